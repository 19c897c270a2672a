// The drag of the fluid on one sphere: the coefficient ζ [kg/s] in force = ζ (u − v), for the
// voidage and slip that it sees. Called once for all particles, after the voidage.
//
// With pressure and stress shared between the phases (model A) the drag is what is left of the
// fluid's whole force F on a sphere without the part that the pressure gradient of the bed gives
// it: in a uniform bed ε F. Papers state one or the other, with the superficial slip U = ε|u − v|
// or the interstitial one; here all is brought to ζ of model A. Of a coefficient β [kg/(m³ s)] per
// volume of bed, n = (1 − ε)/V_p spheres per volume share equally:
//   ζ = V_p β/(1 − ε).
// Where the fluid alone bears the pressure gradient (model B) the same bed needs ζ/ε (Gidaspow
// 1994). Re below is ρ U d/μ with the superficial slip, unless said otherwise.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "proto/scene/drag_formula.hpp"
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

// Each law is finite without slip, and continuous in slip and voidage where nothing else is said.
// drag_range() has the ranges as numbers.

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

/// ψ Wen-Yu + (1 − ψ) Ergun with ψ = 1/2 + atan(150·1.75 (ε − 0.8))/π: the law of Gidaspow without
/// its jump; ψ goes from 0.1 to 0.9 within ±0.012 of ε = 0.8, and its tails reach far: 0.8 % of
/// Ergun's law is left at ε = 0.95. Lu and Gidaspow, Chem. Eng. Sci. 58 (2003) 3777-3792. ζ [kg/s].
double huilin_gidaspow_drag(const DragPoint& point, const FluidProperties& fluid);

/// ζ = 3 π μ d: one sphere in creeping flow, Re well below 1. Stokes (1851). [kg/s]
double stokes_drag(const DragPoint& point, const FluidProperties& fluid);

/// One sphere without neighbours, whatever the voidage: ζ = 3 π μ d (1 + 0.15 Re^0.687) up to Re =
/// 1000, C_D = 0.44 above (there it steps by 0.4 %), Re = ρ |u−v| d/μ: interstitial. ε near 1, Re
/// up to the drag crisis at 2e5. Schiller and Naumann, VDI-Z. 77 (1933) 318-320. ζ [kg/s].
double schiller_naumann_drag(const DragPoint& point, const FluidProperties& fluid);

/// The sphere alone in the superficial flow, times ε^−χ: ζ = π/8 C_D ρ d² ε² |u−v| ε^−χ, C_D =
/// (0.63 + 4.8/√Re)² (Dallavalle 1948: 4 % below Stokes for Re → 0), χ = 3.7 − 0.65 exp(−(1.5 −
/// log10 Re)²/2). ε 0.4 to 1, Re 0.01 to 1e4. Di Felice, Int. J. Multiphase Flow 20 (1994) 153-159,
/// whose force is that of model A: ε times the effective weight in a suspension. ζ [kg/s].
double di_felice_drag(const DragPoint& point, const FluidProperties& fluid);

/// By the ratio V_r of the settling velocities of a suspension and one sphere (Garside and
/// Al-Dibouni 1977): ζ = π/8 C_D ρ d² ε |u−v|/V_r², C_D = (0.63 + 4.8/√(Re/V_r))² (Dallavalle: 4 %
/// below Stokes for Re → 0), V_r = (A − s + √((s − A)² + 4 s B))/2, s = 0.06 Re, A = ε^4.14, B = c
/// ε^1.28 up to ε = 0.85, ε^d above; Re = ρ |u−v| d/μ: interstitial. Steps at 0.85 unless d = 1.28
/// + ln c/ln 0.85; with the published c = 0.8, d = 2.65 by less than 0.1 %. In dense beds ζ falls
/// with Re at first, at ε = 0.4 to 0.38 of its value without slip at Re = 1.3. ε 0.4 to 1, Re up to
/// 1e4. Syamlal and O'Brien, AIChE Symp. Ser. 85 (1989) 22-31; "The derivation of a drag
/// coefficient formula from velocity-voidage correlations", technical note, US DOE 1987. ζ [kg/s].
double syamlal_obrien_drag(const DragPoint& point, const FluidProperties& fluid,
                           const SyamlalObrienSettings& constants);

