#include "dem_server/interphase/exchange.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem_server/interphase/forces.hpp"
#include "dem_server/interphase/own_disturbance.hpp"
#include "dem_server/interphase/prediction.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

const Vector3 no_vector = Vector3::Zero();

// Whose offers are made one after the other: all that is read and written of them stays in cache.
constexpr int rows_at_once = 1024;

/// θ of b = ζ Δt/m: the weight of the window's end in its drag.
double weight_of_end(double over) { return std::min(1.0, 0.5 + 1.5 * over); }

/// v*, and 1 − s: the part of a further force that would move the particle.
struct Foreseen {
  Vector3 velocity;
  double free = 0;
};

Foreseen foresee(const ExchangeSettings& settings, const Prediction& past, const Offer& offer,
                 const Vector3& gradient, const ParticleState& particles, const ParticleBulk& bulk,
                 int i) {
  const Vector3& velocity = velocity_of(particles, past, i);
  if (!settings.mobile || particles.is_fixed(i)) return {velocity, 0};
  const double per_density = 1 / particles.density[i];
  const double per_mass = 1 / bulk.mass[i];
  Vector3 coming = settings.gravity;
  if (settings.pressure_gradient) coming -= per_density * gradient;
  if (settings.buoyancy) coming -= settings.fluid.density * per_density * settings.gravity;
  if (!offer.known.empty()) coming += per_mass * offer.known[i];
  const int before = past_row(past, i);
  if (before < 0) return {velocity + offer.window * coming, 1};
  const double carried = carried_in_past(settings, past, velocity, per_mass, before);
  const Vector3 drag = per_mass / past.length * past.forces->drag_impulse[before];
  return {velocity + offer.window * ((1 - carried) * coming - carried * drag), 1 - carried};
}

/// E of one particle.
Vector3 known_force(const ExchangeSettings& settings, const FluidSeen& fluid,
                    const ParticleCellWeights& weights, const LiftPoint& lift, double volume,
                    double added_mass, int i) {
  Vector3 force = Vector3::Zero();
  if (settings.viscous) force += volume * weights.gather(i, fluid.viscous_force, no_vector);
  if (settings.saffman_lift) force += saffman_lift(lift, settings.fluid);
  if (settings.magnus_lift) force += magnus_lift(lift, settings.fluid);
  if (settings.added_mass) {
    force += added_mass * weights.gather(i, fluid.convective_acceleration, no_vector);
  }
  return force;
}

/// Moves the walk of the particles of `rows` through the eddies over the window, and gives the drag
/// law their velocity. `points`, `offer.coefficient`: those of the mean flow.
void meet_eddies(const ExchangeSettings& settings, const FluidSeen& fluid,
                 const ParticleState& particles, const ParticleBulk& bulk, const Prediction& past,
                 const OfferMaker::Rows& rows, std::span<DragPoint> points,
                 std::span<Vector3> fluctuation, Offer& offer) {
  for (int i = rows.first; i < rows.last; ++i) {
    const int before = past.row_before.empty() ? i : past.row_before[i];
    const bool known = before >= 0 && before < static_cast<int>(past.eddies.size());
    Eddy eddy = known ? past.eddies[before] : Eddy{};
    const ParticleCellWeights& weights = offer.weights;
    const bool moves = settings.mobile && !particles.is_fixed(i) && offer.coefficient[i] > 0;
    const EddyPoint point{
        weights.gather(i, fluid.turbulent_energy, 0.0),
        weights.gather(i, fluid.turbulent_dissipation, 0.0), points[i].slip,
        moves ? bulk.mass[i] / offer.coefficient[i] : std::numeric_limits<double>::infinity()};
    const Vector3 u = weights.gather(i, fluid.velocity, no_vector);
    fluctuation[i] = mean_fluctuation(point, offer.window, settings.seed, particles.id[i], eddy);
    points[i].slip = (u + fluctuation[i] - velocity_of(particles, past, i)).norm();
    offer.eddies[i] = eddy;
  }
}

}  // namespace

ExchangeSettings exchange_settings(const Scene& scene, bool mobile) {
  ExchangeSettings settings;
  settings.fluid = {scene.fluid.density, scene.fluid.viscosity};
  settings.gravity = scene.scene.gravity;
  settings.drag = drag_choice(scene.interphase);
  settings.model = scene.interphase.model;
  settings.buoyancy = has_force(scene, InterphaseForce::pressure_gradient);
  settings.pressure_gradient = settings.buoyancy && settings.model == PressureModel::a;
  settings.viscous = has_force(scene, InterphaseForce::viscous);
  settings.added_mass = has_force(scene, InterphaseForce::added_mass);
  settings.pressure_returns = !asked_of_particles(scene).empty();
  settings.saffman_lift = has_force(scene, InterphaseForce::saffman_lift);
  settings.magnus_lift = has_force(scene, InterphaseForce::magnus_lift);
  settings.turbulent_dispersion = has_force(scene, InterphaseForce::turbulent_dispersion);
  settings.crowding = scene.interphase.added_mass_crowding;
  settings.seed = static_cast<std::uint64_t>(scene.interphase.dispersion_seed);
  settings.mobile = mobile;
  const int threads = scene.particles.numerics.threads;
  settings.threads = threads > 0 ? threads : omp_get_max_threads();
  return settings;
}

