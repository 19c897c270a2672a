// One line per event, with the time and the process that said it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fluxpact {

/// What --log-level takes.
std::vector<std::string> log_levels();

/// Log to standard error (a server: the coordinator collects it in run.log).
void log_to_stderr(const std::string& process, const std::string& level);

/// Warnings and errors, and nothing else, to standard error for a person to read.
void log_to_console(const std::string& process);

/// Log to a new file, and warnings and errors to standard error, too. Throws
/// SystemError.
void log_to_file(const std::string& process, const std::string& level,
                 const std::filesystem::path& path);

}  // namespace fluxpact
