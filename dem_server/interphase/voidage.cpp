#include "dem_server/interphase/voidage.hpp"

#include <algorithm>

#include "proto/base/compensated_sum.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

void particle_volumes(const ParticleState& particles, std::vector<double>& volumes) {
  volumes.resize(particles.radius.size());
  std::ranges::transform(particles.radius, volumes.begin(), ball_volume);
}

void map_voidage(const ParticleCellWeights& weights, std::span<const double> particle_volume,
                 std::span<const double> cell_volumes, std::span<const Vector3> cell_centres,
                 std::int64_t step, int threads, std::span<double> voidage) {
  const int cells = weights.cells();
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < cells; ++cell) {
    CompensatedSum solids;  // cells may hold many particles, far smaller than they are
    weights.deposit(
        cell, [&](double share) { solids.add(share); },
        [&](int particle) { return particle_volume[particle]; });
    voidage[cell] = 1 - solids.value() / cell_volumes[cell];
  }
  for (int cell = 0; cell < cells; ++cell) {
    if (voidage[cell] >= smallest_voidage) continue;
    const Vector3& centre = cell_centres[cell];
    throw NumericsError(
        "cell {} at ({}, {}, {}) m has the voidage {} after step {}, below {}: the particles in it "
        "need more room than it has; use larger cells, or interphase.voidage: exact if it is "
        "centroid",
        cell, centre.x(), centre.y(), centre.z(), voidage[cell], step, smallest_voidage);
  }
}

void map_velocity(const ParticleCellWeights& weights, std::span<const double> particle_volume,
                  std::span<const Vector3> particle_velocity, int threads,
                  std::span<Vector3> velocity) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < weights.cells(); ++cell) {
    double volume = 0;
    Vector3 moment = Vector3::Zero();
    weights.deposit(
        cell, [&](double share) { volume += share; },
        [&](int particle) { return particle_volume[particle]; });
    weights.deposit(
        cell, [&](const Vector3& share) { moment += share; },
        [&](int particle) -> Vector3 {
          return particle_volume[particle] * particle_velocity[particle];
        });
    velocity[cell] = volume > 0 ? Vector3(moment / volume) : Vector3(Vector3::Zero());
  }
}

}  // namespace fluxpact
