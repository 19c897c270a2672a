#include "proto/scene/drag_formula.hpp"

#include <numbers>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

enum Input { voidage, diameter, slip, density, viscosity, reynolds, volume, inputs };

const Unit plain{};
const Unit kilogram{1, 0, 0};
const Unit metre{0, 1, 0};
const Unit second{0, 0, 1};

UnitFormula read(const DragExpressionSettings& settings) {
  const std::array<UnitFormula::Variable, inputs> variables{{
      {"voidage", plain},
      {"diameter", metre},
      {"slip", metre * second.power(-1)},
      {"density", kilogram * metre.power(-3)},
      {"viscosity", kilogram * (metre * second).power(-1)},
      {"reynolds", plain},
      {"volume", metre.power(3)},
  }};
  std::vector<UnitFormula::Constant> constants;
  for (const auto& [name, constant] : settings.constants) {
    constants.push_back({name, parse_unit(constant.unit), constant.value});
  }
  return {settings.coefficient, variables, constants};
}

}  // namespace

DragFormula::DragFormula(const DragExpressionSettings& settings) : formula_(read(settings)) {
  per_volume_ = formula_.unit() == kilogram * (metre.power(3) * second).power(-1);
  if (!per_volume_ && !(formula_.unit() == kilogram * second.power(-1))) {
    throw ConfigError(
        "formula '{}' gives {}; needed: kg/s (force on one sphere over slip) or kg/(m3.s) "
        "(momentum exchange per volume of bed)",
        settings.coefficient, unit_text(formula_.unit()));
  }
}

void DragFormula::evaluate(const Block& block, double fluid_density, double fluid_viscosity,
                           Values& coefficient) const {
  std::array<Values, inputs> values;  // NOLINT(*-member-init): all are written
  values[voidage] = block.voidage;
  values[diameter] = block.diameter;
  values[slip] = block.slip;
  values[density].fill(fluid_density);
  values[viscosity].fill(fluid_viscosity);
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    const double d = block.diameter[i];
    values[reynolds][i] = block.voidage[i] * fluid_density * block.slip[i] * d / fluid_viscosity;
    values[volume][i] = std::numbers::pi / 6 * d * d * d;
  }
  formula_.evaluate(values, coefficient);
  if (!per_volume_) return;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    coefficient[i] *= values[volume][i] / (1 - block.voidage[i]);
  }
}

}  // namespace fluxpact
