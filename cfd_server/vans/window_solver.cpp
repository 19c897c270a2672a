#include "cfd_server/vans/window_solver.hpp"

#include <algorithm>
#include <cmath>

#include "cfd_server/discretisation/gradient.hpp"
#include "cfd_server/discretisation/reconstruction.hpp"
#include "cfd_server/vans/kinked_gradient.hpp"
#include "cfd_server/vans/legacy_continuity.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

std::vector<SlipFace> slip_faces(const Stencil& s, const BoundaryConditions& conditions) {
  std::vector<SlipFace> faces;
  for (int f = s.internal_faces; f < s.faces; ++f) {
    if (conditions.kind[f - s.internal_faces] != FaceKind::slip) continue;
    faces.push_back({f, s.owner[f], s.area[f] / s.area_size(f),
                     1 - conditions.grip[f - s.internal_faces], 0.0});
  }
  return faces;
}

/// χ: the part of a cell's volume on which the fluid bears the pressure gradient.
std::span<const double> pressure_share(const Step& step, const WindowFields& w) {
  const bool own = step.problem.model == PressureModel::a && step.solids.pressure_return.empty();
  return own ? step.solids.voidage : std::span(w.share);
}

/// To the fluid's own share comes what the particles, pressed on, hand back by their drag.
void add_returned_pressure(const Step& step, WindowFields& w) {
  const Stencil& s = step.problem.stencil;
  w.share.resize(s.volume.size());
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    const double own = step.problem.model == PressureModel::a ? step.solids.voidage[cell] : 1.0;
    w.share[cell] = own + step.solids.pressure_return[cell] / s.volume[cell];
  }
}

/// C(u), ε u and the gradients of the velocity in hand.
void evaluate_cells(const Step& step, WindowFields& w) {
  const FluidProblem& problem = step.problem;
  const auto voidage = step.solids.voidage;
  const auto share = pressure_share(step, w);
  const Stencil& s = problem.stencil;
  boundary_jump(s, problem.conditions, w.boundary.velocity, w.velocity, w.jump);
  gradient(s, problem.gradient, w.velocity, w.jump, w.velocity_gradient);
  transport_force(s, w.momentum.faces, problem.numerics.convection, w.velocity, w.jump,
                  w.velocity_gradient, w.force);
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    w.superficial[cell] = voidage[cell] * w.velocity[cell];
    w.specific_force[cell] =
        (w.force[cell] + w.momentum.source[cell]) / (share[cell] * s.volume[cell]);
  }
  boundary_jump(s, problem.conditions, w.boundary.superficial, w.superficial, w.jump);
  gradient(s, problem.gradient, w.superficial, w.jump, w.superficial_gradient);
}

/// Pressure for the source in hand; to the explicit part in `flux` comes what it drives.
void solve_continuity(const Step& step, WindowFields& w, FluidReport& report) {
  const FluidProblem& problem = step.problem;
  const Stencil& s = problem.stencil;
  LapClock clock;
  assemble_pressure_rhs(s, w.boundary, w.faces, w.face_scale, w.source, w.flux, w.rhs);
  report.seconds.assembly += clock.lap();
  report.iterations += solve_pressure(*w.pressure_solver, s, w.matrix, w.rhs, w.pressure,
                                      problem.numerics.pressure_tolerance);
  report.seconds.pressure += clock.lap();
  add_pressure_flux(s, w.boundary, w.faces, w.pressure, w.flux);
  if (!s.orthogonal) {
    kinked_gradient(
        s, problem.conditions, w.boundary, w.momentum, step.old_state, w.time, w.slope_coefficients,
        {step.solids.voidage, pressure_share(step, w), w.pressure, w.flux}, w.pressure_slope);
  }
  report.seconds.assembly += clock.lap();
}

/// The explicit part, which may take the place of the last flux.
void evaluate_explicit_flux(const FluidProblem& problem, std::span<const double> last_flux,
                            WindowFields& w, std::span<double> explicit_part, FluidReport& report) {
  LapClock clock;
  explicit_flux(
      problem.stencil, problem.conditions, w.boundary, w.faces,
      {w.specific_force, w.superficial, w.superficial_gradient, last_flux, w.pressure_slope},
      explicit_part);
  report.seconds.assembly += clock.lap();
}

