// Spheres sorted into cells, and the visit of all pairs that may be near each other, each once.
// Behind the contact list of the native engine and the packing and overlap check of the insertion.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/domain.hpp"

namespace fluxpact {

/// Positions at a fixed stride: the first three of every `stride` doubles.
struct PositionRows {
  const double* data = nullptr;
  int stride = 3;
  int size = 0;
  const double* operator[](int row) const {
    return data + static_cast<std::ptrdiff_t>(row) * stride;
  }
};

/// Periods to add to a position so that it becomes the image which a neighbour sees: -1, 0, 1 in
/// each axis, in one number 0 ... 26; 13 is no shift.
struct Shift {
  static constexpr int none = 13;
  static int code(int x, int y, int z) { return (x + 1) * 9 + (y + 1) * 3 + (z + 1); }
  static std::array<int, 3> periods(int code) {
    return {code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1};
  }
};

/// Displacement [m] of each of the 27 shifts in a domain.
std::array<Vector3, 27> shift_vectors(const Domain& domain);

/// Cells of a size at which two particles nearer than the cutoff lie in the same or adjacent cells.
/// Along a periodic axis the cells fill the period; elsewhere they cover what the particles cover.
class CellGrid {
 public:
  /// Sort positions (wrapped in periodic axes) into cells of at least `cutoff` [m].
  void sort(const Domain& domain, double cutoff, PositionRows positions);

  /// order()[k] is the row of the k-th particle in cell order; stable within a cell.
  const std::vector<int>& order() const { return order_; }

  /// Calls visit(first, last, shift) with ranges of places [first, last) that hold all particles
  /// which, moved by the shift, may be nearer than `reach` [m] to `position` (wrapped; it may lie
  /// beyond the cells). Each place and shift comes once. `reach` is at most the shortest period.
  template <class Visit>
  void visit_near(const double* position, double reach, const Visit& visit) const;

  /// For the particle at place k of the cell order: calls visit(other, shift) with each place whose
  /// particle (moved by the shift) may be nearer than the cutoff. Every pair, with every image,
  /// comes once over all k. A particle is never paired with its own image.
  template <class Visit>
  void visit_partners(int place, const Visit& visit) const;

 private:
  using Cell = std::array<int, 3>;
  void lay_out(const Domain& domain, double cutoff, PositionRows positions);
  /// Cell that holds a position.
  int cell_of(const double* position) const;
  /// Cell along an axis that holds a coordinate, as if the cells went on beyond their ends.
  int cell_along(int axis, double coordinate) const;
  template <class Visit>
  void visit_cells(const Cell& from, const Cell& to, const Visit& visit) const;

  Cell cells_{1, 1, 1};
  Cell strides_{1, 1, 1};
  Cell axes_{0, 1, 2};  // the axis along which cells lie next to each other in memory comes first
  std::array<bool, 3> periodic_{};
  Vector3 lower_;
  Vector3 cells_per_metre_;
  std::vector<int> first_;  // of each cell, into order_; one more at the end
  std::vector<int> order_;
};

/// A cell index that may lie beyond the ends: the cell inside, and the periods between the two.
struct WrappedCell {
  int cell, period;
};

inline WrappedCell wrapped_cell(int index, int count) {
  const int period = index < 0 ? -1 : index >= count ? 1 : 0;
  return {index - period * count, period};
}

inline int CellGrid::cell_along(int axis, double coordinate) const {
  const double at = std::floor((coordinate - lower_[axis]) * cells_per_metre_[axis]);
  // Beyond one period, or anywhere outside where nothing is periodic, the ends are all there is.
  const int count = cells_[axis];
  return static_cast<int>(std::clamp(at, -1.0 * count, 2.0 * count - 1.0));
}

/// All cells from one corner to the other, in runs of cells that lie next to each other in memory.
template <class Visit>
void CellGrid::visit_cells(const Cell& from, const Cell& to, const Visit& visit) const {
  const int run = axes_[0];
  const int middle = axes_[1];
  const int slow = axes_[2];
  const int count = cells_[run];
  std::array<int, 3> periods{};
  const auto visit_run = [&](int row, int first, int last, int period) {
    if (first > last) return;
    periods[run] = period;
    const int begin = first_[row + first];
    const int end = first_[row + last + 1];
    if (begin < end) visit(begin, end, Shift::code(periods[0], periods[1], periods[2]));
  };
  for (int k = from[slow]; k <= to[slow]; ++k) {
    const WrappedCell plane = wrapped_cell(k, cells_[slow]);
    periods[slow] = plane.period;
    for (int j = from[middle]; j <= to[middle]; ++j) {
      const WrappedCell line = wrapped_cell(j, cells_[middle]);
      periods[middle] = line.period;
      const int row = plane.cell * strides_[slow] + line.cell * strides_[middle];
      visit_run(row, std::max(from[run], 0), std::min(to[run], count - 1), 0);
      if (from[run] < 0) visit_run(row, from[run] + count, std::min(to[run], -1) + count, -1);
      if (to[run] >= count) visit_run(row, std::max(from[run], count) - count, to[run] - count, 1);
    }
  }
}

template <class Visit>
void CellGrid::visit_near(const double* position, double reach, const Visit& visit) const {
  if (order_.empty()) return;
  Cell from{};
  Cell to{};
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = cell_along(axis, position[axis] - reach);
    to[axis] = cell_along(axis, position[axis] + reach);
    if (periodic_[axis]) continue;
    from[axis] = std::clamp(from[axis], 0, cells_[axis] - 1);
    to[axis] = std::clamp(to[axis], 0, cells_[axis] - 1);
  }
  visit_cells(from, to, visit);
}

template <class Visit>
void CellGrid::visit_partners(int place, const Visit& visit) const {
  const auto after = std::upper_bound(first_.begin(), first_.end(), place);
  const int index = static_cast<int>(after - first_.begin()) - 1;
  Cell from{};
  Cell to{};
  for (int axis = 0; axis < 3; ++axis) {
    const int cell = index / strides_[axis] % cells_[axis];
    from[axis] = periodic_[axis] ? cell - 1 : std::max(cell - 1, 0);
    to[axis] = periodic_[axis] ? cell + 1 : std::min(cell + 1, cells_[axis] - 1);
  }
  visit_cells(from, to, [&](int first, int last, int shift) {
    for (int other = std::max(first, place + 1); other < last; ++other) visit(other, shift);
  });
}

}  // namespace fluxpact
