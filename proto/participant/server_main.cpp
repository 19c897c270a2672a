#include "proto/participant/server_main.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "proto/base/errors.hpp"
#include "proto/base/logging.hpp"
#include "proto/base/version.hpp"
#include "proto/participant/serve.hpp"

namespace fluxpact {
namespace {

/// A server that a coordinator started must not outlive it, however it ends.
void end_with_parent(const std::string& parent) {
  if (parent.empty()) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (parent != "any" && parent != std::to_string(getppid()))
    throw ProtocolError("the coordinator (process {}) has ended already", parent);
}

/// Go on as the program `name` of our folder, with the same arguments.
[[noreturn]] void become(const std::string& name, const std::string& backend, char** argv) {
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::string program = (here / name).string();
  execv(program.c_str(), argv);
  throw SystemError(
      "the engine '{}' has a program of its own, and {} cannot be started: {}; this build was made "
      "without that engine, install its package and build again (README.md lists them)",
      backend, program, std::strerror(errno));
}

std::vector<std::string> all_backends(const ServerProgram& program) {
  std::vector<std::string> names = program.backends;
  for (const auto& [backend, other] : program.elsewhere) names.push_back(backend);
  return names;
}

}  // namespace

int server_main(int argc, char** argv, const ServerProgram& program) {
  CLI::App app(program.description, program.name);
  ServeOptions options;
  std::string backend = program.backends.front();
  std::string log_level = "info";
  std::string parent;
  options.name = program.name;
  app.set_version_flag("--version", version_text());
  app.add_option("--connect", options.endpoint,
                 "Where the coordinator listens: ipc://PATH or tcp://HOST:PORT")
      ->required();
  app.add_option("--name", options.name, "Name in the coordinator's messages")
      ->capture_default_str();
  app.add_option("--backend", backend, "The engine")
      ->check(CLI::IsMember(all_backends(program)))
      ->capture_default_str();
  app.add_option("--patience", options.patience, "Seconds to wait for the coordinator")
      ->capture_default_str();
  app.add_option("--with-parent", parent,
                 "End when this process, our parent, ends; any: whichever it is");
  app.add_option("--log-level", log_level, "trace, debug, info, warning, error")
      ->check(CLI::IsMember(log_levels()))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  }
  log_to_stderr(options.name, log_level);
  try {
    if (const auto other = program.elsewhere.find(backend); other != program.elsewhere.end())
      become(other->second, backend, argv);
    end_with_parent(parent);
    const auto participant = program.make(backend);
    serve(*participant, options);
    return static_cast<int>(ExitCode::done);
  } catch (const Error& error) {
    spdlog::error("{}", error.what());
    return static_cast<int>(error.exit_code());
  } catch (const std::exception& error) {
    spdlog::error("unexpected: {}", error.what());
    return static_cast<int>(ExitCode::participant);
  }
}

}  // namespace fluxpact
