// Distances and normals of the smooth surfaces, and of triangles that stand for them.
#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {
namespace {

/// Coordinates are of the size 1, and each result a few operations away from them.
constexpr double rounding = 1e-14;

TEST(WallsAnalytic, plane_is_touched_at_its_distance_and_holds_what_is_behind_it) {
  const Walls walls = walls_with(plane({0, 0, 0.2}, {0, 0, 5}));
  for (const double height : {0.09, 0.0, -0.03, -0.5}) {
    const auto touches = touches_at(walls, {0.3, -0.4, 0.2 + height}, 0.1);
    ASSERT_EQ(touches.size(), 1U);
    EXPECT_NEAR(touches[0].distance, height, rounding);
    EXPECT_LE((touches[0].normal - Vector3::UnitZ()).norm(), rounding);
    EXPECT_EQ(touches[0].velocity, Vector3::Zero());
  }
  EXPECT_TRUE(touches_at(walls, {0, 0, 0.2 + 0.1001}, 0.1).empty());
}

TEST(WallsAnalytic, cylinder_is_touched_from_inside_and_outside_along_the_radius) {
  const Vector3 start(0.1, -0.2, 0.3);
  const Vector3 axis = Vector3(1, 2, -1).normalized();
  const Walls walls = walls_with(cylinder(start, 3 * axis, 0.5));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 0; n < 200; ++n) {
    const Vector3 radial = axis.cross(random_direction(random)).normalized();
    const double gap = 0.099 * uniform(random);
    const Vector3 foot = start + uniform(random) * axis;
    const auto touches = touches_at(walls, foot + (0.5 + gap) * radial, 0.1);
    ASSERT_EQ(touches.size(), 1U);
    EXPECT_NEAR(touches[0].distance, std::abs(gap), rounding);
    const Vector3 expected = gap < 0 ? Vector3(-radial) : radial;
    EXPECT_LE((touches[0].normal - expected).norm(), rounding);
  }
}

TEST(WallsAnalytic, short_cylinder_ends_in_a_rim) {
  const Walls walls = walls_with(cylinder({0, 0, 0}, {0, 0, 1}, 0.5, 0.4));
  const auto on_rim = touches_at(walls, {0.53, 0, 0.44}, 0.1);
  ASSERT_EQ(on_rim.size(), 1U);
  EXPECT_NEAR(on_rim[0].distance, 0.05, rounding);
  EXPECT_LE((on_rim[0].normal - Vector3(0.6, 0, 0.8)).norm(), 20 * rounding);
  const auto on_shell = touches_at(walls, {0.53, 0, 0.39}, 0.1);
  ASSERT_EQ(on_shell.size(), 1U);
  EXPECT_NE(on_shell[0].feature, on_rim[0].feature);
  EXPECT_TRUE(touches_at(walls, {0.53, 0, 0.51}, 0.1).empty());
}

TEST(WallsAnalytic, cone_is_touched_square_to_its_slant) {
  SurfaceSettings cone = cylinder({0, 0, 0}, {0, 0, 1}, 0.1, 0.4);
  cone.type = SurfaceType::cone;
  cone.end_radius = 0.4;  // 3 across, 4 along
  const Walls walls = walls_with(cone);
  const Vector3 on_it(0.25, 0, 0.2);
  const Vector3 outward(0.8, 0, -0.6);
  for (const double gap : {0.05, -0.05}) {
    const auto touches = touches_at(walls, on_it + gap * outward, 0.1);
    ASSERT_EQ(touches.size(), 1U);
    EXPECT_NEAR(touches[0].distance, 0.05, rounding);
    EXPECT_LE((touches[0].normal - std::copysign(1, gap) * outward).norm(), 20 * rounding);
  }
}

TEST(WallsAnalytic, nearest_point_of_a_tube_is_that_of_a_search_over_its_points) {
  SurfaceSettings cone = cylinder({0.1, 0.2, -0.3}, {1, 0, 2}, 0.3, 0.5);
  cone.type = SurfaceType::cone;
  cone.end_radius = 0.1;
  const Tube tube = make_tube(cone);
  const Vector3 u = tube.axis.unitOrthogonal();
  const Vector3 v = tube.axis.cross(u);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  constexpr int steps = 300;
  for (int n = 0; n < 20; ++n) {
    const Vector3 x(uniform(random), uniform(random), uniform(random));
    const double distance = (x - nearest_on(tube, x).point).norm();
    double least = 1e9;
    for (int i = 0; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const double radius = 0.3 - 0.2 * share;
      for (int j = 0; j < steps; ++j) {
        const double angle = 2 * std::numbers::pi * j / steps;
        const Vector3 point = tube.start + 0.5 * share * tube.axis +
                              radius * (std::cos(angle) * u + std::sin(angle) * v);
        least = std::min(least, (x - point).norm());
      }
    }
    EXPECT_LE(distance, least + rounding);
    // A point of the search is within half a step of any point of the tube.
    const double half_step = 0.5 * std::hypot(0.54 / steps, 2 * std::numbers::pi * 0.3 / steps);
    EXPECT_GE(distance, least - half_step);
  }
}

