// The longest sub-step: closed forms of the times of contact, and what is refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "dem_server/backends/native/step_limit.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

using std::numbers::pi;

/// The walls' own material comes after the one of the particles.
constexpr std::array<WallsPresent, 1> at_walls{{{1, 0}}};

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
  const StepLimit limit = step_limit(smooth, spheres(1), at_walls);
  EXPECT_NEAR(limit.longest / pair, 1, 1e-14);
  expect_contains(limit.reason, "[glass, glass]");
  // One sphere alone meets only walls.
  ParticleState alone;
  add_sphere(alone, {0, 0, 0}, {0, 0, 0}, 1e-3, 2500);
  EXPECT_NEAR(step_limit(smooth, alone, at_walls).longest / (pair * std::sqrt(2)), 1, 1e-14);
  EXPECT_TRUE(std::isinf(step_limit(smooth, alone, {}).longest));
  // 7/2 k_t of two rolling spheres; with a rolling spring of 2.25 k μ_r² R*² more.
  ParticleSettings rough = glass(ContactLaw::linear, 0.3);
  for (PairSettings& each : rough.contact.pairs) each.tangential_stiffness = 800;
  EXPECT_NEAR(step_limit(ContactLaws(rough), spheres(1), at_walls).longest / pair,
              std::sqrt(1 / 2.8), 1e-14);
  rough.contact.rolling = RollingLaw::spring_dashpot;
  for (PairSettings& each : rough.contact.pairs) each.rolling_friction = 0.4;
  EXPECT_NEAR(step_limit(ContactLaws(rough), spheres(1), at_walls).longest / pair,
              std::sqrt(1 / (2.8 + 2.5 * 2.25 * 0.16)), 1e-14);
}

TEST(StepLimit, hertz_is_a_fifth_of_the_rayleigh_time_at_low_speed) {
  const ContactLaws laws(glass(ContactLaw::hertz, 0));
  const double shear = 5e6 / 2.5;
  const double rayleigh = pi * 1e-3 * std::sqrt(2500 / shear) / (0.1631 * 0.25 + 0.8766);
  for (const double speed : {0.0, 1e-3}) {
    const StepLimit limit = step_limit(laws, spheres(speed), at_walls);
    EXPECT_NEAR(limit.longest, 0.2 * rayleigh, 1e-14 * rayleigh);
    expect_contains(limit.reason, "a fifth of the Rayleigh time of glass");
  }
}

TEST(StepLimit, hertz_is_a_tenth_of_the_time_of_contact_at_high_speed) {
  // Both small spheres might meet head on, each at the largest speed.
  const double effective = 5e6 / (2 * (1 - 0.0625));
  const double m = 0.5 * mass(1e-3);
  const double contact = 2.868 * std::pow(m * m / (0.5e-3 * effective * effective * 20), 0.2);
  const StepLimit limit =
      step_limit(ContactLaws(glass(ContactLaw::hertz, 0)), spheres(10), at_walls);
  EXPECT_NEAR(limit.longest, 0.1 * contact, 1e-12 * contact);
  expect_contains(limit.reason, "[glass, glass] at 20 m/s");
  // With friction the tangential spring is stiffer: 7/2 of 8 G*/(2 E*) = 2 (1 - ν)/(2 - ν).
  const double ratio = 3.5 * 2 * 0.75 / 1.75;
  EXPECT_NEAR(step_limit(ContactLaws(glass(ContactLaw::hertz, 0.5)), spheres(10), at_walls).longest,
              0.1 * contact / std::sqrt(ratio), 1e-12 * contact);
}

TEST(StepLimit, hertz_knows_the_speed_of_walls) {
  const ContactLaws laws(glass(ContactLaw::hertz, 0));
  ParticleState alone;
  add_sphere(alone, {0, 0, 0}, {3, 0, 0}, 1e-3, 2500);
  const double effective = 5e6 / (2 * (1 - 0.0625));
  const double m = mass(1e-3);
  const std::array<WallsPresent, 1> moving{{{1, 17}}};
  const double contact = 2.868 * std::pow(m * m / (1e-3 * effective * effective * 20), 0.2);
  const StepLimit limit = step_limit(laws, alone, moving);
  EXPECT_NEAR(limit.longest, 0.1 * contact, 1e-12 * contact);
  expect_contains(limit.reason, "[glass, walls] at 20 m/s");
}

