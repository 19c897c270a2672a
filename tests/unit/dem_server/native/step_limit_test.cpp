// The longest sub-step: closed forms of the times of contact, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dem_server/backends/native/step_limit.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

using std::numbers::pi;

ParticleSettings glass(ContactLaw law, double friction) {
  ParticleSettings settings;
  settings.contact.law = law;
  settings.materials["glass"].density = 2500;
  PairSettings pair;
  pair.friction = friction;
  if (law == ContactLaw::linear) {
    pair.normal_stiffness = 1000;
  } else {
    settings.materials["glass"].youngs_modulus = 5e6;
    settings.materials["glass"].poisson_ratio = 0.25;
    settings.contact.walls = WallMaterialSettings{5e6, 0.25};
  }
  for (const char* other : {"glass", "walls"}) {
    pair.between = {"glass", other};
    settings.contact.pairs.push_back(pair);
  }
  return settings;
}

ParticleState spheres(double speed) {
  ParticleState state;
  add_sphere(state, {0, 0, 0}, {speed, 0, 0}, 1e-3, 2500);
  add_sphere(state, {1, 0, 0}, {0, 0, 0}, 2e-3, 2500);
  return state;
}

double mass(double radius) { return sphere_mass(radius, 2500); }

TEST(StepLimit, linear_is_a_tenth_of_the_shortest_time_of_contact) {
  const double pair = 0.1 * pi * std::sqrt(0.5 * mass(1e-3) / 1000);
  const ContactLaws smooth(glass(ContactLaw::linear, 0));
  const StepLimit limit = step_limit(smooth, spheres(1), true);
  EXPECT_NEAR(limit.longest / pair, 1, 1e-14);
  expect_contains(limit.reason, "[glass, glass]");
  // One sphere alone meets only walls.
  ParticleState alone;
  add_sphere(alone, {0, 0, 0}, {0, 0, 0}, 1e-3, 2500);
  EXPECT_NEAR(step_limit(smooth, alone, true).longest / (pair * std::sqrt(2)), 1, 1e-14);
  EXPECT_TRUE(std::isinf(step_limit(smooth, alone, false).longest));
  // 7/2 k_t of two rolling spheres; with a rolling spring of 2.25 k μ_r² R*² more.
  ParticleSettings rough = glass(ContactLaw::linear, 0.3);
  for (PairSettings& each : rough.contact.pairs) each.tangential_stiffness = 800;
  EXPECT_NEAR(step_limit(ContactLaws(rough), spheres(1), true).longest / pair, std::sqrt(1 / 2.8),
              1e-14);
  rough.contact.rolling = RollingLaw::spring_dashpot;
  for (PairSettings& each : rough.contact.pairs) each.rolling_friction = 0.4;
  EXPECT_NEAR(step_limit(ContactLaws(rough), spheres(1), true).longest / pair,
              std::sqrt(1 / (2.8 + 2.5 * 2.25 * 0.16)), 1e-14);
}

TEST(StepLimit, hertz_is_a_fifth_of_the_rayleigh_time_at_low_speed) {
  const ContactLaws laws(glass(ContactLaw::hertz, 0));
  const double shear = 5e6 / 2.5;
  const double rayleigh = pi * 1e-3 * std::sqrt(2500 / shear) / (0.1631 * 0.25 + 0.8766);
  for (const double speed : {0.0, 1e-3}) {
    const StepLimit limit = step_limit(laws, spheres(speed), true);
    EXPECT_NEAR(limit.longest, 0.2 * rayleigh, 1e-14 * rayleigh);
    expect_contains(limit.reason, "a fifth of the Rayleigh time of glass");
  }
}

TEST(StepLimit, hertz_is_a_tenth_of_the_time_of_contact_at_high_speed) {
  // Both small spheres might meet head on, each at the largest speed.
  const double effective = 5e6 / (2 * (1 - 0.0625));
  const double m = 0.5 * mass(1e-3);
  const double contact = 2.868 * std::pow(m * m / (0.5e-3 * effective * effective * 20), 0.2);
  const StepLimit limit = step_limit(ContactLaws(glass(ContactLaw::hertz, 0)), spheres(10), true);
  EXPECT_NEAR(limit.longest, 0.1 * contact, 1e-12 * contact);
  expect_contains(limit.reason, "[glass, glass] at 20 m/s");
  // With friction the tangential spring is stiffer: 7/2 of 8 G*/(2 E*) = 2 (1 - ν)/(2 - ν).
  const double ratio = 3.5 * 2 * 0.75 / 1.75;
  EXPECT_NEAR(step_limit(ContactLaws(glass(ContactLaw::hertz, 0.5)), spheres(10), true).longest,
              0.1 * contact / std::sqrt(ratio), 1e-12 * contact);
}

TEST(StepLimit, is_named_with_the_contact_and_a_value_that_passes) {
  const StepLimit limit{2e-6, "a fifth of the Rayleigh time of glass, 1e-05 s"};
  const std::string text = message_of<ConfigError>([&] { check_time_step(limit, 3e-6); });
  expect_contains(text, "3e-06 s");
  expect_contains(text, limit.reason);
  expect_contains(text, "at most 2e-06 s");
  EXPECT_NO_THROW(check_time_step(limit, 2e-6));
}

TEST(ContactLaws, refuse_cohesion_that_the_spring_cannot_bear) {
  ParticleSettings settings = glass(ContactLaw::linear, 0);
  settings.contact.cohesion = CohesionLaw::sjkr;
  // The pull of the larger sphere on the wall: 2 π R* c = 1000 N/m at c = 79577 J/m³.
  for (PairSettings& pair : settings.contact.pairs) pair.cohesion_energy_density = 79000;
  EXPECT_NO_THROW(step_limit(ContactLaws(settings), spheres(0), true));
  for (PairSettings& pair : settings.contact.pairs) pair.cohesion_energy_density = 80000;
  const std::string text =
      message_of<ConfigError>([&] { step_limit(ContactLaws(settings), spheres(0), true); });
  expect_contains(text, "[glass, walls]");
  expect_contains(text, "normal_stiffness");
}

TEST(ContactLaws, refuse_what_is_missing_by_name) {
  ParticleSettings settings = glass(ContactLaw::hertz, 0);
  settings.contact.walls.reset();
  expect_contains(message_of<ConfigError>([&] { const ContactLaws laws(settings); }),
                  "particles.contact.walls: missing");
  settings = glass(ContactLaw::hertz, 0);
  settings.materials["glass"].poisson_ratio.reset();
  expect_contains(message_of<ConfigError>([&] { const ContactLaws laws(settings); }),
                  "particles.materials.glass");
  settings = glass(ContactLaw::linear, 0);
  settings.contact.pairs[0].normal_stiffness.reset();
  expect_contains(message_of<ConfigError>([&] { const ContactLaws laws(settings); }),
                  "[glass, glass] has no normal_stiffness");
  settings = glass(ContactLaw::linear, 0);
  settings.contact.cohesion = CohesionLaw::liquid_bridge;
  expect_contains(message_of<ConfigError>([&] { const ContactLaws laws(settings); }),
                  "[glass, glass] has no liquid_volume");
}

}  // namespace
}  // namespace fluxpact
