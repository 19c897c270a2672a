// The pressure gradient by least squares where the pressure has kinks at the faces.
//
// Drag and inertia jump from cell to cell, and the normal derivative of the pressure with them. A
// least-squares gradient of the cells' pressures would smear each kink over its neighbours, so that
// it could be anything beside the edge of a dense bed. Here each neighbour's pressure is first
// carried over to what it would be without the kink:
//     p_N − p_P + (1 − w) d_n (L_P − L_N)/|A|,   d_n = |d·A|/|A|
// with L = S·A/(χ V) + m_f/χ − (R^t + R^b) φ_f, what local forces and inertia make of ∂p/∂n |A| on
// a side of the face. Non-orthogonal meshes only: for the part of the pressure force along the
// faces, and for the velocity of cells with few faces.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/vans/face_flux.hpp"

namespace fluxpact {

/// Least-squares coefficients for the resistances of a step, one a side: weights 1/|d|² times
/// min(1, R_P/R_N), R = (A_t + A_b + A_c)/(χ ε V). Every side counts, boundary faces included.
void kinked_gradient_coefficients(const Stencil& stencil, const MomentumCoefficients& momentum,
                                  std::span<const double> voidage,
                                  std::span<const double> pressure_share,
                                  std::span<Vector3> coefficients);

struct KinkedGradientInput {
  std::span<const double> voidage;
  std::span<const double> pressure_share;  ///< χ
  std::span<const double> pressure;        ///< p − level [Pa], one a cell
  std::span<const double> flux;            ///< φ [m³/s] that goes with this pressure, one a face
};

/// gradient [Pa/m], one a cell: in, the one before, which gives the part along walls; out, the new
/// one. A wall or inlet has no pressure of its own: along its normal the local forces give it.
void kinked_gradient(const Stencil& stencil, const BoundaryConditions& conditions,
                     const BoundaryValues& values, const MomentumCoefficients& momentum,
                     const FluidState& old_state, const TimeCoefficients& time,
                     std::span<const Vector3> coefficients, const KinkedGradientInput& input,
                     std::span<Vector3> gradient);

}  // namespace fluxpact
