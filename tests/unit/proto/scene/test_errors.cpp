// Each kind of mistake in a scene: its exact place, the key, and what helps.
#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

TEST(SceneErrors, none_in_the_valid_scene) { EXPECT_EQ(errors_in(valid_scene), ""); }

TEST(SceneErrors, unknown_key_names_the_nearest_and_the_allowed_ones) {
  expect_error(with("  drag: wen_yu", "  drga: wen_yu"),
               "s.yaml:51:3: interphase.drga: unknown key",
               {"nearest: `drag`",
                "allowed here: model, voidage, drag, syamlal_obrien, drag_expression, "
                "self_disturbance, forces"});
  expect_error(with("interphase:", "weather: fine\ninterphase:"),
               "s.yaml:49:1: weather: unknown key", {"launch"});
}

TEST(SceneErrors, equal_keys) {
  expect_error(with("  window: 1.0e-3", "  window: 1.0e-3\n  window: 2.0e-3"),
               "s.yaml:8:3: coupling.window: ", {"second time"});
  expect_error(
      with("    steel: {density: 7800}", "    steel: {density: 7800}\n    glass: {density: 1}"),
      "s.yaml:35:5: particles.materials.glass: ", {"second time"});
}

TEST(SceneErrors, missing_required_key_points_at_its_section) {
  expect_error(with("  viscosity: 1.8e-5\n", ""), "s.yaml:11:1: fluid.viscosity: missing; required",
               {"a number in Pa.s, > 0"});
  expect_error(with(", count: 10", ""), "s.yaml:45:7: particles.insertion[0]: none is given",
               {"exactly one of `count`, `fraction`, `number_density`"});
  expect_error(with(", rate: 0.001", ""), "s.yaml:24:5: fluid.boundaries.inlet.rate: missing",
               {"`type: mass_flow`"});
}

TEST(SceneErrors, wrong_type) {
  expect_error(with("density: 1.225", "density: heavy"),
               "s.yaml:13:12: fluid.density: `heavy`: not a number", {"kg/m3"});
  expect_error(with("density: 1.225", "density: \"1.225\""),
               "s.yaml:13:12: fluid.density: the text \"1.225\"", {"number"});
  expect_error(with("density: 1.225", "density: [1.225]"),
               "s.yaml:13:12: fluid.density: a list where", {"number"});
  expect_error(with("density: 1.225", "density:"), "s.yaml:13:3: fluid.density: no value where",
               {"number"});
  expect_error(with("cells: [4, 4, 8]", "cells: [4, 4]"),
               "s.yaml:16:60: fluid.mesh.box.cells: a list of 2", {"list of 3 whole numbers"});
  expect_error(with("cells: [4, 4, 8]", "cells: [4, 4.5, 8]"),
               "s.yaml:16:64: fluid.mesh.box.cells[1]: `4.5`", {"whole"});
  expect_error(with("cells: [4, 4, 8]", "cells: {x: 4}"),
               "s.yaml:16:60: fluid.mesh.box.cells: a section", {"list"});
  expect_error(with("  audit: {limit: 1.0e-10, on_violation: stop}", "  audit: 1"),
               "s.yaml:10:10: coupling.audit: `1` where a section", {});
  expect_error(with("    glass: {density: 2250}\n    steel: {density: 7800}\n", "    - glass\n"),
               "s.yaml:33:5: particles.materials: a list where sections by name", {});
}

TEST(SceneErrors, wrong_choice_names_the_nearest_and_all) {
  expect_error(with("drag: wen_yu", "drag: gidaspov"), "s.yaml:51:9: interphase.drag: `gidaspov`",
               {"nearest: `gidaspow`", "none, gidaspow, ergun, wen_yu, stokes"});
  expect_error(with("scheme: serial", "scheme: yes"),
               "s.yaml:8:11: coupling.scheme: `yes` is none of serial, parallel", {});
  expect_error(with("periodic: [y]", "periodic: [y, y]"),
               "s.yaml:17:19: fluid.mesh.periodic[1]: `y`", {"second time"});
  expect_error(with("periodic: [y]", "periodic: y"),
               "s.yaml:17:15: fluid.mesh.periodic: `y` where a list", {"[x]"});
}

