// particles.surfaces: read, written, and what does not fit.
#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

std::string with_surfaces(const std::string& lines) {
  return with("  walls: from_mesh\n", "  walls: from_mesh\n  surfaces:\n" + lines);
}

TEST(SurfaceKeys, every_value_of_the_text_is_read_and_written) {
  const std::string text = with_surfaces(
      "    drum: {type: cylinder, point: [0, 0, 1 mm], direction: [0, 2, 0], radius: 0.1, length: "
      "20 mm, side: "
      "inside, material: steel, motion: {type: rotation, point: [1, 2, 3], direction: [0, 1, 0], "
      "rate: 6.28}}\n"
      "    base: {type: plane, point: [0, 0, 0], normal: [0, 0, 1], motion: {type: vibration, "
      "amplitude: [0, 0, 1 mm], frequency: 50 Hz, phase: 0.5}}\n"
      "    hopper: {type: cone, point: [0, 0, 0], direction: [0, 0, 1], radius: 0, end_radius: "
      "0.1, length: 0.2, motion: {type: translation, velocity: [0, 0, 1 cm/s]}}\n"
      "    blade: {type: stl, path: \"a b.stl\", scale: 1 mm}\n");
  const Scene scene = read_scene(write_scene(read_scene(text, "s.yaml")), "written");
  const auto& surfaces = scene.particles.surfaces;
  ASSERT_EQ(surfaces.size(), 4U);
  const SurfaceSettings& drum = surfaces[0].second;
  EXPECT_EQ(surfaces[0].first, "drum");
  EXPECT_EQ(drum.type, SurfaceType::cylinder);
  EXPECT_EQ(drum.point, Vector3(0, 0, 0.001));
  EXPECT_EQ(drum.direction, Vector3(0, 2, 0));
  EXPECT_EQ(drum.radius, 0.1);
  EXPECT_EQ(drum.length, 0.02);
  EXPECT_EQ(drum.side, SurfaceSide::inside);
  EXPECT_EQ(drum.material, "steel");
  EXPECT_EQ(drum.motion.type, MotionType::rotation);
  EXPECT_EQ(drum.motion.point, Vector3(1, 2, 3));
  EXPECT_EQ(drum.motion.direction, Vector3(0, 1, 0));
  EXPECT_EQ(drum.motion.rate, 6.28);
  const SurfaceSettings& base = surfaces[1].second;
  EXPECT_EQ(base.normal, Vector3(0, 0, 1));
  EXPECT_EQ(base.material, "walls");
  EXPECT_EQ(base.motion.amplitude, Vector3(0, 0, 0.001));
  EXPECT_EQ(base.motion.frequency, 50);
  EXPECT_EQ(base.motion.phase, 0.5);
  const SurfaceSettings& hopper = surfaces[2].second;
  EXPECT_EQ(hopper.end_radius, 0.1);
  EXPECT_EQ(hopper.length, 0.2);
  EXPECT_EQ(hopper.motion.velocity, Vector3(0, 0, 0.01));
  EXPECT_EQ(surfaces[3].second.path, "a b.stl");
  EXPECT_EQ(surfaces[3].second.scale, 1e-3);
  EXPECT_EQ(surfaces[3].second.motion.type, MotionType::none);
}

TEST(SurfaceKeys, what_does_not_fit_is_refused_where_it_stands) {
  expect_error(with_surfaces("    a: {type: plane, point: [0, 0, 0], normal: [0, 0, 0]}\n"),
               "s.yaml:45:", {"particles.surfaces.a.normal", "length 0"});
  expect_error(
      with_surfaces("    a: {type: cylinder, point: [0, 0, 0], direction: [0, 0, 0], radius: 1}\n"),
      "s.yaml:45:", {"particles.surfaces.a.direction", "length 0"});
  expect_error(
      with_surfaces("    a: {type: plane, point: [0, 0, 0], normal: [0, 0, 1], material: glas}\n"),
      "s.yaml:45:", {"particles.surfaces.a.material", "nearest: `glass`", "walls"});
  expect_error(
      with_surfaces("    a: {type: plane, point: [0, 0, 0], normal: [0, 0, 1], radius: 1}\n"),
      "s.yaml:45:", {"particles.surfaces.a.radius", "cylinder | cone"});
  expect_error(with_surfaces("    a: {type: cone, point: [0, 0, 0], direction: [0, 0, 1], radius: "
                             "1, end_radius: 2}\n"),
               "s.yaml:45:", {"particles.surfaces.a.length", "missing"});
  expect_error(with_surfaces("    a: {type: cone, point: [0, 0, 0], direction: [0, 0, 1], radius: "
                             "0, end_radius: 0, length: 1}\n"),
               "s.yaml:45:", {"particles.surfaces.a.radius", "no surface"});
  expect_error(with_surfaces("    a: {type: stl, path: a.stl, motion: {type: rotation, point: [0, "
                             "0, 0], direction: [0, 0, 0], rate: 1}}\n"),
               "s.yaml:45:", {"particles.surfaces.a.motion.direction", "length 0"});
  expect_error(with_surfaces("    a: {type: stl, path: a.stl, motion: {type: vibration, amplitude: "
                             "[0, 0, 1], frequency: 1 rad/s}}\n"),
               "s.yaml:45:", {"particles.surfaces.a.motion.frequency", "Hz"});
}

TEST(SurfaceKeys, kinematic_particles_and_prescribed_solids_have_none) {
  const std::string text =
      with_surfaces("    a: {type: plane, point: [0, 0, 0], normal: [0, 0, 1]}\n");
  expect_error(text, "s.yaml:44:", {"particles.surfaces", "kinematic"},
               {"particles.backend=kinematic"});
}

TEST(SurfaceKeys, surface_of_the_material_walls_needs_the_pairs_with_walls) {
  std::string text = replaced(
      valid_scene, "walls: from_mesh\n",
      "walls: none\n  surfaces: {a: {type: plane, point: [0, 0, 0], normal: [0, 0, 1]}}\n");
  EXPECT_EQ(errors_in(text), "");
  text = replaced(text, "      - {between: [glass, walls], normal_stiffness: 4000}\n", "");
  expect_error(text, "s.yaml:", {"between: [glass, walls]"});
}

}  // namespace
}  // namespace fluxpact
