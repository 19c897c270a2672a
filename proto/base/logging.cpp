#include "proto/base/logging.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

void set_logger(const std::string& process, const std::string& level,
                std::vector<spdlog::sink_ptr> sinks) {
  auto logger = std::make_shared<spdlog::logger>(process, sinks.begin(), sinks.end());
  logger->set_pattern("%Y-%m-%d %H:%M:%S.%e [%n] %l: %v");
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace

std::vector<std::string> log_levels() { return {"trace", "debug", "info", "warning", "error"}; }

void log_to_stderr(const std::string& process, const std::string& level) {
  set_logger(process, level, {std::make_shared<spdlog::sinks::stderr_sink_st>()});
}

void log_to_file(const std::string& process, const std::string& level,
                 const std::filesystem::path& path) {
  try {
    auto file = std::make_shared<spdlog::sinks::basic_file_sink_st>(path.string());
    auto console = std::make_shared<spdlog::sinks::stderr_sink_st>();
    set_logger(process, level, {file, console});
    console->set_level(spdlog::level::warn);
    console->set_pattern("%l: %v");
  } catch (const spdlog::spdlog_ex& error) {
    throw SystemError("cannot write '{}': {}", path.string(), error.what());
  }
}

}  // namespace fluxpact
