// Collisions against closed forms: alone, and through the engine at a wall and between two spheres.
#include "dem_server/backends/hard_sphere/collision.hpp"

#include <cmath>
#include <numbers>

#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double eps = 2.3e-16;
constexpr double radius = 1e-3;
constexpr double v_n = 5e-3;  // m/s
constexpr double e = 0.9;
constexpr double mu = 0.3;

/// Speed after over before of x'' = -w² x - 2 λ x', x(0) = 0, at time t, in small steps (Runge and
/// Kutta's method; its error is (w t / steps)⁴).
double oscillator(double w, double decay, double t) {
  double x = 0;
  double v = 1;
  const int steps = 4000;
  const double h = t / steps;
  const auto force = [&](double at, double speed) { return -w * w * at - 2 * decay * speed; };
  for (int k = 0; k < steps; ++k) {
    const double v1 = v, f1 = force(x, v);
    const double v2 = v + 0.5 * h * f1, f2 = force(x + 0.5 * h * v1, v2);
    const double v3 = v + 0.5 * h * f2, f3 = force(x + 0.5 * h * v2, v3);
    const double v4 = v + h * f3, f4 = force(x + h * v3, v4);
    x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (f1 + 2 * f2 + 2 * f3 + f4);
  }
  return v;
}

TEST(TangentialRestitution, is_what_a_sticking_spring_and_dashpot_do) {
  for (const double restitution : {0.05, 0.1, 0.5, 0.9, 1.0}) {  // the first two creep back
    for (const double ratio : {2.0 / 7.0, 1.0, 0.05}) {
      // k_n = m* = 1: w0 = 1, γ_n = 2 |ln e| / sqrt(π² + ln² e), γ_t = γ_n / 2.
      const double log_e = std::log(restitution);
      const double damping = -2 * log_e / std::hypot(std::numbers::pi, log_e);
      const double duration = std::numbers::pi / std::sqrt(1 - 0.25 * damping * damping);
      const double after = oscillator(std::sqrt(3.5 * ratio), 7.0 / 4.0 * 0.5 * damping, duration);
      EXPECT_NEAR(tangential_restitution_of_springs(restitution, ratio), -after, 1e-10)
          << restitution << " " << ratio;
    }
  }
  // Without damping and with k_t = 2/7 k_n both turn round at one time.
  EXPECT_NEAR(tangential_restitution_of_springs(1, 2.0 / 7.0), 1, 4 * eps);
}

struct After {
  Vector3 velocity, spin;
};

/// A sphere that hits the wall below after 1 ms, seen 1 ms later.
After at_wall(double v_t, std::optional<double> tangential = {}) {
  Scene scene = box_scene(Vector3::Constant(0.02));
  add_collisions(scene, e, mu, tangential);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, radius + v_n * 1e-3}, {v_t, 0, -v_n}, radius);
  const auto engine = make_hard(scene, state);
  run(*engine, 2e-3, 1e-5);
  return {engine->particles().velocity[0], engine->particles().spin[0]};
}

TEST(Wall, turns_the_normal_speed_round) {
  const After after = at_wall(0);
  EXPECT_NEAR(after.velocity.z(), e * v_n, 4 * eps * v_n);
  EXPECT_LT(after.velocity.head<2>().norm(), eps * v_n);
}

// The numbers are those of a sphere on a spring and dashpot with k_t = 2/7 k_n that sticks
// throughout: the same scene gives the same with the native engine.
TEST(Wall, holds_a_sphere_that_sticks_as_springs_would) {
  const After slow = at_wall(0.5e-3);
  EXPECT_NEAR(slow.velocity.x(), 0.23832e-3, 0.00001e-3);
  EXPECT_NEAR(slow.spin.y(), 0.6542, 0.0001);
  const double beta = tangential_restitution_of_springs(e, 2.0 / 7.0);
  const After fast = at_wall(5e-3);
  const double change = 2.0 / 7.0 * (1 + beta) * 5e-3;
  EXPECT_NEAR(fast.velocity.x(), 5e-3 - change, 4 * eps * 5e-3);
  EXPECT_NEAR(fast.spin.y(), 2.5 * change / radius, 8 * eps * 6.5);
  EXPECT_NEAR(fast.spin.y(), 6.5421, 0.0001);
}

