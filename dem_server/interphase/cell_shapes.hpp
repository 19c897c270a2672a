// The shapes of a mesh's cells, ready for the questions of the voidage map: how much of a ball is
// in this cell, does this cell hold that point. Built once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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

  /// Whether the cell is known to hold the whole ball; false where that would be hard to say.
  bool holds(int cell, const Ball& ball) const;

  /// Calls use(point, volume) for pieces of the cell, their centroids [m] and volumes [m³]: all
  /// those that touch the ball. No piece is larger than `size` [m] along an axis (box) or an edge
  /// (tetrahedron); a cell that is no larger is one piece. The pieces do not depend on the ball.
  template <class Use>
  void each_piece(int cell, const Ball& ball, double size, const Use& use) const;

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
  template <class Use>
  static void cut_box(const Bounds& box, const Ball& ball, double size, const Use& use);
  template <class Use>
  static void cut_tetrahedron(std::array<Vector3, 4> corners, const Ball& ball, double size,
                              const Use& use);

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
  std::vector<Vector3> centres_;  ///< [m]
  std::vector<double> volumes_;   ///< [m³]
};

template <class Use>
void CellShapes::each_piece(int cell, const Ball& ball, double size, const Use& use) const {
  const Bounds box = bounds(cell);
  if (lattice_) return cut_box(box, ball, size, use);
  if ((box.upper - box.lower).maxCoeff() <= size) return use(centres_[cell], volumes_[cell]);
  for (int k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
    const CellFacet& side = cell_facets_[k];
    const Facet plane = facet(side.facet);
    for (std::size_t i = 1; i + 1 < plane.loop.size(); ++i) {
      Vector3 second = plane.loop[i] + side.shift;
      Vector3 third = plane.loop[i + 1] + side.shift;
      if (side.side < 0) second.swap(third);
      cut_tetrahedron({centres_[cell], plane.loop[0] + side.shift, second, third}, ball, size, use);
    }
  }
}

template <class Use>
void CellShapes::cut_box(const Bounds& box, const Ball& ball, double size, const Use& use) {
  const Vector3 nearest = ball.centre.cwiseMax(box.lower).cwiseMin(box.upper);
  if ((nearest - ball.centre).squaredNorm() >= ball.radius * ball.radius) return;
  std::array<double, 3> step{};
  std::array<double, 3> first{};
  std::array<double, 3> last{};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = box.upper[axis] - box.lower[axis];
    const double parts = std::max(1.0, std::ceil(extent / size));
    const double centre = ball.centre[axis] - box.lower[axis];
    step[axis] = extent / parts;
    first[axis] = std::max(0.0, std::floor((centre - ball.radius) / step[axis]));
    last[axis] = std::min(parts - 1, std::floor((centre + ball.radius) / step[axis]));
  }
  const double volume = step[0] * step[1] * step[2];
  for (double k = first[2]; k <= last[2]; ++k) {
    const double z = box.lower.z() + (k + 0.5) * step[2];
    for (double j = first[1]; j <= last[1]; ++j) {
      const double y = box.lower.y() + (j + 0.5) * step[1];
      for (double i = first[0]; i <= last[0]; ++i) {
        use(Vector3(box.lower.x() + (i + 0.5) * step[0], y, z), volume);
      }
    }
  }
}

// Halved at its longest edge until that is short enough.
template <class Use>
void CellShapes::cut_tetrahedron(std::array<Vector3, 4> corners, const Ball& ball, double size,
                                 const Use& use) {
  std::array<int, 2> longest{0, 1};
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const double length = (corners[i] - corners[j]).squaredNorm();
      if (length > square) {
        square = length;
        longest = {i, j};
      }
    }
  }
  // No corner is further from the centroid than the longest edge.
  const Vector3 centroid = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const double distance = (centroid - ball.centre).norm() - ball.radius;
  if (distance > 0 && distance * distance > square) return;
  if (square <= size * size) {
    const Vector3& a = corners[0];
    return use(centroid, (corners[1] - a).cross(corners[2] - a).dot(corners[3] - a) / 6);
  }
  const Vector3 middle = 0.5 * (corners[longest[0]] + corners[longest[1]]);
  for (const int end : longest) {
    std::array<Vector3, 4> half = corners;
    half[end] = middle;
    cut_tetrahedron(half, ball, size, use);
  }
}

}  // namespace fluxpact
