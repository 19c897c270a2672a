// The command line that all servers share.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "proto/participant/participant.hpp"

namespace fluxpact {

struct ServerProgram {
  std::string name;                   ///< of the program
  std::string description;            ///< one line for --help
  std::vector<std::string> backends;  ///< the first is the default
  /// Backends of other programs, which lie beside this one: the process becomes the program.
  std::map<std::string, std::string> elsewhere{};
  std::function<std::unique_ptr<Participant>(const std::string& backend)> make;
};

/// Parse, connect, serve until bye. Returns the exit code of the program.
int server_main(int argc, char** argv, const ServerProgram& program);

}  // namespace fluxpact
