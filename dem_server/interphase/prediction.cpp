#include "dem_server/interphase/prediction.hpp"

namespace fluxpact {
void velocities_ahead(const ExchangeSettings& settings, const ParticleState& particles,
                      const ParticleBulk& bulk, const Prediction& past, const WindowForces& forces,
                      double length, std::vector<Vector3>& velocity) {
  const int count = particles.size();
  velocity.resize(static_cast<std::size_t>(count));
#pragma omp parallel for schedule(static) num_threads(settings.threads)
  for (int i = 0; i < count; ++i) {
    const Vector3& now = particles.velocity[i];
    velocity[i] = now;
    if (!settings.mobile || particles.is_fixed(i)) continue;
    const int before = past_row(past, i);
    const double carried =
        before < 0 ? 0 : carried_in_past(settings, past, now, 1 / bulk.mass[i], before);
    velocity[i] += length * (1 - carried) * (settings.gravity + forces.force[i] / bulk.mass[i]);
  }
}

}  // namespace fluxpact
