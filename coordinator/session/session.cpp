#include "coordinator/session/session.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <random>

#include "coordinator/session/command.hpp"
#include "coordinator/session/interrupt.hpp"
#include "proto/base/errors.hpp"
#include "proto/message/mesh_message.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

using SteadyClock = std::chrono::steady_clock;

Milliseconds milliseconds(double seconds) {
  return Milliseconds(static_cast<std::int64_t>(1000 * seconds));
}

/// A process that has ended may have said why: how long its last message can be on its way.
constexpr Milliseconds last_words{300};

/// A private folder (mode 0700) for the socket.
std::filesystem::path make_run_directory() {
  std::string name = (std::filesystem::temp_directory_path() / "fluxpact-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw SystemError("cannot create a private folder '{}': {}; set TMPDIR to a writable place",
                      name, std::strerror(errno));
  }
  return name;
}

std::string make_session_id() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

/// Largest frame that a participant can have reason to send: an array of vectors over faces, cells
/// or particles.
std::int64_t frame_limit(const Mesh& mesh) {
  constexpr std::int64_t least = std::int64_t{256} << 20;  // particles: 11 million positions
  return std::max<std::int64_t>(least, std::int64_t{32} * mesh.faces());
}

}  // namespace

Session::Session(const Scene& scene, const Mesh& mesh, const std::filesystem::path& log,
                 const std::string& log_level)
    : scene_(scene),
      id_(make_session_id()),
      run_directory_(scene.launch.listen.empty() ? make_run_directory() : std::filesystem::path()),
      channel_(scene.launch.listen.empty() ? "ipc://" + (run_directory_ / "socket").string()
                                           : scene.launch.listen,
               frame_limit(mesh)) {
  peer(Role::fluid).role = Role::fluid;
  peer(Role::fluid).name = server_name(Role::fluid);
  peer(Role::particles).role = Role::particles;
  peer(Role::particles).name = server_name(Role::particles);
  if (scene.launch.mode == LaunchMode::local) launch(log, log_level);
}

Session::~Session() {
  for (Peer& each : peers_) each.process.reset();
  std::error_code ignored;
  if (!run_directory_.empty()) std::filesystem::remove_all(run_directory_, ignored);
}

void Session::launch(const std::filesystem::path& log, const std::string& log_level) {
  for (Peer& each : peers_) {
    const Command command = server_command(scene_, each.role, endpoint(), log_level);
    each.process = std::make_unique<Process>(each.name, command.program, command.arguments, log);
    spdlog::info("started {} (process {})", each.name, each.process->pid());
  }
}

Session::Peer* Session::find(const std::string& routing) {
  const auto found = std::ranges::find(peers_, routing, &Peer::routing);
  return routing.empty() || found == peers_.end() ? nullptr : &*found;
}

std::string Session::where(const Peer& of) const {
  const std::string process = of.process ? fmt::format(" (process {})", of.process->pid()) : "";
  return fmt::format("{}{}, step {}", of.name, process, step_);
}

// ---- start-up
// -----------------------------------------------------------------------------------------

void Session::greet(const std::string& scene_text, const Mesh& mesh) {
  const auto deadline = SteadyClock::now() + milliseconds(scene_.launch.start_deadline);
  while (!std::ranges::all_of(peers_, &Peer::present)) {
    if (SteadyClock::now() > deadline) {
      const auto& missing = *std::ranges::find_if_not(peers_, &Peer::present);
      throw ProtocolError("{} did not say hello within {} s on {}; see run.log for what it said",
                          missing.name, scene_.launch.start_deadline, endpoint());
    }
    take_message(Milliseconds(100));
  }
  check_matching();
  const std::string expected = fingerprint_text(mesh);
  for (Peer& each : peers_) {
    Message welcome;
    welcome.header.type = MessageType::welcome;
    welcome.header.body["deadline"] =
        std::max(scene_.launch.deadline, scene_.launch.start_deadline);
    tell(each.role, welcome);
    Message configure;
    configure.header.type = MessageType::configure;
    configure.header.body["scene"] = scene_text;
    tell(each.role, configure);
  }
  for (Peer& each : peers_) {
    Message geometry = mesh_message(mesh);
    tell(each.role, geometry);
  }
  await_replies(MessageType::mesh);
  for (const Peer& each : peers_) {
    const Message reply = take_reply(each.role);
    const std::string& got = text(reply.header, "fingerprint");
    if (got != expected)
      throw ProtocolError("{}: rebuilt the mesh with fingerprint {}, ours is {}", where(each), got,
                          expected);
  }
}

