// Friction: slip that turns to rolling, and oblique impacts, against closed forms.
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

TEST(Friction, turns_slip_into_rolling_at_five_sevenths) {
  constexpr double g = 9.81;
  constexpr double r = 0.5e-3;
  constexpr double u0 = 0.1;
  constexpr double k = 1e4;
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 1e4;
  for (const double mu : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    Scene scene = box_scene({0.01, 0.01, 0.01});
    scene.scene.gravity = {0, 0, -g};
    scene.particles.materials["glass"].density = 1e4;
    add_pair(scene, "glass", "walls", k, 1.0, mu);
    scene.particles.contact.pairs.back().tangential_stiffness = k;
    ParticleState state;
    add_sphere(state, {1e-3, 5e-3, r - mass * g / k}, {u0, 0, 0}, r, 1e4);
    const auto engine = make_engine(scene, state);
    double slip_end = 0;
    double speed = 0;
    double surface_speed = 0;
    constexpr int windows = 2000;
    for (int window = 1; window <= windows; ++window) {
      run(*engine, 1e-5, 1e-6);
      const double u = engine->particles().velocity[0].x();
      const double rw = r * engine->particles().spin[0].y();
      if (slip_end == 0 && u <= rw) slip_end = window * 1e-5;
      // The undamped tangential spring goes on swinging by μ g / w_t = 1e-4 m/s: mean of the end.
      if (window > windows - 400) {
        speed += u / 400;
        surface_speed += rw / 400;
      }
    }
    EXPECT_NEAR(mu * g * slip_end / u0, 2.0 / 7, 1e-2 * 2 / 7) << mu;
    EXPECT_NEAR(speed / u0, 5.0 / 7, 1e-3) << mu;
    EXPECT_NEAR(surface_speed / u0, 5.0 / 7, 1e-3) << mu;
  }
}

/// A sphere with velocity (v_n, v_t) hits a wall or an equal sphere at rest.
struct Impact {
  double normal, tangential, spin;  // of the first sphere after the impact [mm/s, mm/s, rad/s]
};

constexpr double r = 1e-3;
constexpr double speed = 5e-3;
constexpr double time_step = 1e-6;

Scene impact_scene() {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  add_laws(scene, 1000, 0.9, 0.3);
  return scene;
}

Impact hit_wall(double tangential) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, r + 1e-6}, {tangential, 0, -speed}, r);
  const auto engine = make_engine(impact_scene(), state);
  run(*engine, 1e-3, time_step);
  const ParticleState& after = engine->particles();
  return {1e3 * after.velocity[0].z(), 1e3 * after.velocity[0].x(), after.spin[0].y()};
}

Impact hit_sphere(double tangential, double stiffness, double dt) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  add_laws(scene, stiffness, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {speed, tangential, 0}, r);
  add_sphere(state, {0.01 + 2 * r + 1e-9, 0.01, 0.01}, Vector3::Zero(), r);
  const auto engine = make_engine(scene, state);
  run(*engine, 1000 * dt, dt);
  const ParticleState& after = engine->particles();
  EXPECT_NEAR(after.spin[0].z(), after.spin[1].z(), 1e-12);
  return {1e3 * after.velocity[0].x(), 1e3 * after.velocity[0].y(), after.spin[0].z()};
}

/// Friction follows |F_n| and so acts in the attractive end of the contact, too: ∫|F_n| dt over m
/// (1 + e) v_n.
double impulse_factor(double e) {
  const double l = std::log(e);
  const double z = -l / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
  const double d = std::sqrt(1 - z * z);
  // v(τ) of the damped oscillator from v = -1, and its largest value, where the force changes sign.
  const auto v = [&](double tau) {
    return -std::exp(-z * tau) * (std::cos(d * tau) - z / d * std::sin(d * tau));
  };
  const double most = v((std::numbers::pi - std::atan2(2 * z * d, d * d - z * z)) / d);
  return ((1 + most) + (most - e)) / (1 + e);
}

// Tolerance of all impacts: the moment of touching is known to a sub-step only, which changes the
// impulse of the dashpot by up to γ dt / 2 = 3.5e-4 (wall), 4.9e-4 (pair) of itself; the dashpot's
// lag as much again.
constexpr double tolerance = 1e-3;

TEST(Impact, on_a_wall_rebounds_with_the_restitution) {
  EXPECT_NEAR(hit_wall(0).normal, 4.5, tolerance * 4.5);
}

TEST(Impact, on_a_wall_sticks_at_a_small_angle) {
  const Impact impact = hit_wall(0.5e-3);
  EXPECT_NEAR(impact.tangential, 0.23832, tolerance * 0.5);
  EXPECT_NEAR(impact.spin, 0.6542, tolerance * 0.6542);
}

TEST(Impact, on_a_wall_slips_at_a_large_angle) {
  const Impact impact = hit_wall(15e-3);
  const double loss = 0.3 * 1.9 * 5 * impulse_factor(0.9);
  EXPECT_NEAR(impact.tangential, 15 - loss, tolerance * loss);
  EXPECT_NEAR(impact.spin, 2.5 * loss, tolerance * 2.5 * loss);
}

TEST(Impact, of_two_spheres_sticks_at_a_small_angle) {
  const Impact impact = hit_sphere(0.5e-3, 1000, time_step);
  EXPECT_NEAR(impact.normal, 0.25, tolerance * 5);
  EXPECT_NEAR(impact.tangential, 0.36916, tolerance * 0.5);
  EXPECT_NEAR(impact.spin, -0.3271, 2 * tolerance * 0.3271);
}

TEST(Impact, of_two_spheres_slips_at_a_large_angle) {
  // While they touch the normal turns by v_t t_c / 2r; a hundred times stiffer contact makes that
  // 1.6e-4, so that it changes v_n by 5e-4.
  const Impact impact = hit_sphere(15e-3, 1e5, 0.1 * time_step);
  const double loss = 0.5 * 0.3 * 1.9 * 5 * impulse_factor(0.9);
  EXPECT_NEAR(impact.tangential, 15 - loss, 2 * tolerance * loss);
  EXPECT_NEAR(impact.spin, -2.5 * loss, 2 * tolerance * 2.5 * loss);
}

TEST(Impact, is_the_same_in_all_directions) {
  // The same oblique impact with its axes exchanged in turn: x y z -> y z x -> z x y.
  const auto after = [](int turns) {
    const auto turned = [turns](const Vector3& v) {
      return Vector3(v[(3 - turns) % 3], v[(4 - turns) % 3], v[(5 - turns) % 3]);
    };
    const Vector3 centre = Vector3::Constant(0.01);
    ParticleState state;
    add_sphere(state, centre, turned({speed, 2e-3, 0}), r);
    add_sphere(state, centre + turned({2 * r + 1e-9, 0, 0}), Vector3::Zero(), r);
    const auto engine = make_engine(impact_scene(), state);
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
