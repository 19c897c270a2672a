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

/// A random place in every `cells`/`count`-th of at least `count` cells of about one shape.
std::vector<Vector3> scatter_evenly(const Vector3& low, const Vector3& space, std::int64_t count,
                                    UniformRandom& random) {
  std::array<int, 3> cells{1, 1, 1};
  while (static_cast<double>(cells[0]) * cells[1] * cells[2] < static_cast<double>(count)) {
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (space[axis] / cells[axis] > space[widest] / cells[widest]) widest = axis;
    }
    ++cells[widest];
  }
  const std::int64_t total = static_cast<std::int64_t>(cells[0]) * cells[1] * cells[2];
  std::vector<Vector3> centres;
  for (std::int64_t s = 0; s < count; ++s) {
    const std::int64_t cell = s * total / count;
    const std::array<std::int64_t, 3> at{cell % cells[0], cell / cells[0] % cells[1],
                                         cell / cells[0] / cells[1]};
    Vector3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = (static_cast<double>(at[axis]) + random.next()) / cells[axis];
      place[axis] = low[axis] + space[axis] * share;
    }
    centres.push_back(place);
  }
  return centres;
}

/// `count` places evenly spread over the part of the space where a sphere fits; none if there is
/// next to no such part.
std::vector<Vector3> scatter_in_room(const Room& room, const Vector3& low, const Vector3& space,
                                     std::int64_t count, double radius, UniformRandom& random) {
  constexpr double most_tries = 1e8;
  std::vector<Vector3> fitting;
  double tries = static_cast<double>(count);
  while (tries < most_tries) {
    fitting = scatter_evenly(low, space, static_cast<std::int64_t>(tries), random);
    std::erase_if(fitting, [&](const Vector3& place) { return !room.fits(place, radius); });
    const auto found = static_cast<double>(fitting.size());
    if (found >= static_cast<double>(count)) break;
    if (found == 0 && tries > 1e5) return {};
    tries *= found > 0 ? std::max(1.3, 1.04 * static_cast<double>(count) / found) : 4.0;
  }
  const auto found = static_cast<std::int64_t>(fitting.size());
  if (found < count) return {};
  std::vector<Vector3> centres;
  for (std::int64_t s = 0; s < count; ++s) centres.push_back(fitting[s * found / count]);
  return centres;
}

/// One random place in each of about as many equal cells as there are spheres; nothing if the walls
/// in the box leave none.
std::vector<Vector3> scatter(const PackingBox& box, std::span<const double> diameters,
                             std::uint64_t seed) {
  const auto count = static_cast<std::int64_t>(diameters.size());
  const double smallest = *std::min_element(diameters.begin(), diameters.end());
  Vector3 low = box.lower;
  Vector3 space = box.upper - box.lower;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.periodic[axis]) continue;
    low[axis] += 0.5 * smallest;
    space[axis] = std::max(space[axis] - smallest, 0.0);
  }
  UniformRandom random(seed);
  if (box.room == nullptr) return scatter_evenly(low, space, count, random);
  return scatter_in_room(*box.room, low, space, count, 0.5 * smallest, random);
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
  if (centres.empty()) return {};
  if (!push_apart(domain_of(box), diameters, packing_overlap, centres, box.room).done) return {};
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
