// The event-driven engine: hard spheres that collide at an instant with restitution and friction,
// and fly on parabolas in between. How it takes a window: hard_spheres.hpp; one collision:
// collision.hpp; the exact times: flight.hpp.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Runs in one thread. A window is taken as a whole under constant forces; its `sub_steps` give the
/// time of a contact (hard_spheres.hpp) alone. Positions and times are exact to round-off whatever
/// they are.
///
/// Throws ConfigError for particles that are not sound (checked_rows), overlap by more than 10 % of
/// the distance at which they touch, or could meet their own image, and for pairs of materials that
/// CollisionLaws refuses. `advance` throws NumericsError that names the particle which gets lost
/// through an open side, collides without end, or has a force that is not finite; `rollback`
/// presents the committed state again.
std::unique_ptr<ParticleEngine> make_hard_sphere_engine(const Scene& scene, const Mesh& mesh,
                                                        ParticleState initial);

}  // namespace fluxpact