/// ζ = 3 π μ d ε² (F₀ + F₃ Re/2), φ = 1 − ε: F₀ = (1 + 3 √(φ/2) + 135/64 φ ln φ + 16.14 φ)/(1 +
/// 0.681 φ − 8.48 φ² + 8.16 φ³) for φ < 0.4, 10 φ/(1 − φ)³ from there on (it steps up by 1 %), F₃ =
/// 0.0673 + 0.212 φ + 0.0232/(1 − φ)⁵. The whole force of the fluid in the paper, with Re of the
/// radius there. Random arrays, φ up to 0.64, Re up to some 200; for φ → 0 and Re → 0 Stokes, but
/// 1 + 0.045 Re at Re above 1, which is not the drag of one sphere. Hill, Koch and Ladd, J. Fluid
/// Mech. 448 (2001) 213-241 and 243-278; Koch and Hill, Annu. Rev. Fluid Mech. 33 (2001) 619-647.
/// ζ [kg/s].
double koch_hill_drag(const DragPoint& point, const FluidProperties& fluid);

/// ζ = 3 π μ d ε F, φ = 1 − ε: F = 10 φ/ε² + ε² (1 + 1.5 √φ) + 0.413 Re/(24 ε²) (1/ε + 3 ε φ + 8.4
/// Re^−0.343)/(1 + 10^(3φ) Re^−(1+4φ)/2). Random arrays, φ 0.1 to 0.6, Re up to 1000; towards
/// one sphere it ends 16 % above Schiller and Naumann at Re = 100, 68 % at 1000. All spheres equal
/// (for mixtures the paper corrects by size; that is not done here). Beetstra, van der Hoef and
/// Kuipers, AIChE J. 53 (2007) 489-501. ζ [kg/s].
double beetstra_drag(const DragPoint& point, const FluidProperties& fluid);

/// ζ = 3 π μ d ε F, φ = 1 − ε: F = 10 φ/ε² + ε² (1 + 1.5 √φ) + (0.11 φ (1 + φ) − 0.00456/ε⁴ +
/// (0.169 ε + 0.0644/ε⁴) Re^−0.343) Re. Random arrays at rest, φ up to 0.6, Re up to 1000; within
/// 20 % of one sphere for φ → 0; beyond some 8e4 it turns negative for ε near 1. Tang, Peters,
/// Kuipers, Kriebitzsch and van der Hoef, AIChE J. 61 (2015) 688-698, eq. 21. ζ [kg/s].
double tang_drag(const DragPoint& point, const FluidProperties& fluid);

/// Where a law was found to hold: voidage, and Re = ρ ε|u−v| d/μ from 0.
struct DragRange {
  double least_voidage = 0;
  double most_voidage = 1;
  double most_reynolds = 0;
};

/// Of a law that is looked up; everything for `none` and `expression`.
DragRange drag_range(DragLaw law);

/// The law of a run.
struct DragChoice {
  DragLaw law = DragLaw::none;
  SyamlalObrienSettings syamlal_obrien{};        ///< law syamlal_obrien
  std::shared_ptr<const DragFormula> formula{};  ///< law expression
};

/// Throws ConfigError if the formula of law expression cannot be read.
DragChoice drag_choice(const InterphaseSettings& interphase);

/// What the coefficients of all spheres showed.
struct DragSurvey {
  std::int64_t outside = 0;  ///< spheres beyond the range of the law
  int first_bad = -1;        ///< row of the first coefficient that is not finite, or negative
};

/// ζ [kg/s] of all spheres, row by row; the law is chosen once, outside the loop.
DragSurvey drag_coefficients(const DragChoice& choice, PressureModel model,
                             const FluidProperties& fluid, std::span<const DragPoint> points,
                             int threads, std::span<double> coefficients);

/// Throws NumericsError that says which coefficient cannot be one, where, and what to do.
[[noreturn]] void throw_bad_drag(DragLaw law, const std::string& whose, const DragPoint& point,
                                 double coefficient);

}  // namespace fluxpact
