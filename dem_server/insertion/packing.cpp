#include "dem_server/insertion/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dem_server/backends/cell_grid.hpp"
#include "dem_server/insertion/random.hpp"

namespace fluxpact {
namespace {

struct Pair {
  int a = 0;
  int b = 0;
  int shift = Shift::none;
};

/// Spheres on their way to a packing, and the pairs that can overlap before one has moved by half a
/// skin.
struct Relaxation {
  Domain domain;
  double diameter = 0;  // [m]
  std::vector<Vector3> position;
  std::vector<int> sphere;  // number of each in the order of their start
  std::vector<Vector3> listed_at;
  std::vector<Pair> pairs;
  CellGrid grid;
  std::array<Vector3, 27> shifts;
  const Room* room = nullptr;
  std::vector<int> wall_first;     // of each sphere, into wall_elements; one more at the end
  std::vector<int> wall_elements;  // of room's walls
};

constexpr double skin_share = 0.25;  // of the diameter
// Aimed beyond contact, so that an overlap that is small enough is reached in finite time.
constexpr double margin = 0.5 * packing_overlap;
// Share of the overlap by which each of the two moves. More than half carries on through a crowd:
// 0.7 needs half the sweeps of 0.5 at fractions of 0.58 to 0.61, and 0.9 never comes to rest.
constexpr double push_share = 0.7;
constexpr int most_sweeps = 4000;

/// Visit what a sphere touches of the walls in the room.
template <class Visit>
void visit_walls(const Relaxation& state, int sphere, const Visit& visit) {
  if (state.room == nullptr) return;
  const int first = state.wall_first[sphere];
  const auto count = static_cast<std::size_t>(state.wall_first[sphere + 1] - first);
  if (count == 0) return;
  std::array<WallTouch, most_wall_touches> touches;
  const int met = state.room->walls().touches(state.position[sphere], 0.5 * state.diameter,
                                              {&state.wall_elements[first], count}, touches);
  for (int k = 0; k < met; ++k) visit(touches[static_cast<std::size_t>(k)]);
}

void keep_inside(Relaxation& state, int sphere) {
  const double radius = 0.5 * state.diameter;
  Vector3& position = state.position[sphere];
  visit_walls(state, sphere, [&](const WallTouch& touch) {
    position += ((1 + margin) * radius - touch.distance) * touch.normal;
  });
  for (int axis = 0; axis < 3; ++axis) {
    if (state.domain.periodic(axis)) continue;
    // In a box just one diameter thick rounding may turn the two limits round: the middle then.
    const double low = state.domain.lower[axis] + radius;
    const double high = std::max(low, state.domain.upper[axis] - radius);
    position[axis] = std::clamp(position[axis], low, high);
  }
}

/// A random place in every `cells`/`count`-th of at least `least` cells of about one shape.
void scatter_evenly(const Vector3& low, const Vector3& space, int least, int count,
                    UniformRandom& random, std::vector<Vector3>& places) {
  std::array<int, 3> cells{1, 1, 1};
  while (static_cast<double>(cells[0]) * cells[1] * cells[2] < least) {
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (space[axis] / cells[axis] > space[widest] / cells[widest]) widest = axis;
    }
    ++cells[widest];
  }
  const std::int64_t total = static_cast<std::int64_t>(cells[0]) * cells[1] * cells[2];
  for (int s = 0; s < count; ++s) {
    const std::int64_t cell = s * total / count;
    const std::array<std::int64_t, 3> at{cell % cells[0], cell / cells[0] % cells[1],
                                         cell / cells[0] / cells[1]};
    Vector3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = (static_cast<double>(at[axis]) + random.next()) / cells[axis];
      place[axis] = low[axis] + space[axis] * share;
    }
    places.push_back(place);
  }
}

