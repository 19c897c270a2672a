// Boxes filled with cells of every kind, for tests that must hold on any mesh.
//
// All have the patches x_min, x_max, y_min, y_max, z_min, z_max, but for the periodic axes. They
// are made from one lattice of points, so that those of one size and seed have the same points.
#pragma once

#include <array>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

struct TestBox {
  std::array<int, 3> cells{4, 4, 4};  ///< of the lattice
  Vector3 lower{0, 0, 0};             ///< [m]
  Vector3 upper{1, 1, 1};             ///< [m]
  std::array<bool, 3> periodic{};
  double share = 0;   ///< points inside move by up to this share of the spacing, see perturbed_box
  unsigned seed = 1;  ///< of these moves
};

/// One cell for each of the lattice.
Mesh hexahedra(const TestBox& box);

/// Six for each cell of the lattice, along its diagonal (Kuhn 1960).
Mesh tetrahedra(const TestBox& box);

/// Two for each cell of the lattice, with their triangles on z_min and z_max.
Mesh prisms(const TestBox& box);

/// One for each point of the lattice: the duals of the tetrahedra, inside with 14 faces of 4 or 6
/// points. Corners are the centres of tetrahedra; the cells at the boundary are cut by it.
Mesh polyhedra(const TestBox& box);

/// Every kind of cell that a Gmsh file may hold: hexahedra below, in the middle layer pyramids and
/// tetrahedra about the centres of the lattice's cells, prisms above. Needs 3 layers in z.
Mesh mixed_cells(const TestBox& box);

}  // namespace fluxpact
