// interphase.drag: the laws with keys of their own, and what a law of the user's own must fulfil.
#include "proto/scene/drag_formula.hpp"
#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

std::string with_drag(const std::string& lines) { return with("  drag: wen_yu\n", lines); }

std::string with_formula(const std::string& formula, const std::string& more = "") {
  return with_drag("  drag: expression\n  drag_expression:\n    coefficient: \"" + formula +
                   "\"\n" + more);
}

/// Exactly one error, which contains `part`.
void expect_finding(const std::string& text, const std::string& part) {
  expect_error(text, "s.yaml:", {part});
}

// Wen and Yu's law below Re = 1000, as a coefficient of one sphere.
const std::string own_law = "3*pi*viscosity*diameter * (1 + 0.15*reynolds^0.687) * voidage^-2.65";

TEST(SceneDrag, reads_the_constants_of_syamlal_and_o_brien) {
  const Scene scene = read_scene(
      with_drag("  drag: syamlal_obrien\n  syamlal_obrien: {dense_factor: 0.6}\n"), "s.yaml");
  EXPECT_EQ(scene.interphase.syamlal_obrien.dense_factor, 0.6);
  EXPECT_EQ(scene.interphase.syamlal_obrien.dilute_exponent, 2.65);
  EXPECT_EQ(read_scene(write_scene(scene), "w").interphase.syamlal_obrien.dense_factor, 0.6);
  expect_finding(with_drag("  drag: tang\n  syamlal_obrien: {dense_factor: 0.6}\n"),
                 "has no meaning here, only with `drag: syamlal_obrien`");
}

TEST(SceneDrag, reads_a_law_of_the_users_own) {
  const Scene scene = read_scene(
      with_formula(own_law + " + more*slip", "    constants: {more: {value: 2, unit: kg/m}}\n"),
      "s.yaml");
  EXPECT_EQ(scene.interphase.drag, DragLaw::expression);
  EXPECT_EQ(scene.interphase.drag_expression.constants.at("more").value, 2);
  const Scene again = read_scene(write_scene(scene), "w");
  EXPECT_EQ(again.interphase.drag_expression.coefficient, own_law + " + more*slip");
  EXPECT_EQ(again.interphase.drag_expression.constants.at("more").unit, "kg/m");
}

TEST(SceneDrag, needs_the_formula_and_only_then) {
  expect_finding(with_drag("  drag: expression\n"), "interphase.drag_expression: missing");
  expect_finding(with_drag("  drag: tang\n  drag_expression: {coefficient: \"1\"}\n"),
                 "has no meaning here, only with `drag: expression`");
}

TEST(SceneDrag, checks_the_units_of_a_formula) {
  expect_finding(with_formula("viscosity*diameter + slip"), "`+` between kg/s and m/s");
  expect_finding(with_formula("viscosity"),
                 "gives kg/(m.s); needed: kg/s (force on one sphere over slip) or kg/(m3.s)");
  expect_finding(with_formula("0.44"), "gives 1; needed: kg/s");
  expect_finding(with_formula("viscosity*width"), "'width' is not known");
  expect_finding(
      with_formula("k*diameter", "    constants: {k: {value: 1, unit: kg/mm}}\n"),
      "interphase.drag_expression.constants.k.unit: unit 'kg/mm': 'mm' is not known (character 4)");
  expect_finding(with_formula(own_law, "    constants: {slip: {value: 1}}\n"), "constant 'slip'");
}

TEST(SceneDrag, tries_the_sign_of_a_formula_over_its_ranges) {
  // The insertions of the scene have 2 mm and 3 mm.
  expect_finding(
      with_formula("viscosity*diameter*(voidage - 0.3)"),
      "at voidage 0.2, slip 0 m/s, diameter 0.002 m; it must be finite and not negative");
  EXPECT_NO_THROW(read_scene(
      with_formula("viscosity*diameter*(voidage - 0.3)", "    voidage: [0.31, 1]\n"), "s.yaml"));
  expect_finding(with_formula("viscosity*diameter*(1 - 1e-4*reynolds)"), "is -");
  EXPECT_NO_THROW(read_scene(
      with_formula("viscosity*diameter*(1 - 1e-4*reynolds)", "    slip: [0, 20 m/s]\n"), "s.yaml"));
  expect_finding(with_formula("viscosity*diameter/reynolds"), "is inf kg/s at voidage 0.2, slip 0");
  expect_finding(with_formula("viscosity*diameter*ln(diameter/far)",
                              "    constants: {far: {value: 0.0025, unit: m}}\n"),
                 "diameter 0.002 m");
}

TEST(SceneDrag, corrects_the_self_disturbance_of_narrow_maps_only) {
  const std::string key = "  drag: wen_yu\n  self_disturbance: corrected\n";
  const Scene scene = read_scene(with_drag(key), "s.yaml");
  EXPECT_EQ(scene.interphase.self_disturbance, SelfDisturbance::corrected);
  EXPECT_EQ(read_scene(write_scene(scene), "w").interphase.self_disturbance,
            SelfDisturbance::corrected);
  expect_finding(with("  voidage: centroid\n  drag: wen_yu\n",
                      "  voidage: {map: diffusion, width: 5 cm}\n" + key),
                 "is for the maps exact, centroid and satellite");
}

TEST(DragFormula, of_a_momentum_exchange_is_shared_by_the_spheres) {
  // β of Wen and Yu, over the spheres of a volume, against the same law for one sphere.
  DragExpressionSettings settings;
  settings.coefficient = own_law;
  const DragFormula sphere(settings);
  settings.coefficient =
      "18*viscosity*(1-voidage)/diameter^2 * (1 + 0.15*reynolds^0.687) * voidage^-2.65";
  const DragFormula bed(settings);
  DragFormula::Block block{};
  for (std::size_t i = 0; i < UnitFormula::block; ++i) {
    block.voidage[i] = 0.4 + 0.009 * static_cast<double>(i);
    block.diameter[i] = 1e-3;
    block.slip[i] = 0.1 * static_cast<double>(i);
  }
  DragFormula::Values one{};
  DragFormula::Values all{};
  sphere.evaluate(block, 1.2, 1.8e-5, one);
  bed.evaluate(block, 1.2, 1.8e-5, all);
  // Some ten operations, and 1 − ε twice alike.
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(all[i], one[i], 1e-14 * one[i]);
}

}  // namespace
}  // namespace fluxpact