void Session::take_hello(const std::string& routing, const Message& hello) {
  const Header& header = hello.header;
  if (header.version != protocol_version) {
    refuse(routing, fmt::format("this coordinator speaks protocol version {}, you speak {}",
                                protocol_version, header.version));
    return;
  }
  const std::string& role = text(header, "role");
  if (role != "fluid" && role != "particles") {
    refuse(routing, fmt::format("the role '{}' is neither fluid nor particles", role));
    return;
  }
  Peer& place = peer(role == "fluid" ? Role::fluid : Role::particles);
  const std::string& backend = text(header, "backend");
  const std::string_view wanted =
      place.role == Role::fluid ? name_of(scene_.fluid.backend) : name_of(scene_.particles.backend);
  if (place.present()) {
    refuse(routing, fmt::format("the role {} is taken by {}", role, place.name));
  } else if (backend != wanted) {
    refuse(routing, fmt::format("the scene asks for the {} backend '{}', you are '{}'", role,
                                wanted, backend));
  } else {
    place.backend = backend;
    place.gives = texts(header, "gives");
    place.needs = texts(header, "needs");
    place.offers = header.body.contains("offers") && integer(header, "offers") != 0;
    place.received = 1;
    place.routing = routing;
    spdlog::info("{}: hello from '{}', backend {}, {}", place.name, text(header, "name"), backend,
                 text(header, "program"));
  }
}

void Session::refuse(const std::string& routing, const std::string& reason) {
  spdlog::warn("refused a participant: {}", reason);
  Message reject;
  reject.header.type = MessageType::reject;
  reject.header.body["reason"] = reason;
  try {
    channel_.send(routing, reject);
  } catch (const ProtocolError& error) {
    spdlog::warn("the refused participant has gone: {}", error.what());
  }
}

void Session::check_matching() const {
  const auto check_asked = [&](const Peer& one, const AskedFields& asked) {
    for (const auto* names : {&asked.scalars, &asked.vectors}) {
      for (const std::string& field : *names) {
        if (std::ranges::find(one.gives, field) != one.gives.end()) continue;
        throw ProtocolError(
            "interphase.forces of the scene needs the field '{}', which {} ({}) does not give; "
            "leave that force out, or use another backend",
            field, one.name, one.backend);
      }
    }
  };
  check_asked(peers_[static_cast<std::size_t>(Role::fluid)], asked_of_fluid(scene_));
  check_asked(peers_[static_cast<std::size_t>(Role::particles)], asked_of_particles(scene_));
  const Peer& particles = peers_[static_cast<std::size_t>(Role::particles)];
  if (scene_.coupling.scheme == CouplingScheme::parallel && !particles.offers) {
    throw ProtocolError(
        "coupling.scheme is parallel, for which {} ({}) would have to make offers, and it does not "
        "say that it can; set coupling.scheme: serial",
        particles.name, particles.backend);
  }
  for (const Peer& one : peers_) {
    const Peer& other = peers_[1 - static_cast<std::size_t>(one.role)];
    for (const std::string& field : one.needs) {
      if (std::ranges::find(other.gives, field) == other.gives.end()) {
        throw ProtocolError("{} ({}) needs the field '{}', which {} ({}) does not give", one.name,
                            one.backend, field, other.name, other.backend);
      }
    }
  }
}

// ---- talking
// ------------------------------------------------------------------------------------------

void Session::tell(Role role, Message& message) {
  Peer& to = peer(role);
  const SessionState next = require_next(to.state, message.header.type, where(to));
  message.header.session = id_;
  message.header.step = step_;
  message.header.attempt = attempt_;
  message.header.sequence = to.sent;
  try {
    channel_.send(to.routing, message);
  } catch (const ProtocolError& error) {
    check_processes();
    throw ProtocolError("{}: {}", where(to), error.what());
  }
  ++to.sent;
  to.state = next;
  if (is_answered(message.header.type)) {
    to.asked = true;
    to.last_sign = SteadyClock::now();
  }
}

Message Session::ask(Role role, Message& message) {
  tell(role, message);
  await_replies(message.header.type);
  return take_reply(role);
}

Session::Replies Session::ask_both(Message& fluid, Message& particles) {
  tell(Role::fluid, fluid);
  tell(Role::particles, particles);
  await_replies(fluid.header.type);
  return {take_reply(Role::fluid), take_reply(Role::particles)};
}

/// Wait until all who were asked have answered. Each has its own deadline, from its last sign of
/// life.
void Session::await_replies(MessageType asked) {
  const bool starting = asked == MessageType::mesh || asked == MessageType::start;
  const double patience = starting ? scene_.launch.start_deadline : scene_.launch.deadline;
  while (std::ranges::any_of(peers_, &Peer::asked)) {
    if (interrupts() > 1) throw Error(ExitCode::interrupted, "interrupted twice: stopped at once");
    for (const Peer& each : peers_) {
      if (!each.asked || SteadyClock::now() - each.last_sign <= milliseconds(patience)) continue;
      throw ProtocolError(
          "{}: silent for {} s after '{}'; it hangs, or launch.deadline is too short for this "
          "scene",
          where(each), patience, name_of(asked));
    }
    take_message(Milliseconds(200));
    keep_idle_awake();
  }
}

