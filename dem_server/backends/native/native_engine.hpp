// The native soft-sphere engine: contacts by springs and dashpots, velocity-Verlet, any number of
// threads with the same bits.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Contact law: contact_force.hpp. Walls: domain.hpp. Motion: velocity-Verlet whose contact forces
/// see the velocity half a sub-step behind the position, as LAMMPS' granular styles do. Second
/// order in the sub-step for springs and constant forces (exact for the latter), first order for
/// dashpots: they act as if stronger by the factor 1 + γ dt / 2. The force of a window acts from
/// its first half kick on, so a free particle gains exactly F Δt / m.
///
/// Holds for the whole life of the engine: the particles, their materials and laws.
/// Throws ConfigError: two particles of one id, a radius or density that is not positive, a pair of
/// materials that can meet without a law, a sub-step longer than a tenth of the shortest contact
/// time, a period too short for the largest particle, a mesh that is no box. Its `advance` throws
/// NumericsError that names particle, place and sub-step if a particle leaves through an open side,
/// is pressed through a wall, is not finite, or moves by more than its radius in one sub-step; the
/// committed state is unharmed then, and `rollback` presents it again.
std::unique_ptr<ParticleEngine> make_native_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial);

}  // namespace fluxpact
