#include "dem_server/backends/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fluxpact {

std::array<Vector3, 27> shift_vectors(const Domain& domain) {
  std::array<Vector3, 27> vectors;
  for (int code = 0; code < 27; ++code) {
    const std::array<int, 3> periods = Shift::periods(code);
    for (int axis = 0; axis < 3; ++axis) vectors[code][axis] = periods[axis] * domain.length(axis);
  }
  return vectors;
}

void CellGrid::lay_out(const Domain& domain, double cutoff, PositionRows positions) {
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 upper = -lower;
  for (int row = 0; row < positions.size; ++row) {
    const Eigen::Map<const Vector3> at(positions[row]);
    lower = lower.cwiseMin(at);
    upper = upper.cwiseMax(at);
  }
  for (int axis = 0; axis < 3; ++axis) {
    periodic_[axis] = domain.periodic(axis);
    if (periodic_[axis]) {
      lower[axis] = domain.lower[axis];
      upper[axis] = domain.upper[axis];
    }
  }
  const Vector3 extent = upper - lower;
  // A few particles far apart must not ask for billions of cells: coarser cells are still right.
  const double most_cells = 64.0 + 4.0 * positions.size;
  double edge = cutoff;
  std::array<double, 3> count{};
  while (true) {
    for (int axis = 0; axis < 3; ++axis)
      count[axis] = std::max(1.0, std::floor(extent[axis] / edge));
    if (count[0] * count[1] * count[2] <= most_cells) break;
    edge *= 1.26;
  }
  for (int axis = 0; axis < 3; ++axis) {
    cells_[axis] = static_cast<int>(count[axis]);
    lower_[axis] = lower[axis];
    cells_per_metre_[axis] = extent[axis] > 0 ? count[axis] / extent[axis] : 0.0;
  }
}

int CellGrid::cell_of(const double* position) const {
  int index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    index += std::clamp(cell_along(axis, position[axis]), 0, cells_[axis] - 1) * strides_[axis];
  }
  return index;
}

void CellGrid::sort(const Domain& domain, double cutoff, PositionRows positions) {
  order_.resize(positions.size);
  if (positions.size == 0) return;
  lay_out(domain, cutoff, positions);
  // The axis with the fewest cells runs fastest, so that adjacent cells are near in memory.
  axes_ = {0, 1, 2};
  std::sort(axes_.begin(), axes_.end(), [&](int a, int b) {  // a stable sort would take memory
    return cells_[a] < cells_[b] || (cells_[a] == cells_[b] && a < b);
  });
  strides_[axes_[0]] = 1;
  strides_[axes_[1]] = cells_[axes_[0]];
  strides_[axes_[2]] = cells_[axes_[0]] * cells_[axes_[1]];

  // Ends of the cells, which go back to the firsts as the cells are filled from behind. (A cell is
  // found twice: to note it would take as much memory as the order.)
  first_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2] + 1, 0);
  for (int row = 0; row < positions.size; ++row) ++first_[cell_of(positions[row])];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  for (int row = positions.size - 1; row >= 0; --row) {
    order_[--first_[cell_of(positions[row])]] = row;
  }
}

}  // namespace fluxpact
