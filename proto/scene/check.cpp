#include "proto/scene/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "proto/base/expression.hpp"
#include "proto/scene/endpoint.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

constexpr std::string_view walls =
    "walls";  // the patch of all faces without a name, and its partner in contacts

bool is_sound(const Findings& findings, std::initializer_list<const char*> paths) {
  return std::all_of(paths.begin(), paths.end(),
                     [&](const char* path) { return findings.sound(path); });
}

template <class Map>
std::vector<std::string> names_in(const Map& map) {
  std::vector<std::string> names;
  names.reserve(map.size());
  for (const auto& [name, value] : map) {
    names.push_back(name);
  }
  return names;
}

void check_times(const Scene& scene, Findings& findings) {
  const double window = scene.coupling.window;
  const double end_time = scene.scene.end_time;
  const double time_step = scene.particles.time_step;
  constexpr double most = std::numeric_limits<int>::max();
  if (is_sound(findings, {"coupling.window", "scene.end_time"})) {
    const double count = end_time / window;
    if (count > most) {
      findings.add("coupling.window",
                   fmt::format("{} s gives {:.3g} windows until scene.end_time; at most {} are "
                               "counted, use a longer window",
                               window, count, most));
    } else if (windows(scene) == 0) {
      findings.add("scene.end_time",
                   fmt::format("{} s is not a whole number of windows of {} s; nearest: {} or {}",
                               end_time, window, std::max(1.0, std::floor(count)) * window,
                               std::max(2.0, std::ceil(count)) * window));
    }
  }
  if (!is_sound(findings, {"coupling.window", "particles.time_step", "particles.backend",
                           "particles.insertion"})) {
    return;
  }
  if (time_step > window) {
    findings.add("particles.time_step",
                 fmt::format("{} s is longer than coupling.window, {} s; at most one window",
                             time_step, window));
  } else if (time_step > 0 && window / time_step > most) {
    findings.add("particles.time_step",
                 fmt::format("{} s gives {:.3g} steps in a window; at most {} are counted",
                             time_step, window / time_step, most));
  } else if (time_step == 0 && knows_contacts(scene.particles.backend) && has_particles(scene)) {
    findings.add("particles.time_step",
                 fmt::format("missing; required with particles.backend: {}: a number in s, > 0",
                             name_of(scene.particles.backend)));
  }
}

void check_box(const Scene& scene, Findings& findings) {
  if (!scene.fluid.mesh.is_box() ||
      !is_sound(findings, {"fluid.mesh.box.lower", "fluid.mesh.box.upper"})) {
    return;
  }
  const BoxSettings& box = scene.fluid.mesh.box;
  for (const auto& axis : enum_names<Axis>) {
    const auto i = static_cast<int>(axis.value);
    if (!(box.upper[i] > box.lower[i])) {
      findings.add("fluid.mesh.box.upper",
                   fmt::format("{} in {} is not beyond `lower`, {}; the box has no volume",
                               box.upper[i], axis.name, box.lower[i]));
    }
  }
}

bool is_periodic(const MeshSettings& mesh, Side side) {
  const auto axis = static_cast<Axis>(static_cast<int>(side) / 2);
  return std::find(mesh.periodic.begin(), mesh.periodic.end(), axis) != mesh.periodic.end();
}

void check_patches(const Scene& scene, Findings& findings) {
  const MeshSettings& mesh = scene.fluid.mesh;
  for (const auto& [name, patch] : mesh.patches) {
    const std::string path = "fluid.mesh.patches." + name;
    if (name == walls) {
      findings.add(
          path, "this name is taken: `walls` are the faces that no patch names; use another name");
    }
    if (is_sound(findings, {"fluid.mesh.periodic"}) && findings.sound(path) &&
        is_periodic(mesh, patch.side)) {
      findings.add(
          path,
          fmt::format("{} is periodic and has no boundary faces; remove the patch or the axis from "
                      "fluid.mesh.periodic",
                      name_of(patch.side)));
    }
  }
}

/// Whether faces are left for the patch `walls`, as far as that can be said without the mesh.
enum class Left { none, some, depends_on_mesh };

