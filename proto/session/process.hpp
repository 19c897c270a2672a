// A child process: started, watched, and never left behind.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fluxpact {

class Process {
 public:
  /// Start a program in its own process group (a Ctrl-C on the terminal does not reach it); what it
  /// prints is appended to `log`. Throws SystemError.
  Process(std::string name, const std::filesystem::path& program,
          const std::vector<std::string>& arguments, const std::filesystem::path& log);
  /// Kills the process if it still runs, and reaps it.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  const std::string& name() const { return name_; }
  pid_t pid() const { return pid_; }
  int descriptor() const { return descriptor_; }  ///< becomes readable when the process ends

  /// How it ended ("exit code 4", "signal 9 (Killed)"), or nothing if it still runs.
  std::optional<std::string> ended();

  /// Wait for it to end by itself, then go on with its child `successor`, which then is ours (we
  /// are a subreaper, prctl(2)). Throws SystemError if that one is gone.
  void follow(pid_t successor, std::chrono::milliseconds grace);

  /// Wait for it to end by itself, then kill it.
  void finish(std::chrono::milliseconds grace) noexcept;

 private:
  void watch();
  std::string name_;
  pid_t pid_ = -1;
  int descriptor_ = -1;
  std::optional<int> status_;
};

}  // namespace fluxpact
