// The last look at the particles of a scene before they are handed to an engine.
#pragma once

#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/particle_engine.hpp"
#include "dem_server/walls/room.hpp"

namespace fluxpact {

/// Throws ConfigError that names entry, particle and place if a centre is outside the domain, a
/// particle sticks out of a side that is not periodic, or into another particle, by more than 10 %
/// of the (smaller) diameter. `entry` [-] is the number, from 1, of the insertion entry of each
/// particle.
void check_placement(const ParticleState& particles, const std::vector<int>& entry,
                     const Domain& domain);

/// Likewise if a particle is on the wrong side of a wall in the room, or sticks into it by more
/// than 10 % of its diameter.
void check_walls(const ParticleState& particles, const std::vector<int>& entry, const Room& room);

}  // namespace fluxpact
