// Attraction: its size, when it begins and ends, and the energy it takes.
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/one_contact.hpp"

namespace fluxpact {
namespace {

using std::numbers::pi;

constexpr double k = 1000;
constexpr double r1 = 1e-3;
constexpr double r2 = 3e-3;
constexpr double radius = r1 * r2 / (r1 + r2);

/// Two unequal balls in contact, sliding along x.
Touch touching(double overlap) {
  Touch touch;
  touch.overlap = overlap;
  touch.inverse_mass = 1e5;
  touch.inverse_radius = 1 / r1 + 1 / r2;
  return touch;
}

ParticleSettings sticky(ContactLaw law, double density) {
  ParticleSettings settings = law == ContactLaw::linear ? two_pairs() : elastic(5e6, 0.3);
  settings.contact.cohesion = CohesionLaw::sjkr;
  return with(settings, [&](PairSettings& pair) { pair.cohesion_energy_density = density; });
}

TEST(Sjkr, pulls_in_proportion_to_the_circle_in_which_the_spheres_cut) {
  for (const ContactLaw law : {ContactLaw::linear, ContactLaw::hertz}) {
    const ContactLaws with_pull(sticky(law, 1e4));
    const ContactLaws without(sticky(law, 0));
    for (const double overlap : {1e-6, 1e-5}) {
      const Touch touch = touching(overlap);
      const double pull = push(law_table<double>(without), 0, touch, {}, 0).force.z() -
                          push(law_table<double>(with_pull), 0, touch, {}, 0).force.z();
      // The circle of two spheres at distance d = r1 + r2 - δ, whose area the law takes to first
      // order in δ over the smaller radius.
      const double d = r1 + r2 - overlap;
      const double half = (d * d + r1 * r1 - r2 * r2) / (2 * d);
      const double area = pi * (r1 * r1 - half * half);
      EXPECT_NEAR(pull / (1e4 * area), 1, overlap / r1);
      EXPECT_NEAR(pull / (1e4 * 2 * pi * radius * overlap), 1, 1e-12);
    }
  }
}

TEST(Sjkr, lets_a_ball_sink_until_the_spring_bears_weight_and_pull) {
  Ball ball;
  ParticleSettings settings = sticky(ContactLaw::linear, 5e4);
  for (PairSettings& pair : settings.contact.pairs) pair.restitution = 0.3;
  ball.x.z() = ball.radius;
  Flight flight(settings, {ball});
  flight.gravity = {0, 0, -9.81};
  flight.steps(20000, 1e-6);
  const double stiffness = k - 2 * pi * ball.radius * 5e4;
  EXPECT_NEAR(flight.overlap / (ball.mass * 9.81 / stiffness), 1, 1e-9);
}

TEST(Sjkr, friction_follows_what_presses_the_surfaces_together) {
  // The spring bears weight and pull, and so does friction: μ k δ, whatever the sum of forces is.
  const ContactLaws laws(sticky(ContactLaw::linear, 3e5));  // the pull exceeds the spring
  Touch touch = touching(1e-5);
  touch.velocity = {1, 0, 0};
  Springs stretched;
  stretched.tangential = {1, 0, 0};
  const Pushed pushed = push(law_table<double>(laws), 0, touch, stretched, 0);
  EXPECT_LT(pushed.force.z(), 0);
  EXPECT_NEAR(pushed.force.x(), -0.3 * k * 1e-5, 1e-15);
}

constexpr double volume = 1e-13;
constexpr double tension = 0.07;
constexpr double angle = 0.4;

ParticleSettings wet(double liquid = volume) {
  ParticleSettings settings = two_pairs();
  settings.contact.cohesion = CohesionLaw::liquid_bridge;
  return with(settings, [&](PairSettings& pair) {
    pair.liquid_volume = liquid;
    pair.surface_tension = tension;
    pair.contact_angle = angle;
    pair.restitution = 1;
  });
}

/// Pull at the distance s of the surfaces.
double pull_at(double s, double effective) {
  const double over = s * std::sqrt(2 * effective / volume);
  return 4 * pi * effective * tension * std::cos(angle) / (1 + 1.05 * over + 2.5 * over * over);
}

const double rupture = (1 + 0.5 * angle) * std::cbrt(volume);

TEST(LiquidBridge, forms_on_contact_and_holds_up_to_its_rupture) {
  const ContactLaws laws(wet());
  const auto table = law_table<double>(laws);
  EXPECT_DOUBLE_EQ(reach_beyond_contact(laws, r2), rupture);
  EXPECT_EQ(reach_beyond_contact(ContactLaws(two_pairs()), r2), 0);
  Springs springs;
  const auto force = [&](double overlap) {
    const Pushed pushed = push(table, 0, touching(overlap), springs, 1e-6);
    springs = pushed.springs;
    return pushed.force.z();
  };
  const double most = 4 * pi * radius * tension * std::cos(angle);
  EXPECT_EQ(force(-1e-6), 0);  // dry until they touch
  EXPECT_NEAR(force(1e-6) / (k * 1e-6 - most), 1, 1e-12);
  for (const double share : {0.01, 0.3, 0.999}) {
    EXPECT_NEAR(force(-share * rupture) / -pull_at(share * rupture, radius), 1, 1e-12) << share;
    EXPECT_EQ(springs.bridge, 1);
  }
  EXPECT_EQ(force(-1.001 * rupture), 0);
  EXPECT_EQ(springs.bridge, 0);
  EXPECT_EQ(force(-0.5 * rupture), 0);  // it has broken
  EXPECT_LT(force(1e-9), -0.99 * most);
  EXPECT_LT(force(-1e-9), -0.99 * most);
}

TEST(LiquidBridge, closed_form_is_near_the_published_pull_of_small_bridges) {
  // Equal spheres that touch: F = 2 π r γ cos θ; on a wall twice that (Willett et al. 2000).
  const ContactLaws laws(wet());
  Touch touch = touching(0);
  touch.overlap = 1e-12;
  touch.inverse_radius = 2 / r1;
  EXPECT_NEAR(push(law_table<double>(laws), 0, touch, {}, 0).force.z() /
                  (-2 * pi * r1 * tension * std::cos(angle)),
              1, 1e-4);
  touch.inverse_radius = 1 / r1;
  EXPECT_NEAR(push(law_table<double>(laws), 0, touch, {}, 0).force.z() /
                  (-4 * pi * r1 * tension * std::cos(angle)),
              1, 1e-4);
}

TEST(LiquidBridge, leaves_pairs_without_liquid_dry) {
  const ContactLaws laws(wet(0));
  const Pushed pushed = push(law_table<double>(laws), 0, touching(1e-6), {}, 0);
  EXPECT_NEAR(pushed.force.z(), k * 1e-6, 1e-15);
  EXPECT_EQ(pushed.springs.bridge, 0);
}

/// ∫ pull ds from 0 to rupture, of a ball on a wall.
double work_of_rupture(double effective) {
  const double q = std::sqrt(2 * effective / volume);
  const double root = std::sqrt(10 - 1.05 * 1.05);
  const double reach = q * rupture;
  return pull_at(0, effective) / q * 2 / root *
         (std::atan((5 * reach + 1.05) / root) - std::atan(1.05 / root));
}

TEST(LiquidBridge, takes_its_work_from_an_elastic_rebound_or_holds_the_ball) {
  constexpr double dt = 5e-7;
  Ball ball;
  const double work = work_of_rupture(ball.radius);
  const double critical = std::sqrt(2 * work / ball.mass);
  for (const double factor : {1.05, 1.5, 4.0}) {
    Ball start = ball;
    start.x.z() = start.radius;
    start.v.z() = -factor * critical;
    Flight flight(wet(), {start});
    flight.steps(60000, dt);
    EXPECT_LT(flight.overlap, -rupture);
    // The bridge is there from the first step that touches and gone in the first beyond rupture:
    // each changes the energy by the pull times at most the way of a step.
    EXPECT_NEAR(flight.energy(), start.energy() - work,
                pull_at(0, ball.radius) * 2 * dt * factor * critical)
        << factor;
  }
  Ball slow = ball;
  slow.x.z() = slow.radius;
  slow.v.z() = -0.95 * critical;
  Flight held(wet(), {slow});
  for (int i = 0; i < 60000; ++i) {
    held.step(dt);
    ASSERT_GT(held.overlap, -rupture);
  }
}

}  // namespace
}  // namespace fluxpact
