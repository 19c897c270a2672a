#include "dem_server/participant/particle_participant.hpp"

#include <algorithm>
#include <chrono>

#include "proto/base/compensated_sum.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

double total(std::span<const double> values) {
  CompensatedSum sum;
  for (const double value : values) sum.add(value);
  return sum.value();
}

}  // namespace

Identity particle_identity(const std::string& backend) {
  Identity identity{Role::particles,
                    backend,
                    {field::voidage, field::drag_coefficient, field::drag_source,
                     field::impulse_given, field::particle_velocity, field::particle_volume,
                     field::particle_count, field::particle_mass, field::wall_seconds},
                    {field::velocity, field::pressure_gradient}};
  for (std::string& name : all_asked_of_particles()) identity.gives.push_back(std::move(name));
  return identity;
}

ParticleParticipant::ParticleParticipant(std::string backend, EngineFactory make_engine)
    : backend_(std::move(backend)), make_engine_(std::move(make_engine)) {}

Identity ParticleParticipant::identity() const { return particle_identity(backend_); }

void ParticleParticipant::configure(const Scene& scene, const Mesh& mesh) {
  engine_ = make_engine_(scene, mesh);
  settings_ = exchange_settings(scene, engine_->mobile());
  flow_.reset();
  if (particles_flow(scene)) flow_.emplace(scene, mesh, engine_->particles());
  builder_.emplace(mesh, scene.interphase.voidage, settings_.threads);
  sub_steps_ = sub_steps(scene);
  first_window_ = scene.coupling.window;
  cell_volumes_ = mesh.cell_volumes;
  cell_centres_ = mesh.cell_centres;
  const auto cells = cell_volumes_.size();
  voidage_.resize(cells);
  drag_coefficient_.resize(cells);
  drag_source_.resize(cells);
  particle_velocity_.resize(cells);
  impulse_given_.assign(cells, Vector3::Zero());
  if (settings_.pressure_returns) pressure_return_.resize(cells);
  pending_ = false;
}

void ParticleParticipant::start(const Fields& in, Fields& out) {
  const auto began = SteadyClock::now();
  const bool fluid_first = std::ranges::any_of(
      in.views(), [](const FieldView& view) { return view.name == field::velocity; });
  const std::vector<Vector3> at_rest(cell_volumes_.size(), Vector3::Zero());
  FluidSeen fluid;
  fluid.velocity = at_rest;
  if (fluid_first) {
    fluid.velocity = in.vectors(field::velocity, static_cast<int>(cell_volumes_.size()));
  }
  map_particles(0);
  candidate_.window = first_window_;
  candidate_.initial = true;
  offer_maker_.make(settings_, fluid, voidage_, engine_->particles(), bulk_, {}, candidate_);
  publish(seconds_since(began), out);
  std::swap(committed_, candidate_);
}

void ParticleParticipant::advance(const Window& window, const Fields& in, Fields& out,
                                  const Progress& progress) {
  const auto began = SteadyClock::now();
  if (pending_) {
    throw ProtocolError(
        "particle side: asked to advance step {} while the last candidate is neither committed nor "
        "rolled back",
        window.step);
  }
  const int cells = static_cast<int>(cell_volumes_.size());
  const FluidSeen fluid = fluid_seen(settings_, in, cells, !committed_.initial);
  measure_bulk(engine_->particles(), bulk_);
  window_forces(settings_, committed_, fluid, engine_->particles(), bulk_, window.step,
                window.length, forces_);
  velocity_before_ = engine_->particles().velocity;

  pending_ = true;  // from here on there is something to roll back
  engine_->advance(window.length, sub_steps_, forces_.force, progress);
  // The bulk is still that of the rows which moved.
  if (flow_) flow_->advance(window, bulk_, *engine_);

  map_particles(window.step);
  candidate_.window = window.length;
  candidate_.initial = false;
  offer_maker_.make(settings_, fluid, voidage_, engine_->particles(), bulk_,
                    {velocity_before_, window.length, &forces_,
                     flow_ ? flow_->row_before() : std::span<const int>{}, committed_.eddies},
                    candidate_);
  // By the weights the impulse was computed with: those are what the fluid answered to.
  deposit_vectors(committed_.weights, forces_.impulse, settings_.threads, impulse_given_);
  publish(seconds_since(began), out);
}

void ParticleParticipant::map_particles(std::int64_t step) {
  const ParticleState& particles = engine_->particles();
  measure_bulk(particles, bulk_);
  builder_->build(particles, step, candidate_.weights);
  map_voidage(candidate_.weights, bulk_.volume, cell_volumes_, cell_centres_, step,
              settings_.threads, voidage_);
  map_velocity(candidate_.weights, bulk_.volume, particles.velocity, settings_.threads,
               particle_velocity_);
}

void ParticleParticipant::publish(double wall_seconds, Fields& out) {
  deposit_offer(candidate_, settings_.threads, drag_coefficient_, drag_source_);
  out.add(field::voidage, voidage_);
  out.add(field::drag_coefficient, drag_coefficient_);
  out.add(field::drag_source, drag_source_);
  if (settings_.pressure_returns) {
    deposit_returned(candidate_, settings_.threads, pressure_return_);
    out.add(field::pressure_return, pressure_return_);
  }
  out.add(field::impulse_given, impulse_given_);
  out.add(field::particle_velocity, particle_velocity_);
  out.add_number(field::particle_volume, total(bulk_.volume));
  out.add_number(field::particle_count, engine_->particles().size());
  out.add_number(field::particle_mass, total(bulk_.mass));
  if (flow_) publish_flow(flow_->window(), out);
  out.add_number(field::wall_seconds, wall_seconds);
}

void ParticleParticipant::commit() {
  if (!pending_) throw ProtocolError("particle side: asked to commit, but nothing was advanced");
  engine_->commit();
  if (flow_) flow_->commit();
  std::swap(committed_, candidate_);
  pending_ = false;
}

void ParticleParticipant::rollback() {
  if (!pending_) return;  // the window failed before anything was changed
  engine_->rollback();
  if (flow_) flow_->rollback();
  pending_ = false;
}

void ParticleParticipant::snapshot(Fields& out) {
  if (pending_) {
    throw ProtocolError(
        "particle side: asked for a snapshot while a candidate is neither committed nor rolled "
        "back");
  }
  const ParticleState& particles = engine_->particles();
  id_.assign(particles.id.begin(), particles.id.end());
  out.add("id", id_);
  out.add("position", particles.position);
  out.add("velocity", particles.velocity);
  out.add("spin", particles.spin);
  out.add("radius", particles.radius);
  out.add("density", particles.density);
}

}  // namespace fluxpact
