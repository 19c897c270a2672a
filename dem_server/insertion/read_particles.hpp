// Particles listed in a CSV file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// One line of the file.
struct ListedParticle {
  Vector3 position;                    ///< [m]
  Vector3 velocity = Vector3::Zero();  ///< [m/s]
  std::optional<double> diameter;      ///< [m]
};

/// Read a CSV file whose header names x, y, z and, if given, vx, vy, vz (all three) and diameter,
/// in any order. Empty lines are skipped. Throws ConfigError `path:line: ...` for anything else.
std::vector<ListedParticle> read_particles(const std::string& path);

}  // namespace fluxpact
