#include "dem_server/backends/yade/yade_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr Milliseconds time_to_start{60'000};
constexpr Milliseconds time_to_end{5'000};
constexpr std::int64_t largest_answer = std::int64_t{1} << 34;  // [bytes] of one array

/// For messages: the end of what the process has printed.
std::string last_words(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) continue;
    lines.push_back(line.substr(0, 200));
    if (lines.size() > 3) lines.pop_front();
  }
  if (lines.empty()) return "it printed nothing";
  std::string words = "it printed last:";
  for (const std::string& line : lines) words += " | " + line;
  return words;
}

}  // namespace

YadeProcess::PrivateFolder::PrivateFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "fluxpact-yade-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {  // readable for us alone
    throw SystemError("cannot make the folder {} for YADE: {}; set TMPDIR to one with room", name,
                      std::strerror(errno));
  }
  path = name;
}

YadeProcess::PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

YadeProcess::YadeProcess(const std::filesystem::path& adapter, Milliseconds silence)
    : silence_(silence), channel_("ipc://" + (folder_.path / "socket").string(), largest_answer) {
  // A copy of YADE that takes the place of its parent becomes our child.
  if (prctl(PR_SET_CHILD_SUBREAPER, 1) != 0)
    throw SystemError("cannot adopt processes of YADE: {}", std::strerror(errno));
  process_.emplace("YADE", FLUXPACT_YADE_PYTHON,
                   std::vector<std::string>{adapter.string(), channel_.endpoint(),
                                            std::to_string(getpid()), FLUXPACT_YADE_MODULES},
                   folder_.path / "log");
  group_ = process_->pid();
  await_hello();
}

YadeProcess::~YadeProcess() {
  if (!process_) return;
  // The copy that holds the committed state, and who waits for our end, are ours now. All are of
  // the group that the first was started in.
  process_.reset();
  int ended = 0;
  while ((ended = waitpid(-group_, nullptr, WNOHANG)) >= 0) {
    if (ended > 0) continue;
    kill(-group_, SIGKILL);
    waitpid(-group_, nullptr, 0);
  }
}

void YadeProcess::fail(const std::string& what) const {
  throw ProtocolError("YADE (process {}) {}; {}", process_->pid(), what,
                      last_words(folder_.path / "log"));
}

void YadeProcess::await_hello() {
  const Message hello = wait("start", time_to_start, {});
  if (hello.header.type != MessageType::hello || integer(hello.header, "pid") != process_->pid())
    fail("said something else than hello");
}

Message YadeProcess::wait(const std::string& what, Milliseconds silence, const Progress& progress) {
  while (true) {
    CoordinatorChannel::Wakeup wakeup = channel_.wait({process_->descriptor()}, silence);
    if (!wakeup.arrival) {
      if (const auto end = process_->ended())
        fail(fmt::format("ended with {} when asked to {}", *end, what));
      if (wakeup.ready.empty()) {
        fail(fmt::format("has been silent for {} s, asked to {}",
                         1e-3 * static_cast<double>(silence.count()), what));
      }
      continue;
    }
    Arrival& arrival = *wakeup.arrival;
    if (!arrival.message) fail("sent what is no message: " + arrival.defect);
    const MessageType type = arrival.message->header.type;
    if (type == MessageType::hello) peer_ = arrival.peer;
    if (progress) progress();
    if (type == MessageType::heartbeat) continue;
    if (type == MessageType::error) {
      throw ProtocolError("YADE (process {}) cannot {}", process_->pid(),
                          text(arrival.message->header, "text"));
    }
    return std::move(*arrival.message);
  }
}

Message YadeProcess::ask(Message& question, const Progress& progress) {
  const std::string call = text(question.header, "call");
  question.header.sequence = asked_++;
  // The arrays may be gone before a YADE that hangs has taken them.
  for (zmq::message_t& frame : question.frames) frame = zmq::message_t(frame.data(), frame.size());
  try {
    channel_.send(peer_, question);
  } catch (const ProtocolError& error) {
    if (const auto end = process_->ended())
      fail(fmt::format("ended with {} before it was asked to {}", *end, call));
    fail(fmt::format("cannot be asked to {}: {}", call, error.what()));
  }
  return wait(call, silence_, progress);
}

void YadeProcess::rollback() {
  Message question = yade_question("rollback");
  const Message answer = ask(question, {});
  process_->follow(static_cast<pid_t>(integer(answer.header, "successor")), time_to_end);
  await_hello();
}

Message yade_question(const std::string& call) {
  Message question;
  question.header.type = MessageType::advance;
  question.header.body["call"] = call;
  return question;
}

std::filesystem::path yade_adapter() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return program.parent_path().parent_path() / "share" / "fluxpact" / "yade_adapter.py";
}

}  // namespace fluxpact
