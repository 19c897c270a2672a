// A random packing of equal spheres in a box.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/walls/room.hpp"

namespace fluxpact {

/// The box that holds the spheres: wholly inside each hard side, through the periodic ones.
struct PackingBox {
  Vector3 lower;  ///< [m]
  Vector3 upper;  ///< [m]
  std::array<bool, 3> periodic{};
  const Room* room = nullptr;  ///< the walls within the box that hold them, too; nullptr: none

  double volume() const { return (upper - lower).prod(); }
};

/// Overlap [diameters] that may be left between two spheres of a packing.
inline constexpr double packing_overlap = 1e-3;

/// Centres [m] of `count` spheres of one diameter [m] at random places without overlap of more than
/// `packing_overlap`; nothing if they do not fit. The same bits for the same arguments.
///
/// Starts from one random place in each of about `count` equal cells, so that the density is even
/// at once, and pushes overlapping pairs apart, one after another, until none is left (the
/// projection of Jakobsen, "Advanced character physics", GDC 2001, section 3, over-relaxed and
/// without velocities). Finds packings of up to about 0.62, between walls 20 diameters apart 0.60,
/// in narrower boxes less. Walls of a Room push likewise.
std::optional<std::vector<Vector3>> random_packing(const PackingBox& box, int count,
                                                   double diameter, std::uint64_t seed);

/// The largest count that `random_packing` was seen to pack, found downwards from `count`, which it
/// could not.
int largest_packing(const PackingBox& box, int count, double diameter, std::uint64_t seed);

}  // namespace fluxpact
