// Spheres thrown at closed triangulated bodies, most of them at edges and corners: none may get
// through.
#pragma once

#include <functional>

#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {

/// How a touch acts on the sphere of these tests, whose mass and sub-step are 1.
enum class Rebound {
  hard,  ///< speed turned round, overlap taken back at once: any speed below a radius per sub-step
  soft,  ///< spring of the engine's longest sub-step: a tenth of its contact time
};

struct Impacts {
  const Walls& walls;
  const TriangleSurface& surface;  ///< the body, pointing out
  double side;                     ///< 1: the spheres are outside, -1: inside
  double radius;
  Rebound rebound;
  std::function<bool(const Vector3&)> inside;  ///< of the body
};

/// One of the corners, edges or faces of the body, and a point of it.
inline Vector3 random_target(const TriangleSurface& surface, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto& [a, b, c] = surface.triangles[random() % surface.triangles.size()];
  const Vector3& p = surface.points[a];
  const Vector3& q = surface.points[b];
  const Vector3& r = surface.points[c];
  const double u = uniform(random);
  const double v = uniform(random) * (1 - u);
  switch (random() % 4) {
    case 0:
      return p;
    case 1:
      return p + u * (q - p);
    case 2:
      return q + u * (r - q);
    default:
      return p + u * (q - p) + v * (r - p);
  }
}

/// A start from which a sphere hits the target after some sub-steps; its speed [radius per
/// sub-step] is at most 1 (hard), or such that the spring holds it before the centre is a radius
/// behind the wall (soft: the depth is speed over angular frequency, π/10, so up to 1.9 radii of
/// overlap).
inline bool throw_sphere(const Impacts& impacts, std::mt19937_64& random, Vector3& x, Vector3& v) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vector3 target = random_target(impacts.surface, random);
  const Vector3 way = random_direction(random);
  x = target - way * impacts.radius * (1.01 + uniform(random));
  if (impacts.inside(x) != (impacts.side < 0)) return false;
  const double fastest = impacts.rebound == Rebound::hard ? 0.999 : 0.6;
  v = fastest * impacts.radius * uniform(random) * way;
  return true;
}

/// Sends `count` spheres and returns how many of them ended on the wrong side.
inline int leaks(const Impacts& impacts, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const double radius = impacts.radius;
  const double skin = 0.3 * radius;
  const double stiffness = std::pow(std::numbers::pi / 10, 2);
  std::vector<int> elements;
  std::vector<int> before;
  std::vector<WallTouch> touches(most_wall_touches);
  int wrong = 0;
  for (int n = 0; n < count;) {
    Vector3 x;
    Vector3 v;
    if (!throw_sphere(impacts, random, x, v)) continue;
    ++n;
    Vector3 listed(1e9, 0, 0);
    elements.clear();
    bool held = true;
    for (int step = 0; step < 16 && held; ++step) {
      if ((x - listed).norm() > 0.5 * skin) {
        std::swap(elements, before);
        elements.clear();
        held = impacts.walls.nearby(x, radius + 0.5 * skin,
                                    step == 0 ? std::span<const int>{} : before, elements);
        listed = x;
      }
      const int met = impacts.walls.touches(x, radius, elements, touches);
      if (met < 0) return count;
      for (int k = 0; k < met; ++k) {
        const WallTouch& touch = touches[static_cast<std::size_t>(k)];
        const double overlap = radius - touch.distance;
        if (impacts.rebound == Rebound::soft) {
          v += stiffness * overlap * touch.normal;
        } else {
          x += overlap * touch.normal;
          v -= 2 * std::min(0.0, v.dot(touch.normal)) * touch.normal;
        }
      }
      // Between two corners the overlaps are taken back one after the other, which may leave one.
      if (impacts.rebound == Rebound::hard && v.norm() > radius) v *= radius / v.norm();
      x += v;
    }
    // The last way may end behind the wall; what counts is whether it is held there.
    if (held && impacts.inside(x) != (impacts.side < 0)) {
      for (int step = 0; step < 20 && impacts.inside(x) != (impacts.side < 0); ++step) {
        std::swap(elements, before);
        elements.clear();
        held = impacts.walls.nearby(x, radius + 0.5 * skin, before, elements);
        const int met = held ? impacts.walls.touches(x, radius, elements, touches) : 0;
        if (met == 0) break;
        x += (radius - touches[0].distance) * touches[0].normal;
      }
    }
    if (!held || impacts.inside(x) != (impacts.side < 0)) ++wrong;
  }
  return wrong;
}

inline bool in_cube(const Vector3& x, double half) { return x.cwiseAbs().maxCoeff() < half; }

/// Inside a convex body of triangles.
inline bool in_convex(const TriangleSurface& surface, const Vector3& x) {
  for (const auto& [a, b, c] : surface.triangles) {
    const Vector3& p = surface.points[a];
    if ((x - p).dot((surface.points[b] - p).cross(surface.points[c] - p)) > 0) return false;
  }
  return true;
}

}  // namespace fluxpact
