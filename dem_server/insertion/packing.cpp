#include "dem_server/insertion/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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
};

constexpr double skin_share = 0.25;  // of the diameter
// Aimed beyond contact, so that an overlap that is small enough is reached in finite time.
constexpr double margin = 0.5 * packing_overlap;
// Share of the overlap by which each of the two moves. More than half carries on through a crowd:
// 0.7 needs half the sweeps of 0.5 at fractions of 0.58 to 0.61, and 0.9 never comes to rest.
constexpr double push_share = 0.7;
constexpr int most_sweeps = 4000;

void keep_inside(const Relaxation& state, Vector3& position) {
  const double radius = 0.5 * state.diameter;
  for (int axis = 0; axis < 3; ++axis) {
    if (state.domain.periodic(axis)) continue;
    // In a box just one diameter thick rounding may turn the two limits round: the middle then.
    const double low = state.domain.lower[axis] + radius;
    const double high = std::max(low, state.domain.upper[axis] - radius);
    position[axis] = std::clamp(position[axis], low, high);
  }
}

Relaxation scatter(const PackingBox& box, int count, double diameter, std::uint64_t seed) {
  Relaxation state;
  state.domain = {box.lower, box.upper, {}};
  for (int side = 0; side < 6; ++side) {
    state.domain.sides[side] = box.periodic[side / 2] ? SideKind::periodic : SideKind::wall;
  }
  state.diameter = diameter;
  state.shifts = shift_vectors(state.domain);
  // The room of the centres, cut into at least `count` cells; every count/cells-th of them gets
  // one.
  Vector3 low = box.lower;
  Vector3 room = box.upper - box.lower;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.periodic[axis]) continue;
    low[axis] += 0.5 * diameter;
    room[axis] = std::max(room[axis] - diameter, 0.0);
  }
  std::array<int, 3> cells{1, 1, 1};
  while (static_cast<double>(cells[0]) * cells[1] * cells[2] < count) {
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (room[axis] / cells[axis] > room[widest] / cells[widest]) widest = axis;
    }
    ++cells[widest];
  }
  const std::int64_t total = static_cast<std::int64_t>(cells[0]) * cells[1] * cells[2];
  UniformRandom random(seed);
  for (int s = 0; s < count; ++s) {
    const std::int64_t cell = s * total / count;
    const std::array<std::int64_t, 3> at{cell % cells[0], cell / cells[0] % cells[1],
                                         cell / cells[0] / cells[1]};
    Vector3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = (static_cast<double>(at[axis]) + random.next()) / cells[axis];
      place[axis] = low[axis] + room[axis] * share;
    }
    state.position.push_back(place);
    state.sphere.push_back(s);
  }
  return state;
}

void list_pairs(Relaxation& state) {
  for (Vector3& position : state.position) position = wrapped(state.domain, position);
  const double cutoff = (1 + skin_share) * state.diameter;
  const int count = static_cast<int>(state.position.size());
  state.grid.sort(state.domain, cutoff, {state.position.front().data(), 3, count});
  std::vector<Vector3> position;
  std::vector<int> sphere;
  for (const int row : state.grid.order()) {
    position.push_back(state.position[row]);
    sphere.push_back(state.sphere[row]);
  }
  state.position = std::move(position);
  state.sphere = std::move(sphere);
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
    keep_inside(state, a);
    keep_inside(state, b);
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
