// The drag of the fluid on one sphere: the coefficient ζ [kg/s] in force = ζ (u − v), for the
// voidage and slip that it sees. Called once for all particles, after the voidage.
//
// The laws are written for the momentum exchange β [kg/(m³ s)] per volume of bed; with pressure and
// stress shared between the phases (model A), n = (1 − ε)/V_p spheres per volume share it equally:
//   ζ = V_p β/(1 − ε).
// Where the fluid alone bears the pressure gradient (model B) the same bed needs ζ/ε (Gidaspow
// 1994).
#pragma once

#include <span>

#include "proto/scene/scene.hpp"

namespace fluxpact {

struct FluidProperties {
  double density = 0;    ///< ρ [kg/m³]
  double viscosity = 0;  ///< μ [Pa s]
};

/// What one sphere sees.
struct DragPoint {
  double voidage = 1;   ///< ε [-], in (0, 1]
  double diameter = 0;  ///< d [m]
  double slip = 0;      ///< |u − v| [m/s], interstitial velocities
};

/// β/(1 − ε) = 150 (1−ε) μ/(ε d²) + 1.75 ρ |u−v|/d. Packed beds, ε of about 0.35 to 0.6; Re(1−ε)⁻¹
/// up to some 1e4. Ergun, Chem. Eng. Prog. 48 (1952) 89-94. ζ [kg/s].
double ergun_drag(const DragPoint& point, const FluidProperties& fluid);

/// β/(1 − ε) = 3/4 C_D ε ρ |u−v|/d ε^−2.65, Re = ε ρ |u−v| d/μ, C_D = 24/Re (1 + 0.15 Re^0.687) up
/// to Re = 1000, 0.44 above (there it steps by 0.4 %). Dilute to moderately dense, ε above about
/// 0.8. Wen and Yu, Chem. Eng. Prog. Symp. Ser. 62 (1966) 100-111. ζ [kg/s].
double wen_yu_drag(const DragPoint& point, const FluidProperties& fluid);

/// Ergun for ε < 0.8, Wen-Yu from 0.8 on. It is NOT continuous: going up through 0.8 the drag drops
/// by 13 % for Re → 0, by 42 % at Re = 100. Gidaspow, Multiphase Flow and Fluidization, Academic
/// Press 1994, ch. 2. ζ [kg/s].
double gidaspow_drag(const DragPoint& point, const FluidProperties& fluid);

/// ζ = 3 π μ d: one sphere in creeping flow, Re well below 1. Stokes (1851). [kg/s]
double stokes_drag(const DragPoint& point, const FluidProperties& fluid);

/// ζ [kg/s] of all spheres, row by row; the law is chosen once, outside the loop.
void drag_coefficients(DragLaw law, PressureModel model, const FluidProperties& fluid,
                       std::span<const DragPoint> points, int threads,
                       std::span<double> coefficients);

}  // namespace fluxpact
