// How a server is started: which program, with which arguments.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "proto/participant/participant.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

struct Command {
  std::filesystem::path program;
  std::vector<std::string> arguments;
};

/// The names that the servers bear in messages and, but for custom engines, as programs.
const char* server_name(Role role);

/// The server lies beside the coordinator, or is the scene's own (particles.program). With several
/// ranks mpirun starts it. It ends with its parent. Throws SystemError if mpirun is needed and not
/// to be found.
Command server_command(const Scene& scene, Role role, const std::string& endpoint,
                       const std::string& log_level);

}  // namespace fluxpact
