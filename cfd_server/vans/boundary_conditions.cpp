#include "cfd_server/vans/boundary_conditions.hpp"

#include <fmt/ranges.h>

#include <cmath>

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

/// Length of the path from the cell's centre to the wall, along its normal [m].
double depth(const Stencil& s, int face) { return s.area_size(face) / s.conductance[face]; }

PatchCondition make_condition(const BoundarySettings& entry, const Mesh& mesh, const Patch& patch) {
  const VectorFormula velocity = entry.superficial    ? *entry.superficial
                                 : entry.interstitial ? *entry.interstitial
                                                      : entry.velocity;
  const bool mass_flow = entry.type == BoundaryType::mass_flow;
  PatchCondition condition{.name = patch.name,
                           .first = patch.first - mesh.internal_faces(),
                           .size = patch.size,
                           .type = entry.type,
                           .is_interstitial = entry.interstitial.has_value(),
                           .velocity = VectorValue(velocity),
                           .scalar = FormulaValue(mass_flow ? *entry.rate : entry.value),
                           .factor = ProfileFactor(entry)};
  condition.varies = condition.velocity.is_formula() || condition.scalar.is_formula() ||
                     condition.factor.varies_in_time();
  double area = 0;
  for (int f = patch.first; f < patch.first + patch.size; ++f) {
    const double size = mesh.face_areas[f].norm();
    area += size;
    condition.centre += size * mesh.face_centres[f];
    condition.area += size * (mass_flow ? condition.factor.shape(mesh.face_centres[f]) : 1.0);
  }
  if (area > 0) condition.centre /= area;
  if (mass_flow && !(condition.area > 0)) {
    throw ConfigError(
        "fluid.boundaries.{}.profile: the tables give the patch no positive mean, so the mass flow "
        "cannot be spread over it",
        patch.name);
  }
  return condition;
}

void add_kinds(const BoundarySettings& entry, const Stencil& s, const PatchCondition& patch,
               BoundaryConditions& conditions) {
  for (int b = patch.first; b < patch.first + patch.size; ++b) {
    if (entry.type == BoundaryType::pressure) conditions.kind[b] = FaceKind::pressure;
    if (entry.type != BoundaryType::wall || entry.slip == Slip::none) continue;
    conditions.kind[b] = FaceKind::slip;
    const double distance = depth(s, b + s.internal_faces);
    conditions.grip[b] = entry.slip == Slip::free ? 0.0 : distance / (distance + entry.slip_length);
  }
}

[[noreturn]] void refuse(const PatchCondition& patch, const Vector3& x, double time) {
  throw NumericsError(
      "fluid: the formula of fluid.boundaries.{} has no finite value at ({:.6g}, {:.6g}, {:.6g}) "
      "m, t = {} s; it must be finite at every face of the patch, at all times",
      patch.name, x.x(), x.y(), x.z(), time);
}

/// p_b − ρ g·x_f [Pa].
double boundary_pressure(const BoundaryConditions& conditions, const PatchCondition& patch, int b,
                         double time) {
  const Vector3& x = conditions.centre[b];
  const double given = patch.scalar(x, time) * patch.factor.shape(x) * patch.factor.pace(time);
  if (!std::isfinite(given)) refuse(patch, x, time);
  return given - conditions.density * conditions.gravity.dot(x);
}

void evaluate(const Stencil& s, const BoundaryConditions& conditions, const PatchCondition& patch,
              double time, std::vector<Vector3>& given, std::vector<double>& pressure) {
  const double pace = patch.factor.pace(time);
  for (int b = patch.first; b < patch.first + patch.size; ++b) {
    const Vector3& x = conditions.centre[b];
    const Vector3 normal = s.area[b + s.internal_faces] / s.area_size(b + s.internal_faces);
    switch (patch.type) {
      case BoundaryType::velocity:
        given[b] = pace * patch.factor.shape(x) * patch.velocity(x, time);
        break;
      case BoundaryType::mass_flow:
        given[b] = -(pace * patch.scalar(patch.centre, time) * patch.factor.shape(x) /
                     (conditions.density * patch.area)) *
                   normal;
        break;
      case BoundaryType::pressure:
        pressure[b] = boundary_pressure(conditions, patch, b, time) - conditions.level;
        break;
      case BoundaryType::wall: {
        const Vector3 velocity = pace * patch.velocity(x, time);
        given[b] = velocity - velocity.dot(normal) * normal;
        break;
      }
    }
    if (!given[b].allFinite()) refuse(patch, x, time);
  }
}

}  // namespace

