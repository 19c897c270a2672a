// One scalar over one step of the fluid: bounded, conservative at any tolerance of the solver, and
// blind to a uniform field.
//
//     (M^{n+1} c^{n+1} − M^n c^n)/Δt + Σ_f [ Φ_f c_f − (ε ρ D)_f g (c_N − c_P) ] = Q,   M = ρ ε V
// with the fluxes Φ_f that close the continuity of the same step, (M^{n+1} − M^n)/Δt + Σ Φ_f = 0.
// That turns it into the net form, in which only differences of c stand:
//     M^n (c^{n+1}_P − c^n_P)/Δt = Σ_f a_f (c^{n+1}_N − c^{n+1}_P) + Q,   a_f = max(−Φ_f, 0) + (…)
//     g
// 1. The higher-order part of the convected flux (and the non-orthogonal part of the diffusive one)
//    of the old field, cut so that they make no new extremum of it. Deferred like this they stand
//    in the steady state, too, and nothing of Δt with them, where nothing had to be cut.
// 2. Implicit upwind: an M-matrix with row sums M^n/Δt, so c stays between its values of 1 and
// those
//    of the boundary for any Δt. (Legacy continuity: the fluxes do not close, and what they leave,
//    r = (M^{n+1} − M^n)/Δt + Σ Φ, stands on the diagonal: a uniform field then drifts.)
// 3. Amounts: the fluxes, computed from the solved field, change M c. What the solver left moves c
//    by its residual over M^{n+1}/Δt, never the sum over the cells.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "cfd_server/linear/bicgstab_work.hpp"
#include "cfd_server/scalars/flux_correction.hpp"
#include "cfd_server/scalars/scalar_boundary.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// A step of the fluid, as its scalars see it.
struct FluidStep {
  double density = 0;                   ///< [kg/m³]
  double length = 0;                    ///< Δt [s]
  std::span<const double> old_voidage;  ///< ε^n [-], one a cell
  std::span<const double> voidage;      ///< ε^{n+1} [-], one a cell
  std::span<const double> face_flux;    ///< Φ [kg/s], one a face, out of the owner
  bool closed = true;                   ///< Φ closes the continuity of this step in every cell
};

/// What the step of one scalar is made of.
struct ScalarInput {
  const ScalarBoundary& boundary;
  std::span<const double> conductance;  ///< (ε ρ D)_f g [kg/s], one a face
  std::span<const double> source;       ///< Q [kg c/s], one a cell; empty: none
  std::span<const double> sink;  ///< [kg/s], one a cell, ≥ 0: Q − sink c^{n+1} acts; empty: none
};

/// Sized once for a mesh; shared by all scalars of a run.
struct ScalarWork {
  explicit ScalarWork(const Stencil& stencil);

  std::vector<double> into_owner, into_neighbour;  ///< a_f [kg/s], one a face
  std::vector<double> weight;                      ///< [kg/s], one a side
  std::vector<double> diagonal;                    ///< [kg/s], one a cell
  std::vector<double> capacity;                    ///< M^n/Δt [kg/s], one a cell
  std::vector<double> residual, change, solved;    ///< one a cell
  std::vector<double> flux;                        ///< deferred and cut [kg c/s], one a face
  std::vector<double> jump;                        ///< c_b − c_P, one a boundary face
  std::vector<Vector3> gradient;                   ///< [c/m], one a cell
  CorrectionWork correction;
  BicgstabWork<double> solver;
};

/// (ε Γ)_f g [kg/s] of each face: the two half cells in series, exact where ε or Γ jumps. Γ =
/// molecular + eddy/eddy_number [kg/(m s)]; eddy: one a cell, empty: none. At the boundary that of
/// the cell where the value is held, else 0.
void diffusive_conductance(const Stencil& stencil, const ScalarBoundary& boundary,
                           std::span<const double> voidage, double molecular,
                           std::span<const double> eddy, double eddy_number,
                           std::span<double> conductance);

/// into_owner, into_neighbour, weight and diagonal of the implicit upwind step: what multiplies c
/// is a diagonal at least as large as the sum of the row's weights.
void assemble_transport(const Stencil& stencil, const FluidStep& step, const ScalarInput& input,
                        ScalarWork& work);

/// Higher-order part of the convected flux and the non-orthogonal part of the diffusive one [kg
/// c/s], out of the owner, for the field `value` [c] with its gradient. limited: van Leer's limiter
/// (J. Comput. Phys. 14, 1974, 361-370) in the form of Darwish & Moukalled (Int. J. Heat Mass
/// Transfer 46, 2003, 599-611).
void deferred_flux(const Stencil& stencil, Convection scheme, std::span<const double> mass_flux,
                   std::span<const double> conductance, std::span<const double> value,
                   std::span<const Vector3> gradient, std::span<double> flux);

/// value [c], one a cell: from the step's start to its end. boundary_flux [kg c/s], one a boundary
/// face: what left through it. `gradient_coefficients`: of this scalar's boundary. `tolerance`:
/// residual of the linear solver over that of the step's start. Returns the solver's iterations;
/// throws NumericsError with `name` if it does not converge.
int advance_scalar(const Stencil& stencil, const FluidStep& step, const ScalarInput& input,
                   std::span<const Vector3> gradient_coefficients, Convection scheme,
                   double tolerance, const char* name, ScalarWork& work, std::span<double> value,
                   std::span<double> boundary_flux);

}  // namespace fluxpact
