#include "dem_server/interphase/voidage.hpp"

#include <algorithm>

#include "proto/base/compensated_sum.hpp"

namespace fluxpact {

void particle_volumes(const ParticleState& particles, std::vector<double>& volumes) {
  volumes.resize(particles.radius.size());
  std::ranges::transform(particles.radius, volumes.begin(), ball_volume);
}

double map_voidage(ParticleCellWeights& weights, std::span<const double> particle_volume,
                   std::span<const double> cell_volumes, ExcessFinder& excess, std::int64_t step,
                   int threads, std::span<double> voidage, const AddUp& add_up) {
  const std::span<double> solids = voidage;  // [m³] first
  const int cells = weights.cells();
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < cells; ++cell) {
    CompensatedSum sum;  // cells may hold many particles, far smaller than they are
    weights.deposit(
        cell, [&](double share) { sum.add(share); },
        [&](int particle) { return particle_volume[particle]; });
    solids[cell] = sum.value();
  }
  if (add_up) add_up(solids);
  if (weights.diffusion != nullptr) weights.diffusion->spread(solids);
  const double moved = excess.move(step, solids, weights.excess);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < cells; ++cell) voidage[cell] = 1 - solids[cell] / cell_volumes[cell];
  return moved;
}

void map_velocity(const ParticleCellWeights& weights, std::span<const double> particle_volume,
                  std::span<const Vector3> particle_velocity, int threads,
                  std::vector<double>& solids, std::span<Vector3> velocity, const AddUp& add_up) {
  solids.resize(velocity.size());
  const std::span<double> volumes(solids);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < weights.cells(); ++cell) {
    double volume = 0;
    Vector3 moment = Vector3::Zero();
    weights.each_in(cell, [&](int particle, double weight) {
      const double share = weight * particle_volume[particle];
      volume += share;
      moment += share * particle_velocity[particle];
    });
    volumes[cell] = volume;
    velocity[cell] = moment;
  }
  if (add_up) {
    add_up(volumes);
    add_up(numbers_in(velocity));
  }
  weights.spread(volumes);
  weights.spread(velocity);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int cell = 0; cell < weights.cells(); ++cell) {
    if (volumes[cell] > 0) velocity[cell] /= volumes[cell];
  }
}

}  // namespace fluxpact
