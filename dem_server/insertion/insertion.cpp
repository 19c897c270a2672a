#include "dem_server/insertion/insertion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem_server/insertion/entry_box.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/placement_check.hpp"
#include "dem_server/insertion/push_apart.hpp"
#include "dem_server/insertion/read_particles.hpp"
#include "dem_server/insertion/settling.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// Overlap that `particles.overlaps: relax` may leave, of the smaller diameter.
constexpr double relaxed_overlap = 0.01;

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

std::string name_of(const Entry& entry) {
  return fmt::format("particles.insertion entry {}", entry.number);
}

std::vector<ListedParticle> listed(const std::vector<Vector3>& centres,
                                   std::span<const double> diameters, const Vector3& velocity) {
  std::vector<ListedParticle> particles;
  particles.reserve(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    particles.push_back({centres[i], velocity, Vector3::Zero(), diameters[i]});
  }
  return particles;
}

std::vector<ListedParticle> pack(const Entry& entry, const PackingBox& box) {
  const InsertionSettings& settings = entry.settings;
  const auto seed = static_cast<std::uint64_t>(settings.seed);
  const std::vector<double> diameters = entry_diameters(name_of(entry), settings, box.volume());
  const auto packing = random_packing(box, diameters, seed);
  if (packing) return listed(*packing, diameters, settings.velocity);
  const int fits = largest_packing(box, diameters, seed);
  const auto fraction = [&](int count) {
    double volume = 0;
    for (int i = 0; i < count; ++i) volume += sphere_volume(diameters[i]);
    return volume / box.volume();
  };
  const int count = static_cast<int>(diameters.size());
  const Vector3 size = box.upper - box.lower;
  throw ConfigError(
      "{}: {} spheres of {:.4g} m fill {:.3f} of the region of {:.4g} x {:.4g} x {:.4g} m, which a "
      "random packing does not reach{}; {} fit, a fraction of {:.3f}: ask for fewer, or enlarge "
      "`within`",
      name_of(entry), count, *std::max_element(diameters.begin(), diameters.end()), fraction(count),
      size.x(), size.y(), size.z(), box.room == nullptr ? "" : " between the walls in it", fits,
      fraction(fits));
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

std::vector<ListedParticle> placed(const Scene& scene, const Entry& entry, const Domain& domain,
                                   const Room& room, const Mesh& mesh, const Progress& alive) {
  const InsertionSettings& settings = entry.settings;
  if (settings.type == InsertionType::file) {
    std::vector<ListedParticle> particles = read_particles(settings.path, settings.group);
    for (ListedParticle& particle : particles) {
      if (!particle.diameter) particle.diameter = diameter_of(entry);
    }
    return particles;
  }
  PackingBox box = entry_box(name_of(entry), settings.within, domain);
  if (!room.unbounded()) box.room = &room;
  box.alive = alive;
  if (settings.type == InsertionType::packing) return pack(entry, box);
  if (settings.type == InsertionType::settled) {
    return settled_bed(scene, name_of(entry), settings, box, domain, mesh, alive);
  }
  std::vector<Vector3> centres = lattice(entry, box);
  std::erase_if(centres, [&](const Vector3& x) { return !room.fits(x, 0.5 * settings.diameter); });
  return listed(centres, std::vector<double>(centres.size(), settings.diameter), settings.velocity);
}

/// Push apart whatever overlaps.
void relax(const Domain& domain, const Room& room, const std::vector<int>& entry,
           const Progress& alive, ParticleState& state) {
  std::vector<double> diameters;
  for (const double radius : state.radius) diameters.push_back(2 * radius);
  const PushedApart result = push_apart(domain, diameters, relaxed_overlap, state.position,
                                        room.unbounded() ? nullptr : &room, alive);
  if (result.done) return;
  if (result.b < 0) {
    throw ConfigError(
        "particles.overlaps: relax: particle {} of particles.insertion entry {} still sticks into "
        "the wall `{}` by {:.3g} of its diameter, {} is allowed: there is no room for so many; ask "
        "for fewer, or enlarge the domain",
        state.id[result.a], entry[result.a], room.nearest_wall(state.position[result.a]),
        result.overlap, relaxed_overlap);
  }
  throw ConfigError(
      "particles.overlaps: relax: particle {} of particles.insertion entry {} and particle {} of "
      "entry {} still overlap by {:.3g} of the smaller diameter, {} is allowed: there is no room "
      "for so many; ask for fewer, or enlarge the domain",
      state.id[result.a], entry[result.a], state.id[result.b], entry[result.b], result.overlap,
      relaxed_overlap);
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

ParticleState insert_particles(const Scene& scene, const Mesh& mesh, const Progress& alive) {
  const Domain domain = particle_domain(scene, mesh);
  const Room room(scene, mesh);
  const std::vector<std::string> names = material_names(scene.particles);
  ParticleState state;
  std::vector<int> entry_of;
  bool any_fixed = false;
  for (const InsertionSettings& settings : scene.particles.insertion) {
    const Entry entry{settings, static_cast<int>(&settings - scene.particles.insertion.data()) + 1};
    const int material = material_index(entry, names);
    const double density = scene.particles.materials.at(settings.material).density;
    const bool fixed = settings.motion == Mobility::fixed;
    any_fixed = any_fixed || fixed;
    for (const ListedParticle& particle : placed(scene, entry, domain, room, mesh, alive)) {
      state.id.push_back(state.size() + 1);
      state.position.push_back(particle.position);
      // A file may hold the speeds at which particles were caught.
      state.velocity.push_back(fixed ? Vector3::Zero() : particle.velocity);
      state.spin.push_back(fixed ? Vector3::Zero() : particle.spin);
      state.fixed.push_back(fixed ? 1 : 0);
      state.radius.push_back(0.5 * *particle.diameter);
      state.density.push_back(density);
      state.material.push_back(material);
      entry_of.push_back(entry.number);
    }
  }
  if (!any_fixed) state.fixed.clear();
  if (scene.particles.overlaps == Overlaps::relax) relax(domain, room, entry_of, alive, state);
  check_placement(state, entry_of, domain);
  check_walls(state, entry_of, room);
  return state;
}

}  // namespace fluxpact