TEST(Wall, lets_a_fast_sphere_slip) {
  const After after = at_wall(15e-3);
  EXPECT_NEAR(after.velocity.x(), 12.15e-3, 4 * eps * 15e-3);
  EXPECT_NEAR(after.spin.y(), 7.125, 8 * eps * 7.125);
}

TEST(Wall, takes_the_tangential_restitution_of_the_scene) {
  for (const double beta : {-1.0, 0.0, 0.4, 1.0}) {
    const After after = at_wall(1e-3, beta);
    // The velocity of the surface at the contact, before and after.
    EXPECT_NEAR(after.velocity.x() - radius * after.spin.y(), -beta * 1e-3, 8 * eps * 1e-3) << beta;
  }
}

After of_pair(double v_t) {
  Scene scene = box_scene(Vector3::Constant(0.02));
  add_collisions(scene, e, mu);
  ParticleState state;
  add_sphere(state, {0.01 - 2 * radius - v_n * 1e-3, 0.01 - v_t * 1e-3, 0.01}, {v_n, v_t, 0},
             radius);
  add_sphere(state, {0.01, 0.01, 0.01}, Vector3::Zero(), radius);
  const auto engine = make_hard(scene, state);
  run(*engine, 2e-3, 1e-5);
  EXPECT_NEAR(engine->particles().spin[0].z(), engine->particles().spin[1].z(), 1e-15);
  return {engine->particles().velocity[0], engine->particles().spin[0]};
}

TEST(Pair, shares_what_a_wall_would_do) {
  // In the frame in which the line of centres at contact is x: the start is chosen so.
  const After slow = of_pair(0.5e-3);
  EXPECT_NEAR(slow.velocity.x(), 0.25e-3, 1e-15);
  EXPECT_NEAR(slow.velocity.y(), 0.36916e-3, 0.00001e-3);
  EXPECT_NEAR(slow.spin.z(), -0.3271, 0.0001);
  const After slipping = of_pair(15e-3);
  EXPECT_NEAR(slipping.velocity.y(), 13.575e-3, 1e-14);
  EXPECT_NEAR(slipping.spin.z(), -3.5625, 1e-11);
}

/// Random pairs with an approach, all numbers of order one.
struct RandomPair {
  Collider a, b;
  Vector3 normal;
};
RandomPair random_pair(UniformRandom& random) {
  const auto vector = [&]() -> Vector3 {
    const double x = random.next() - 0.5;
    const double y = random.next() - 0.5;
    return {x, y, random.next() - 0.5};
  };
  RandomPair pair;
  pair.normal = vector().normalized();
  for (Collider* one : {&pair.a, &pair.b}) {
    const Vector3 velocity = vector();
    const Vector3 spin = vector();
    const double size = 0.5 + random.next();
    *one = {velocity, spin, size, 1 / (0.2 + random.next())};
  }
  const double approach = (pair.a.velocity - pair.b.velocity).dot(pair.normal);
  if (approach < 0) pair.a.velocity -= 2 * approach * pair.normal;
  return pair;
}

double energy(const Collider& one) {
  const double mass = 1 / one.inverse_mass;
  return 0.5 * mass * one.velocity.squaredNorm() +
         0.2 * mass * one.radius * one.radius * one.spin.squaredNorm();
}
double energy(const RandomPair& pair) { return energy(pair.a) + energy(pair.b); }
Vector3 momentum(const RandomPair& pair) {
  return pair.a.velocity / pair.a.inverse_mass + pair.b.velocity / pair.b.inverse_mass;
}
/// About the centre of a.
Vector3 angular_momentum(const RandomPair& pair) {
  const auto own = [](const Collider& one) -> Vector3 {
    return 0.4 / one.inverse_mass * one.radius * one.radius * one.spin;
  };
  const Vector3 apart = (pair.a.radius + pair.b.radius) * pair.normal;
  return own(pair.a) + own(pair.b) + apart.cross(pair.b.velocity) / pair.b.inverse_mass;
}