/// A box whose floor moves, and a sphere of Hertz' law that rests above it.
Scene moving_floor(const MotionSettings& motion, double time_step) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  const MaterialSettings soft = glass(ContactLaw::hertz, 0).materials.at("glass");
  scene.particles.materials["glass"] = soft;
  scene.particles.contact = glass(ContactLaw::hertz, 0).contact;
  SurfaceSettings floor;
  floor.type = SurfaceType::plane;
  floor.normal = Vector3::UnitZ();
  floor.motion = motion;
  scene.particles.surfaces.emplace_back("floor", floor);
  scene.particles.time_step = time_step;
  scene.coupling.window = time_step;
  return scene;
}

TEST(StepLimit, of_an_engine_counts_in_the_speed_of_its_moving_walls) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {0, 0, 0}, 1e-3, 2500);
  MotionSettings shifts, shakes, turns;
  shifts.type = MotionType::translation;
  shifts.velocity = {0, 0, 20};
  shakes.type = MotionType::vibration;
  shakes.frequency = 1000;
  shakes.amplitude = {0, 0, 20 / (2 * pi * 1000)};
  turns.type = MotionType::rotation;  // the corners at z = 0 are 0.01 √2 m from the axis
  turns.point = {0.01, 0.01, 0};
  turns.direction = Vector3::UnitZ();
  turns.rate = 20 / (0.01 * std::sqrt(2.0));
  const double effective = 5e6 / (2 * (1 - 0.0625));
  const double m = mass(1e-3);
  const double limit = 0.2868 * std::pow(m * m / (1e-3 * effective * effective * 20), 0.2);
  for (const MotionSettings& motion : {shifts, shakes, turns}) {
    EXPECT_NO_THROW(make_engine(moving_floor(motion, 0.99 * limit), state));
    const std::string text =
        message_of<ConfigError>([&] { make_engine(moving_floor(motion, 1.01 * limit), state); });
    expect_contains(text, "[glass, walls] at 20 m/s");
  }
  EXPECT_NO_THROW(make_engine(moving_floor({}, 1.01 * limit), state));
}

TEST(StepLimit, counts_in_from_the_start_what_can_come_in) {
  Scene scene = box_scene({0.02, 0.02, 0.02}, {Axis::x});
  add_laws(scene, 1000, 0.9, 0);
  InflowSettings inflow;
  inflow.material = "glass";
  SizeSettings sizes;
  sizes.distribution = SizeDistribution::uniform;
  sizes.range = {0.4e-3, 1e-3};
  inflow.sizes = sizes;
  scene.particles.inflow.push_back(inflow);
  const double m = sphere_mass(0.2e-3, 2250);
  const double limit = 0.1 * pi * std::sqrt(0.5 * m / 1000);
  scene.particles.time_step = scene.coupling.window = 0.99 * limit;
  EXPECT_NO_THROW(make_engine(scene, {}));
  scene.particles.time_step = scene.coupling.window = 1.01 * limit;
  const std::string text = message_of<ConfigError>([&] { make_engine(scene, {}); });
  expect_contains(text, "once particles.inflow has begun");
  expect_contains(text, fmt::format("at most {:.4g} s", limit));
  // Too large for the period, and of a material without a law.
  scene.particles.time_step = scene.coupling.window = 1e-6;
  scene.particles.inflow[0].sizes->range = {1e-3, 0.03};
  EXPECT_THROW(make_engine(scene, {}), ConfigError);
  scene.particles.inflow[0].sizes.reset();
  scene.particles.inflow[0].diameter = 1e-3;
  scene.particles.materials["steel"].density = 7800;
  scene.particles.inflow[0].material = "steel";
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, {}); }), "[steel, ");
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
  EXPECT_NO_THROW(step_limit(ContactLaws(settings), spheres(0), at_walls));
  for (PairSettings& pair : settings.contact.pairs) pair.cohesion_energy_density = 80000;
  const std::string text =
      message_of<ConfigError>([&] { step_limit(ContactLaws(settings), spheres(0), at_walls); });
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
