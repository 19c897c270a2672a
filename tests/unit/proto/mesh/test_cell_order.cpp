// Cells in a better order are the same cells, nearer to their neighbours.
#include "proto/mesh/cell_order.hpp"

#include <random>

#include "proto/mesh/box.hpp"
#include "tests/unit/proto/mesh/mesh_files.hpp"

namespace fluxpact {
namespace {

/// A box whose cells have random numbers.
Mesh shuffled_box(unsigned seed) {
  MeshSettings settings;
  settings.box.upper = {8, 8, 8};
  settings.box.cells = {8, 8, 8};
  settings.periodic = {Axis::x};
  MeshTopology box = make_box(settings);
  std::vector<int> number(512);
  std::iota(number.begin(), number.end(), 0);
  std::ranges::shuffle(number, std::mt19937(seed));
  for (int& cell : box.owner) cell = number[cell];
  for (int& cell : box.neighbour) cell = number[cell];
  return with_geometry(box);
}

double mean_distance(const Mesh& mesh) {
  double sum = 0;
  for (int face = 0; face < mesh.internal_faces(); ++face) {
    sum += std::abs(mesh.owner[face] - mesh.neighbour[face]);
  }
  return sum / mesh.internal_faces();
}

/// Places of the two cells of each face with the face's own, in an order that numbers do not touch.
std::vector<std::array<double, 13>> joints(const Mesh& mesh) {
  std::vector<std::array<double, 13>> all;
  for (int face = 0; face < mesh.faces(); ++face) {
    const bool internal = face < mesh.internal_faces();
    const Vector3 other =
        internal ? mesh.cell_centres[mesh.neighbour[face]] : Vector3(Vector3::Zero());
    const Vector3 delta = internal ? mesh.delta[face] : Vector3(Vector3::Zero());
    const Vector3& owner = mesh.cell_centres[mesh.owner[face]];
    const Vector3& at = mesh.face_centres[face];
    const Vector3& area = mesh.face_areas[face];
    all.push_back({at.x(), at.y(), at.z(), owner.x(), owner.y(), owner.z(), other.x(), other.y(),
                   other.z(), delta.x(), delta.y(), delta.z(), area.sum()});
  }
  std::ranges::sort(all);
  return all;
}

TEST(CellOrder, brings_neighbours_together_and_changes_nothing_else) {
  const Mesh mesh = shuffled_box(1);
  const auto better = with_cells_in_better_order(mesh);
  ASSERT_TRUE(better.has_value());
  const Mesh ordered = with_geometry(*better);
  // Levels of a breadth-first walk through 8³ cells hold at most some 60 of them.
  EXPECT_LT(mean_distance(ordered), 64);
  EXPECT_GT(mean_distance(mesh), 128);  // two random numbers of 512 differ by a third of it
  EXPECT_EQ(ordered.patches.size(), mesh.patches.size());
  EXPECT_EQ(ordered.periodic_faces.size(), 64u);
  const auto before = joints(mesh);
  const auto after = joints(ordered);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    // The sum over a cell's faces runs in another order: round-off of its centre.
    for (std::size_t k = 0; k < 13; ++k) EXPECT_NEAR(before[i].at(k), after[i].at(k), 1e-13);
  }
}

TEST(CellOrder, leaves_a_good_order_alone) {
  const auto better = with_cells_in_better_order(shuffled_box(2));
  ASSERT_TRUE(better.has_value());
  EXPECT_FALSE(with_cells_in_better_order(with_geometry(*better)).has_value());
}

TEST(CellOrder, knows_meshes_of_several_parts) {
  MeshTopology two = make_box([] {
    MeshSettings settings;
    settings.box.upper = {1, 1, 1};
    settings.box.cells = {2, 1, 1};
    return settings;
  }());
  // A second pair of cells far away, not joined to the first.
  const MeshTopology one = two;
  const int points = static_cast<int>(one.points.size());
  for (const Vector3& point : one.points) two.points.emplace_back(point + Vector3(9, 0, 0));
  MeshTopology both;
  both.points = two.points;
  both.face_offsets.push_back(0);
  const auto add = [&](int face, int part) {
    for (int i = one.face_offsets[face]; i < one.face_offsets[face + 1]; ++i) {
      both.face_points.push_back(one.face_points[i] + part * points);
    }
    both.face_offsets.push_back(static_cast<int>(both.face_points.size()));
    both.owner.push_back(one.owner[face] + 2 * part);
  };
  for (const int part : {0, 1}) {
    add(0, part);
    both.neighbour.push_back(one.neighbour[0] + 2 * part);
  }
  for (const int part : {0, 1}) {
    for (int face = 1; face < 11; ++face) add(face, part);
  }
  both.patches = {{"walls", 2, 20}};
  EXPECT_FALSE(with_cells_in_better_order(with_geometry(both)).has_value());
}

}  // namespace
}  // namespace fluxpact
