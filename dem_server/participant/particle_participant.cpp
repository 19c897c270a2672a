#include "dem_server/participant/particle_participant.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "dem_server/interphase/first_window.hpp"
#include "dem_server/interphase/prediction.hpp"
#include "dem_server/participant/precision_error.hpp"
#include "proto/base/compensated_sum.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"
#include "proto/scene/names.hpp"

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
  Identity identity{
      Role::particles,
      backend,
      {field::voidage, field::drag_coefficient, field::drag_source, field::impulse_given,
       field::particle_velocity, field::particle_volume, field::particle_count,
       field::particle_mass, field::excess_moved, field::wall_seconds},
      {field::velocity, field::pressure_gradient}};
  identity.offers = true;
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
  excess_.emplace(mesh, scene.interphase.voidage.smallest);
  own_.reset();
  if (scene.interphase.self_disturbance == SelfDisturbance::corrected) {
    settings_.own = &own_.emplace(mesh);
  }
  sub_steps_ = sub_steps(scene);
  first_window_ = scene.coupling.window;
  cell_volumes_ = mesh.cell_volumes;
  const auto cells = cell_volumes_.size();
  voidage_.resize(cells);
  drag_coefficient_.resize(cells);
  drag_source_.resize(cells);
  particle_velocity_.resize(cells);
  impulse_given_.assign(cells, Vector3::Zero());
  if (settings_.pressure_returns) pressure_return_.resize(cells);
  pending_ = false;
  last_window_ = 0;
  late_.reset();
  if (scene.coupling.scheme == CouplingScheme::parallel) late_.emplace();
  mixed_.reset();
  if (scene.particles.backend == ParticleBackend::native &&
      scene.particles.numerics.precision == Precision::mixed) {
    mixed_.emplace(Place{scene, mesh});
  }
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
  offer_maker_.make(settings_, fluid_view_.of(fluid, candidate_.weights),
                    candidate_.weights.seen(std::span<const double>(voidage_), voidage_seen_),
                    engine_->particles(), bulk_, {}, candidate_);
  publish_offer(candidate_, out);
  publish_state(impulse_given_, out);
  out.add_number(field::wall_seconds, seconds_since(began));
  std::swap(committed_, candidate_);
  if (late_) late_->start(voidage_);
}

void ParticleParticipant::require_settled(const char* asked, std::int64_t step) const {
  if (!pending_) return;
  throw ProtocolError(
      "particle side: asked to {} step {} while the last candidate is neither committed nor "
      "rolled back",
      asked, step);
}

void ParticleParticipant::advance(const Window& window, const Fields& in, Fields& out,
                                  const Progress& progress) {
  const auto began = SteadyClock::now();
  require_settled("advance", window.step);
  if (late_) {
    advance_under_offer(window, out, progress);
  } else {
    advance_and_offer(window, in, out, progress);
  }
  out.add_number(field::wall_seconds, seconds_since(began));
}

void ParticleParticipant::advance_and_offer(const Window& window, const Fields& in, Fields& out,
                                            const Progress& progress) {
  const int cells = static_cast<int>(cell_volumes_.size());
  const bool first = committed_.initial;
  const FluidSeen fluid = fluid_seen(settings_, in, cells, !first);
  measure_bulk(engine_->particles(), bulk_);
  if (first) {
    map_voidage(committed_.weights, bulk_.volume, cell_volumes_, *excess_, 0, settings_.threads,
                voidage_, add_up());  // of time 0, also if the window is repeated
    first_forces(settings_,
                 {window.step, window.length, engine_->particles(), bulk_, voidage_, cell_volumes_,
                  add_up()},
                 fluid, offer_maker_, fluid_view_, committed_, forces_);
  } else {
    window_forces(settings_, committed_, fluid_view_.of(fluid, committed_.weights),
                  engine_->particles(), bulk_, window.step, window.length, forces_);
  }
  velocity_before_ = engine_->particles().velocity;

  move_particles(window, forces_.force, bulk_, progress);
  candidate_.window = window.length;
  candidate_.initial = false;
  offer_maker_.make(settings_, fluid_view_.of(fluid, candidate_.weights),
                    candidate_.weights.seen(std::span<const double>(voidage_), voidage_seen_),
                    engine_->particles(), bulk_,
                    {velocity_before_, window.length, &forces_,
                     flow_ ? flow_->row_before() : std::span<const int>{}, committed_.eddies},
                    candidate_);
  // By the weights the impulse was computed with: those are what the fluid answered to.
  deposit_vectors(committed_.weights, forces_.impulse, settings_.threads, impulse_given_);
  publish_offer(candidate_, out, first ? impulse_given_ : std::span<const Vector3>{});
  publish_state(impulse_given_, out);
}

