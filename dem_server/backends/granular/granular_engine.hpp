// A particle engine around a library that moves spheres (Simulation). Every window begins from our
// own arrays, in the same order: so a window that is repeated, or begins in another process, goes
// on with the same bits, and undoing it is to forget what came out.
#pragma once

#include <memory>
#include <string>

#include "dem_server/backends/granular/ranks.hpp"
#include "dem_server/backends/granular/simulation.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// `name` ("lammps", "liggghts"): in messages and in what `store` writes. The particles are sound
/// (checked_rows) and the same on all ranks. Throws ConfigError for a sub-step that is too long, a
/// pair of materials that can meet without a law, a period too short for the largest particle, ids
/// beyond 1 .. 2^31 - 1.
/// Its `advance` throws NumericsError that names the particle if one is lost, is not finite, or
/// moves by more than its radius in a sub-step; the committed state is unharmed.
std::unique_ptr<ParticleEngine> make_granular_engine(const Scene& scene, const Mesh& mesh,
                                                     std::string name, ContactLaws laws,
                                                     ParticleState spheres,
                                                     std::unique_ptr<Simulation> simulation);

}  // namespace fluxpact
