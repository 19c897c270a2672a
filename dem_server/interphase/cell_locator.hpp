// Which cell holds a point, and which cells a ball may touch. Index arithmetic on a lattice,
// uniform bins on any other mesh; periodic images included. Built once, asked for every particle
// each window.
#pragma once

#include <array>
#include <vector>

#include "dem_server/interphase/cell_shapes.hpp"

namespace fluxpact {

/// A cell and a point as that cell sees it: in the coordinates of the cell, after the translation
/// of a periodic image.
struct CellImage {
  int cell = 0;
  Vector3 point{0, 0, 0};  ///< [m]
};

class CellLocator {
 public:
  /// `shapes` must be those of the mesh, and outlive the locator.
  CellLocator(const Mesh& mesh, const CellShapes& shapes);

  /// The cell that holds a point [m], −1 if none does. On a shared face: the one of lower index, on
  /// a lattice the one above. A point up to one period outside a periodic side is found (any number
  /// of periods on a lattice).
  int cell_of(const Vector3& point) const;

  /// Appends to `out` every cell whose bounding box the ball's bounding box touches, with the
  /// ball's centre as that cell sees it; a cell that meets several images of the ball comes once
  /// for each. The order is that of the mesh, not of time.
  void touching(const Ball& ball, std::vector<CellImage>& out) const;

  /// Shortest period [m], infinite without one: a ball of a larger radius would meet images that
  /// `touching` does not visit.
  double shortest_period() const { return shortest_period_; }

 private:
  using Index = std::array<int, 3>;

  int lattice_position(int axis, double value) const;
  double wrap(int axis, double value) const;
  int cell_of_lattice(const Vector3& point) const;
  void touching_lattice(const Ball& ball, std::vector<CellImage>& out) const;

  void collect_images(const Mesh& mesh);
  void fill_bins();
  Index bin_of(const Vector3& point) const;
  int bin_number(const Index& bin) const {
    return bin[0] + bins_[0] * (bin[1] + bins_[1] * bin[2]);
  }
  int cell_of_bins(const Vector3& point) const;
  void touching_bins(const Ball& ball, std::vector<CellImage>& out) const;

  const CellShapes& shapes_;
  double shortest_period_ = 0;
  // General meshes.
  std::vector<Vector3> images_;  ///< [m] what to add to a point; the first is zero
  Bounds domain_;
  Index bins_{1, 1, 1};
  std::vector<Index> first_bin_;  ///< of each cell's bounding box
  std::vector<int> bin_offsets_;  ///< CSR into bin_cells_
  std::vector<int> bin_cells_;
};

}  // namespace fluxpact