TEST(SceneErrors, out_of_range) {
  expect_error(with("density: 1.225", "density: 0"),
               "s.yaml:13:12: fluid.density: `0` is out of range", {"> 0"});
  expect_error(with("restitution: 0.8", "restitution: 1.1"),
               "s.yaml:38:72: particles.contact.pairs[0].restitution: ", {"> 0 and <= 1"});
  expect_error(with("cells: [4, 4, 8]", "cells: [4, 0, 8]"),
               "s.yaml:16:64: fluid.mesh.box.cells[1]: `0`", {">= 1"});
  expect_error(with("count: 10", "count: 0"), "s.yaml:45:63: particles.insertion[0].count: `0`",
               {">= 1"});
  expect_error(with("count: 10", "count: 3000000000"),
               "s.yaml:45:63: particles.insertion[0].count: ", {"2147483647"});
  expect_error(with("x: [0.04, 0.06]", "x: [0.06, 0.04]"),
               "s.yaml:19:38: fluid.mesh.patches.jet.within.x: ", {"lower end comes first"});
}

TEST(SceneErrors, not_finite_or_octal_looking_numbers) {
  expect_error(with("density: 1.225", "density: .inf"), "s.yaml:13:12: fluid.density: `.inf`",
               {"finite"});
  expect_error(with("density: 1.225", "density: .nan"), "s.yaml:13:12: fluid.density: `.nan`",
               {"finite"});
  expect_error(with("count: 10", "count: 010"), "s.yaml:45:63: particles.insertion[0].count: `010`",
               {"octal"});
  expect_error(with("density: 1.225", "density: 1e400"), "s.yaml:13:12: fluid.density: `1e400`",
               {"too large"});
}

TEST(SceneErrors, unit_of_another_dimension) {
  expect_error(with("time_step: 1.0e-4", "time_step: 2 mm"),
               "s.yaml:31:14: particles.time_step: `2 mm`", {"s, ms, us"});
  expect_error(with("interstitial: [0, 0, 5]", "interstitial: [0, 0, 5 m]"),
               "s.yaml:23:48: fluid.boundaries.jet.interstitial[2]: `5 m`", {"m/s, cm/s, mm/s"});
}

TEST(SceneErrors, text_that_is_a_truth_value_or_no_name) {
  expect_error(with("directory: runs/elsewhere", "directory: no"),
               "s.yaml:54:14: output.directory: `no`", {"quotes"});
  expect_error(with("name: test", "name: a/b"), "s.yaml:3:9: scene.name: `a/b` is not a name", {});
  expect_error(with("name: test", "name: \"\""), "s.yaml:3:9: scene.name: no value where a name",
               {});
  expect_error(with("directory: runs/elsewhere", "directory: \"a\\nb\""),
               "s.yaml:54:14: output.directory: ", {"line break"});
  expect_error(
      with("    walls: {type: wall, slip: free}", "    walls: {type: wall}\n    no: {type: wall}"),
      "s.yaml:27:5: fluid.boundaries.no: `no` is not a name", {});
}

TEST(SceneErrors, keys_without_meaning_for_the_type) {
  expect_error(with("{type: pressure, value: 10}", "{type: pressure, slip: none}"),
               "s.yaml:25:30: fluid.boundaries.outlet.slip: ", {"only with `type: wall`"});
  expect_error(
      with("material: steel, diameter: 0.003", "material: steel, diameter: 0.003, count: 5"),
      "s.yaml:46:57: particles.insertion[1].count: ", {"only with `type: packing | settled`"});
}

TEST(SceneErrors, refuse_a_velocity_of_fixed_spheres) {
  const Scene fixed = read_scene(with("diameter: 0.003}", "diameter: 0.003, motion: fixed}"), "s");
  EXPECT_EQ(fixed.particles.insertion[0].motion, Mobility::free);
  EXPECT_EQ(fixed.particles.insertion[1].motion, Mobility::fixed);
  expect_error(with("velocity: [0, 0, 1]", "velocity: [0, 0, 1], motion: fixed"),
               "s.yaml:45:99: particles.insertion[0].velocity", {"motion: free"});
}

