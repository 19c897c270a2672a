#include "coordinator/coupling/schemes.hpp"

#include <algorithm>

#include "coordinator/coupling/check_fields.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

Message request_for(MessageType type, const Window& window) {
  Message message;
  message.header.type = type;
  message.header.body = {{"start", window.start}, {"length", window.length}};
  return message;
}

void share_asked(Message& to, Message& from, const AskedFields& asked) {
  for (const auto* names : {&asked.scalars, &asked.vectors})
    for (const std::string& name : *names) share_array(to, from, name);
}

/// Frames go on as they came; sending uses them up, so what is to be kept is shared.
void share_all(Message& to, Message& from) {
  for (const ArrayInfo& array : std::vector(from.header.arrays)) share_array(to, from, array.name);
}

/// To the particles: the fluid that they move under.
Message request_with_fluid(const Coupling& coupling, MessageType type, const Window& window,
                           Message& fluid) {
  Message request = request_for(type, window);
  for (const auto* name : {field::velocity, field::pressure_gradient})
    share_array(request, fluid, name);
  share_asked(request, fluid, asked_of_fluid(coupling.scene));
  return request;
}

Message request_with_solids(const Window& window, Message& solids) {
  Message request = request_for(MessageType::advance, window);
  share_all(request, solids);
  return request;
}

double seconds_of(const Message& result) { return number(result.header, field::wall_seconds); }

/// The particles move under the committed fluid state; what comes back belongs to the window's end.
/// The fluid moves with that.
Advanced advance_in_turn(const Coupling& coupling, const Window& window, Committed state) {
  Advanced next;
  Message request = request_with_fluid(coupling, MessageType::advance, window, state.fluid);
  next.particles = coupling.session.ask(Role::particles, request);
  check_offer_fields(next.particles, coupling.scene, coupling.mesh, window.step);
  check_particle_fields(next.particles, coupling.scene, coupling.mesh, window.step);

  next.offered = tell_of_solids(coupling, next.particles, next.particles);
  request = request_with_solids(window, next.offered);
  next.fluid = coupling.session.ask(Role::fluid, request);
  check_fluid_fields(next.fluid, coupling.scene, coupling.mesh, window.step);

  next.wall_fluid = seconds_of(next.fluid);
  next.wall_particles = seconds_of(next.particles);
  return next;
}

/// The particles say what drag they offer where they are; then both move.
Advanced advance_at_once(const Coupling& coupling, const Window& window, Committed state) {
  Advanced next;
  Message request = request_with_fluid(coupling, MessageType::offer, window, state.fluid);
  Message offer = coupling.session.ask(Role::particles, request);
  check_offer_fields(offer, coupling.scene, coupling.mesh, window.step);

  next.offered = tell_of_solids(coupling, state.particles, offer);
  Message to_fluid = request_with_solids(window, next.offered);
  Message to_particles = request_for(MessageType::advance, window);
  Session::Replies replies = coupling.session.ask_both(to_fluid, to_particles);
  next.fluid = std::move(replies.fluid);
  next.particles = std::move(replies.particles);
  check_particle_fields(next.particles, coupling.scene, coupling.mesh, window.step);
  check_fluid_fields(next.fluid, coupling.scene, coupling.mesh, window.step);

  next.wall_fluid = seconds_of(next.fluid);
  next.wall_particles = seconds_of(offer) + seconds_of(next.particles);
  next.wall_both = std::min(seconds_of(next.fluid), seconds_of(next.particles));
  return next;
}

}  // namespace

Message tell_of_solids(const Coupling& coupling, Message& state, Message& offer) {
  Message solids;
  share_array(solids, state, field::voidage);
  for (const auto* name : {field::drag_coefficient, field::drag_source})
    share_array(solids, offer, name);
  share_asked(solids, offer, asked_of_particles(coupling.scene));
  return solids;
}

double late_response(const Scene& scene, double voidage) {
  if (!has_particles(scene) || scene.particles.backend == ParticleBackend::kinematic) return 0;
  constexpr double densest = 0.64;
  const double solids = std::min(1 - voidage, densest);
  const double fluid = 1 - solids;
  double ratio = 0;
  for (const auto& [name, material] : scene.particles.materials)
    ratio = std::max(ratio, scene.fluid.density / material.density);
  double added = 0;
  if (has_force(scene, InterphaseForce::added_mass)) {
    added = scene.interphase.added_mass_crowding == Crowding::none ? 0.5
                                                                   : 0.5 * (1 + 2 * solids) / fluid;
  }
  return solids / fluid * ratio * (fluid + added) / (fluid + added * ratio);
}

Advanced advance_both_sides(const Coupling& coupling, const Window& window, Committed state) {
  switch (coupling.scene.coupling.scheme) {
    case CouplingScheme::serial:
      return advance_in_turn(coupling, window, state);
    case CouplingScheme::parallel:
      return advance_at_once(coupling, window, state);
  }
  throw ConfigError("coupling.scheme: unknown value {}",
                    static_cast<int>(coupling.scene.coupling.scheme));
}

}  // namespace fluxpact
