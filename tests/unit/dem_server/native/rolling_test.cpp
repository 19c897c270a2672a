// Rolling friction against closed forms: spin that decays, inclines, and the rolling spring.
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/one_contact.hpp"

namespace fluxpact {
namespace {

constexpr double g = 9.81;
constexpr double k = 1000;
constexpr double r = 1e-3;
constexpr double m = 1e-5;
constexpr double rolling = 0.1;

ParticleSettings settings_with(RollingLaw law, double mu, double e = 1) {
  ParticleSettings settings = two_pairs();
  settings.contact.rolling = law;
  return with(settings, [&](PairSettings& pair) {
    pair.friction = mu;
    pair.restitution = e;
    pair.rolling_friction = rolling;
  });
}

/// A ball in equilibrium on the wall z = 0 that is tilted by `angle`.
Flight resting(const ParticleSettings& settings, double angle = 0) {
  Ball ball;
  ball.radius = r;
  ball.mass = m;
  ball.x = {0, 0, r - m * g * std::cos(angle) / k};
  Flight flight(settings, {ball});
  flight.gravity = {g * std::sin(angle), 0, -g * std::cos(angle)};
  flight.step(0);  // the forces of the start
  return flight;
}

TEST(Rolling, constant_torque_takes_spin_at_five_halves_and_then_stops_it) {
  Flight flight = resting(settings_with(RollingLaw::constant_torque, 0));
  flight.balls[0].w = {8, 6, 5};
  flight.step(0);                                 // the torque of the start
  const double rate = 5 * rolling * g / (2 * r);  // 2452 rad/s²: from 10 rad/s to rest in 4.08 ms
  flight.steps(2000, 1e-6);
  const double left = 1 - rate * 2e-3 / 10;
  EXPECT_NEAR(flight.balls[0].w.x(), 8 * left, 1e-9);
  EXPECT_NEAR(flight.balls[0].w.y(), 6 * left, 1e-9);
  flight.steps(3000, 1e-6);
  EXPECT_NEAR(flight.balls[0].w.head<2>().norm(), 0, 1e-12);
  EXPECT_EQ(flight.balls[0].w.z(), 5);  // no torque about the normal
}

TEST(Rolling, on_an_incline_accelerates_by_what_rolling_friction_leaves) {
  for (const RollingLaw law : {RollingLaw::constant_torque, RollingLaw::spring_dashpot}) {
    const double angle = 0.3;
    Flight flight = resting(settings_with(law, 0.8, 0.5), angle);
    // The start, in which the springs are stretched, is over after 10 ms.
    flight.steps(10000, 1e-6);
    const double start = flight.balls[0].v.x();
    flight.steps(20000, 1e-6);
    const double gained = 5.0 / 7 * g * (std::sin(angle) - rolling * std::cos(angle)) * 0.02;
    EXPECT_NEAR((flight.balls[0].v.x() - start) / gained, 1, 1e-6) << static_cast<int>(law);
    EXPECT_NEAR(r * flight.balls[0].w.y() / flight.balls[0].v.x(), 1, 1e-4);
  }
}

TEST(Rolling, spring_holds_a_ball_on_an_incline_that_is_flat_enough) {
  const double angle = 0.9 * std::atan(rolling);
  Flight flight = resting(settings_with(RollingLaw::spring_dashpot, 0.8, 0.5), angle);
  flight.steps(60000, 1e-6);
  const Vector3 place = flight.balls[0].x;
  EXPECT_LT(flight.balls[0].v.norm(), 1e-10);
  flight.steps(10000, 1e-6);
  EXPECT_LT((flight.balls[0].x - place).norm(), 1e-12);
  // It rolled until the torque of the spring is that of gravity, k_r θ = m g sin(a) r.
  const double stiffness = 2.25 * k * rolling * rolling * r * r;
  EXPECT_NEAR(flight.springs.rolling.y() * stiffness / (m * g * std::sin(angle) * r), 1, 1e-6);
}

TEST(Rolling, spring_swings_as_a_damped_oscillator) {
  // Without friction: I θ'' = -k_r θ - C_r θ', I = 2/5 m r², C_r = 2 η sqrt(7/5 m r² k_r).
  ParticleSettings settings = settings_with(RollingLaw::spring_dashpot, 0);
  for (PairSettings& pair : settings.contact.pairs) pair.rolling_damping = 0.2;
  const double stiffness = 2.25 * k * rolling * rolling * r * r;
  const double inertia = 0.4 * m * r * r;
  const double w0 = std::sqrt(stiffness / inertia);
  const double zeta = 0.2 * std::sqrt(1.4 / 0.4);
  const double wd = w0 * std::sqrt(1 - zeta * zeta);
  const auto error = [&](double dt) {
    Flight flight = resting(settings);
    flight.balls[0].w = {0.1, 0, 0};
    flight.step(0);
    const double time = 1e-3;
    flight.steps(static_cast<int>(std::lround(time / dt)), dt);
    const double exact =
        0.1 * std::exp(-zeta * w0 * time) *
        (std::cos(wd * time) - zeta / std::sqrt(1 - zeta * zeta) * std::sin(wd * time));
    return flight.balls[0].w.x() - exact;
  };
  // The dashpot sees a spin half a step old: first order, the error up to w0 dt of the amplitude.
  EXPECT_LT(std::abs(error(1e-6)), 0.1 * w0 * 1e-6);
  EXPECT_NEAR(std::log2(error(1e-6) / error(5e-7)), 1, 0.05);
}

TEST(Rolling, torque_uses_effective_radius_and_inertia_of_unequal_balls) {
  ParticleSettings settings = settings_with(RollingLaw::spring_dashpot, 0.3);
  for (PairSettings& pair : settings.contact.pairs) pair.rolling_damping = 0.2;
  const ContactLaws laws(settings);
  const auto table = law_table<double>(laws);
  const double r1 = 1e-3;
  const double r2 = 3e-3;
  const double m1 = 1e-5;
  const double m2 = 20e-5;
  Touch touch;
  touch.normal = {0, 0, 1};
  touch.overlap = 1e-5;
  touch.spin = {3, 4, 12};
  touch.inverse_mass = 1 / m1 + 1 / m2;
  touch.inverse_radius = 1 / r1 + 1 / r2;
  touch.inverse_inertia = 1 / (m1 * r1 * r1) + 1 / (m2 * r2 * r2);
  const double radius = r1 * r2 / (r1 + r2);
  const double stiffness = 2.25 * k * rolling * rolling * radius * radius;
  const double inertia = 1.4 * m1 * r1 * r1 * m2 * r2 * r2 / (m1 * r1 * r1 + m2 * r2 * r2);
  const Vector3 damped = -2 * 0.2 * std::sqrt(inertia * stiffness) * Vector3(3, 4, 0);
  const int pair = laws.index(0, 0);
  EXPECT_LT((push(table, pair, touch, {}, 0).torque - damped).norm(), 1e-14 * damped.norm());
  // A spring beyond its limit gives the limit, without the dashpot, and is set back to it.
  Springs wound;
  wound.rolling = {0, -1, 0};
  const Pushed limited = push(table, pair, touch, wound, 0);
  const double limit = rolling * radius * k * touch.overlap;
  EXPECT_LT((limited.torque - Vector3(0, limit, 0)).norm(), 1e-14 * limit);
  EXPECT_NEAR(limited.springs.rolling.y(), -limit / stiffness, 1e-14);
  // Constant torque: the limit, against the spin across the normal.
  settings.contact.rolling = RollingLaw::constant_torque;
  const ContactLaws constant(settings);
  const Pushed pushed = push(law_table<double>(constant), pair, touch, {}, 0);
  EXPECT_LT((pushed.torque + limit * Vector3(0.6, 0.8, 0)).norm(), 1e-14 * limit);
}

}  // namespace
}  // namespace fluxpact
