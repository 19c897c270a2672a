// fluid.scalars and fluid.turbulence: what is read, and what must fit together.
#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

const std::string scalars = R"(  scalars:
    tracer:
      diffusivity: 2e-5 m2/s
      initial: "z < 0.1 ? 1 : 0"
      source: 0.5
      convection: upwind
      tolerance: 1e-6
      boundaries:
        inlet: {value: "1 + t"}
        outlet: {value: 0}
    heat:
      kind: temperature
      conductivity: 0.026
      heat_capacity: 1005
      initial: 300
      boundaries:
        jet: {value: 350}
        walls: {flux: 500}
  turbulence:
    model: k_epsilon
    kinetic_energy: 0.1
    dissipation: 3
    schmidt_number: 0.9
    inlets:
      jet: {intensity: 0.1, length_scale: 2 mm}
      inlet: {length_scale: 1 mm}
)";

std::string with_scalars() {
  return with("particles:\n  backend: native\n", scalars + "particles:\n  backend: native\n");
}

std::string but(const std::string& old_part, const std::string& new_part) {
  return replaced(with_scalars(), old_part, new_part);
}

TEST(SceneScalars, gives_every_value_of_the_text) {
  const Scene s = read_scene(with_scalars(), "s.yaml");
  ASSERT_EQ(s.fluid.scalars.size(), 2U);
  const ScalarSettings& tracer = s.fluid.scalars.at("tracer");
  EXPECT_EQ(tracer.kind, ScalarKind::species);
  EXPECT_EQ(tracer.diffusivity, 2e-5);
  EXPECT_EQ(tracer.initial.text, "z < 0.1 ? 1 : 0");
  EXPECT_EQ(tracer.source, Formula(0.5));
  EXPECT_EQ(tracer.convection, Convection::upwind);
  EXPECT_EQ(tracer.tolerance, 1e-6);
  EXPECT_EQ(tracer.boundaries.at("inlet").value->text, "1 + t");
  EXPECT_EQ(tracer.boundaries.at("outlet").value, Formula(0));
  const ScalarSettings& heat = s.fluid.scalars.at("heat");
  EXPECT_EQ(heat.kind, ScalarKind::temperature);
  EXPECT_EQ(heat.conductivity, 0.026);
  EXPECT_EQ(heat.heat_capacity, 1005);
  EXPECT_EQ(heat.boundaries.at("walls").flux, Formula(500));
  EXPECT_FALSE(heat.boundaries.at("walls").value.has_value());
  const TurbulenceSettings& turbulence = s.fluid.turbulence;
  EXPECT_EQ(turbulence.model, TurbulenceModel::k_epsilon);
  EXPECT_EQ(turbulence.kinetic_energy, 0.1);
  EXPECT_EQ(turbulence.dissipation, 3);
  EXPECT_EQ(turbulence.schmidt_number, 0.9);
  EXPECT_EQ(turbulence.inlets.at("jet").intensity, 0.1);
  EXPECT_EQ(turbulence.inlets.at("inlet").length_scale, 1e-3);
}

TEST(SceneScalars, come_back_from_the_resolved_scene) {
  const std::string once = write_scene(read_scene(with_scalars(), "s.yaml"));
  EXPECT_EQ(write_scene(read_scene(once, "again")), once);
  EXPECT_NE(once.find("conductivity: 0.026"), std::string::npos);
}

TEST(SceneScalars, are_none_by_default_and_turbulence_is_off) {
  const Scene s = read_scene(valid_scene, "s.yaml");
  EXPECT_TRUE(s.fluid.scalars.empty());
  EXPECT_EQ(s.fluid.turbulence.model, TurbulenceModel::none);
}

TEST(SceneScalars, need_what_their_kind_needs) {
  expect_error(but("      conductivity: 0.026\n", ""),
               "s.yaml:39:5: fluid.scalars.heat.conductivity: missing", {"kind: temperature"});
  expect_error(but("diffusivity: 2e-5 m2/s", "heat_capacity: 3\n      diffusivity: 1"),
               "s.yaml:31:7: fluid.scalars.tracer.heat_capacity: has no meaning here",
               {"kind: temperature"});
}

TEST(SceneScalars, have_one_condition_on_a_patch_of_the_fluid) {
  expect_error(but("walls: {flux: 500}", "wals: {flux: 500}"),
               "s.yaml:46:9: fluid.scalars.heat.boundaries.wals: no such patch", {"`walls`"});
  expect_error(but("walls: {flux: 500}", "walls: {flux: 500, value: 3}"),
               "s.yaml:46:9: fluid.scalars.heat.boundaries.walls: `value` and `flux`", {});
  expect_error(but("jet: {value: 350}", "jet: {flux: 350}"),
               "s.yaml:45:21: fluid.scalars.heat.boundaries.jet.flux: has a meaning on walls only",
               {"velocity"});
}

TEST(SceneTurbulence, of_k_epsilon_needs_its_inlets) {
  expect_error(but("      inlet: {length_scale: 1 mm}\n", ""),
               "s.yaml:52:5: fluid.turbulence.inlets.inlet: missing", {"intensity"});
  expect_error(but("      inlet: {length_scale: 1 mm}",
                   "      inlet: {length_scale: 1 mm}\n      walls: {length_scale: 1 mm}"),
               "s.yaml:55:7: fluid.turbulence.inlets.walls: the patch is of type wall", {});
  expect_error(but("model: k_epsilon", "model: smagorinsky"),
               "s.yaml:49:5: fluid.turbulence.kinetic_energy: has no meaning here", {});
}

}  // namespace
}  // namespace fluxpact
