// The box that an entry of particles.insertion or particles.inflow fills.
#pragma once

#include <string>

#include "dem_server/insertion/packing.hpp"

namespace fluxpact {

/// `within` where given, else the domain. An axis stays periodic if all of its length is in the
/// box. Throws ConfigError that names the `entry` if a range is empty or reaches out of the domain.
PackingBox entry_box(const std::string& entry, const Region& within, const Domain& domain);

}  // namespace fluxpact
