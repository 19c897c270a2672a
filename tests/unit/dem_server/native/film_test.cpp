// Lubrication: the film between surfaces that come close, against the closed form of a sphere that
// coasts through it. With the force −K (1/h − 1/h_r) v and dh = v dt
//   v(h) = v_0 − K/m [ln(h/h_0) − (h − h_0)/h_r],   K = 6π μ R*².
#include <cmath>
#include <numbers>

#include "dem_server/backends/native/step_limit.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double r = 1e-3;
constexpr double viscosity = 0.01;
constexpr double roughness = 1e-6;
constexpr double reach = 1e-4;
const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
/// Of a sphere at a wall over its mass [m/s]. Of two spheres R*² is a quarter, m* a half.
const double wall_speed = 6 * std::numbers::pi * viscosity * r * r / mass;

Scene film_scene(double friction = 0) {
  Scene scene = box_scene({0.01, 0.01, 0.01});
  add_laws(scene, 1000, 1.0, friction);
  scene.fluid.viscosity = viscosity;
  scene.interphase.forces.push_back(InterphaseForce::lubrication);
  scene.interphase.lubrication = {roughness, reach};
  return scene;
}

/// Speed lost from the gap h0 to the gap h, over K/m*.
double lost(double h, double h0) { return std::abs(std::log(h / h0) - (h - h0) / reach); }

/// Largest difference from the closed form of a sphere that coasts from `gap` to or from the wall
/// at z = 0, or of two spheres (half of their relative speed each).
double error_of_coast(double gap, double speed, int spheres, double time_step) {
  ParticleState state;
  const double apart = spheres == 1 ? r + gap : 0.005 + r + 0.5 * gap;
  add_sphere(state, {0.005, 0.005, apart}, {0, 0, speed}, r);
  if (spheres == 2) add_sphere(state, {0.005, 0.005, 0.01 - apart}, {0, 0, -speed}, r);
  const auto engine = make_engine(film_scene(), state);
  const double scale = spheres == 1 ? wall_speed : 0.5 * wall_speed;
  const double closing = spheres == 1 ? speed : 2 * speed;
  double worst = 0;
  for (int window = 0; window < 40; ++window) {
    run(*engine, 2e-5, time_step);
    const ParticleState& now = engine->particles();
    const double h =
        spheres == 1 ? now.position[0].z() - r : now.position[0].z() - now.position[1].z() - 2 * r;
    if (h < 2 * roughness || h > reach) break;
    const double v = spheres == 1 ? now.velocity[0].z() : (now.velocity[0] - now.velocity[1]).z();
    const double expected = std::abs(closing) - scale * lost(h, gap);
    worst = std::max(worst, std::abs(std::abs(v) - expected));
    if (spheres == 2) {
      EXPECT_EQ(now.velocity[0], -now.velocity[1]);
    }
  }
  return worst;
}

TEST(Film, slows_a_sphere_as_theory_says_at_a_wall_and_at_another_to_first_order) {
  for (const int spheres : {1, 2}) {
    // Towards each other from the reach on, and apart from near touch. The step over the time in
    // which the thinnest film stops a sphere, 5e-5 s, is 0.008: the error is a share of that.
    for (const auto& [gap, speed] : {std::pair(reach, -0.1), std::pair(3e-6, 0.05)}) {
      const double coarse = error_of_coast(gap, speed, spheres, 4e-7);
      const double fine = error_of_coast(gap, speed, spheres, 2e-7);
      EXPECT_LT(coarse, 0.008 * std::abs(speed)) << spheres << ' ' << gap;
      EXPECT_GT(coarse, 1e-7) << "nothing was compared";
      EXPECT_NEAR(coarse / fine, 2.0, 0.2) << spheres << ' ' << gap;
    }
  }
}

TEST(Film, acts_within_its_reach_only) {
  ParticleState state;
  add_sphere(state, {0.005, 0.005, r + 1.5 * reach}, {0, 0, -0.01}, r);
  const auto engine = make_engine(film_scene(), state);
  run(*engine, 4.9e-3, 1e-6);  // to 1.01 of the reach
  EXPECT_EQ(engine->particles().velocity[0].z(), -0.01);
  run(*engine, 1e-3, 1e-6);
  EXPECT_GT(engine->particles().velocity[0].z(), -0.01);
}

/// Of an elastic sphere the film takes K/m ln(h_r/roughness) on the way in (the last roughness
/// included), and again on the way out: e = 1 − St_c/St, as Davis, Serayssol & Hinch, J. Fluid
/// Mech. 163 (1986) 479, have it.
TEST(Film, slows_a_rebound_as_the_stokes_number_says) {
  const double one_way = wall_speed * std::log(reach / roughness);
  for (const double faster : {4.0, 8.0, 16.0}) {
    ParticleState state;
    const double speed = faster * one_way;
    add_sphere(state, {0.005, 0.005, r + reach}, {0, 0, -speed}, r);
    const auto engine = make_engine(film_scene(0.3), state);
    run(*engine, 4 * reach / speed + 1e-3, 1e-7);
    // First order: the sphere crosses the last roughness in a few steps of 0.002 of the film's
    // time.
    EXPECT_NEAR(engine->particles().velocity[0].z() / speed, 1 - 2 / faster, 0.02 * 2 / faster);
  }
}

TEST(Film, stops_a_slow_sphere_before_it_touches) {
  const double one_way = wall_speed * lost(roughness, reach);
  ParticleState state;
  add_sphere(state, {0.005, 0.005, r + reach}, {0, 0, -0.5 * one_way}, r);
  const auto engine = make_engine(film_scene(), state);
  run(*engine, 0.05, 1e-6);
  EXPECT_GT(engine->particles().position[0].z(), r + roughness);
  // Creeping: exp(−t/time) with the 1e-4 s and less in which so thin a film stops it.
  EXPECT_LT(std::abs(engine->particles().velocity[0].z()), 1e-6 * one_way);
}

TEST(Film, bounds_the_time_step) {
  ParticleState state;
  add_sphere(state, {0.005, 0.005, 0.005}, Vector3::Zero(), r);
  const auto engine = make_engine(film_scene(), state);
  const double stop = 1 / (wall_speed * (1 / roughness - 1 / reach));
  const std::vector<Vector3> none{Vector3::Zero()};
  EXPECT_NO_THROW(engine->advance(0.2 * stop, 1, none, {}));
  expect_contains(message_of<ConfigError>([&] { engine->advance(0.21 * stop, 1, none, {}); }),
                  "a fifth of the time in which the film of lubrication stops [glass, walls]");
}

TEST(Film, bounds_the_time_step_beside_a_large_fixed_sphere) {
  const Scene scene = film_scene();
  const ContactLaws laws(scene.particles, Film{viscosity, roughness, reach});
  ParticleState state;
  add_sphere(state, {0.002, 0.002, 0.002}, Vector3::Zero(), r);
  add_sphere(state, {0.02, 0.02, 0.02}, Vector3::Zero(), 9 * r);
  state.fixed = {0, 1};
  const double effective = 0.9 * r;
  const double stop = mass / (6 * std::numbers::pi * viscosity * effective * effective *
                              (1 / roughness - 1 / reach));
  EXPECT_NEAR(step_limit(laws, state, {}).longest, 0.2 * stop, 1e-12 * stop);
}

}  // namespace
}  // namespace fluxpact
