#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

std::vector<std::filesystem::path> configs() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(
           std::filesystem::path(FLUXPACT_SOURCE_DIR) / "configs")) {
    if (entry.path().extension() == ".yaml") {
      paths.push_back(entry.path());
    }
  }
  return paths;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(ReadScene, gives_every_value_of_the_text) {
  const Scene s = read_scene(valid_scene, "s.yaml");
  EXPECT_EQ(s.scene.name, "test");
  EXPECT_EQ(s.scene.gravity, Vector3(0, 0, -9.81));
  EXPECT_EQ(s.scene.end_time, 0.1);
  EXPECT_EQ(s.coupling.window, 1e-3);
  EXPECT_EQ(s.coupling.audit.limit, 1e-10);
  EXPECT_EQ(s.fluid.viscosity, 1.8e-5);
  EXPECT_EQ(s.fluid.mesh.box.upper, Vector3(0.1, 0.1, 0.2));
  EXPECT_EQ(s.fluid.mesh.box.cells, (std::array{4, 4, 8}));
  EXPECT_EQ(s.fluid.mesh.periodic, std::vector{Axis::y});
  ASSERT_EQ(s.fluid.mesh.patches.size(), 3U);
  EXPECT_EQ(s.fluid.mesh.patches[0].first,
            "jet");  // the order of the file decides which patch a face gets
  EXPECT_EQ(s.fluid.mesh.patches[0].second.within.x, (std::array{0.04, 0.06}));
  EXPECT_FALSE(s.fluid.mesh.patches[0].second.within.y.has_value());
  EXPECT_EQ(s.fluid.mesh.patches[2].second.side, Side::z_max);
  EXPECT_EQ(s.fluid.boundaries.at("jet").interstitial.value(), Vector3(0, 0, 5));
  EXPECT_FALSE(s.fluid.boundaries.at("jet").superficial.has_value());
  EXPECT_EQ(s.fluid.boundaries.at("inlet").rate, 0.001);
  EXPECT_EQ(s.fluid.boundaries.at("outlet").value, 10);
  EXPECT_EQ(s.fluid.boundaries.at("walls").slip, Slip::free);
  EXPECT_EQ(s.fluid.initial.superficial, Vector3(0, 0, 1));
  EXPECT_EQ(s.fluid.numerics.convection, Convection::upwind);
  EXPECT_EQ(s.fluid.numerics.correctors, 3);
  EXPECT_EQ(s.fluid.numerics.pressure_tolerance, 1e-5);
  EXPECT_EQ(s.fluid.numerics.solver, LinearSolverChoice::multigrid);
  EXPECT_EQ(s.fluid.numerics.legacy.tolerance, 1e-3);
  EXPECT_EQ(s.fluid.numerics.legacy.iterations, 7);
  EXPECT_EQ(s.fluid.numerics.legacy.velocity, LegacyVelocity::cells);
  EXPECT_EQ(s.particles.time_step, 1e-4);
  EXPECT_EQ(s.particles.materials.at("steel").density, 7800);
  ASSERT_EQ(s.particles.contact.pairs.size(), 5U);
  EXPECT_EQ(s.particles.contact.pairs[1].between, (std::array<std::string, 2>{"steel", "glass"}));
  EXPECT_EQ(s.particles.contact.pairs[0].normal_stiffness, 1000);
  EXPECT_EQ(s.particles.contact.pairs[1].tangential_stiffness, 500);
  EXPECT_EQ(s.particles.contact.pairs[0].restitution, 0.8);
  EXPECT_EQ(s.particles.contact.pairs[0].friction, 0.2);
  ASSERT_EQ(s.particles.insertion.size(), 3U);
  EXPECT_EQ(s.particles.insertion[0].diameter, 2e-3);
  EXPECT_EQ(s.particles.insertion[0].seed, 3);
  EXPECT_EQ(s.particles.insertion[0].velocity, Vector3(0, 0, 1));
  EXPECT_EQ(s.particles.insertion[0].within.z, (std::array{0.0, 0.1}));
  EXPECT_EQ(s.particles.insertion[1].type, InsertionType::lattice);
  EXPECT_EQ(s.particles.insertion[2].path, "bed.csv");
  EXPECT_EQ(s.particles.numerics.threads, 2);
  EXPECT_EQ(s.interphase.voidage.map, VoidageMap::centroid);
  EXPECT_EQ(s.interphase.drag, DragLaw::wen_yu);
  EXPECT_TRUE(s.interphase.forces.empty());
  EXPECT_EQ(s.output.directory, "runs/elsewhere");
  EXPECT_EQ(s.output.fields.every, 0.01);
  EXPECT_EQ(s.output.particles.every, 0.02);
  EXPECT_EQ(s.launch.mode, LaunchMode::external);
  EXPECT_EQ(s.launch.listen, "tcp://127.0.0.1:5555");
  EXPECT_EQ(s.launch.deadline, 20);
  EXPECT_EQ(s.launch.start_deadline, 10);
}

