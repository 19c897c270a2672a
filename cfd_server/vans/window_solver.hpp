// One step of the fluid, piece by piece: what `VansSolver::advance` puts in order. A step is a
// window or, where the Courant number asks for it, a part of one.
//
// Plain arrays, sized once; the functions fill them from left to right: coefficients -> pre-pass ->
// predictor -> correctors -> closed fluxes.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cfd_server/linear/pressure_solver.hpp"
#include "cfd_server/vans/face_flux.hpp"
#include "cfd_server/vans/flux_closure.hpp"
#include "cfd_server/vans/pressure_equation.hpp"
#include "cfd_server/vans/solver.hpp"

namespace fluxpact {

/// Fixed for a run.
struct FluidProblem {
  std::optional<Lattice> lattice;  ///< of the mesh
  Stencil stencil;
  BoundaryConditions conditions;
  FluidRegions regions;
  FluidProperties fluid;
  FluidNumerics numerics;
  Continuity continuity = Continuity::conservative;
  PressureModel model = PressureModel::a;
  AxisVectors gradient;        ///< least-squares coefficients of velocities, one a side
  AxisVectors reconstruction;  ///< one a side
};

FluidProblem make_problem(const Scene& scene, const Mesh& mesh);

/// Fields and coefficients of the step in hand. One entry a cell unless stated.
struct WindowFields {
  explicit WindowFields(const FluidProblem& problem);

  TimeCoefficients time;
  ViscosityFields viscosity;  ///< of turbulence, set before the step; empty without
  BoundaryValues boundary;
  MomentumCoefficients momentum;
  FaceCoefficients faces;
  PressureMatrix matrix;
  ClosureTree tree;
  MomentumSolver predictor;
  std::unique_ptr<PressureSolver> pressure_solver;

  std::vector<double> storage;     ///< ρ V dε/dt [kg/s]
  std::vector<double> source;      ///< right-hand side of continuity [m³/s]
  std::vector<double> convecting;  ///< Φ [kg/s] at the step's end; bdf2 or outer iterations only
  std::vector<double> share;  ///< χ where it is not ε: 1 with pressure model b, ε + A/V where
                              ///< particles return pressure (sized by the first who do)
  std::vector<double> flux;   ///< φ of the last corrector [m³/s], one a face
  std::vector<double> flux_before;  ///< φ from which a corrector started [m³/s], one a face
  std::vector<double> pressure;     ///< p − level [Pa]
  std::vector<double> rhs;
  std::vector<Vector3> superficial;         ///< ε u of the last corrector
  std::vector<Vector3> velocity;            ///< u of the last corrector
  std::vector<Vector3> velocity_before;     ///< u from which it started
  std::vector<Vector3> force;               ///< C(velocity_before) [N]
  std::vector<Vector3> specific_force;      ///< (C + S)/(χ V) [N/m³]
  std::vector<Vector3> pressure_slope;      ///< kinked ∇p [Pa/m], non-orthogonal meshes only
  std::vector<Vector3> slope_coefficients;  ///< of it, one a side
  std::vector<Matrix3> velocity_gradient;   ///< until the superficial one takes its place
  std::span<Matrix3> superficial_gradient;  ///< in the place of the former, or in own_gradient
  std::vector<Vector3> jump;                ///< one a boundary face

  // continuity: legacy; empty else
  std::vector<double> explicit_part;      ///< of the flux [m³/s], one a face
  std::vector<double> face_scale;         ///< one a face: 1/ε_f
  std::vector<double> face_voidage;       ///< one a face
  std::vector<double> interstitial_flux;  ///< Λ/ρ [m³/s], one a face
  std::vector<Vector3> voidage_gradient;
  std::vector<Vector3> interstitial;  ///< u rebuilt from Λ
  std::vector<Matrix3> own_gradient;  ///< of ε u: that of u is needed to the end
};

/// One step: from the old state over `window`, with the solids at its end.
struct Step {
  const FluidProblem& problem;
  const FluidState& old_state;
  const Window& window;
  const SolidsInput& solids;
  FluidState& new_state;  ///< sized; gets the flux of the last corrector and the pressure gradient
};

/// Everything that stays the same in all correctors of a step. `time` says how the old levels
/// enter.
void open_step(const Step& step, const TimeCoefficients& time, WindowFields& fields,
               FluidReport& report);

/// One pressure correction from `velocity`: new pressure, flux, velocity and the pressure gradient
/// that closes each cell's momentum. With `last` the fluxes are closed before the velocity is
/// rebuilt from them.
void correct(const Step& step, bool last, WindowFields& fields, FluidReport& report);

/// Before the predictor: start from ε^n u^n/ε^{n+1} and find the pressure that goes with the new
/// voidage and drag. A cell that leaves the bed would otherwise keep the bed's gradient without its
/// drag, and shoot up.
void pre_correct(const Step& step, WindowFields& fields, FluidReport& report);

/// Before the predictor of a further outer iteration: the newest flux convects.
void renew_convection(const Step& step, WindowFields& fields, FluidReport& report);

/// Implicit momentum with the gradient in hand.
void predict(const Step& step, WindowFields& fields, FluidReport& report);

}  // namespace fluxpact
