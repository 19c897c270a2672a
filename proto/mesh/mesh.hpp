// The face-based polyhedral mesh that all processes share.
//
// Faces are numbered with the internal ones first, then the boundary faces patch by patch. The area
// vector of a face points out of its owner; a flux is positive along it. One number per face,
// shared by its two cells, is what makes every sum over cells telescope: so a periodic pair of
// faces is ONE internal face, too, whose neighbour lies a translation away. Code that only uses
// `face_offset_owner` and `delta` never sees the difference.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// A named range of boundary faces [first, first + size).
struct Patch {
  std::string name;
  int first = 0;
  int size = 0;
};

/// A Cartesian product of cell intervals: cell index = i + nx (j + ny k). Known for box meshes
/// only; lets solvers choose structured methods, never needed for correctness.
struct Lattice {
  std::array<std::vector<double>, 3> nodes;  ///< [m] ascending, cells + 1 entries for each axis
  std::array<bool, 3> periodic{};
};

/// What goes on the wire: enough to rebuild everything else.
struct MeshTopology {
  std::vector<Vector3> points;        ///< [m]
  std::vector<int> face_offsets;      ///< CSR: faces + 1 entries into face_points
  std::vector<int> face_points;       ///< points of each face, right-handed about its area vector
  std::vector<int> owner;             ///< one for each face
  std::vector<int> neighbour;         ///< one for each internal face
  std::vector<int> periodic_faces;    ///< internal faces that join cells across a periodic boundary
  std::vector<Vector3> translations;  ///< [m] for each of these: from the neighbour's true place to
                                      ///< its image at the face
  std::vector<Patch> patches;         ///< cover all boundary faces in order
};

struct Mesh : MeshTopology {
  // Geometry, derived by `with_geometry`.
  std::vector<Vector3> face_areas;    ///< [m²] out of the owner
  std::vector<Vector3> face_centres;  ///< [m]
  std::vector<Vector3> cell_centres;  ///< [m]
  std::vector<double> cell_volumes;   ///< [m³]
  std::vector<Vector3>
      delta;  ///< [m] for each internal face: owner's centre to the neighbour's (image's) centre
  std::vector<int> cell_face_offsets;  ///< CSR: cells + 1 entries into cell_faces
  std::vector<int> cell_faces;         ///< faces of each cell, ascending
  std::optional<Lattice> lattice;

  int cells() const { return static_cast<int>(cell_volumes.size()); }
  int faces() const { return static_cast<int>(owner.size()); }
  int internal_faces() const { return static_cast<int>(neighbour.size()); }
  const Patch* find_patch(const std::string& name) const;
};

/// Volumes, areas and centres of the cells and faces of a topology. Polyhedra: faces split into
/// triangles about the mean of their points. Throws ConfigError that names the cell or face if a
/// volume is not positive, a cell is not closed, or a point is not used.
Mesh with_geometry(MeshTopology topology);

/// The lattice behind a mesh if it is an axis-aligned box grid in natural order, else nothing.
std::optional<Lattice> find_lattice(const Mesh& mesh);

/// Hash of the topology and points: equal on both sides of the wire, or the session is refused.
std::uint64_t fingerprint(const MeshTopology& mesh);

}  // namespace fluxpact
