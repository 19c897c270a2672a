// Momentum between fluid and particles, exact in both directions; drag is stable for any window.
//
// Partial elimination: at the end of a window each particle i offers the fluid the law
//   impulse(u) = Δt k (u − q),   k = ζ/(1 + θ b),  b = ζ Δt/m,  q = θ v* + (1 − θ) v0,
// where v0 is its velocity and v* the one that it would have after the coming window without drag.
// The fluid solves with the sums of k and k q in its cells. In the next window the impulse is
// evaluated ONCE, with the stored k, q and weights and the fluid's answer u, and acts on the
// particle as a constant force. So what the fluid lost the particles gain, to round-off; and a
// particle in free flight has had the drag Δt ζ (u − θ v1 − (1 − θ) v0) of its velocity v1 at the
// end and v0 at the start: with θ = 1, Euler's implicit rule, v1 = (v* + b u)/(1 + b), stable
// however large b is. Partial elimination of interphase drag: Spalding, in Recent Advances in
// Numerical Methods in Fluids 1 (1980) 139-167.
//
// θ = 1/2 + 3/2 b up to b = 1/3, and 1 from there: second order in b where the window resolves the
// drag. With θ in [1/2, 1] the slip never overshoots, and what bounds b (below) is above 1/3 for
// φ < 0.7, so it bounds it as for θ = 1. (The exact θ = 1/(1 − e^−b) − 1/b, of a constant u, is no
// better for b → 0, but halves that bound: k Δt/m is 1 − e^−b then, not b/(1 + b).)
//
// Other forces, if the scene asks for them, enter the same law: impulse(u) = Δt [k (u − q) + E].
// Viscous force and lift are E, known from the fluid's last state; v* has their effect, too. The
// viscous force takes (1 − ε) of the fluid's own, a window late: stable, since the fluid keeps the
// whole of it implicit.
//
// Added mass M = C_m ρ V_p: M (Du/Dt − dv/dt) over the window from (u0, v0) to (u1, v1) is
//   M [(u1 − u0)/Δt + (u0·∇)u0 − (v1 − v0)/Δt] = M/Δt (u1 − v1) − M/Δt (u0 − v0) + M (u0·∇)u0.
// The first part is a drag: Z = ζ + M/Δt stands in the place of ζ. The last is in E. The second
// belongs to the drag whatever contacts do, and so does ζ u' of an eddy: together a lead
//   l = [ζ u' − M/Δt (u0 − v0)]/Z,   impulse(u) = Δt k (u − (v* − l)),   k = Z/(1 + Z Δt/m),
// which is Z (u1 − v1 + l) for the velocity v1 to which it leads: θ is 1 with added mass. No
// density ratio is too small: without other forces the slip becomes s1 = s0 (1 + R M)/(1 + R (M + ζ
// Δt)), R = 1/m + 1/m_fluid, between 0 and s0 for any Δt.
//
// With it the pressure gradient is eliminated, too (model a), because a liquid and its particles
// accelerate each other through it: v* = v*_0 − a ∇p, a = (1 − s) Δt/ρ_p (s: see prediction.hpp),
// and the fluid gets Σ w k a ∇p with the ∇p that it solves for. Taken from the window before, it is
// stable only up to B + 2 φ β < 2 ε, B = b/(1 + b + M/m), β = (b + M/m)/(1 + b + M/m): at best for
// φ < 1/4 when b is large. Eliminated, a uniform suspension with a given flux keeps its slip within
// s1/s0 = 1 − B/(ε + φ β), in (0, 1), for any Δt and φ.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/interphase/dispersion.hpp"
#include "dem_server/interphase/drag.hpp"
#include "dem_server/interphase/voidage.hpp"
#include "dem_server/interphase/weights.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

class OwnDisturbance;
struct Prediction;

/// What stays the same for a whole run.
struct ExchangeSettings {
  FluidProperties fluid;
  Vector3 gravity{0, 0, 0};  ///< [m/s²]
  DragChoice drag;
  PressureModel model = PressureModel::a;
  bool pressure_gradient = true;  ///< −V_p ∇p_d acts on the particles (pressure model a)
  bool buoyancy = true;           ///< −ρ V_p g, the hydrostatic part of it (both models)
  bool viscous = false;           ///< V_p ∇·τ
  bool added_mass = false;
  bool pressure_returns = false;  ///< the pressure gradient is eliminated as drag is
  bool saffman_lift = false;
  bool magnus_lift = false;
  bool turbulent_dispersion = false;
  Crowding crowding = Crowding::none;  ///< of added mass
  std::uint64_t seed = 1;              ///< of turbulent dispersion
  bool mobile = true;  ///< false: all particles count as infinitely heavy, not only those
                       ///< that are fixed
  int threads = 1;
  const OwnDisturbance* own = nullptr;  ///< none: drag is that of the slip as seen

  /// Whether an offer has forces E beside the drag.
  bool has_known() const { return viscous || added_mass || saffman_lift || magnus_lift; }
};

/// From the scene; `mobile` from the engine. threads = 0 in the scene: all cores.
ExchangeSettings exchange_settings(const Scene& scene, bool mobile);

/// The fluid's newest state, one row a cell, as `FluidView` has it for the weights in question.
struct FluidSeen {
  bool solved = false;  ///< false before the first fluid step: no drag impulse, no pressure yet
  std::span<const Vector3> velocity;           ///< u [m/s]
  std::span<const Vector3> pressure_gradient;  ///< ∇p_d [Pa/m], p_d = p − ρ g·x
  // Only what the settings ask for; see field_names.hpp.
  std::span<const Vector3> viscous_force{};            ///< [N/m³]
  std::span<const Vector3> convective_acceleration{};  ///< [m/s²]
  std::span<const Vector3> vorticity{};                ///< [1/s]
  std::span<const double> turbulent_energy{};          ///< k [m²/s²]
  std::span<const double> turbulent_dissipation{};     ///< ε [m²/s³]
};

