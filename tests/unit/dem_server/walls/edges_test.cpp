// Which of the faces, edges and corners around a sphere count as touches.
#include <algorithm>

#include "dem_server/walls/sheet.hpp"
#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {
namespace {

constexpr double half = 0.5;
constexpr double radius = 0.1;

class CubeWalls : public ::testing::TestWithParam<int> {
 protected:
  CubeWalls() : file_(cube(half, GetParam())), walls_(walls_with(file_.surface())) {}
  std::vector<WallTouch> at(const Vector3& x) const { return touches_at(walls_, x, radius); }

  StlFile file_;
  Walls walls_;
};

TEST_P(CubeWalls, convex_edge_is_one_touch_along_the_way_to_it) {
  for (const double y : {-0.4, -0.25, 0.0, 0.13, 0.25, 0.3}) {
    const auto touches = at({half + 0.06, y, half + 0.08 - 0.03});
    ASSERT_EQ(touches.size(), 1U) << y;
    EXPECT_NEAR(touches[0].distance, std::hypot(0.06, 0.05), 1e-14);
    EXPECT_NEAR(touches[0].normal.x(), 0.06 / std::hypot(0.06, 0.05), 1e-13);
    EXPECT_NEAR(touches[0].normal.y(), 0, 1e-13);
  }
}

TEST_P(CubeWalls, convex_edge_and_face_of_one_plane_are_one_touch) {
  const auto touches = at({half - 0.01, 0.11, half + 0.05});
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_NEAR(touches[0].distance, 0.05, 1e-14);
  EXPECT_LE((touches[0].normal - Vector3::UnitZ()).norm(), 1e-14);
}

TEST_P(CubeWalls, corner_from_outside_is_one_touch) {
  const auto touches = at({half + 0.03, half + 0.04, half + 0.05});
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_NEAR(touches[0].distance, Vector3(0.03, 0.04, 0.05).norm(), 1e-14);
}

TEST_P(CubeWalls, concave_corner_has_one_touch_for_each_of_its_faces) {
  const auto edge = at({half - 0.06, 0.05, half - 0.08});
  ASSERT_EQ(edge.size(), 2U);
  EXPECT_NEAR(edge[0].distance, 0.06, 1e-14);
  EXPECT_NEAR(edge[1].distance, 0.08, 1e-14);
  const auto corner = at({half - 0.06, half - 0.07, half - 0.08});
  ASSERT_EQ(corner.size(), 3U);
  EXPECT_LE((corner[0].normal + Vector3::UnitX()).norm(), 1e-14);
  EXPECT_LE((corner[1].normal + Vector3::UnitY()).norm(), 1e-14);
  EXPECT_LE((corner[2].normal + Vector3::UnitZ()).norm(), 1e-14);
}

TEST_P(CubeWalls, rolling_around_an_edge_changes_distance_and_normal_without_a_jump) {
  // Along a path at the height 0.08 above the cube: face, edge, face.
  std::vector<std::int32_t> features;
  Vector3 normal = Vector3::UnitZ();
  for (int n = 0; n <= 400; ++n) {
    const double way = -0.1 + 0.33 * n / 400.0;
    const double quarter = 0.08 * std::numbers::pi / 2;
    const double angle = std::clamp(way, 0.0, quarter) / 0.08;
    Vector3 x(half + 0.08 * std::sin(angle), 0.25, half + 0.08 * std::cos(angle));
    if (way < 0) x.x() += way;
    if (way > quarter) x.z() -= way - quarter;
    const auto touches = at(x);
    ASSERT_EQ(touches.size(), 1U) << way;
    EXPECT_NEAR(touches[0].distance, 0.08, 1e-14);
    EXPECT_LE((touches[0].normal - normal).norm(), 0.011);  // 0.33/400 of way at 0.08
    normal = touches[0].normal;
    if (features.empty() || features.back() != touches[0].feature) {
      features.push_back(touches[0].feature);
    }
  }
  EXPECT_EQ(features.size(), 3U) << "one face, one edge, one face";
}

INSTANTIATE_TEST_SUITE_P(Meshes, CubeWalls, ::testing::Values(1, 2, 7, 40));

TEST(WallEdges, every_place_outside_a_cube_has_the_one_touch_of_its_nearest_point) {
  const StlFile file(cube(half, 3));
  const Walls walls = walls_with(file.surface());
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  int met = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vector3 x(uniform(random), uniform(random), uniform(random));
    const Vector3 nearest = x.cwiseMax(-half).cwiseMin(half);
    const double distance = (x - nearest).norm();
    if (distance < 1e-6) continue;  // inside
    const auto touches = touches_at(walls, x, radius);
    if (distance >= radius) {
      EXPECT_TRUE(touches.empty());
      continue;
    }
    ++met;
    ASSERT_EQ(touches.size(), 1U) << x.transpose();
    EXPECT_NEAR(touches[0].distance, distance, 1e-14);
    EXPECT_LE((touches[0].normal - (x - nearest) / distance).norm(), 1e-14 / distance);
  }
  EXPECT_GT(met, 5000);
}

