// Spheres moved by LIGGGHTS (Debian's libliggghts; Kloss et al., Prog. Comput. Fluid Dyn. 12, 2012,
// 140-152).
//
// The library is under the GPL: so is a program that links this.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Law: `hooke/stiffness` with `tangential history`, which is the native engine's linear law but
/// for two things: Coulomb's limit is on the spring alone, whose dashpot acts while it sticks; and
/// the lever is r - δ/2. The program must have an MpiSession, and all its ranks call this with the
/// same arguments. Throws as make_granular_engine, and ConfigError for more than most_kinds kinds
/// of spheres. LIGGGHTS itself ends the process where it finds an error.
std::unique_ptr<ParticleEngine> make_liggghts_engine(const Scene& scene, const Mesh& mesh,
                                                     ParticleState initial);

}  // namespace fluxpact
