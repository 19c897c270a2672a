// A random packing of spheres in a box.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/walls/room.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

/// The box that holds the spheres: wholly inside each hard side, through the periodic ones.
struct PackingBox {
  Vector3 lower;  ///< [m]
  Vector3 upper;  ///< [m]
  std::array<bool, 3> periodic{};
  const Room* room = nullptr;  ///< the walls within the box that hold them, too; nullptr: none
  Progress alive{};            ///< called now and then: a dense packing may take a while

  double volume() const { return (upper - lower).prod(); }
};

/// Overlap [diameters] that may be left between two spheres of a packing.
inline constexpr double packing_overlap = 1e-3;

/// Centres [m] of spheres of these diameters [m] at random places without overlap of more than
/// `packing_overlap` of the smaller one; nothing if they do not fit. The same bits for the same
/// arguments.
///
/// Starts from one random place in each of about as many equal cells, so that the density is even
/// at once, and pushes overlapping pairs apart (push_apart). Finds packings of equal spheres of up
/// to about 0.62, between walls 20 diameters apart 0.60, in narrower boxes less.
std::optional<std::vector<Vector3>> random_packing(const PackingBox& box,
                                                   std::span<const double> diameters,
                                                   std::uint64_t seed);

/// The same of `count` spheres of one diameter [m].
inline std::optional<std::vector<Vector3>> random_packing(const PackingBox& box, int count,
                                                          double diameter, std::uint64_t seed) {
  return random_packing(box, std::vector<double>(static_cast<std::size_t>(count), diameter), seed);
}

/// How many of the spheres, from the first, `random_packing` was seen to pack, found downwards from
/// all of them, which it could not.
int largest_packing(const PackingBox& box, std::span<const double> diameters, std::uint64_t seed);
inline int largest_packing(const PackingBox& box, int count, double diameter, std::uint64_t seed) {
  return largest_packing(box, std::vector<double>(static_cast<std::size_t>(count), diameter), seed);
}

}  // namespace fluxpact
