// Spheres, settings and meshes for the tests of the maps.
#pragma once

#include <string>

#include "boxes.hpp"
#include "mapped.hpp"
#include "tests/unit/cfd_server/test_meshes.hpp"

namespace fluxpact {

inline void add_ball(ParticleState& particles, const Vector3& position, double radius) {
  particles.id.push_back(particles.size() + 1);
  particles.position.push_back(position);
  particles.velocity.emplace_back(position.y(), 1.0, -position.x());
  particles.spin.emplace_back(Vector3::Zero());
  particles.radius.push_back(radius);
  particles.density.push_back(2500);
  particles.material.push_back(0);
}

inline VoidageSettings settings_of(VoidageMap map, double width = 0) {
  VoidageSettings settings(map);
  settings.width = width;
  return settings;
}

inline constexpr double edge = 0.125;  // of a cell

inline Mesh mesh_named(const std::string& name) {
  TestBox unit{.cells = {8, 8, 8}};
  if (name == "box") return testing_boxes::box({1, 1, 1}, {8, 8, 8});
  if (name == "periodic") return testing_boxes::box({1, 1, 1}, {8, 8, 8}, {Axis::x, Axis::z});
  if (name == "graded") {
    MeshSettings settings;
    settings.box = {{0, 0, 0}, {1, 1, 1}, {8, 8, 8}};
    settings.box.grading.x = {{1, 1, 4}};
    settings.box.grading.z = {{0.5, 0.7, 1}, {0.5, 0.3, 0.25}};
    return make_box(settings);
  }
  if (name == "hexahedra") {
    unit.periodic = {true, false, false};
    unit.share = 0.15;
    return hexahedra(unit);
  }
  return name == "tetrahedra" ? tetrahedra(unit) : polyhedra(unit);
}

}  // namespace fluxpact
