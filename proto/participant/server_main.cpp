#include "proto/participant/server_main.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>

#include "proto/base/errors.hpp"
#include "proto/base/logging.hpp"
#include "proto/base/version.hpp"
#include "proto/participant/serve.hpp"

namespace fluxpact {
namespace {

/// A server that a coordinator started must not outlive it, however it ends.
void end_with_parent(pid_t parent) {
  if (parent == 0) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent)
    throw ProtocolError("the coordinator (process {}) has ended already", parent);
}

}  // namespace

int server_main(int argc, char** argv, const ServerProgram& program) {
  CLI::App app(program.description, program.name);
  ServeOptions options;
  std::string backend = program.backends.front();
  std::string log_level = "info";
  pid_t parent = 0;
  options.name = program.name;
  app.set_version_flag("--version", version_text());
  app.add_option("--connect", options.endpoint,
                 "Where the coordinator listens: ipc://PATH or tcp://HOST:PORT")
      ->required();
  app.add_option("--name", options.name, "Name in the coordinator's messages")
      ->capture_default_str();
  app.add_option("--backend", backend, "The engine")
      ->check(CLI::IsMember(program.backends))
      ->capture_default_str();
  app.add_option("--patience", options.patience, "Seconds to wait for the coordinator")
      ->capture_default_str();
  app.add_option("--with-parent", parent, "End when this process, our parent, ends");
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