Message Session::take_reply(Role role) {
  Peer& from = peer(role);
  Message reply = std::move(*from.reply);
  from.reply.reset();
  return reply;
}

/// Wait for the next message of anybody and put it where it belongs.
void Session::take_message(Milliseconds patience) {
  std::vector<int> watched;
  for (const Peer& each : peers_) {
    if (each.process) watched.push_back(each.process->descriptor());
  }
  auto wakeup = channel_.wait(watched, patience);
  if (!wakeup.arrival && !wakeup.ready.empty()) {
    wakeup = channel_.wait({}, last_words);
    if (!wakeup.arrival) check_processes();
  }
  if (!wakeup.arrival) return;
  Peer* sender = find(wakeup.arrival->peer);
  if (sender == nullptr) {
    take_from_stranger(*wakeup.arrival);
    return;
  }
  auto& message = wakeup.arrival->message;
  if (!message)
    throw ProtocolError("{}: sent a malformed message: {}", where(*sender), wakeup.arrival->defect);
  if (message->header.type == MessageType::error) sender->state = SessionState::closed;
  check_header(*sender, message->header);
  ++sender->received;
  sender->last_sign = SteadyClock::now();
  if (message->header.type == MessageType::result) {
    sender->asked = false;
    sender->reply = std::move(*message);
  }
}

/// Whoever is no participant can become one with a hello; anything else is not for us.
void Session::take_from_stranger(const Arrival& arrival) {
  if (arrival.message && arrival.message->header.type == MessageType::hello) {
    try {
      take_hello(arrival.peer, *arrival.message);
    } catch (const ProtocolError& error) {
      refuse(arrival.peer, error.what());
    }
  } else if (++foreign_messages_ == 1) {
    spdlog::warn(
        "ignored what is no message of a participant ({}); more of it is ignored silently",
        arrival.message ? name_of(arrival.message->header.type) : std::string_view(arrival.defect));
  }
}

void Session::check_header(const Peer& from, const Header& header) const {
  if (header.sequence != from.received) {
    throw ProtocolError("{}: message '{}' has sequence {}, expected {}", where(from),
                        name_of(header.type), header.sequence, from.received);
  }
  if (header.type == MessageType::error) {
    const auto code = static_cast<ExitCode>(integer(header, "exit_code"));
    const bool known =
        code == ExitCode::usage || code == ExitCode::conservation || code == ExitCode::numerics;
    throw Error(known ? code : ExitCode::participant,
                fmt::format("{}: {}", where(from), text(header, "text")));
  }
  if (header.type != MessageType::result && header.type != MessageType::heartbeat) {
    throw ProtocolError("{}: a participant may not say '{}'", where(from), name_of(header.type));
  }
  if (header.type == MessageType::result && !from.asked)
    throw ProtocolError("{}: sent a result without being asked", where(from));
  if (header.session != id_ || header.step != step_ || header.attempt != attempt_) {
    throw ProtocolError(
        "{}: '{}' for session {}, step {}, attempt {}; expected session {}, step {}, attempt {}",
        where(from), name_of(header.type), header.session, header.step, header.attempt, id_, step_,
        attempt_);
  }
}

void Session::check_processes() {
  for (Peer& each : peers_) {
    if (!each.process) continue;
    if (const auto how = each.process->ended()) {
      throw ProtocolError("{}: ended unexpectedly with {}; the last lines of run.log may say why",
                          where(each), *how);
    }
  }
}

/// Participants that wait for their turn must know that we live.
void Session::keep_idle_awake() {
  const auto now = SteadyClock::now();
  if (now - last_heartbeat_ < milliseconds(scene_.launch.deadline / 4)) return;
  last_heartbeat_ = now;
  for (const Peer& each : peers_) {
    if (each.asked || !each.present() || each.state == SessionState::configured) continue;
    Message heartbeat;
    tell(each.role, heartbeat);
  }
}

void Session::close() noexcept {
  for (Peer& each : peers_) {
    if (!each.present() || each.state == SessionState::closed) continue;
    try {
      Message bye;
      bye.header.type = MessageType::bye;
      tell(each.role, bye);
    } catch (const std::exception& error) {
      spdlog::warn("{}: could not say bye: {}", each.name, error.what());
    }
  }
  for (Peer& each : peers_) {
    if (each.process) each.process->finish(Milliseconds(2000));
  }
}

}  // namespace fluxpact
