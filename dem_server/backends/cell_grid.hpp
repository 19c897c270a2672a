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

  /// For the particle at place k of the cell order: calls visit(other, shift) with each place whose
  /// particle (moved by the shift) may be nearer than the cutoff. Every pair, with every image,
  /// comes once over all k. A particle is never paired with its own image.
  template <class Visit>
  void visit_partners(int place, const Visit& visit) const;

  /// Calls visit(other, shift) with every place whose cell touches the cube of `reach` [m] around
  /// `at` (wrapped); across periodic sides with each image, `reach` being at most a period.
  template <class Visit>
  void visit_within(const Vector3& at, double reach, const Visit& visit) const;

 private:
  struct Range {
    int first, last, shift;
  };
  /// The part of `cell + offset`: empty outside, an image across a periodic side.
  Range neighbour_cell(const std::array<int, 3>& cell, const std::array<int, 3>& offset) const;
  void lay_out(const Domain& domain, double cutoff, PositionRows positions);
  int cell_of(const double* position) const;

  std::array<int, 3> cells_{1, 1, 1};
  std::array<int, 3> strides_{1, 1, 1};
  std::array<bool, 3> periodic_{};
  Vector3 lower_;
  Vector3 cells_per_metre_;
  std::vector<int> first_;  // of each cell, into order_; one more at the end
  std::vector<int> order_;
  std::vector<int> cell_at_;  // cell of each place in order_
  std::vector<int> cell_of_row_;
  std::vector<int> next_;
};

/// Half of the 26 cells around a cell: with the visitor's own later places they make each pair
/// once.
inline constexpr std::array<std::array<int, 3>, 13> forward_cells{{{1, 0, 0},
                                                                   {-1, 1, 0},
                                                                   {0, 1, 0},
                                                                   {1, 1, 0},
                                                                   {-1, -1, 1},
                                                                   {0, -1, 1},
                                                                   {1, -1, 1},
                                                                   {-1, 0, 1},
                                                                   {0, 0, 1},
                                                                   {1, 0, 1},
                                                                   {-1, 1, 1},
                                                                   {0, 1, 1},
                                                                   {1, 1, 1}}};

inline CellGrid::Range CellGrid::neighbour_cell(const std::array<int, 3>& cell,
                                                const std::array<int, 3>& offset) const {
  std::array<int, 3> periods{};
  int index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    int at = cell[axis] + offset[axis];
    if (at < 0 || at >= cells_[axis]) {
      if (!periodic_[axis]) return {0, 0, Shift::none};
      periods[axis] = at < 0 ? -1 : 1;
      at -= periods[axis] * cells_[axis];
    }
    index += at * strides_[axis];
  }
  return {first_[index], first_[index + 1], Shift::code(periods[0], periods[1], periods[2])};
}

template <class Visit>
void CellGrid::visit_partners(int place, const Visit& visit) const {
  const int index = cell_at_[place];
  for (int other = place + 1; other < first_[index + 1]; ++other) visit(other, Shift::none);
  std::array<int, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) cell[axis] = index / strides_[axis] % cells_[axis];
  for (const std::array<int, 3>& offset : forward_cells) {
    const Range range = neighbour_cell(cell, offset);
    for (int other = range.first; other < range.last; ++other) {
      if (other != place) visit(other, range.shift);
    }
  }
}

template <class Visit>
void CellGrid::visit_within(const Vector3& at, double reach, const Visit& visit) const {
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (at[axis] - lower_[axis]) * cells_per_metre_[axis];
    const double span = reach * cells_per_metre_[axis];
    low[axis] = static_cast<int>(std::floor(place - span));
    high[axis] = static_cast<int>(std::floor(place + span));
    if (periodic_[axis]) continue;
    low[axis] = std::clamp(low[axis], 0, cells_[axis] - 1);
    high[axis] = std::clamp(high[axis], 0, cells_[axis] - 1);
  }
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i) {
        const Range range = neighbour_cell({0, 0, 0}, {i, j, k});
        for (int other = range.first; other < range.last; ++other) visit(other, range.shift);
      }
    }
  }
}

}  // namespace fluxpact
