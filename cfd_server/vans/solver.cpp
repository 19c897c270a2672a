#include "cfd_server/vans/solver.hpp"

#include <spdlog/spdlog.h>

#include <cmath>

#include "cfd_server/vans/window_check.hpp"
#include "cfd_server/vans/window_solver.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

void resize(FluidState& state, const Stencil& s) {
  const auto cells = static_cast<std::size_t>(s.cells);
  state.voidage.assign(cells, 1.0);
  state.face_flux.assign(static_cast<std::size_t>(s.faces), 0.0);
  state.velocity.assign(cells, Vector3::Zero());
  state.pressure.assign(cells, 0.0);
  state.pressure_gradient.assign(cells, Vector3::Zero());
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
      outlet_area[region] += s.area_size[f];
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    if (problem.conditions.kind[f - s.internal_faces] != FaceKind::pressure) continue;
    const int region = problem.regions.of_cell[s.owner[f]];
    flux[f] -= surplus[region] * s.area_size[f] / outlet_area[region];
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
      : problem(make_problem(scene, mesh)),
        fields(problem, mesh),
        initial_superficial(scene.fluid.initial.superficial) {
    resize(committed, problem.stencil);
    resize(candidate, problem.stencil);
  }

  void warn_once();

  FluidProblem problem;
  WindowFields fields;
  Vector3 initial_superficial;
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

VansSolver::VansSolver(const Scene& scene, const Mesh& mesh) {
  check_settings(scene);
  impl_ = std::make_unique<Impl>(scene, mesh);
}

VansSolver::~VansSolver() = default;

void VansSolver::start(std::span<const double> voidage) {
  Impl& self = *impl_;
  const Stencil& s = self.problem.stencil;
  check_voidage(s, voidage, 0);
  update_boundary_values(s, self.problem.conditions, voidage, self.fields.boundary);
  FluidState& state = self.committed;
  state.voidage.assign(voidage.begin(), voidage.end());
  std::vector<double> flux(static_cast<std::size_t>(s.faces));
  for (int f = 0; f < s.faces; ++f) {
    const bool given = f >= s.internal_faces &&
                       self.problem.conditions.kind[f - s.internal_faces] != FaceKind::pressure;
    flux[f] = given ? self.fields.boundary.flux[f - s.internal_faces]
                    : self.initial_superficial.dot(s.area[f]);
  }
  balance_outlets(self.problem, flux);
  for (int f = 0; f < s.faces; ++f) state.face_flux[f] = self.problem.fluid.density * flux[f];
  for (int cell = 0; cell < s.cells; ++cell) {
    state.velocity[cell] = self.initial_superficial / voidage[cell];
    state.pressure[cell] = self.problem.conditions.level;
    state.pressure_gradient[cell] = Vector3::Zero();
  }
  self.has_candidate = false;
  self.fields.pressure_solver->forget();
}

void VansSolver::advance(const Window& window, const SolidsInput& solids,
                         const Progress& progress) {
  Impl& self = *impl_;
  const FluidProblem& problem = self.problem;
  WindowFields& fields = self.fields;
  self.has_candidate = false;
  check_window(problem.stencil, window, solids);
  self.report = {};
  fields.pressure_solver->begin_window();
  open_window(problem, self.committed, window, solids, fields, self.report);
  pre_correct(problem, self.committed, window, solids.voidage, fields, self.report);
  if (progress) progress();
  predict(problem, solids.voidage, fields, self.report);
  for (int corrector = 1; corrector <= problem.numerics.correctors; ++corrector) {
    const bool last = corrector == problem.numerics.correctors;
    correct(problem, self.committed, window, solids.voidage, last, fields, self.report);
    if (progress) progress();
  }
  FluidState& next = self.candidate;
  std::ranges::copy(solids.voidage, next.voidage.begin());
  std::ranges::copy(fields.mass_flux, next.face_flux.begin());
  std::ranges::copy(fields.velocity, next.velocity.begin());
  std::ranges::copy(fields.closing_gradient, next.pressure_gradient.begin());
  for (int cell = 0; cell < problem.stencil.cells; ++cell) {
    next.pressure[cell] = fields.pressure[cell] + problem.conditions.level;
  }
  check_finite(problem.stencil, next, window.step);
  self.has_candidate = true;
  self.warn_once();
}

void VansSolver::commit() {
  if (!impl_->has_candidate)
    throw NumericsError("fluid: there is no candidate to commit; advance must come first");
  std::swap(impl_->committed, impl_->candidate);
  impl_->fields.pressure_solver->commit();
  impl_->has_candidate = false;
}

void VansSolver::rollback() { impl_->has_candidate = false; }
void VansSolver::forget_setup() { impl_->fields.pressure_solver->forget(); }

const FluidState& VansSolver::committed() const { return impl_->committed; }
const FluidState& VansSolver::candidate() const { return impl_->candidate; }
const FluidReport& VansSolver::report() const { return impl_->report; }

}  // namespace fluxpact
