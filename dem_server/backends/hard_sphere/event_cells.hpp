// The cells that spheres fly through between two windows: who may be near whom, kept up to date by
// one event at each crossing. Spheres of very different sizes have cells of their own size, each
// class in which diameters differ by at most a factor of two.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "dem_server/backends/cell_grid.hpp"

namespace fluxpact {

class EventCells {
 public:
  /// Sort spheres into cells. Positions are wrapped in periodic axes; elsewhere the outermost cells
  /// have no end.
  void sort(const Domain& domain, std::span<const Vector3> position,
            std::span<const double> radius);

  /// The cell of a sphere [m]; infinite at an end of the domain.
  struct Bounds {
    std::array<double, 3> lower, upper;
  };
  Bounds bounds(int sphere) const;

  /// Put the sphere into the next cell along an axis, up (+1) or down (-1). The periods to add to
  /// its position: -1, 0, 1.
  int cross(int sphere, int axis, int direction);

  /// Calls visit(other, shift) with every sphere, moved by the shift, that this one may touch while
  /// both are in the cells they are in now. The sphere itself may be among them.
  template <class Visit>
  void visit_near(int sphere, const Visit& visit) const;

 private:
  struct Level {
    double largest_radius = 0;
    std::array<int, 3> cells{1, 1, 1};
    std::array<double, 3> lower{}, edge{};
    int first = 0;  // of its cells, in first_of_cell_
    int spheres = 0;
  };
  using Cell = std::array<int, 3>;
  void lay_out(const Domain& domain, const Vector3& lower, const Vector3& upper,
               Level& level) const;
  int index(const Level& level, const Cell& cell) const {
    return level.first + (cell[2] * level.cells[1] + cell[1]) * level.cells[0] + cell[0];
  }
  void put_in(int sphere);
  void take_out(int sphere);
  double face(const Level& level, int axis, int number) const {
    return level.lower[axis] + number * level.edge[axis];
  }
  void reach_of(int sphere, const Level& other, Cell& from, Cell& to) const;

  std::array<bool, 3> periodic_{};
  std::vector<Level> levels_;
  std::vector<int> first_of_cell_;  // -1: empty
  std::vector<int> next_, previous_;
  std::vector<Cell> cell_of_;
  std::vector<std::uint8_t> level_of_;
};

template <class Visit>
void EventCells::visit_near(int sphere, const Visit& visit) const {
  for (const Level& level : levels_) {
    Cell from{};
    Cell to{};
    reach_of(sphere, level, from, to);
    for (int k = from[2]; k <= to[2]; ++k) {
      const WrappedCell z = wrapped_cell(k, level.cells[2]);
      for (int j = from[1]; j <= to[1]; ++j) {
        const WrappedCell y = wrapped_cell(j, level.cells[1]);
        const int* const row = &first_of_cell_[index(level, {0, y.cell, z.cell})];
        for (int i = from[0]; i <= to[0]; ++i) {
          const WrappedCell x = wrapped_cell(i, level.cells[0]);
          const int shift = Shift::code(x.period, y.period, z.period);
          for (int other = row[x.cell]; other >= 0; other = next_[other]) visit(other, shift);
        }
      }
    }
  }
}

}  // namespace fluxpact
