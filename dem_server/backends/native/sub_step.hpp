// One sub-step of the native engine: velocity-Verlet in two passes over blocks of particles.
//
//   move     v += dt a, x += dt v        (with reactions gathered from other blocks; first step:
//   dt/2) contact  loads at the new positions, with the velocity half a step behind
//
// and at the end of the window `settle` completes the last half step. Each pass touches only what
// its block owns, plus its own part of the outbox.
#pragma once

#include <span>
#include <vector>

#include "dem_server/backends/native/contact_list.hpp"
#include "dem_server/backends/native/spheres.hpp"

namespace fluxpact {

/// What a pass reads beside the spheres.
struct StepContext {
  const Blocks& blocks;
  const ContactLaws& laws;
  const Domain& domain;
  std::span<const Vector3> drive;  ///< [m/s²] gravity and the constant force over the mass
  const Vector3* shifts;  ///< [m] displacement of each Shift; nullptr if nothing is periodic
  bool friction;
  int threads;
};

/// Which half steps a `move` makes of the velocity before it moves the positions.
enum class Kick { half, full };

/// Kick, then drift by `time_step` [s]. `half` starts a window: the loads are complete then; `full`
/// adds what waits in the outbox. Returns true if some particle is farther than `reach` [m] from
/// where the list was made (or not finite).
bool move(const StepContext& context, Kick kick, double time_step, double reach,
          const ContactList& list, std::span<const Load> outbox, Spheres& spheres);

/// Loads of all contacts: those within a block complete, the rest into the outbox. Tangential
/// springs grow over `time_step` [s].
void add_contacts(const StepContext& context, double time_step, ContactList& list,
                  std::span<Load> outbox, Spheres& spheres);

/// Gather the outbox into the loads, then a last kick of half a `time_step` [s]: positions and
/// velocities are at the same time then.
void settle(const StepContext& context, double time_step, const ContactList& list,
            std::span<const Load> outbox, Spheres& spheres);

}  // namespace fluxpact
