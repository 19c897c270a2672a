// How far a mesh is from what the numerics like best. Told to the user, decides nothing.
#pragma once

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// The largest value and where it stands.
struct Worst {
  double value = 0;
  int index = -1;  ///< of the face or cell
  Vector3 place = Vector3::Zero();
};

/// Faces: internal ones only, periodic pairs included.
struct MeshQuality {
  Worst non_orthogonality;            ///< [degrees] angle of the line between centres and the face
  double mean_non_orthogonality = 0;  ///< [degrees] over faces
  int steep_faces = 0;                ///< beyond `steep_angle`
  Worst skewness;         ///< [-] distance of the face's centre from that line over its length
  int outside_faces = 0;  ///< not between the centres of their cells, as seen along the area vector
  Worst volume_ratio;     ///< [-] larger over smaller of two neighbours, ≥ 1
  Worst aspect_ratio;     ///< [-] longest over shortest extent of a cell, ≥ 1
  double smallest_cell = 0;  ///< [m] cube root of the volume
  double largest_cell = 0;   ///< [m]
};

/// Beyond this angle [degrees] the correction of the two-point gradient outweighs what it corrects:
/// users are warned.
inline constexpr double steep_angle = 70;

/// The extents of a cell are measured by M = Σ A Aᵀ/|A| over its faces: the root-free ratio of its
/// largest to its smallest eigenvalue is longest over shortest edge for a box in any position, and
/// 1 for regular polyhedra.
MeshQuality measure_quality(const Mesh& mesh);

}  // namespace fluxpact
