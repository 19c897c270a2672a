// YADE as a child process: started, asked, watched. What it can be asked stands in adapter.py.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "proto/session/channel.hpp"
#include "proto/session/process.hpp"

namespace fluxpact {

/// One question after another to one YADE. It never outlives us.
class YadeProcess {
 public:
  /// Starts YADE with `adapter` and waits until it says hello. `silence`: after which it counts as
  /// lost. Throws SystemError, and what `ask` throws.
  YadeProcess(const std::filesystem::path& adapter, Milliseconds silence);
  ~YadeProcess();
  YadeProcess(const YadeProcess&) = delete;
  YadeProcess& operator=(const YadeProcess&) = delete;

  /// Sends `question` (made by `yade_question`) and waits for the answer; `progress` is called when
  /// YADE gives a sign of life. Throws ProtocolError if YADE ended, was silent too long, or
  /// could not do it: what it said last stands in the message.
  Message ask(Message& question, const Progress& progress);

  /// Ends the process; the copy of it that holds the state before the last `run` goes on instead.
  void rollback();

 private:
  Message wait(const std::string& what, Milliseconds silence, const Progress& progress);
  void await_hello();
  [[noreturn]] void fail(const std::string& what) const;

  /// Removed at the end.
  struct PrivateFolder {
    std::filesystem::path path;
    PrivateFolder();
    ~PrivateFolder();
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;
  };
  Milliseconds silence_;
  PrivateFolder folder_;
  CoordinatorChannel channel_;
  std::optional<Process> process_;
  pid_t group_ = 0;   ///< of all its processes
  std::string peer_;  ///< routing id of the one that said hello last
  std::int64_t asked_ = 0;
};

/// A message that asks for `call`; arrays and numbers are added to it.
Message yade_question(const std::string& call);

/// Of this build, found from the running program: ../share/fluxpact/yade_adapter.py.
std::filesystem::path yade_adapter();

}  // namespace fluxpact
