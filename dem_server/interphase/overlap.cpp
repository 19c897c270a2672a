#include "dem_server/interphase/overlap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fluxpact {
namespace {

// What the edges of one facet share. In polar coordinates (s, θ) about the foot point of the ball's
// centre on the plane, height h, a ray of the plane that ends at s = r holds, per unit of θ,
//   inside the ball:   h/3 · r²/2                                      (a plane cone)
//   outside:           whole − R³/3 · h/sqrt(r² + h²)                  (cone to the rim, then ball)
// with whole = h (3R² − h²)/6 if the plane cuts the ball, else sign(h) R³/3 (no part inside).
struct PlaneCut {
  double height = 0;        // h, positive if the normal points away from the centre
  double disk_squared = 0;  // R² − h²: radius² of the ball's section, negative if there is none
  double whole = 0;         // [m³]
  double ball_third = 0;    // R³/3 [m³]
};

PlaneCut cut_by_plane(double radius, double height) {
  PlaneCut cut;
  cut.height = height;
  cut.disk_squared = (radius - height) * (radius + height);
  cut.ball_third = radius * radius * radius / 3;
  cut.whole = cut.disk_squared > 0 ? height * (2 * radius * radius + cut.disk_squared) / 6
                                   : std::copysign(cut.ball_third, height);
  return cut;
}

// The triangle of the foot point and the piece [t0, t1] of an edge line at distance d > 0, where
// that piece is outside the ball. With r = d/cos φ and t = d tan φ the integral of h/sqrt(r² + h²)
// is asin(h sin φ/sqrt(h² + d²)) = atan(h t/(d q)), q² = d² + t² + h². Both differences of angles
// are taken in one atan2: that keeps them accurate, and equal to each other, when d or h vanish.
double outside_piece(const PlaneCut& cut, double d, double t0, double t1) {
  const double h = cut.height;
  const double angle = std::atan2(d * (t1 - t0), d * d + t0 * t1);
  const double q0 = std::sqrt(d * d + t0 * t0 + h * h);
  const double q1 = std::sqrt(d * d + t1 * t1 + h * h);
  const double bent = std::atan2(h * d * (t1 * q0 - t0 * q1), d * d * q0 * q1 + h * h * t0 * t1);
  return cut.whole * angle - cut.ball_third * bent;
}

// The triangle of the foot point and the edge from t0 to t1 (t0 < t1) at signed distance d. It is
// flat for d = 0: the angles of its pieces outside are then equal, and cancel.
double edge_share(const PlaneCut& cut, double d, double t0, double t1) {
  const double distance = std::abs(d);
  const double chord_squared = cut.disk_squared - d * d;
  if (chord_squared <= 0) return std::copysign(1.0, d) * outside_piece(cut, distance, t0, t1);
  const double chord = std::sqrt(chord_squared);
  double outside = 0;
  if (t0 < -chord) outside += outside_piece(cut, distance, t0, std::min(t1, -chord));
  if (t1 > chord) outside += outside_piece(cut, distance, std::max(t0, chord), t1);
  const double inside = std::max(0.0, std::min(t1, chord) - std::max(t0, -chord));
  return std::copysign(1.0, d) * (outside + cut.height * distance * inside / 6);
}

}  // namespace

double ball_volume(double radius) { return 4 * std::numbers::pi / 3 * radius * radius * radius; }

double cut_ball_volume(double radius, double height) {
  return std::numbers::pi / 3 * (radius + height) * (radius + height) * (2 * radius - height);
}

// A body bounded by the sphere and by planes through which the centre sees it: a third of the
// height times the area for each. The spherical part has the area (angles − arcs' curvature) R².
double beyond_edge(double radius, double a, double b) {
  const double square = radius * radius;
  const double c_squared = square - a * a - b * b;
  if (c_squared <= 0) return 0;
  const double c = std::sqrt(c_squared);
  const double angle = std::atan2(radius * c, a * b);
  return 2.0 / 3 * (square * radius * angle + a * b * c) -
         (a / 3) * (3 * square - a * a) * std::atan2(c, b) -
         (b / 3) * (3 * square - b * b) * std::atan2(c, a);
}

double beyond_corner(double radius, const Vector3& distances) {
  const double square = radius * radius;
  if (distances.squaredNorm() >= square) return 0;
  double angles = -std::numbers::pi;
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = distances[axis];
    const double b = distances[(axis + 1) % 3];
    const double c = distances[(axis + 2) % 3];
    // The piece of the disc in the plane at a: from (b, c) to its rim at (x, c) and (b, y).
    const double disc = square - a * a;
    const double x = std::sqrt(disc - c * c);
    const double y = std::sqrt(disc - b * b);
    const double arc = std::atan2(x * y - b * c, x * b + y * c);
    const double area = 0.5 * (disc * arc - c * (x - b) - b * (y - c));
    angles += std::atan2(radius * y, a * b);
    sum += a * (square * arc + area);
  }
  return (square * radius * angles - sum) / 3;
}

double signed_cone_overlap(const Ball& ball, const Facet& facet) {
  const PlaneCut cut = cut_by_plane(ball.radius, facet.normal.dot(facet.loop[0] - ball.centre));
  double sum = 0;
  Vector3 from = facet.loop.back() - ball.centre;
  for (const Vector3& corner : facet.loop) {
    const Vector3 to = corner - ball.centre;
    const Vector3 edge = to - from;
    const double length = edge.norm();
    if (length > 0) {  // a repeated corner spans no triangle
      const double t0 = from.dot(edge) / length;
      sum += edge_share(cut, facet.normal.dot(from.cross(edge)) / length, t0, t0 + length);
    }
    from = to;
  }
  return sum;
}

double polyhedron_overlap(const Ball& ball, std::span<const Facet> facets) {
  double sum = 0;
  for (const Facet& facet : facets) sum += signed_cone_overlap(ball, facet);
  return sum;
}

double box_overlap(const Ball& ball, const Vector3& lower, const Vector3& upper) {
  const Vector3 below = ball.centre - lower;  // distances of the centre from the six planes
  const Vector3 above = upper - ball.centre;
  const double nearest = std::min(below.minCoeff(), above.minCoeff());
  if (nearest <= -ball.radius) return 0;
  if (nearest >= ball.radius) return ball_volume(ball.radius);
  const auto cuts = (below.array() < ball.radius).count() + (above.array() < ball.radius).count();
  if (cuts == 1) return cut_ball_volume(ball.radius, nearest);

  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;  // u, v, axis are right-handed
    const int v = (axis + 2) % 3;
    std::array<Vector3, 4> loop{lower, lower, lower, lower};
    loop[1][u] = loop[2][u] = upper[u];
    loop[2][v] = loop[3][v] = upper[v];
    // The lower side is the same loop seen from its back.
    sum -= signed_cone_overlap(ball, {loop, Vector3::Unit(axis)});
    for (Vector3& corner : loop) corner[axis] = upper[axis];
    sum += signed_cone_overlap(ball, {loop, Vector3::Unit(axis)});
  }
  return sum;
}

}  // namespace fluxpact
