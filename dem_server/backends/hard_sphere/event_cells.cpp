#include "dem_server/backends/hard_sphere/event_cells.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {
namespace {

/// Cells are wider than the largest sphere by this share, and what is sought is farther: rounding
/// of a place must not hide a neighbour.
constexpr double slack = 1e-9;

constexpr int most_levels = 16;

}  // namespace

void EventCells::lay_out(const Domain& domain, const Vector3& lower, const Vector3& upper,
                         Level& level) const {
  // A few spheres far apart must not ask for billions of cells: coarser cells are still right.
  const double most_cells = 64.0 + 4.0 * level.spheres;
  double edge = 2 * level.largest_radius * (1 + slack);
  std::array<double, 3> count{};
  std::array<double, 3> extent{};
  for (int axis = 0; axis < 3; ++axis) {
    level.lower[axis] = periodic_[axis] ? domain.lower[axis] : lower[axis];
    extent[axis] = periodic_[axis] ? domain.length(axis) : upper[axis] - lower[axis];
  }
  while (true) {
    for (int axis = 0; axis < 3; ++axis) {
      count[axis] = std::max(1.0, std::floor(extent[axis] / edge));
    }
    if (count[0] * count[1] * count[2] <= most_cells) break;
    edge *= 1.26;
  }
  for (int axis = 0; axis < 3; ++axis) {
    level.cells[axis] = static_cast<int>(count[axis]);
    level.edge[axis] = extent[axis] / count[axis];
  }
}

void EventCells::sort(const Domain& domain, std::span<const Vector3> position,
                      std::span<const double> radius) {
  const std::size_t count = position.size();
  levels_.clear();
  first_of_cell_.clear();
  next_.resize(count);
  previous_.resize(count);
  cell_of_.resize(count);
  level_of_.resize(count);
  if (count == 0) return;
  for (int axis = 0; axis < 3; ++axis) periodic_[axis] = domain.periodic(axis);
  Vector3 lower = position.front();
  Vector3 upper = lower;
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    lower = lower.cwiseMin(position[i]);
    upper = upper.cwiseMax(position[i]);
    largest = std::max(largest, radius[i]);
  }
  std::array<Level, most_levels> levels{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto finer = static_cast<std::size_t>(std::log2(largest / radius[i]));
    const std::size_t level = std::min<std::size_t>(finer, most_levels - 1);
    level_of_[i] = static_cast<std::uint8_t>(level);
    levels[level].largest_radius = std::max(levels[level].largest_radius, radius[i]);
    ++levels[level].spheres;
  }
  std::array<std::uint8_t, most_levels> used{};
  int cells = 0;
  for (std::size_t k = 0; k < most_levels; ++k) {
    Level& level = levels[k];
    if (level.spheres == 0) continue;
    lay_out(domain, lower, upper, level);
    level.first = cells;
    cells += level.cells[0] * level.cells[1] * level.cells[2];
    used[k] = static_cast<std::uint8_t>(levels_.size());
    levels_.push_back(level);
  }
  first_of_cell_.assign(static_cast<std::size_t>(cells), -1);
  for (std::size_t i = count; i-- > 0;) {  // so that each cell lists its spheres in their order
    level_of_[i] = used[level_of_[i]];
    const Level& level = levels_[level_of_[i]];
    for (int axis = 0; axis < 3; ++axis) {
      const double at =
          level.edge[axis] > 0 ? (position[i][axis] - level.lower[axis]) / level.edge[axis] : 0;
      cell_of_[i][axis] = std::clamp(static_cast<int>(at), 0, level.cells[axis] - 1);
    }
    put_in(static_cast<int>(i));
  }
}

void EventCells::put_in(int sphere) {
  int& first = first_of_cell_[index(levels_[level_of_[sphere]], cell_of_[sphere])];
  next_[sphere] = first;
  previous_[sphere] = -1;
  if (first >= 0) previous_[first] = sphere;
  first = sphere;
}

void EventCells::take_out(int sphere) {
  const int before = previous_[sphere];
  const int after = next_[sphere];
  if (before >= 0) next_[before] = after;
  if (after >= 0) previous_[after] = before;
  if (before < 0) {
    first_of_cell_[index(levels_[level_of_[sphere]], cell_of_[sphere])] = after;
  }
}

EventCells::Bounds EventCells::bounds(int sphere) const {
  const Level& level = levels_[level_of_[sphere]];
  const Cell& cell = cell_of_[sphere];
  Bounds bounds{};
  for (int axis = 0; axis < 3; ++axis) {
    const bool first = !periodic_[axis] && cell[axis] == 0;
    const bool last = !periodic_[axis] && cell[axis] == level.cells[axis] - 1;
    bounds.lower[axis] = first ? -INFINITY : face(level, axis, cell[axis]);
    bounds.upper[axis] = last ? INFINITY : face(level, axis, cell[axis] + 1);
  }
  return bounds;
}

int EventCells::cross(int sphere, int axis, int direction) {
  take_out(sphere);
  const WrappedCell next =
      wrapped_cell(cell_of_[sphere][axis] + direction, levels_[level_of_[sphere]].cells[axis]);
  cell_of_[sphere][axis] = next.cell;
  put_in(sphere);
  return -next.period;
}

/// The cells of a level, as if they went on beyond the ends of a period, that are nearer than
/// touching to the cell of a sphere.
void EventCells::reach_of(int sphere, const Level& other, Cell& from, Cell& to) const {
  const Level& own = levels_[level_of_[sphere]];
  const Cell& cell = cell_of_[sphere];
  const bool same = &own == &other;
  const double reach = (own.largest_radius + other.largest_radius) * (1 + slack);
  for (int axis = 0; axis < 3; ++axis) {
    const int last = other.cells[axis] - 1;
    const bool periodic = periodic_[axis];
    if (same) {
      from[axis] = cell[axis] - 1;
      to[axis] = cell[axis] + 1;
    } else if (last == 0 && !periodic) {
      from[axis] = to[axis] = 0;
    } else {
      const double low = face(own, axis, cell[axis]) - reach - other.lower[axis];
      const double high = face(own, axis, cell[axis] + 1) + reach - other.lower[axis];
      from[axis] = static_cast<int>(std::floor(low / other.edge[axis] - slack));
      to[axis] = static_cast<int>(std::floor(high / other.edge[axis] + slack));
    }
    if (periodic) continue;
    // Who is in an outermost cell may be anywhere beyond it.
    if (!same && cell[axis] == 0) from[axis] = 0;
    if (!same && cell[axis] == own.cells[axis] - 1) to[axis] = last;
    from[axis] = std::clamp(from[axis], 0, last);
    to[axis] = std::clamp(to[axis], 0, last);
  }
}

}  // namespace fluxpact
