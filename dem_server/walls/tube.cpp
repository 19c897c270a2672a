#include "dem_server/walls/tube.hpp"

#include <cmath>
#include <limits>

namespace fluxpact {

Tube make_tube(const SurfaceSettings& surface) {
  Tube tube;
  tube.start = surface.point;
  tube.axis = surface.direction.normalized();
  tube.radius = surface.radius;
  tube.length = surface.length > 0 ? surface.length : std::numeric_limits<double>::infinity();
  tube.end_radius = surface.type == SurfaceType::cone ? surface.end_radius : surface.radius;
  if (surface.type == SurfaceType::cone) {
    const double slant = std::hypot(tube.length, tube.end_radius - tube.radius);
    tube.cosine = tube.length / slant;
    tube.sine = (tube.end_radius - tube.radius) / slant;
  }
  return tube;
}

TubePoint nearest_on(const Tube& tube, const Vector3& x) {
  const Vector3 from_start = x - tube.start;
  const double z = from_start.dot(tube.axis);
  Vector3 radial = from_start - z * tube.axis;
  const double distance = radial.norm();
  // Below this the direction is rounding.
  if (distance > 1e-14 * from_start.norm()) {
    radial /= distance;
  } else {
    radial = tube.axis.unitOrthogonal();
  }
  // In the half plane (z, distance) the tube is a straight line from (0, radius), of the direction
  // (cosine, sine).
  const double along = z * tube.cosine + (distance - tube.radius) * tube.sine;
  TubePoint nearest;
  nearest.outward = tube.cosine * radial - tube.sine * tube.axis;
  nearest.outside = (distance - tube.radius) * tube.cosine - z * tube.sine;
  const double slant = tube.length / tube.cosine;
  const bool endless = std::isinf(tube.length);
  if (along < 0 && !endless) {
    nearest.part = TubePart::start_rim;
    nearest.point = tube.start + tube.radius * radial;
  } else if (along > slant && !endless) {
    nearest.part = TubePart::end_rim;
    nearest.point = tube.start + tube.length * tube.axis + tube.end_radius * radial;
  } else {
    nearest.point = x - nearest.outside * nearest.outward;
  }
  return nearest;
}

}  // namespace fluxpact
