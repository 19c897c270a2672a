#include "proto/participant/serve.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "proto/base/errors.hpp"
#include "proto/base/version.hpp"
#include "proto/message/mesh_message.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/session/channel.hpp"
#include "proto/session/state_machine.hpp"

namespace fluxpact {
namespace {

using SteadyClock = std::chrono::steady_clock;

Milliseconds milliseconds(double seconds) {
  return Milliseconds(static_cast<std::int64_t>(1000 * seconds));
}

/// One session seen from the participant: state, and what must outlive the messages that borrow it.
class Session {
 public:
  Session(Participant& participant, const ServeOptions& options)
      : participant_(participant),
        options_(options),
        channel_(options.endpoint),
        deadline_(options.patience) {}

  void run() {
    say_hello();
    while (state_ != SessionState::closed) {
      auto message = channel_.receive(milliseconds(deadline_));
      if (!message) {
        throw ProtocolError(
            "coordinator at {}: silent for {} s in state '{}'; it has probably ended",
            options_.endpoint, deadline_, name_of(state_));
      }
      handle(*message);
    }
  }

  /// Tell the coordinator why we end. Failing to do so changes nothing: we end anyway.
  void report(const std::string& what, ExitCode code) noexcept {
    try {
      Message message;
      message.header.type = MessageType::error;
      message.header.body["text"] = what;
      message.header.body["exit_code"] = std::int64_t{static_cast<int>(code)};
      send(message);
      channel_.linger(Milliseconds(500));
    } catch (const std::exception& error) {
      spdlog::error("could not report to the coordinator: {}", error.what());
    }
  }

 private:
  void say_hello() {
    const Identity identity = participant_.identity();
    Message hello;
    hello.header.type = MessageType::hello;
    hello.header.body = {{"role", std::string(name_of(identity.role))},
                         {"name", options_.name},
                         {"backend", identity.backend},
                         {"gives", identity.gives},
                         {"needs", identity.needs},
                         {"program", version_line()},
                         {"pid", std::int64_t{getpid()}}};
    if (identity.offers) hello.header.body["offers"] = std::int64_t{1};
    send(hello);
  }

  void send(Message& message) {
    message.header.session = session_;
    message.header.step = step_;
    message.header.attempt = attempt_;
    channel_.send(message, milliseconds(deadline_));
    last_sent_ = SteadyClock::now();
  }

  void send_result(const Fields& fields) {
    Message result;
    result.header.type = MessageType::result;
    add_fields(result, fields);
    send(result);
  }

  void handle(const Message& message) {
    const Header& header = message.header;
    if (header.version != protocol_version) {
      throw ProtocolError("coordinator: speaks protocol version {}, we speak {}", header.version,
                          protocol_version);
    }
    if (!session_.empty() && header.session != session_) {
      throw ProtocolError("coordinator: message '{}' belongs to session {}, ours is {}",
                          name_of(header.type), header.session, session_);
    }
    state_ = require_next(state_, header.type, "coordinator");
    step_ = header.step;
    attempt_ = header.attempt;
    switch (header.type) {
      case MessageType::welcome:
        session_ = header.session;
        deadline_ = number(header, "deadline");
        break;
      case MessageType::reject:
        throw ProtocolError("coordinator: refused us: {}", text(header, "reason"));
      case MessageType::configure:
        scene_ = read_scene(text(header, "scene"), "the coordinator's scene");
        break;
      case MessageType::mesh:
        take_mesh(message);
        break;
      case MessageType::start:
        answer([&](Fields& out) { participant_.start(fields_of(message), out); });
        break;
      case MessageType::advance:
        answer([&](Fields& out) { advance(message, out); });
        break;
      case MessageType::offer:
        answer([&](Fields& out) { offer(message, out); });
        break;
      case MessageType::snapshot:
        answer([&](Fields& out) { snapshot(header, out); });
        break;
      case MessageType::commit:
        participant_.commit();
        break;
      case MessageType::rollback:
        participant_.rollback();
        break;
      case MessageType::error:
        throw ProtocolError("coordinator: {}", text(header, "text"));
      default:  // heartbeat, bye: the state says it all
        break;
    }
  }

  void take_mesh(const Message& message) {
    const Mesh mesh = mesh_of(message);
    last_sent_ = SteadyClock::now();
    participant_.keep_alive(
        [this] { say_alive(std::min(deadline_, scene_.launch.start_deadline)); });
    participant_.configure(scene_, mesh);
    spdlog::info("ready for session {}: '{}', {} cells", session_, scene_.scene.name, mesh.cells());
    Message result;
    result.header.type = MessageType::result;
    result.header.body["fingerprint"] = fingerprint_text(mesh);
    send(result);
  }

  template <class Produce>
  void answer(const Produce& produce) {
    Fields out;
    produce(out);
    send_result(out);
  }

  static Window window_of(const Header& header) {
    return {header.step, number(header, "start"), number(header, "length")};
  }

  void advance(const Message& message, Fields& out) {
    last_sent_ = SteadyClock::now();
    participant_.advance(window_of(message.header), fields_of(message), out,
                         [this] { say_alive(deadline_); });
  }

  void offer(const Message& message, Fields& out) {
    last_sent_ = SteadyClock::now();
    participant_.offer(window_of(message.header), fields_of(message), out,
                       [this] { say_alive(deadline_); });
  }

  void snapshot(const Header& header, Fields& out) {
    if (!header.body.contains("figures")) {
      participant_.snapshot(out);
      return;
    }
    last_sent_ = SteadyClock::now();
    participant_.figures(out, [this] { say_alive(deadline_); });
  }

  /// A sign of life if the last one is a good part of the other side's patience [s] ago.
  void say_alive(double patience) {
    if (SteadyClock::now() - last_sent_ < milliseconds(patience / 4)) return;
    Message heartbeat;
    send(heartbeat);
  }

  Participant& participant_;
  const ServeOptions& options_;
  Scene scene_;
  ParticipantChannel channel_;
  double deadline_;  ///< [s]
  SessionState state_ = SessionState::greeting;
  std::string session_;
  std::int64_t step_ = 0;
  std::int64_t attempt_ = 0;
  SteadyClock::time_point last_sent_{};
};

}  // namespace

void serve(Participant& participant, const ServeOptions& options) {
  Session session(participant, options);
  try {
    session.run();
  } catch (const Error& error) {
    session.report(error.what(), error.exit_code());
    throw;
  } catch (const std::exception& error) {
    session.report(error.what(), ExitCode::numerics);
    throw;
  }
}

}  // namespace fluxpact
