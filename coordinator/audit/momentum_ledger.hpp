// The momentum audit of one window: what the fluid gave away and what the particles were given.
//
// The fluid step of window n hands over, cell by cell, the impulse
//     H_c = −J_c − Δt (1−ε_c) V_c ∇p_c,        J_c = Δt (S_c − B_c u_c − A_c ∇p_c)
// (J: what drag and the other forces of the particles gave the fluid, A only where the scene asks
// for it; the second part of H only if the pressure-gradient force is on). The particles are given
// it in window n+1, as a constant force; in between it is in flight, and the ledger holds it.
//
// What must match is the SUM over the cells, not each cell: u and ∇p are gathered at a particle
// from all the cells that it touches and the impulse is scattered back with the same weights, which
// moves impulse between neighbouring cells and leaves its sum. B, S and ε carry these weights, so
// the sums are equal to round-off.
//
// In window 1 the fluid has handed over nothing yet. What the particles are given in it is lent: S
// of the same window has it, and so has H, of which the rest alone is to be given in window 2.
//
// ∇p is that of p_d = p − ρ g·x, on both sides: the buoyancy of the hydrostatic part is in neither
// sum.
#pragma once

#include <span>

#include "proto/base/compensated_sum.hpp"
#include "proto/base/vector.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// What was sent about one window; one row a cell. Sizes are those of the mesh (`Fields` has
/// checked them).
struct MomentumWindow {
  double length = 0;                           ///< Δt [s]
  bool pressure_gradient_force = true;         ///< whether the particles feel −V_p ∇p_d
  std::span<const double> voidage;             ///< ε^{n+1} [-]
  std::span<const double> drag_coefficient;    ///< B [kg/s]
  std::span<const Vector3> drag_source;        ///< S [N]
  std::span<const double> pressure_return;     ///< A [m³]; empty: none
  std::span<const Vector3> velocity;           ///< u^{n+1} [m/s]
  std::span<const Vector3> pressure_gradient;  ///< ∇p_d [Pa/m]
  std::span<const Vector3> impulse_taken;      ///< J as the fluid says [N s]
  std::span<const Vector3> impulse_given;      ///< as the particles say, in this window [N s]
};

/// A vector sum that rounds once.
struct CompensatedVector {
  CompensatedSum x, y, z;
  void add(const Vector3& term);
  Vector3 value() const { return {x.value(), y.value(), z.value()}; }
};

/// What the last committed fluid step handed over, and all that is in flight. At time 0 nothing is.
struct MomentumTotal {
  bool begun = false;            ///< a window was committed
  Vector3 handed_over{0, 0, 0};  ///< Σ_c H of the last committed window, less what was lent [N s]
  double scale = 0;              ///< what an error in it is relative to [N s]
  CompensatedVector in_flight;   ///< Σ over all windows of handed over − given [N s]
};

struct MomentumAudit {
  Vector3 momentum_to_fluid{0, 0, 0};      ///< −Σ_c H of this window [N s]
  Vector3 momentum_to_particles{0, 0, 0};  ///< Σ_c impulse_given of this window [N s]
  Vector3 ledger{0, 0, 0};                 ///< in flight after this window [N s]
  /// Σ_c |J_c as sent − Δt (S_c − B_c u_c − A_c ∇p_c)| / scale of this window [-].
  double impulse_error = 0;
  int impulse_error_cell = -1;  ///< where the difference is largest; -1: nowhere
  /// |Σ_c given now − Σ_c H of the last window| / its scale [-]; 0 in window 1, see above.
  double handover_error = 0;
  MomentumTotal total;  ///< to be kept if the window is committed
};

/// A pure function of the window and of the committed total, so a window can be repeated.
///
/// The scale of a window is Σ_c |H_c| + Δt (|S_c| + |B_c u_c| + |A_c ∇p_c| + audit_floor V_c
/// |∇p_c|): the sizes of the terms whose sum is compared, the last one because 1−ε is known
/// to 1.1e-16 only. 0/0 counts as 0.
MomentumAudit audit_momentum(const Mesh& mesh, const MomentumWindow& window,
                             const MomentumTotal& committed);

}  // namespace fluxpact