TEST(ReadScene, fills_in_the_defaults_that_follow_from_other_values) {
  const Scene scene = read_scene(with("  directory: runs/elsewhere\n", ""), "s.yaml");
  EXPECT_EQ(scene.output.directory, "runs/test");
  EXPECT_EQ(scene.particles.contact.pairs.at(0).tangential_stiffness.value(), 2.0 / 7.0 * 1000);
  EXPECT_EQ(scene.particles.insertion.at(1).spacing, 1.001 * 0.003);
}

TEST(WriteScene, is_read_back_and_written_the_same) {
  const std::string written = write_scene(read_scene(valid_scene, "s.yaml"));
  EXPECT_EQ(write_scene(read_scene(written, "written")), written);
  for (const char* line : {"      interstitial: [0, 0, 5]\n", "    jet:\n", "    - type: packing\n",
                           "      spacing: 0.0030029999999999996\n", "  continuity: conservative\n",
                           "  forces: []\n", "  listen: \"tcp://127.0.0.1:5555\"\n"}) {
    EXPECT_NE(written.find(line), std::string::npos) << line << "not in:\n" << written;
  }
}

TEST(ReadScene, takes_formulas_where_a_value_may_vary) {
  const std::string text = with("interstitial: [0, 0, 5]",
                                "superficial: [0, 5 cm/s, \"t < 1 ? t : 1\"], ramp: 20 ms, "
                                "profile: [{along: x, points: [[0, 0], [0.1, 1.5]]}]");
  const Scene scene = read_scene(write_scene(read_scene(text, "s.yaml")), "written");
  const BoundarySettings& jet = scene.fluid.boundaries.at("jet");
  const auto& velocity = jet.superficial->components;
  EXPECT_EQ(velocity[0], Formula(0.0));
  EXPECT_EQ(velocity[1], Formula(0.05));
  EXPECT_EQ(velocity[2].text, "t < 1 ? t : 1");
  EXPECT_EQ(jet.ramp, 0.02);
  ASSERT_EQ(jet.profile.size(), 1U);
  EXPECT_EQ(jet.profile[0].along, Along::x);
  EXPECT_EQ(jet.profile[0].points, (std::vector<std::array<double, 2>>{{0, 0}, {0.1, 1.5}}));
}

TEST(ReadScene, says_why_a_formula_or_a_table_is_none) {
  expect_error(
      with("interstitial: [0, 0, 5]", "interstitial: [0, 0, 5 lightyears]"),
      "s.yaml:23:48: fluid.boundaries.jet.interstitial[2]: `5 lightyears` is neither a number",
      {"nor a formula"});
  expect_error(with("interstitial: [0, 0, 5]",
                    "interstitial: [0, 0, 5], profile: [{along: x, points: [[0, 0], [0, 1]]}]"),
               "s.yaml:23:90: fluid.boundaries.jet.profile[0].points[1]: 0 does not lie above 0 of "
               "the row before",
               {});
}

TEST(ReadScene, takes_a_map_alone_or_with_its_options) {
  const auto voidage = [](const std::string& text) {
    const Scene scene = read_scene(with("voidage: centroid", "voidage: " + text), "s.yaml");
    return read_scene(write_scene(scene), "written").interphase.voidage;
  };
  EXPECT_EQ(voidage("satellite").map, VoidageMap::satellite);
  EXPECT_EQ(voidage("satellite").points, 32);
  EXPECT_EQ(voidage("{map: satellite, points: 50}").points, 50);
  EXPECT_EQ(voidage("kernel").width, 0);
  EXPECT_EQ(voidage("{map: kernel, width: 8 mm}").width, 0.008);
  const VoidageSettings diffusion = voidage("{map: diffusion, width: 6 mm, from: centroid}");
  EXPECT_EQ(diffusion.width, 0.006);
  EXPECT_EQ(diffusion.from, DiffusedMap::centroid);
  EXPECT_EQ(voidage("{smallest: 0.3}").smallest, 0.3);
  EXPECT_EQ(voidage("{smallest: 0.3}").map, VoidageMap::exact);
  expect_error(with("voidage: centroid", "voidage: diffusion"),
               "s.yaml:50:12: interphase.voidage.width: missing; required with `map: kernel | ",
               {});
  expect_error(with("voidage: centroid", "voidage: exat"),
               "s.yaml:50:12: interphase.voidage.map: ", {"`exat`", "nearest: `exact`"});
  expect_error(with("voidage: centroid", "voidage: {map: exact, width: 1 mm}"),
               "s.yaml:50:25: interphase.voidage.width: has no meaning here", {});
}

