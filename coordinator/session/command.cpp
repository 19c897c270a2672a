#include "coordinator/session/command.hpp"

#include <unistd.h>

#include <cstdlib>

#include "proto/base/errors.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

/// Where the shell would find it.
std::filesystem::path on_the_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "";
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    std::filesystem::path found =
        std::filesystem::path(folders.substr(begin, end - begin)) / program;
    if (end > begin && access(found.c_str(), X_OK) == 0) return found;
    begin = end + 1;
  }
  throw SystemError(
      "particles.ranks is more than 1, and '{}', which starts several processes, is not on the "
      "PATH; "
      "install openmpi-bin, or set particles.ranks to 1",
      program);
}

}  // namespace

const char* server_name(Role role) { return role == Role::fluid ? "cfd_server" : "dem_server"; }

Command server_command(const Scene& scene, Role role, const std::string& endpoint,
                       const std::string& log_level) {
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const bool particles = role == Role::particles;
  const std::string backend(particles ? name_of(scene.particles.backend)
                                      : name_of(scene.fluid.backend));
  Command command;
  command.program = here / server_name(role);
  if (particles && scene.particles.backend == ParticleBackend::custom)
    command.program = scene.particles.program;
  const bool several = particles && scene.particles.ranks > 1;
  // Processes that mpirun starts have mpirun as parent, whose number nobody knows yet.
  const std::string parent = several ? "any" : std::to_string(getpid());
  command.arguments = {"--connect", endpoint,        "--name", server_name(role), "--backend",
                       backend,     "--with-parent", parent,   "--log-level",     log_level};
  if (!several) return command;
  std::vector<std::string> words{"--allow-run-as-root",
                                 "--oversubscribe",
                                 "--bind-to",
                                 "none",
                                 "-np",
                                 std::to_string(scene.particles.ranks),
                                 command.program.string()};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  return {on_the_path("mpirun"), std::move(words)};
}

}  // namespace fluxpact
