// Numbers of mesh quality against geometry by hand.
#include "proto/mesh/mesh_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

MeshTopology two_boxes() {
  MeshSettings settings;
  settings.box.upper = {2, 1, 1};
  settings.box.cells = {2, 1, 1};
  return make_box(settings);
}

TEST(MeshQuality, of_cubes_is_perfect) {
  const MeshQuality quality = measure_quality(with_geometry(two_boxes()));
  EXPECT_NEAR(quality.non_orthogonality.value, 0, 1e-13);
  EXPECT_NEAR(quality.skewness.value, 0, 1e-15);
  EXPECT_NEAR(quality.volume_ratio.value, 1, 1e-15);
  EXPECT_NEAR(quality.aspect_ratio.value, 1, 1e-14);
  EXPECT_NEAR(quality.smallest_cell, 1, 1e-15);
  EXPECT_EQ(quality.steep_faces, 0);
  EXPECT_EQ(quality.outside_faces, 0);
}

TEST(MeshQuality, of_a_graded_box_is_that_of_its_widths) {
  MeshSettings settings;
  settings.box.upper = {4, 1, 1};
  settings.box.cells = {2, 1, 2};
  settings.box.grading.x = {{1, 1, 3}};  // widths 1 and 3
  const MeshQuality quality = measure_quality(make_box(settings));
  EXPECT_NEAR(quality.volume_ratio.value, 3, 1e-14);
  EXPECT_NEAR(quality.volume_ratio.place.x(), 1, 1e-14);
  EXPECT_NEAR(quality.aspect_ratio.value, 6, 1e-13);  // 3 x 1 x 0.5
  EXPECT_NEAR(quality.aspect_ratio.place.x(), 2.5, 1e-14);
  EXPECT_NEAR(quality.smallest_cell, std::cbrt(0.5), 1e-15);
  EXPECT_NEAR(quality.largest_cell, std::cbrt(1.5), 1e-15);
}

TEST(MeshQuality, aspect_ratio_is_that_of_the_box_in_any_position) {
  MeshTopology box = two_boxes();
  const Eigen::AngleAxisd turn(0.7, Vector3(1, 2, 3).normalized());
  for (Vector3& point : box.points) point = turn * Vector3(point.x(), point.y(), 5 * point.z());
  EXPECT_NEAR(measure_quality(with_geometry(box)).aspect_ratio.value, 5, 1e-12);
}

TEST(MeshQuality, of_a_sheared_pair_is_known_in_closed_form) {
  // Two cubes sheared along x: y-z faces keep their centres and normals, the centres of the cells
  // move apart by (1, s, 0): the angle is atan s, the face stays on the line.
  MeshTopology sheared = two_boxes();
  const double s = 3;
  for (Vector3& point : sheared.points) point.y() += s * point.x();
  MeshQuality quality = measure_quality(with_geometry(sheared));
  EXPECT_NEAR(quality.non_orthogonality.value, std::atan(s) * 180 / std::numbers::pi, 1e-12);
  EXPECT_EQ(quality.steep_faces, 1);
  EXPECT_NEAR(quality.skewness.value, 0, 1e-15);
  // One cube slides along the face between them: that needs a non-conforming face; instead the
  // middle layer of points moves by (0, m, 0): the face's centre lies m off the line between the
  // centres, each of which moves by m/2.
  MeshTopology bent = two_boxes();
  const double m = 0.4;
  for (Vector3& point : bent.points) {
    if (point.x() == 1) point.y() += m;
  }
  quality = measure_quality(with_geometry(bent));
  EXPECT_NEAR(quality.skewness.value, m / 2, 1e-14);  // |d| = 1
  EXPECT_NEAR(quality.non_orthogonality.value, 0, 1e-12);
}

TEST(MeshQuality, mean_angle_is_over_all_faces) {
  MeshSettings settings;
  settings.box.upper = {2, 2, 1};
  settings.box.cells = {2, 2, 1};
  MeshTopology mesh = make_box(settings);
  // Sheared along x: the two faces across x are at 45 degrees, so are the two across y, whose area
  // vectors turn while the line between their centres does not.
  for (Vector3& point : mesh.points) point.y() += point.x();
  EXPECT_NEAR(measure_quality(with_geometry(mesh)).mean_non_orthogonality, 45, 1e-12);
  // Sheared by a half in z the faces across y stay upright.
  mesh = make_box(settings);
  for (Vector3& point : mesh.points) point.z() += point.x();
  EXPECT_NEAR(measure_quality(with_geometry(mesh)).mean_non_orthogonality, 22.5, 1e-12);
}

TEST(MeshQuality, counts_faces_that_are_not_between_the_centres_of_their_cells) {
  // The left cell becomes an arrow head around the corner of the other: its centre has x = 1.46,
  // behind the face at x = 1. Only cells that are not convex can do that.
  MeshTopology mesh = two_boxes();
  for (Vector3& point : mesh.points) {
    if (point.x() != 0) continue;
    point = point.y() == 0 ? Vector3(5, -6, point.z()) : Vector3(-0.1, 1.2, point.z());
  }
  EXPECT_EQ(measure_quality(with_geometry(mesh)).outside_faces, 1);
}

}  // namespace
}  // namespace fluxpact
