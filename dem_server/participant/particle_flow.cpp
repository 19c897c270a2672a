#include "dem_server/participant/particle_flow.hpp"

#include <spdlog/spdlog.h>

#include "proto/base/compensated_sum.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

/// Σ m [kg] and Σ m v [N s] of some rows.
struct Carried {
  CompensatedSum mass;
  std::array<CompensatedSum, 3> momentum;

  void add(double m, const Vector3& velocity) {
    mass.add(m);
    for (int axis = 0; axis < 3; ++axis) momentum.at(axis).add(m * velocity[axis]);
  }
  Vector3 total_momentum() const {
    return {momentum[0].value(), momentum[1].value(), momentum[2].value()};
  }
};

}  // namespace

void publish_flow(const WindowFlow& flow, Fields& out) {
  out.add(field::particle_momentum_entered, flow.momentum_entered);
  out.add(field::particle_momentum_left, flow.momentum_left);
  out.add_number(field::particles_entered, static_cast<double>(flow.entered));
  out.add_number(field::particles_left, static_cast<double>(flow.left));
  out.add_number(field::particles_waiting, static_cast<double>(flow.waiting));
  out.add_number(field::particle_mass_entered, flow.mass_entered);
  out.add_number(field::particle_mass_left, flow.mass_left);
}

ParticleFlow::ParticleFlow(const Scene& scene, const Mesh& mesh, const ParticleState& initial)
    : domain_(particle_domain(scene, mesh)),
      inflow_(scene, mesh, initial.id.empty() ? 1 : initial.id.back() + 1) {}

void ParticleFlow::find_leaving(const ParticleState& particles) {
  leaving_.clear();
  for (int row = 0; row < particles.size(); ++row) {
    if (left_through(domain_, particles.position[row]) >= 0) leaving_.push_back(row);
  }
}

void ParticleFlow::match_rows(int before, int entered) {
  row_before_.clear();
  if (leaving_.empty() && entered == 0) return;
  std::size_t next = 0;
  for (int row = 0; row < before; ++row) {
    if (next < leaving_.size() && leaving_[next] == row) {
      ++next;
    } else {
      row_before_.push_back(row);
    }
  }
  row_before_.resize(row_before_.size() + static_cast<std::size_t>(entered), -1);
}

void ParticleFlow::advance(const Window& window, const ParticleBulk& bulk, ParticleEngine& engine) {
  const ParticleState& particles = engine.particles();
  find_leaving(particles);
  Carried left;
  for (const int row : leaving_) left.add(bulk.mass[row], particles.velocity[row]);
  inflow_.advance(window.end(), particles, leaving_, entering_);
  measure_bulk(entering_, entering_bulk_);
  Carried entered;
  for (int row = 0; row < entering_.size(); ++row) {
    entered.add(entering_bulk_.mass[row], entering_.velocity[row]);
  }
  match_rows(particles.size(), entering_.size());
  if (!row_before_.empty() || !leaving_.empty()) engine.exchange(leaving_, entering_);

  window_.entered = entering_.size();
  window_.left = static_cast<std::int64_t>(leaving_.size());
  window_.waiting = inflow_.waiting();
  window_.mass_entered = entered.mass.value();
  window_.mass_left = left.mass.value();
  window_.momentum_entered.front() = entered.total_momentum();
  window_.momentum_left.front() = left.total_momentum();
}

void ParticleFlow::commit() {
  inflow_.commit();
  if (window_.waiting > 0 && !said_waiting_) {
    spdlog::warn(
        "{} particles of particles.inflow found no room and wait to come in (said once; the "
        "audit's "
        "particles_waiting counts them): lower the rate, raise the velocity, or enlarge the place",
        window_.waiting);
    said_waiting_ = true;
  }
}

void ParticleFlow::rollback() { inflow_.rollback(); }

}  // namespace fluxpact
