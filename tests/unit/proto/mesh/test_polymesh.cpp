// Folders polyMesh: what OpenFOAM wrote is read with the geometry that its checkMesh tells; every
// form of its lists; refusals with file and line.
#include "proto/mesh/polymesh.hpp"

#include "proto/mesh/mesh_quality.hpp"
#include "tests/unit/proto/mesh/mesh_files.hpp"

namespace fluxpact {
namespace {

constexpr std::array<const char*, 5> file_names{"points", "faces", "owner", "neighbour",
                                                "boundary"};

/// A copy of a folder of the fixtures, to be changed.
class PolyMesh : public testing::Test {
 protected:
  void copy(const std::string& name) {
    for (const char* file : file_names) {
      write_text(folder_ / file, text_of(mesh_file(name) / file));
    }
  }
  void change(const std::string& file, const std::string& part, const std::string& by) {
    write_text(folder_ / file, changed(text_of(folder_ / file), part, by));
  }
  Mesh read() const { return with_geometry(read_polymesh(folder_.path(), 1)); }
  void expect_refused(const std::vector<std::string>& words) {
    expect_refusal([&] { read(); }, words);
  }

  ScratchFolder folder_;
};

TEST_F(PolyMesh, of_polyhedra_has_the_geometry_that_openfoam_tells) {
  copy("polyhedra");
  const Mesh mesh = read();
  EXPECT_EQ(mesh.cells(), 45);
  EXPECT_EQ(mesh.points.size(), 300u);
  EXPECT_EQ(faces_of(mesh, "inlet"), 24);
  EXPECT_NEAR(total_volume(mesh), 1, 1e-5);  // checkMesh prints six digits
  // The faces are warped by up to some per cent of their size, and OpenFOAM weights their triangles
  // by their own areas, not by their part along the area vector: a second-order effect.
  constexpr double warp = 3e-3;
  const auto [least, most] = std::ranges::minmax_element(mesh.cell_volumes);
  EXPECT_NEAR(*least, 0.00703695, warp * 0.00703695);
  EXPECT_NEAR(*most, 0.172381, warp * 0.172381);
  EXPECT_NEAR(measure_quality(mesh).non_orthogonality.value, 27.2318, warp * 27);
}

TEST_F(PolyMesh, of_a_box_is_recognised_as_a_graded_lattice) {
  copy("graded_cyclic");
  const Mesh mesh = read();
  ASSERT_TRUE(mesh.lattice.has_value());
  EXPECT_TRUE(mesh.lattice->periodic[0]);
  const std::vector<double> expected{0, 0.01, 0.05, 0.09, 0.1};
  ASSERT_EQ(mesh.lattice->nodes[0].size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(mesh.lattice->nodes[0][i], expected[i], 1e-12);
}

TEST_F(PolyMesh, cyclic_patches_are_one_layer_of_internal_faces) {
  copy("graded_cyclic");
  const Mesh mesh = read();
  EXPECT_EQ(mesh.internal_faces(), 162 + 18);
  EXPECT_EQ(mesh.patches.size(), 3u);
  ASSERT_EQ(mesh.periodic_faces.size(), 18u);
  for (std::size_t i = 0; i < 18; ++i) {
    EXPECT_NEAR(std::abs(mesh.translations[i].x()), 0.1, 1e-15);
    EXPECT_NEAR(mesh.delta[mesh.periodic_faces[i]].norm(), 0.01, 1e-12);  // two cells of 0.01
  }
}

TEST_F(PolyMesh, cyclic_points_of_few_digits_are_brought_together) {
  copy("graded_cyclic");
  change("points", "(0.1 0.1 0)", "(0.100001 0.099999 0)");
  EXPECT_EQ(read().periodic_faces.size(), 18u);
  change("points", "(0.100001 0.099999 0)", "(0.1 0.095 0)");
  expect_refused({"left", "right", "no partner"});
}

TEST_F(PolyMesh, comments_and_lists_without_their_length_are_read) {
  copy("graded_cyclic");
  change("points", "140\n(", "// points\n( /* none\n left out */");
  change("owner", "270\n(", "(");
  EXPECT_EQ(read().cells(), 72);
}

TEST_F(PolyMesh, compact_faces_and_uniform_lists_are_read) {
  const std::string head = "FoamFile { version 2.0; format ascii; class labelList; object x; }\n";
  write_text(folder_ / "points", head + "4((0 0 0)(1 0 0)(0 1 0)(0 0 1))");
  write_text(folder_ / "faces",
             "FoamFile { format ascii; class faceCompactList; }\n"
             "5(0 3 6 9 12) 12(0 2 1 0 1 3 1 2 3 0 3 2)");
  write_text(folder_ / "owner", head + "4{0}");
  write_text(folder_ / "neighbour", head + "0()");
  write_text(folder_ / "boundary",
             head +
                 "2(none { type wall; nFaces 0; startFace 0; } all { type empty; inGroups "
                 "List<word> 1(wall); sub { a b; } nFaces 4; startFace 0; })");
  const Mesh mesh = read();
  EXPECT_NEAR(mesh.cell_volumes[0], 1.0 / 6, 1e-16);
  ASSERT_EQ(mesh.patches.size(), 1u) << "a patch without a face is left out";
  EXPECT_EQ(faces_of(mesh, "all"), 4);
  write_text(folder_ / "owner", head + "2000000000{0}");
  expect_refused({"owner:2: ", "2000000000 owners"});
}

TEST_F(PolyMesh, neighbours_of_old_versions_end_with_minus_one) {
  copy("graded_cyclic");
  change("neighbour", "162\n(", "(");
  change("neighbour", "71\n)", "71\n-1 -1 -1)");
  EXPECT_EQ(read().internal_faces(), 180);
}

TEST_F(PolyMesh, refuses_what_is_not_ascii_with_the_command_that_helps) {
  copy("graded_cyclic");
  change("faces", "ascii", "binary");
  expect_refused({"faces:15: ", "binary", "foamFormatConvert"});
  std::filesystem::rename(folder_ / "faces", folder_ / "faces.gz");
  expect_refused({"faces.gz: compressed", "gunzip"});
  std::filesystem::remove(folder_ / "faces.gz");
  expect_refused({"faces: no such file", "points, faces, owner"});
}

TEST_F(PolyMesh, a_case_folder_is_told_its_polymesh) {
  std::filesystem::create_directories(folder_ / "constant/polyMesh");
  write_text(folder_ / "constant/polyMesh/points", "x");
  expect_refused({"points: no such file", "give ", "constant/polyMesh"});
}

TEST_F(PolyMesh, refuses_damage_with_its_line) {
  copy("graded_cyclic");
  change("points", "(0.05 0 0)", "(0.05 0)");
  expect_refused({"points:23: ", "`)`", "number"});
  copy("graded_cyclic");
  change("points", "140\n(", "141\n(");
  expect_refused({"points:", "141 points are announced, 140 are there"});
  copy("graded_cyclic");
  change("faces", "4(", "2(");
  expect_refused({"faces:21: ", "2 points"});
  copy("graded_cyclic");
  change("owner", "FoamFile", "FromFile");
  expect_refused({"owner:8: ", "`FromFile`"});
  copy("graded_cyclic");
  change("faces", "(1 6 26 21)", "(1 6 26 2100)");
  expect_refused({"point 2100 of 140"});
  copy("graded_cyclic");
  change("boundary", "startFace       198", "startFace       199");
  expect_refused({"'inlet'", "starts at 198"});
  copy("graded_cyclic");
  change("boundary", "startFace       198;", "");
  expect_refused({"boundary:", "patch inlet has no startFace"});
}

TEST_F(PolyMesh, refuses_couplings_that_are_not_supported_by_name) {
  copy("graded_cyclic");
  change("boundary", "type            patch", "type            processor");
  expect_refused({"boundary:", "patch inlet", "processor", "reconstructParMesh"});
  change("boundary", "type            processor", "type            cyclicAMI");
  expect_refused({"patch inlet", "cyclicAMI"});
  copy("graded_cyclic");
  change("boundary", "transform       unknown", "transform       rotational");
  expect_refused({"patch left", "rotational"});
  copy("graded_cyclic");
  change("boundary", "neighbourPatch  right", "neighbourPatch  inlet");
  expect_refused({"left", "inlet"});
}

TEST_F(PolyMesh, names_open_cells_with_their_place) {
  copy("graded_cyclic");
  // The first face joins cells 0 and 1 at x = 0.01: turned over, both are open.
  change("faces", "(1 6 26 21)", "(21 26 6 1)");
  expect_refused({"2 cells are open", "cell 0 at (0.005,", "cell 1 at (0.03,"});
}

TEST_F(PolyMesh, names_unused_points) {
  copy("graded_cyclic");
  change("points", "140\n(", "142\n(");
  change("points", "(0.1 0.1 0.2)\n", "(0.1 0.1 0.2)\n(7 8 9)\n(7 8 10)\n");
  expect_refused(
      {"2 points are on no face", "point 140 at (7, 8, 9) m; point 141 at (7, 8, 10) m"});
}

}  // namespace
}  // namespace fluxpact
