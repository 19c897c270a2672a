// Where a moving wall is at a time, and how fast: rigid motions given by the scene.
#pragma once

#include "proto/base/vector.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Place of a rigid body in relation to its place at rest: x = pivot + turn (X - pivot) + shift.
struct Pose {
  Matrix3 turn = Matrix3::Identity();
  Vector3 pivot = Vector3::Zero();     ///< [m]
  Vector3 shift = Vector3::Zero();     ///< [m]
  Vector3 velocity = Vector3::Zero();  ///< [m/s] of translation
  Vector3 spin = Vector3::Zero();      ///< [rad/s]
  bool turns = false;                  ///< false: `turn` is the identity

  /// A place [m] as the body at rest sees it.
  Vector3 to_body(const Vector3& x) const {
    if (!turns) return x - shift;
    return pivot + turn.transpose() * (x - pivot - shift);
  }
  /// A direction of the body at rest.
  Vector3 direction(const Vector3& body) const { return turns ? Vector3(turn * body) : body; }
  /// Velocity [m/s] of the body at a place [m] of the world.
  Vector3 velocity_at(const Vector3& x) const {
    return turns ? Vector3(velocity + spin.cross(x - pivot - shift)) : velocity;
  }
};

/// The pose at `time` [s]. Translation: v t; rotation: rate t about the axis; vibration:
/// A sin(2 π f t + φ), with the velocity 2 π f A cos(2 π f t + φ).
Pose pose_at(const MotionSettings& motion, double time);

/// Bound of how far [m] any point at most `arm` [m] from the axis of a rotation is at `time` from
/// where it was at `since` [s].
double displacement(const MotionSettings& motion, double since, double time, double arm);

/// The largest speed [m/s], at any time, of any point at most `arm` [m] from the axis of a
/// rotation.
double largest_speed(const MotionSettings& motion, double arm);

}  // namespace fluxpact
