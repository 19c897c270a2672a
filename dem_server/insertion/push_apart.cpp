#include "dem_server/insertion/push_apart.hpp"

#include <algorithm>
#include <cmath>

#include "dem_server/backends/cell_grid.hpp"

namespace fluxpact {
namespace {

struct Pair {
  int a = 0;
  int b = 0;
  int shift = Shift::none;
};

constexpr double skin_share = 0.25;  // of the mean diameter
// Share of the overlap by which the two move in all. More than all of it carries on through a
// crowd: 1.4 needs half the sweeps of 1 at fractions of 0.58 to 0.61, and 1.8 never comes to rest.
constexpr double push_share = 1.4;
constexpr int most_sweeps = 4000;

/// Spheres on their way, and the pairs that can overlap before one has moved by half a skin.
struct Relaxation {
  const Domain& domain;
  double allowed = 0;
  double skin = 0;  // [m]
  double mean = 0;  // diameter [m]
  std::vector<Vector3> position;
  std::vector<double> diameter;  // [m]
  std::vector<int> sphere;       // number of each in the caller's order
  std::vector<Vector3> listed_at;
  std::vector<Pair> pairs;
  CellGrid grid;
  std::array<Vector3, 27> shifts;
  const Room* room = nullptr;
  std::vector<int> wall_first{};     // of each sphere, into wall_elements; one more at the end
  std::vector<int> wall_elements{};  // of the room's walls
};

/// Visit what a sphere touches of the walls in the room.
template <class Visit>
void visit_walls(const Relaxation& state, int sphere, const Visit& visit) {
  if (state.wall_first.empty()) return;
  const int first = state.wall_first[sphere];
  const auto count = static_cast<std::size_t>(state.wall_first[sphere + 1] - first);
  if (count == 0) return;
  std::array<WallTouch, most_wall_touches> touches;
  const int met = state.room->walls().touches(state.position[sphere], 0.5 * state.diameter[sphere],
                                              {&state.wall_elements[first], count}, touches);
  for (int k = 0; k < met; ++k) visit(touches[static_cast<std::size_t>(k)]);
}

void keep_inside(Relaxation& state, int sphere) {
  const double diameter = state.diameter[sphere];
  Vector3& position = state.position[sphere];
  visit_walls(state, sphere, [&](const WallTouch& touch) {
    const double aim = (0.5 + 0.25 * state.allowed) * diameter;
    position += (aim - touch.distance) * touch.normal;
  });
  for (int axis = 0; axis < 3; ++axis) {
    if (state.domain.periodic(axis)) continue;
    const int side = Domain::low_side(axis);
    const auto margin = [&](int s) {
      return state.domain.sides[s] == SideKind::wall ? 0.5 * diameter : 0.0;
    };
    // In a box just one diameter thick rounding may turn the two limits round: the middle then.
    const double low = state.domain.lower[axis] + margin(side);
    const double high = std::max(low, state.domain.upper[axis] - margin(side + 1));
    position[axis] = std::clamp(position[axis], low, high);
  }
}

template <class T>
void reorder(const std::vector<int>& order, std::vector<T>& values) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const int row : order) sorted.push_back(values[row]);
  values = std::move(sorted);
}

/// Spheres that a push took through a wall go back to where they came from; then what is near each.
void list_walls(Relaxation& state) {
  if (state.room == nullptr) return;
  const bool first_time = state.listed_at.empty();
  state.wall_elements.clear();
  state.wall_first.assign(1, 0);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if (!first_time && state.room->clearance(state.position[i]) < 0) {
      state.position[i] = state.listed_at[i];
    }
    // One sweep may move a sphere farther than the skin; the list is made anew after it.
    const double reach = 0.5 * state.diameter[i] + state.mean + state.skin;
    state.room->walls().nearby(state.position[i], reach, {}, state.wall_elements);
    state.wall_first.push_back(static_cast<int>(state.wall_elements.size()));
  }
}

void list_pairs(Relaxation& state) {
  for (Vector3& position : state.position) position = wrapped(state.domain, position);
  const int count = static_cast<int>(state.position.size());
  // Cells of about a mean diameter: a large sphere looks into many of them, the many small ones
  // into few.
  state.grid.sort(state.domain, state.mean + state.skin, {state.position.front().data(), 3, count});
  reorder(state.grid.order(), state.position);
  reorder(state.grid.order(), state.diameter);
  reorder(state.grid.order(), state.sphere);
  if (!state.listed_at.empty()) reorder(state.grid.order(), state.listed_at);
  list_walls(state);
  state.listed_at = state.position;
  state.pairs.clear();
  for (int a = 0; a < count; ++a) {
    const double size = state.diameter[a];
    const auto consider = [&](int b, int shift) {
      // Each pair from its larger sphere.
      if (state.diameter[b] > size || (state.diameter[b] == size && b <= a)) return;
      const Vector3 apart = state.position[b] + state.shifts[shift] - state.position[a];
      const double cutoff = 0.5 * (size + state.diameter[b]) + state.skin;
      if (apart.squaredNorm() < cutoff * cutoff) state.pairs.push_back({a, b, shift});
    };
    const double reach = size + state.skin;
    state.grid.visit_near(state.position[a].data(), reach, [&](int first, int last, int shift) {
      for (int b = first; b < last; ++b) consider(b, shift);
    });
  }
}

