#include "dem_server/backends/lammps/lammps_script.hpp"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "dem_server/backends/granular/box_command.hpp"

namespace fluxpact {
namespace {

/// Common mass [kg] if all spheres that can meet have one and follow one law.
std::optional<double> one_mass(const LammpsScene& scene) {
  const ParticleState& spheres = scene.spheres;
  if (scene.more_to_come || spheres.size() == 0) return {};
  if (scene.laws.model().law != ContactLaw::linear || scene.laws.walls() != 1) return {};
  const double mass = sphere_mass(spheres.radius[0], spheres.density[0]);
  for (int row = 0; row < spheres.size(); ++row) {
    if (spheres.is_fixed(row)) return {};
    if (sphere_mass(spheres.radius[row], spheres.density[row]) != mass) return {};
  }
  return mass;
}

/// The law in the words of `pair_style gran/hooke/history` and `fix wall/gran hooke/history`.
std::string plain_law(const PairLaw& law, double effective_mass) {
  const double normal = law[LawColumn::damping] / std::sqrt(effective_mass);
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 1", law[LawColumn::normal],
                     law[LawColumn::tangential], normal,
                     law[LawColumn::tangential_damping] * normal, law[LawColumn::friction]);
}

/// The law in the words of `pair_style granular`, for any masses and radii.
std::string granular_law(const ContactModel& model, const PairLaw& law) {
  const bool linear = model.law == ContactLaw::linear;
  // Of the linear law c_n = damping sqrt(m*); of Hertz' damping sqrt(2 E* a m*), where LAMMPS takes
  // the secant 4/3 E* a of the spring.
  const double share =
      law[LawColumn::damping] * (linear ? 1 / std::sqrt(law[LawColumn::normal]) : std::sqrt(1.5));
  const double normal = (linear ? 1 : 2.0 / 3.0) * law[LawColumn::normal];
  return fmt::format("{} {:.17g} {:.17g} tangential {} {:.17g} {:.17g} {:.17g} damping tsuji",
                     linear ? "hooke" : "hertz", normal, tsuji_coefficient(share),
                     linear ? "linear_history" : "mindlin_rescale/force",
                     law[LawColumn::tangential], law[LawColumn::tangential_damping],
                     law[LawColumn::friction]);
}

/// Pairs that cannot meet need numbers, too: those of any that can.
const PairLaw& law_of(const ContactLaws& laws, int a, int b) {
  const PairLaw& law = laws[laws.index(a, b)];
  if (law.given) return law;
  for (int pair = 0; pair < laws.count(); ++pair) {
    if (laws[pair].given) return laws[pair];
  }
  return law;
}

void add_pairs(const LammpsScene& scene, std::optional<double> mass,
               std::vector<std::string>& start) {
  const ContactLaws& laws = scene.laws;
  if (mass) {
    start.push_back("pair_style gran/hooke/history " + plain_law(law_of(laws, 0, 0), *mass / 2));
    start.emplace_back("pair_coeff * *");
    return;
  }
  start.emplace_back("pair_style granular");
  const int materials = laws.walls();
  for (int a = 0; a < 2 * materials; ++a) {
    for (int b = a; b < 2 * materials; ++b) {
      start.push_back(
          fmt::format("pair_coeff {} {} {}", a + 1, b + 1,
                      granular_law(laws.model(), law_of(laws, a % materials, b % materials))));
    }
  }
}

void add_walls(const LammpsScene& scene, std::optional<double> mass,
               std::vector<std::string>& walls) {
  const ContactLaws& laws = scene.laws;
  for (int material = 0; material < laws.walls(); ++material) {
    const PairLaw& law = law_of(laws, material, laws.walls());
    const std::string words = mass ? "hooke/history " + plain_law(law, *mass)
                                   : "granular " + granular_law(laws.model(), law);
    for (int side = 0; side < 6; ++side) {
      if (scene.domain.sides[side] != SideKind::wall) continue;
      const std::string plane = fmt::format("{:.17g}", scene.domain.plane(side));
      // A fix for each side: one that has two planes minds only the nearer one.
      walls.push_back(fmt::format("fix wall_{}_{} material_{} wall/gran {} {}plane {}", material,
                                  side_name(side), material, words, "xyz"[side / 2],
                                  side % 2 == 0 ? plane + " NULL" : "NULL " + plane));
    }
  }
}

}  // namespace

double tsuji_coefficient(double share) {
  const auto polynomial = [](double c) {
    return 1.2728 - 4.2783 * c + 11.087 * std::pow(c, 2) - 22.348 * std::pow(c, 3) +
           27.467 * std::pow(c, 4) - 18.022 * std::pow(c, 5) + 4.8218 * std::pow(c, 6);
  };
  // It falls all the way from 89 at -1 to below 0 at 1.05.
  double low = -1;
  double high = 1.05;
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (polynomial(middle) > share ? low : high) = middle;
  }
}

int lammps_type(const ParticleState& spheres, int materials, int row) {
  return spheres.material[row] + 1 + (spheres.is_fixed(row) ? materials : 0);
}

LammpsScript lammps_script(const LammpsScene& scene) {
  const int materials = scene.laws.walls();
  const BoxCommands box = box_commands(scene.domain, scene.gravity, scene.spheres);
  const Vector3& g = scene.gravity;
  const std::optional<double> mass = one_mass(scene);
  LammpsScript script;
  script.mass = mass;
  std::vector<std::string>& start = script.start;
  start.emplace_back("units si");
  start.emplace_back("atom_style sphere");
  start.emplace_back("atom_modify map yes sort 0 0");  // rows keep their order
  start.push_back(box.boundary);
  start.push_back(box.processors);
  start.emplace_back("newton off");
  start.emplace_back("comm_modify vel yes");
  start.push_back(box.region);
  start.push_back(fmt::format("create_box {} box", 2 * materials));
  add_pairs(scene, mass, start);
  start.push_back(box.neighbor);
  start.emplace_back("neigh_modify delay 0 every 1 check yes");
  start.emplace_back("group free empty");
  start.emplace_back("group fixed empty");
  start.emplace_back("neigh_modify exclude group fixed fixed");
  start.emplace_back("fix motion free nve/sphere");
  if (g.norm() > 0) {
    start.push_back(fmt::format("fix weight free gravity {:.17g} vector {:.17g} {:.17g} {:.17g}",
                                g.norm(), g.x(), g.y(), g.z()));
  }
  start.emplace_back("fix fluid free external pf/array 1");
  start.emplace_back("fix rest fixed freeze");
  start.emplace_back("thermo_style custom step atoms");
  start.emplace_back("thermo_modify lost ignore norm no");  // we name who is lost
  script.groups.push_back(fmt::format("group free type 1:{}", materials));
  script.groups.push_back(fmt::format("group fixed type {}:{}", materials + 1, 2 * materials));
  for (int material = 0; material < materials; ++material) {
    script.groups.push_back(fmt::format("group material_{} type {}", material, material + 1));
  }
  add_walls(scene, mass, script.walls);
  return script;
}

}  // namespace fluxpact
