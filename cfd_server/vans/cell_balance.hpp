// Velocities of cells that have too few faces to be rebuilt from their fluxes.
//
// A tetrahedron has two fluxes for three components of velocity (each face belongs to two cells),
// and an error of the rebuilt vector would alternate between neighbours. There the momentum balance
// of the cell gives the velocity, with a pressure gradient by least squares that knows the jumps of
// drag and inertia at the faces:
//     (A_t + A_b + A_c) u = B_t + S + C(u') + A_c u' − χ V ∇p
//     ∇p = LSQ of p_N − p_P + (1 − w) d_n (L_P − L_N)/|A|,  d_n = |d·A|/|A|
// L = S·A/(χ V) + m_f/χ − (R^t + R^b) φ_f is what local forces and inertia make of ∂p/∂n |A| on a
// face's side; the two sides' difference is the kink of the pressure at the face.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/vans/face_flux.hpp"

namespace fluxpact {

/// Inputs beside the coefficients of the step.
struct CellBalanceInput {
  std::span<const double> voidage;
  std::span<const double> pressure_share;    ///< χ
  std::span<const double> pressure;          ///< p − level [Pa], one a cell
  std::span<const double> flux;              ///< φ [m³/s], one a face
  std::span<const Vector3> slope;            ///< least-squares ∇p [Pa/m] of the corrector before
  std::span<const Vector3> force;            ///< C(u') [N]
  std::span<const Vector3> velocity_before;  ///< u' [m/s]
};

/// Least-squares coefficients for these cells: every side gives a value.
std::vector<Vector3> cell_balance_coefficients(const Stencil& stencil);

/// velocity [m/s] and pressure gradient [Pa/m] of the cells with few faces; others are left alone.
void balance_cells(const Stencil& stencil, const BoundaryConditions& conditions,
                   const BoundaryValues& values, const MomentumCoefficients& momentum,
                   const FluidState& old_state, const TimeCoefficients& time,
                   std::span<const Vector3> coefficients, const CellBalanceInput& input,
                   std::span<Vector3> velocity, std::span<Vector3> pressure_gradient);

}  // namespace fluxpact
