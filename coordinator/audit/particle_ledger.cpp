#include "coordinator/audit/particle_ledger.hpp"

#include <cmath>

namespace fluxpact {

ParticleTotal start_particles(std::int64_t count, double mass) {
  ParticleTotal total;
  total.initial_mass = mass;
  total.count = count;
  return total;
}

ParticleAudit audit_particles(const ParticleWindow& window, const ParticleTotal& committed) {
  ParticleAudit audit{window, 0, 0, committed};
  ParticleTotal& total = audit.total;
  total.count += window.entered - window.left;
  total.count_entered += window.entered;
  total.count_left += window.left;
  total.gained.add(window.mass_entered);
  total.gained.add(-window.mass_left);
  total.entered.add(window.mass_entered);
  total.left.add(window.mass_left);

  CompensatedSum missing = total.gained;
  missing.add(total.initial_mass);
  missing.add(-window.mass);
  const double error = std::abs(missing.value());
  audit.mass_error = error == 0 ? 0 : error / (total.initial_mass + total.entered.value());
  audit.count_error = std::abs(static_cast<double>(total.count - window.count));
  return audit;
}

}  // namespace fluxpact
