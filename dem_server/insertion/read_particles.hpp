// Particles read from a file: CSV, HDF5, or a text dump of LAMMPS or LIGGGHTS. SI units.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// One particle of a file.
struct ListedParticle {
  Vector3 position;                    ///< [m]
  Vector3 velocity = Vector3::Zero();  ///< [m/s]
  Vector3 spin = Vector3::Zero();      ///< [rad/s]
  std::optional<double> diameter;      ///< [m]
};

/// The particles of a file, whose kind is told from its first bytes:
/// - HDF5: datasets x, y, z [vx, vy, vz] [wx, wy, wz] [radius | diameter] of equal length, or
///   position, velocity, spin, radius as in our own records. They stand in `group`; without it at
///   the top, or in the last record of /particles.
/// - text dump (`ITEM: TIMESTEP` ...): the last frame, in the order of its ids; columns id, x, y, z
/// (or
///   xu, yu, zu), [vx, vy, vz], [omegax, omegay, omegaz], [radius | diameter], others are left out.
/// - CSV: a header line of x, y, z, [vx, vy, vz], [wx, wy, wz], [radius | diameter], in any order.
/// Throws ConfigError `path:line:column: ...`, of HDF5 `path: dataset: ...`, for anything else.
std::vector<ListedParticle> read_particles(const std::string& path, const std::string& group = {});

}  // namespace fluxpact
