// Mixed precision (positions in double, all else in float) beside double precision and closed
// forms. A float rounds by at most u = 2^-24 of its value.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "dem_server/backends/engine_state.hpp"
#include "tests/unit/dem_server/native/oblique_impact.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

constexpr double u = 0x1p-24;

TEST(Mixed, impacts_are_those_of_double_to_the_rounding_of_their_sub_steps) {
  // 310 sub-steps of contact with the wall, 220 with a sphere; in each the velocities are rounded
  // once and what is added to them some ten times, the sum of which is at most the gain of 2 v_n.
  constexpr double rounding = (310 + 2 * 10) * u;  // of the speed before
  for (const double tangential : {0.5e-3, 5e-3, 15e-3}) {
    const double speed = 1e3 * std::hypot(tangential, oblique::approach);
    for (const auto& hit :
         {std::pair(oblique::hit_wall(tangential), oblique::hit_wall(tangential, Precision::mixed)),
          std::pair(oblique::hit_sphere(tangential),
                    oblique::hit_sphere(tangential, Precision::mixed))}) {
      const auto& [full, mixed] = hit;
      fmt::print(
          "{:>4} mm/s: mixed off double by {:.1e} {:.1e} mm/s, {:.1e} rad/s (allowed {:.1e})\n",
          1e3 * tangential, mixed.normal - full.normal, mixed.tangential - full.tangential,
          mixed.spin - full.spin, rounding * speed);
      EXPECT_NEAR(mixed.normal, full.normal, rounding * speed);
      EXPECT_NEAR(mixed.tangential, full.tangential, rounding * speed);
      EXPECT_NEAR(mixed.spin, full.spin, 2.5 * rounding * speed);  // r w gains 5/2 of what v does
    }
  }
  const oblique::Impact wall = oblique::hit_wall(0.5e-3, Precision::mixed);
  EXPECT_NEAR(wall.normal, oblique::wall_sticks.normal, oblique::tolerance * 5);
  EXPECT_NEAR(wall.tangential, oblique::wall_sticks.tangential, oblique::tolerance * 0.5);
  EXPECT_NEAR(wall.spin, oblique::wall_sticks.spin, oblique::tolerance * 0.6542);
}

TEST(Mixed, momentum_of_an_isolated_cloud_is_kept_to_the_rounding_of_float_at_random) {
  // The forces of a pair are opposite to the last bit in float, too; what is not kept is the
  // rounding of each velocity in each of n sub-steps, by u / 2 of it on average, up as often as
  // down: of N particles together u / 2 sqrt(n / N) of Σ m |v|. A bias of it would give u / 2 · n.
  constexpr int count = 2000;
  constexpr int steps = 2500;
  Scene scene = box_scene(Vector3::Constant(10 * cloud_box));
  scene.particles.walls = WallSource::none;
  scene.particles.numerics.precision = Precision::mixed;
  add_pair(scene, "glass", "glass", 1000, 0.9, 0.5);
  ParticleState state = random_cloud(count, 0.5);
  for (int i = 0; i < count; ++i) {
    state.velocity[i] -= 30 * (state.position[i] - Vector3::Constant(0.5 * cloud_box));
    state.position[i] += Vector3::Constant(4.5 * cloud_box);
  }
  const auto momentum = [](const ParticleState& now, double& scale) {
    Vector3 sum = Vector3::Zero();
    scale = 0;
    for (int i = 0; i < now.size(); ++i) {
      const double mass = std::pow(now.radius[i], 3);
      sum += mass * now.velocity[i];
      scale += mass * now.velocity[i].norm();
    }
    return sum;
  };
  const auto engine = make_engine(scene, state);
  double scale = 0;
  double left = 0;
  const Vector3 before = momentum(engine->particles(), scale);
  run(*engine, 5e-3, 5e-3 / steps);
  const double off = (momentum(engine->particles(), left) - before).norm() / scale;
  const double expected = 0.5 * u * std::sqrt(double{steps} / count);
  fmt::print("isolated cloud in mixed precision: momentum off by {:.1e} (u/2 sqrt(n/N) = {:.1e})\n",
             off, expected);
  EXPECT_LT(left, 0.8 * scale);  // it did collide
  EXPECT_LT(off, 5 * expected);
  EXPECT_GT(off, 0.01 * expected);  // it is float's rounding that is seen
}

/// Mean height [m] of the centres.
double mean_height(const ParticleState& bed) {
  double sum = 0;
  for (const Vector3& position : bed.position) sum += position.z();
  return sum / bed.size();
}

TEST(Mixed, bed_at_rest_keeps_the_mean_height_that_it_has_in_double) {
  constexpr int count = 600;
  constexpr double d = 2e-3;
  constexpr double g = 9.81;
  constexpr double stiffness = 1000;
  const double mass = 2250 * std::numbers::pi / 6 * d * d * d;
  Scene scene = box_scene({0.016, 0.016, 0.06});
  scene.scene.gravity = {0, 0, -g};
  scene.particles.time_step = 2e-5;
  add_laws(scene, stiffness, 0.3, 0.5);
  const PackingBox box{Vector3::Zero(), {0.016, 0.016, 0.02}, {}};
  const auto centres = random_packing(box, count, d, 1);
  ParticleState start;
  for (const Vector3& centre : centres.value()) add_sphere(start, centre, Vector3::Zero(), d / 2);
  const auto full = make_engine(scene, start);
  run(*full, 0.3, 2e-5);
  // The same state, its velocities and springs rounded to floats, and another 0.1 s in both.
  EngineState state;
  full->store(state);
  state.add_number("real_bytes", sizeof(float));
  scene.particles.numerics.precision = Precision::mixed;
  const auto mixed = make_engine(scene, start);
  mixed->restore(state.fields());
  const double before = mean_height(full->particles());
  run(*full, 0.1, 2e-5);
  run(*mixed, 0.1, 2e-5);
  const double height = mean_height(full->particles());
  const double off = mean_height(mixed->particles()) - height;
  // What the weight presses together: the layers above a contact, h / 2 d of them on average, by
  // m g / k each, over h / d layers. Forces and springs that are rounded by u a few times change it
  // by that share; sliding contacts, which hold what they held, amplify it: a hundred times.
  const double layers = 2 * height / d;
  const double pressed = 0.5 * layers * layers * mass * g / stiffness;
  fmt::print(
      "bed of {} at {:.6f} m mean height: mixed off double by {:.1e} m; it is pressed together by "
      "{:.1e} m, and moved by {:.1e} m meanwhile\n",
      count, height, off, pressed, height - before);
  EXPECT_LT(std::abs(off), 100 * u * pressed);
}

}  // namespace
}  // namespace fluxpact
