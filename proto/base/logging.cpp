#include "proto/base/logging.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <fstream>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

void set_logger(const std::string& process, const std::string& level,
                std::vector<spdlog::sink_ptr> sinks) {
  auto logger = std::make_shared<spdlog::logger>(process, sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

spdlog::sink_ptr with_time(spdlog::sink_ptr sink) {
  sink->set_pattern("%Y-%m-%d %H:%M:%S.%e [%n] %l: %v");
  return sink;
}

spdlog::sink_ptr console_sink() {
  auto sink = std::make_shared<spdlog::sinks::stderr_sink_st>();
  sink->set_level(spdlog::level::warn);
  sink->set_pattern("%n: %l: %v");
  return sink;
}

}  // namespace

std::vector<std::string> log_levels() { return {"trace", "debug", "info", "warning", "error"}; }

void log_to_stderr(const std::string& process, const std::string& level) {
  set_logger(process, level, {with_time(std::make_shared<spdlog::sinks::stderr_sink_st>())});
}

void log_to_console(const std::string& process) {
  set_logger(process, "warning", {console_sink()});
}

void log_to_file(const std::string& process, const std::string& level,
                 const std::filesystem::path& path) {
  // Emptied, then appended to: servers append to the same file, and each line must go to its end.
  std::ofstream(path, std::ios::trunc).close();
  try {
    auto file = with_time(std::make_shared<spdlog::sinks::basic_file_sink_st>(path.string()));
    set_logger(process, level, {file, console_sink()});
  } catch (const spdlog::spdlog_ex& error) {
    throw SystemError("cannot write '{}': {}", path.string(), error.what());
  }
}

}  // namespace fluxpact
