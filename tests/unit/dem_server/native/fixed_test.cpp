// Fixed particles: nothing moves them, and free ones meet them as if they were infinitely heavy.
#include <cmath>
#include <limits>
#include <numbers>

#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

constexpr double r = 1e-3;
constexpr double stiffness = 1000;
const double mass = 2250 * 4.0 / 3.0 * std::numbers::pi * r * r * r;
const Vector3 middle = Vector3::Constant(0.01);

void fix(ParticleState& state, int row) {
  state.fixed.resize(state.id.size(), 0);
  state.fixed[row] = 1;
}

Scene impact_scene(double e, double mu) {
  Scene scene = box_scene(Vector3::Constant(0.02));
  add_laws(scene, stiffness, e, mu);
  return scene;
}

/// A free sphere flies at one that is fixed.
ParticleState sphere_at_fixed_one(const Vector3& velocity) {
  ParticleState state;
  add_sphere(state, middle, Vector3::Zero(), r);
  add_sphere(state, middle + Vector3(2 * r + 1e-9, 0, 0), velocity, r);
  fix(state, 0);
  return state;
}

TEST(Fixed, sphere_is_met_as_one_of_infinite_mass) {
  // An elastic contact lasts π sqrt(m / k) with the whole mass of the free sphere, not half of it,
  // and its speed turns round.
  const auto engine = make_engine(impact_scene(1.0, 0.0), sphere_at_fixed_one({-0.1, 0, 0}));
  const double half = 0.5 * std::numbers::pi * std::sqrt(mass / stiffness);
  const int steps = static_cast<int>(std::lround(half / 1e-7));
  run(*engine, steps * 1e-7, 1e-7);
  const double overlap = 2 * r - (engine->particles().position[1].x() - middle.x());
  // At the turning point the depth is v sqrt(m / k); half a sub-step off changes it by 1e-7.
  EXPECT_NEAR(overlap, 0.1 * std::sqrt(mass / stiffness), 1e-5 * overlap);
  run(*engine, 1e-3, 1e-7);
  EXPECT_NEAR(engine->particles().velocity[1].x(), 0.1, 1e-6 * 0.1);
  EXPECT_EQ(engine->particles().position[0], middle);
  EXPECT_EQ(engine->particles().velocity[0], Vector3::Zero());
}

TEST(Fixed, sphere_damps_with_the_mass_of_its_partner) {
  // The moment of touching is known to a sub-step, as for impacts on walls.
  for (const double e : {0.3, 0.6, 0.9}) {
    const auto engine = make_engine(impact_scene(e, 0.0), sphere_at_fixed_one({-0.1, 0, 0}));
    run(*engine, 2e-3, 1e-6);
    EXPECT_NEAR(engine->particles().velocity[1].x(), 0.1 * e, 5e-3 * 0.1) << e;
  }
}

TEST(Fixed, sphere_rubs_as_one_that_is_ten_billion_times_heavier) {
  const Vector3 velocity(-0.1, 0.03, 0);
  const auto at_fixed = make_engine(impact_scene(0.9, 0.3), sphere_at_fixed_one(velocity));
  ParticleState heavy = sphere_at_fixed_one(velocity);
  heavy.fixed.clear();
  heavy.density[0] *= 1e10;
  const auto at_heavy = make_engine(impact_scene(0.9, 0.3), heavy);
  run(*at_fixed, 1e-3, 1e-6);
  run(*at_heavy, 1e-3, 1e-6);
  const ParticleState& a = at_fixed->particles();
  const ParticleState& b = at_heavy->particles();
  EXPECT_GT(std::abs(a.spin[1].z()), 1);
  // 1e-10 of the mass, amplified by the 200 sub-steps of the contact.
  EXPECT_LT((a.velocity[1] - b.velocity[1]).norm(), 1e-8 * velocity.norm());
  EXPECT_LT(r * (a.spin[1] - b.spin[1]).norm(), 1e-8 * velocity.norm());
  EXPECT_EQ(a.spin[0], Vector3::Zero());
}

/// Half of a cloud is fixed, some spheres of that half pressed into each other and into walls.
ParticleState half_fixed_cloud() {
  ParticleState state = random_cloud(1000, 1.0);
  for (int row = 0; row < state.size(); row += 2) {
    fix(state, row);
    state.velocity[row].setZero();
    state.radius[row] *= 1.05;
  }
  return state;
}

