#include "cfd_server/backends/native/fluid_participant.hpp"

#include <spdlog/spdlog.h>

#include <chrono>

#include "cfd_server/scalars/fluid_scalars.hpp"
#include "cfd_server/turbulence/turbulence.hpp"
#include "cfd_server/vans/flow_fields.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

void add_state(const FluidState& state, Fields& out) {
  out.add(field::face_flux, window_flux(state));
  out.add(field::velocity, window_velocity(state));
  out.add(field::pressure, std::span<const double>(state.pressure));
  out.add(field::pressure_gradient, window_pressure_gradient(state));
}

void add_scalar(const std::string& name, const ScalarField& scalar, Fields& out) {
  out.add(field::scalar(name), std::span<const double>(scalar.value));
  out.add(field::scalar_flux(name), std::span<const double>(scalar.boundary_flux));
  out.add_number(field::scalar_source(name), scalar.source);
}

}  // namespace

Identity NativeFluid::identity() const {
  Identity identity{Role::fluid,
                    "native",
                    {field::face_flux, field::velocity, field::pressure, field::pressure_gradient,
                     field::impulse_taken},
                    {field::voidage, field::drag_coefficient, field::drag_source}};
  for (std::string& name : all_asked_of_fluid()) identity.gives.push_back(std::move(name));
  return identity;
}

VansSolver& NativeFluid::solver() {
  if (!solver_)
    throw ProtocolError("fluid: called before configure; the scene and the mesh must come first");
  return *solver_;
}

void NativeFluid::configure(const Scene& scene, const Mesh& mesh) {
  solver_ = std::make_unique<VansSolver>(scene, mesh);
  cells_ = mesh.cells();
  pressure_returns_ = !asked_of_particles(scene).empty();
  impulse_.assign(static_cast<std::size_t>(cells_), Vector3::Zero());
}

void NativeFluid::start(const Fields& in, Fields& out) {
  solver().start(in.scalars(field::voidage, cells_));
  add_state(solver().committed(), out);
  if (const FlowFields* flow = solver().flow_fields()) add_flow(*flow, out);
  const FluidScalars* const scalars = solver().scalars();
  for (int i = 0; scalars != nullptr && i < scalars->count(); ++i)
    add_scalar(scalars->name(i), scalars->committed(i), out);
}

void NativeFluid::add_flow(const FlowFields& flow, Fields& out) {
  const auto add = [&](const char* name, std::span<const Vector3> values) {
    if (!values.empty()) out.add(name, values);
  };
  add(field::viscous_force, flow.viscous_force());
  add(field::convective_acceleration, flow.convective_acceleration());
  add(field::vorticity, flow.vorticity());
  if (!flow.turbulent()) return;
  const TurbulentLevel& level = solver().turbulence()->candidate();
  out.add(field::turbulent_energy, std::span<const double>(level.energy));
  out.add(field::turbulent_dissipation, std::span<const double>(level.dissipation));
}

void NativeFluid::advance(const Window& window, const Fields& in, Fields& out,
                          const Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const SolidsInput solids{
      in.scalars(field::voidage, cells_), in.scalars(field::drag_coefficient, cells_),
      in.vectors(field::drag_source, cells_),
      pressure_returns_ ? in.scalars(field::pressure_return, cells_) : std::span<const double>{}};
  solver().advance(window, solids, progress);
  const FluidState& state = solver().candidate();
  const auto velocity = window_velocity(state);
  const auto gradient = window_pressure_gradient(state);
  for (int cell = 0; cell < cells_; ++cell) {
    Vector3 force = solids.drag_source[cell] - solids.drag_coefficient[cell] * velocity[cell];
    if (pressure_returns_) force -= solids.pressure_return[cell] * gradient[cell];
    impulse_[cell] = window.length * force;
  }
  add_state(state, out);
  out.add(field::impulse_taken, std::span<const Vector3>(impulse_));
  if (const FlowFields* flow = solver().flow_fields()) add_flow(*flow, out);
  const FluidScalars* const scalars = solver().scalars();
  for (int i = 0; scalars != nullptr && i < scalars->count(); ++i)
    add_scalar(scalars->name(i), scalars->candidate(i), out);
  const FluidReport& report = solver().report();
  out.add_number(field::solver_iterations, report.iterations);
  out.add_number(field::closure_correction, report.closure_correction);
  spdlog::debug(
      "step {}: {} inner steps, {} of second order; {} pressure iterations in {:.3g} ms after "
      "{:.3g} ms of set-up; predictor {:.3g} ms, assembly {:.3g} ms, closure {:.3g} ms",
      window.step, report.inner_steps, report.second_order_steps, report.iterations,
      1e3 * report.seconds.pressure, 1e3 * report.seconds.setup, 1e3 * report.seconds.predictor,
      1e3 * report.seconds.assembly, 1e3 * report.seconds.closure);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  out.add_number(field::wall_seconds, spent.count());
}

void NativeFluid::commit() { solver().commit(); }
void NativeFluid::rollback() { solver().rollback(); }
void NativeFluid::snapshot(Fields& /*out*/) { solver().forget_setup(); }

}  // namespace fluxpact
