#include "dem_server/backends/liggghts/liggghts_script.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "dem_server/backends/granular/box_command.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr const char* model = "model hooke/stiffness tangential history";

/// What a contact of two types reads: spheres of two kinds, or of one and the walls.
struct TypePair {
  const PairLaw& law;
  double damping;  ///< [1/s] normal, per effective mass
};

class TypePairs {
 public:
  TypePairs(const ContactLaws& laws, bool walls, const std::vector<SphereKind>& kinds)
      : laws_(laws), walls_(walls ? 1 : 0), kinds_(kinds) {}

  int count() const { return static_cast<int>(kinds_.size()) + walls_; }

  TypePair operator()(int a, int b) const {
    const double inverse = inverse_mass(a) + inverse_mass(b);
    // Two that nothing moves never meet: any number will do.
    const double mass = inverse > 0 ? 1 / inverse : 1.0;
    const PairLaw& law = law_of(material(a), material(b));
    return {law, law[LawColumn::damping] / std::sqrt(mass)};
  }

 private:
  int material(int type) const {
    return type < walls_ ? laws_.walls() : kinds_[type - walls_].material;
  }
  double inverse_mass(int type) const {
    if (type < walls_ || kinds_[type - walls_].fixed) return 0;
    return 1 / kinds_[type - walls_].mass;
  }
  /// Pairs that cannot meet need numbers, too: those of any that can.
  const PairLaw& law_of(int a, int b) const {
    const PairLaw& law = laws_[laws_.index(a, b)];
    if (law.given) return law;
    for (int pair = 0; pair < laws_.count(); ++pair) {
      if (laws_[pair].given) return laws_[pair];
    }
    return law;
  }

  const ContactLaws& laws_;
  int walls_;  ///< types of walls: the first, or none
  const std::vector<SphereKind>& kinds_;
};

std::string property(const char* name, const TypePairs& pairs,
                     const std::function<double(const TypePair&)>& value) {
  std::string words =
      fmt::format("fix {0} all property/global {0} peratomtypepair {1}", name, pairs.count());
  for (int a = 0; a < pairs.count(); ++a) {
    for (int b = 0; b < pairs.count(); ++b) words += fmt::format(" {:.17g}", value(pairs(a, b)));
  }
  return words;
}

std::string group_command(const char* name, const std::vector<SphereKind>& kinds, int first,
                          bool fixed) {
  std::string words = fmt::format("group {} type", name);
  bool any = false;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (kinds[k].fixed != fixed) continue;
    words += fmt::format(" {}", static_cast<int>(k) + first);
    any = true;
  }
  return any ? words : std::string();
}

}  // namespace

SphereKind kind_of(const ParticleState& spheres, int row) {
  return {spheres.material[row], sphere_mass(spheres.radius[row], spheres.density[row]),
          spheres.is_fixed(row)};
}

ParticleState spheres_to_come(const Scene& scene) {
  ParticleState spheres;
  const auto& materials = scene.particles.materials;
  for (const InflowSettings& inflow : scene.particles.inflow) {
    std::vector<double> diameters{inflow.diameter};
    if (inflow.sizes) {
      diameters.clear();
      for (const auto& [diameter, weight] : inflow.sizes->table) diameters.push_back(diameter);
    }
    const auto material = materials.find(inflow.material);
    for (const double diameter : diameters) {
      spheres.id.push_back(0);
      spheres.radius.push_back(0.5 * diameter);
      spheres.density.push_back(material->second.density);
      spheres.material.push_back(static_cast<int>(std::distance(materials.begin(), material)));
    }
  }
  return spheres;
}

void add_kinds(const ParticleState& spheres, bool walls, std::vector<SphereKind>& kinds) {
  const std::size_t most = walls ? most_kinds : 1;
  for (int row = 0; row < spheres.size(); ++row) {
    const SphereKind kind = kind_of(spheres, row);
    if (std::ranges::find(kinds, kind) != kinds.end()) continue;
    if (kinds.size() == most) {
      throw ConfigError(
          "particles.backend: liggghts knows at most {} kinds of spheres here (of one material and "
          "mass, free or fixed), and one of diameter {:.6g} m is of another; use fewer diameters, "
          "or "
          "the native or lammps backend",
          most, 2 * spheres.radius[row]);
    }
    kinds.push_back(kind);
  }
}

std::vector<std::string> liggghts_script(const Domain& domain, const ContactLaws& laws,
                                         const Vector3& gravity, const ParticleState& spheres,
                                         const std::vector<SphereKind>& kinds) {
  const bool walls = std::ranges::count(domain.sides, SideKind::wall) > 0;
  const TypePairs pairs(laws, walls, kinds);
  const BoxCommands box = box_commands(domain, gravity, spheres);
  std::vector<std::string> script{"units si",
                                  "atom_style granular",
                                  "atom_modify map hash sort 0 0",  // rows keep their order
                                  box.boundary,
                                  box.processors,
                                  "newton off",
                                  "communicate single vel yes",
                                  box.region,
                                  fmt::format("create_box {} box", pairs.count()),
                                  box.neighbor,
                                  "neigh_modify delay 0 every 1 check yes"};
  script.push_back(
      property("kn", pairs, [](const TypePair& pair) { return pair.law[LawColumn::normal]; }));
  script.push_back(
      property("kt", pairs, [](const TypePair& pair) { return pair.law[LawColumn::tangential]; }));
  script.push_back(property("gamman", pairs, [](const TypePair& pair) { return pair.damping; }));
  script.push_back(property("gammat", pairs, [](const TypePair& pair) {
    return pair.law[LawColumn::tangential_damping] * pair.damping;
  }));
  script.push_back(property("coefficientFriction", pairs,
                            [](const TypePair& pair) { return pair.law[LawColumn::friction]; }));
  script.push_back(fmt::format("pair_style gran {}", model));
  script.emplace_back("pair_coeff * *");
  const std::string free = group_command("free", kinds, first_type(walls), false);
  const std::string fixed = group_command("fixed", kinds, first_type(walls), true);
  if (!free.empty()) {
    script.push_back(free);
    script.emplace_back("fix motion free nve/sphere");
    if (gravity.norm() > 0) {
      script.push_back(fmt::format("fix weight free gravity {:.17g} vector {:.17g} {:.17g} {:.17g}",
                                   gravity.norm(), gravity.x(), gravity.y(), gravity.z()));
    }
  }
  for (int side = 0; side < 6; ++side) {
    if (domain.sides[side] != SideKind::wall) continue;
    script.push_back(fmt::format("fix wall_{} all wall/gran {} primitive type 1 {}plane {:.17g}",
                                 side_name(side), model, "xyz"[side / 2], domain.plane(side)));
  }
  script.emplace_back("fix fluid all external pf/array 1");
  if (!fixed.empty()) {
    script.push_back(fixed);
    script.emplace_back("neigh_modify exclude group fixed fixed");
    script.emplace_back("fix rest fixed freeze");
  }
  script.emplace_back("thermo_style custom step atoms");
  script.emplace_back("thermo_modify norm no lost ignore");  // we name who is lost
  return script;
}

}  // namespace fluxpact