TEST(SceneErrors, conditions_of_a_misspelt_type_are_not_reported_on_top) {
  expect_error(with("type: mass_flow", "type: massflow"),
               "s.yaml:24:19: fluid.boundaries.inlet.type: `massflow`", {"nearest: `mass_flow`"});
  expect_error(with("type: lattice", "type: latice"),
               "s.yaml:46:14: particles.insertion[1].type: `latice`", {"nearest: `lattice`"});
}

TEST(SceneErrors, aliases_anchors_and_tags) {
  expect_error(with("density: 1.225", "density: &d 1.225"), "s.yaml:13:12: fluid.density: anchors",
               {});
  expect_error(with("density: 1.225", "density: !!float 1.225"),
               "s.yaml:13:12: fluid.density: the tag", {});
  const std::string both =
      replaced(with("density: 1.225", "density: &d 1.225"), "viscosity: 1.8e-5", "viscosity: *d");
  EXPECT_NE(errors_in(both).find("s.yaml:14:14: fluid.viscosity: aliases (*name)"),
            std::string::npos)
      << errors_in(both);
  expect_error(with("  drag: wen_yu", "  ? [drag]\n  : wen_yu"),
               "s.yaml:51:5: interphase: a key must be a plain word", {});
}

TEST(SceneErrors, text_that_is_not_yaml) {
  expect_error("scene: [1, 2\n", "s.yaml:2:1: not valid YAML: ", {});
  expect_error("a: b: c\n", "s.yaml:1:5: not valid YAML: ", {});
  expect_error("version: 1\nscene: \x04\n", "s.yaml:2:8: the control character 0x04", {});
  expect_error(valid_scene + "---\nversion: 1\n", "s.yaml:62:1: ", {"second document"});
  expect_error("", "s.yaml:1:1: no value where a section", {});
  expect_error("just words", "s.yaml:1:1: `just words` where a section", {});
}

TEST(SceneErrors, nesting_and_size_are_limited) {
  expect_error("version: " + std::string(20, '[') + std::string(20, ']'), "s.yaml:1:25: version[0]",
               {"more than 16 sections"});
  expect_error("version: " + std::string(100000, '['), "s.yaml:1:", {"more than 16 sections"});
  expect_error(std::string((1 << 20) + 1, '#'), "s.yaml:1:1: 1048577 bytes", {"at most 1048576"});
}

TEST(SceneErrors, version_of_a_later_program) {
  const std::string later =
      replaced(with("version: 1", "version: 2"), "  drag: wen_yu", "  dragging: wen_yu");
  expect_error(later, "s.yaml:1:10: version: `2`", {"this program reads version 1"});
}

TEST(SceneErrors, are_all_reported_at_once_in_the_order_of_the_file) {
  std::string text = with("density: 1.225", "density: -1");
  text = replaced(text, "end_time: 0.1\n", "end_time: soon\n");
  text = replaced(text, "drag: wen_yu", "drag: wenyu");
  text = replaced(text, "side: z_max", "sied: z_max");
  text = replaced(text, "law: linear", "law: hooke");
  text = replaced(text, "material: steel", "material: stel");  // found by a check after reading
  const std::string errors = errors_in(text);
  std::vector<std::string> starts{"s.yaml:5:13: scene.end_time",
                                  "s.yaml:13:12: fluid.density",
                                  "s.yaml:21:7: fluid.mesh.patches.outlet.side: missing",
                                  "s.yaml:21:16: fluid.mesh.patches.outlet.sied: unknown key",
                                  "s.yaml:36:10: particles.contact.law",
                                  "s.yaml:46:33: particles.insertion[1].material",
                                  "s.yaml:51:9: interphase.drag"};
  std::size_t at = 0;
  for (const std::string& start : starts) {
    EXPECT_EQ(errors.substr(at, start.size()), start) << errors;
    at = std::min(errors.find('\n', at), errors.size() - 1) + 1;
  }
  EXPECT_EQ(at, errors.size()) << errors;
}

TEST(SceneErrors, missing_sections_are_all_named) {
  const std::string errors = errors_in("version: 1\n");
  for (const char* section : {"s.yaml:1:1: scene: missing", "s.yaml:1:1: coupling: missing",
                              "s.yaml:1:1: fluid: missing"}) {
    EXPECT_NE(errors.find(section), std::string::npos) << errors;
  }
}

}  // namespace
}  // namespace fluxpact
