// A manufactured solution of the volume-averaged equations in a periodic unit cube.
//
// The voidage is a wave ε(x − c t), so that q = ε u = c ε + w with any solenoidal w satisfies
// continuity exactly; w is an ABC flow (Arnold 1965). The force that keeps u and p comes from the
// momentum equation by finite differences of the exact fields.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "tests/unit/cfd_server/fluid_case.hpp"

namespace fluxpact {

class Manufactured {
 public:
  double density = 1;
  double viscosity = 0.01;
  double drag = 0;               ///< β [kg/(m³ s)], largest; varies in space as (1 + sin)/2
  double wobble = 0.2;           ///< amplitude of the voidage
  Vector3 drift{0.4, 0.3, 0.2};  ///< c [m/s]
  PressureModel model = PressureModel::a;

  double voidage(const Vector3& x, double t) const {
    const Vector3 y = x - t * drift;
    return 0.7 + wobble * std::sin(k * (y.x() + y.y())) * std::cos(k * y.z());
  }
  Vector3 swirl(const Vector3& x) const {
    return {0.3 * std::sin(k * x.z()) + 0.2 * std::cos(k * x.y()),
            0.25 * std::sin(k * x.x()) + 0.3 * std::cos(k * x.z()),
            0.2 * std::sin(k * x.y()) + 0.25 * std::cos(k * x.x())};
  }
  Vector3 velocity(const Vector3& x, double t) const { return drift + swirl(x) / voidage(x, t); }
  double pressure(const Vector3& x, double t) const {
    return std::cos(k * x.x()) * std::sin(k * x.y() + t) * std::cos(k * x.z());
  }
  double drag_at(const Vector3& x) const { return 0.5 * drag * (1 + std::sin(k * x.x())); }

  /// q at t = 0 as the scene says it.
  VectorFormula initial_superficial() const {
    const std::string voidage_text = fmt::format("(0.7+{}*sin(2*pi*(x+y))*cos(2*pi*z))", wobble);
    VectorFormula formula;
    formula.components[0].text =
        fmt::format("{}*{}+0.3*sin(2*pi*z)+0.2*cos(2*pi*y)", drift.x(), voidage_text);
    formula.components[1].text =
        fmt::format("{}*{}+0.25*sin(2*pi*x)+0.3*cos(2*pi*z)", drift.y(), voidage_text);
    formula.components[2].text =
        fmt::format("{}*{}+0.2*sin(2*pi*y)+0.25*cos(2*pi*x)", drift.z(), voidage_text);
    return formula;
  }

  /// Force per volume [N/m³] besides drag: ρ ε (∂u/∂t + u·∇u) + χ ∇p − ∇·(ε τ) + β u.
  Vector3 force(const Vector3& x, double t) const {
    const auto u = [&](const Vector3& y, double s) { return velocity(y, s); };
    const Vector3 rate = derivative([&](double h) { return u(x, t + h); });
    Vector3 carried = Vector3::Zero();
    Vector3 slope = Vector3::Zero();
    Vector3 viscous = Vector3::Zero();
    for (int a = 0; a < 3; ++a) {
      const Vector3 e = Vector3::Unit(a);
      carried += u(x, t)[a] * derivative([&](double h) { return u(x + h * e, t); });
      slope[a] = derivative([&](double h) { return Vector3(pressure(x + h * e, t), 0, 0); })[0];
      viscous += derivative([&](double h) { return stress(x + h * e, t, a); });
    }
    const double share = model == PressureModel::a ? voidage(x, t) : 1.0;
    return density * voidage(x, t) * (rate + carried) + share * slope - viscous +
           drag_at(x) * u(x, t);
  }

 private:
  static constexpr double k = 2 * std::numbers::pi;

  /// Central difference of fourth order; its error is some 1e-10 of the fields.
  template <class F>
  static Vector3 derivative(const F& f) {
    constexpr double h = 1e-3;
    return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
  }

  /// Viscous traction on a plane normal to an axis: ε μ (∂u/∂x_a + ∇u_a − 2/3 ∇·u e_a).
  Vector3 stress(const Vector3& x, double t, int axis) const {
    Matrix3 gradient;
    for (int a = 0; a < 3; ++a) {
      gradient.col(a) = derivative([&](double h) { return velocity(x + h * Vector3::Unit(a), t); });
    }
    Vector3 traction = gradient.col(axis) + Vector3(gradient.row(axis).transpose());
    traction[axis] -= 2.0 / 3.0 * gradient.trace();
    return voidage(x, t) * viscosity * traction;
  }
};

}  // namespace fluxpact
