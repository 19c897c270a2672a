// The mass audit of one window, from what both sides sent: per cell and over the whole domain.
//
// Stands between the fluid's result and the commit. A pure function of the window and of the
// committed total, so a window can be repeated; the new total becomes the committed one only when
// the caller says so. Every sum is compensated: what is left is what was sent, not how it was added
// up.
#pragma once

#include <span>

#include "proto/base/compensated_sum.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// Share of the whole domain below which an amount counts as nothing to compare with [-].
///
/// A stored voidage is known to 2^-53 = 1.1e-16 at best, so an amount of fluid or solids is known
/// to 1.1e-16 of the domain, however little of it there is. Relative errors therefore divide by the
/// amount itself or, if that is more, by 1e-5 of the domain: round-off then stays below
/// 1.1e-16 / 1e-5 = 1.1e-11, a tenth of the default limit of the gate.
inline constexpr double audit_floor = 1e-5;

/// What was sent about one window. Sizes are those of the mesh (`Fields::scalars` has checked
/// them).
struct MassWindow {
  double density = 0;                      ///< ρ of the fluid [kg/m³]
  double length = 0;                       ///< Δt [s]
  std::span<const double> voidage_before;  ///< ε^n as committed, one a cell [-]
  std::span<const double> voidage_after;   ///< ε^{n+1}, one a cell [-]
  std::span<const double> face_flux;       ///< Φ, one a face, out of the owner [kg/s]
  double particle_volume = 0;              ///< Σ V_p at the window's end [m³]
  /// ε that the particles have sent for the window's end, if the fluid does not know it yet
  /// (coupling.scheme parallel); empty: ε^{n+1}.
  std::span<const double> voidage_sent{};
};

/// Fluid mass at time 0 and what has crossed the boundary since.
struct MassTotal {
  double initial_fluid_mass = 0;  ///< [kg]
  CompensatedSum gained;          ///< Σ (in − out) Δt [kg]
};

struct MassAudit {
  double mass_in = 0;               ///< over boundary faces, ≥ 0 [kg/s]
  double mass_out = 0;              ///< over boundary faces, ≥ 0 [kg/s]
  double storage_rate = 0;          ///< Σ ρ (ε^{n+1} − ε^n) V / Δt [kg/s]
  double net_imbalance = 0;         ///< in − out − storage [kg/s]
  double relative_imbalance = 0;    ///< net / max(in, audit_floor ρ ΣV/Δt) [-]
  double max_cell_residual = 0;     ///< max |ρ Δε V/Δt + ΣΦ| / (ρ V/Δt) [-]
  int max_cell_residual_cell = -1;  ///< where that is
  double cumulative_drift = 0;      ///< (mass − initial mass − gained) / mass [-]
  double fluid_mass = 0;            ///< Σ ρ ε V [kg]
  double voidage_volume_error = 0;  ///< |Σ(1−ε)V − ΣV_p| / max(ΣV_p, audit_floor ΣV) [-]
  double displaced = 0;  ///< Σ ρ (ε^{n+1} − ε sent) V: what the fluid is yet to give way to [kg]
  double epsilon_min = 0;  ///< of ε^{n+1} [-]
  double epsilon_max = 0;  ///< of ε^{n+1} [-]
  MassTotal total;         ///< to be kept if the window is committed
};

/// Σ ρ ε V [kg].
double fluid_mass(const Mesh& mesh, double density, std::span<const double> voidage);

/// The total at time 0.
MassTotal start_mass(const Mesh& mesh, double density, std::span<const double> voidage);

/// The conservative continuity cell by cell and summed over the domain (eq. 9 and 11 of "Enforcing
/// mass conservation in DPM-CFD models of dense particulate flows", the sequel to C.L. Wu et al.,
/// Chem. Eng. J. 152, 2009, 514-529). Periodic faces are internal. A value that is not finite ends
/// up in the results, which the gate refuses.
MassAudit audit_mass(const Mesh& mesh, const MassWindow& window, const MassTotal& committed);

}  // namespace fluxpact
