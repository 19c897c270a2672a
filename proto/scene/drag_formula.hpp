// The drag law that a user wrote into the scene (interphase.drag_expression): read and checked by
// every process, evaluated on the particle side.
#pragma once

#include <array>

#include "proto/base/unit_formula.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

class DragFormula {
 public:
  /// Throws ConfigError, with the place in the text, if the formula or the unit of a constant
  /// cannot be read, units do not fit together, or the result is neither in kg/s nor in kg/(m³ s).
  explicit DragFormula(const DragExpressionSettings& settings);

  using Values = UnitFormula::Values;

  /// What the spheres of a block see.
  struct Block {
    Values voidage;   ///< ε [-]
    Values diameter;  ///< d [m]
    Values slip;      ///< |u − v| [m/s], interstitial
  };

  /// ζ [kg/s] of each sphere of the block, of a formula for β the sphere's share of it,
  /// β V_p/(1 − ε). Whatever the formula gives: the caller looks whether it can be a drag.
  void evaluate(const Block& block, double density, double viscosity, Values& coefficient) const;

 private:
  UnitFormula formula_;
  bool per_volume_ = false;  ///< the formula is one for β
};

}  // namespace fluxpact
