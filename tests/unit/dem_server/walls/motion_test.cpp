// Walls that move: where they are, how fast, and how far they went.
#include "tests/unit/dem_server/walls/surfaces.hpp"

namespace fluxpact {
namespace {

constexpr double pi = std::numbers::pi;

MotionSettings rotation(const Vector3& point, const Vector3& direction, double rate) {
  MotionSettings motion;
  motion.type = MotionType::rotation;
  motion.point = point;
  motion.direction = direction;
  motion.rate = rate;
  return motion;
}

TEST(WallMotion, vibrating_plane_is_where_the_sine_says_with_its_velocity) {
  SurfaceSettings floor = plane({0, 0, 0}, {0, 0, 1});
  floor.motion.type = MotionType::vibration;
  floor.motion.amplitude = {0.01, 0, 0.02};
  floor.motion.frequency = 50;
  floor.motion.phase = 0.3;
  Walls walls = walls_with(floor);
  for (const double time : {0.0, 0.003, 0.0071, 1.2345}) {
    walls.place(time);
    const double at = 2 * pi * 50 * time + 0.3;
    const auto touches = touches_at(walls, {0, 0, 0.05}, 0.1);
    ASSERT_EQ(touches.size(), 1U);
    // The argument is up to 400, its rounding 5e-14 of an amplitude of 0.02.
    EXPECT_NEAR(touches[0].distance, 0.05 - 0.02 * std::sin(at), 1e-14);
    const Vector3 velocity = 2 * pi * 50 * std::cos(at) * Vector3(0.01, 0, 0.02);
    EXPECT_LE((touches[0].velocity - velocity).norm(), 1e-12);
  }
}

TEST(WallMotion, velocity_is_the_rate_of_change_of_the_place) {
  std::mt19937_64 random(6);
  for (const MotionType type :
       {MotionType::translation, MotionType::rotation, MotionType::vibration}) {
    MotionSettings motion = rotation({0.1, 0.2, 0.3}, {1, 1, 2}, 7);
    motion.type = type;
    motion.velocity = {1, -2, 0.5};
    motion.amplitude = {0.1, 0.2, 0.3};
    motion.frequency = 2;
    for (int n = 0; n < 20; ++n) {
      const double time = 0.1 * n;
      const double step = 1e-5;
      const Vector3 body = random_direction(random);
      const auto place = [&](double t) {
        const Pose pose = pose_at(motion, t);
        const Vector3 x = pose.turns ? Vector3(pose.pivot + pose.turn * (body - pose.pivot)) : body;
        return Vector3(x + pose.shift);
      };
      const Pose pose = pose_at(motion, time);
      EXPECT_LE((pose.to_body(place(time)) - body).norm(), 1e-14);
      const Vector3 rate = (place(time + step) - place(time - step)) / (2 * step);
      // Third derivative over six, times the step squared; rounding 1e-16 over the step.
      EXPECT_LE((pose.velocity_at(place(time)) - rate).norm(), 400 * step * step + 1e-10);
    }
  }
}

TEST(WallMotion, rotating_drum_carries_its_surface_along_and_stays_where_it_is) {
  SurfaceSettings drum = cylinder({0, 0, 0}, {0, 1, 0}, 0.5);
  drum.motion = rotation({0, 0, 0}, {0, 1, 0}, 3);
  Walls walls = walls_with(drum);
  walls.place(0.77);
  const Vector3 radial = Vector3(0.6, 0, -0.8);
  const auto touches = touches_at(walls, 0.45 * radial + Vector3(0, 0.2, 0), 0.1);
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_NEAR(touches[0].distance, 0.05, 1e-14);
  EXPECT_LE((touches[0].normal + radial).norm(), 1e-13);
  const Vector3 expected = Vector3(0, 3, 0).cross(0.5 * radial);
  EXPECT_LE((touches[0].velocity - expected).norm(), 1e-13);
  EXPECT_EQ(walls.travelled(0, 0.1), 0) << "it turns in itself";
}

TEST(WallMotion, turned_triangles_are_touched_where_they_are_now) {
  const StlFile file(cube(0.3, 4));
  SurfaceSettings rotor = file.surface();
  rotor.motion = rotation({0, 0, 0}, {0, 0, 2}, 1);
  Walls walls = walls_with(rotor);
  const double angle = 0.6;
  walls.place(angle);
  const Vector3 normal(std::cos(angle), std::sin(angle), 0);
  const Vector3 x = 0.35 * normal + Vector3(0, 0, 0.1);
  const auto touches = touches_at(walls, x, 0.1);
  ASSERT_EQ(touches.size(), 1U);
  EXPECT_NEAR(touches[0].distance, 0.05, 1e-14);
  EXPECT_LE((touches[0].normal - normal).norm(), 1e-13);
  EXPECT_LE((touches[0].velocity - Vector3::UnitZ().cross(0.3 * normal)).norm(), 1e-13);
}

TEST(WallMotion, travelled_bounds_the_way_of_every_point_and_is_no_generous_bound) {
  const StlFile file(cube(0.3, 1));
  for (const MotionType type :
       {MotionType::translation, MotionType::rotation, MotionType::vibration}) {
    SurfaceSettings body = file.surface();
    body.motion = rotation({0.1, 0, 0}, {0, 0, 1}, 2);
    body.motion.type = type;
    body.motion.velocity = {0.1, 0.2, 0.2};
    body.motion.amplitude = {0.02, 0.01, 0.02};
    body.motion.frequency = 3;
    Walls walls = walls_with(body);
    for (const double since : {0.0, 0.2}) {
      const double time = since + 0.13;
      walls.place(time);
      const Pose then = pose_at(body.motion, since);
      const Pose now = pose_at(body.motion, time);
      double way = 0;
      for (const Vector3& corner : cube(0.3, 1).points) {
        const auto place = [&](const Pose& pose) {
          return Vector3(pose.pivot + pose.turn * (corner - pose.pivot) + pose.shift);
        };
        way = std::max(way, (place(now) - place(then)).norm());
      }
      EXPECT_LE(way, walls.travelled(since, 0.05) + 1e-14);
      EXPECT_GE(way, 0.85 * walls.travelled(since, 0.05)) << "0.05 of reach more than 0.5 of arm";
    }
  }
}

TEST(WallMotion, sphere_that_a_wall_runs_into_is_pushed_the_way_the_wall_goes) {
  SurfaceSettings piston = cylinder({0, 0, 0}, {0, 0, 1}, 0.3);
  piston.motion.type = MotionType::translation;
  piston.motion.velocity = {0.5, 0, 0};
  Walls walls = walls_with(piston);
  std::vector<int> elements;
  ASSERT_TRUE(walls.nearby({0.42, 0, 0}, 0.15, {}, elements));  // outside, ahead of it
  ASSERT_EQ(elements.size(), 1U);
  std::vector<WallTouch> touches(most_wall_touches);
  walls.place(0.3);  // the shell has passed the centre by 0.03
  ASSERT_EQ(walls.touches({0.42, 0, 0}, 0.1, elements, touches), 1);
  EXPECT_NEAR(touches[0].distance, -0.03, 1e-14);
  EXPECT_NEAR(touches[0].normal.x(), 1, 1e-14);
  EXPECT_NEAR(touches[0].velocity.x(), 0.5, 1e-14);
}

}  // namespace
}  // namespace fluxpact
