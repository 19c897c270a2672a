// The native soft-sphere engine: contacts by springs and dashpots, velocity-Verlet, any number of
// threads with the same bits.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Contact laws: contact_force-inl.hpp. Walls: the sides of the domain (domain.hpp) and the
/// surfaces (dem_server/walls). Motion: velocity-Verlet whose contact forces see the velocity half
/// a sub-step behind the position, as LAMMPS' granular styles do. Second order in the sub-step for
/// springs and constant forces (exact for the latter), first order for dashpots: they act as if
/// stronger by the factor 1 + γ dt / 2. The force of a window acts from its first half kick on, so
/// a free particle gains exactly F Δt / m.
///
/// Precision: particles.numerics.precision; what is frictionless follows no spins. The instruction
/// set is the widest that the processor has; the same bits for any number of threads.
///
/// Holds for the whole life of the engine: materials and laws; particles come and go by `exchange`.
/// Throws ConfigError: two particles of one id, a radius or density that is not positive, a pair of
/// materials that can meet without a law, a sub-step longer than the contacts allow
/// (step_limit.hpp), a period too short for the largest particle, more than 15 materials. Its
/// `advance` throws NumericsError that names particle, place and sub-step if a particle gets lost
/// (through an open side that lets none out, a wall or a surface), is not finite, or moves by more
/// than its radius in one sub-step; the committed state is unharmed then, and `rollback` presents
/// it again.
std::unique_ptr<ParticleEngine> make_native_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial);

}  // namespace fluxpact
