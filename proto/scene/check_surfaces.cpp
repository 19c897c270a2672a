// What must fit together in particles.surfaces.
#include <algorithm>

#include "proto/scene/check.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

void check_direction(const std::string& path, const Vector3& direction, Findings& findings) {
  if (findings.sound(path) && direction == Vector3::Zero()) {
    findings.add(path, "has the length 0, so it has no direction; e.g. [0, 0, 1]");
  }
}

void check_shape(const std::string& path, const SurfaceSettings& surface, Findings& findings) {
  if (surface.type == SurfaceType::plane) {
    check_direction(path + ".normal", surface.normal, findings);
  } else if (surface.type != SurfaceType::stl) {
    check_direction(path + ".direction", surface.direction, findings);
  }
  if (surface.type == SurfaceType::cone && findings.sound(path + ".radius") &&
      findings.sound(path + ".end_radius") && surface.radius == 0 && surface.end_radius == 0) {
    findings.add(path + ".radius",
                 "is 0 at both ends, so the cone has no surface; make one of them positive");
  }
}

void check_motion(const std::string& path, const MotionSettings& motion, Findings& findings) {
  if (!findings.sound(path)) return;
  if (motion.type == MotionType::rotation) {
    check_direction(path + ".direction", motion.direction, findings);
  }
}

void check_material(const std::string& path, const std::string& name,
                    const ParticleSettings& particles, Findings& findings) {
  if (!findings.sound(path) || !findings.sound("particles.materials")) return;
  if (name == "walls" || particles.materials.contains(name)) return;
  std::vector<std::string> materials;
  for (const auto& [known, material] : particles.materials) materials.push_back(known);
  findings.add(path, fmt::format("`{}` is none of particles.materials{}; allowed: {}walls", name,
                                 nearest_hint(name, materials),
                                 materials.empty() ? "" : joined(materials) + ", "));
}

}  // namespace

void check_surfaces(const Scene& scene, Findings& findings) {
  const ParticleSettings& particles = scene.particles;
  if (particles.surfaces.empty() || !findings.sound("interphase.voidage")) return;
  if (scene.interphase.voidage.map == VoidageMap::prescribed) {
    findings.add("particles.surfaces",
                 "with `interphase.voidage: prescribed` there are no particles; remove them");
  }
  for (const auto& [name, surface] : particles.surfaces) {
    const std::string path = "particles.surfaces." + name;
    if (!findings.sound(path + ".type")) continue;
    check_shape(path, surface, findings);
    check_motion(path + ".motion", surface.motion, findings);
    check_material(path + ".material", surface.material, particles, findings);
  }
}

}  // namespace fluxpact
