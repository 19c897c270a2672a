#include "cfd_server/vans/solver.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <optional>

#include "cfd_server/scalars/fluid_scalars.hpp"
#include "cfd_server/turbulence/turbulence.hpp"
#include "cfd_server/vans/flow_fields.hpp"
#include "cfd_server/vans/inner_steps.hpp"
#include "cfd_server/vans/window_check.hpp"
#include "cfd_server/vans/window_solver.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"

namespace fluxpact {
namespace {

/// Below it, a failure of a step on cells with few faces has other reasons than stiffness.
constexpr double notable_stiffness = 100;

void resize(FluidState& state, const Stencil& s) {
  const auto cells = static_cast<std::size_t>(s.cells);
  state.voidage.assign(cells, 1.0);
  state.face_flux.assign(static_cast<std::size_t>(s.faces), 0.0);
  state.velocity.assign(cells, Vector3::Zero());
  state.pressure.assign(cells, 0.0);
  state.pressure_gradient.assign(cells, Vector3::Zero());
}

Vector3 initial_value(const VectorValue& formula, const Vector3& at) {
  const Vector3 value = formula(at, 0);
  if (value.allFinite()) return value;
  throw NumericsError(
      "fluid: the formula of fluid.initial.superficial has no finite value at ({:.6g}, {:.6g}, "
      "{:.6g}) m; it must be finite at all cells and faces",
      at.x(), at.y(), at.z());
}

/// Flux of pressure faces so that what flows in flows out: the surplus of each region in proportion
/// to area.
void balance_outlets(const FluidProblem& problem, std::vector<double>& flux) {
  const Stencil& s = problem.stencil;
  std::vector<double> surplus(problem.regions.list.size(), 0.0);
  std::vector<double> outlet_area(problem.regions.list.size(), 0.0);
  for (int f = s.internal_faces; f < s.faces; ++f) {
    const int region = problem.regions.of_cell[s.owner[f]];
    surplus[region] += flux[f];
    if (problem.conditions.kind[f - s.internal_faces] == FaceKind::pressure)
      outlet_area[region] += s.area_size(f);
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    if (problem.conditions.kind[f - s.internal_faces] != FaceKind::pressure) continue;
    const int region = problem.regions.of_cell[s.owner[f]];
    flux[f] -= surplus[region] * s.area_size(f) / outlet_area[region];
  }
}

void check_settings(const Scene& scene) {
  const FluidSettings& fluid = scene.fluid;
  if (!(fluid.density > 0))
    throw ConfigError("fluid.density is {} kg/m³; it must be positive", fluid.density);
  if (!(fluid.viscosity >= 0))
    throw ConfigError("fluid.viscosity is {} Pa s; it must not be negative", fluid.viscosity);
  if (fluid.numerics.correctors < 1) {
    throw ConfigError(
        "fluid.numerics.correctors is {}; at least 1 is needed, 2 keep the order of the pressure",
        fluid.numerics.correctors);
  }
}

}  // namespace

struct VansSolver::Impl {
  Impl(const Scene& scene, const Mesh& mesh)
      : problem(make_problem(scene, mesh)), initial_superficial(scene.fluid.initial.superficial) {
    if (!scene.fluid.scalars.empty())
      scalars = std::make_unique<FluidScalars>(scene, mesh, problem.stencil);
    if (scene.fluid.turbulence.model != TurbulenceModel::none) {
      turbulence = std::make_unique<Turbulence>(scene, mesh, problem.stencil, problem.conditions);
    }
    if (!asked_of_fluid(scene).empty()) flow_fields = std::make_unique<FlowFields>(scene, problem);
  }

  void warn_once();
  void advance_step(const FluidState& from, const Window& step, const SolidsInput& solids,
                    const Progress& progress, FluidState& to);
  [[noreturn]] void refuse(const Window& window, int count, const SolidsInput& solids,
                           const NumericsError& error) const;
  void carry(const FluidState& from, const FluidState& to, const Window& step);
  void finish_window(const Window& window, int inner_steps);