/// `count` places evenly spread over the part of the space where a sphere fits; fewer if there is
/// next to none.
void scatter_in_room(const Room& room, const Vector3& low, const Vector3& space, int count,
                     double radius, UniformRandom& random, std::vector<Vector3>& places) {
  constexpr double most_tries = 1e8;
  std::vector<Vector3> fitting;
  for (double tries = count; tries < most_tries; tries *= 1.3) {
    std::vector<Vector3> tried;
    const int cells = static_cast<int>(tries);
    scatter_evenly(low, space, cells, cells, random, tried);
    fitting.clear();
    for (const Vector3& place : tried) {
      if (room.fits(place, radius)) fitting.push_back(place);
    }
    const auto found = static_cast<double>(fitting.size());
    if (found >= count) break;
    if (found > 0) tries = std::max(tries, 0.8 * tries * count / found);
    if (found == 0 && tries > 1e5 && tries > 100.0 * count) return;
  }
  const auto found = static_cast<std::int64_t>(fitting.size());
  if (found < count) return;
  for (std::int64_t s = 0; s < count; ++s) places.push_back(fitting[s * found / count]);
}

Relaxation scatter(const PackingBox& box, int count, double diameter, std::uint64_t seed) {
  Relaxation state;
  state.domain = {box.lower, box.upper, {}};
  for (int side = 0; side < 6; ++side) {
    state.domain.sides[side] = box.periodic[side / 2] ? SideKind::periodic : SideKind::wall;
  }
  state.diameter = diameter;
  state.shifts = shift_vectors(state.domain);
  state.room = box.room;
  // The space of the centres. In a room with walls only a part of the cells holds a sphere: cut it
  // finer until enough of them do.
  Vector3 low = box.lower;
  Vector3 space = box.upper - box.lower;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.periodic[axis]) continue;
    low[axis] += 0.5 * diameter;
    space[axis] = std::max(space[axis] - diameter, 0.0);
  }
  UniformRandom random(seed);
  if (box.room == nullptr) {
    scatter_evenly(low, space, count, count, random, state.position);
  } else {
    scatter_in_room(*box.room, low, space, count, 0.5 * diameter, random, state.position);
  }
  state.sphere.resize(state.position.size());
  std::iota(state.sphere.begin(), state.sphere.end(), 0);
  return state;
}

/// Spheres that a push took through a wall go back to where they came from; then what is near each.
void list_walls(Relaxation& state, const std::vector<Vector3>& came_from) {
  if (state.room == nullptr) return;
  // One sweep may move a sphere farther than the skin; the list is made anew after it.
  const double reach = 1.5 * state.diameter;
  state.wall_elements.clear();
  state.wall_first.assign(1, 0);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if (!came_from.empty() && state.room->clearance(state.position[i]) < 0) {
      state.position[i] = came_from[i];
    }
    state.room->walls().nearby(state.position[i], reach, {}, state.wall_elements);
    state.wall_first.push_back(static_cast<int>(state.wall_elements.size()));
  }
}

void list_pairs(Relaxation& state) {
  for (Vector3& position : state.position) position = wrapped(state.domain, position);
  const double cutoff = (1 + skin_share) * state.diameter;
  const int count = static_cast<int>(state.position.size());
  state.grid.sort(state.domain, cutoff, {state.position.front().data(), 3, count});
  std::vector<Vector3> position;
  std::vector<int> sphere;
  std::vector<Vector3> came_from;
  for (const int row : state.grid.order()) {
    position.push_back(state.position[row]);
    sphere.push_back(state.sphere[row]);
    if (!state.listed_at.empty()) came_from.push_back(state.listed_at[row]);
  }
  state.position = std::move(position);
  state.sphere = std::move(sphere);
  list_walls(state, came_from);
  state.listed_at = state.position;
  state.pairs.clear();
  for (int a = 0; a < count; ++a) {
    state.grid.visit_partners(a, [&](int b, int shift) {
      const Vector3 apart = state.position[b] + state.shifts[shift] - state.position[a];
      if (apart.squaredNorm() < cutoff * cutoff) state.pairs.push_back({a, b, shift});
    });
  }
}

