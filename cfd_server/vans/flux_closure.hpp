// Makes the discrete continuity of every cell exact, whatever the pressure solver left.
//
// Last step of a window's flux: the residual of each cell is passed along a breadth-first tree to a
// pressure face. It is no solver: it moves what is left by a converged solve, and says how much
// that was.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/vans/regions.hpp"

namespace fluxpact {

/// A spanning forest of the cells with its roots at pressure faces (closed regions: at their first
/// cell).
struct ClosureTree {
  std::vector<int> order;  ///< cells, parents before children
  std::vector<int>
      parent_face;  ///< one a cell: the face towards the root; −1 at the root of a closed region
  std::vector<int> parent_cell;   ///< one a cell: the cell across that face, −1 outside
  std::vector<std::int8_t> sign;  ///< one a cell: +1 if it owns parent_face
  std::vector<long double>
      carry;  ///< workspace: rounding passed on, so that it does not add up globally
};

ClosureTree make_closure_tree(const Stencil& stencil, const BoundaryConditions& conditions,
                              const FluidRegions& regions);

/// Changes one flux a cell so that storage_P + Σ Φ_f = 0 in every cell. storage [kg/s] one a cell,
/// flux Φ [kg/s] one a face, out of the owner. Returns the largest change [kg/s].
double close_fluxes(ClosureTree& tree, const Stencil& stencil, std::span<const double> storage,
                    std::span<double> flux);

}  // namespace fluxpact
