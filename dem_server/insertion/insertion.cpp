#include "dem_server/insertion/insertion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// The box of an entry: its `within` where given, else the domain.
PackingBox box_of(const Entry& entry, const Domain& domain) {
  PackingBox box{domain.lower, domain.upper, {}};
  const Region& within = entry.settings.within;
  const std::array<const std::optional<std::array<double, 2>>*, 3> ranges{&within.x, &within.y,
                                                                          &within.z};
  for (int axis = 0; axis < 3; ++axis) {
    box.periodic[axis] = domain.periodic(axis);
    if (!ranges[axis]->has_value()) continue;
    const auto [low, high] = **ranges[axis];
    // A bound written with fewer digits than the mesh's point is still the side.
    const double rounding = 1e-9 * domain.length(axis);
    if (!(low < high) || low < domain.lower[axis] - rounding ||
        high > domain.upper[axis] + rounding) {
      throw ConfigError(
          "particles.insertion entry {}: within.{} is [{:.6g}, {:.6g}] m; it must ascend and lie "
          "in the "
          "domain, [{:.6g}, {:.6g}] m",
          entry.number, "xyz"[axis], low, high, domain.lower[axis], domain.upper[axis]);
    }
    const bool whole =
        low <= domain.lower[axis] + rounding && high >= domain.upper[axis] - rounding;
    box.periodic[axis] = box.periodic[axis] && whole;
    box.lower[axis] = std::max(low, domain.lower[axis]);
    box.upper[axis] = std::min(high, domain.upper[axis]);
  }
  return box;
}

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
      "x {:.4g} m, which a random packing does not reach{}; {} fit, a fraction of {:.3f}: lower "
      "`count` or "
      "enlarge `within`",
      entry.number, settings.count, diameter, settings.count * share, size.x(), size.y(), size.z(),
      box.room == nullptr ? "" : " between the walls in it", fits, fits * share);
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

/// The centres at which a sphere is clear of the walls in the room.
std::vector<Vector3> fitting(std::vector<Vector3> centres, const Room& room, double diameter) {
  std::erase_if(centres, [&](const Vector3& x) { return !room.fits(x, 0.5 * diameter); });
  return centres;
}

std::vector<ListedParticle> placed(const Entry& entry, const Domain& domain, const Room& room) {
  if (entry.settings.type == InsertionType::file) {
    std::vector<ListedParticle> listed = read_particles(entry.settings.path);
    for (ListedParticle& particle : listed) {
      if (!particle.diameter) particle.diameter = diameter_of(entry);
    }
    return listed;
  }
  PackingBox box = box_of(entry, domain);
  if (!room.unbounded()) box.room = &room;
  const std::vector<Vector3> centres =
      entry.settings.type == InsertionType::packing
          ? pack(entry, box)
          : fitting(lattice(entry, box), room, entry.settings.diameter);
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
  const Room room(scene, mesh);
  const std::vector<std::string> names = material_names(scene.particles);
  ParticleState state;
  std::vector<int> entry_of;
  for (const InsertionSettings& settings : scene.particles.insertion) {
    const Entry entry{settings, static_cast<int>(&settings - scene.particles.insertion.data()) + 1};
    const int material = material_index(entry, names);
    const double density = scene.particles.materials.at(settings.material).density;
    for (const ListedParticle& particle : placed(entry, domain, room)) {
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
  check_walls(state, entry_of, room);
  return state;
}

}  // namespace fluxpact
