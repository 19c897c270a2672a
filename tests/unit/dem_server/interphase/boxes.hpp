// Meshes for the tests between the phases.
#pragma once

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "proto/mesh/box.hpp"

namespace fluxpact::testing_boxes {

inline Mesh box(const Vector3& upper, std::array<int, 3> cells, std::vector<Axis> periodic = {}) {
  MeshSettings settings;
  settings.box = {{0, 0, 0}, upper, cells};
  settings.periodic = std::move(periodic);
  return make_box(settings);
}

/// The same mesh for code that does not know that it is a lattice.
inline Mesh without_lattice(Mesh mesh) {
  mesh.lattice.reset();
  return mesh;
}

/// Points moved by a map: sheared, rotated, warped.
template <class Move>
Mesh moved(const Mesh& mesh, const Move& move) {
  MeshTopology topology = static_cast<const MeshTopology&>(mesh);
  for (Vector3& point : topology.points) point = move(point);
  return without_lattice(with_geometry(std::move(topology)));
}

/// Oblique but plane faces: a linear map of unit determinant.
inline Mesh sheared(const Mesh& mesh) {
  return moved(mesh, [](const Vector3& x) -> Vector3 {
    return {x.x() + 0.3 * x.z(), x.y() - 0.2 * x.x() - 0.06 * x.z(), x.z()};
  });
}

/// Inner points of a unit box shaken by up to a tenth of its cells' edge: faces that are not plane.
inline Mesh warped(const Mesh& mesh, double edge) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> shake(-0.1 * edge, 0.1 * edge);
  return moved(mesh, [&](const Vector3& x) -> Vector3 {
    const bool inner = x.minCoeff() > 1e-9 && x.maxCoeff() < 1 - 1e-9;
    const Vector3 by(shake(random), shake(random), shake(random));
    return inner ? Vector3(x + by) : x;
  });
}

}  // namespace fluxpact::testing_boxes
