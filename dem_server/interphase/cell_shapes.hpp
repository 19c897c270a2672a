// The shapes of a mesh's cells, ready for the questions of the voidage map: how much of a ball is
// in this cell, does this cell hold that point. Built once.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "dem_server/interphase/overlap.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// An axis-aligned box [m].
struct Bounds {
  Vector3 lower{0, 0, 0};
  Vector3 upper{0, 0, 0};
};

/// Keeps what it needs of the mesh, so the mesh may go away. On a lattice that is its nodes only.
class CellShapes {
 public:
  explicit CellShapes(const Mesh& mesh);

  int cells() const { return cells_; }
  const std::optional<Lattice>& lattice() const { return lattice_; }
  Bounds bounds(int cell) const;

  /// Volume [m³] of ball ∩ cell. Faces that are not plane count as the fan of triangles about the
  /// mean of their points, as in the mesh's own volumes. See `polyhedron_overlap` for the error.
  double overlap(int cell, const Ball& ball) const;

  /// Whether the cell holds the point [m]; its surface belongs to it.
  bool contains(int cell, const Vector3& point) const;

 private:
  struct CellFacet {
    int facet = 0;
    double side = 1;         ///< −1 if the facet's normal points into the cell
    Vector3 shift{0, 0, 0};  ///< [m] from the facet's place to its place on this cell
  };

  void add_facets(const Mesh& mesh, int face, std::vector<int>& first_facet);
  void attach_facets(const Mesh& mesh, const std::vector<int>& first_facet);
  void measure(int cell);
  Facet facet(int index) const;
  std::array<int, 3> lattice_index(int cell) const;
  bool winds_around(int cell, const Vector3& point) const;

  int cells_ = 0;
  std::optional<Lattice> lattice_;
  // General meshes. Facets: one for each plane face, one for each triangle of the others.
  std::vector<Vector3> corners_;
  std::vector<int> facet_offsets_{0};  ///< CSR into corners_
  std::vector<Vector3> normals_;
  std::vector<int> cell_offsets_;  ///< CSR into cell_facets_
  std::vector<CellFacet> cell_facets_;
  std::vector<Bounds> bounds_;
  std::vector<char> convex_;
};

}  // namespace fluxpact
