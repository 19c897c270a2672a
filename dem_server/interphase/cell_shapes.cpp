#include "dem_server/interphase/cell_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fluxpact {
namespace {

// Deviation from a plane, over the size, that is still the rounding of the coordinates.
constexpr double flat = 1e-12;

}  // namespace

CellShapes::CellShapes(const Mesh& mesh) : cells_(mesh.cells()), lattice_(mesh.lattice) {
  if (lattice_) return;
  std::vector<int> first_facet{0};  // CSR: facets of each face
  for (int face = 0; face < mesh.faces(); ++face) add_facets(mesh, face, first_facet);
  attach_facets(mesh, first_facet);
  bounds_.resize(cells_);
  centres_ = mesh.cell_centres;
  volumes_ = mesh.cell_volumes;
  convex_.resize(cells_);
  for (int cell = 0; cell < cells_; ++cell) measure(cell);
}

void CellShapes::add_facets(const Mesh& mesh, int face, std::vector<int>& first_facet) {
  const int first = mesh.face_offsets[face];
  const int count = mesh.face_offsets[face + 1] - first;
  const auto point = [&](int k) { return mesh.points[mesh.face_points[first + k]]; };

  Vector3 mean = Vector3::Zero();
  for (int k = 0; k < count; ++k) mean += point(k) / count;
  const Vector3 normal = mesh.face_areas[face].normalized();
  double size = 0;
  double warp = 0;
  for (int k = 0; k < count; ++k) {
    size = std::max(size, (point(k) - mean).norm());
    warp = std::max(warp, std::abs(normal.dot(point(k) - mean)));
  }
  if (warp <= flat * size) {
    for (int k = 0; k < count; ++k) corners_.push_back(point(k));
    facet_offsets_.push_back(static_cast<int>(corners_.size()));
    normals_.push_back(normal);
  } else {
    for (int k = 0; k < count; ++k) {
      const Vector3 a = point(k);
      const Vector3 b = point((k + 1) % count);
      corners_.insert(corners_.end(), {mean, a, b});
      facet_offsets_.push_back(static_cast<int>(corners_.size()));
      normals_.push_back((a - mean).cross(b - mean).normalized());
    }
  }
  first_facet.push_back(static_cast<int>(normals_.size()));
}

void CellShapes::attach_facets(const Mesh& mesh, const std::vector<int>& first_facet) {
  std::vector<Vector3> shift_of_neighbour(mesh.internal_faces(), Vector3::Zero());
  for (std::size_t k = 0; k < mesh.periodic_faces.size(); ++k) {
    shift_of_neighbour[mesh.periodic_faces[k]] = -mesh.translations[k];
  }
  cell_offsets_.assign(cells_ + 1, 0);
  const auto facets_of = [&](int face) { return first_facet[face + 1] - first_facet[face]; };
  for (int face = 0; face < mesh.faces(); ++face) {
    cell_offsets_[mesh.owner[face] + 1] += facets_of(face);
    if (face < mesh.internal_faces()) {
      cell_offsets_[mesh.neighbour[face] + 1] += facets_of(face);
    }
  }
  for (int cell = 0; cell < cells_; ++cell) cell_offsets_[cell + 1] += cell_offsets_[cell];

  cell_facets_.resize(cell_offsets_.back());
  std::vector<int> next(cell_offsets_.begin(), cell_offsets_.end() - 1);
  for (int face = 0; face < mesh.faces(); ++face) {
    for (int index = first_facet[face]; index < first_facet[face + 1]; ++index) {
      cell_facets_[next[mesh.owner[face]]++] = {index, 1.0, Vector3::Zero()};
      if (face < mesh.internal_faces()) {
        cell_facets_[next[mesh.neighbour[face]]++] = {index, -1.0, shift_of_neighbour[face]};
      }
    }
  }
}

void CellShapes::measure(int cell) {
  Bounds box{Vector3::Constant(std::numeric_limits<double>::max()),
             Vector3::Constant(std::numeric_limits<double>::lowest())};
  const auto each_corner = [&](auto&& use) {
    for (int k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
      for (const Vector3& corner : facet(cell_facets_[k].facet).loop) {
        use(Vector3(corner + cell_facets_[k].shift));
      }
    }
  };
  each_corner([&](const Vector3& corner) {
    box.lower = box.lower.cwiseMin(corner);
    box.upper = box.upper.cwiseMax(corner);
  });
  bounds_[cell] = box;

  const double tolerance = flat * (box.upper - box.lower).norm();
  bool convex = true;
  for (int k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
    const CellFacet& use = cell_facets_[k];
    const Facet plane = facet(use.facet);
    each_corner([&](const Vector3& corner) {
      const double outside = use.side * plane.normal.dot(corner - plane.loop[0] - use.shift);
      convex = convex && outside <= tolerance;
    });
  }
  convex_[cell] = convex ? 1 : 0;
}

