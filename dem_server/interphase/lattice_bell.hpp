// The bell of the kernel map on a lattice. Its midpoints are products of one list an axis, so what
// a cell is asked for on any mesh is done here once a particle.
#pragma once

#include <array>
#include <vector>

#include "dem_server/interphase/lattice_axis.hpp"
#include "dem_server/interphase/overlap.hpp"

namespace fluxpact {

/// Room for one thread, reused.
struct BellRoom {
  /// The intervals that the bell reaches along an axis, and their pieces.
  struct Reach {
    std::vector<int> cells;       ///< what they add to a cell's number
    std::vector<int> ends;        ///< of the pieces of each
    std::vector<double> lengths;  ///< of one piece of each [m]
    std::vector<double> squares;  ///< of a piece's midpoint from the centre, over h² [-]
  };
  std::array<Reach, 3> reach;
  std::vector<double> sums;
};

class LatticeBell {
 public:
  explicit LatticeBell(const Lattice& lattice) : axes_(lattice_axes(lattice)) {}

  /// Appends the cells in which (1 − r²/h²)³, h the radius of `bell` [m], is not 0, and its
  /// integral in each [m³]: by the midpoints of equal pieces no larger than h/2, as
  /// `CellShapes::each_piece` cuts them. False, with nothing appended, if the centre or an end of
  /// the bell is in the last plane of an axis or not to be placed. h must be below the shortest
  /// period.
  bool append(const Ball& bell, BellRoom& room, std::vector<int>& cells,
              std::vector<double>& integrals) const;

 private:
  static bool cut(const LatticeAxis& axis, double centre, double radius, BellRoom::Reach& reach);

  std::array<LatticeAxis, 3> axes_;
};

}  // namespace fluxpact
