#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

TEST(Override, replaces_a_value_before_the_checks) {
  const Scene scene = read_scene(
      valid_scene, "s.yaml",
      {"coupling.window=2 ms", "particles.insertion[0].count=77",
       "fluid.boundaries.jet={type: velocity, superficial: [0, 0, 3]}", "scene.end_time=0.2"});
  EXPECT_EQ(scene.coupling.window, 2e-3);
  EXPECT_EQ(scene.particles.insertion.at(0).count, 77);
  EXPECT_EQ(scene.fluid.boundaries.at("jet").superficial.value(), Vector3(0, 0, 3));
  EXPECT_EQ(windows(scene), 100);
}

TEST(Override, adds_a_key_and_the_sections_around_it) {
  const Scene scene = read_scene(
      "version: 1\nscene: {name: a, end_time: 1}\ncoupling: {window: 1}\n"
      "fluid: {density: 1, viscosity: 1, mesh: {box: {upper: [1, 1, 1], cells: [1, 1, 1]}},\n"
      "        boundaries: {walls: {type: wall}}}\n",
      "s.yaml", {"output.fields.every=0.5"});
  EXPECT_EQ(scene.output.fields.every, 0.5);
}

TEST(Override, a_later_one_wins) {
  EXPECT_EQ(read_scene(valid_scene, "s.yaml", {"fluid.density=2", "fluid.density=3"}).fluid.density,
            3);
}

TEST(Override, errors_name_the_override) {
  expect_error(valid_scene, "--set fluid.density=-1: fluid.density: `-1` is out of range", {"> 0"},
               {"fluid.density=-1"});
  expect_error(valid_scene, "--set fluid.dnsity=1: fluid.dnsity: unknown key",
               {"nearest: `density`"}, {"fluid.dnsity=1"});
  expect_error(valid_scene, "--set particles.time_step=1: particles.time_step: 1 s is longer", {},
               {"particles.time_step=1"});
  expect_error(
      valid_scene,
      "--set particles.insertion[9].count=1: particles.insertion[9].count: [9] does not exist",
      {"3 entries"}, {"particles.insertion[9].count=1"});
  expect_error(valid_scene, "--set scene.name.x=1: scene.name.x: `x` cannot be set", {},
               {"scene.name.x=1"});
  expect_error(valid_scene, "--set fluid.density=[1: not valid YAML", {}, {"fluid.density=[1"});
  for (const char* text : {"", "=", "fluid", "=1", ".a=1", "a.=1", "a..b=1", "[0]=1", "a[=1",
                           "a[x]=1", "a[1=1", "a[0]]=1"}) {
    EXPECT_EQ(errors_in(valid_scene, {text}).substr(0, 6), "--set ")
        << text << ": " << errors_in(valid_scene, {text});
  }
}

}  // namespace
}  // namespace fluxpact
