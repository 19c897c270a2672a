// A million spheres thrown at closed bodies of triangles, mostly at their edges and corners, from
// both sides, with speeds up to a radius per sub-step: none gets through.
#include "tests/unit/dem_server/walls/impacts.hpp"

namespace fluxpact {
namespace {

constexpr double half = 0.5;

/// Half of them as fast as the engine allows, half on springs.
int leaks_of(const Walls& walls, const TriangleSurface& surface, double radius, int count,
             const std::function<bool(const Vector3&)>& inside, std::uint64_t seed) {
  int wrong = 0;
  for (const double side : {1.0, -1.0}) {
    for (const Rebound rebound : {Rebound::hard, Rebound::soft}) {
      wrong += leaks({walls, surface, side, radius, rebound, inside}, count / 4, ++seed);
    }
  }
  return wrong;
}

TEST(WallLeaks, cube_of_twelve_triangles_holds_200000_impacts) {
  const TriangleSurface surface = cube(half, 1);
  const StlFile file(surface);
  const Walls walls = walls_with(file.surface());
  const auto inside = [](const Vector3& x) { return in_cube(x, half); };
  EXPECT_EQ(leaks_of(walls, surface, 0.05, 200000, inside, 100), 0);
}

TEST(WallLeaks, cube_of_triangles_of_half_a_radius_holds_300000_impacts) {
  const TriangleSurface surface = cube(half, 25);
  const StlFile file(surface);
  const Walls walls = walls_with(file.surface());
  const auto inside = [](const Vector3& x) { return in_cube(x, half); };
  EXPECT_EQ(leaks_of(walls, surface, 0.08, 300000, inside, 200), 0);
}

TEST(WallLeaks, ball_of_512_triangles_holds_300000_impacts) {
  const TriangleSurface surface = ball(half, 3);
  const StlFile file(surface);
  const Walls walls = walls_with(file.surface());
  const auto inside = [&](const Vector3& x) {
    // Between the spheres in and around the body the triangles decide.
    if (x.norm() > half) return false;
    return x.norm() < 0.97 * half || in_convex(surface, x);
  };
  EXPECT_EQ(leaks_of(walls, surface, 0.05, 300000, inside, 300), 0);
}

/// An L: its re-entrant edge is convex from inside and concave from outside.
TriangleSurface angle_iron() {
  TriangleSurface surface;
  const Vector3 z(0, 0, 1);
  const std::array<Vector3, 6> outline{Vector3(-0.5, -0.5, -0.5), Vector3(0.5, -0.5, -0.5),
                                       Vector3(0.5, 0, -0.5),     Vector3(0, 0, -0.5),
                                       Vector3(0, 0.5, -0.5),     Vector3(-0.5, 0.5, -0.5)};
  for (std::size_t k = 0; k < 6; ++k) {
    const Vector3 along = outline.at((k + 1) % 6) - outline.at(k);
    append(surface, sheet(outline.at(k), along, z, along.norm() > 0.7 ? 2 : 1, 2));
  }
  for (const Vector3& corner :
       {Vector3(-0.5, -0.5, 0.5), Vector3(0, -0.5, 0.5), Vector3(-0.5, 0, 0.5)}) {
    const Vector3 u(0.5, 0, 0);
    const Vector3 v(0, 0.5, 0);
    append(surface, sheet(corner, u, v, 1, 1));
    append(surface, sheet(corner - z, v, u, 1, 1));
  }
  return surface;
}

TEST(WallLeaks, angle_iron_holds_200000_impacts) {
  const TriangleSurface surface = angle_iron();
  ASSERT_TRUE(measure_surface(with_merged_points(surface, 1e-6)).closed());
  const StlFile file(surface);
  const Walls walls = walls_with(file.surface());
  const auto inside = [](const Vector3& x) {
    return in_cube(x, half) && !(x.x() > 0 && x.y() > 0);
  };
  EXPECT_EQ(leaks_of(walls, surface, 0.05, 200000, inside, 400), 0);
}

}  // namespace
}  // namespace fluxpact
