#include "proto/mesh/mesh_quality.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fluxpact {
namespace {

void raise(Worst& worst, double value, int index, const Vector3& place) {
  if (worst.index < 0 || value > worst.value) worst = {value, index, place};
}

void measure_faces(const Mesh& mesh, MeshQuality& quality) {
  double sum = 0;
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    const Vector3& area = mesh.face_areas[face];
    const Vector3& delta = mesh.delta[face];
    const Vector3& place = mesh.face_centres[face];
    const Vector3 from_owner = place - mesh.cell_centres[mesh.owner[face]];
    const double along = delta.dot(area);
    // The arc tangent keeps its digits at small angles, where the arc cosine loses half of them.
    const double angle = std::atan2(delta.cross(area).norm(), along) * 180 / std::numbers::pi;
    sum += angle;
    raise(quality.non_orthogonality, angle, face, place);
    if (angle > steep_angle) ++quality.steep_faces;
    raise(quality.skewness, from_owner.cross(delta).norm() / delta.squaredNorm(), face, place);
    const double reached = from_owner.dot(area);
    if (!(reached > 0 && reached < along)) ++quality.outside_faces;
    const double a = mesh.cell_volumes[mesh.owner[face]];
    const double b = mesh.cell_volumes[mesh.neighbour[face]];
    raise(quality.volume_ratio, std::max(a, b) / std::min(a, b), face, place);
  }
  if (mesh.internal_faces() > 0) quality.mean_non_orthogonality = sum / mesh.internal_faces();
}

void measure_cells(const Mesh& mesh, MeshQuality& quality) {
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0;
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    Matrix3 extent = Matrix3::Zero();
    for (int i = mesh.cell_face_offsets[cell]; i < mesh.cell_face_offsets[cell + 1]; ++i) {
      const Vector3& area = mesh.face_areas[mesh.cell_faces[i]];
      extent += area * area.transpose() / area.norm();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3> solver(extent, Eigen::EigenvaluesOnly);
    const Vector3& values = solver.eigenvalues();  // ascending
    raise(quality.aspect_ratio, values[2] / values[0], cell, mesh.cell_centres[cell]);
    smallest = std::min(smallest, mesh.cell_volumes[cell]);
    largest = std::max(largest, mesh.cell_volumes[cell]);
  }
  quality.smallest_cell = std::cbrt(smallest);
  quality.largest_cell = std::cbrt(largest);
}

}  // namespace

MeshQuality measure_quality(const Mesh& mesh) {
  MeshQuality quality;
  measure_faces(mesh, quality);
  measure_cells(mesh, quality);
  return quality;
}

}  // namespace fluxpact
