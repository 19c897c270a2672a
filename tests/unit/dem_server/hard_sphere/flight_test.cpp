// Times of contact against closed forms, and against a search in small steps.
#include "dem_server/backends/hard_sphere/flight.hpp"

#include <gtest/gtest.h>

#include "dem_server/insertion/random.hpp"

namespace fluxpact {
namespace {

constexpr double eps = 2.3e-16;

TEST(Plane, is_met_at_the_time_of_free_fall) {
  EXPECT_NEAR(first_touch(Fall{0.5, 0, -9.81}, 1), std::sqrt(2 * 0.5 / 9.81), 4 * eps);
  // Thrown up first; and slowed down so that it only just arrives.
  const double up = 2.0;
  EXPECT_NEAR(first_touch(Fall{0.5, up, -9.81}, 1), (up + std::sqrt(up * up + 9.81)) / 9.81,
              4 * eps);
  EXPECT_NEAR(first_touch(Fall{0.5, -1, 0.9}, 5), 2 * 0.5 / (1 + std::sqrt(1 - 0.9)), 4 * eps);
}

TEST(Plane, is_not_met_by_what_turns_before_or_arrives_later) {
  EXPECT_EQ(first_touch(Fall{0.5, -1, 1.1}, 5), never);
  EXPECT_EQ(first_touch(Fall{0.5, 1, 1}, 5), never);
  EXPECT_EQ(first_touch(Fall{0.5, 0, -9.81}, 0.31), never);
}

TEST(Plane, lets_those_part_that_overlap) {
  EXPECT_EQ(first_touch(Fall{-1e-6, 1, 1}, 5), never);
  EXPECT_EQ(first_touch(Fall{-1e-6, -1e-9, 1}, 5), 0);
  // Falls back before it is out: met where it turns.
  EXPECT_DOUBLE_EQ(first_touch(Fall{-1, 1, -2}, 5), 0.5);
  // Comes out and falls back: met at the plane.
  EXPECT_NEAR(first_touch(Fall{-1e-3, 1, -2}, 5), (1 + std::sqrt(1 - 4e-3)) / 2, 4 * eps);
}

Separation along_x(double distance, double speed, double acceleration, double reach) {
  return {Vector3(distance, 0, 0), Vector3(speed, 0, 0), Vector3(acceleration, 0, 0), reach};
}

TEST(Spheres, meet_on_a_line_at_the_time_of_the_closed_form) {
  // Away from each other first, then together: all four roots of the quartic are real.
  const double a = -3.0;
  const double v = 1.0;
  const double gap = 0.25;
  EXPECT_NEAR(first_touch(along_x(1 + gap, v, a, 1), 5), (v + std::sqrt(v * v - 2 * a * gap)) / -a,
              8 * eps);
  // Without acceleration.
  EXPECT_NEAR(first_touch(along_x(3, -2, 0, 1), 5), 1, 8 * eps);
  EXPECT_EQ(first_touch(along_x(3, -2, 0, 1), 0.999), never);
}

TEST(Spheres, pass_each_other_by_a_hair) {
  for (const double offset : {-1e-12, 1e-12}) {
    const Separation passing({-2, 1 + offset, 0}, {1, 0, 0}, {0, 0, 0}, 1);
    const double time = first_touch(passing, 10);
    if (offset > 0) {
      EXPECT_EQ(time, never);
    } else {
      // A root at a minimum: its place is known to the root of the accuracy of the distance.
      EXPECT_NEAR(time, 2 - std::sqrt(2e-12), 1e-7);
    }
  }
}

TEST(Spheres, that_overlap_are_left_alone_until_they_turn) {
  EXPECT_EQ(first_touch(along_x(1 - 1e-6, 1, 0, 1), 5), never);
  EXPECT_EQ(first_touch(along_x(1 - 1e-6, -1e-12, 0, 1), 5), 0);
  EXPECT_NEAR(first_touch(along_x(0.5, 0.1, -1, 1), 5), 0.1, 4 * eps);
}

/// The first of many small steps at whose end the surfaces overlap and approach; before that the
/// separation was positive or rose.
double stepwise(const Separation& separation, double horizon, int steps) {
  for (int k = 0; k <= steps; ++k) {
    const double t = horizon * k / steps;
    if (separation.at(t) <= 0 && separation.slope(t) < 0) return t;
  }
  return never;
}

TEST(Spheres, on_any_parabolas_never_miss_a_contact) {
  UniformRandom random(11);
  const auto vector = [&](double size) -> Vector3 {
    const double x = random.next() - 0.5;
    const double y = random.next() - 0.5;
    return 2 * size * Vector3(x, y, random.next() - 0.5);
  };
  constexpr int steps = 2000;
  int met = 0;
  int met_after_turning = 0;
  int double_dips = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    // Distances, speeds and accelerations at which all kinds of paths occur; some overlap at first.
    const Separation separation(vector(1.2), vector(2.0), vector(8.0), 0.6);
    const double horizon = 0.1 + 2 * random.next();
    const double time = first_touch(separation, horizon);
    const double step = horizon / steps;
    const double found = stepwise(separation, horizon, steps);
    if (time == never) {
      // Nothing, or an overlap that fits between two steps, as the smallest values tell.
      EXPECT_EQ(found, never) << trial;
      continue;
    }
    ++met;
    if (separation.c[1] > 0) ++met_after_turning;
    EXPECT_LE(time, horizon);
    // Not earlier than that the surfaces touch: the sum of the terms' rounding errors.
    double terms = 0;
    for (int k = 4; k >= 0; --k) terms = std::abs(separation.c[k]) + terms * time;
    EXPECT_LE(separation.at(time), 8 * eps * (terms + 0.36)) << trial;
    // Not later than the search in steps, which is late by up to a step.
    EXPECT_LE(time, found) << trial;
    if (found != never && found > time + 2 * step) ++double_dips;
  }
  // All kinds were there; short dips between two steps are few.
  EXPECT_GT(met, 2000);
  EXPECT_GT(met_after_turning, 100);
  EXPECT_LT(double_dips, met / 20);
}

}  // namespace
}  // namespace fluxpact
