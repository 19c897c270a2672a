// Least-squares gradients of cell fields: exact for linear fields on any mesh.
//
// Used by the limited convection, by the second-order face value of the pressure correction and by
// the non-orthogonal terms.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"

namespace fluxpact {

/// One vector a side of each cell [1/m]: grad φ = Σ_sides c (φ_other − φ_P). Weights 1/|d|².
/// `gives_value`: one a boundary face, whether it enters with a value of its own. Directions in
/// which a cell sees no second value (one layer of cells between free walls) get a zero gradient.
std::vector<Vector3> gradient_coefficients(const Stencil& stencil,
                                           std::span<const std::uint8_t> gives_value);

/// out(i, j) = ∂φ_i/∂x_j of a cell field of vectors. `boundary_jump`: φ_b − φ_P for each boundary
/// face.
void gradient(const Stencil& stencil, std::span<const Vector3> coefficients,
              std::span<const Vector3> field, std::span<const Vector3> boundary_jump,
              std::span<Matrix3> out);

void gradient(const Stencil& stencil, const AxisVectors& coefficients,
              std::span<const Vector3> field, std::span<const Vector3> boundary_jump,
              std::span<Matrix3> out);

/// Gradient of a cell scalar. `boundary_jump`: φ_b − φ_P for each boundary face.
void gradient(const Stencil& stencil, std::span<const Vector3> coefficients,
              std::span<const double> field, std::span<const double> boundary_jump,
              std::span<Vector3> out);

}  // namespace fluxpact
