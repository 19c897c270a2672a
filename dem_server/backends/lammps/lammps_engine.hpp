// Spheres moved by LAMMPS (Debian's liblammps; Thompson et al., Comput. Phys. Commun. 271, 2022,
// 108171) with its GRANULAR package.
//
// The library is under the GPL: so is a program that links this.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Law: that of the native engine, exactly, for linear contacts of equal spheres (pair_style
/// gran/hooke/history); else pair_style granular, whose torque has the lever r - δ/2. The program
/// must have an MpiSession, and all its ranks call this with the same arguments.
/// Throws as make_granular_engine. LAMMPS itself ends the process where it finds an error.
std::unique_ptr<ParticleEngine> make_lammps_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial);

}  // namespace fluxpact