  FluidProblem problem;
  std::optional<WindowFields> fields;  ///< from `start` on, when the caller may have freed the mesh
  VectorValue initial_superficial;
  std::vector<double> voidage;             ///< at the end of an inner step; sized when first needed
  FluidState between;                      ///< of inner steps; sized when a window first needs them
  WindowMeans means;                       ///< of the window in hand; sized with it
  std::unique_ptr<FluidScalars> scalars;   ///< nothing if the scene has none
  std::unique_ptr<Turbulence> turbulence;  ///< nothing without a model
  std::unique_ptr<FlowFields> flow_fields;  ///< nothing if no force asks for them
  FluidState committed;
  FluidState candidate;
  FluidReport report;
  bool has_candidate = false;
  bool warned_of_closure = false;
  bool warned_of_legacy = false;
};

void VansSolver::Impl::warn_once() {
  if (report.closure_correction > 1e-2 && !warned_of_closure) {
    warned_of_closure = true;
    spdlog::warn(
        "fluid: the flux closure moves {:.1e} of the largest flux; mass is exact, but the velocity "
        "is not: lower "
        "fluid.numerics.pressure_tolerance (now {:.1e})",
        report.closure_correction, problem.numerics.pressure_tolerance);
  }
  if (report.legacy_change > 0 && !warned_of_legacy) {
    warned_of_legacy = true;
    spdlog::warn(
        "fluid: the legacy mass source still changes the fluxes by {:.1e} after "
        "fluid.numerics.legacy.iterations = {} "
        "passes",
        report.legacy_change, problem.numerics.legacy.iterations);
  }
}

/// One step of the fluid: pre-pass, predictor, correctors.
void VansSolver::Impl::advance_step(const FluidState& from, const Window& window,
                                    const SolidsInput& solids, const Progress& progress,
                                    FluidState& to) {
  const Step step{problem, from, window, solids, to};
  const TimeCoefficients time = choose_time_scheme(problem, from, solids.voidage, window.length);
  if (turbulence) fields->viscosity = turbulence->prepare(from.velocity, fields->boundary);
  open_step(step, time, *fields, report);
  pre_correct(step, *fields, report);
  if (progress) progress();
  for (int outer = 1; outer <= problem.numerics.outer_iterations; ++outer) {
    if (outer > 1) renew_convection(step, *fields, report);
    predict(step, *fields, report);
    for (int corrector = 1; corrector <= problem.numerics.correctors; ++corrector) {
      const bool last =
          outer == problem.numerics.outer_iterations && corrector == problem.numerics.correctors;
      correct(step, last, *fields, report);
      if (progress) progress();
    }
  }
#pragma omp parallel for schedule(static) num_threads(problem.stencil.threads)
  for (int cell = 0; cell < problem.stencil.cells; ++cell) {
    to.voidage[cell] = solids.voidage[cell];
    to.velocity[cell] = fields->velocity[cell];
    to.pressure[cell] = fields->pressure[cell] + problem.conditions.level;
  }
  to.step = window.length;
  if (problem.numerics.time == TimeScheme::bdf2) keep_level(from, time, to);
  ++report.inner_steps;
  report.second_order_steps += time.two_steps() ? 1 : 0;
  check_finite(problem.stencil, to, window.step);
}

/// The error of a step, with the step's number and, on cells with few faces, the limit that it may
/// have met.
void VansSolver::Impl::refuse(const Window& window, int count, const SolidsInput& solids,
                              const NumericsError& error) const {
  // Errors from within say who speaks, and some which step: once is enough.
  std::string_view what = error.what();
  if (what.starts_with("fluid")) what.remove_prefix(std::min(what.find(": ") + 2, what.size()));
  std::string text = fmt::format("fluid, step {} (coupling.window {:.3g} s in {} inner steps): {}",
                                 window.step, window.length, count, what);
  const double stiffness = stiffness_number(problem, solids, window.length / count);
  if (stiffness > notable_stiffness) {
    text += fmt::format(
        "; cells with fewer than six faces (tetrahedra, prisms, pyramids) bear drag and viscous "
        "stress of some 1000 times the inertia of a step (less in thin layers), here it is {:.3g} "
        "times; use hexahedra "
        "or polyhedra there, or a coupling.window of {:.2g} s",
        stiffness, std::min(window.length, window.length / count * 1000 / stiffness));
  }
  throw NumericsError("{}", text);
}

/// What the fluid carries, with the mass that passed in a step.
void VansSolver::Impl::carry(const FluidState& from, const FluidState& to, const Window& step) {
  if (!scalars && !turbulence) return;
  const std::span<const double> passed = to.before.passed.empty() ? to.face_flux : to.before.passed;
  const FluidStep done{problem.fluid.density,
                       step.length,
                       from.voidage,
                       to.voidage,
                       passed,
                       problem.continuity == Continuity::conservative};
  if (turbulence) turbulence->advance(done, to.velocity, fields->boundary);
  if (!scalars) return;
  scalars->advance(done, step.end(),
                   turbulence ? turbulence->eddy_viscosity() : std::span<const double>{});
}

/// The window's mean flux balances what the voidage changed by, to the last digit.
void VansSolver::Impl::finish_window(const Window& window, int inner_steps) {
  WindowMeans& of_window = candidate.means;
  if (inner_steps == 1) {
    // No new memory where windows with one step follow each other.
    of_window.face_flux.clear();
    of_window.velocity.clear();
    of_window.pressure_gradient.clear();
  }
  if (inner_steps == 1 && problem.numerics.time == TimeScheme::euler) return;
  if (inner_steps == 1) of_window.face_flux = candidate.before.passed;
  if (problem.continuity == Continuity::legacy) return;
  const Stencil& s = problem.stencil;
  for (int cell = 0; cell < s.cells; ++cell) {
    fields->storage[cell] = problem.fluid.density * s.volume[cell] *
                            (candidate.voidage[cell] - committed.voidage[cell]) / window.length;
  }
  for (int b = 0; b < s.boundary_faces(); ++b) {
    fields->boundary.flux[b] =
        candidate.means.face_flux[b + s.internal_faces] / problem.fluid.density;
  }
  settle_closed_regions(s, problem.regions, fields->boundary.flux, problem.fluid.density,
                        window.length, window.step, fields->storage);
  close_fluxes(fields->tree, s, fields->storage, candidate.means.face_flux);
}

VansSolver::VansSolver(const Scene& scene, const Mesh& mesh) {
  check_settings(scene);
  impl_ = std::make_unique<Impl>(scene, mesh);
}

VansSolver::~VansSolver() = default;

void VansSolver::start(std::span<const double> voidage) {
  Impl& self = *impl_;
  const Stencil& s = self.problem.stencil;
  check_voidage(s, voidage, 0);
  if (!self.fields) {
    self.fields.emplace(self.problem);
    resize(self.committed, s);
    resize(self.candidate, s);
  }
  update_boundary_values(s, self.problem.conditions, voidage, 0, self.fields->boundary);
  FluidState& state = self.committed;
  state.voidage.assign(voidage.begin(), voidage.end());
  std::vector<double> flux(static_cast<std::size_t>(s.faces));
  for (int f = 0; f < s.faces; ++f) {
    const bool given = f >= s.internal_faces &&
                       self.problem.conditions.kind[f - s.internal_faces] != FaceKind::pressure;
    const Vector3 at = s.centre[s.owner[f]] + s.from_owner[f];
    flux[f] = given ? self.fields->boundary.flux[f - s.internal_faces]
                    : initial_value(self.initial_superficial, at).dot(s.area[f]);
  }
  balance_outlets(self.problem, flux);
  for (int f = 0; f < s.faces; ++f) state.face_flux[f] = self.problem.fluid.density * flux[f];
  for (int cell = 0; cell < s.cells; ++cell) {
    state.velocity[cell] = initial_value(self.initial_superficial, s.centre[cell]) / voidage[cell];
    state.pressure[cell] = self.problem.conditions.level;
    state.pressure_gradient[cell] = Vector3::Zero();
  }
  state.step = 0;
  state.before = {};
  state.means = {};
  if (self.scalars) self.scalars->start();
  if (self.turbulence) self.turbulence->start();
  if (self.flow_fields) {
    self.flow_fields->update(state.velocity, state.voidage, self.fields->boundary);
  }
  self.has_candidate = false;
  self.fields->pressure_solver->forget();
}

void VansSolver::advance(const Window& window, const SolidsInput& solids,
                         const Progress& progress) {
  Impl& self = *impl_;
  const FluidProblem& problem = self.problem;
  self.has_candidate = false;
  if (!self.fields) {
    throw NumericsError("fluid, step {}: there is no state to go on from; start must come first",
                        window.step);
  }
  check_window(problem.stencil, window, solids);
  self.report = {};
  self.fields->pressure_solver->begin_window();
  update_boundary_values(problem.stencil, problem.conditions, solids.voidage, window.end(),
                         self.fields->boundary);
  const double courant =
      courant_number(problem, self.committed, self.fields->boundary, solids.voidage, window.length);
  const int count = count_inner_steps(courant, problem.numerics.courant_limit, window);
  if (count > 1 && self.between.voidage.empty()) {
    resize(self.between, problem.stencil);
    self.voidage.resize(problem.stencil.volume.size());
  }
  if (self.scalars) self.scalars->open_window();
  if (self.turbulence) self.turbulence->open_window();
  const FluidState* from = &self.committed;
  for (int number = 1; number <= count; ++number) {
    const bool last = number == count;
    if (!last) {
      interpolate_voidage(self.committed.voidage, solids.voidage, number, count, self.voidage);
    }
    const SolidsInput at_end{last ? solids.voidage : std::span<const double>(self.voidage),
                             solids.drag_coefficient, solids.drag_source, solids.pressure_return};
    FluidState& to = from == &self.candidate ? self.between : self.candidate;
    try {
      const Window step = inner_window(window, number, count);
      self.advance_step(*from, step, at_end, progress, to);
      if (last) check_courant(problem, to, self.fields->boundary, window);
      self.carry(*from, to, step);
    } catch (const NumericsError& error) {
      self.refuse(window, count, solids, error);
    }
    if (count > 1) add_to_means(to, number, count, self.means);
    from = &to;
  }
  if (from == &self.between) std::swap(self.between, self.candidate);
  if (count > 1) std::swap(self.means, self.candidate.means);
  self.finish_window(window, count);
  if (self.scalars) self.scalars->close_window(window.length);
  if (self.flow_fields) {
    self.flow_fields->update(window_velocity(self.candidate), self.candidate.voidage,
                             self.fields->boundary);
  }
  self.has_candidate = true;
  self.warn_once();
}

void VansSolver::commit() {
  if (!impl_->has_candidate)
    throw NumericsError("fluid: there is no candidate to commit; advance must come first");
  std::swap(impl_->committed, impl_->candidate);
  if (impl_->scalars) impl_->scalars->commit();
  if (impl_->turbulence) impl_->turbulence->commit();
  impl_->fields->pressure_solver->commit();
  impl_->has_candidate = false;
}

void VansSolver::rollback() { impl_->has_candidate = false; }
void VansSolver::forget_setup() {
  if (impl_->fields) impl_->fields->pressure_solver->forget();
}

std::span<const double> window_flux(const FluidState& state) {
  return state.means.face_flux.empty() ? state.face_flux : state.means.face_flux;
}

std::span<const Vector3> window_velocity(const FluidState& state) {
  return state.means.velocity.empty() ? state.velocity : state.means.velocity;
}

std::span<const Vector3> window_pressure_gradient(const FluidState& state) {
  return state.means.pressure_gradient.empty() ? state.pressure_gradient
                                               : state.means.pressure_gradient;
}

const FluidState& VansSolver::committed() const { return impl_->committed; }
const FluidState& VansSolver::candidate() const { return impl_->candidate; }
const FluidReport& VansSolver::report() const { return impl_->report; }
const FluidScalars* VansSolver::scalars() const { return impl_->scalars.get(); }
const Turbulence* VansSolver::turbulence() const { return impl_->turbulence.get(); }
const FlowFields* VansSolver::flow_fields() const { return impl_->flow_fields.get(); }

}  // namespace fluxpact
