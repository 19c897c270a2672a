// The forces of the fluid on one sphere beside drag and pressure gradient, each a closed form.
//
// exchange.hpp sums them up at the end of a window; what acts on the sphere the fluid gets back.
// All are those of one sphere in an unbounded flow: dense beds are outside their range, except the
// added mass with its crowding.
#pragma once

#include "dem_server/interphase/drag.hpp"
#include "proto/base/vector.hpp"

namespace fluxpact {

/// C_m [-] of the added mass C_m ρ V_p. A sphere alone: 1/2 (potential flow). `zuber`: by
/// (1 + 2 φ)/(1 − φ) with φ = 1 − ε, a sphere amid its neighbours (N. Zuber, Chem. Eng. Sci. 19,
/// 1964, 897-917), for φ up to some 0.5.
double added_mass_coefficient(Crowding crowding, double voidage);

/// What a sphere meets in a shear flow.
struct LiftPoint {
  double diameter = 0;         ///< d [m]
  Vector3 slip{0, 0, 0};       ///< u − v [m/s]
  Vector3 vorticity{0, 0, 0};  ///< Ω = ∇×u [1/s]
  Vector3 spin{0, 0, 0};       ///< ω [rad/s]
};

/// Lift of a sphere that slips through a shear flow [N]:
///   F = 1.615 d² √(ρ μ/|Ω|) f(Re, β) (u − v)×Ω,  Re = ρ |u−v| d/μ,  β = d |Ω|/(2 |u−v|),
///   f = (1 − 0.3314 √β) e^{−Re/10} + 0.3314 √β up to Re = 40, 0.0524 √(β Re) above.
/// A sphere that lags behind the fluid is driven to where the fluid is faster. P.G. Saffman, J.
/// Fluid Mech. 22 (1965) 385-400 and 31 (1968) 624; f: R. Mei, Int. J. Multiphase Flow 18 (1992)
/// 145-147, for Re up to 100 and 0.005 < β < 0.4. Zero without shear or slip. f drops by
/// (1 − 0.3314 √β) e^−4, at most 0.018, at Re = 40.
Vector3 saffman_lift(const LiftPoint& point, const FluidProperties& fluid);

/// Lift of a sphere that turns relative to the fluid, with ω_r = ω − Ω/2 and V = v − u [N]:
///   F = 1/8 π d² ρ C |V| (ω_r × V)/|ω_r|,
///   C = 0.45 + (Γ − 0.45) exp(−0.05684 Re_r^0.4 Re^0.3),  Γ = Re_r/Re,  Re_r = ρ d² |ω_r|/μ.
/// For Re → 0 it is π/8 d³ ρ ω_r × V (S.I. Rubinow, J.B. Keller, J. Fluid Mech. 11, 1961, 447-459);
/// C: B. Oesterlé, T. Bui Dinh, Exp. Fluids 25 (1998) 16-22, for Re up to 140. Zero without
/// relative spin or slip. Spins are those of the contacts and of time 0: nothing here turns a
/// sphere.
Vector3 magnus_lift(const LiftPoint& point, const FluidProperties& fluid);

}  // namespace fluxpact