/// The fluid's fields of a message. Throws ProtocolError if one that the settings ask for is
/// missing.
FluidSeen fluid_seen(const ExchangeSettings& settings, const Fields& in, int cells, bool solved);

/// The fluid as the particles of some weights see it: `fluid` itself, or a copy whose fields have
/// gone through `ParticleCellWeights::seen`. The buffers are reused.
class FluidView {
 public:
  FluidSeen of(const FluidSeen& fluid, const ParticleCellWeights& weights);

 private:
  std::vector<Vector3> velocity_;
  std::vector<Vector3> pressure_gradient_;
  std::vector<Vector3> viscous_force_;
  std::vector<Vector3> convective_acceleration_;
  std::vector<Vector3> vorticity_;
  std::vector<double> turbulent_energy_;
  std::vector<double> turbulent_dissipation_;
};

/// What one window offers to the fluid and keeps for the next: committed and candidate of it swap.
struct Offer {
  double window = 0;    ///< Δt [s] over which the fluid answers
  bool initial = true;  ///< made at time 0: the fluid never steps with it, so it has drag only
                        ///< (first_window.hpp)
  ParticleCellWeights weights;
  std::vector<double> coefficient;  ///< k [kg/s], one a particle
  std::vector<Vector3> velocity;    ///< q − l [m/s], one a particle
  // Empty unless the settings ask for it; one a particle.
  std::vector<Vector3> known;    ///< E [N]
  std::vector<double> returned;  ///< k a [m³]: what drag hands back of the pressure gradient
  std::vector<Eddy> eddies;      ///< at the end of the coming window
};

/// What acts on the particles over one window, one row a particle; all constant over the window.
struct WindowForces {
  std::vector<Vector3> drag_impulse;  ///< J = Δt k (Σ w u − q) [N s], with all that is above
  std::vector<Vector3>
      impulse;  ///< J + Δt (E − V_p Σ w ∇p_d) [N s]: what the fluid gives and feels
  std::vector<Vector3> force;  ///< [N] impulse/Δt, and the buoyancy −ρ V_p g: for the engine
};

/// Masses [kg] and volumes [m³] of the particles.
struct ParticleBulk {
  std::vector<double> volume;
  std::vector<double> mass;
};

void measure_bulk(const ParticleState& particles, ParticleBulk& bulk);

/// The forces of the window of `length` [s] that begins, from the committed offer and the fluid's
/// answer to it. The drag impulse is that of the fluid's own step, whatever the length of this
/// window, and of an initial offer it is all. Throws NumericsError (particle, step) if one is not
/// finite.
void window_forces(const ExchangeSettings& settings, const Offer& offer, const FluidSeen& fluid,
                   const ParticleState& particles, const ParticleBulk& bulk, std::int64_t step,
                   double length, WindowForces& forces);

/// Fills weights (already built), k and q of an offer for a coming window of `offer.window`.
/// `voidage`: of the new positions, one a cell, as seen through the weights. Buffers inside are
/// reused. Throws NumericsError naming the particle if its drag coefficient is negative or not
/// finite, or if its own disturbance is to be corrected where no correction holds
/// (own_disturbance.hpp).
class OfferMaker {
 public:
  /// first .. last − 1 of the particles.
  struct Rows {
    int first = 0;
    int last = 0;
  };

  void make(const ExchangeSettings& settings, const FluidSeen& fluid,
            std::span<const double> voidage, const ParticleState& particles,
            const ParticleBulk& bulk, const Prediction& past, Offer& offer);

  /// Of the newest offer.
  const DragSurvey& survey() const { return survey_; }

 private:
  DragSurvey find_drag(const ExchangeSettings& settings, const Rows& rows, Offer& offer);
  int correct(const ExchangeSettings& settings, const FluidSeen& fluid,
              std::span<const double> voidage, const ParticleState& particles,
              const Prediction& past, const Rows& rows, Offer& offer);
  void add_known(const ExchangeSettings& settings, const FluidSeen& fluid,
                 const ParticleState& particles, const ParticleBulk& bulk, const Prediction& past,
                 const Rows& rows, Offer& offer);
  void eliminate(const ExchangeSettings& settings, const FluidSeen& fluid,
                 const ParticleState& particles, const ParticleBulk& bulk, const Prediction& past,
                 const Rows& rows, Offer& offer) const;

  std::vector<DragPoint> points_;
  DragSurvey survey_;
  std::vector<Vector3> lead_;  ///< l [m/s]; empty without added mass and dispersion
};

/// B = Σ w k [kg/s] and S = Σ w (k q − E) [N], one row a cell: the force on the fluid is S − B u,
/// less A ∇p where pressure returns.
void deposit_offer(const Offer& offer, int threads, std::span<double> drag_coefficient,
                   std::span<Vector3> drag_source);

/// A = Σ w k a [m³] of an offer in which pressure returns, one row a cell.
void deposit_returned(const Offer& offer, int threads, std::span<double> pressure_return);

/// Σ w I of any vector of the particles, one row a cell, by the offer's weights.
void deposit_vectors(const ParticleCellWeights& weights, std::span<const Vector3> particle_values,
                     int threads, std::span<Vector3> cell_values);

}  // namespace fluxpact