/// Pressure and fluxes; on a non-orthogonal mesh again with the slope of the pressure just found.
void solve_fluxes(const Step& step, WindowFields& w, FluidReport& report) {
  const FluidProblem& problem = step.problem;
  if (!problem.stencil.orthogonal) std::ranges::copy(w.flux, w.flux_before.begin());
  evaluate_explicit_flux(problem, w.flux, w, w.flux, report);
  if (problem.stencil.orthogonal) return solve_continuity(step, w, report);
  solve_continuity(step, w, report);
  for (int again = 0; again < problem.numerics.non_orthogonal_correctors; ++again) {
    evaluate_explicit_flux(problem, w.flux_before, w, w.flux, report);
    solve_continuity(step, w, report);
  }
}

double largest(const Stencil& s, std::span<const double> values) {
  const int count = static_cast<int>(values.size());
  double result = 0;
#pragma omp parallel for schedule(static) num_threads(s.threads) reduction(max : result)
  for (int i = 0; i < count; ++i) result = std::max(result, std::abs(values[i]));
  return result;
}

/// u_P [m/s] of the mass source, from the fluxes in hand.
void legacy_velocity(const Step& step, WindowFields& w) {
  const FluidProblem& problem = step.problem;
  const Stencil& s = problem.stencil;
  if (problem.numerics.legacy.velocity == LegacyVelocity::cells) {
    reconstruct(s, problem.reconstruction, w.flux, w.superficial_gradient, w.interstitial);
#pragma omp parallel for schedule(static) num_threads(s.threads)
    for (int cell = 0; cell < s.cells; ++cell) w.interstitial[cell] /= step.solids.voidage[cell];
    return;
  }
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) w.interstitial_flux[f] = w.flux[f] * w.face_scale[f];
  reconstruct(s, problem.reconstruction, w.interstitial_flux, w.velocity_gradient, w.interstitial);
}

/// Repeat the pressure solve with the mass source of the fluxes before until they settle.
void solve_legacy_continuity(const Step& step, WindowFields& w, FluidReport& report) {
  const FluidProblem& problem = step.problem;
  const Stencil& s = problem.stencil;
  double change = 0;
  for (int pass = 0; pass < problem.numerics.legacy.iterations; ++pass) {
    legacy_velocity(step, w);
    legacy_source(s, step.old_state.voidage, step.solids.voidage, w.voidage_gradient,
                  w.interstitial, step.window.length, w.source);
    std::ranges::copy(w.flux, w.flux_before.begin());
    std::ranges::copy(w.explicit_part, w.flux.begin());
    solve_continuity(step, w, report);
    ++report.legacy_iterations;
    change = 0;
    for (int f = 0; f < s.faces; ++f)
      change = std::max(change, std::abs(w.flux[f] - w.flux_before[f]));
    if (change <= problem.numerics.legacy.tolerance * largest(problem.stencil, w.flux)) return;
  }
  report.legacy_change = std::max(report.legacy_change, change / largest(problem.stencil, w.flux));
}

/// Fluxes in kg/s, with the continuity of every cell exact to round-off.
void close(const Step& step, WindowFields& w, FluidReport& report) {
  const std::span<double> mass_flux = step.new_state.face_flux;
  const FluidProblem& problem = step.problem;
  const Stencil& s = problem.stencil;
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) mass_flux[f] = problem.fluid.density * w.flux[f];
  if (problem.continuity == Continuity::legacy) return;
  const double correction = close_fluxes(w.tree, problem.stencil, w.storage, mass_flux);
  // In a fluid at rest all fluxes are rounding, and so is their correction: no error of the solver.
  const double rounding = 1e-13 * problem.fluid.density *
                          largest(problem.stencil, problem.stencil.volume) / step.window.length;
  report.closure_correction =
      correction > rounding ? correction / largest(problem.stencil, mass_flux) : 0.0;
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) w.flux[f] = mass_flux[f] / problem.fluid.density;
}

/// The coefficients of momentum, faces and pressure for this convecting flux [kg/s].
void assemble(const Step& step, std::span<const double> convecting, WindowFields& w,
              FluidReport& report) {
  LapClock clock;
  const FluidProblem& problem = step.problem;
  const Stencil& s = problem.stencil;
  const auto voidage = step.solids.voidage;
  assemble_momentum(s, problem.conditions, problem.fluid, step.old_state, step.solids, w.time,
                    convecting, w.viscosity, w.momentum);
  assemble_faces(s, problem.conditions, w.momentum, voidage, pressure_share(step, w),
                 step.old_state, w.time, w.faces);
  if (!s.orthogonal) {
    kinked_gradient_coefficients(s, w.momentum, voidage, pressure_share(step, w),
                                 w.slope_coefficients);
  }
  assemble_pressure_matrix(s, problem.conditions, problem.regions, w.faces, w.face_scale, w.matrix);
  report.seconds.assembly += clock.lap();
  w.pressure_solver->setup(w.matrix);
  report.seconds.setup += clock.lap();
}

}  // namespace

