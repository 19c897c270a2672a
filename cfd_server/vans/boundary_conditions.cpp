#include "cfd_server/vans/boundary_conditions.hpp"

#include <fmt/ranges.h>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

std::vector<std::string> patch_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const Patch& patch : mesh.patches) names.push_back(patch.name);
  return names;
}

/// The entry of a patch; `walls` need not have one.
BoundarySettings settings_of(const Scene& scene, const Patch& patch) {
  const auto entry = scene.fluid.boundaries.find(patch.name);
  if (entry != scene.fluid.boundaries.end()) return entry->second;
  if (patch.name == "walls") return {};
  throw ConfigError(
      "fluid.boundaries: the patch '{}' has no condition; add '{}: {{type: velocity | mass_flow | "
      "pressure | wall, "
      "...}}'",
      patch.name, patch.name);
}

double patch_area(const Mesh& mesh, const Patch& patch) {
  double area = 0;
  for (int f = patch.first; f < patch.first + patch.size; ++f) area += mesh.face_areas[f].norm();
  return area;
}

void check_entry(const std::string& name, const BoundarySettings& entry) {
  if (entry.type == BoundaryType::velocity &&
      entry.superficial.has_value() == entry.interstitial.has_value()) {
    throw ConfigError(
        "fluid.boundaries.{}: type velocity needs either 'superficial' or 'interstitial', {} given",
        name, entry.superficial ? "both are" : "neither is");
  }
  if (entry.type == BoundaryType::mass_flow && !entry.rate) {
    throw ConfigError(
        "fluid.boundaries.{}: type mass_flow needs 'rate' [kg/s], positive into the domain", name);
  }
}

}  // namespace

BoundaryConditions read_boundaries(const Scene& scene, const Mesh& mesh) {
  for (const auto& [name, entry] : scene.fluid.boundaries) {
    if (mesh.find_patch(name) == nullptr && name != "walls") {
      throw ConfigError("fluid.boundaries.{}: the mesh has no such patch; it has {}", name,
                        fmt::join(patch_names(mesh), ", "));
    }
    check_entry(name, entry);
  }
  const auto faces = static_cast<std::size_t>(mesh.faces() - mesh.internal_faces());
  BoundaryConditions conditions;
  conditions.kind.assign(faces, FaceKind::fixed_flux);
  conditions.given.assign(faces, Vector3::Zero());
  conditions.is_interstitial.assign(faces, 0);
  conditions.pressure.assign(faces, 0.0);
  double area_of_pressure = 0;
  for (const Patch& patch : mesh.patches) {
    const BoundarySettings entry = settings_of(scene, patch);
    const double area = patch_area(mesh, patch);
    for (int f = patch.first; f < patch.first + patch.size; ++f) {
      const int b = f - mesh.internal_faces();
      const double size = mesh.face_areas[f].norm();
      switch (entry.type) {
        case BoundaryType::velocity:
          conditions.given[b] = entry.superficial ? *entry.superficial : *entry.interstitial;
          conditions.is_interstitial[b] = entry.interstitial ? 1 : 0;
          break;
        case BoundaryType::mass_flow:
          conditions.given[b] =
              -(*entry.rate / (scene.fluid.density * area)) * mesh.face_areas[f] / size;
          break;
        case BoundaryType::pressure:
          conditions.kind[b] = FaceKind::pressure;
          conditions.pressure[b] =
              entry.value - scene.fluid.density * scene.scene.gravity.dot(mesh.face_centres[f]);
          conditions.level += size * conditions.pressure[b];
          area_of_pressure += size;
          break;
        case BoundaryType::wall:
          if (entry.slip == Slip::free) conditions.kind[b] = FaceKind::free_slip;
          break;
      }
    }
  }
  if (area_of_pressure > 0) conditions.level /= area_of_pressure;
  for (std::size_t b = 0; b < faces; ++b) {
    if (conditions.kind[b] == FaceKind::pressure) conditions.pressure[b] -= conditions.level;
  }
  return conditions;
}

void update_boundary_values(const Stencil& s, const BoundaryConditions& conditions,
                            std::span<const double> voidage, BoundaryValues& values) {
  const auto faces = static_cast<std::size_t>(s.boundary_faces());
  values.flux.resize(faces);
  values.superficial.resize(faces);
  values.velocity.resize(faces);
  for (std::size_t b = 0; b < faces; ++b) {
    const std::size_t f = b + static_cast<std::size_t>(s.internal_faces);
    const double own_voidage = voidage[s.owner[f]];
    const Vector3& given = conditions.given[b];
    values.superficial[b] =
        conditions.is_interstitial[b] != 0 ? Vector3(own_voidage * given) : given;
    values.velocity[b] = conditions.is_interstitial[b] != 0 ? given : Vector3(given / own_voidage);
    values.flux[b] =
        conditions.kind[b] == FaceKind::fixed_flux ? values.superficial[b].dot(s.area[f]) : 0.0;
  }
}

void boundary_jump(const Stencil& s, const BoundaryConditions& conditions,
                   std::span<const Vector3> prescribed, std::span<const Vector3> field,
                   std::span<Vector3> jump) {
  for (std::size_t b = 0; b < conditions.kind.size(); ++b) {
    const std::size_t f = b + static_cast<std::size_t>(s.internal_faces);
    const Vector3& own = field[s.owner[f]];
    switch (conditions.kind[b]) {
      case FaceKind::fixed_flux:
        jump[b] = prescribed[b] - own;
        break;
      case FaceKind::free_slip: {
        const Vector3 normal = s.area[f] / s.area_size[f];
        jump[b] = -own.dot(normal) * normal;
        break;
      }
      case FaceKind::pressure:
        jump[b] = Vector3::Zero();
        break;
    }
  }
}

std::vector<std::uint8_t> faces_with_value(const BoundaryConditions& conditions, bool of_pressure) {
  std::vector<std::uint8_t> flags;
  for (const FaceKind kind : conditions.kind)
    flags.push_back((kind == FaceKind::pressure) == of_pressure ? 1 : 0);
  return flags;
}

}  // namespace fluxpact
