// The budget of one scalar over one window, from what both sides sent.
//
// Stands beside the mass audit: what was in the domain, what crossed its boundary and what its
// sources added must make what is in the domain. The fluid's side says the flows and the field, the
// particles' side the voidage; every sum is compensated.
#pragma once

#include <span>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// What was sent about a scalar and one window. Sizes are those of the mesh.
struct ScalarWindow {
  double density = 0;                      ///< ρ of the fluid [kg/m³]
  double length = 0;                       ///< Δt [s]
  double factor = 1;                       ///< amount over fluid mass times c: heat capacity, or 1
  std::span<const double> voidage_before;  ///< ε^n [-], one a cell
  std::span<const double> voidage_after;   ///< ε^{n+1} [-], one a cell
  std::span<const double> value_before;    ///< c^n, one a cell
  std::span<const double> value_after;     ///< c^{n+1}, one a cell
  std::span<const double> boundary_flux;   ///< what left, one a boundary face [kg/s], heat: [W]
  double source = 0;                       ///< what sources added [kg/s], [W]
};

/// Amounts are in kg, of heat in J above 0 K.
struct ScalarAudit {
  double amount = 0;     ///< Σ ρ ε V c at the window's end
  double in = 0;         ///< over boundary faces, ≥ 0 [1/s]
  double out = 0;        ///< over boundary faces, ≥ 0 [1/s]
  double source = 0;     ///< [1/s]
  double imbalance = 0;  ///< (in − out + source) Δt less the change of the amount, over the larger
                         ///< of Σ ρ ε V |c| before and after and in Δt [-]
  double lowest = 0;   ///< of c^{n+1}
  double highest = 0;  ///< of c^{n+1}
};

/// A value that is not finite ends up in the results, which the gate refuses.
ScalarAudit audit_scalar(const Mesh& mesh, const ScalarWindow& window);

}  // namespace fluxpact