FluidSeen FluidView::of(const FluidSeen& fluid, const ParticleCellWeights& weights) {
  FluidSeen seen = fluid;
  seen.velocity = weights.seen(fluid.velocity, velocity_);
  if (fluid.solved) {
    seen.pressure_gradient = weights.seen(fluid.pressure_gradient, pressure_gradient_);
  }
  // What the scene does not ask for is empty, and stays so.
  const auto view = [&](auto& field, auto& buffer) {
    if (!field.empty()) field = weights.seen(field, buffer);
  };
  view(seen.viscous_force, viscous_force_);
  view(seen.convective_acceleration, convective_acceleration_);
  view(seen.vorticity, vorticity_);
  view(seen.turbulent_energy, turbulent_energy_);
  view(seen.turbulent_dissipation, turbulent_dissipation_);
  return seen;
}

FluidSeen fluid_seen(const ExchangeSettings& settings, const Fields& in, int cells, bool solved) {
  FluidSeen fluid{solved, in.vectors(field::velocity, cells),
                  in.vectors(field::pressure_gradient, cells)};
  if (settings.viscous) fluid.viscous_force = in.vectors(field::viscous_force, cells);
  if (settings.added_mass) {
    fluid.convective_acceleration = in.vectors(field::convective_acceleration, cells);
  }
  if (settings.saffman_lift || settings.magnus_lift) {
    fluid.vorticity = in.vectors(field::vorticity, cells);
  }
  if (settings.turbulent_dispersion) {
    fluid.turbulent_energy = in.scalars(field::turbulent_energy, cells);
    fluid.turbulent_dissipation = in.scalars(field::turbulent_dissipation, cells);
  }
  return fluid;
}

void measure_bulk(const ParticleState& particles, ParticleBulk& bulk) {
  particle_volumes(particles, bulk.volume);
  bulk.mass.resize(bulk.volume.size());
  std::ranges::transform(bulk.volume, particles.density, bulk.mass.begin(), std::multiplies<>());
}

void window_forces(const ExchangeSettings& settings, const Offer& offer, const FluidSeen& fluid,
                   const ParticleState& particles, const ParticleBulk& bulk, std::int64_t step,
                   double length, WindowForces& forces) {
  const int count = offer.weights.particles();
  for (auto* array : {&forces.drag_impulse, &forces.impulse, &forces.force}) {
    array->resize(static_cast<std::size_t>(count));
  }
  const double per_length = 1 / length;
  int bad = count;  // the first one, for any number of threads
#pragma omp parallel for schedule(static) num_threads(settings.threads) reduction(min : bad)
  for (int i = 0; i < count; ++i) {
    Vector3 drag = Vector3::Zero();
    Vector3 pressure = Vector3::Zero();
    if (fluid.solved) {
      const Vector3 u = offer.weights.gather(i, fluid.velocity, no_vector);
      drag = offer.window * offer.coefficient[i] * (u - offer.velocity[i]);
      if (settings.pressure_gradient && !offer.initial) {
        const Vector3 gradient = offer.weights.gather(i, fluid.pressure_gradient, no_vector);
        pressure = -bulk.volume[i] * gradient;
        if (!offer.returned.empty()) drag += offer.window * offer.returned[i] * gradient;
      }
    }
    Vector3 impulse = drag + length * pressure;
    Vector3 force = per_length * drag + pressure;
    if (fluid.solved && !offer.known.empty()) {
      const Vector3 known = offer.window * offer.known[i];
      impulse += known;
      force += per_length * known;
    }
    if (settings.buoyancy) force -= settings.fluid.density * bulk.volume[i] * settings.gravity;
    forces.drag_impulse[i] = drag;
    forces.impulse[i] = impulse;
    forces.force[i] = force;
    if (!force.allFinite()) bad = std::min(bad, i);
  }
  if (bad < count) {
    const Vector3& x = particles.position[bad];
    const Vector3& f = forces.force[bad];
    throw NumericsError(
        "force of the fluid on particle {} at ({}, {}, {}) m is ({}, {}, {}) N in step {}: the "
        "velocity or pressure gradient received from the fluid side is not finite, or too large",
        particles.id[bad], x.x(), x.y(), x.z(), f.x(), f.y(), f.z(), step);
  }
}

