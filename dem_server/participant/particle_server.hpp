// A particle server from the engines that it knows: all else is the same for every engine.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/participant/participant.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// How one engine is made. Both functions throw ConfigError for what the engine cannot do.
struct EngineMaker {
  ParticleBackend backend = ParticleBackend::custom;
  /// Called before the particles are packed, which may take a while; may be left out.
  std::function<void(const Scene&, const Mesh&)> check_mesh{};
  std::function<std::unique_ptr<ParticleEngine>(const Scene&, const Mesh&, ParticleState)> make{};
};

/// Takes part with what the scene asks for when it is configured: particles moved by the engine
/// `backend`, one of `engines`, or prescribed solids. Throws ConfigError for another name; its
/// `configure` does if the scene asks for another engine than the program was started with.
std::unique_ptr<Participant> make_particle_participant(const std::string& backend,
                                                       std::vector<EngineMaker> engines);

/// The whole of a server program: command line, session, exit code. `elsewhere`: the programs of
/// the same folder that have further engines; the process becomes one of them if it is asked for
/// its engine.
int particle_server_main(int argc, char** argv, const std::string& program,
                         std::vector<EngineMaker> engines,
                         std::map<std::string, std::string> elsewhere = {});

}  // namespace fluxpact
