// The errors of all programs. A message says what was seen, where, and what to do about it.
// Programs turn them into exit codes (docs/protocol.md, "Exit codes").
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace fluxpact {

/// Exit codes of the three programs.
enum class ExitCode : int {
  done = 0,
  usage = 2,         ///< wrong command line or scene: nothing was started
  conservation = 3,  ///< the audit refused a window
  participant = 4,   ///< a participant failed or vanished
  numerics = 5,      ///< a solver could not go on
  interrupted = 130,
};

class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ExitCode exit_code() const { return code_; }

 private:
  ExitCode code_;
};

/// The scene or the command line asks for something that cannot be done (exit 2).
struct ConfigError : Error {
  template <class... Args>
  explicit ConfigError(fmt::format_string<Args...> text, Args&&... args)
      : Error(ExitCode::usage, fmt::format(text, std::forward<Args>(args)...)) {}
};

/// The audit refused a window (exit 3).
struct ConservationError : Error {
  template <class... Args>
  explicit ConservationError(fmt::format_string<Args...> text, Args&&... args)
      : Error(ExitCode::conservation, fmt::format(text, std::forward<Args>(args)...)) {}
};

/// A peer vanished, was silent past its deadline, or said what the protocol does not allow (exit
/// 4).
struct ProtocolError : Error {
  template <class... Args>
  explicit ProtocolError(fmt::format_string<Args...> text, Args&&... args)
      : Error(ExitCode::participant, fmt::format(text, std::forward<Args>(args)...)) {}
};

/// A solver met a value with which it cannot go on: names field, cell or particle, value, step
/// (exit 5).
struct NumericsError : Error {
  template <class... Args>
  explicit NumericsError(fmt::format_string<Args...> text, Args&&... args)
      : Error(ExitCode::numerics, fmt::format(text, std::forward<Args>(args)...)) {}
};

/// The operating system refused something: file, disk, process, socket (exit 4).
struct SystemError : Error {
  template <class... Args>
  explicit SystemError(fmt::format_string<Args...> text, Args&&... args)
      : Error(ExitCode::participant, fmt::format(text, std::forward<Args>(args)...)) {}
};

}  // namespace fluxpact
