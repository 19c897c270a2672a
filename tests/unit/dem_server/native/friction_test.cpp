// Friction: slip that turns to rolling, and oblique impacts, against closed forms.
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/oblique_impact.hpp"

namespace fluxpact {
namespace {

using oblique::approach;
using oblique::hit_sphere;
using oblique::hit_wall;
using oblique::Impact;
using oblique::r;
using oblique::time_step;
using oblique::tolerance;

TEST(Friction, turns_slip_into_rolling_at_five_sevenths) {
  for (const double mu : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    const oblique::Slip slip = oblique::slip_on_a_wall(mu);
    EXPECT_NEAR(slip.end, 2.0 / 7, 1e-2 * 2 / 7) << mu;
    EXPECT_NEAR(slip.speed, 5.0 / 7, 1e-3) << mu;
    EXPECT_NEAR(slip.surface, 5.0 / 7, 1e-3) << mu;
  }
}

/// Spheres of 1 mm, elastic but for friction 0.5 and a rolling friction of 0.02.
Scene rolling_scene(RollingLaw law) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  add_laws(scene, 1000, 1.0, 0.5);
  scene.particles.contact.rolling = law;
  for (PairSettings& pair : scene.particles.contact.pairs) pair.rolling_friction = 0.02;
  return scene;
}

TEST(RollingFriction, slows_a_sphere_that_rolls_on_a_wall) {
  constexpr double g = 9.81;
  constexpr double u0 = 0.1;
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  Scene scene = rolling_scene(RollingLaw::constant_torque);
  scene.scene.gravity = {0, 0, -g};
  ParticleState state;
  add_sphere(state, {5e-3, 0.01, r - mass * g / 1000}, {u0, 0, 0}, r);
  state.spin[0] = {0, u0 / r, 0};
  const auto engine = make_engine(scene, state);
  run(*engine, 0.04, 2e-6);
  // M = μ_r r m g against the spin: u = u0 − 5/7 μ_r g t while it rolls.
  const double lost = 5.0 / 7 * 0.02 * g * 0.04;
  // The tangential spring swings by what the torque loads it with at once: 1e-2 of what is lost.
  EXPECT_NEAR(u0 - engine->particles().velocity[0].x(), lost, 0.02 * lost);
  EXPECT_NEAR(r * engine->particles().spin[0].y(), u0 - lost, 0.02 * lost);
}

TEST(RollingFriction, slows_two_spheres_that_roll_on_each_other) {
  constexpr double push = 1e-3;  // N
  constexpr double w0 = 50;      // rad/s, as cogs turn
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  ParticleState state;
  const Vector3 half(r - 0.5 * push / 1000, 0, 0);
  add_sphere(state, Vector3::Constant(0.01) - half, Vector3::Zero(), r);
  add_sphere(state, Vector3::Constant(0.01) + half, Vector3::Zero(), r);
  state.spin = {Vector3(0, 0, w0), Vector3(0, 0, -w0)};
  const auto engine = make_engine(rolling_scene(RollingLaw::constant_torque), state);
  const std::vector<Vector3> force{{push, 0, 0}, {-push, 0, 0}};
  engine->advance(4e-3, 4000, force, {});
  // M = μ_r R* F, R* = r / 2, on each against its spin, and I = 2/5 m r².
  const double lost = 0.02 * 0.5 * r * push * 4e-3 / (0.4 * mass * r * r);
  EXPECT_NEAR(engine->particles().spin[0].z(), w0 - lost, 1e-3 * lost);
  EXPECT_NEAR(engine->particles().spin[1].z(), -w0 + lost, 1e-3 * lost);
}

TEST(Impact, on_a_wall_rebounds_with_the_restitution) {
  EXPECT_NEAR(hit_wall(0).normal, 4.5, tolerance * 4.5);
}

TEST(Impact, on_a_wall_sticks_at_a_small_angle) {
  const Impact impact = hit_wall(0.5e-3);
  EXPECT_NEAR(impact.tangential, oblique::wall_sticks.tangential, tolerance * 0.5);
  EXPECT_NEAR(impact.spin, oblique::wall_sticks.spin, tolerance * 0.6542);
}

TEST(Impact, on_a_wall_slips_at_a_large_angle) {
  const Impact impact = hit_wall(15e-3);
  const Impact exact = oblique::wall_slips(15e-3, oblique::impulse_factor(0.9));
  EXPECT_NEAR(impact.tangential, exact.tangential, tolerance * (15 - exact.tangential));
  EXPECT_NEAR(impact.spin, exact.spin, tolerance * exact.spin);
}

TEST(Impact, of_two_spheres_sticks_at_a_small_angle) {
  const Impact impact = hit_sphere(0.5e-3);
  EXPECT_NEAR(impact.normal, oblique::pair_sticks.normal, tolerance * 5);
  EXPECT_NEAR(impact.tangential, oblique::pair_sticks.tangential, tolerance * 0.5);
  EXPECT_NEAR(impact.spin, oblique::pair_sticks.spin, 2 * tolerance * 0.3271);
}

TEST(Impact, of_two_spheres_slips_at_a_large_angle) {
  // While they touch the normal turns by v_t t_c / 2r; a hundred times stiffer contact makes that
  // 1.6e-4, so that it changes v_n by 5e-4.
  const Impact impact = hit_sphere(15e-3, Precision::full, 1e5, 0.1 * time_step);
  const Impact exact = oblique::pair_slips(15e-3, oblique::impulse_factor(0.9));
  EXPECT_NEAR(impact.tangential, exact.tangential, 2 * tolerance * (15 - exact.tangential));
  EXPECT_NEAR(impact.spin, exact.spin, 2 * tolerance * std::abs(exact.spin));
}

TEST(Impact, is_the_same_in_all_directions) {
  // The same oblique impact with its axes exchanged in turn: x y z -> y z x -> z x y.
  const auto after = [](int turns) {
    const auto turned = [turns](const Vector3& v) {
      return Vector3(v[(3 - turns) % 3], v[(4 - turns) % 3], v[(5 - turns) % 3]);
    };
    const Vector3 centre = Vector3::Constant(0.01);
    ParticleState state;
    add_sphere(state, centre, turned({approach, 2e-3, 0}), r);
    add_sphere(state, centre + turned({2 * r + 1e-9, 0, 0}), Vector3::Zero(), r);
    const auto engine = make_engine(oblique::scene_of(1000, Precision::full), state);
    run(*engine, 1e-3, time_step);
    // Back to the axes of the first.
    const Vector3& v = engine->particles().velocity[0];
    const Vector3& w = engine->particles().spin[0];
    const auto back = [turns](const Vector3& u) {
      return Vector3(u[turns % 3], u[(turns + 1) % 3], u[(turns + 2) % 3]);
    };
    return std::pair(back(v), back(w));
  };
  const auto [velocity, spin] = after(0);
  EXPECT_GT(std::abs(spin.z()), 0.1);
  for (const int turns : {1, 2}) {
    const auto [v, w] = after(turns);
    // Sums of three squares in another order: rounding, over the 200 sub-steps of the contact and
    // an overlap of 1e-5 of the position.
    EXPECT_LT((v - velocity).norm(), 1e-9 * velocity.norm());
    EXPECT_LT((w - spin).norm(), 1e-9 * spin.norm());
  }
}

TEST(Impact, spring_of_a_sticking_contact_is_second_order) {
  // Sphere pressed on a wall by gravity, elastic, large friction: v = u0 (5 + 2 cos w t) / 7.
  const auto error = [](double dt) {
    constexpr double g = 9.81;
    constexpr double k = 1000;
    constexpr double u0 = 1e-5;
    const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
    Scene scene = box_scene({0.02, 0.02, 0.02});
    scene.scene.gravity = {0, 0, -g};
    add_pair(scene, "glass", "walls", k, 1.0, 100.0);
    ParticleState state;
    add_sphere(state, {0.01, 0.01, r - mass * g / k}, {u0, 0, 0}, r);
    const auto engine = make_engine(scene, state);
    const double time = 1.5e-3;
    run(*engine, time, dt);
    const double w = std::sqrt(3.5 * (2.0 / 7 * k) / mass);
    return engine->particles().velocity[0].x() / u0 - (5 + 2 * std::cos(w * time)) / 7;
  };
  EXPECT_NEAR(std::log2(error(1e-5) / error(5e-6)), 2.0, 0.1);
  EXPECT_NEAR(std::log2(error(5e-6) / error(2.5e-6)), 2.0, 0.1);
}

}  // namespace
}  // namespace fluxpact