/// The committed state after windows with gravity, wind and a rollback each.
void expect_fixed_half_to_stay(Precision precision, RollingLaw rolling) {
  Scene scene = cloud_scene({Axis::y});
  scene.scene.gravity = {0, 0, -9.81};
  scene.particles.numerics.precision = precision;
  scene.particles.contact.rolling = rolling;
  for (PairSettings& pair : scene.particles.contact.pairs) {
    if (rolling != RollingLaw::none) pair.rolling_friction = 0.1;
  }
  const ParticleState start = half_fixed_cloud();
  const auto engine = make_engine(scene, start);
  const std::vector<Vector3> wind(start.id.size(), Vector3(1e-5, -2e-5, 3e-5));
  for (int window = 0; window < 3; ++window) {
    engine->advance(4e-4, 200, wind, {});
    engine->rollback();
    engine->advance(6e-4, 300, wind, {});
    engine->commit();
  }
  EXPECT_GT(engine->counters().rebuilds, 3);
  const ParticleState& after = engine->particles();
  EXPECT_EQ(after.fixed, start.fixed);
  int moved = 0;
  for (int row = 0; row < start.size(); ++row) {
    if (!start.is_fixed(row)) {
      moved += after.position[row] == start.position[row] ? 0 : 1;
      continue;
    }
    EXPECT_EQ(after.position[row], start.position[row]) << row;
    EXPECT_EQ(after.velocity[row], Vector3::Zero()) << row;
    EXPECT_EQ(after.spin[row], Vector3::Zero()) << row;
  }
  EXPECT_EQ(moved, start.size() / 2);
}

TEST(Fixed, half_of_a_cloud_stays_to_the_bit_under_gravity_wind_and_contacts) {
  expect_fixed_half_to_stay(Precision::full, RollingLaw::none);
  expect_fixed_half_to_stay(Precision::mixed, RollingLaw::none);
  expect_fixed_half_to_stay(Precision::full, RollingLaw::spring_dashpot);
  expect_fixed_half_to_stay(Precision::full, RollingLaw::constant_torque);
}

TEST(Fixed, layer_lets_smaller_spheres_fall_through_and_holds_larger_ones) {
  Scene scene = box_scene(Vector3::Constant(0.02));
  scene.scene.gravity = {0, 0, -9.81};
  add_laws(scene, stiffness, 0.5, 0.3);
  ParticleState state;
  for (int k = 0; k < 16; ++k) {  // spheres of 2 mm with gaps of 3 mm between them
    add_sphere(state, {2.5e-3 + 5e-3 * (k % 4), 2.5e-3 + 5e-3 * (k / 4), 0.01}, Vector3::Zero(), r);
    fix(state, k);
  }
  add_sphere(state, {5e-3, 5e-3, 0.014}, Vector3::Zero(), r);
  add_sphere(state, {15e-3, 15e-3, 0.016}, Vector3::Zero(), 3e-3);
  state.fixed.resize(state.id.size(), 0);
  const auto engine = make_engine(scene, state);
  for (int window = 0; window < 40; ++window) run(*engine, 5e-3, 1e-5);
  const ParticleState& after = engine->particles();
  EXPECT_TRUE(
      std::equal(state.position.begin(), state.position.begin() + 16, after.position.begin()));
  EXPECT_LT(after.position[16].z(), 1.1 * r) << "the smaller one is on the floor";
  // Between four spheres at 2.5 mm sqrt(2) from its axis, 4 mm from their centres.
  EXPECT_NEAR(after.position[17].z(), 0.01 + std::sqrt(16e-6 - 12.5e-6), 1e-5);
}

TEST(Fixed, momentum_of_free_spheres_changes_by_gravity_wind_and_what_the_fixed_ones_take) {
  // Without contacts the fixed ones take nothing: the free ones gain m g t + F t exactly.
  Scene scene = impact_scene(0.9, 0.3);
  scene.scene.gravity = {0, 0, -9.81};
  ParticleState state;
  add_sphere(state, {5e-3, 5e-3, 5e-3}, Vector3::Zero(), r);
  add_sphere(state, {15e-3, 15e-3, 15e-3}, Vector3::Zero(), r);
  fix(state, 0);
  const auto engine = make_engine(scene, state);
  const Vector3 wind(1e-4, 0, 0);
  engine->advance(1e-3, 100, std::vector<Vector3>{wind, wind}, {});
  const Vector3 expected = 1e-3 * (scene.scene.gravity + wind / mass);
  EXPECT_LT((engine->particles().velocity[1] - expected).norm(), 1e-13 * expected.norm());
  EXPECT_EQ(engine->particles().velocity[0], Vector3::Zero());
}