TEST(Collision, conserves_momentum_and_angular_momentum) {
  UniformRandom random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const CollisionLaw law{random.next(), 2 * random.next() - 1, random.next(), true};
    const RandomPair before = random_pair(random);
    RandomPair after = before;
    collide(law, {trial % 2 == 0, 0}, before.normal, after.a, after.b);
    // Some tens of roundings of numbers of order one.
    EXPECT_LT((momentum(after) - momentum(before)).norm(), 30 * eps * 5);
    EXPECT_LT((angular_momentum(after) - angular_momentum(before)).norm(), 30 * eps * 10);
  }
}

TEST(Collision, conserves_energy_where_it_should) {
  UniformRandom random(4);
  int slipping = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const RandomPair before = random_pair(random);
    const double tolerance = 60 * eps * energy(before);
    const auto lost = [&](const CollisionLaw& law, bool conserves) {
      RandomPair after = before;
      collide(law, {conserves, 0}, before.normal, after.a, after.b);
      return energy(before) - energy(after);
    };
    EXPECT_NEAR(lost({1, 0.3, 0, true}, false), 0, tolerance);  // smooth
    EXPECT_NEAR(lost({1, 1, 1e9, true}, false), 0, tolerance);  // perfectly rough
    // At rest, whatever the law; and any other one loses some.
    const CollisionLaw law{0.7, 2 * random.next() - 1, random.next(), true};
    EXPECT_NEAR(lost(law, true), 0, tolerance) << trial;
    EXPECT_GT(lost(law, false), 0) << trial;
    RandomPair after = before;
    collide(law, {true, 0}, before.normal, after.a, after.b);
    const auto slip = [&](const RandomPair& pair) -> Vector3 {
      const Vector3 g =
          pair.a.velocity - pair.b.velocity +
          (pair.a.radius * pair.a.spin + pair.b.radius * pair.b.spin).cross(pair.normal);
      return g - g.dot(pair.normal) * pair.normal;
    };
    if ((slip(after) + law.tangential_restitution * slip(before)).norm() > 1e-9) ++slipping;
  }
  EXPECT_GT(slipping, 200);
  EXPECT_LT(slipping, 800);
}

TEST(Collision, takes_the_normal_energy_that_restitution_says) {
  UniformRandom random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const RandomPair before = random_pair(random);
    RandomPair after = before;
    collide({0.6, 0, 0, true}, {}, before.normal, after.a, after.b);
    const double approach = (before.a.velocity - before.b.velocity).dot(before.normal);
    const double mass = 1 / (before.a.inverse_mass + before.b.inverse_mass);
    EXPECT_NEAR(energy(before) - energy(after), 0.5 * mass * (1 - 0.36) * approach * approach,
                60 * eps * energy(before));
  }
}

TEST(CollisionLaws, refuse_what_cannot_be) {
  const auto message = [](double restitution, double friction, std::optional<double> tangential) {
    Scene scene = box_scene(Vector3::Ones());
    add_collision(scene, "glass", restitution, friction, tangential);
    return message_of<ConfigError>([&] { CollisionLaws{scene.particles}; });
  };
  expect_contains(message(1.2, 0.3, {}), "restitution = 1.2");
  expect_contains(message(0.9, -1, {}), "friction = -1");
  expect_contains(message(0.9, 0.3, 1.5), "tangential_restitution = 1.5");
  Scene scene = box_scene(Vector3::Ones());
  add_collision(scene, "steel", 0.9, 0.3);
  expect_contains(message_of<ConfigError>([&] { CollisionLaws{scene.particles}; }), "`steel`");
}

}  // namespace
}  // namespace fluxpact
