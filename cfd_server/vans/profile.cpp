#include "cfd_server/vans/profile.hpp"

#include <algorithm>

namespace fluxpact {

FormulaValue::FormulaValue(const Formula& formula) : number_(formula.number) {
  if (!formula.text.empty()) expression_.emplace(formula.text);
}

double FormulaValue::operator()(const Vector3& position, double time) const {
  return expression_ ? (*expression_)(position, time) : number_;
}

VectorValue::VectorValue(const VectorFormula& formula)
    : components_{FormulaValue(formula.components[0]), FormulaValue(formula.components[1]),
                  FormulaValue(formula.components[2])} {}

Vector3 VectorValue::operator()(const Vector3& position, double time) const {
  return {components_[0](position, time), components_[1](position, time),
          components_[2](position, time)};
}

bool VectorValue::is_formula() const {
  return std::ranges::any_of(components_, &FormulaValue::is_formula);
}

double interpolate(const std::vector<std::array<double, 2>>& points, double place) {
  const auto above =
      std::ranges::upper_bound(points, place, {}, [](const auto& point) { return point[0]; });
  if (above == points.begin()) return points.front()[1];
  if (above == points.end()) return points.back()[1];
  const auto& [from, low] = *(above - 1);
  const auto& [to, high] = *above;
  return low + (high - low) * (place - from) / (to - from);
}

ProfileFactor::ProfileFactor(const BoundarySettings& settings)
    : ramp_(settings.ramp), tables_(settings.profile) {}

double ProfileFactor::shape(const Vector3& position) const {
  double factor = 1;
  for (const ProfileSettings& table : tables_) {
    if (table.along == Along::time) continue;
    const int axis = static_cast<int>(table.along) - static_cast<int>(Along::x);
    factor *= interpolate(table.points, position[axis]);
  }
  return factor;
}

double ProfileFactor::pace(double time) const {
  double factor = ramp_ > 0 ? std::clamp(time / ramp_, 0.0, 1.0) : 1.0;
  for (const ProfileSettings& table : tables_) {
    if (table.along == Along::time) factor *= interpolate(table.points, time);
  }
  return factor;
}

bool ProfileFactor::varies_in_time() const {
  return ramp_ > 0 || std::ranges::any_of(tables_, [](const ProfileSettings& table) {
           return table.along == Along::time;
         });
}

}  // namespace fluxpact