/// Push each overlapping pair apart. Returns the largest overlap met [diameters].
double sweep(Relaxation& state) {
  const double aim = (1 + margin) * state.diameter;
  double largest = 0;
  for (const Pair& pair : state.pairs) {
    Vector3& a = state.position[pair.a];
    Vector3& b = state.position[pair.b];
    Vector3 apart = b + state.shifts[pair.shift] - a;
    const double square = apart.squaredNorm();
    if (square >= aim * aim) continue;
    const double distance = std::sqrt(square);
    largest = std::max(largest, 1 - distance / state.diameter);
    // Centres in one place have no direction: any fixed one will do.
    if (distance < 1e-12 * state.diameter) apart = Vector3::UnitX() * distance;
    const double push = push_share * (aim - distance) / std::max(distance, 1e-12 * state.diameter);
    a -= push * apart;
    b += push * apart;
    keep_inside(state, pair.a);
    keep_inside(state, pair.b);
  }
  return largest;
}

bool list_is_stale(const Relaxation& state) {
  const double reach = 0.5 * skin_share * state.diameter;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if ((state.position[i] - state.listed_at[i]).squaredNorm() > reach * reach) return true;
  }
  return false;
}

double largest_overlap(const Relaxation& state) {
  double largest = 0;
  for (const Pair& pair : state.pairs) {
    const Vector3 apart =
        state.position[pair.b] + state.shifts[pair.shift] - state.position[pair.a];
    largest = std::max(largest, 1 - apart.norm() / state.diameter);
  }
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    visit_walls(state, static_cast<int>(i), [&](const WallTouch& touch) {
      largest = std::max(largest, 0.5 - touch.distance / state.diameter);
    });
  }
  return largest;
}

/// Sweep until the largest overlap is small enough. False if that does not happen.
bool relax(Relaxation& state) {
  list_pairs(state);
  for (int s = 0; s < most_sweeps; ++s) {
    const double met = sweep(state);
    if (list_is_stale(state)) list_pairs(state);
    // What a sweep meets is not what it leaves: look again when it seems done.
    if (met <= packing_overlap && largest_overlap(state) <= packing_overlap) return true;
  }
  return false;
}

bool has_room(const PackingBox& box, double diameter) {
  for (int axis = 0; axis < 3; ++axis) {
    const double needed = box.periodic[axis] ? (1 + skin_share) * diameter : diameter;
    if (box.upper[axis] - box.lower[axis] < needed * (1 - 1e-12)) return false;
  }
  return true;
}

}  // namespace

std::optional<std::vector<Vector3>> random_packing(const PackingBox& box, int count,
                                                   double diameter, std::uint64_t seed) {
  const double fraction =
      count * std::numbers::pi / 6 * diameter * diameter * diameter / box.volume();
  // Denser than any packing of spheres (Hales 2005): not worth the sweeps.
  if (!has_room(box, diameter) || fraction > std::numbers::pi / std::sqrt(18.0)) return {};
  if (count == 0) return std::vector<Vector3>{};
  Relaxation state = scatter(box, count, diameter, seed);
  if (static_cast<int>(state.position.size()) < count) return {};
  if (!relax(state)) return {};
  std::vector<Vector3> centres(count);
  for (int i = 0; i < count; ++i) {
    centres[state.sphere[i]] = wrapped(state.domain, state.position[i]);
  }
  return centres;
}

int largest_packing(const PackingBox& box, int count, double diameter, std::uint64_t seed) {
  if (!has_room(box, diameter)) return 0;
  const double sphere = std::numbers::pi / 6 * diameter * diameter * diameter;
  // No random packing is denser than 0.64; below that, in steps that end after a few tries.
  int tried = std::min(count - 1, static_cast<int>(0.64 * box.volume() / sphere));
  while (tried > 1 && !random_packing(box, tried, diameter, seed)) {
    tried -= std::max(1, tried / 25);
  }
  return std::max(tried, 1);
}

}  // namespace fluxpact
