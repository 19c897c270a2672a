// When two spheres on parabolas, or a sphere and a plane, next come into touch: the exact times of
// the event-driven engine.
//
// Contact is asked for as the first moment at which the surfaces touch or overlap *and* approach.
// So two that part after a collision, or overlap by a rounding error, are left alone until they
// turn, and no overlap ever grows.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/base/vector.hpp"

namespace fluxpact {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// A distance along a line over time: `distance` + `speed` t + `acceleration` t²/2.
struct Fall {
  double distance;      ///< [m], negative: beyond
  double speed;         ///< [m/s]
  double acceleration;  ///< [m/s²]
};

/// First time [s] in [0, horizon] at which the distance is zero or less and falls; `never` if there
/// is none.
inline double first_touch(const Fall& fall, double horizon) {
  const auto [distance, speed, acceleration] = fall;
  // It falls by no more than this.
  if (distance > horizon * (std::abs(speed) + 0.5 * horizon * std::abs(acceleration))) return never;
  const auto within = [horizon](double time) { return time <= horizon ? time : never; };
  if (distance <= 0) {
    if (speed < 0) return 0;
    if (acceleration >= 0) return never;
    const double turn = speed / -acceleration;
    if (distance + 0.5 * speed * turn <= 0) return within(turn);
  }
  const double square = speed * speed - 2 * acceleration * distance;
  if (square < 0) return never;  // turns before it is there
  const double root = std::sqrt(square);
  // The root at which the distance falls, in the form without cancellation.
  if (speed <= 0) return distance <= 0 ? within(0) : within(2 * distance / (root - speed));
  return acceleration < 0 ? within((root + speed) / -acceleration) : never;
}

/// |r + v t + a t²/2|² - reach² as a polynomial of t.
struct Separation {
  double c[5];  ///< [m² / s^k]

  Separation(const Vector3& r, const Vector3& v, const Vector3& a, double reach)
      : c{r.squaredNorm() - reach * reach, 2 * r.dot(v), v.squaredNorm() + r.dot(a), v.dot(a),
          0.25 * a.squaredNorm()} {}

  double at(double t) const { return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4]))); }
  double slope(double t) const { return c[1] + t * (2 * c[2] + t * (3 * c[3] + t * (4 * c[4]))); }
};

/// The same in general, by the stretches in which the separation is monotone.
double first_touch_of_any(const Separation& separation, double horizon);

/// The root [s] of the separation in [low, high], where it is positive at `low` and not at `high`,
/// and monotone: Newton's method in a bracket.
double root_between(const Separation& separation, double low, double high);

/// First time [s] in [0, horizon] at which the separation is zero or less and falls; `never` if
/// there is none.
inline double first_touch(const Separation& separation, double horizon) {
  const double* c = separation.c;
  if (c[4] == 0) {  // straight: the smaller root, in the form without cancellation
    if (c[1] >= 0) return never;
    if (c[0] <= 0) return 0;
    const double square = c[1] * c[1] - 4 * c[2] * c[0];
    if (square < 0) return never;
    const double time = 2 * c[0] / (std::sqrt(square) - c[1]);
    return time <= horizon ? time : never;
  }
  // The second derivative, 2 (c2 + 3 c3 t + 6 c4 t²), lies between these two.
  const double bend = 3 * std::abs(c[3]) * horizon;
  if (c[2] - bend >= 0) {  // convex
    if (c[1] >= 0) return never;
    if (c[0] <= 0) return 0;
    // Newton's steps from the left cannot pass the root; if there is none they pass the minimum.
    double t = 0;
    while (true) {
      const double value = separation.at(t);
      const double slope = separation.slope(t);
      if (value <= 0) return t;
      if (slope >= 0) return never;
      const double next = t - value / slope;
      if (next > horizon) return never;
      if (next <= t) return t;  // as near as numbers are
      t = next;
    }
  }
  if (c[0] > 0 && c[2] + bend + 6 * c[4] * horizon * horizon <= 0) {  // concave: falls at most once
    return separation.at(horizon) > 0 ? never : root_between(separation, 0, horizon);
  }
  return first_touch_of_any(separation, horizon);
}

}  // namespace fluxpact
