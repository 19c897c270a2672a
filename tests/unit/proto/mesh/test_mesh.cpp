// A box as a face-based mesh: geometry, closure, patches, periodicity, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/mesh/cell_sides.hpp"

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

TEST(Box, of_graded_axes_has_the_nodes_of_a_geometric_series) {
  MeshSettings settings = box({7, 20, 1}, {3, 4, 1});
  settings.box.grading.x = {{1, 1, 4}};                // 1, 2, 4
  settings.box.grading.y = {{1, 1, 4}, {1, 1, 0.25}};  // 2, 8, 8, 2: fine at both ends
  const Mesh mesh = make_box(settings);
  ASSERT_TRUE(mesh.lattice.has_value());
  const std::vector<double> x{0, 1, 3, 7};
  const std::vector<double> y{0, 2, 10, 18, 20};
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(mesh.lattice->nodes[0][i], x[i], 1e-14);
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(mesh.lattice->nodes[1][i], y[i], 1e-14);
  EXPECT_EQ(mesh.lattice->nodes[2], (std::vector<double>{0, 1}));
}

TEST(Box, parts_of_an_axis_share_length_and_cells) {
  MeshSettings settings = box({1, 1, 1}, {10, 1, 1});
  settings.box.grading.x = {{0.2, 3, 1}, {0.8, 2, 1}};  // 6 cells in a fifth, 4 in the rest
  const Mesh mesh = make_box(settings);
  ASSERT_TRUE(mesh.lattice.has_value());
  EXPECT_NEAR(mesh.lattice->nodes[0][6], 0.2, 1e-15);
  EXPECT_NEAR(mesh.lattice->nodes[0][1], 0.2 / 6, 1e-15);
  EXPECT_NEAR(mesh.lattice->nodes[0][7], 0.4, 1e-15);
}

TEST(Box, a_ratio_of_nearly_one_keeps_its_digits) {
  MeshSettings settings = box({1, 1, 1}, {1000, 1, 1});
  settings.box.grading.x = {{1, 1, 1 + 1e-12}};
  const Mesh mesh = make_box(settings);
  // Widths differ by 1e-12 of themselves: the middle moves by an eighth of that.
  EXPECT_NEAR(mesh.lattice->nodes[0][500], 0.5, 2e-13);
}

TEST(Box, refuses_a_part_without_cells_by_name) {
  MeshSettings settings = box({1, 1, 1}, {1, 1, 4});
  const auto refusal = [&]() -> std::string {
    try {
      make_box(settings);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  settings.box.grading.z = {{1, 1, 1}, {1, 100, 1}};
  EXPECT_EQ(refusal().find("fluid.mesh.box.grading.z[0]: 0 of the 4 cells"), 0u) << refusal();
  settings.box.grading.z = {};
  settings.box.grading.x = {{1, 1, 2}};
  EXPECT_EQ(refusal().find("fluid.mesh.box.grading.x[0]: 1 of the 1 cells"), 0u) << refusal();
}

TEST(Geometry, of_a_moved_vertex_keeps_every_cell_closed_and_the_volume) {
  MeshTopology topology = make_box(box({1, 1, 1}, {2, 2, 2}));
  topology.points[13] += Vector3(0.1, -0.07, 0.05);  // the middle of 3 x 3 x 3 points
  const Mesh mesh = with_geometry(topology);
  EXPECT_NEAR(total_volume(mesh), 1.0, 1e-14);
  EXPECT_FALSE(mesh.lattice.has_value());
  EXPECT_NE(mesh.cell_volumes[0], mesh.cell_volumes[7]);
}

TEST(Geometry, volume_of_a_warped_cell_is_that_of_the_triangles_of_its_faces) {
  // A pyramid over a hexagon of uneven height: of a quadrangle the corners lie alternately above
  // and below the plane through their mean, which hides errors.
  MeshTopology topology;
  constexpr std::array<double, 6> heights{0.3, 0, 0.1, -0.2, 0.05, 0.15};
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    topology.points.emplace_back(std::cos(angle), std::sin(angle), heights.at(i));
  }
  topology.points.emplace_back(0.2, 0.1, 2);
  CellSides sides;
  sides.add(0, std::array{5, 4, 3, 2, 1, 0});
  for (int i = 0; i < 6; ++i) sides.add(0, std::array{i, (i + 1) % 6, 6});
  const std::vector<int> patches(7, 0);
  const std::vector<std::string> names{"walls"};
  const Mesh mesh = with_geometry(
      mesh_of_sides(topology.points, sides, match_sides(sides, topology.points), patches, names));
  // Signed tetrahedra over the triangles about the mean of each face, from any point.
  const Vector3 apex(0.2, -0.4, 0.7);
  double volume = 0;
  for (int face = 0; face < mesh.faces(); ++face) {
    const int first = mesh.face_offsets[face];
    const int size = mesh.face_offsets[face + 1] - first;
    const int* ring = mesh.face_points.data() + first;
    Vector3 mean = Vector3::Zero();
    for (int i = 0; i < size; ++i) mean += mesh.points[ring[i]] / size;
    for (int i = 0; i < size; ++i) {
      const Vector3& a = mesh.points[ring[i]];
      const Vector3& b = mesh.points[ring[(i + 1) % size]];
      volume += (mean - apex).dot((a - apex).cross(b - apex)) / 6;
    }
  }
  EXPECT_NEAR(mesh.cell_volumes[0], volume, 1e-14);
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

TEST(Geometry, refuses_faces_that_cannot_be) {
  const MeshTopology good = make_box(box({1, 1, 1}, {2, 1, 1}));
  const auto refusal = [](const MeshTopology& mesh) -> std::string {
    try {
      with_geometry(mesh);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  MeshTopology bad = good;
  bad.neighbour[0] = 0;
  EXPECT_EQ(refusal(bad), "mesh: face 0 joins cell 0 to itself");
  bad = good;
  bad.face_offsets[1] = 2;
  EXPECT_EQ(refusal(bad), "mesh: face 0 has 2 points; it needs at least 3");
  bad = good;
  bad.patches[0].size = 2147483647;
  EXPECT_NE(refusal(bad).find("patch 'walls' has 2147483647 faces"), std::string::npos);
}

TEST(Geometry, names_the_first_faults_with_their_place_and_counts_all) {
  MeshTopology mesh = make_box(box({8, 1, 1}, {8, 1, 1}));
  for (int i = 0; i < 6; ++i) mesh.points.emplace_back(i, 5, 5);
  try {
    with_geometry(mesh);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("6 points are on no face: point 36 at (0, 5, 5) m"), std::string::npos);
    EXPECT_NE(text.find("point 39 at (3, 5, 5) m; and 2 more"), std::string::npos) << text;
  }
  mesh = make_box(box({8, 1, 1}, {8, 1, 1}));
  for (Vector3& point : mesh.points) point.x() = -point.x();  // a mirror turns all inside out
  try {
    with_geometry(mesh);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("8 cells have no positive volume: cell 0 at (-0.5, 0.5, 0.5) m, -1 m³"),
              std::string::npos)
        << text;
  }
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
