// How much of the higher-order fluxes a field can take without a new extremum.
//
// First part of a scalar's step: the fluxes are cut where they would take a cell of the old field
// out of the range of itself and its neighbours; the implicit upwind step that follows is an
// M-matrix and keeps that range. One factor a face, the same for both cells: what is cut is cut on
// both sides, so the sum over the cells does not change.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "cfd_server/scalars/scalar_boundary.hpp"

namespace fluxpact {

/// Sized once, one entry a cell; factor one a face.
struct CorrectionWork {
  std::vector<double> lowest, highest;  ///< [c] that a cell may reach
  std::vector<double> corrected;        ///< [c] with the factors in hand
  std::vector<std::uint8_t> guarded;    ///< its factors are in force
  std::vector<double> factor;
};

void resize(CorrectionWork& work, const Stencil& stencil);

/// The field before its correction [c], one a cell, and what counts as neighbours at the boundary.
struct CorrectedField {
  std::span<const double> value;
  const ScalarBoundary& boundary;
  std::span<const double> into_owner;  ///< [kg/s], one a face: the value of a boundary face counts
                                       ///< where it has a weight in the cell
};

/// flux [kg c/s], one a face, out of the owner: on return what the field can take. capacity
/// [kg/s], one a cell: M/Δt.
///
/// The limiter of S.T. Zalesak, J. Comput. Phys. 31 (1979) 335-362, eq. 10-15 (on meshes of any
/// kind: D. Kuzmin, S. Turek, J. Comput. Phys. 175 (2002) 525-558) holds a cell in its range
/// whatever happens to its neighbours, but at a price: it counts what enters and not what leaves.
/// So it guards only the cells that would leave their range, then those that do because of the
/// faces that were cut for others, until there is none: each cell is added at most once.
void limit_correction(const Stencil& stencil, const CorrectedField& field,
                      std::span<const double> capacity, CorrectionWork& work,
                      std::span<double> flux);

}  // namespace fluxpact