Left faces_left(const MeshSettings& mesh) {
  Left left = Left::none;
  for (const auto& side : enum_names<Side>) {
    bool named = is_periodic(mesh, side.value);
    bool whole = named;
    for (const auto& [name, patch] : mesh.patches) {
      named = named || patch.side == side.value;
      whole = whole ||
              (patch.side == side.value && !patch.within.x && !patch.within.y && !patch.within.z);
    }
    if (!named) {
      return Left::some;
    }
    left = whole ? left : Left::depends_on_mesh;
  }
  return left;
}

void check_velocity(const std::string& path, const BoundarySettings& boundary, Findings& findings) {
  const bool superficial = boundary.superficial.has_value();
  const bool interstitial = boundary.interstitial.has_value();
  if (boundary.type == BoundaryType::velocity && findings.sound(path) &&
      superficial == interstitial) {
    findings.add(
        path, fmt::format("{} of `superficial` and `interstitial` is given; exactly one is needed",
                          superficial ? "each" : "none"));
  }
}

void check_boundaries(const Scene& scene, Findings& findings) {
  if (!is_sound(findings, {"fluid.mesh.patches", "fluid.mesh.periodic"})) {
    return;
  }
  const FluidSettings& fluid = scene.fluid;
  if (!fluid.mesh.is_box()) {  // the file names the patches: the rest follows when it is read
    for (const auto& [name, boundary] : fluid.boundaries) {
      check_velocity("fluid.boundaries." + name, boundary, findings);
    }
    return;
  }
  const Left left = faces_left(fluid.mesh);
  std::vector<std::string> patches = names_in(fluid.mesh.patches);
  for (const std::string& name : patches) {
    if (!fluid.boundaries.contains(name) && findings.sound("fluid.boundaries." + name)) {
      findings.add("fluid.boundaries." + name,
                   "missing; required: every patch of fluid.mesh needs a condition");
    }
  }
  if (left == Left::some && !fluid.boundaries.contains("walls") &&
      findings.sound("fluid.boundaries.walls")) {
    findings.add("fluid.boundaries.walls",
                 "missing; required: some sides have no patch, and their faces are the patch "
                 "`walls`; e.g. walls: {type: wall}");
  }
  if (left != Left::none) {
    patches.emplace_back(walls);
  }
  for (const auto& [name, boundary] : fluid.boundaries) {
    const std::string path = "fluid.boundaries." + name;
    check_velocity(path, boundary, findings);
    if (std::find(patches.begin(), patches.end(), name) == patches.end()) {
      findings.add(
          path,
          fmt::format(
              "{}{}; patches: {}",
              name == walls
                  ? "all faces belong to a named patch or are periodic, none is left for `walls`"
                  : "no such patch in fluid.mesh.patches",
              nearest_hint(name, patches), patches.empty() ? "none" : joined(patches)));
    }
  }
}

/// The pair in one order, so that [a, b] and [b, a] are equal.
std::pair<std::string, std::string> ordered(const std::array<std::string, 2>& between) {
  return std::minmax(between[0], between[1]);
}

void check_pair(const std::string& path, const PairSettings& pair,
                const std::vector<std::string>& materials, Findings& findings) {
  for (std::size_t i = 0; i < pair.between.size(); ++i) {
    const std::string& name = pair.between.at(i);
    if (name != walls && std::find(materials.begin(), materials.end(), name) == materials.end()) {
      findings.add(fmt::format("{}.between[{}]", path, i),
                   fmt::format("`{}` is none of particles.materials{}; allowed: {}, walls", name,
                               nearest_hint(name, materials), joined(materials)));
    }
  }
  if (pair.between[0] == walls && pair.between[1] == walls) {
    findings.add(path + ".between", "walls do not touch each other; name at least one material");
  }
}

