// A box as a face-based mesh: geometry, closure, patches, periodicity, refusals.
#include <gtest/gtest.h>

#include <numeric>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

MeshSettings box(const Vector3& upper, const std::array<int, 3>& cells) {
  MeshSettings settings;
  settings.box.upper = upper;
  settings.box.cells = cells;
  return settings;
}

double total_volume(const Mesh& mesh) {
  return std::accumulate(mesh.cell_volumes.begin(), mesh.cell_volumes.end(), 0.0);
}

TEST(Box, has_the_volume_and_the_faces_of_a_box) {
  const Mesh mesh = make_box(box({1, 2, 3}, {4, 5, 6}));
  EXPECT_EQ(mesh.cells(), 120);
  EXPECT_EQ(mesh.internal_faces(), 3 * 5 * 6 + 4 * 4 * 6 + 4 * 5 * 5);
  EXPECT_EQ(mesh.faces() - mesh.internal_faces(), 2 * (5 * 6 + 4 * 6 + 4 * 5));
  EXPECT_NEAR(total_volume(mesh), 6.0, 6e-14);  // 120 additions of round-off
}

TEST(Box, area_vectors_point_from_owner_to_neighbour) {
  const Mesh mesh = make_box(box({1, 2, 3}, {3, 2, 4}));
  for (int face = 0; face < mesh.internal_faces(); ++face)
    EXPECT_GT(mesh.face_areas[face].dot(mesh.delta[face]), 0);
  for (int face = mesh.internal_faces(); face < mesh.faces(); ++face) {
    EXPECT_GT(
        mesh.face_areas[face].dot(mesh.face_centres[face] - mesh.cell_centres[mesh.owner[face]]),
        0);
  }
}

TEST(Box, faces_go_to_the_first_patch_that_holds_their_centre) {
  MeshSettings settings = box({1, 1, 1}, {4, 1, 1});
  settings.patches = {{"jet", {Side::z_min, Region{std::array{0.25, 0.5}, {}, {}}}},
                      {"background", {Side::z_min, {}}}};
  const Mesh mesh = make_box(settings);
  ASSERT_NE(mesh.find_patch("jet"), nullptr);
  EXPECT_EQ(mesh.find_patch("jet")->size, 1);
  EXPECT_EQ(mesh.find_patch("background")->size, 3);
  EXPECT_EQ(mesh.find_patch("walls")->size, 4 + 4 + 4 + 1 + 1);
  EXPECT_EQ(mesh.find_patch("outlet"), nullptr);
}

TEST(Box, a_periodic_pair_of_sides_is_one_layer_of_internal_faces) {
  MeshSettings settings = box({1, 1, 1}, {2, 3, 1});
  settings.periodic = {Axis::y};
  const Mesh mesh = make_box(settings);
  EXPECT_EQ(mesh.periodic_faces.size(), 2u);
  for (const int face : mesh.periodic_faces) {
    EXPECT_NEAR(mesh.delta[face].y(), 1.0 / 3, 1e-15);  // the image is next door
    EXPECT_NEAR(mesh.cell_centres[mesh.neighbour[face]].y(), 1.0 / 6, 1e-15);
  }
  ASSERT_TRUE(mesh.lattice.has_value());
  EXPECT_TRUE(mesh.lattice->periodic[1]);
  EXPECT_FALSE(mesh.lattice->periodic[0]);
}

TEST(Box, one_cell_may_be_its_own_periodic_neighbour) {
  MeshSettings settings = box({1, 2, 3}, {1, 1, 1});
  settings.periodic = {Axis::x, Axis::y, Axis::z};
  const Mesh mesh = make_box(settings);
  EXPECT_EQ(mesh.internal_faces(), 3);
  EXPECT_EQ(mesh.faces(), 3);
  EXPECT_NEAR(mesh.cell_volumes[0], 6.0, 1e-14);
}

TEST(Box, refuses_a_patch_without_faces_by_name) {
  MeshSettings settings = box({1, 1, 1}, {2, 2, 2});
  settings.patches = {{"jet", {Side::z_min, Region{std::array{0.4, 0.45}, {}, {}}}}};
  try {
    make_box(settings);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("jet"), std::string::npos);
  }
}

TEST(Geometry, of_a_moved_vertex_keeps_every_cell_closed_and_the_volume) {
  MeshTopology topology = make_box(box({1, 1, 1}, {2, 2, 2}));
  topology.points[13] += Vector3(0.1, -0.07, 0.05);  // the middle of 3 x 3 x 3 points
  const Mesh mesh = with_geometry(topology);
  EXPECT_NEAR(total_volume(mesh), 1.0, 1e-14);
  EXPECT_FALSE(mesh.lattice.has_value());
  EXPECT_NE(mesh.cell_volumes[0], mesh.cell_volumes[7]);
}

TEST(Geometry, refuses_what_is_no_mesh) {
  const MeshTopology good = make_box(box({1, 1, 1}, {2, 1, 1}));
  MeshTopology bad = good;
  bad.face_points[0] = 99;
  EXPECT_THROW(with_geometry(bad), ConfigError);
  bad = good;
  std::swap(bad.face_points[4],
            bad.face_points[6]);  // turns a boundary face round: its cell is open
  EXPECT_THROW(with_geometry(bad), ConfigError);
  bad = good;
  bad.points.emplace_back(5, 5, 5);
  EXPECT_THROW(with_geometry(bad), ConfigError);
  bad = good;
  bad.owner.back() = 7;
  EXPECT_THROW(with_geometry(bad), ConfigError);
  bad = good;
  bad.patches.back().size -= 1;
  EXPECT_THROW(with_geometry(bad), ConfigError);
}

TEST(Fingerprint, changes_with_any_part_of_the_mesh) {
  const MeshTopology mesh = make_box(box({1, 1, 1}, {2, 1, 1}));
  MeshTopology other = mesh;
  EXPECT_EQ(fingerprint(other), fingerprint(mesh));
  other.points[3].x() += 1e-16;
  other.points[0].z() = 1e-300;
  EXPECT_NE(fingerprint(other), fingerprint(mesh));
  other = mesh;
  other.patches[0].name = "w";
  EXPECT_NE(fingerprint(other), fingerprint(mesh));
}

}  // namespace
}  // namespace fluxpact