BoundaryConditions read_boundaries(const Scene& scene, const Mesh& mesh, const Stencil& s) {
  for (const auto& [name, entry] : scene.fluid.boundaries) {
    if (mesh.find_patch(name) == nullptr && name != "walls") {
      throw ConfigError("fluid.boundaries.{}: the mesh has no such patch; it has {}", name,
                        fmt::join(patch_names(mesh), ", "));
    }
    check_entry(name, entry);
  }
  const auto faces = static_cast<std::size_t>(s.boundary_faces());
  BoundaryConditions conditions;
  conditions.kind.assign(faces, FaceKind::fixed_flux);
  conditions.grip.assign(faces, 1.0);
  conditions.centre.assign(mesh.face_centres.begin() + mesh.internal_faces(),
                           mesh.face_centres.end());
  conditions.density = scene.fluid.density;
  conditions.gravity = scene.scene.gravity;
  double weight = 0;
  for (const Patch& patch : mesh.patches) {
    const BoundarySettings entry = settings_of(scene, patch);
    const PatchCondition& condition =
        conditions.patches.emplace_back(make_condition(entry, mesh, patch));
    add_kinds(entry, s, condition, conditions);
    if (condition.type != BoundaryType::pressure) continue;
    for (int b = condition.first; b < condition.first + condition.size; ++b) {
      const double size = s.area_size(b + s.internal_faces);
      conditions.level += size * boundary_pressure(conditions, condition, b, 0);
      weight += size;
    }
  }
  if (weight > 0) conditions.level /= weight;
  return conditions;
}

void update_boundary_values(const Stencil& s, const BoundaryConditions& conditions,
                            std::span<const double> voidage, double time, BoundaryValues& values) {
  const auto faces = static_cast<std::size_t>(s.boundary_faces());
  const bool first = values.given.size() != faces;
  for (auto* field : {&values.given, &values.superficial, &values.velocity})
    field->resize(faces, Vector3::Zero());
  values.flux.resize(faces);
  values.pressure.resize(faces);
  for (const PatchCondition& patch : conditions.patches) {
    if (first || patch.varies) evaluate(s, conditions, patch, time, values.given, values.pressure);
    for (int b = patch.first; b < patch.first + patch.size; ++b) {
      const double own_voidage = voidage[s.owner[b + s.internal_faces]];
      const Vector3& given = values.given[b];
      const bool interstitial = patch.is_interstitial || patch.type == BoundaryType::wall;
      values.superficial[b] = interstitial ? Vector3(own_voidage * given) : given;
      values.velocity[b] = interstitial ? given : Vector3(given / own_voidage);
      const bool through =
          patch.type == BoundaryType::velocity || patch.type == BoundaryType::mass_flow;
      values.flux[b] = through ? values.superficial[b].dot(s.area[b + s.internal_faces]) : 0.0;
    }
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
      case FaceKind::slip: {
        const Vector3 normal = s.area[f] / s.area_size(f);
        const Vector3 difference = prescribed[b] - own;
        const double across = difference.dot(normal);
        jump[b] = across * normal + conditions.grip[b] * (difference - across * normal);
        break;
      }
      case FaceKind::pressure:
        jump[b] = Vector3::Zero();
        break;
    }
  }
}

std::vector<std::uint8_t> faces_with_velocity(const BoundaryConditions& conditions) {
  std::vector<std::uint8_t> flags;
  for (const FaceKind kind : conditions.kind) flags.push_back(kind == FaceKind::pressure ? 0 : 1);
  return flags;
}

}  // namespace fluxpact