void OfferMaker::make(const ExchangeSettings& settings, const FluidSeen& fluid,
                      std::span<const double> voidage, const ParticleState& particles,
                      const ParticleBulk& bulk, const Prediction& past, Offer& offer) {
  const int count = particles.size();
  const auto size = static_cast<std::size_t>(count);
  const bool further = !offer.initial;
  points_.resize(size);
  offer.coefficient.resize(size);
  offer.velocity.resize(size);
  offer.known.resize(further && settings.has_known() ? size : 0);
  offer.eddies.resize(further && settings.turbulent_dispersion ? size : 0);
  lead_.resize(further && (settings.added_mass || settings.turbulent_dispersion) ? size : 0);
  offer.returned.resize(settings.pressure_returns ? size : 0);
  std::int64_t outside = 0;
  int bad = count;  // the first one, for any number of threads
  int hidden = count;
#pragma omp parallel for schedule(static) num_threads(settings.threads) reduction(+ : outside) \
    reduction(min : bad, hidden)
  for (int first = 0; first < count; first += rows_at_once) {
    const Rows rows{first, std::min(first + rows_at_once, count)};
    for (int i = rows.first; i < rows.last; ++i) {
      const Vector3 u = offer.weights.gather(i, fluid.velocity, no_vector);
      points_[i] = {offer.weights.gather(i, voidage, 0.0), 2 * particles.radius[i],
                    (u - velocity_of(particles, past, i)).norm()};
    }
    DragSurvey survey = find_drag(settings, rows, offer);
    if (survey.first_bad < 0 && !offer.eddies.empty()) {
      meet_eddies(settings, fluid, particles, bulk, past, rows, points_, lead_, offer);
      survey = find_drag(settings, rows, offer);
    }
    outside += survey.outside;
    if (survey.first_bad >= 0) {
      bad = std::min(bad, survey.first_bad);
      continue;
    }
    if (settings.own != nullptr && further) {
      hidden = std::min(hidden, correct(settings, fluid, voidage, particles, past, rows, offer));
    }
    if (!offer.known.empty()) add_known(settings, fluid, particles, bulk, past, rows, offer);
    eliminate(settings, fluid, particles, bulk, past, rows, offer);
  }
  survey_ = {outside, bad < count ? bad : -1};
  if (bad == count && hidden < count) {
    const Vector3& x = particles.position[hidden];
    throw NumericsError(
        "interphase.self_disturbance: corrected: particle {} at ({}, {}, {}) m, diameter {:.3g} m, "
        "has cells of less than {} diameters, or would not see more than {} % of its slip for what "
        "it does itself to the fluid in them, and no correction holds there: it is for single "
        "particles in larger cells; take these, or interphase.voidage kernel or diffusion with "
        "self_disturbance: none",
        particles.id[hidden], x.x(), x.y(), x.z(), 2 * particles.radius[hidden], narrowest,
        100 * most_unseen);
  }
  if (bad == count) return;
  const Vector3& x = particles.position[bad];
  throw_bad_drag(
      settings.drag.law,
      fmt::format("particle {} at ({}, {}, {}) m", particles.id[bad], x.x(), x.y(), x.z()),
      points_[bad], offer.coefficient[bad]);
}

/// ζ of the rows. Their numbers are those of all particles in the survey, too.
DragSurvey OfferMaker::find_drag(const ExchangeSettings& settings, const Rows& rows, Offer& offer) {
  const auto first = static_cast<std::size_t>(rows.first);
  const auto size = static_cast<std::size_t>(rows.last - rows.first);
  DragSurvey survey = drag_coefficients(settings.drag, settings.model, settings.fluid,
                                        std::span(points_).subspan(first, size), 1,
                                        std::span(offer.coefficient).subspan(first, size));
  if (survey.first_bad >= 0) survey.first_bad += rows.first;
  return survey;
}

/// ζ of the slip without their own disturbance, for the slip with it. Returns the first of the rows
/// whose cells are too small, or of whose slip too much is not seen, or the number of all
/// particles.
int OfferMaker::correct(const ExchangeSettings& settings, const FluidSeen& fluid,
                        std::span<const double> voidage, const ParticleState& particles,
                        const Prediction& past, const Rows& rows, Offer& offer) {
  for (int i = rows.first; i < rows.last; ++i) {
    if (!settings.own->has_room(offer.weights, i, particles.radius[i])) return i;
    Vector3 seen =
        offer.weights.gather(i, fluid.velocity, no_vector) - velocity_of(particles, past, i);
    if (!offer.eddies.empty()) seen += lead_[i];
    const auto drag = [&](double slip) {
      points_[i].slip = slip;
      find_drag(settings, {i, i + 1}, offer);
      return offer.coefficient[i];
    };
    const double response = settings.own->response(offer.weights, i, settings.fluid, voidage, seen);
    const Undisturbed found = undisturbed(points_[i].slip, response, drag);
    if (!(found.share <= most_unseen)) return i;
    offer.coefficient[i] = found.drag / (1 - found.share);
  }
  return particles.size();
}

