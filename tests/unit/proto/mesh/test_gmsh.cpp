// Files of Gmsh: what the real program wrote is read as OpenFOAM's gmshToFoam and checkMesh read
// it; what is not supported or damaged is refused with its line.
#include "proto/mesh/gmsh.hpp"

#include "proto/mesh/mesh_quality.hpp"
#include "tests/unit/proto/mesh/mesh_files.hpp"

namespace fluxpact {
namespace {

/// Numbers of checkMesh (OpenFOAM 1912), which prints six digits.
struct Told {
  friend void PrintTo(const Told& told, std::ostream* out) { *out << told.name; }
  const char* name;
  int points, internal_faces, cells;
  double smallest_volume, largest_volume, total_volume;
  double largest_angle;
};

class GmshFiles : public testing::TestWithParam<Told> {};

TEST_P(GmshFiles, are_read_as_openfoam_reads_them) {
  const Told& told = GetParam();
  const Mesh mesh = with_geometry(read_gmsh(mesh_file(std::string(told.name) + ".msh"), 1));
  EXPECT_EQ(static_cast<int>(mesh.points.size()), told.points);
  EXPECT_EQ(mesh.internal_faces(), told.internal_faces);
  EXPECT_EQ(mesh.cells(), told.cells);
  constexpr double digits = 1e-5;
  const auto [least, most] = std::ranges::minmax_element(mesh.cell_volumes);
  EXPECT_NEAR(*least, told.smallest_volume, digits * told.smallest_volume);
  EXPECT_NEAR(*most, told.largest_volume, digits * told.largest_volume);
  EXPECT_NEAR(total_volume(mesh), told.total_volume, digits * told.total_volume);
  EXPECT_NEAR(measure_quality(mesh).non_orthogonality.value, told.largest_angle,
              digits * told.largest_angle);
}

INSTANTIATE_TEST_SUITE_P(
    Of, GmshFiles,
    testing::Values(Told{"tetrahedra", 142, 606, 368, 0.00254021, 0.0107831, 2, 34.4115},
                    Told{"mixed", 64, 203, 119, 0.00353299, 0.125, 2, 50.8},
                    Told{"prisms", 65, 117, 60, 0.150384, 0.24171, 11.5702, 17.878}),
    [](const auto& told) { return std::string(told.param.name); });

TEST(Gmsh, physical_surfaces_are_patches_and_the_rest_is_walls) {
  const Mesh mesh = with_geometry(read_gmsh(mesh_file("hexahedra.msh"), 1));
  EXPECT_EQ(mesh.cells(), 18);
  EXPECT_EQ(mesh.points.size(), 48u) << "the point of the geometry that no cell uses is left out";
  ASSERT_EQ(mesh.patches.size(), 4u);
  EXPECT_EQ(faces_of(mesh, "bottom"), 6);
  EXPECT_EQ(faces_of(mesh, "left"), 6);
  EXPECT_EQ(faces_of(mesh, "right"), 6);
  EXPECT_EQ(faces_of(mesh, "walls"), 24);
  const Patch* right = mesh.find_patch("right");
  for (int face = right->first; face < right->first + right->size; ++face) {
    EXPECT_NEAR(mesh.face_centres[face].x(), 1, 1e-12);
  }
}

TEST(Gmsh, a_scale_turns_the_units_of_the_file_into_metres) {
  const Mesh mesh = with_geometry(read_gmsh(mesh_file("tetrahedra.msh"), 1e-2));
  EXPECT_NEAR(total_volume(mesh), 2e-6, 1e-18);
  // Two cubes: the face between them is no patch.
  const Patch* outlet = mesh.find_patch("outlet");
  ASSERT_NE(outlet, nullptr);
  EXPECT_NEAR(mesh.face_centres[outlet->first].z(), 2e-2, 1e-12);
}

/// One tetrahedron whose base is the physical surface `base`.
const std::string one_cell = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
2 7 "base"
$EndPhysicalNames
$Entities
0 0 1 1
5 0 0 0 1 1 0 1 7 0
1 0 0 0 1 1 1 0 1 5
$EndEntities
$Nodes
1 4 10 40
3 1 0 4
10
20
30
40
0 0 0
1 0 0
0 1 0
0 0 1
$EndNodes
$Periodic
0
$EndPeriodic
$Elements
2 2 1 2
2 5 2 1
1 10 20 30
3 1 4 1
2 10 20 30 40
$EndElements
)";

MeshTopology read_text(const std::string& text) {
  const ScratchFolder folder;
  write_text(folder / "mesh.msh", text);
  return read_gmsh(folder / "mesh.msh", 1);
}

void expect_text_refused(const std::string& part, const std::string& by,
                         const std::vector<std::string>& words) {
  expect_refusal([&] { read_text(changed(one_cell, part, by)); }, words);
}

TEST(Gmsh, one_cell_has_a_base_and_three_walls) {
  const Mesh mesh = with_geometry(read_text(one_cell));
  EXPECT_NEAR(total_volume(mesh), 1.0 / 6, 1e-16);
  EXPECT_EQ(faces_of(mesh, "base"), 1);
  EXPECT_EQ(faces_of(mesh, "walls"), 3);
  EXPECT_EQ(faces_of(with_geometry(read_text(changed(one_cell, "2 7 \"base\"", "2 8 \"base\""))),
                     "physical_7"),
            1)
      << "a group without a name";
}

TEST(Gmsh, refuses_other_formats_with_the_command_that_helps) {
  expect_text_refused("4.1 0 8", "2.2 0 8", {"mesh.msh:2: ", "2.2", "-format msh41"});
  expect_text_refused("4.1 0 8", "4.1 1 8", {"mesh.msh:2: ", "binary", "ascii"});
  expect_text_refused("$MeshFormat", "solid", {"mesh.msh:1: "});
  expect_refusal([] { read_text(""); }, {"mesh.msh:1: "});
}

TEST(Gmsh, refuses_elements_that_are_no_cells_by_name) {
  expect_text_refused("3 1 4 1", "3 1 11 1", {"mesh.msh:32: ", "second order, 10 nodes"});
  expect_text_refused("2 5 2 1", "2 5 9 1", {"mesh.msh:30: ", "surface 5", "6 nodes"});
}

TEST(Gmsh, refuses_damage_with_its_line) {
  expect_text_refused("0 1 0\n", "0 one 0\n", {"mesh.msh:22: ", "`one`", "number"});
  expect_text_refused("0 1 0\n", "0 nan 0\n", {"mesh.msh:22: ", "finite"});
  expect_text_refused("1 4 10 40", "1 4000000000 10 40",
                      {"mesh.msh:14: ", "4000000000", "cut off"});
  expect_text_refused("2 10 20 30 40", "2 10 20 30 41", {"mesh.msh:33: ", "node 41"});
  expect_text_refused("\n20\n", "\n10\n", {"node 10", "second time"});
  expect_text_refused("$EndElements\n", "", {"the end of the file"});
  expect_text_refused("$EndPeriodic\n", "", {"$Periodic", "does not end"});
}

TEST(Gmsh, refuses_a_file_without_volumes) {
  expect_text_refused("3 1 4 1\n2 10 20 30 40", "3 1 4 0", {"no volume elements", "gmsh -3"});
}

TEST(Gmsh, refuses_a_surface_in_two_groups) {
  expect_text_refused("0 0 0 1 1 0 1 7 0", "0 0 0 1 1 0 2 7 8 0", {"surface 5", "7 and 8"});
}

TEST(Gmsh, refuses_a_patch_that_is_no_boundary) {
  // A second tetrahedron behind the base, then a face that has no cell.
  std::string twins = changed(one_cell, "1 4 10 40", "1 5 10 50");
  twins = changed(twins, "3 1 0 4\n", "3 1 0 5\n");
  twins = changed(twins, "40\n0 0 0\n", "40\n50\n0 0 0\n");
  twins = changed(twins, "0 0 1\n$EndNodes", "0 0 1\n0 0 -1\n$EndNodes");
  twins = changed(twins, "3 1 4 1\n2 10 20 30 40", "3 1 4 2\n2 10 20 30 40\n3 10 30 20 50");
  expect_refusal([&] { read_text(twins); },
                 {"1 faces", "base (surface 5)", "(0.333333, 0.333333, 0)", "between two cells"});
  expect_refusal([&] { read_text(changed(twins, "1 10 20 30\n", "1 10 40 50\n")); },
                 {"base (surface 5)", "belongs to no cell"});
  expect_refusal([&] { read_text(changed(twins, "3 10 30 20 50", "3 10 20 30 50")); },
                 {"cells 0 and 1", "same side", "(0.333333, 0.333333, 0)"});
}

TEST(Gmsh, refuses_a_node_in_a_volume_that_no_cell_uses) {
  std::string text = changed(one_cell, "1 4 10 40", "1 5 10 50");
  text = changed(text, "3 1 0 4\n", "3 1 0 5\n");
  text = changed(text, "40\n0 0 0\n", "40\n50\n0 0 0\n");
  text = changed(text, "0 0 1\n$EndNodes", "0 0 1\n3 3 3\n$EndNodes");
  expect_refusal([&] { with_geometry(read_text(text)); },
                 {"1 point is on no face", "point 4 at (3, 3, 3) m"});
}

TEST(Gmsh, refuses_a_cell_inside_out) {
  expect_refusal(
      [] { with_geometry(read_text(changed(one_cell, "2 10 20 30 40", "2 10 30 20 40"))); },
      {"1 cell has no positive volume", "cell 0 at (0.25, 0.25, 0.25) m", "-0.167"});
}

}  // namespace
}  // namespace fluxpact
