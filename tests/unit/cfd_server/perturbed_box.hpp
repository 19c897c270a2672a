// A box whose interior points are moved at random: non-orthogonal, skewed hexahedra with non-planar
// faces.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <random>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// Points inside the box move by up to `share` of the spacing of its cells; those at its ends stay,
/// so a periodic pair still fits.
inline Mesh perturbed(const Mesh& box, const Vector3& spacing, double share, unsigned seed) {
  MeshTopology topology = static_cast<const MeshTopology&>(box);
  Vector3 lower = topology.points.front();
  Vector3 upper = lower;
  for (const Vector3& point : topology.points) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-share, share);
  // In a direction with one layer of cells nothing moves, and both ends of the layer move alike:
  // one move a place.
  std::map<std::array<long, 3>, Vector3> moves;
  for (Vector3& point : topology.points) {
    std::array<long, 3> place{};
    Vector3 move(shift(random), shift(random), shift(random));
    for (int axis = 0; axis < 3; ++axis) {
      const double from_start = (point[axis] - lower[axis]) / spacing[axis];
      const double to_end = (upper[axis] - point[axis]) / spacing[axis];
      const bool layered = from_start + to_end > 1.5;
      if (layered && (from_start < 0.5 || to_end < 0.5)) move.setZero();
      place[static_cast<std::size_t>(axis)] = layered ? std::lround(from_start) : 0;
      move[axis] *= layered ? spacing[axis] : 0.0;
    }
    point += moves.try_emplace(place, move).first->second;
  }
  return with_geometry(std::move(topology));
}

}  // namespace fluxpact