TEST(Fixed, force_that_is_not_finite_is_named) {
  const auto engine = make_engine(impact_scene(0.9, 0.3), sphere_at_fixed_one(Vector3::Zero()));
  const std::vector<Vector3> force{{std::numeric_limits<double>::infinity(), 0, 0},
                                   Vector3::Zero()};
  expect_contains(message_of<NumericsError>([&] { engine->advance(1e-3, 100, force, {}); }),
                  "particle 1:");
}

TEST(Fixed, spheres_come_and_go_with_their_rows) {
  Scene scene = impact_scene(0.9, 0.3);
  scene.scene.gravity = {0, 0, -9.81};
  ParticleState state;
  for (const double x : {3e-3, 8e-3, 13e-3}) {
    add_sphere(state, {x, 0.01, 0.01}, Vector3::Zero(), r);
  }
  fix(state, 1);
  ParticleState entering;
  add_sphere(entering, {17e-3, 0.01, 0.01}, Vector3::Zero(), r);
  entering.id[0] = 4;
  const auto engine = make_engine(scene, state);
  const std::vector<Vector3> three(3, Vector3::Zero());
  engine->advance(1e-3, 100, three, {});
  engine->exchange(std::vector<int>{0}, entering);
  EXPECT_EQ(engine->particles().fixed, (std::vector<std::uint8_t>{1, 0, 0}));
  engine->rollback();
  EXPECT_EQ(engine->particles().fixed, (std::vector<std::uint8_t>{0, 1, 0}));
  engine->advance(1e-3, 100, three, {});
  engine->exchange(std::vector<int>{0}, entering);
  engine->commit();
  engine->advance(1e-3, 100, three, {});
  EXPECT_EQ(engine->particles().velocity[0], Vector3::Zero());
  EXPECT_NEAR(engine->particles().velocity[1].z(), -2e-3 * 9.81, 1e-12);
  EXPECT_NEAR(engine->particles().velocity[2].z(), -1e-3 * 9.81, 1e-12);
}

TEST(Fixed, sphere_that_is_to_move_is_refused) {
  ParticleState state = sphere_at_fixed_one(Vector3::Zero());
  state.velocity[0] = {0, 0, 0.1};
  const Scene scene = impact_scene(0.9, 0.3);
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "it is fixed");
}

TEST(Fixed, spheres_need_no_law_with_each_other_and_with_walls) {
  Scene scene = box_scene(Vector3::Constant(0.02));
  scene.particles.materials["steel"].density = 7800;
  add_laws(scene, stiffness, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, middle, Vector3::Zero(), r);
  add_sphere(state, middle + Vector3(2 * r, 0, 0), Vector3::Zero(), r);
  state.material = {1, 1};
  fix(state, 0);
  fix(state, 1);
  EXPECT_NO_THROW(make_engine(scene, state));
  add_sphere(state, middle + Vector3(0, 3 * r, 0), Vector3::Zero(), r);
  state.fixed.push_back(0);
  expect_contains(message_of<ConfigError>([&] { make_engine(scene, state); }), "[glass, steel]");
  add_pair(scene, "glass", "steel", stiffness, 0.9, 0.3);
  EXPECT_NO_THROW(make_engine(scene, state));
}

TEST(Fixed, spheres_limit_the_step_by_the_mass_of_their_free_partners) {
  // π sqrt(m / k_w) / 10 with the tangential spring's 3.5 * 2/7 = 1: the fixed one is light, but
  // counts as heavy.
  Scene scene = impact_scene(0.9, 0.0);
  ParticleState state = sphere_at_fixed_one(Vector3::Zero());
  state.density[0] = 1;
  const double longest = 0.1 * std::numbers::pi * std::sqrt(mass / stiffness);
  scene.coupling.window = scene.particles.time_step = 0.999 * longest;
  EXPECT_NO_THROW(make_engine(scene, state));
  scene.coupling.window = scene.particles.time_step = 1.001 * longest;
  EXPECT_THROW(make_engine(scene, state), ConfigError);
}

}  // namespace
}  // namespace fluxpact
