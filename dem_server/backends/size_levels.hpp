// Spheres of very different sizes, sorted for the search of neighbours: one grid of cells for each
// class of sizes, so that small ones need not look through the wide cells of the large. Behind the
// contact list of the native engine.
#pragma once

#include <vector>

#include "dem_server/backends/cell_grid.hpp"

namespace fluxpact {

/// Radii at a fixed stride of doubles, one of each position.
struct RadiusRows {
  const double* data = nullptr;
  int stride = 1;
  double operator[](int row) const { return data[static_cast<std::ptrdiff_t>(row) * stride]; }
};

/// Classes within which diameters differ by at most a factor of two. With one class this is one
/// grid.
class SizeLevels {
 public:
  /// Sort spheres (wrapped in periodic axes). `skin` [m] is added to the size of the cells.
  void sort(const Domain& domain, double skin, PositionRows positions, RadiusRows radii);

  /// order()[place] is the row of the sphere at a place: the largest class first, each in cell
  /// order.
  const std::vector<int>& order() const {
    return levels_.size() == 1 ? levels_.front().grid.order() : order_;
  }

  /// Calls visit(first, last, shift, largest_radius) with ranges of places [first, last) that hold
  /// every sphere whose surface, moved by the shift, may be nearer than `reach` [m] to this
  /// position; no sphere of a range has a larger radius [m].
  template <class Visit>
  void visit_near(const double* position, double reach, const Visit& visit) const {
    for (const Level& level : levels_) {
      level.grid.visit_near(
          position, reach + level.largest_radius, [&](int first, int last, int shift) {
            visit(level.first + first, level.first + last, shift, level.largest_radius);
          });
    }
  }

 private:
  struct Level {
    double largest_radius = 0;
    int first = 0;  // place of its first sphere
    std::vector<int> rows;
    std::vector<Vector3> positions;  // of its rows; unused if there is one level
    CellGrid grid;
  };
  void sort_level(const Domain& domain, double skin, PositionRows positions, Level& level);

  std::vector<Level> levels_;
  std::vector<int> order_;
};

}  // namespace fluxpact
