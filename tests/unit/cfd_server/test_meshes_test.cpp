// The meshes on which the fluid solver is tested are what they say.
#include "tests/unit/cfd_server/test_meshes.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <set>

namespace fluxpact {
namespace {

struct Kind {
  const char* name;
  std::function<Mesh(const TestBox&)> make;
  int cells;  ///< of the box below
};

class TestMeshes : public testing::TestWithParam<Kind> {};

TestBox moved_box() { return {{3, 4, 5}, {-1, 0, 2}, {1, 3, 4.5}, {}, 0.2, 7}; }

TEST_P(TestMeshes, fill_the_box_with_the_cells_that_they_promise) {
  const Mesh mesh = GetParam().make(moved_box());
  EXPECT_EQ(mesh.cells(), GetParam().cells);
  const double volume = std::accumulate(mesh.cell_volumes.begin(), mesh.cell_volumes.end(), 0.0);
  EXPECT_NEAR(volume, 15.0, 1e-12);  // a few hundred additions of round-off
}

TEST_P(TestMeshes, have_each_side_of_the_box_as_a_patch) {
  const Mesh mesh = GetParam().make(moved_box());
  const std::array<double, 6> places{-1, 1, 0, 3, 2, 4.5};
  ASSERT_EQ(mesh.patches.size(), 6u);
  const std::array<const char*, 6> names{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  for (std::size_t side = 0; side < 6; ++side) {
    const Patch* patch = mesh.find_patch(names.at(side));
    ASSERT_NE(patch, nullptr);
    Vector3 area = Vector3::Zero();
    for (int face = patch->first; face < patch->first + patch->size; ++face) {
      EXPECT_NEAR(mesh.face_centres[face][static_cast<int>(side) / 2], places.at(side), 1e-13);
      area += mesh.face_areas[face];
    }
    Vector3 expected = Vector3::Zero();
    const Vector3 lengths(2, 3, 2.5);
    const auto axis = static_cast<int>(side) / 2;
    expected[axis] = (side % 2 == 0 ? -1 : 1) * 15.0 / lengths[axis];
    EXPECT_NEAR((area - expected).norm(), 0, 1e-13);
  }
}

TEST_P(TestMeshes, join_periodic_sides) {
  TestBox box = moved_box();
  box.periodic = {true, true, false};
  const Mesh mesh = GetParam().make(box);
  EXPECT_EQ(mesh.cells(), GetParam().cells);
  EXPECT_EQ(mesh.patches.size(), 2u);
  ASSERT_FALSE(mesh.periodic_faces.empty());
  for (std::size_t i = 0; i < mesh.periodic_faces.size(); ++i) {
    EXPECT_NEAR(mesh.translations[i].norm(), mesh.translations[i].x() > 1 ? 2 : 3, 1e-14);
    EXPECT_LT(mesh.delta[mesh.periodic_faces[i]].norm(), 1.5);  // the image is next door
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, TestMeshes,
                         testing::Values(Kind{"hexahedra", hexahedra, 60},
                                         Kind{"tetrahedra", tetrahedra, 360},
                                         Kind{"prisms", prisms, 120},
                                         Kind{"polyhedra", polyhedra, 4 * 5 * 6},
                                         Kind{"mixed", mixed_cells, 24 + 12 * 7 + 24 * 2}),
                         [](const auto& kind) { return kind.param.name; });

TEST(TestMeshes, polyhedra_have_fourteen_faces_inside) {
  const Mesh mesh = polyhedra({.cells = {4, 4, 4}});
  const int inside = 2 + 5 * (2 + 5 * 2);
  EXPECT_EQ(mesh.cell_face_offsets[inside + 1] - mesh.cell_face_offsets[inside], 14);
  std::multiset<int> points;
  for (int i = mesh.cell_face_offsets[inside]; i < mesh.cell_face_offsets[inside + 1]; ++i) {
    const int face = mesh.cell_faces[i];
    points.insert(mesh.face_offsets[face + 1] - mesh.face_offsets[face]);
  }
  EXPECT_EQ(points.count(4), 6u);
  EXPECT_EQ(points.count(6), 8u);
}

}  // namespace
}  // namespace fluxpact