void ParticleParticipant::offer(const Window& window, const Fields& in, Fields& out,
                                const Progress& progress) {
  const auto began = SteadyClock::now();
  if (!late_) Participant::offer(window, in, out, progress);
  require_settled("make an offer for", window.step);
  late_->offer({settings_, engine_->particles(), late_->voidage(), cell_volumes_, flow_.has_value(),
                add_up()},
               window, in, offer_maker_, fluid_view_, committed_);
  publish_offer(committed_, out,
                late_->lends() ? late_->impulse_given() : std::span<const Vector3>{});
  out.add_number(field::wall_seconds, seconds_since(began));
}

void ParticleParticipant::advance_under_offer(const Window& window, Fields& out,
                                              const Progress& progress) {
  if (!late_->offered()) {
    throw ProtocolError(
        "particle side: asked to advance step {} in coupling.scheme parallel without being asked "
        "for its offer first",
        window.step);
  }
  move_particles(window, late_->force(), late_->bulk(), progress);
  impulse_given_.assign(late_->impulse_given().begin(), late_->impulse_given().end());
  publish_state(impulse_given_, out);
}

/// The engine's sub-steps, who leaves and comes in, and the map of the new positions. `bulk`: of
/// the rows that move.
void ParticleParticipant::move_particles(const Window& window, std::span<const Vector3> force,
                                         const ParticleBulk& bulk, const Progress& progress) {
  pending_ = true;  // from here on there is something to roll back
  engine_->advance(window.length, sub_steps_, force, progress);
  if (flow_) flow_->advance(window, bulk, *engine_);
  map_particles(window.step);
}

AddUp ParticleParticipant::add_up() const {
  return [this](std::span<double> values) { engine_->add_up(values); };
}

void ParticleParticipant::map_particles(std::int64_t step) {
  const ParticleState& particles = engine_->particles();
  measure_bulk(particles, bulk_);
  builder_->build(particles, step, candidate_.weights);
  excess_moved_ = map_voidage(candidate_.weights, bulk_.volume, cell_volumes_, *excess_, step,
                              settings_.threads, voidage_, add_up());
  map_velocity(candidate_.weights, bulk_.volume, particles.velocity, settings_.threads,
               cell_solids_, particle_velocity_, add_up());
}

/// `lent`: impulse that the particles have before the fluid gave it [N s], one row a cell.
void ParticleParticipant::publish_offer(const Offer& offer, Fields& out,
                                        std::span<const Vector3> lent) {
  deposit_offer(offer, settings_.threads, drag_coefficient_, drag_source_);
  if (!lent.empty()) take_back(lent, offer.window, drag_source_);
  engine_->add_up(drag_coefficient_);
  engine_->add_up(numbers_in(drag_source_));
  out.add(field::drag_coefficient, drag_coefficient_);
  out.add(field::drag_source, drag_source_);
  if (settings_.pressure_returns) {
    deposit_returned(offer, settings_.threads, pressure_return_);
    engine_->add_up(pressure_return_);
    out.add(field::pressure_return, pressure_return_);
  }
}