/// True of walls and of materials that nothing which moves is made of: fixed particles, surfaces.
bool stands_still(const ParticleSettings& particles, const std::string& material) {
  const auto is_of = [&](const auto& entry) { return entry.material == material; };
  const auto& inserted = particles.insertion;
  const bool moves = std::any_of(particles.inflow.begin(), particles.inflow.end(), is_of) ||
                     std::any_of(inserted.begin(), inserted.end(), [&](const auto& entry) {
                       return is_of(entry) && entry.motion == Mobility::free;
                     });
  const bool used = std::any_of(inserted.begin(), inserted.end(), is_of) ||
                    std::any_of(particles.surfaces.begin(), particles.surfaces.end(),
                                [&](const auto& named) { return is_of(named.second); });
  return !moves && (used || material == walls);
}

void check_pairs(const Scene& scene, Findings& findings) {
  if (!is_sound(findings, {"particles.materials", "particles.contact", "particles.walls",
                           "particles.surfaces", "particles.backend"})) {
    return;
  }
  const ParticleSettings& particles = scene.particles;
  const std::vector<std::string> materials = names_in(particles.materials);
  std::set<std::pair<std::string, std::string>> given;
  for (std::size_t i = 0; i < particles.contact.pairs.size(); ++i) {
    const PairSettings& pair = particles.contact.pairs[i];
    const std::string path = fmt::format("particles.contact.pairs[{}]", i);
    check_pair(path, pair, materials, findings);
    if (!given.insert(ordered(pair.between)).second) {
      findings.add(path + ".between",
                   fmt::format("the pair {}, {} stands here a second time; keep one",
                               pair.between[0], pair.between[1]));
    }
  }
  std::vector<std::string> partners = materials;
  if (particles.walls == WallSource::from_mesh ||
      std::any_of(particles.surfaces.begin(), particles.surfaces.end(),
                  [](const auto& entry) { return entry.second.material == walls; })) {
    partners.emplace_back(walls);
  }
  if (!knows_contacts(particles.backend)) return;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    for (std::size_t j = i; j < partners.size(); ++j) {
      if (stands_still(particles, materials[i]) && stands_still(particles, partners[j])) continue;
      if (!given.contains(ordered({materials[i], partners[j]}))) {
        findings.add("particles.contact.pairs",
                     fmt::format("no entry with between: [{}, {}]; particles.backend: {} needs one "
                                 "for each pair that can touch",
                                 materials[i], partners[j], name_of(particles.backend)));
      }
    }
  }
}

void check_interphase(const Scene& scene, Findings& findings) {
  if (!is_sound(findings, {"interphase.voidage", "interphase.prescribed"})) {
    return;
  }
  const InterphaseSettings& interphase = scene.interphase;
  const bool prescribed = interphase.voidage.map == VoidageMap::prescribed;
  if (prescribed && !interphase.prescribed) {
    findings.add("interphase.prescribed",
                 "missing; required with `voidage: prescribed`, e.g. prescribed: {voidage: "
                 "\"x < 0.1 ? 0.42 : 1\", diameter: 2 mm}");
  }
  if (!prescribed && interphase.prescribed) {
    findings.add("interphase.prescribed",
                 "has no meaning here, only with `voidage: prescribed`; remove it");
  }
  const auto refuse_entries = [&](const char* path, bool empty) {
    if (!prescribed || empty || !findings.sound(path)) return;
    findings.add(
        path, "with `interphase.voidage: prescribed` there are no particles; remove the entries");
  };
  refuse_entries("particles.insertion", scene.particles.insertion.empty());
  refuse_entries("particles.inflow", scene.particles.inflow.empty());
  if (interphase.prescribed) {
    try {
      const Expression formula(interphase.prescribed->voidage);
    } catch (const ConfigError& error) {
      findings.add("interphase.prescribed.voidage", error.what());
    }
  }
}

/// What a force of the fluid on the particles needs of the rest of the scene.
void check_lubrication(const Scene& scene, Findings& findings) {
  const LubricationSettings& film = scene.interphase.lubrication;
  if (is_sound(findings, {"interphase.lubrication.roughness", "interphase.lubrication.reach"}) &&
      film.reach <= film.roughness) {
    findings.add("interphase.lubrication.reach",
                 fmt::format("{} m is not more than the roughness, {} m: the film would never act",
                             film.reach, film.roughness));
  }
}

