// Spheres near a region, sorted into cells: is there room for one more?
#pragma once

#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

class NearSpheres {
 public:
  /// Forget all; from here on answer for spheres with a radius of at most `largest` [m] and centres
  /// in [lower, upper] [m] among spheres of at most `largest`.
  void start(const Vector3& lower, const Vector3& upper, double largest);

  /// One that is too far from the region to matter is left out.
  void add(const Vector3& centre, double radius);

  /// Whether a sphere touches none. Its centre must be in the region.
  bool is_free(const Vector3& centre, double radius) const;

 private:
  struct Sphere {
    Vector3 centre;
    double radius = 0;
    int next = -1;  // in the same cell
  };
  int cell_at(const Vector3& point, int axis) const;

  Vector3 lower_;  // with the margin in which others matter
  Vector3 upper_;
  Vector3 width_;  // of a cell
  std::array<int, 3> cells_{1, 1, 1};
  std::vector<int> first_;  // of each cell, -1: none
  std::vector<Sphere> spheres_;
};

}  // namespace fluxpact
