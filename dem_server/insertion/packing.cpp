#include "dem_server/insertion/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem_server/insertion/push_apart.hpp"
#include "dem_server/insertion/random.hpp"

namespace fluxpact {
namespace {

Domain domain_of(const PackingBox& box) {
  Domain domain{box.lower, box.upper, {}, {}};
  for (int side = 0; side < 6; ++side) {
    domain.sides[side] = box.periodic[side / 2] ? SideKind::periodic : SideKind::wall;
  }
  return domain;
}

/// One random place in each of about as many equal cells as there are spheres.
std::vector<Vector3> scatter(const PackingBox& box, std::span<const double> diameters,
                             std::uint64_t seed) {
  const auto count = static_cast<std::int64_t>(diameters.size());
  // The room of the centres, cut into at least `count` cells; every count/cells-th of them gets
  // one.
  Vector3 low = box.lower;
  Vector3 room = box.upper - box.lower;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.periodic[axis]) continue;
    const double smallest = *std::min_element(diameters.begin(), diameters.end());
    low[axis] += 0.5 * smallest;
    room[axis] = std::max(room[axis] - smallest, 0.0);
  }
  std::array<int, 3> cells{1, 1, 1};
  while (static_cast<double>(cells[0]) * cells[1] * cells[2] < static_cast<double>(count)) {
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (room[axis] / cells[axis] > room[widest] / cells[widest]) widest = axis;
    }
    ++cells[widest];
  }
  const std::int64_t total = static_cast<std::int64_t>(cells[0]) * cells[1] * cells[2];
  UniformRandom random(seed);
  std::vector<Vector3> centres;
  for (std::int64_t s = 0; s < count; ++s) {
    const std::int64_t cell = s * total / count;
    const std::array<std::int64_t, 3> at{cell % cells[0], cell / cells[0] % cells[1],
                                         cell / cells[0] / cells[1]};
    Vector3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = (static_cast<double>(at[axis]) + random.next()) / cells[axis];
      place[axis] = low[axis] + room[axis] * share;
    }
    centres.push_back(place);
  }
  return centres;
}

bool has_room(const PackingBox& box, double diameter) {
  for (int axis = 0; axis < 3; ++axis) {
    // An image must stay out of reach of the list of pairs.
    const double needed = box.periodic[axis] ? 1.25 * diameter : diameter;
    if (box.upper[axis] - box.lower[axis] < needed * (1 - 1e-12)) return false;
  }
  return true;
}

double volume_of(std::span<const double> diameters) {
  double cubes = 0;
  for (const double diameter : diameters) cubes += diameter * diameter * diameter;
  return std::numbers::pi / 6 * cubes;
}

}  // namespace

std::optional<std::vector<Vector3>> random_packing(const PackingBox& box,
                                                   std::span<const double> diameters,
                                                   std::uint64_t seed) {
  if (diameters.empty()) return std::vector<Vector3>{};
  const auto [smallest, largest] = std::minmax_element(diameters.begin(), diameters.end());
  // Equal spheres are never denser (Hales 2005), and two sizes of up to 10:1 hardly than this: not
  // worth the sweeps.
  const double densest = *smallest == *largest ? std::numbers::pi / std::sqrt(18.0) : 0.9;
  if (!has_room(box, *largest) || volume_of(diameters) > densest * box.volume()) return {};
  std::vector<Vector3> centres = scatter(box, diameters, seed);
  if (!push_apart(domain_of(box), diameters, packing_overlap, centres).done) return {};
  return centres;
}

int largest_packing(const PackingBox& box, std::span<const double> diameters, std::uint64_t seed) {
  if (diameters.empty() || !has_room(box, *std::max_element(diameters.begin(), diameters.end()))) {
    return 0;
  }
  // No random packing of equal spheres is denser than 0.64; below that, in steps that end after a
  // few tries.
  const double share = 0.64 * box.volume() / volume_of(diameters);
  int tried = static_cast<int>(static_cast<double>(diameters.size()) * std::min(share, 1.0));
  tried = std::min(tried, static_cast<int>(diameters.size()) - 1);
  while (tried > 1 && !random_packing(box, diameters.first(tried), seed)) {
    tried -= std::max(1, tried / 25);
  }
  return std::max(tried, 1);
}

}  // namespace fluxpact