void check_forces(const Scene& scene, Findings& findings) {
  const std::string path = "interphase.forces";
  if (!findings.sound(path)) return;
  const InterphaseSettings& interphase = scene.interphase;
  for (const InterphaseForce force : interphase.forces) {
    if (interphase.voidage.map == VoidageMap::prescribed &&
        force != InterphaseForce::pressure_gradient && findings.sound("interphase.voidage")) {
      findings.add(path, fmt::format("`{}` acts on particles, and with `voidage: prescribed` there "
                                     "are none; remove it",
                                     name_of(force)));
    }
  }
  if (has_force(scene, InterphaseForce::viscous) && interphase.model == PressureModel::b &&
      findings.sound("interphase.model")) {
    findings.add(path,
                 "`viscous` has no meaning with `model: b`, where the fluid alone bears pressure "
                 "and stress; remove it, or use `model: a`");
  }
  if (has_force(scene, InterphaseForce::lubrication)) check_lubrication(scene, findings);
  if (!has_force(scene, InterphaseForce::turbulent_dispersion)) return;
  if (scene.fluid.turbulence.model != TurbulenceModel::k_epsilon &&
      findings.sound("fluid.turbulence.model")) {
    findings.add(path,
                 fmt::format("`turbulent_dispersion` takes its eddies from k and epsilon, and "
                             "fluid.turbulence.model is `{}`; use `k_epsilon`, or remove it",
                             name_of(scene.fluid.turbulence.model)));
  }
  if (interphase.drag == DragLaw::none && findings.sound("interphase.drag")) {
    findings.add(path,
                 "`turbulent_dispersion` acts through the drag, and interphase.drag is `none`; "
                 "choose a law, or remove it");
  }
}

void check_numerics(const Scene& scene, Findings& findings) {
  if (is_sound(findings, {"fluid.numerics.time", "coupling.continuity"}) &&
      scene.fluid.numerics.time == TimeScheme::bdf2 &&
      scene.coupling.continuity == Continuity::legacy) {
    findings.add("fluid.numerics.time",
                 "`bdf2` has no meaning with coupling.continuity: legacy, whose mass source is of "
                 "first order; use `euler`");
  }
}

void check_launch(const Scene& scene, Findings& findings) {
  const LaunchSettings& launch = scene.launch;
  if (launch.mode == LaunchMode::external && launch.listen.empty() &&
      is_sound(findings, {"launch.mode"})) {
    findings.add("launch.listen",
                 "missing; with `mode: external` participants must know where to connect, "
                 "e.g. tcp://127.0.0.1:5555");
  }
  if (launch.listen.empty() || !is_sound(findings, {"launch.listen", "launch.security"})) {
    return;
  }
  switch (reach_of(launch.listen)) {
    case Reach::unknown:
      findings.add(
          "launch.listen",
          fmt::format("`{}` is no endpoint; allowed: tcp://HOST:PORT (1 .. 65535 or *), ipc://PATH",
                      shown(launch.listen)));
      break;
    case Reach::network:
      if (!launch.security) {
        findings.add("launch.listen", fmt::format("`{}` can be reached from other machines, and "
                                                  "anybody there could connect; use 127.0.0.1 or "
                                                  "ipc://, or write out `security: none`",
                                                  shown(launch.listen)));
      }
      break;
    case Reach::this_machine:
      break;
  }
}

}  // namespace

void check_scene(const Scene& scene, Findings& findings) {
  check_times(scene, findings);
  check_box(scene, findings);
  check_patches(scene, findings);
  check_boundaries(scene, findings);
  check_scalars(scene, findings);
  check_pairs(scene, findings);
  check_surfaces(scene, findings);
  check_contact_laws(scene, findings);
  check_insertion(scene, findings);
  check_backend(scene, findings);
  check_interphase(scene, findings);
  check_drag(scene, findings);
  check_forces(scene, findings);
  check_numerics(scene, findings);
  check_launch(scene, findings);
}

}  // namespace fluxpact
