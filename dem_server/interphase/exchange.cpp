#include "dem_server/interphase/exchange.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

const Vector3 no_vector = Vector3::Zero();

// The share of the load that contacts carried in the window just ended.
double carried_share(const Vector3& load, const Vector3& acceleration) {
  const double load_squared = load.squaredNorm();
  if (!(load_squared > 0)) return 0;
  return std::clamp(-(acceleration - load).dot(load) / load_squared, 0.0, 1.0);
}

Vector3 predicted_velocity(const ExchangeSettings& settings, const Prediction& past, double window,
                           const Vector3& gradient, const ParticleState& particles,
                           const ParticleBulk& bulk, int i) {
  const Vector3& velocity = particles.velocity[i];
  if (!settings.mobile || particles.is_fixed(i)) return velocity;
  Vector3 coming = settings.gravity;
  if (settings.pressure_gradient) coming -= gradient / particles.density[i];
  if (settings.buoyancy) {
    coming -= settings.fluid.density * settings.gravity / particles.density[i];
  }
  const int before = past.row_before.empty() ? i : past.row_before[i];
  if (!(past.length > 0) || before < 0) return velocity + window * coming;
  const Vector3 load = settings.gravity + past.forces->force[before] / bulk.mass[i];
  const Vector3 change = velocity - past.velocity_before[before];
  const double carried = carried_share(load, change / past.length);
  const Vector3 drag = past.forces->drag_impulse[before] / (bulk.mass[i] * past.length);
  return velocity + window * ((1 - carried) * coming - carried * drag);
}

}  // namespace

ExchangeSettings exchange_settings(const Scene& scene, bool mobile) {
  ExchangeSettings settings;
  settings.fluid = {scene.fluid.density, scene.fluid.viscosity};
  settings.gravity = scene.scene.gravity;
  settings.drag = drag_choice(scene.interphase);
  settings.model = scene.interphase.model;
  settings.buoyancy =
      std::ranges::find(scene.interphase.forces, InterphaseForce::pressure_gradient) !=
      scene.interphase.forces.end();
  settings.pressure_gradient = settings.buoyancy && settings.model == PressureModel::a;
  settings.mobile = mobile;
  const int threads = scene.particles.numerics.threads;
  settings.threads = threads > 0 ? threads : omp_get_max_threads();
  return settings;
}

FluidSeen FluidView::of(const FluidSeen& fluid, const ParticleCellWeights& weights) {
  FluidSeen seen = fluid;
  seen.velocity = weights.seen(fluid.velocity, velocity_);
  if (fluid.solved)
    seen.pressure_gradient = weights.seen(fluid.pressure_gradient, pressure_gradient_);
  return seen;
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
  int bad = count;  // the first one, for any number of threads
#pragma omp parallel for schedule(static) num_threads(settings.threads) reduction(min : bad)
  for (int i = 0; i < count; ++i) {
    Vector3 drag = Vector3::Zero();
    Vector3 pressure = Vector3::Zero();
    if (fluid.solved) {
      const Vector3 u = offer.weights.gather(i, fluid.velocity, no_vector);
      drag = offer.window * offer.coefficient[i] * (u - offer.velocity[i]);
      if (settings.pressure_gradient) {
        pressure = -bulk.volume[i] * offer.weights.gather(i, fluid.pressure_gradient, no_vector);
      }
    }
    forces.drag_impulse[i] = drag;
    forces.impulse[i] = drag + length * pressure;
    forces.force[i] = drag / length + pressure;
    if (settings.buoyancy) {
      forces.force[i] -= settings.fluid.density * bulk.volume[i] * settings.gravity;
    }
    if (!forces.force[i].allFinite()) bad = std::min(bad, i);
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
  points_.resize(size);
  offer.coefficient.resize(size);
  offer.velocity.resize(size);
#pragma omp parallel for schedule(static) num_threads(settings.threads)
  for (int i = 0; i < count; ++i) {
    const Vector3 u = offer.weights.gather(i, fluid.velocity, no_vector);
    points_[i] = {offer.weights.gather(i, voidage, 0.0), 2 * particles.radius[i],
                  (u - particles.velocity[i]).norm()};
  }
  survey_ = drag_coefficients(settings.drag, settings.model, settings.fluid, points_,
                              settings.threads, offer.coefficient);
  if (const int bad = survey_.first_bad; bad >= 0) {
    const Vector3& x = particles.position[bad];
    throw_bad_drag(
        settings.drag.law,
        fmt::format("particle {} at ({}, {}, {}) m", particles.id[bad], x.x(), x.y(), x.z()),
        points_[bad], offer.coefficient[bad]);
  }
#pragma omp parallel for schedule(static) num_threads(settings.threads)
  for (int i = 0; i < count; ++i) {
    const Vector3 gradient =
        fluid.solved ? offer.weights.gather(i, fluid.pressure_gradient, no_vector) : no_vector;
    offer.velocity[i] =
        predicted_velocity(settings, past, offer.window, gradient, particles, bulk, i);
    if (settings.mobile && !particles.is_fixed(i)) {
      offer.coefficient[i] /= 1 + offer.coefficient[i] * offer.window / bulk.mass[i];
    }
  }
}

void deposit_offer(const Offer& offer, int threads, std::span<double> drag_coefficient,
                   std::span<Vector3> drag_source) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < offer.weights.cells(); ++cell) {
    double coefficient = 0;
    Vector3 source = Vector3::Zero();
    offer.weights.deposit(
        cell, [&](double share) { coefficient += share; },
        [&](int particle) { return offer.coefficient[particle]; });
    offer.weights.deposit(
        cell, [&](const Vector3& share) { source += share; },
        [&](int particle) -> Vector3 {
          return offer.coefficient[particle] * offer.velocity[particle];
        });
    drag_coefficient[cell] = coefficient;
    drag_source[cell] = source;
  }
  offer.weights.spread(drag_coefficient);
  offer.weights.spread(drag_source);
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
