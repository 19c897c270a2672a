// A value of the scene as a function of place and time: number or formula, tables, ramp.
//
// Compiled once a run from the scene; evaluated for the boundary faces at the end of each step if
// it varies in time.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "proto/base/expression.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// A number or formula of the scene, ready to be evaluated.
class FormulaValue {
 public:
  /// Throws ConfigError if the formula cannot be parsed.
  explicit FormulaValue(const Formula& formula);

  double operator()(const Vector3& position, double time) const;
  bool is_formula() const { return expression_.has_value(); }

 private:
  double number_ = 0;
  std::optional<Expression> expression_;
};

/// Three of them.
class VectorValue {
 public:
  explicit VectorValue(const VectorFormula& formula);

  Vector3 operator()(const Vector3& position, double time) const;
  bool is_formula() const;

 private:
  std::array<FormulaValue, 3> components_;
};

/// Value of a table at `place`: linear between the points, constant beyond the ends.
double interpolate(const std::vector<std::array<double, 2>>& points, double place);

/// The factor by which ramp and tables scale a boundary value. `shape` is its part in space, `pace`
/// its part in time.
class ProfileFactor {
 public:
  explicit ProfileFactor(const BoundarySettings& settings);

  double shape(const Vector3& position) const;
  double pace(double time) const;
  bool varies_in_time() const;

 private:
  double ramp_ = 0;
  std::vector<ProfileSettings> tables_;
};

}  // namespace fluxpact
