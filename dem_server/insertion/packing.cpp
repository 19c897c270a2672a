#include "dem_server/insertion/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

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

/// A place in a room, and the largest sphere that is clear of the walls there.
struct Opening {
  Vector3 place;
  double radius = 0;  // [m]
  bool taken = false;

  bool suits(double diameter) const { return !taken && radius >= 0.5 * diameter * (1 - 1e-9); }
};

/// An opening for each sphere, spread evenly over them all; the largest spheres choose first, so
/// that all find one if there is a way. Nothing if not.
std::vector<Vector3> choose(std::vector<Opening>& openings, std::span<const double> diameters) {
  const auto found = static_cast<std::int64_t>(openings.size());
  const auto count = static_cast<std::int64_t>(diameters.size());
  std::vector<std::int64_t> order(diameters.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int64_t a, std::int64_t b) { return diameters[a] > diameters[b]; });
  std::vector<Vector3> places(diameters.size());
  for (const std::int64_t sphere : order) {
    std::int64_t at = sphere * found / count;
    std::int64_t looked = 0;
    for (; looked < found && !openings[at].suits(diameters[sphere]); ++looked) {
      at = (at + 1) % found;
    }
    if (looked == found) return {};
    openings[at].taken = true;
    places[sphere] = openings[at].place;
  }
  return places;
}

/// A place for each sphere, evenly spread over the part of the space where it is clear of the
/// walls; none if there is next to no such part. The space is cut finer until there are enough.
std::vector<Vector3> scatter_in_room(const Room& room, const Vector3& low, const Vector3& space,
                                     std::span<const double> diameters, UniformRandom& random) {
  constexpr double most_tries = 1e8;
  const auto count = static_cast<double>(diameters.size());
  const auto [smallest, largest] = std::minmax_element(diameters.begin(), diameters.end());
  double tries = count;
  while (tries < most_tries) {
    std::vector<Opening> openings;
    bool any_for_largest = false;
    for (const Vector3& place :
         scatter_evenly(low, space, static_cast<std::int64_t>(tries), random)) {
      const Opening opening{place, room.clearance(place)};
      if (opening.suits(*smallest)) openings.push_back(opening);
      any_for_largest = any_for_largest || opening.suits(*largest);
    }
    const auto found = static_cast<double>(openings.size());
    if (found >= count) {
      std::vector<Vector3> places = choose(openings, diameters);
      if (!places.empty()) return places;
    }
    if (!any_for_largest && tries > 1e5) return {};
    tries *= found > 0 ? std::max(1.3, 1.04 * count / found) : 4.0;
  }
  return {};
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
  return scatter_in_room(*box.room, low, space, diameters, random);
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
  if (!push_apart(domain_of(box), diameters, packing_overlap, centres, box.room, box.alive).done)
    return {};
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
