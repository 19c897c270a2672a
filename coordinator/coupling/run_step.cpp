#include "coordinator/coupling/run_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "coordinator/coupling/check_fields.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

/// The budget of each scalar of the scene.
std::vector<ScalarAudit> audit_scalars(const Coupling& coupling, const Window& window,
                                       const CommittedState& state, const Fields& solids,
                                       const Fields& fluid) {
  std::vector<ScalarAudit> audits;
  if (coupling.scene.fluid.scalars.empty()) return audits;
  const int cells = coupling.mesh.cells();
  const Fields solids_before = fields_of(state.offered);
  const Fields fluid_before = fields_of(state.fluid);
  for (const auto& [name, scalar] : coupling.scene.fluid.scalars) {
    const bool heat = scalar.kind == ScalarKind::temperature;
    audits.push_back(audit_scalar(
        coupling.mesh,
        {.density = coupling.scene.fluid.density,
         .length = window.length,
         .factor = heat ? scalar.heat_capacity : 1.0,
         .voidage_before = solids_before.scalars(field::voidage, cells),
         .voidage_after = solids.scalars(field::voidage, cells),
         .value_before = fluid_before.scalars(field::scalar(name), cells),
         .value_after = fluid.scalars(field::scalar(name), cells),
         .boundary_flux = fluid.scalars(field::scalar_flux(name),
                                        coupling.mesh.faces() - coupling.mesh.internal_faces()),
         .source = fluid.number(field::scalar_source(name))}));
  }
  return audits;
}

std::int64_t whole(const Fields& fields, std::string_view name) {
  return std::llround(fields.number(name));
}

/// What the particle side says of its particles, and of those that came in and left if they `flow`.
ParticleWindow particle_window(const Fields& particles, bool flow) {
  ParticleWindow window;
  window.count = whole(particles, field::particle_count);
  window.mass = particles.number(field::particle_mass);
  window.excess_moved = particles.number(field::excess_moved);
  if (!flow) return window;
  window.entered = whole(particles, field::particles_entered);
  window.left = whole(particles, field::particles_left);
  window.waiting = whole(particles, field::particles_waiting);
  window.mass_entered = particles.number(field::particle_mass_entered);
  window.mass_left = particles.number(field::particle_mass_left);
  window.momentum_entered = particles.vectors(field::particle_momentum_entered, 1).front();
  window.momentum_left = particles.vectors(field::particle_momentum_left, 1).front();
  return window;
}

/// The ledgers of this window, from what was sent.
AuditRow audit(const Coupling& coupling, const Window& window, const CommittedState& state,
               const Advanced& next) {
  const int cells = coupling.mesh.cells();
  const Fields before = fields_of(state.offered);
  const Fields solids = fields_of(next.offered);
  const Fields particles = fields_of(next.particles);
  const Fields fluid = fields_of(next.fluid);
  AuditRow row;
  row.step = window.step;
  row.time = window.end();
  const auto voidage = solids.scalars(field::voidage, cells);
  row.mass = audit_mass(coupling.mesh,
                        {.density = coupling.scene.fluid.density,
                         .length = window.length,
                         .voidage_before = before.scalars(field::voidage, cells),
                         .voidage_after = voidage,
                         .face_flux = fluid.scalars(field::face_flux, coupling.mesh.faces()),
                         .particle_volume = particles.number(field::particle_volume),
                         .voidage_sent = particles.scalars(field::voidage, cells)},
                        state.mass);
  const bool returns = !asked_of_particles(coupling.scene).empty();
  row.momentum = audit_momentum(
      coupling.mesh,
      {.length = window.length,
       .pressure_gradient_force = coupling.scene.interphase.model == PressureModel::a &&
                                  has_force(coupling.scene, InterphaseForce::pressure_gradient),
       .voidage = voidage,
       .drag_coefficient = solids.scalars(field::drag_coefficient, cells),
       .drag_source = solids.vectors(field::drag_source, cells),
       .pressure_return =
           returns ? solids.scalars(field::pressure_return, cells) : std::span<const double>{},
       .velocity = fluid.vectors(field::velocity, cells),
       .pressure_gradient = fluid.vectors(field::pressure_gradient, cells),
       .impulse_taken = fluid.vectors(field::impulse_taken, cells),
       .impulse_given = particles.vectors(field::impulse_given, cells)},
      state.momentum);
  row.scalars = audit_scalars(coupling, window, state, solids, fluid);
  row.particles.window = particle_window(particles, particles_flow(coupling.scene));
  if (has_particles(coupling.scene)) {
    row.particles = audit_particles(row.particles.window, state.solids);
  }
  row.solver_iterations = static_cast<std::int64_t>(fluid.number(field::solver_iterations));
  row.wall_dem = next.wall_particles;
  row.wall_cfd = next.wall_fluid;
  row.wall_both = next.wall_both;
  return row;
}

void tell_both(const Coupling& coupling, MessageType type) {
  for (const Role role : {Role::particles, Role::fluid}) {
    Message message;
    message.header.type = type;
    coupling.session.tell(role, message);
  }
}

}  // namespace

CommittedState start_coupling(const Coupling& coupling) {
  CommittedState state;
  Message request;
  request.header.type = MessageType::start;
  state.particles = coupling.session.ask(Role::particles, request);
  check_offer_fields(state.particles, coupling.scene, coupling.mesh, 0);
  check_particle_fields(state.particles, coupling.scene, coupling.mesh, 0);
  state.offered = tell_of_solids(coupling, state.particles, state.particles);
  share_array(request, state.particles, field::voidage);
  state.fluid = coupling.session.ask(Role::fluid, request);
  check_fluid_fields(state.fluid, coupling.scene, coupling.mesh, 0);
  const Fields particles = fields_of(state.particles);
  state.mass = start_mass(coupling.mesh, coupling.scene.fluid.density,
                          particles.scalars(field::voidage, coupling.mesh.cells()));
  state.solids = start_particles(whole(particles, field::particle_count),
                                 particles.number(field::particle_mass));
  return state;
}

StepResult run_step(const Coupling& coupling, const Window& window, CommittedState& state) {
  const auto begin = std::chrono::steady_clock::now();
  coupling.session.set_step(window.step, 0);

  Advanced next =
      advance_both_sides(coupling, window, {state.offered, state.particles, state.fluid});

  StepResult result;
  result.row = audit(coupling, window, state, next);
  result.verdict = judge(result.row, coupling.scene.coupling.audit.limit);
  result.committed =
      result.verdict.pass || coupling.scene.coupling.audit.on_violation == OnViolation::warn;
  tell_both(coupling, result.committed ? MessageType::commit : MessageType::rollback);
  if (result.committed) {
    state = {std::move(next.offered), std::move(next.particles), std::move(next.fluid),
             result.row.mass.total,   result.row.momentum.total, result.row.particles.total};
  }

  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  result.row.wall_exchange =
      wall.count() - result.row.wall_cfd - result.row.wall_dem + result.row.wall_both;
  return result;
}

}  // namespace fluxpact
