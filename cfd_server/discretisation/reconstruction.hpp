// Cell vectors from face fluxes.
//
// After each pressure correction the cell velocity is rebuilt from the fluxes, which is what makes
// a voidage jump in one cell exact and keeps the collocated mesh free of checkerboards.
#pragma once

#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"

namespace fluxpact {

/// One vector a side: M⁻¹ A/|A| with M = Σ_f A Aᵀ/|A| [1/m²].
std::vector<Vector3> reconstruction_coefficients(const Stencil& stencil);

/// q_P = M⁻¹ Σ_f (A/|A|) [φ_f − A·(∇q_P (x_f − x_P))]: the vector whose face values fit the fluxes
/// best; exact for linear fields. flux: φ [m³/s], one a face, out of the owner. gradient: of q,
/// lagged; may be empty on a centred mesh, where its term cancels. out: [m/s] one a cell.
void reconstruct(const Stencil& stencil, std::span<const Vector3> coefficients,
                 std::span<const double> flux, std::span<const Matrix3> gradient,
                 std::span<Vector3> out);
void reconstruct(const Stencil& stencil, const AxisVectors& coefficients,
                 std::span<const double> flux, std::span<const Matrix3> gradient,
                 std::span<Vector3> out);

}  // namespace fluxpact
