// What must fit together in fluid.scalars and fluid.turbulence.
#include <algorithm>

#include "proto/scene/check.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

std::vector<std::string> patch_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, boundary] : scene.fluid.boundaries) names.push_back(name);
  return names;
}

/// The condition of the fluid on the patch `name`; nothing, and a finding, if there is no such
/// patch.
const BoundarySettings* condition(const Scene& scene, const std::string& name,
                                  const std::string& path, Findings& findings) {
  const auto found = scene.fluid.boundaries.find(name);
  if (found != scene.fluid.boundaries.end()) return &found->second;
  const std::vector<std::string> names = patch_names(scene);
  findings.add(path,
               fmt::format("no such patch in fluid.boundaries{}; patches: {}",
                           nearest_hint(name, names), names.empty() ? "none" : joined(names)));
  return nullptr;
}

void check_scalar_boundary(const Scene& scene, const std::string& scalar, const std::string& patch,
                           const ScalarBoundarySettings& entry, Findings& findings) {
  const std::string path = fmt::format("fluid.scalars.{}.boundaries.{}", scalar, patch);
  if (!findings.sound(path)) return;
  if (entry.value && entry.flux)
    findings.add(path, "`value` and `flux` are both given; at most one can hold, keep it");
  const BoundarySettings* const fluid = condition(scene, patch, path, findings);
  if (fluid != nullptr && entry.flux && fluid->type != BoundaryType::wall) {
    findings.add(path + ".flux",
                 fmt::format("has a meaning on walls only, `{}` is of type {}; give `value`", patch,
                             name_of(fluid->type)));
  }
}

void check_turbulence(const Scene& scene, Findings& findings) {
  const TurbulenceSettings& turbulence = scene.fluid.turbulence;
  if (turbulence.model != TurbulenceModel::k_epsilon) return;
  const auto brings = [](const BoundarySettings& boundary) {
    return boundary.type == BoundaryType::velocity || boundary.type == BoundaryType::mass_flow;
  };
  for (const auto& [name, inlet] : turbulence.inlets) {
    const std::string path = "fluid.turbulence.inlets." + name;
    const BoundarySettings* const fluid = condition(scene, name, path, findings);
    if (fluid != nullptr && !brings(*fluid)) {
      findings.add(path, fmt::format("the patch is of type {}; only velocity and mass_flow bring a "
                                     "turbulence of their own, remove the entry",
                                     name_of(fluid->type)));
    }
  }
  for (const auto& [name, boundary] : scene.fluid.boundaries) {
    const std::string path = "fluid.turbulence.inlets." + name;
    if (brings(boundary) && !turbulence.inlets.contains(name) && findings.sound(path)) {
      findings.add(path,
                   "missing; required with `model: k_epsilon`: what enters there needs a "
                   "turbulence, e.g. {intensity: 0.05, length_scale: 1 mm}");
    }
  }
}

}  // namespace

void check_scalars(const Scene& scene, Findings& findings) {
  if (!findings.sound("fluid.boundaries")) return;
  for (const auto& [name, scalar] : scene.fluid.scalars) {
    for (const auto& [patch, entry] : scalar.boundaries)
      check_scalar_boundary(scene, name, patch, entry, findings);
  }
  if (findings.sound("fluid.turbulence")) check_turbulence(scene, findings);
}

}  // namespace fluxpact
