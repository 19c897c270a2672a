// Cylinders and cones: the distance of a place from a thin round shell in closed form.
#pragma once

#include "proto/base/vector.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// A shell about an axis, without ends. Its points at the distance z along the axis have the
/// distance radius + slope z from it.
struct Tube {
  Vector3 start = Vector3::Zero();  ///< [m] of the axis
  Vector3 axis = Vector3::UnitZ();  ///< unit vector
  double length = 0;                ///< [m]; infinite: an endless cylinder
  double radius = 0;                ///< [m] at the start
  double end_radius = 0;            ///< [m] at the end
  double cosine = 1;                ///< of the angle between shell and axis
  double sine = 0;                  ///< likewise; positive if the tube widens
};

/// Of a surface of type cylinder or cone.
Tube make_tube(const SurfaceSettings& surface);

enum class TubePart { shell, start_rim, end_rim };

struct TubePoint {
  Vector3 point;       ///< [m] the nearest of the shell
  Vector3 outward;     ///< unit normal of the shell there, away from the axis
  double outside = 0;  ///< [m] distance from the shell along `outward`: negative inside
  TubePart part = TubePart::shell;
};

/// The point of the tube nearest to x [m]; on the axis, where all around are equally near, one in a
/// direction that depends on the axis alone. `outside` is the distance from the endless shell that
/// continues the tube if the nearest point is on a rim.
TubePoint nearest_on(const Tube& tube, const Vector3& x);

}  // namespace fluxpact
