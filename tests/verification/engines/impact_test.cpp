// Impacts with friction at low speed against closed forms; a free sphere under gravity and a force.
#include <fmt/core.h>

#include <algorithm>

#include "tests/unit/dem_server/native/oblique_impact.hpp"
#include "tests/verification/engines/mixture.hpp"

namespace fluxpact {
namespace {

using oblique::approach;
using oblique::Impact;
using oblique::r;
using oblique::time_step;

Impact hit_wall(double tangential) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, r + 1e-9}, {tangential, 0, -approach}, r);
  const auto engine = make_under_test(oblique::scene_of(1000, Precision::full), state);
  run(*engine, 1e-3, time_step);
  const ParticleState& after = engine->particles();
  return {1e3 * after.velocity[0].z(), 1e3 * after.velocity[0].x(), after.spin[0].y()};
}

Impact hit_sphere(double tangential) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {approach, tangential, 0}, r);
  add_sphere(state, {0.01 + 2 * r + 1e-9, 0.01, 0.01}, Vector3::Zero(), r);
  const auto engine = make_under_test(oblique::scene_of(1000, Precision::full), state);
  run(*engine, 1e-3, time_step);
  const ParticleState& after = engine->particles();
  EXPECT_NEAR(after.spin[0].z(), after.spin[1].z(), 1e-10);
  return {1e3 * after.velocity[0].x(), 1e3 * after.velocity[0].y(), after.spin[0].z()};
}

/// `turned` [rad]: what the line of centres turns by while they touch.
void expect_impact(const char* what, const Impact& ours, const Impact& exact, double speed,
                   double turned) {
  fmt::print("{} {} {:>4} mm/s | {:.5f} {:.5f} {:.4f} | {:.5f} {:.5f} {:.4f}\n", under_test().name,
             what, speed, ours.normal, ours.tangential, ours.spin, exact.normal, exact.tangential,
             exact.spin);
  const double tolerance = under_test().impact_tolerance;
  EXPECT_NEAR(ours.normal, exact.normal, tolerance * 5 + turned * speed) << speed;
  EXPECT_NEAR(ours.tangential, exact.tangential, (tolerance + turned) * speed) << speed;
  EXPECT_NEAR(ours.spin, exact.spin, 2.5 * (tolerance + turned) * speed) << speed;
}

TEST(Impact, on_a_wall_is_that_of_the_closed_form) {
  expect_impact("wall", hit_wall(0.5e-3), oblique::wall_sticks, 0.5, 0);
  expect_impact("wall", hit_wall(5e-3), {4.5, 2.3832, 6.5421}, 5, 0);
  expect_impact("wall", hit_wall(15e-3), oblique::wall_slips(15e-3), 15, 0);
}

TEST(Impact, of_two_spheres_is_that_of_the_closed_form) {
  const auto turned = [](double speed) { return speed * 1e-3 * 2.16e-4 / (2 * r); };
  expect_impact("pair", hit_sphere(0.5e-3), oblique::pair_sticks, 0.5, turned(0.5));
  expect_impact("pair", hit_sphere(5e-3), {0.25, 3.6916, -3.2711}, 5, turned(5));
  expect_impact("pair", hit_sphere(15e-3), oblique::pair_slips(15e-3), 15, turned(15));
}

// Light on heavy and small on large: one restitution for all of them.
TEST(Impact, keeps_the_restitution_of_a_pair_whatever_the_masses) {
  for (const double other : {0.3e-3, 2e-3}) {
    Scene scene = box_scene({0.02, 0.02, 0.02});
    add_laws(scene, 1000, 0.7, 0.0);
    ParticleState state;
    add_sphere(state, {0.01, 0.01, 0.01}, {approach, 0, 0}, r);
    add_sphere(state, {0.01 + r + other + 1e-9, 0.01, 0.01}, Vector3::Zero(), other);
    const auto engine = make_under_test(scene, state);
    run(*engine, 1e-3, 2e-7);
    const ParticleState& after = engine->particles();
    const double parting = after.velocity[1].x() - after.velocity[0].x();
    EXPECT_NEAR(parting, 0.7 * approach, under_test().impact_tolerance * approach) << other;
  }
}

// Two materials, two diameters, free and fixed: each pair and each wall has its own law.
TEST(Law, of_each_pair_without_friction_is_that_of_the_native_engine) {
  Mixture mixture = mixture_of(ContactLaw::linear, 0);
  const double largest = *std::ranges::min_element(mixture.state.radius);
  for (std::size_t row = 0; row < mixture.state.id.size(); ++row) {
    mixture.state.radius[row] = (row % 2 == 0 ? 1.0 : 0.8) * largest;
  }
  const double off = difference_after(mixture, 100);
  fmt::print("{}: velocities differ by {:.2g}\n", under_test().name, off);
  EXPECT_LT(off, 1e-9);  // round-off, grown by collisions
}

// Velocity-Verlet is exact for a constant force: from the first half kick on.
TEST(FreeSphere, gains_the_impulse_of_the_force_of_each_window) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  scene.scene.gravity = {0.5, -1, -9.81};
  add_laws(scene, 1000, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {0.01, 0, 0}, r);
  const auto engine = make_under_test(scene, state);
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  Vector3 velocity = state.velocity[0];
  Vector3 position = state.position[0];
  constexpr double window = 1e-4;
  for (int k = 0; k < 5; ++k) {
    const std::vector<Vector3> force{{1e-4 * k, -2e-4, 3e-5 * (k % 2)}};
    const Vector3 gain = window * (scene.scene.gravity + force[0] / mass);
    engine->advance(window, 20, force, {});
    engine->commit();
    position += window * (velocity + 0.5 * gain);
    velocity += gain;
    // Round-off of 20 sums of some 1e-2.
    EXPECT_LT((engine->particles().velocity[0] - velocity).norm(), 1e-15) << k;
    EXPECT_LT((engine->particles().position[0] - position).norm(), 1e-15) << k;
  }
}

}  // namespace
}  // namespace fluxpact