FluidProblem make_problem(const Scene& scene, const Mesh& mesh) {
  FluidProblem problem;
  problem.lattice = mesh.lattice;
  problem.stencil = make_stencil(mesh, threads_for(scene.fluid.numerics.threads, mesh.cells()));
  problem.conditions = read_boundaries(scene, mesh, problem.stencil);
  problem.regions = find_regions(problem.stencil, problem.conditions);
  problem.fluid = {scene.fluid.density, scene.fluid.viscosity, scene.fluid.numerics.convection};
  problem.numerics = scene.fluid.numerics;
  problem.continuity = scene.coupling.continuity;
  problem.model = scene.interphase.model;
  const bool lattice = mesh.lattice.has_value();
  problem.gradient = AxisVectors(
      gradient_coefficients(problem.stencil, faces_with_velocity(problem.conditions)), lattice);
  problem.reconstruction = AxisVectors(reconstruction_coefficients(problem.stencil), lattice);
  if (problem.continuity == Continuity::legacy) {
    for (const FluidRegion& region : problem.regions.list) {
      if (region.open) continue;
      throw ConfigError(
          "coupling.continuity: legacy does not balance inflow, outflow and storage, so every part "
          "of the domain needs "
          "a patch of type pressure to take the difference; give one in fluid.boundaries or choose "
          "'conservative'");
    }
  }
  return problem;
}

WindowFields::WindowFields(const FluidProblem& problem)
    : tree(make_closure_tree(problem.stencil, problem.conditions, problem.regions)),
      predictor(problem.stencil, slip_faces(problem.stencil, problem.conditions)),
      pressure_solver(
          make_pressure_solver(problem.numerics.solver, problem.lattice, problem.stencil)) {
  const Stencil& s = problem.stencil;
  const auto cell_count = static_cast<std::size_t>(s.cells);
  const auto face_count = static_cast<std::size_t>(s.faces);
  const auto boundary_count = static_cast<std::size_t>(s.boundary_faces());
  resize(momentum, s);
  resize(faces, s);
  matrix.diagonal.assign(cell_count, 0.0);
  matrix.coupling.assign(static_cast<std::size_t>(s.internal_faces), 0.0);
  for (auto* values : {&storage, &source, &pressure, &rhs}) values->assign(cell_count, 0.0);
  flux.assign(face_count, 0.0);
  for (auto* values : {&superficial, &velocity, &velocity_before, &force, &specific_force}) {
    values->assign(cell_count, Vector3::Zero());
  }
  if (problem.continuity == Continuity::legacy) {
    for (auto* values :
         {&explicit_part, &face_scale, &face_voidage, &interstitial_flux, &flux_before})
      values->assign(face_count, 1.0);
    for (auto* values : {&voidage_gradient, &interstitial})
      values->assign(cell_count, Vector3::Zero());
    own_gradient.assign(cell_count, Matrix3::Zero());
  }
  if (problem.numerics.time == TimeScheme::bdf2 || problem.numerics.outer_iterations > 1)
    convecting.assign(face_count, 0.0);
  if (problem.model == PressureModel::b) share.assign(cell_count, 1.0);
  if (!s.orthogonal) {
    pressure_slope.assign(cell_count, Vector3::Zero());
    slope_coefficients.assign(s.side_face.size(), Vector3::Zero());
    flux_before.assign(face_count, 0.0);
  }
  velocity_gradient.assign(cell_count, Matrix3::Zero());
  superficial_gradient = own_gradient.empty() ? velocity_gradient : own_gradient;
  jump.assign(boundary_count, Vector3::Zero());
}

