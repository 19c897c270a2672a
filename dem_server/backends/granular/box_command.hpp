// The box of the library: in words that LAMMPS and LIGGGHTS both take.
#pragma once

#include <string>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

struct BoxCommands {
  std::string boundary;
  std::string processors;  ///< how ranks share space
  std::string region;
  std::string neighbor;  ///< the skin of its list
};

/// The box holds whatever touches a wall, and what flies out through an open side in one window.
/// Ranks share it across gravity [m/s²]: along it beds fill the lower part only.
BoxCommands box_commands(const Domain& domain, const Vector3& gravity,
                         const ParticleState& spheres);

}  // namespace fluxpact