/// Of all particles; `impulse_given` comes as that of ours.
void ParticleParticipant::publish_state(std::span<Vector3> impulse_given, Fields& out) {
  std::array<double, 3> totals{total(bulk_.volume), total(bulk_.mass),
                               static_cast<double>(offer_maker_.survey().outside)};
  engine_->add_up(totals);
  beyond_drag_ = totals[2];
  engine_->add_up(numbers_in(impulse_given));
  out.add(field::voidage, voidage_);
  out.add(field::impulse_given, std::span<const Vector3>(impulse_given));
  out.add(field::particle_velocity, particle_velocity_);
  out.add_number(field::particle_volume, totals[0]);
  out.add_number(field::particle_count, engine_->all_particles().size());
  out.add_number(field::particle_mass, totals[1]);
  out.add_number(field::excess_moved, excess_moved_);
  if (drag_range(settings_.drag.law).most_reynolds < INFINITY) {
    out.add_number(field::particles_beyond_drag, beyond_drag_);
  }
  if (!flow_) return;
  flow_sent_ = flow_->window();
  if (late_) flow_sent_.momentum_left.front() += late_->departed_impulse();
  publish_flow(flow_sent_, out);
}

void ParticleParticipant::commit() {
  if (!pending_) throw ProtocolError("particle side: asked to commit, but nothing was advanced");
  engine_->commit();
  if (flow_) flow_->commit();
  if (late_) {
    late_->commit(committed_, candidate_, voidage_,
                  flow_ ? flow_->row_before() : std::span<const int>{});
    last_window_ = late_->last_length();
  } else {
    std::swap(committed_, candidate_);
    last_window_ = committed_.window;
  }
  pending_ = false;
  warn_of_drag();
}

void ParticleParticipant::warn_of_drag() {
  constexpr double tolerated = 0.01;  // a few spheres at the edge of a range are no news
  const int count = engine_->all_particles().size();
  const double share = beyond_drag_ / std::max(count, 1);
  if (said_drag_ || share <= tolerated) return;
  said_drag_ = true;
  const DragRange range = drag_range(settings_.drag.law);
  spdlog::warn(
      "drag law {} is known to hold for voidage {} .. {} and Re (superficial) up to {:g}; {:.1f} % "
      "of {} particles are beyond (said once; the closing summary has the mean and the largest "
      "share): consider another law, see docs/theory.md",
      name_of(settings_.drag.law), range.least_voidage, range.most_voidage, range.most_reynolds,
      100 * share, count);
}

void ParticleParticipant::rollback() {
  if (late_) late_->rollback();
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
  const ParticleState& particles = engine_->all_particles();
  id_.assign(particles.id.begin(), particles.id.end());
  out.add("id", id_);
  out.add("position", particles.position);
  out.add("velocity", particles.velocity);
  out.add("spin", particles.spin);
  out.add("radius", particles.radius);
  out.add("density", particles.density);
}

/// What the fluid did in the last window to those that are there now [N].
std::vector<Vector3> ParticleParticipant::last_force() const {
  if (late_) return late_->last_force(engine_->particles().size());
  const auto now = static_cast<std::size_t>(engine_->particles().size());
  const std::span<const int> before = flow_ ? flow_->row_before() : std::span<const int>{};
  std::vector<Vector3> force(now, Vector3::Zero());
  for (std::size_t row = 0; row < now; ++row) {
    const auto then = before.empty() ? row : static_cast<std::size_t>(before[row]);
    if (then < forces_.force.size()) force[row] = forces_.force[then];
  }
  return force;
}

void ParticleParticipant::figures(Fields& out, const Progress& progress) {
  if (!mixed_ || last_window_ == 0 || pending_) return;
  try {
    const PrecisionError error = measure_precision(
        mixed_->scene, mixed_->mesh, *engine_, last_window_, sub_steps_, last_force(), progress);
    publish_precision(error, out);
    spdlog::info(
        "mixed precision against double, one window after the last: velocities differ by {:.2g} "
        "(rms; at most {:.2g}) of the rms of their gains, overlaps by {:.2g} ({:.2g}) of their "
        "mean, positions by {:.2g} ({:.2g}) of the radius",
        error.velocity_rms, error.velocity_max, error.overlap_rms, error.overlap_max,
        error.position_rms, error.position_max);
  } catch (const NumericsError& failure) {
    // The run is over and whole; what would come after it is not a part of it.
    spdlog::warn("mixed precision could not be compared with double after the last window: {}",
                 failure.what());
  }
}

}  // namespace fluxpact
