// Two patches a translation apart become one layer of internal faces, as a periodic box has.
#include "proto/mesh/periodic_patches.hpp"

#include "proto/mesh/box.hpp"
#include "proto/mesh/cell_sides.hpp"
#include "tests/unit/proto/mesh/mesh_files.hpp"

namespace fluxpact {
namespace {

MeshSettings box_of_patches() {
  MeshSettings settings;
  settings.box.upper = {1, 2, 3};
  settings.box.cells = {2, 3, 4};
  settings.patches = {{"west", {Side::x_min, {}}},   {"east", {Side::x_max, {}}},
                      {"south", {Side::y_min, {}}},  {"north", {Side::y_max, {}}},
                      {"bottom", {Side::z_min, {}}}, {"top", {Side::z_max, {}}}};
  return settings;
}

TEST(PeriodicPatches, joined_are_the_periodic_box) {
  MeshTopology joined = make_box(box_of_patches());
  joined = join_periodic(std::move(joined), "east", "west", 1e-6);
  joined = join_periodic(std::move(joined), "south", "north", 1e-6);
  const Mesh mesh = with_geometry(std::move(joined));
  MeshSettings settings = box_of_patches();
  settings.patches.erase(settings.patches.begin(), settings.patches.begin() + 4);
  settings.periodic = {Axis::x, Axis::y};
  const Mesh box = make_box(settings);
  EXPECT_EQ(mesh.internal_faces(), box.internal_faces());
  EXPECT_EQ(mesh.faces(), box.faces());
  EXPECT_EQ(mesh.periodic_faces.size(), box.periodic_faces.size());
  for (int cell = 0; cell < box.cells(); ++cell) {
    EXPECT_NEAR((mesh.cell_centres[cell] - box.cell_centres[cell]).norm(), 0, 1e-15);
  }
  ASSERT_TRUE(mesh.lattice.has_value());
  EXPECT_TRUE(mesh.lattice->periodic[0] && mesh.lattice->periodic[1] && !mesh.lattice->periodic[2]);
  for (std::size_t i = 0; i < mesh.periodic_faces.size(); ++i) {
    const int face = mesh.periodic_faces[i];
    // The neighbour's image lies one cell further along the area vector.
    const double width = mesh.translations[i].x() != 0 ? 0.5 : 2.0 / 3;
    EXPECT_NEAR(mesh.delta[face].dot(mesh.face_areas[face].normalized()), width, 1e-14);
  }
}

TEST(PeriodicPatches, must_be_copies_of_each_other) {
  const MeshTopology box = make_box(box_of_patches());
  expect_refusal([&] { join_periodic(box, "east", "none", 1e-6); }, {"none is not in the mesh"});
  expect_refusal([&] { join_periodic(box, "east", "top", 1e-6); },
                 {"east (12 faces)", "top (6 faces)"});
  expect_refusal([&] { join_periodic(box, "east", "east", 1e-6); }, {"must be two"});
  MeshTopology moved = box;
  for (Vector3& point : moved.points) {
    if (point.x() == 1 && point.y() > 0.5 && point.y() < 1) point.y() += 0.05;
  }
  expect_refusal([&] { join_periodic(moved, "east", "west", 1e-2); },
                 {"east and west", "no partner"});
  EXPECT_EQ(with_geometry(join_periodic(moved, "east", "west", 0.2)).periodic_faces.size(), 12u);
}

TEST(CellSides, refuse_three_cells_at_a_face_and_cells_that_overlap) {
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CellSides sides;
  const auto add = [&](int cell, std::array<int, 3> ring) { sides.add(cell, ring); };
  add(0, {0, 2, 1});
  add(1, {0, 1, 2});
  EXPECT_EQ(match_sides(sides, points).pairs.size(), 1u);
  add(2, {1, 2, 0});
  expect_refusal([&] { match_sides(sides, points); },
                 {"cells 0, 1 and 2", "(0.333333, 0.333333, 0)"});
  CellSides same_way;
  same_way.add(0, std::array{0, 2, 1});
  same_way.add(1, std::array{2, 1, 0});
  expect_refusal([&] { match_sides(same_way, points); }, {"cells 0 and 1", "same side"});
  CellSides flat;
  flat.add(0, std::array{0, 2, 1});
  flat.add(0, std::array{0, 1, 2});
  expect_refusal([&] { match_sides(flat, points); }, {"cell 0", "twice"});
}

}  // namespace
}  // namespace fluxpact
