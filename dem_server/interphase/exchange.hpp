// Momentum between fluid and particles, exact in both directions and stable for any window.
//
// Partial elimination: at the end of a window each particle i offers the fluid the law
//   impulse(u) = Δt k (u − v*),   k = ζ/(1 + b),  b = ζ Δt/m,
// where v* is the velocity that it would have after the coming window without drag. The fluid
// solves with the sums of k and k v* in its cells. In the next window the impulse is evaluated
// ONCE, with the stored k, v* and weights and the fluid's answer u, and acts on the particle as a
// constant force. So what the fluid lost the particles gain, to round-off; and a particle in free
// flight ends at (v* + b u)/(1 + b), the implicit Euler value, however large b is. Partial
// elimination of interphase drag: Spalding, in Recent Advances in Numerical Methods in Fluids 1
// (1980) 139-167.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/interphase/drag.hpp"
#include "dem_server/interphase/voidage.hpp"
#include "dem_server/interphase/weights.hpp"

namespace fluxpact {

/// What stays the same for a whole run.
struct ExchangeSettings {
  FluidProperties fluid;
  Vector3 gravity{0, 0, 0};  ///< [m/s²]
  DragChoice drag;
  PressureModel model = PressureModel::a;
  bool pressure_gradient = true;  ///< −V_p ∇p_d acts on the particles (pressure model a)
  bool buoyancy = true;           ///< −ρ V_p g, the hydrostatic part of it (both models)
  bool mobile = true;  ///< false: all particles count as infinitely heavy, not only those
                       ///< that are fixed
  int threads = 1;
};

/// From the scene; `mobile` from the engine. threads = 0 in the scene: all cores.
ExchangeSettings exchange_settings(const Scene& scene, bool mobile);

/// The fluid's newest state, one row a cell, as `FluidView` has it for the weights in question.
struct FluidSeen {
  bool solved = false;  ///< false before the first fluid step: no drag impulse, no pressure yet
  std::span<const Vector3> velocity;           ///< u [m/s]
  std::span<const Vector3> pressure_gradient;  ///< ∇p_d [Pa/m], p_d = p − ρ g·x
};

/// The fluid as the particles of some weights see it: `fluid` itself, or a copy whose fields have
/// gone through `ParticleCellWeights::seen`. The buffers are reused.
class FluidView {
 public:
  FluidSeen of(const FluidSeen& fluid, const ParticleCellWeights& weights);

 private:
  std::vector<Vector3> velocity_;
  std::vector<Vector3> pressure_gradient_;
};

/// What one window offers to the fluid and keeps for the next: committed and candidate of it swap.
struct Offer {
  double window = 0;    ///< Δt [s] over which the fluid answers
  bool initial = true;  ///< made at time 0: the fluid never steps with it
  ParticleCellWeights weights;
  std::vector<double> coefficient;  ///< k [kg/s], one a particle
  std::vector<Vector3> velocity;    ///< v* [m/s], one a particle
};

/// What acts on the particles over one window, one row a particle; all constant over the window.
struct WindowForces {
  std::vector<Vector3> drag_impulse;  ///< J = Δt k (Σ w u − v*) [N s]
  std::vector<Vector3> impulse;  ///< J − Δt V_p Σ w ∇p_d [N s]: what the fluid gives and feels
  std::vector<Vector3> force;    ///< [N] impulse/Δt, and the buoyancy −ρ V_p g: for the engine
};

/// Masses [kg] and volumes [m³] of the particles.
struct ParticleBulk {
  std::vector<double> volume;
  std::vector<double> mass;
};

void measure_bulk(const ParticleState& particles, ParticleBulk& bulk);

/// The forces of the window of `length` [s] that begins, from the committed offer and the fluid's
/// answer to it. The drag impulse is that of the fluid's own step, whatever the length of this
/// window. Throws NumericsError (particle, step) if one is not finite.
void window_forces(const ExchangeSettings& settings, const Offer& offer, const FluidSeen& fluid,
                   const ParticleState& particles, const ParticleBulk& bulk, std::int64_t step,
                   double length, WindowForces& forces);

/// v* [m/s], the velocity at the end of the coming window without its drag:
///   v* = v + Δt [(1 − s) a − s J/(m Δt)],
/// a: gravity, buoyancy, and the pressure gradient of the fluid's newest state; s in [0, 1]: the
/// share of the load that contacts carried in the window just ended, s = −c·l/|l|² with the load l
/// (all but contacts, per mass) and the contact part c = Δv/Δt − l. A particle that rests on others
/// will not fall, and its contacts will answer the drag as they did; one in free flight has s = 0.
struct Prediction {
  std::span<const Vector3> velocity_before;  ///< [m/s] at the start of the window just ended
  double length = 0;                         ///< [s] of that window; 0: there was none, s = 0
  const WindowForces* forces = nullptr;      ///< that acted in it
  /// Row of each particle in that window, -1 for one that has just come in: s = 0. Empty: the same
  /// rows.
  std::span<const int> row_before = {};
};

/// Fills weights (already built), k and v* of an offer for a coming window of `offer.window`.
/// `voidage`: of the new positions, one a cell, as seen through the weights. Buffers inside are
/// reused. Throws NumericsError naming the particle if its drag coefficient is negative or not
/// finite.
class OfferMaker {
 public:
  void make(const ExchangeSettings& settings, const FluidSeen& fluid,
            std::span<const double> voidage, const ParticleState& particles,
            const ParticleBulk& bulk, const Prediction& past, Offer& offer);

  /// Of the newest offer.
  const DragSurvey& survey() const { return survey_; }

 private:
  std::vector<DragPoint> points_;
  DragSurvey survey_;
};

/// B = Σ w k [kg/s] and S = Σ w k v* [N], one row a cell: the force on the fluid is S − B u.
void deposit_offer(const Offer& offer, int threads, std::span<double> drag_coefficient,
                   std::span<Vector3> drag_source);

/// Σ w I of any vector of the particles, one row a cell, by the offer's weights.
void deposit_vectors(const ParticleCellWeights& weights, std::span<const Vector3> particle_values,
                     int threads, std::span<Vector3> cell_values);

}  // namespace fluxpact
