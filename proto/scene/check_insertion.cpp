// What must fit together in particles.insertion, particles.inflow and particles.outflow.
#include <algorithm>

#include "proto/scene/check.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

constexpr double largest_ratio = 10;  // of the diameters: the pair lists grow with its cube

template <class Map>
std::vector<std::string> names_in(const Map& map) {
  std::vector<std::string> names;
  for (const auto& [name, value] : map) names.push_back(name);
  return names;
}

void check_material(const Scene& scene, const std::string& entry, const std::string& name,
                    Findings& findings) {
  const std::string path = entry + ".material";
  if (!findings.sound(path) || scene.particles.materials.contains(name)) return;
  const std::vector<std::string> materials = names_in(scene.particles.materials);
  findings.add(path, fmt::format("`{}` is none of particles.materials{}; allowed: {}", name,
                                 nearest_hint(name, materials),
                                 materials.empty() ? "none is given" : joined(materials)));
}

/// Exactly one of some keys.
struct Choice {
  const char* key;
  bool given;
};

void check_choice(const std::string& path, std::initializer_list<Choice> choices,
                  Findings& findings) {
  std::vector<std::string> all;
  std::vector<std::string> given;
  for (const Choice& choice : choices) {
    if (!findings.sound(fmt::format("{}.{}", path, choice.key))) return;
    all.push_back(fmt::format("`{}`", choice.key));
    if (choice.given) given.push_back(all.back());
  }
  if (given.size() == 1) return;
  findings.add(path, fmt::format("{} given; exactly one of {} is needed",
                                 given.empty() ? "none is" : joined(given) + " are", joined(all)));
}

void check_sizes(const std::string& path, const std::optional<SizeSettings>& sizes,
                 Findings& findings) {
  if (!sizes || !findings.sound(path)) return;
  const bool table = sizes->distribution == SizeDistribution::table;
  if (table && sizes->table.empty()) return;  // said already
  const double low = table ? sizes->table.front()[0] : sizes->range[0];
  const double high = table ? sizes->table.back()[0] : sizes->range[1];
  if (high <= largest_ratio * low) return;
  findings.add(path + (table ? ".table" : ".range"),
               fmt::format("diameters from {} m to {} m, {:.3g} times; at most {} times: leave out "
                           "the smallest",
                           low, high, high / low, largest_ratio));
}

void check_entry(const Scene& scene, const std::string& path, const InsertionSettings& entry,
                 Findings& findings) {
  check_material(scene, path, entry.material, findings);
  if (!findings.sound(path + ".type")) return;
  const bool settled = entry.type == InsertionType::settled;
  if (entry.type == InsertionType::lattice && entry.diameter == 0 &&
      findings.sound(path + ".diameter")) {
    findings.add(path + ".diameter", "missing; required with `type: lattice`: a number in m, > 0");
  }
  if (entry.type != InsertionType::packing && !settled) return;
  check_choice(path, {{"diameter", entry.diameter > 0}, {"sizes", entry.sizes.has_value()}},
               findings);
  check_sizes(path + ".sizes", entry.sizes, findings);
  const Choice count{"count", entry.count > 0};
  const Choice fraction{"fraction", entry.fraction > 0};
  const Choice density{"number_density", entry.number_density > 0};
  if (settled) {
    check_choice(path, {count, fraction, density, {"height", entry.height > 0}}, findings);
  } else {
    check_choice(path, {count, fraction, density}, findings);
  }
  if (settled && scene.scene.gravity.isZero() && findings.sound("scene.gravity")) {
    findings.add(path + ".type", "`settled` needs scene.gravity, which is zero; use `packing`");
  }
  // Hard spheres settle on the springs of their pairs, which are demanded then.
  if (settled && !knows_contacts(scene.particles.backend) && findings.sound("particles.backend")) {
    findings.add(path + ".type",
                 fmt::format("`settled` needs springs, and particles.backend: {} has none; settle "
                             "the bed with `native` and read it from its results.h5 (type: file)",
                             name_of(scene.particles.backend)));
  }
}

void check_inflow(const Scene& scene, const std::string& path, const InflowSettings& inflow,
                  Findings& findings) {
  check_material(scene, path, inflow.material, findings);
  check_choice(path, {{"patch", !inflow.patch.empty()}, {"within", inflow.within.has_value()}},
               findings);
  check_choice(path, {{"diameter", inflow.diameter > 0}, {"sizes", inflow.sizes.has_value()}},
               findings);
  check_choice(path, {{"mass_rate", inflow.mass_rate > 0}, {"number_rate", inflow.number_rate > 0}},
               findings);
  check_sizes(path + ".sizes", inflow.sizes, findings);
  if (inflow.stop && *inflow.stop <= inflow.start && findings.sound(path + ".stop")) {
    findings.add(path + ".stop",
                 fmt::format("{} s is not after `start`, {} s", *inflow.stop, inflow.start));
  }
}

/// A patch that the fluid's boundaries name; nothing, and a finding, if there is none.
const BoundarySettings* patch_of(const Scene& scene, const std::string& name,
                                 const std::string& path, Findings& findings) {
  const auto found = scene.fluid.boundaries.find(name);
  if (found != scene.fluid.boundaries.end()) return &found->second;
  const std::vector<std::string> names = names_in(scene.fluid.boundaries);
  findings.add(path,
               fmt::format("`{}`: no such patch in fluid.boundaries{}; patches: {}", name,
                           nearest_hint(name, names), names.empty() ? "none" : joined(names)));
  return nullptr;
}

void check_outflow(const Scene& scene, Findings& findings) {
  if (!scene.particles.outflow || !findings.sound("particles.outflow")) return;
  for (std::size_t i = 0; i < scene.particles.outflow->size(); ++i) {
    const std::string& name = scene.particles.outflow->at(i);
    const std::string path = fmt::format("particles.outflow[{}]", i);
    const BoundarySettings* const patch = patch_of(scene, name, path, findings);
    if (patch != nullptr && patch->type != BoundaryType::pressure) {
      findings.add(
          path, fmt::format("`{}` is of type {}, a wall to particles; they leave through patches "
                            "of type pressure",
                            name, name_of(patch->type)));
    }
  }
}

}  // namespace

void check_insertion(const Scene& scene, Findings& findings) {
  if (!findings.sound("particles.materials")) return;
  for (std::size_t i = 0; i < scene.particles.insertion.size(); ++i) {
    check_entry(scene, fmt::format("particles.insertion[{}]", i), scene.particles.insertion[i],
                findings);
  }
  if (!findings.sound("fluid.boundaries")) return;
  for (std::size_t i = 0; i < scene.particles.inflow.size(); ++i) {
    const InflowSettings& inflow = scene.particles.inflow[i];
    const std::string path = fmt::format("particles.inflow[{}]", i);
    check_inflow(scene, path, inflow, findings);
    if (!inflow.patch.empty()) patch_of(scene, inflow.patch, path + ".patch", findings);
  }
  check_outflow(scene, findings);
}

}  // namespace fluxpact