Facet CellShapes::facet(int index) const {
  const auto first = static_cast<std::size_t>(facet_offsets_[index]);
  const auto last = static_cast<std::size_t>(facet_offsets_[index + 1]);
  return {std::span(corners_).subspan(first, last - first), normals_[index]};
}

std::array<int, 3> CellShapes::lattice_index(int cell) const {
  const int nx = static_cast<int>(lattice_->nodes[0].size()) - 1;
  const int ny = static_cast<int>(lattice_->nodes[1].size()) - 1;
  return {cell % nx, cell / nx % ny, cell / nx / ny};
}

Bounds CellShapes::bounds(int cell) const {
  if (!lattice_) return bounds_[cell];
  const auto index = lattice_index(cell);
  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& nodes = lattice_->nodes[axis];
    box.lower[axis] = nodes[index[axis]];
    box.upper[axis] = nodes[index[axis] + 1];
  }
  return box;
}

double CellShapes::overlap(int cell, const Ball& ball) const {
  if (lattice_) {
    const Bounds box = bounds(cell);
    return box_overlap(ball, box.lower, box.upper);
  }
  const int first = cell_offsets_[cell];
  const int last = cell_offsets_[cell + 1];
  if (convex_[cell] != 0) {  // few planes cut the ball: no need to look at their edges
    int cuts = 0;
    double height = 0;
    for (int k = first; k < last; ++k) {
      const CellFacet& use = cell_facets_[k];
      const Facet plane = facet(use.facet);
      const double h = use.side * plane.normal.dot(plane.loop[0] + use.shift - ball.centre);
      if (h <= -ball.radius) return 0;
      if (h < ball.radius) {
        ++cuts;
        height = h;
      }
    }
    if (cuts == 0) return ball_volume(ball.radius);
    if (cuts == 1) return cut_ball_volume(ball.radius, height);
  }
  double sum = 0;
  for (int k = first; k < last; ++k) {
    const CellFacet& use = cell_facets_[k];
    const Ball seen{ball.centre - use.shift, ball.radius};
    sum += use.side * signed_cone_overlap(seen, facet(use.facet));
  }
  return sum;
}

bool CellShapes::holds(int cell, const Ball& ball) const {
  if (lattice_) {
    const Bounds box = bounds(cell);
    return (ball.centre - box.lower).minCoeff() >= ball.radius &&
           (box.upper - ball.centre).minCoeff() >= ball.radius;
  }
  if (convex_[cell] == 0) return false;
  for (int k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
    const CellFacet& use = cell_facets_[k];
    const Facet plane = facet(use.facet);
    const double height = use.side * plane.normal.dot(plane.loop[0] + use.shift - ball.centre);
    if (height < ball.radius) return false;
  }
  return true;
}

bool CellShapes::contains(int cell, const Vector3& point) const {
  const Bounds box = bounds(cell);
  const double tolerance = flat * (box.upper - box.lower).norm();
  if ((point - box.lower).minCoeff() < -tolerance || (box.upper - point).minCoeff() < -tolerance) {
    return false;
  }
  if (lattice_) return true;
  if (convex_[cell] == 0) return winds_around(cell, point);
  for (int k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
    const CellFacet& use = cell_facets_[k];
    const Facet plane = facet(use.facet);
    if (use.side * plane.normal.dot(plane.loop[0] + use.shift - point) < -tolerance) return false;
  }
  return true;
}

// The share of a small ball about the point: 1 inside, 1/2 on a face, 1/8 on a corner of a cube, 0
// outside. Above 1/100 any corner that a mesh may have counts as inside.
bool CellShapes::winds_around(int cell, const Vector3& point) const {
  const Bounds box = bounds(cell);
  const double radius = 1e-6 * (box.upper - box.lower).norm();
  double sum = 0;
  for (int k = cell_offsets_[cell]; k < cell_offsets_[cell + 1]; ++k) {
    const CellFacet& use = cell_facets_[k];
    sum += use.side * signed_cone_overlap({point - use.shift, radius}, facet(use.facet));
  }
  return sum > ball_volume(radius) / 100;
}

}  // namespace fluxpact
