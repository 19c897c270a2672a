// The share of a small ball in each cell of a lattice, in closed form: the fast path of the exact
// map. A ball in a bed lies wholly in one cell or is cut by one plane of an axis or two; only where
// it is cut by two of the same axis does it need the sum over all faces (overlap.hpp).
#pragma once

#include <array>

#include "dem_server/interphase/lattice_axis.hpp"
#include "dem_server/interphase/overlap.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// At most eight cells and what each holds of the ball [m³]; what is behind a wall is not there.
/// The cell of the centre comes first.
struct LatticeShares {
  int count = 0;
  double total = 0;  ///< [m³]
  std::array<int, 8> cells{};
  std::array<double, 8> volumes{};
};

class LatticeOverlap {
 public:
  explicit LatticeOverlap(const Lattice& lattice) : axes_(lattice_axes(lattice)) {}

  /// The cell that holds a point [m]; -1 if none does, or it lies in the last plane of an axis.
  int cell_of(Vector3 point) const {
    int cell = 0;
    for (int k = 0; k < 3; ++k) {
      const int i = axes_[k].interval(point[k]);
      if (i < 0) return -1;
      cell += i * axes_[k].stride;
    }
    return cell;
  }

  /// False if the ball is cut by two planes of one axis, its centre is outside, or its radius is
  /// not positive: nothing is said of it then.
  bool find(const Ball& ball, LatticeShares& shares) const;

 private:
  /// The planes that cut a ball, at most one an axis.
  struct Cuts {
    int cell = 0;  ///< that holds the centre
    int count = 0;
    std::array<double, 3> distance{};  ///< of the centre [m]
    std::array<int, 3> beyond{};       ///< what to add to the cell's number
    int walls = 0;                     ///< bits: nothing is beyond this one
  };

  bool find_cuts(const Ball& ball, Cuts& cuts) const;

  std::array<LatticeAxis, 3> axes_;
};

}  // namespace fluxpact
