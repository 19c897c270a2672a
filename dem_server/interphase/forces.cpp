#include "dem_server/interphase/forces.hpp"

#include <cmath>
#include <numbers>

namespace fluxpact {

double added_mass_coefficient(Crowding crowding, double voidage) {
  if (crowding == Crowding::none) return 0.5;
  return 0.5 * (3 - 2 * voidage) / voidage;
}

Vector3 saffman_lift(const LiftPoint& point, const FluidProperties& fluid) {
  const double slip = point.slip.norm();
  const double shear = point.vorticity.norm();
  if (!(slip > 0) || !(shear > 0)) return Vector3::Zero();
  const double d = point.diameter;
  const double reynolds = fluid.density * slip * d / fluid.viscosity;
  const double beta = d * shear / (2 * slip);
  const double slow = 0.3314 * std::sqrt(beta);
  const double factor = reynolds <= 40 ? (1 - slow) * std::exp(-reynolds / 10) + slow
                                       : 0.0524 * std::sqrt(beta * reynolds);
  const double size = 1.615 * d * d * std::sqrt(fluid.density * fluid.viscosity / shear) * factor;
  return size * point.slip.cross(point.vorticity);
}

Vector3 magnus_lift(const LiftPoint& point, const FluidProperties& fluid) {
  const Vector3 velocity = -point.slip;
  const Vector3 turning = point.spin - 0.5 * point.vorticity;
  const double speed = velocity.norm();
  const double rate = turning.norm();
  if (!(speed > 0) || !(rate > 0)) return Vector3::Zero();
  const double d = point.diameter;
  const double reynolds = fluid.density * speed * d / fluid.viscosity;
  const double spin_reynolds = fluid.density * d * d * rate / fluid.viscosity;
  const double ratio = d * rate / speed;
  const double faded = std::exp(-0.05684 * std::pow(spin_reynolds, 0.4) * std::pow(reynolds, 0.3));
  const double coefficient = 0.45 + (ratio - 0.45) * faded;
  const double area = std::numbers::pi / 4 * d * d;
  return 0.5 * fluid.density * area * coefficient * speed / rate * turning.cross(velocity);
}

}  // namespace fluxpact