/// Added mass joins ζ; E.
void OfferMaker::add_known(const ExchangeSettings& settings, const FluidSeen& fluid,
                           const ParticleState& particles, const ParticleBulk& bulk,
                           const Prediction& past, const Rows& rows, Offer& offer) {
  const bool lifts = settings.saffman_lift || settings.magnus_lift;
  for (int i = rows.first; i < rows.last; ++i) {
    LiftPoint lift;
    lift.diameter = points_[i].diameter;
    lift.slip =
        offer.weights.gather(i, fluid.velocity, no_vector) - velocity_of(particles, past, i);
    if (lifts) {
      lift.vorticity = offer.weights.gather(i, fluid.vorticity, no_vector);
      lift.spin = particles.spin[i];
    }
    double added = 0;
    if (settings.added_mass) {
      added = added_mass_coefficient(settings.crowding, points_[i].voidage) *
              settings.fluid.density * bulk.volume[i];
      const double whole = offer.coefficient[i] + added / offer.window;
      const Vector3 eddy = offer.eddies.empty() ? no_vector : lead_[i];
      lead_[i] = (offer.coefficient[i] * eddy - added / offer.window * lift.slip) / whole;
      offer.coefficient[i] = whole;
    }
    offer.known[i] = known_force(settings, fluid, offer.weights, lift, bulk.volume[i], added, i);
  }
}

/// ζ -> k, q and what returns.
void OfferMaker::eliminate(const ExchangeSettings& settings, const FluidSeen& fluid,
                           const ParticleState& particles, const ParticleBulk& bulk,
                           const Prediction& past, const Rows& rows, Offer& offer) const {
  const bool last_gradient =
      settings.pressure_gradient && fluid.solved && !settings.pressure_returns;
  for (int i = rows.first; i < rows.last; ++i) {
    const Vector3 gradient =
        last_gradient ? offer.weights.gather(i, fluid.pressure_gradient, no_vector) : no_vector;
    const Foreseen coming = foresee(settings, past, offer, gradient, particles, bulk, i);
    offer.velocity[i] = coming.velocity;
    if (settings.mobile && !particles.is_fixed(i)) {
      const double over = offer.coefficient[i] * offer.window / bulk.mass[i];
      const double end = settings.added_mass ? 1 : weight_of_end(over);
      offer.coefficient[i] /= 1 + end * over;
      offer.velocity[i] += (1 - end) * (velocity_of(particles, past, i) - coming.velocity);
    }
    if (settings.pressure_returns) {
      offer.returned[i] =
          offer.initial ? 0.0
                        : offer.coefficient[i] * coming.free * offer.window / particles.density[i];
    }
    if (!lead_.empty()) offer.velocity[i] -= lead_[i];
  }
}

void deposit_offer(const Offer& offer, int threads, std::span<double> drag_coefficient,
                   std::span<Vector3> drag_source) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < offer.weights.cells(); ++cell) {
    double coefficient = 0;
    Vector3 source = Vector3::Zero();
    offer.weights.each_in(cell, [&](int particle, double weight) {
      const double share = weight * offer.coefficient[particle];
      coefficient += share;
      source += share * offer.velocity[particle];
    });
    if (!offer.known.empty()) {
      offer.weights.deposit(
          cell, [&](const Vector3& share) { source -= share; },
          [&](int particle) -> const Vector3& { return offer.known[particle]; });
    }
    drag_coefficient[cell] = coefficient;
    drag_source[cell] = source;
  }
  offer.weights.spread(drag_coefficient);
  offer.weights.spread(drag_source);
}

void deposit_returned(const Offer& offer, int threads, std::span<double> pressure_return) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < offer.weights.cells(); ++cell) {
    double sum = 0;
    offer.weights.deposit(
        cell, [&](double share) { sum += share; },
        [&](int particle) { return offer.returned[particle]; });
    pressure_return[cell] = sum;
  }
  offer.weights.spread(pressure_return);
}

void deposit_vectors(const ParticleCellWeights& weights, std::span<const Vector3> particle_values,
                     int threads, std::span<Vector3> cell_values) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < weights.cells(); ++cell) {
    Vector3 sum = Vector3::Zero();
    weights.deposit(
        cell, [&](const Vector3& share) { sum += share; },
        [&](int particle) -> const Vector3& { return particle_values[particle]; });
    cell_values[cell] = sum;
  }
  weights.spread(cell_values);
}

}  // namespace fluxpact
