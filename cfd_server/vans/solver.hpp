// The volume-averaged Navier-Stokes solver: one window forward for given voidage and drag.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cfd_server/vans/phase_seconds.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/participant/participant.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// What the particle side says of the window's end; one row a cell.
struct SolidsInput {
  std::span<const double> voidage;  ///< ε^{n+1} [-]
  std::span<const double>
      drag_coefficient;  ///< B [kg/s]: force on the fluid in a cell is S − B u^{n+1} − A ∇p
  std::span<const Vector3> drag_source;  ///< S [N]
  std::span<const double>
      pressure_return{};  ///< A [m³], see field::pressure_return; empty: there is none
};

/// What a second-order step needs of the level before the last one.
struct LevelBefore {
  std::vector<double> voidage;
  std::vector<double> face_flux;  ///< Φ [kg/s]
  std::vector<Vector3> velocity;
  std::vector<double> passed;  ///< F [kg/s]: mass that passed in the last step, over its length
};

/// Means over a window where they differ from the values at its end: with inner steps, and the flux
/// in a second-order step. Empty otherwise.
struct WindowMeans {
  std::vector<double> face_flux;
  std::vector<Vector3> velocity;
  std::vector<Vector3> pressure_gradient;
};

/// The fluid at the end of a window.
struct FluidState {
  std::vector<double> voidage;    ///< ε the state was solved with, bit for bit as received
  std::vector<double> face_flux;  ///< Φ [kg/s], superficial, out of the owner
  std::vector<Vector3> velocity;  ///< u [m/s], interstitial
  std::vector<double> pressure;   ///< p_d = p − ρ g·x [Pa]
  std::vector<Vector3> pressure_gradient;  ///< [Pa/m] that closes the cell's momentum balance
  double step = 0;                         ///< [s] length of the step that led here; 0 at the start
  LevelBefore before;                      ///< empty with `time: euler`
  WindowMeans means;
};

/// What the other side and the audit see of a window: mass that passed through each face over the
/// window's length [kg/s], the velocity [m/s] on which drag acted, and the pressure gradient
/// [Pa/m].
std::span<const double> window_flux(const FluidState& state);
std::span<const Vector3> window_velocity(const FluidState& state);
std::span<const Vector3> window_pressure_gradient(const FluidState& state);

/// How the last window went.
struct FluidReport {
  int inner_steps = 0;
  int second_order_steps = 0;    ///< of these, with `time: bdf2`
  int iterations = 0;            ///< of the pressure solver, all correctors
  int predictor_iterations = 0;  ///< of the momentum predictor
  int legacy_iterations = 0;     ///< passes over the lagged mass source (continuity: legacy)
  double legacy_change = 0;  ///< last relative change of a flux where those passes ran out, else 0
  double closure_correction = 0;  ///< largest flux change by the closure over the largest flux [-]
  PhaseSeconds seconds;
};

class FlowFields;
class FluidScalars;
class Turbulence;

class VansSolver {
 public:
  /// Throws ConfigError if the scene cannot be solved on this mesh (a patch without a condition,
  /// ...).
  VansSolver(const Scene& scene, const Mesh& mesh);
  ~VansSolver();

  /// The state of time 0 for this voidage: the scene's initial superficial velocity, closed fluxes
  /// at the boundary.
  void start(std::span<const double> voidage);

  /// From the committed state to a candidate. Throws NumericsError naming field, cell, value, step.
  void advance(const Window& window, const SolidsInput& solids, const Progress& progress);
  void commit();
  void rollback();
  /// The next window depends on the committed state only, not on the set-up of the linear solver
  /// that earlier ones left: what goes on from here and what is restored here give the same bits.
  void forget_setup();

  const FluidState& committed() const;
  const FluidState& candidate() const;
  const FluidReport& report() const;
  /// Nothing if the scene has none.
  const FluidScalars* scalars() const;
  const Turbulence* turbulence() const;
  /// Of the candidate, or after `start` of the committed state; nothing if no force asks for them.
  const FlowFields* flow_fields() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fluxpact
