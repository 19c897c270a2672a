#include "dem_server/backends/particle_rows.hpp"

#include <algorithm>
#include <numeric>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

template <class T>
void reorder(const std::vector<int>& order, std::vector<T>& values) {
  std::vector<T> sorted;
  sorted.reserve(order.size());
  for (const int row : order) sorted.push_back(values[row]);
  values = std::move(sorted);
}

void check_row(const ParticleState& particles, int row, int materials) {
  const auto refuse = [&](const char* what, double value, const char* allowed) {
    throw ConfigError("particle {}: {} is {}; it must be {}", particles.id[row], what, value,
                      allowed);
  };
  if (row > 0 && particles.id[row] == particles.id[row - 1]) {
    throw ConfigError("particle {}: the id stands twice; every particle needs its own",
                      particles.id[row]);
  }
  const double radius = particles.radius[row];
  const double density = particles.density[row];
  const int material = particles.material[row];
  if (!(radius > 0 && std::isfinite(radius))) refuse("radius", radius, "positive [m]");
  if (!(density > 0 && std::isfinite(density))) refuse("density", density, "positive [kg/m³]");
  if (material < 0 || material >= materials) {
    refuse("material", material, "an index into particles.materials");
  }
  for (const Vector3& vector :
       {particles.position[row], particles.velocity[row], particles.spin[row]}) {
    if (!vector.allFinite()) refuse("position, velocity or spin", vector.sum(), "finite");
  }
  const double speed = particles.velocity[row].norm() + radius * particles.spin[row].norm();
  if (particles.is_fixed(row) && speed > 0) refuse("speed", speed, "0 [m/s], since it is fixed");
}

}  // namespace

ParticleState checked_rows(ParticleState particles, int materials) {
  const std::size_t count = particles.id.size();
  if (particles.position.size() != count || particles.velocity.size() != count ||
      particles.spin.size() != count || particles.radius.size() != count ||
      particles.density.size() != count || particles.material.size() != count ||
      (!particles.fixed.empty() && particles.fixed.size() != count)) {
    throw ConfigError(
        "the particle arrays differ in length; each needs one row for each of the {} ids", count);
  }
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return particles.id[a] < particles.id[b]; });
  reorder(order, particles.id);
  reorder(order, particles.position);
  reorder(order, particles.velocity);
  reorder(order, particles.spin);
  reorder(order, particles.radius);
  reorder(order, particles.density);
  reorder(order, particles.material);
  if (!particles.fixed.empty()) reorder(order, particles.fixed);
  for (int row = 0; row < particles.size(); ++row) check_row(particles, row, materials);
  return particles;
}

void exchange_rows(std::span<const int> leaving, const ParticleState& entering,
                   ParticleState& particles) {
  std::int64_t last = particles.id.empty() ? 0 : particles.id.back();
  for (const std::int64_t id : entering.id) {
    if (id <= last) {
      throw ConfigError("particle {} enters after {}: ids of those that enter must ascend", id,
                        last);
    }
    last = id;
  }
  if (!particles.fixed.empty() || !entering.fixed.empty()) {
    std::vector<std::uint8_t> added = entering.fixed;
    added.resize(entering.id.size(), 0);
    particles.fixed.resize(particles.id.size(), 0);
    remove_rows(leaving, particles.fixed);
    particles.fixed.insert(particles.fixed.end(), added.begin(), added.end());
  }
  const auto exchange = [&](auto& values, const auto& added) {
    remove_rows(leaving, values);
    values.insert(values.end(), added.begin(), added.end());
  };
  exchange(particles.id, entering.id);
  exchange(particles.position, entering.position);
  exchange(particles.velocity, entering.velocity);
  exchange(particles.spin, entering.spin);
  exchange(particles.radius, entering.radius);
  exchange(particles.density, entering.density);
  exchange(particles.material, entering.material);
}

}  // namespace fluxpact
