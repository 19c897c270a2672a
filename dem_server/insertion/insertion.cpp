#include "dem_server/insertion/insertion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem_server/insertion/entry_box.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/placement_check.hpp"
#include "dem_server/insertion/read_particles.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// One entry of particles.insertion, its number from 1 for messages.
struct Entry {
  const InsertionSettings& settings;
  int number;
};

double diameter_of(const Entry& entry) {
  const double diameter = entry.settings.diameter;
  if (diameter > 0) return diameter;
  throw ConfigError("particles.insertion entry {}: diameter is {} m; it must be positive",
                    entry.number, diameter);
}

std::vector<Vector3> pack(const Entry& entry, const PackingBox& box) {
  const InsertionSettings& settings = entry.settings;
  const double diameter = diameter_of(entry);
  if (settings.count < 0) {
    throw ConfigError("particles.insertion entry {}: count is {}; it must not be negative",
                      entry.number, settings.count);
  }
  const auto seed = static_cast<std::uint64_t>(settings.seed);
  const auto packing = random_packing(box, settings.count, diameter, seed);
  if (packing) return *packing;
  const double share = std::numbers::pi / 6 * diameter * diameter * diameter / box.volume();
  const int fits = largest_packing(box, settings.count, diameter, seed);
  const Vector3 size = box.upper - box.lower;
  throw ConfigError(
      "particles.insertion entry {}: {} spheres of {:.4g} m fill {:.3f} of the region of {:.4g} x "
      "{:.4g} "
      "x {:.4g} m, which a random packing does not reach; {} fit, a fraction of {:.3f}: lower "
      "`count` or "
      "enlarge `within`",
      entry.number, settings.count, diameter, settings.count * share, size.x(), size.y(), size.z(),
      fits, fits * share);
}

/// A cubic lattice from the lower corner: the first sphere touches the sides, or lies half a
/// spacing from a periodic one.
std::vector<Vector3> lattice(const Entry& entry, const PackingBox& box) {
  const double diameter = diameter_of(entry);
  const double given = entry.settings.spacing;
  const double spacing = given > 0 ? given : 1.001 * diameter;
  std::array<int, 3> count{};
  Vector3 first;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = box.upper[axis] - box.lower[axis];
    const double room = box.periodic[axis] ? length - spacing : length - diameter;
    // A length that is a multiple of the spacing up to rounding holds that many.
    count[axis] = static_cast<int>(std::floor(room / spacing + 1e-9)) + 1;
    if (room < -1e-9 * spacing || count[axis] < 1) {
      throw ConfigError(
          "particles.insertion entry {}: the region is {:.6g} m long in {}, too short for one "
          "particle "
          "of diameter {:.6g} m at spacing {:.6g} m",
          entry.number, length, "xyz"[axis], diameter, spacing);
    }
    first[axis] = box.lower[axis] + 0.5 * (box.periodic[axis] ? spacing : diameter);
  }
  std::vector<Vector3> centres;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) centres.push_back(first + spacing * Vector3(i, j, k));
    }
  }
  return centres;
}

std::vector<ListedParticle> placed(const Entry& entry, const Domain& domain) {
  if (entry.settings.type == InsertionType::file) {
    std::vector<ListedParticle> listed = read_particles(entry.settings.path);
    for (ListedParticle& particle : listed) {
      if (!particle.diameter) particle.diameter = diameter_of(entry);
    }
    return listed;
  }
  const PackingBox box = entry_box(fmt::format("particles.insertion entry {}", entry.number),
                                   entry.settings.within, domain);
  const std::vector<Vector3> centres =
      entry.settings.type == InsertionType::packing ? pack(entry, box) : lattice(entry, box);
  std::vector<ListedParticle> particles;
  particles.reserve(centres.size());
  for (const Vector3& centre : centres) {
    particles.push_back({centre, entry.settings.velocity, entry.settings.diameter});
  }
  return particles;
}

int material_index(const Entry& entry, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), entry.settings.material);
  if (found == names.end()) {
    throw ConfigError(
        "particles.insertion entry {}: material `{}` is not in particles.materials ({})",
        entry.number, entry.settings.material, fmt::join(names, ", "));
  }
  return static_cast<int>(found - names.begin());
}

}  // namespace

std::vector<std::string> material_names(const ParticleSettings& settings) {
  std::vector<std::string> names;
  for (const auto& [name, material] : settings.materials) names.push_back(name);
  return names;
}

ParticleState insert_particles(const Scene& scene, const Mesh& mesh) {
  const Domain domain = particle_domain(scene, mesh);
  const std::vector<std::string> names = material_names(scene.particles);
  ParticleState state;
  std::vector<int> entry_of;
  for (const InsertionSettings& settings : scene.particles.insertion) {
    const Entry entry{settings, static_cast<int>(&settings - scene.particles.insertion.data()) + 1};
    const int material = material_index(entry, names);
    const double density = scene.particles.materials.at(settings.material).density;
    for (const ListedParticle& particle : placed(entry, domain)) {
      state.id.push_back(state.size() + 1);
      state.position.push_back(particle.position);
      state.velocity.push_back(particle.velocity);
      state.spin.push_back(Vector3::Zero());
      state.radius.push_back(0.5 * *particle.diameter);
      state.density.push_back(density);
      state.material.push_back(material);
      entry_of.push_back(entry.number);
    }
  }
  check_placement(state, entry_of, domain);
  return state;
}

}  // namespace fluxpact
