// A part of tests/verification/walls/leaks_test.cpp that fits into a unit test, and what is noticed
// of a sphere that is pressed through all the same.
#include "tests/unit/dem_server/walls/impacts.hpp"

namespace fluxpact {
namespace {

TEST(WallLeaks, spheres_thrown_at_a_cube_stay_on_their_side) {
  for (const int n : {1, 5}) {
    const TriangleSurface surface = cube(0.5, n);
    const StlFile file(surface);
    const Walls walls = walls_with(file.surface());
    for (const double side : {1.0, -1.0}) {
      for (const Rebound rebound : {Rebound::hard, Rebound::soft}) {
        const Impacts impacts{walls, surface, side,
                              0.07,  rebound, [](const Vector3& x) { return in_cube(x, 0.5); }};
        EXPECT_EQ(leaks(impacts, 1500, 7), 0)
            << n << " " << side << " " << (rebound == Rebound::hard);
      }
    }
  }
}

TEST(WallLeaks, spheres_thrown_at_a_ball_of_triangles_stay_on_their_side) {
  const TriangleSurface surface = ball(0.5, 2);
  const StlFile file(surface);
  const Walls walls = walls_with(file.surface());
  for (const double side : {1.0, -1.0}) {
    const Impacts impacts{walls,         surface,
                          side,          0.07,
                          Rebound::hard, [&](const Vector3& x) { return in_convex(surface, x); }};
    EXPECT_EQ(leaks(impacts, 1500, 8), 0) << side;
  }
}

TEST(WallLeaks, side_of_a_thin_sheet_is_kept_from_list_to_list) {
  const StlFile file(sheet({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, 3, 3));
  const Walls walls = walls_with(file.surface());
  std::vector<int> elements;
  std::vector<WallTouch> touches(most_wall_touches);
  for (const double side : {1.0, -1.0}) {
    std::vector<int> before;
    for (const double height : {0.1, 0.05, 0.01, -0.02, -0.06, -0.09}) {
      elements.clear();
      const Vector3 x(0.02, 0.03, side * height);
      ASSERT_TRUE(walls.nearby(x, 0.12, before, elements));
      ASSERT_EQ(walls.touches(x, 0.11, elements, touches), 1);
      EXPECT_NEAR(touches[0].distance, height, 1e-14);
      EXPECT_NEAR(touches[0].normal.z(), side, 1e-14);
      before = elements;
    }
    elements.clear();
    EXPECT_FALSE(walls.nearby({0.02, 0.03, -0.13 * side}, 0.12, before, elements))
        << "pressed through";
  }
}

TEST(WallLeaks, sphere_may_leave_a_sheet_on_its_side_or_roll_around_its_rim) {
  const StlFile file(sheet({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, 3, 3));
  const Walls walls = walls_with(file.surface());
  std::vector<int> before;
  std::vector<int> elements;
  std::vector<WallTouch> touches(most_wall_touches);
  ASSERT_TRUE(walls.nearby({0, 0, 0.1}, 0.12, {}, before));
  EXPECT_TRUE(walls.nearby({0, 0, 0.14}, 0.12, before, elements));
  EXPECT_TRUE(elements.empty());
  before.clear();
  for (int n = -5; n <= 25; ++n) {
    const double angle = std::clamp(n / 20.0, 0.0, 1.0) * std::numbers::pi;
    const double inward = n < 0 ? 0.01 * n : (n > 20 ? -0.01 * (n - 20) : 0.0);
    const Vector3 x(0.5 + inward + 0.1 * std::sin(angle), 0.1, 0.1 * std::cos(angle));
    elements.clear();
    ASSERT_TRUE(walls.nearby(x, 0.12, before, elements)) << n;
    ASSERT_EQ(walls.touches(x, 0.11, elements, touches), 1) << n;
    EXPECT_NEAR(touches[0].distance, 0.1, 1e-14) << n;
    EXPECT_NEAR(touches[0].normal.z(), std::cos(angle), 1e-13) << n;
    before = elements;
  }
}

TEST(WallLeaks, sphere_pressed_through_a_tube_is_noticed) {
  const Walls walls = walls_with(cylinder({0, 0, 0}, {0, 0, 1}, 0.5));
  std::vector<int> before;
  std::vector<int> elements;
  ASSERT_TRUE(walls.nearby({0.45, 0, 0}, 0.12, {}, before));
  EXPECT_TRUE(walls.nearby({0.3, 0, 0}, 0.12, before, elements));
  EXPECT_FALSE(walls.nearby({0.63, 0, 0}, 0.12, before, elements));
}

}  // namespace
}  // namespace fluxpact
