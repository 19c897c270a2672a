// What must hold for a drag law of the user's own, as far as it can be tried before the run; and
// for the slip that the law is given.
#include <algorithm>
#include <cmath>

#include "proto/scene/check.hpp"
#include "proto/scene/drag_formula.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

constexpr const char* formula_path = "interphase.drag_expression.coefficient";

void add_sizes(double diameter, const std::optional<SizeSettings>& sizes,
               std::vector<double>& diameters) {
  if (!sizes) {
    if (diameter > 0) diameters.push_back(diameter);
    return;
  }
  const bool table = sizes->distribution == SizeDistribution::table && !sizes->table.empty();
  diameters.push_back(table ? sizes->table.front()[0] : sizes->range[0]);
  diameters.push_back(table ? sizes->table.back()[0] : sizes->range[1]);
}

/// The smallest and the largest diameter [m] that the scene itself names; empty if none.
std::vector<double> named_diameters(const Scene& scene) {
  std::vector<double> all;
  for (const InsertionSettings& entry : scene.particles.insertion) {
    add_sizes(entry.diameter, entry.sizes, all);
  }
  for (const InflowSettings& entry : scene.particles.inflow) {
    add_sizes(entry.diameter, entry.sizes, all);
  }
  if (scene.interphase.prescribed) all.push_back(scene.interphase.prescribed->diameter);
  std::erase_if(all, [](double diameter) { return !(diameter > 0); });
  if (all.size() < 2) return all;
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return {*least, *most};
}

/// A block of slips [m/s] between the ends: the ends, even steps, and even steps of the logarithm.
DragFormula::Values slips_between(const std::array<double, 2>& range) {
  DragFormula::Values slips{};
  constexpr int half = UnitFormula::block / 2;
  constexpr double decades = 8;
  for (int i = 0; i < half; ++i) {
    const double part = static_cast<double>(i) / (half - 1);
    slips.at(i) = range[0] + part * (range[1] - range[0]);
    slips.at(half + i) = range[0] + std::pow(10, decades * (part - 1)) * (range[1] - range[0]);
  }
  return slips;
}

bool can_be_drag(double coefficient) { return std::isfinite(coefficient) && coefficient >= 0; }

/// Tries the formula over its ranges; the first point where it cannot be a drag is a finding.
void try_formula(const Scene& scene, const DragFormula& formula, Findings& findings) {
  const DragExpressionSettings& law = scene.interphase.drag_expression;
  constexpr int steps = 60;
  DragFormula::Block block{};
  DragFormula::Values coefficient{};
  block.slip = slips_between(law.slip);
  for (const double diameter : named_diameters(scene)) {
    block.diameter.fill(diameter);
    for (int i = 0; i <= steps; ++i) {
      // A formula for β is tried as close to ε = 1 as there can be a sphere in a cell.
      const double voidage = law.voidage[0] + i * (law.voidage[1] - law.voidage[0]) / steps;
      constexpr double emptiest = 1 - 1e-9;
      block.voidage.fill(std::min(voidage, emptiest));
      formula.evaluate(block, scene.fluid.density, scene.fluid.viscosity, coefficient);
      const auto bad = std::find_if_not(coefficient.begin(), coefficient.end(), can_be_drag);
      if (bad == coefficient.end()) continue;
      findings.add(
          formula_path,
          fmt::format("the drag coefficient is {:.6g} kg/s at voidage {:.6g}, slip {:.6g} m/s, "
                      "diameter {:.6g} m; it must be finite and not negative for voidage {} .. {} "
                      "and slip {} .. {} m/s. Write it so, or narrow these ranges",
                      *bad, block.voidage[0], block.slip.at(bad - coefficient.begin()), diameter,
                      law.voidage[0], law.voidage[1], law.slip[0], law.slip[1]));
      return;
    }
  }
}

void check_self_disturbance(const InterphaseSettings& interphase, Findings& findings) {
  const VoidageMap map = interphase.voidage.map;
  const bool narrow =
      map == VoidageMap::exact || map == VoidageMap::centroid || map == VoidageMap::satellite;
  if (interphase.self_disturbance == SelfDisturbance::none || narrow ||
      !findings.sound("interphase.self_disturbance") || !findings.sound("interphase.voidage")) {
    return;
  }
  findings.add("interphase.self_disturbance",
               fmt::format("`corrected` is for the maps exact, centroid and satellite, and "
                           "interphase.voidage is `{}`; remove it, or take one of these",
                           name_of(map)));
}

}  // namespace

void check_drag(const Scene& scene, Findings& findings) {
  check_self_disturbance(scene.interphase, findings);
  if (scene.interphase.drag != DragLaw::expression ||
      !findings.sound("interphase.drag_expression") || !findings.sound("interphase.drag")) {
    return;
  }
  const std::size_t before = findings.count();
  for (const auto& [name, constant] : scene.interphase.drag_expression.constants) {
    try {
      parse_unit(constant.unit);
    } catch (const ConfigError& error) {
      findings.add(fmt::format("interphase.drag_expression.constants.{}.unit", name), error.what());
    }
  }
  if (findings.count() > before) return;
  try {
    const DragFormula formula(scene.interphase.drag_expression);
    if (findings.sound("fluid") && findings.sound("particles.insertion") &&
        findings.sound("particles.inflow") && findings.sound("interphase.prescribed")) {
      try_formula(scene, formula, findings);
    }
  } catch (const ConfigError& error) {
    findings.add(formula_path, error.what());
  }
}

}  // namespace fluxpact
