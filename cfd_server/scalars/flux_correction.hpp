// Zalesak's limiter: how much of an antidiffusive flux a bounded solution can take without a new
// extremum.
//
// Last part of a scalar's step. The low-order solution is bounded because its matrix is an
// M-matrix; each further flux is cut so that no cell leaves the range of itself and its neighbours,
// before and after the low-order step. One factor a face, the same for both cells: what is cut is
// cut on both sides, so the sum over the cells does not change.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "cfd_server/scalars/scalar_boundary.hpp"

namespace fluxpact {

/// Sized once, one entry a cell.
struct CorrectionWork {
  std::vector<double> lowest, highest;  ///< [c] that a cell may reach
  std::vector<double> gain, loss;  ///< [kg c/s] all that would enter and leave, then their factors
};

void resize(CorrectionWork& work, int cells);

/// flux [kg c/s], one a face, out of the owner: on return what may be added to `low`. low, old [c]:
/// the solution to correct, and that of the step's start. into_owner [kg/s], one a face: the weight
/// of a boundary's value in its cell, which then is one of the neighbours. capacity [kg/s], one a
/// cell: M^{n+1}/Δt. S.T. Zalesak, J. Comput. Phys. 31 (1979) 335-362, eq. 10-15; on meshes of any
/// kind D. Kuzmin, S. Turek, J. Comput. Phys. 175 (2002) 525-558.
void limit_correction(const Stencil& stencil, const ScalarBoundary& boundary,
                      std::span<const double> into_owner, std::span<const double> capacity,
                      std::span<const double> low, std::span<const double> old,
                      CorrectionWork& work, std::span<double> flux);

}  // namespace fluxpact