TEST(WallEdges, face_hides_the_edges_of_its_own_plane_across_a_hole) {
  // A plate with a square hole; the sphere lies on its border and reaches the opposite one.
  TriangleSurface plate;
  const auto add = [&](double x, double y, double w, double h) {
    append(plate, sheet({x, y, 0}, {w, 0, 0}, {0, h, 0}, 1, 1));
  };
  add(-0.5, -0.5, 0.48, 0.48);
  add(-0.02, -0.5, 0.04, 0.48);
  add(0.02, -0.5, 0.48, 0.48);
  add(-0.5, -0.02, 0.48, 0.04);
  add(0.02, -0.02, 0.48, 0.04);
  add(-0.5, 0.02, 0.48, 0.48);
  add(-0.02, 0.02, 0.04, 0.48);
  add(0.02, 0.02, 0.48, 0.48);
  const StlFile file(plate);
  const Walls walls = walls_with(file.surface());
  const auto touches = touches_at(walls, {0.021, 0.003, 0.02}, radius);
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_NEAR(touches[0].distance, 0.02, 1e-14);
  // In the middle of the hole there is no face, and each border is one.
  EXPECT_EQ(touches_at(walls, {0, 0, 0.02}, radius).size(), 4U);
}

TEST(WallEdges, steps_between_coplanar_sheets_that_share_no_point_are_no_double_touch) {
  TriangleSurface floor = sheet({-0.5, -0.5, 0}, {0.5, 0, 0}, {0, 1, 0}, 1, 3);
  append(floor, sheet({0, -0.5, 0}, {0.5, 0, 0}, {0, 1, 0}, 1, 2));  // hanging points in between
  const StlFile file(floor);
  const Walls walls = walls_with(file.surface());
  for (int n = -50; n <= 50; ++n) {
    const auto touches = touches_at(walls, {0.001 * n, 0.03, 0.09}, radius);
    ASSERT_EQ(touches.size(), 1U) << n;
    EXPECT_NEAR(touches[0].distance, 0.09, 1e-14);
  }
}

TEST(WallEdges, baffle_that_stands_on_a_wall_and_the_wall_are_two_touches) {
  TriangleSurface both = sheet({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2);
  append(both, sheet({0, -0.5, 0}, {0, 1, 0}, {0, 0, 0.5}, 2, 2));  // three triangles at an edge
  const StlFile file(both);
  const Walls walls = walls_with(file.surface());
  for (const double x : {-0.06, 0.06}) {
    const auto touches = touches_at(walls, {x, 0.1, 0.07}, radius);
    ASSERT_EQ(touches.size(), 2U);
    EXPECT_NEAR(touches[0].distance, 0.06, 1e-14);
    EXPECT_NEAR(touches[0].normal.x(), std::copysign(1, x), 1e-14);
    EXPECT_NEAR(touches[1].distance, 0.07, 1e-14);
  }
}

TEST(WallEdges, side_of_a_spike_is_right_around_its_sharp_edges_and_its_tip) {
  TriangleSurface spike;
  spike.points = {{0, 0, 0}, {0.1, 0, 0}, {0.02, 0.05, 0}, {0.3, 0.1, 0.5}};
  spike.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  ASSERT_GT(enclosed_volume(spike), 0);
  const StlFile file(spike);
  const Walls walls = walls_with(file.surface());
  const Facets& facets = walls.facets();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  int by_vertex = 0;
  for (int n = 0; n < 20000; ++n) {
    // About a point of an edge, or about a corner.
    const Vector3& a = spike.points[random() % 4];
    const Vector3& b = spike.points[random() % 4];
    const Vector3 x =
        a + uniform(random) * (b - a) + 0.01 * uniform(random) * random_direction(random);
    double least = -1;  // distance from the planes of its faces: negative inside
    for (const WallFacet& facet : facets.facets) {
      least = std::max(least, facet.normal.dot(x - facet.corner));
    }
    if (std::abs(least) < 1e-9) continue;  // on it, as far as rounding knows
    const NearestFacet nearest = nearest_in(walls[0].tree, facets, 0, x);
    by_vertex += nearest.point.part == FacetPart::vertex ? 1 : 0;
    ASSERT_EQ(height(facets, nearest, x) < 0, least < 0) << x.transpose();
  }
  EXPECT_GT(by_vertex, 1000);
}

TEST(WallEdges, sphere_far_larger_than_the_triangles_has_one_touch) {
  const StlFile file(sheet({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, 60, 60));
  const Walls walls = walls_with(file.surface());
  const auto touches = touches_at(walls, {0.011, 0.007, 0.2}, 0.3);
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_NEAR(touches[0].distance, 0.2, 1e-14);
}

}  // namespace
}  // namespace fluxpact
