#include "coordinator/coupling/run_step.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "coordinator/coupling/check_fields.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

Message advance_message(const Window& window) {
  Message message;
  message.header.type = MessageType::advance;
  message.header.body = {{"start", window.start}, {"length", window.length}};
  return message;
}

void share_asked(Message& to, Message& from, const AskedFields& asked) {
  for (const auto* names : {&asked.scalars, &asked.vectors})
    for (const std::string& name : *names) share_array(to, from, name);
}

/// The particles move under the committed fluid state; what comes back belongs to the window's end.
Message advance_particles(const Coupling& coupling, const Window& window, CommittedState& state) {
  Message request = advance_message(window);
  for (const auto* name : {field::velocity, field::pressure_gradient})
    share_array(request, state.fluid, name);
  share_asked(request, state.fluid, asked_of_fluid(coupling.scene));
  Message result = coupling.session.ask(Role::particles, request);
  check_particle_fields(result, coupling.scene, coupling.mesh, window.step);
  return result;
}

/// The fluid moves with the new voidage and drag: the frames of the particle side go on as they
/// came.
Message advance_fluid(const Coupling& coupling, const Window& window, Message& particles) {
  Message request = advance_message(window);
  for (const auto* name : {field::voidage, field::drag_coefficient, field::drag_source})
    share_array(request, particles, name);
  share_asked(request, particles, asked_of_particles(coupling.scene));
  Message result = coupling.session.ask(Role::fluid, request);
  check_fluid_fields(result, coupling.scene, coupling.mesh, window.step);
  return result;
}

/// The budget of each scalar of the scene.
std::vector<ScalarAudit> audit_scalars(const Coupling& coupling, const Window& window,
                                       const CommittedState& state, const Fields& particles,
                                       const Fields& fluid) {
  std::vector<ScalarAudit> audits;
  if (coupling.scene.fluid.scalars.empty()) return audits;
  const int cells = coupling.mesh.cells();
  const Fields particles_before = fields_of(state.particles);
  const Fields fluid_before = fields_of(state.fluid);
  for (const auto& [name, scalar] : coupling.scene.fluid.scalars) {
    const bool heat = scalar.kind == ScalarKind::temperature;
    audits.push_back(audit_scalar(
        coupling.mesh,
        {.density = coupling.scene.fluid.density,
         .length = window.length,
         .factor = heat ? scalar.heat_capacity : 1.0,
         .voidage_before = particles_before.scalars(field::voidage, cells),
         .voidage_after = particles.scalars(field::voidage, cells),
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
               const Fields& particles, const Fields& fluid) {
  const int cells = coupling.mesh.cells();
  const Fields before = fields_of(state.particles);
  AuditRow row;
  row.step = window.step;
  row.time = window.end();
  const auto voidage = particles.scalars(field::voidage, cells);
  row.mass = audit_mass(coupling.mesh,
                        {.density = coupling.scene.fluid.density,
                         .length = window.length,
                         .voidage_before = before.scalars(field::voidage, cells),
                         .voidage_after = voidage,
                         .face_flux = fluid.scalars(field::face_flux, coupling.mesh.faces()),
                         .particle_volume = particles.number(field::particle_volume)},
                        state.mass);
  const bool returns = !asked_of_particles(coupling.scene).empty();
  row.momentum = audit_momentum(
      coupling.mesh,
      {.length = window.length,
       .pressure_gradient_force = coupling.scene.interphase.model == PressureModel::a &&
                                  has_force(coupling.scene, InterphaseForce::pressure_gradient),
       .voidage = voidage,
       .drag_coefficient = particles.scalars(field::drag_coefficient, cells),
       .drag_source = particles.vectors(field::drag_source, cells),
       .pressure_return =
           returns ? particles.scalars(field::pressure_return, cells) : std::span<const double>{},
       .velocity = fluid.vectors(field::velocity, cells),
       .pressure_gradient = fluid.vectors(field::pressure_gradient, cells),
       .impulse_taken = fluid.vectors(field::impulse_taken, cells),
       .impulse_given = particles.vectors(field::impulse_given, cells)},
      state.momentum);
  row.scalars = audit_scalars(coupling, window, state, particles, fluid);
  row.particles.window = particle_window(particles, particles_flow(coupling.scene));
  if (has_particles(coupling.scene)) {
    row.particles = audit_particles(row.particles.window, state.solids);
  }
  row.solver_iterations = static_cast<std::int64_t>(fluid.number(field::solver_iterations));
  row.wall_dem = particles.number(field::wall_seconds);
  row.wall_cfd = fluid.number(field::wall_seconds);
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
  check_particle_fields(state.particles, coupling.scene, coupling.mesh, 0);
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

  Message particles = advance_particles(coupling, window, state);
  Message fluid = advance_fluid(coupling, window, particles);

  StepResult result;
  result.row = audit(coupling, window, state, fields_of(particles), fields_of(fluid));
  result.verdict = judge(result.row, coupling.scene.coupling.audit.limit);
  result.committed =
      result.verdict.pass || coupling.scene.coupling.audit.on_violation == OnViolation::warn;
  tell_both(coupling, result.committed ? MessageType::commit : MessageType::rollback);
  if (result.committed) {
    state = {std::move(particles), std::move(fluid), result.row.mass.total,
             result.row.momentum.total, result.row.particles.total};
  }

  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  result.row.wall_exchange = wall.count() - result.row.wall_cfd - result.row.wall_dem;
  return result;
}

}  // namespace fluxpact
