// The non-conservative continuity of Wu et al. (Chem. Eng. J. 152, 2009, 514-529), kept for
// comparison only.
//
// Σ Λ_f = S_c V with the interstitial fluxes Λ_f = Φ_f/ε_f and the lagged mass source
//     S_c = −(ρ/ε_P) (Δε/Δt + u_P·∇ε),   ∇ε = (1/V) Σ ε_f A_f
// It does not telescope: where the voidage varies, what flows in differs from what flows out and is
// stored. u_P is the mean of Λ/A over the faces of the cell, or that of Φ/A over ε_P (the scene's
// fluid.numerics.legacy.velocity).
#pragma once

#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"

namespace fluxpact {

/// ε_f [-]: the arithmetic mean of the two cells; at the boundary that of the cell.
void legacy_face_voidage(const Stencil& stencil, std::span<const double> voidage,
                         std::span<double> face_voidage);

/// ∇ε [1/m] by Green-Gauss.
void legacy_voidage_gradient(const Stencil& stencil, std::span<const double> face_voidage,
                             std::span<Vector3> gradient);

/// S_c V/ρ [m³/s] of each cell from its interstitial velocity u [m/s].
void legacy_source(const Stencil& stencil, std::span<const double> old_voidage,
                   std::span<const double> voidage, std::span<const Vector3> voidage_gradient,
                   std::span<const Vector3> velocity, double window, std::span<double> source);

}  // namespace fluxpact
