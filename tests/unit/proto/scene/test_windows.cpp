#include <gtest/gtest.h>

#include "proto/scene/scene.hpp"

namespace fluxpact {
namespace {

Scene timed(double end_time, double window, double time_step) {
  Scene scene;
  scene.scene.end_time = end_time;
  scene.coupling.window = window;
  scene.particles.time_step = time_step;
  return scene;
}

TEST(Windows, count_to_the_end_whatever_the_rounding_of_decimals) {
  EXPECT_EQ(windows(timed(1.0, 5e-4, 0)), 2000);
  EXPECT_EQ(windows(timed(0.3, 0.1, 0)), 3);  // 0.3 / 0.1 = 2.9999999999999996 in doubles
  EXPECT_EQ(windows(timed(7e-5 * 123457, 7e-5, 0)), 123457);
}

TEST(Windows, are_none_if_the_end_is_inside_one) {
  EXPECT_EQ(windows(timed(1.0, 0.3, 0)), 0);
  EXPECT_EQ(windows(timed(1.0000001, 0.1, 0)), 0);
  EXPECT_EQ(windows(timed(0.05, 0.1, 0)), 0);
}

TEST(SubSteps, are_the_fewest_not_longer_than_the_time_step) {
  EXPECT_EQ(sub_steps(timed(1, 5e-4, 1.5e-5)), 34);  // 33.3
  EXPECT_EQ(sub_steps(timed(1, 5e-4, 1e-5)), 50);    // not 51 for round-off
  EXPECT_EQ(sub_steps(timed(1, 0.3, 0.1)), 3);
  EXPECT_EQ(sub_steps(timed(1, 1e-3, 1e-3)), 1);
  EXPECT_EQ(sub_steps(timed(1, 1e-3, 0)), 1);  // none given
}

}  // namespace
}  // namespace fluxpact
