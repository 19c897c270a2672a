// Adhesive elastic spheres against the closed forms of Johnson, Kendall and Roberts (1971).
#include <cmath>
#include <numbers>

#include "tests/unit/dem_server/native/one_contact.hpp"

namespace fluxpact {
namespace {

using std::numbers::pi;

constexpr double modulus = 5e6;
constexpr double nu = 0.3;
constexpr double effective = modulus / (2 * (1 - nu * nu));  // E* of the solid on itself
constexpr double radius = 0.75e-3;                           // R* of 1 and 3 mm
constexpr double work = 0.02;

ParticleSettings adhesive(double work_of_adhesion, double mu = 0.3) {
  ParticleSettings settings = elastic(modulus, nu);
  settings.contact.cohesion = CohesionLaw::jkr;
  return with(settings, [&](PairSettings& pair) {
    pair.work_of_adhesion = work_of_adhesion;
    pair.restitution = 1;
    pair.friction = mu;
  });
}

Touch at_overlap(double overlap) {
  Touch touch;
  touch.overlap = overlap;
  touch.inverse_mass = 1e5;
  touch.inverse_radius = 1 / radius;
  return touch;
}

Springs holding() {
  Springs springs;
  springs.bridge = 1;
  return springs;
}

const double smallest = std::cbrt(pi * work * radius * radius / (8 * effective));

TEST(Jkr, overlap_and_force_belong_to_one_contact_radius) {
  const ContactLaws laws(adhesive(work));
  const auto table = law_table<double>(laws);
  for (const double a : {1.02, 1.3, 2.0, 2.6, 5.0, 30.0, 1e3}) {
    const double contact = a * smallest;
    const double overlap =
        contact * contact / radius - std::sqrt(2 * pi * work * contact / effective);
    const double force = 4 * effective * std::pow(contact, 3) / (3 * radius) -
                         std::sqrt(8 * pi * work * effective * std::pow(contact, 3));
    const double got = push(table, 0, at_overlap(overlap), holding(), 0).force.z();
    // Where the surfaces part the radius goes with the root of the overlap: at 1.02 a rounding of
    // the overlap counts 25 times.
    EXPECT_NEAR(got, force, 1e-13 * (std::abs(force) + 1.5 * pi * work * radius)) << a;
  }
}

TEST(Jkr, pulls_at_most_with_three_halves_pi_w_r) {
  const ContactLaws laws(adhesive(work));
  const auto table = law_table<double>(laws);
  const double parting = -3 * smallest * smallest / radius;
  double least = 0;
  for (int i = 0; i < 2000; ++i) {
    const double overlap = parting * (1 - (i + 0.5) / 2000);
    least = std::min(least, push(table, 0, at_overlap(overlap), holding(), 0).force.z());
  }
  EXPECT_NEAR(least / (-1.5 * pi * work * radius), 1, 1e-6);
  // It parts at 5/9 of that.
  const double last = push(table, 0, at_overlap(parting * (1 - 1e-12)), holding(), 0).force.z();
  EXPECT_NEAR(last / (-1.5 * pi * work * radius), 5.0 / 9, 1e-5);
}

TEST(Jkr, holds_from_touch_to_its_parting) {
  const ContactLaws laws(adhesive(work));
  const auto table = law_table<double>(laws);
  const double parting = 3 * smallest * smallest / radius;
  EXPECT_NEAR(reach_beyond_contact(laws, radius), parting, 1e-12 * parting);
  EXPECT_EQ(push(table, 0, at_overlap(-0.1 * parting), {}, 0).force, Vector3::Zero());
  EXPECT_EQ(push(table, 0, at_overlap(1e-9), {}, 0).springs.bridge, 1);
  EXPECT_EQ(push(table, 0, at_overlap(-0.99 * parting), holding(), 0).springs.bridge, 1);
  const Pushed parted = push(table, 0, at_overlap(-1.01 * parting), holding(), 0);
  EXPECT_EQ(parted.springs.bridge, 0);
  EXPECT_EQ(parted.force, Vector3::Zero());
}

TEST(Jkr, without_adhesion_is_hertz) {
  const ContactLaws none(adhesive(0));
  const ContactLaws hertz(
      with(elastic(modulus, nu), [](PairSettings& pair) { pair.restitution = 1; }));
  Touch touch = at_overlap(2e-6);
  touch.velocity = {0.3, 0.1, -0.5};
  Springs springs;
  springs.tangential = {1e-8, -2e-8, 0};
  const Pushed a = push(law_table<double>(none), 0, touch, springs, 1e-6);
  const Pushed b = push(law_table<double>(hertz), 0, touch, springs, 1e-6);
  EXPECT_LT((a.force - b.force).norm(), 1e-13 * b.force.norm());
  EXPECT_LT((a.springs.tangential - b.springs.tangential).norm(), 1e-13 * 2e-8);
  EXPECT_EQ(push(law_table<double>(none), 0, at_overlap(-1e-12), holding(), 0).springs.bridge, 0);
}

TEST(Jkr, friction_follows_the_force_and_twice_the_largest_pull) {
  const ContactLaws laws(adhesive(work));
  Springs stretched = holding();
  stretched.tangential = {1, 0, 0};
  const Pushed pushed = push(law_table<double>(laws), 0, at_overlap(0), stretched, 0);
  EXPECT_LT(pushed.force.z(), 0);
  EXPECT_NEAR(pushed.force.x() / (-0.3 * (pushed.force.z() + 3 * pi * work * radius)), 1, 1e-12);
}

TEST(Jkr, spring_keeps_its_force_when_pressed_and_loses_it_with_the_area) {
  const ContactLaws laws(adhesive(work, 1e6));
  const auto table = law_table<double>(laws);
  const auto radius_at = [&](double overlap) {  // from the elastic force, by its own closed form
    double a = 10 * smallest;
    for (int i = 0; i < 100; ++i) {
      a = std::sqrt(radius * (overlap + std::sqrt(2 * pi * work * a / effective)));
    }
    return a;
  };
  const double dt = 1e-6;
  const double overlap = 1e-6;
  const double change = 2e-7;
  for (const double sign : {-1.0, 1.0}) {
    Touch touch = at_overlap(overlap);
    touch.velocity = {0, 0,
                      sign * change / dt};  // it was deeper (+) or shallower (-) by the change
    Springs springs = holding();
    springs.tangential = {1e-8, 0, 0};
    const double kept = push(table, 0, touch, springs, dt).springs.tangential.x() / 1e-8;
    const double ratio = radius_at(overlap + sign * change) / radius_at(overlap);
    EXPECT_NEAR(kept, std::min(1.0, ratio), 1e-12) << sign;
  }
}

TEST(Jkr, takes_its_work_from_an_elastic_rebound) {
  Ball ball;
  const double scale =
      std::cbrt(std::pow(work, 5) * std::pow(ball.radius, 4) / (effective * effective));
  // Thornton & Ning (1998): 7.09 (w⁵ R⁴ / E*²)^(1/3), here with y = 4^(1/3) at δ = 0.
  const double y = std::cbrt(4.0);
  const double loss = 16.0 / 3 * std::pow(pi / 8, 5.0 / 3) *
                      (std::pow(y, 7) - 1.5 * std::pow(y, 4) - 0.1 * std::pow(y, 10) + 0.6) * scale;
  EXPECT_NEAR(loss / scale, 7.09, 0.005);
  const double critical = std::sqrt(2 * loss / ball.mass);
  for (const double factor : {1.2, 3.0}) {
    Ball start = ball;
    start.x.z() = start.radius;
    start.v.z() = -factor * critical;
    Flight flight(adhesive(work, 0), {start});
    constexpr double dt = 2e-7;
    flight.steps(40000, dt);
    EXPECT_LT(flight.overlap, 0);
    // The force jumps where the contact begins and ends; each is known to a step.
    const double jump = 1.5 * pi * work * ball.radius;
    EXPECT_NEAR(flight.energy(), start.energy() - loss, jump * 2 * dt * factor * critical)
        << factor;
  }
  ball.x.z() = ball.radius;
  ball.v.z() = -0.9 * critical;
  Flight held(adhesive(work, 0), {ball});
  for (int i = 0; i < 40000; ++i) {
    held.step(2e-7);
    ASSERT_EQ(held.springs.bridge, i == 0 && held.overlap <= 0 ? 0 : 1) << i;
  }
}

}  // namespace
}  // namespace fluxpact
