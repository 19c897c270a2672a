#include "dem_server/backends/domain.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

bool is_pressure(const Scene& scene, const std::string& patch) {
  const auto boundary = scene.fluid.boundaries.find(patch);
  return boundary != scene.fluid.boundaries.end() &&
         boundary->second.type == BoundaryType::pressure;
}

/// Whether particles may leave through a patch where nothing holds them.
bool is_outflow(const Scene& scene, const std::string& patch) {
  const auto& outflow = scene.particles.outflow;
  return !outflow || std::find(outflow->begin(), outflow->end(), patch) != outflow->end();
}

}  // namespace

int side_of_face(const Domain& domain, const Mesh& mesh, int face) {
  int axis = 0;
  const Vector3& area = mesh.face_areas[face];
  area.cwiseAbs().maxCoeff(&axis);
  const int side = 2 * axis + (area[axis] > 0 ? 1 : 0);
  // Round-off of a face centre is some 1e-16 of the coordinates; a cell is far thicker than 1e-9 of
  // the box.
  const double tolerance = 1e-9 * (domain.upper - domain.lower).norm();
  if (std::abs(mesh.face_centres[face][axis] - domain.plane(side)) > tolerance ||
      area.norm() - std::abs(area[axis]) > 1e-9 * area.norm()) {
    return -1;
  }
  return side;
}

std::vector<int> faces_off_the_box(const Scene& scene, const Mesh& mesh, const Domain& domain) {
  std::vector<int> faces;
  for (const Patch& patch : mesh.patches) {
    if (is_pressure(scene, patch.name)) continue;
    for (int face = patch.first; face < patch.first + patch.size; ++face) {
      if (side_of_face(domain, mesh, face) < 0) faces.push_back(face);
    }
  }
  return faces;
}

void check_box_mesh(const Scene& scene, const Mesh& mesh) {
  if (!has_particles(scene)) return;
  const std::vector<int> faces = faces_off_the_box(scene, mesh, particle_domain(scene, mesh));
  if (faces.empty()) return;
  const Vector3& at = mesh.face_centres[faces.front()];
  throw ConfigError(
      "particles.backend: {} knows the sides of a box only, and a face at ({:.6g}, {:.6g}, {:.6g}) "
      "m "
      "is off the outer box of the mesh; use a box mesh, or the native backend",
      name_of(scene.particles.backend), at.x(), at.y(), at.z());
}

const char* side_name(int side) {
  constexpr std::array<const char*, 6> names{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  return names.at(side);
}

Domain particle_domain(const Scene& scene, const Mesh& mesh) {
  Domain domain{mesh.points.front(), mesh.points.front(), {}};
  for (const Vector3& point : mesh.points) {
    domain.lower = domain.lower.cwiseMin(point);
    domain.upper = domain.upper.cwiseMax(point);
  }
  std::array<bool, 6> only_pressure{};
  only_pressure.fill(true);
  std::array<bool, 6> only_outflow = only_pressure;
  std::array<bool, 6> any_face{};
  for (const Patch& patch : mesh.patches) {
    for (int face = patch.first; face < patch.first + patch.size; ++face) {
      const int side = side_of_face(domain, mesh, face);
      if (side < 0) continue;  // for Walls
      any_face[side] = true;
      only_pressure[side] = only_pressure[side] && is_pressure(scene, patch.name);
      only_outflow[side] = only_outflow[side] && is_outflow(scene, patch.name);
    }
  }
  for (int side = 0; side < 6; ++side) {
    const bool open = only_pressure[side] || scene.particles.walls == WallSource::none;
    domain.sides[side] = open ? SideKind::open : SideKind::wall;
    // Behind a side without faces stands a wall of the mesh: who gets there is lost, not gone.
    const bool free = any_face[side] || scene.particles.walls == WallSource::none;
    domain.lets_out[side] = open && only_outflow[side] && free;
  }
  for (const Vector3& translation : mesh.translations) {
    int axis = 0;
    translation.cwiseAbs().maxCoeff(&axis);
    const int low = Domain::low_side(axis);
    domain.sides[low] = domain.sides[low + 1] = SideKind::periodic;
    domain.lets_out[low] = domain.lets_out[low + 1] = false;
  }
  return domain;
}

Vector3 wrapped(const Domain& domain, Vector3 position) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!domain.periodic(axis)) continue;
    const double length = domain.length(axis);
    position[axis] -= length * std::floor((position[axis] - domain.lower[axis]) / length);
    // A position a rounding error below `lower` lands on `upper`, which is the same place.
    if (position[axis] >= domain.upper[axis]) position[axis] = domain.lower[axis];
  }
  return position;
}

int left_through(const Domain& domain, const Vector3& position) {
  for (int side = 0; side < 6; ++side) {
    if (!domain.lets_out[side]) continue;
    const double outward = side % 2 == 0 ? -1.0 : 1.0;
    if (outward * (position[side / 2] - domain.plane(side)) > 0) return side;
  }
  return -1;
}

int lost_through(const Domain& domain, const Vector3& position, double radius) {
  if (left_through(domain, position) >= 0) return -1;
  for (int side = 0; side < 6; ++side) {
    if (domain.sides[side] == SideKind::periodic) continue;
    const double outward = side % 2 == 0 ? -1.0 : 1.0;
    const double beyond = outward * (position[side / 2] - domain.plane(side));
    if (beyond > (domain.sides[side] == SideKind::wall ? radius : 0.0)) return side;
  }
  return -1;
}

}  // namespace fluxpact
