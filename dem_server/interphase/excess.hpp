// Over-full cells: what a cell cannot hold of the particles goes to the cells around it, and so
// does the same part of all that these particles exchange with the fluid. Nothing is clipped.
//
// After the solids have been mapped to cells, before the voidage. Where no cell is over-full it is
// one comparison a cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// What was moved from cell to cell, in order: a change of all weights between particles and cells.
/// Sums stay to round-off, nothing turns negative.
struct ExcessMoves {
  struct Part {
    int to = 0;
    double share = 0;  ///< of what `from` holds at its turn [-]
  };
  std::vector<int> from;           ///< one cell a turn
  std::vector<std::int64_t> ends;  ///< of its parts, one a turn
  std::vector<Part> parts;

  bool empty() const { return from.empty(); }
  void clear();

  /// Amounts (of anything, per cell) move on, in place.
  void spread(std::span<double> amounts) const;
  void spread(std::span<Vector3> amounts) const;

  /// The transpose: a cell that has passed on a part sees that part of the others' field.
  void average(std::span<double> field) const;
  void average(std::span<Vector3> field) const;
};

class ExcessFinder {
 public:
  /// `smallest_voidage` in (0, 1): a cell holds up to (1 − that) of its volume.
  ExcessFinder(const Mesh& mesh, double smallest_voidage);

  /// Moves what is too much in `solids` [m³, one a cell], and writes down how: from cell to cell
  /// towards the nearest ones with room, as often as it takes; a cell with room never takes more
  /// than that. By one thread, in an order that only depends on the mesh and the amounts. Returns
  /// the volume that ended up in another cell [m³]. Throws NumericsError (cell, place, voidage,
  /// step) if there is no room for it within reach.
  double move(std::int64_t step, std::span<double> solids, ExcessMoves& moves);

 private:
  bool is_over_full(int cell, double solids) const;
  void find_distances(std::span<const double> solids);
  void pass_on(int cell, std::span<double> solids, ExcessMoves& moves);
  [[noreturn]] void refuse(int cell, double voidage, std::int64_t step) const;

  double smallest_voidage_;
  std::vector<int> offsets_;  ///< CSR: the cells around each cell
  std::vector<int> around_;
  std::vector<double> volumes_;   ///< [m³]
  std::vector<double> capacity_;  ///< [m³]
  std::vector<Vector3> centres_;  ///< [m]
  std::vector<int> distance_;     ///< steps to a cell with room; -1: none
  std::vector<int> order_;        ///< cells by distance
  std::vector<double> before_;    ///< [m³]
};

}  // namespace fluxpact