TEST(WriteScene, keeps_graded_boxes_and_meshes_of_files) {
  const std::string box = "box: {lower: [0, 0, 0], upper: [0.1, 0.1, 0.2], cells: [4, 4, 8]";
  Scene scene = read_scene(
      with(box, box + ", grading: {x: [{length: 0.2, cells: 0.5, ratio: 4}, {}]}"), "s.yaml");
  Scene again = read_scene(write_scene(scene), "written");
  ASSERT_EQ(again.fluid.mesh.box.grading.x.size(), 2U);
  EXPECT_EQ(again.fluid.mesh.box.grading.x[0].length, 0.2);
  EXPECT_EQ(again.fluid.mesh.box.grading.x[0].cells, 0.5);
  EXPECT_EQ(again.fluid.mesh.box.grading.x[0].ratio, 4);
  EXPECT_EQ(again.fluid.mesh.box.grading.x[1].ratio, 1);
  EXPECT_TRUE(again.fluid.mesh.box.grading.y.empty());

  scene = Scene();
  scene.scene.name = "file";
  scene.scene.end_time = scene.coupling.window = 1;
  scene.fluid.density = scene.fluid.viscosity = 1;
  scene.fluid.mesh.gmsh = MeshFileSettings{"/a b/c.msh", 1e-3, {{{"left", "right"}}}};
  again = read_scene(write_scene(scene), "written");
  EXPECT_FALSE(again.fluid.mesh.is_box());
  EXPECT_FALSE(again.fluid.mesh.polymesh.has_value());
  EXPECT_EQ(again.fluid.mesh.gmsh->path, "/a b/c.msh");
  EXPECT_EQ(again.fluid.mesh.gmsh->scale, 1e-3);
  ASSERT_EQ(again.fluid.mesh.gmsh->periodic.size(), 1U);
  EXPECT_EQ(again.fluid.mesh.gmsh->periodic[0].patches[1], "right");
}

TEST(WriteScene, keeps_a_given_zero_apart_from_nothing_given) {
  const Scene scene = read_scene(with("interstitial: [0, 0, 5]", "interstitial: [0, 0, 0]"),
                                 "s.yaml", {"particles.contact.pairs[1].tangential_stiffness=0"});
  const Scene again = read_scene(write_scene(scene), "written");
  EXPECT_EQ(again.fluid.boundaries.at("jet").interstitial.value(), Vector3(0, 0, 0));
  EXPECT_EQ(again.particles.contact.pairs.at(1).tangential_stiffness, 0);
}

TEST(WriteScene, keeps_the_order_of_patches_and_any_text) {
  Scene scene = read_scene(valid_scene, "s.yaml");
  scene.output.directory = "a \"quoted\" \\ back: slash # ümlaut 'x' {y}";
  std::swap(scene.fluid.mesh.patches[0], scene.fluid.mesh.patches[2]);
  const Scene again = read_scene(write_scene(scene), "written");
  EXPECT_EQ(again.output.directory, scene.output.directory);
  EXPECT_EQ(again.fluid.mesh.patches.at(0).first, "outlet");
}

TEST(WriteScene, keeps_every_double_bit_for_bit) {
  const Scene base = read_scene(valid_scene, "s.yaml");
  EXPECT_TRUE(rc::check("write, then read", [&] {
    // All bits from the first round on: the default sizes begin with few, which are subnormal
    // numbers.
    const auto any_bits = rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>());
    const auto number = std::bit_cast<double>(*any_bits);
    const auto other = std::bit_cast<double>(*any_bits);
    RC_PRE(std::isfinite(number) && std::isfinite(other) && other != 0);
    Scene scene = base;
    scene.scene.gravity = Vector3(number, -number, other);
    scene.fluid.boundaries["inlet"].rate = number;
    scene.fluid.boundaries["outlet"].value = other;
    scene.fluid.density = std::abs(other);
    scene.particles.contact.pairs[0].tangential_stiffness = std::abs(number);
    const Scene again = read_scene(write_scene(scene), "written");
    const auto same = [](double a, double b) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    };
    RC_ASSERT(same(again.scene.gravity[0], number));
    RC_ASSERT(same(again.scene.gravity[1], -number));
    RC_ASSERT(same(again.scene.gravity[2], other));
    RC_ASSERT(same(again.fluid.boundaries.at("inlet").rate->number, number));
    RC_ASSERT(same(again.fluid.boundaries.at("outlet").value.number, other));
    RC_ASSERT(same(again.fluid.density, std::abs(other)));
    RC_ASSERT(
        same(again.particles.contact.pairs[0].tangential_stiffness.value(), std::abs(number)));
  }));
}

TEST(Configs, are_read_and_written_the_same) {
  const std::vector<std::filesystem::path> paths = configs();
  EXPECT_GE(paths.size(), 4U);
  for (const std::filesystem::path& path : paths) {
    const Scene scene = read_scene(content(path), path.string());
    const std::string written = write_scene(scene);
    EXPECT_EQ(write_scene(read_scene(written, "written")), written) << path;
    EXPECT_GT(windows(scene), 0) << path;
  }
}

}  // namespace
}  // namespace fluxpact