TEST(WallsAnalytic, triangles_of_a_plane_are_that_plane_and_one_feature) {
  const Vector3 u = Vector3(1, 2, 0.5).normalized();
  const Vector3 v = u.cross(Vector3(0.3, -1, 1)).normalized();
  const StlFile file(sheet({-0.2, -0.6, -0.2}, u, v, 3, 4));
  const Walls triangles = walls_with(file.surface());
  const Walls exact = walls_with(plane({-0.2, -0.6, -0.2}, u.cross(v)));
  // Across diagonals and points of the grid, along an edge and off all of them.
  for (const double shear : {0.0, 4.0 / 3.0, 0.37}) {
    for (int n = 0; n <= 600; ++n) {
      const double along = 0.1 + 0.8 * n / 600.0;
      const double across = shear == 0 ? 0.25 : 0.1 + 0.55 * shear * n / 600.0;
      const Vector3 x = Vector3(-0.2, -0.6, -0.2) + along * u + across * v + 0.06 * u.cross(v);
      const auto one = touches_at(triangles, x, 0.07);
      const auto two = touches_at(exact, x, 0.07);
      ASSERT_EQ(one.size(), 1U) << along << " " << across;
      EXPECT_NEAR(one[0].distance, two[0].distance, rounding);
      EXPECT_LE((one[0].normal - two[0].normal).norm(), rounding / 0.06);
      EXPECT_EQ(one[0].feature, 0);
    }
  }
}

/// Largest deviation of a polyhedron of edges `edge` from a smooth surface of radius R: the sagitta
/// of the circle around a triangle, at most edge²/6R for a triangle with a circumradius of edge/√3,
/// and in the normal the angle edge/√3R.
TEST(WallsAnalytic, ball_of_triangles_is_a_ball_up_to_its_sagitta) {
  constexpr double radius = 0.5;
  const TriangleSurface surface = ball(radius, 4);
  double edge = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    edge = std::max(edge, (surface.points[a] - surface.points[b]).norm());
    edge = std::max(edge, (surface.points[b] - surface.points[c]).norm());
    edge = std::max(edge, (surface.points[c] - surface.points[a]).norm());
  }
  const StlFile file(surface);
  const Walls walls = walls_with(file.surface());
  std::mt19937_64 random(3);
  double worst = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vector3 direction = random_direction(random);
    const double sign = n % 2 == 0 ? 1 : -1;
    const auto touches = touches_at(walls, (radius + sign * 0.08) * direction, 0.1);
    ASSERT_EQ(touches.size(), 1U) << direction.transpose();
    const double error = touches[0].distance - 0.08;
    worst = std::max(worst, std::abs(error));
    EXPECT_LE(std::abs(error), 1.01 * edge * edge / (6 * radius));
    EXPECT_LE((sign * touches[0].normal - direction).norm(),
              1.2 * edge / (std::sqrt(3.0) * radius));
  }
  EXPECT_GT(worst, 0.1 * edge * edge / (6 * radius));  // the bound is no generous one
}

TEST(WallsAnalytic, cylinder_of_facets_is_a_cylinder_up_to_its_chord) {
  constexpr int n = 96;
  const StlFile file(tube_of_facets(0.5, 0.5, n, 3));
  const Walls facets = walls_with(file.surface());
  const Walls exact = walls_with(cylinder({0, 0, 0}, {0, 0, 1}, 0.5));
  const double chord_error = 0.5 * (1 - std::cos(std::numbers::pi / n));
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 2000; ++k) {
    const double angle = std::numbers::pi * uniform(random);
    const double distance = 0.5 + 0.15 * uniform(random);
    const Vector3 x(distance * std::cos(angle), distance * std::sin(angle), 0.3 * uniform(random));
    if (std::abs(distance - 0.5) < chord_error) continue;  // between facet and cylinder
    const auto one = touches_at(facets, x, 0.2);
    const auto two = touches_at(exact, x, 0.2);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_NEAR(one[0].distance, two[0].distance, chord_error + rounding);
    EXPECT_LE((one[0].normal - two[0].normal).norm(), 1.001 * std::numbers::pi / n);
  }
}

}  // namespace
}  // namespace fluxpact