void open_step(const Step& step, const TimeCoefficients& time, WindowFields& w,
               FluidReport& report) {
  LapClock clock;
  const FluidProblem& problem = step.problem;
  const FluidState& old_state = step.old_state;
  const auto voidage = step.solids.voidage;
  const Stencil& s = problem.stencil;
  const double density = problem.fluid.density;
  w.time = time;
  if (!step.solids.pressure_return.empty()) add_returned_pressure(step, w);
  update_boundary_values(s, problem.conditions, voidage, step.window.end(), w.boundary);
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    double change = time.now * (voidage[cell] - old_state.voidage[cell]);
    if (time.two_steps())
      change -= time.before * (old_state.voidage[cell] - old_state.before.voidage[cell]);
    w.storage[cell] = density * s.volume[cell] * change / time.step;
    w.pressure[cell] = old_state.pressure[cell] - problem.conditions.level;
  }
  if (problem.continuity == Continuity::conservative) {
    settle_closed_regions(s, problem.regions, w.boundary.flux, density, step.window.length,
                          step.window.step, w.storage);
#pragma omp parallel for schedule(static) num_threads(s.threads)
    for (int cell = 0; cell < s.cells; ++cell) w.source[cell] = -w.storage[cell] / density;
  } else {
    legacy_face_voidage(s, voidage, w.face_voidage);
    legacy_voidage_gradient(s, w.face_voidage, w.voidage_gradient);
#pragma omp parallel for schedule(static) num_threads(s.threads)
    for (int f = 0; f < s.faces; ++f) w.face_scale[f] = 1 / w.face_voidage[f];
  }
  std::span<const double> convecting = old_state.face_flux;
  if (time.two_steps()) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
    for (int f = 0; f < s.faces; ++f) {
      w.convecting[f] = extrapolated(time, old_state.face_flux[f], old_state.before.face_flux[f]);
    }
    convecting = w.convecting;
  }
  if (!s.orthogonal) std::ranges::copy(old_state.pressure_gradient, w.pressure_slope.begin());
  report.seconds.assembly += clock.lap();
  assemble(step, convecting, w, report);
}

void correct(const Step& step, bool last, WindowFields& w, FluidReport& report) {
  const FluidProblem& problem = step.problem;
  const Stencil& s = problem.stencil;
  LapClock clock;
  evaluate_cells(step, w);
  report.seconds.assembly += clock.lap();
  if (problem.continuity == Continuity::conservative) {
    solve_fluxes(step, w, report);
  } else {
    evaluate_explicit_flux(problem, w.flux, w, w.explicit_part, report);
    solve_legacy_continuity(step, w, report);
  }
  clock.lap();  // the solve has its own
  if (last) close(step, w, report);
  std::swap(w.velocity, w.velocity_before);
  reconstruct(s, problem.reconstruction, w.flux, w.superficial_gradient, w.velocity);
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) w.velocity[cell] /= step.solids.voidage[cell];
  if (!s.few_faces.empty()) {
    balance_cells(s, problem.conditions, w.momentum, pressure_share(step, w), w.force,
                  w.velocity_before, w.pressure_slope, w.velocity);
  }
  close_momentum(s, w.momentum, pressure_share(step, w), w.force, w.velocity_before, w.velocity,
                 step.new_state.pressure_gradient);
  report.seconds.closure += clock.lap();
}

void pre_correct(const Step& step, WindowFields& w, FluidReport& report) {
  const FluidState& old_state = step.old_state;
  const LevelBefore& before = old_state.before;
  const Stencil& s = step.problem.stencil;
  const double density = step.problem.fluid.density;
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    Vector3 start = old_state.voidage[cell] * old_state.velocity[cell];
    if (w.time.two_steps()) {
      start = extrapolated(w.time, start, Vector3(before.voidage[cell] * before.velocity[cell]));
    }
    w.velocity[cell] = start / step.solids.voidage[cell];
  }
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) w.flux[f] = old_state.face_flux[f] / density;
  correct(step, false, w, report);
  // `force` belongs to the velocity before: the predictor starts there, deferred parts included.
  std::swap(w.velocity, w.velocity_before);
}

void renew_convection(const Step& step, WindowFields& w, FluidReport& report) {
  const Stencil& s = step.problem.stencil;
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) w.convecting[f] = step.problem.fluid.density * w.flux[f];
  assemble(step, w.convecting, w, report);
  evaluate_cells(step, w);
}

void predict(const Step& step, WindowFields& w, FluidReport& report) {
  const Stencil& s = step.problem.stencil;
  LapClock clock;
  report.predictor_iterations +=
      predict_velocity(s, w.momentum, pressure_share(step, w), w.force,
                       step.new_state.pressure_gradient, w.predictor, w.velocity);
  report.seconds.predictor += clock.lap();
  if (s.uniform) return;  // no face value of the flux enters
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell)
    w.superficial[cell] = step.solids.voidage[cell] * w.velocity[cell];
  predict_flux(s, step.old_state, step.problem.fluid.density, w.superficial, w.flux);
}

}  // namespace fluxpact