/// Push each sphere off the walls of the room, also where no other pushes it.
void push_off_walls(Relaxation& state) {
  if (state.wall_first.empty()) return;
  for (int i = 0; i < static_cast<int>(state.position.size()); ++i) {
    if (state.wall_first[i] < state.wall_first[i + 1]) keep_inside(state, i);
  }
}

/// Push each overlapping pair apart, and all off the walls. Returns the largest overlap met
/// [smaller diameters].
double sweep(Relaxation& state) {
  // Aimed beyond contact, so that an overlap that is small enough is reached in finite time.
  const double margin = 0.5 * state.allowed;
  double largest = 0;
  for (const Pair& pair : state.pairs) {
    Vector3& a = state.position[pair.a];
    Vector3& b = state.position[pair.b];
    const double size_a = state.diameter[pair.a];
    const double size_b = state.diameter[pair.b];
    const double smaller = std::min(size_a, size_b);
    const double contact = 0.5 * (size_a + size_b);
    const double aim = contact + margin * smaller;
    Vector3 apart = b + state.shifts[pair.shift] - a;
    const double square = apart.squaredNorm();
    if (square >= aim * aim) continue;
    const double distance = std::sqrt(square);
    largest = std::max(largest, (contact - distance) / smaller);
    // Centres in one place have no direction: any fixed one will do.
    if (distance < 1e-12 * smaller) apart = Vector3::UnitX() * distance;
    const double push = push_share * (aim - distance) / std::max(distance, 1e-12 * smaller);
    const double share = size_b / (size_a + size_b);
    a -= push * share * apart;
    b += push * (1 - share) * apart;
    keep_inside(state, pair.a);
    keep_inside(state, pair.b);
  }
  push_off_walls(state);
  return largest;
}

bool list_is_stale(const Relaxation& state) {
  const double reach = 0.5 * state.skin;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if ((state.position[i] - state.listed_at[i]).squaredNorm() > reach * reach) return true;
  }
  return false;
}

PushedApart largest_overlap(const Relaxation& state) {
  PushedApart worst;
  for (const Pair& pair : state.pairs) {
    const Vector3 apart =
        state.position[pair.b] + state.shifts[pair.shift] - state.position[pair.a];
    const double size_a = state.diameter[pair.a];
    const double size_b = state.diameter[pair.b];
    const double overlap = (0.5 * (size_a + size_b) - apart.norm()) / std::min(size_a, size_b);
    if (overlap <= worst.overlap) continue;
    worst = {false, overlap, state.sphere[pair.a], state.sphere[pair.b]};
  }
  for (int i = 0; i < static_cast<int>(state.position.size()); ++i) {
    visit_walls(state, i, [&](const WallTouch& touch) {
      const double overlap = 0.5 - touch.distance / state.diameter[i];
      if (overlap > worst.overlap) worst = {false, overlap, state.sphere[i], -1};
    });
  }
  worst.done = worst.overlap <= state.allowed;
  return worst;
}

}  // namespace

PushedApart push_apart(const Domain& domain, std::span<const double> diameters, double allowed,
                       std::vector<Vector3>& centres, const Room* room, const Progress& alive) {
  if (centres.empty()) return {true};
  Relaxation state{domain, allowed, 0, 0, centres, {}, {}, {}, {}, {}, shift_vectors(domain), room};
  state.diameter.assign(diameters.begin(), diameters.end());
  for (int i = 0; i < static_cast<int>(centres.size()); ++i) {
    state.sphere.push_back(i);
    state.mean += diameters[i] / static_cast<double>(centres.size());
    keep_inside(state, i);
  }
  state.skin = skin_share * state.mean;
  list_pairs(state);
  PushedApart result = largest_overlap(state);
  for (int s = 0; s < most_sweeps && !result.done; ++s) {
    if (alive) alive();
    const double met = sweep(state);
    if (list_is_stale(state)) list_pairs(state);
    // What a sweep meets is not what it leaves: look again when it seems done.
    if (met <= allowed || s + 1 == most_sweeps) result = largest_overlap(state);
  }
  for (std::size_t i = 0; i < centres.size(); ++i) {
    centres[state.sphere[i]] = wrapped(domain, state.position[i]);
  }
  return result;
}

}  // namespace fluxpact
