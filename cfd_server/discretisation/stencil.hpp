// Geometry of the mesh in the form in which the scheme meets it, computed once a run.
//
// First thing that a fluid solver builds; everything in discretisation/ and vans/ reads it, nothing
// writes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cfd_server/discretisation/axis_vectors.hpp"
#include "cfd_server/discretisation/cell_shares.hpp"
#include "proto/base/vector.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// Owner P, neighbour N (internal faces only), area vector A out of P, d = x_N − x_P (boundary: x_f
/// − x_P).
struct Stencil {
  int cells = 0;
  int faces = 0;
  int internal_faces = 0;
  std::vector<int> owner;
  std::vector<int> neighbour;   ///< internal faces
  std::vector<double> volume;   ///< [m³]
  std::vector<Vector3> centre;  ///< [m] of cells
  AxisVectors area;             ///< [m²]
  std::vector<double> weight;  ///< w = |(x_f − x_P)·A|/(|(x_f − x_P)·A| + |(x_f − x_N)·A|): share
                               ///< of the path that lies in P; 1 at the boundary
  std::vector<double> conductance;  ///< g = |A|²/max(A·d, |A||d|/20) [m]
  std::vector<Vector3>
      cross;  ///< k = A − g d [m²], perpendicular to A; empty if the mesh is orthogonal
  AxisVectors from_owner;      ///< x_f − x_P [m]
  AxisVectors from_neighbour;  ///< x_f − x_N [m], at N's side of a periodic pair; internal faces

  // The sides of each cell. A cell that is its own periodic neighbour has both sides of that face.
  std::vector<int> side_offsets;  ///< CSR: cells + 1 entries
  std::vector<int> side_face;
  std::vector<int> side_other;  ///< the cell across, −1 at the boundary
  std::vector<std::int8_t>
      side_sign;  ///< +1 where the cell owns the face, −1 where it is the neighbour

  int threads = 1;                ///< that share each loop over cells or faces
  std::vector<CellShare> shares;  ///< one a thread

  /// One a cell: 1 where the cell has too few faces for its velocity to be rebuilt from their
  /// fluxes (tetrahedra, prisms, pyramids: fewer than two for each component). Empty if there is
  /// none.
  std::vector<std::uint8_t> few_faces;

  bool orthogonal = false;  ///< every k vanishes
  bool centred =
      false;  ///< opposite faces lie at equal distances from the cell's centre (lattices)
  bool uniform = false;  ///< a lattice with equal cells

  int boundary_faces() const { return faces - internal_faces; }
  /// |A| [m²] of a face.
  double area_size(std::size_t face) const { return area[face].norm(); }
  /// d [m] of a face.
  Vector3 delta(int face) const {
    return face < internal_faces ? Vector3(from_owner[face] - from_neighbour[face])
                                 : from_owner[face];
  }
};

/// Throws ConfigError naming the face if d·A is not positive inside the mesh.
Stencil make_stencil(const Mesh& mesh, int threads = 1);

/// Threads that pay on a mesh of this size: those wanted (0: all cores), but not less than some
/// thousands of cells each.
int threads_for(int wanted, int cells);

}  // namespace fluxpact
