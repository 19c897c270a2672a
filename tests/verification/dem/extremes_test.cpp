// At the edges of what the native engine takes: finite results, or a refusal that names the limit
// and what would pass.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "dem_server/insertion/insertion.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

constexpr double r = 1e-3;
const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;

/// A tenth of the contact time of two spheres of effective mass m on a spring k.
double longest_step(double k, double effective_mass) {
  return 0.1 * std::numbers::pi * std::sqrt(effective_mass / k);
}

/// Two spheres that meet head on at `speed` each in the middle of a box of 2 cm.
ParticleState head_on(double speed, double ratio = 1, double density = 2250) {
  ParticleState state;
  add_sphere(state, {0.01 - 1.01 * r, 0.01, 0.01}, {speed, 0, 0}, r, density);
  add_sphere(state, {0.01 + 1.01 * r * ratio, 0.01, 0.01}, {-speed, 0, 0}, r * ratio, density);
  return state;
}

Scene pair_scene(double stiffness, double e, double time_step) {
  Scene scene = box_scene({0.03, 0.02, 0.02});
  scene.particles.time_step = time_step;
  scene.coupling.window = time_step;
  add_laws(scene, stiffness, e, 0.3);
  return scene;
}

TEST(Step, at_its_limit_runs_and_over_it_is_refused_with_the_limit) {
  const double limit = longest_step(1000, 0.5 * mass);
  const auto engine = make_engine(pair_scene(1000, 1, limit), head_on(0.1));
  const std::vector<Vector3> none(2, Vector3::Zero());
  engine->advance(100 * limit, 100, none, {});
  // Ten steps to a contact: the energy is back to (w0 dt)² / 8 = 1.2 % of it, the speed to half.
  EXPECT_NEAR(engine->particles().velocity[1].x(), 0.1, 0.0063 * 0.1);
  const std::string refusal = message_of<ConfigError>(
      [&] { make_engine(pair_scene(1000, 1, 1.01 * limit), head_on(0.1)); });
  fmt::print("{}\n", refusal);
  expect_contains(refusal, "particles.time_step");
  expect_contains(refusal, fmt::format("{:.4g} s", limit));
  // A window that asks for fewer steps than the scene said is refused, too.
  const auto again = make_engine(pair_scene(1000, 1, limit), head_on(0.1));
  const std::string later =
      message_of<ConfigError>([&] { again->advance(100 * limit, 50, none, {}); });
  expect_contains(later, fmt::format("{:.4g} s", limit));
}

/// Rebound of an impact at 1 mm/s with the longest allowed step.
void expect_restitution(double stiffness, double ratio, double density, double e) {
  const double m1 = mass * density / 2250;
  const double m2 = m1 * ratio * ratio * ratio;
  // The wall's contact of the lighter sphere, m_eff = m1, is slower than the pair's.
  const double limit = longest_step(stiffness, m1 * m2 / (m1 + m2));
  const double time_step = 0.05 * std::min(limit, longest_step(stiffness, 0.5 * m1));
  Scene scene = pair_scene(stiffness, e, time_step);
  // The gap of 1 % of the radii closes at 2 v; so fast that the overlap stays below 1 % of r.
  const double speed = 0.01 * r * std::sqrt(stiffness / m1) / 4;
  const auto engine = make_engine(scene, head_on(speed, ratio, density));
  const double gap = 0.01 * r * (1 + ratio);
  const double duration = gap / (2 * speed) + 30 * limit;
  const int steps = static_cast<int>(duration / time_step);
  const std::vector<Vector3> none(2, Vector3::Zero());
  engine->advance(steps * time_step, steps, none, {});
  const ParticleState& after = engine->particles();
  const double found = (after.velocity[1].x() - after.velocity[0].x()) / (2 * speed);
  const double centre = (m1 * speed - m2 * speed) / (m1 + m2);
  const double kept = (m1 * after.velocity[0].x() + m2 * after.velocity[1].x()) / (m1 + m2);
  fmt::print("k {:.0e} N/m, radii 1:{:<4} density {:>7}: step {:.2e} s (limit {:.2e}), e {:.5f}\n",
             stiffness, ratio, density, time_step, limit, found);
  // γ dt / 2 of ln e with 200 steps a contact, and the moment of touching: 1e-3.
  EXPECT_NEAR(found, e, 2e-3 * e);
  EXPECT_NEAR(kept, centre, 1e-12 * speed);
}

TEST(Pair, rebounds_at_any_stiffness_with_the_step_it_allows) {
  for (const double stiffness : {1e2, 1e4, 1e6, 1e8}) expect_restitution(stiffness, 1, 2250, 0.8);
}

TEST(Pair, rebounds_at_any_density) {
  for (const double density : {1.0, 100.0, 2e4}) expect_restitution(1e3, 1, density, 0.8);
}

TEST(Pair, rebounds_at_sizes_of_ten_to_one) {
  for (const double ratio : {0.1, 0.3, 3.0}) expect_restitution(1e3, ratio, 2250, 0.8);
}

TEST(Cloud, of_sizes_ten_to_one_keeps_its_momentum_and_loses_energy) {
  Scene scene = box_scene(Vector3::Constant(0.02), {Axis::x, Axis::y, Axis::z});
  add_laws(scene, 1000, 0.9, 0.3);
  const double small = 0.25e-3;
  scene.particles.time_step = 2e-6;
  // A lattice of small spheres, and eight spheres of ten times their size in holes of it.
  ParticleState state;
  UniformRandom random(1);
  const auto speed = [&random] {
    return Vector3(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
  };
  for (int i = 0; i < 8; ++i) {
    add_sphere(state, 0.01 * Vector3(i % 2 + 0.5, i / 2 % 2 + 0.5, i / 4 + 0.5), speed(),
               10 * small);
  }
  constexpr int side = 30;
  const double spacing = 0.02 / side;
  for (int i = 0; i < side * side * side; ++i) {
    const Vector3 at =
        spacing * Vector3(i % side + 0.5, i / side % side + 0.5, i / (side * side) + 0.5);
    bool free = true;
    for (int large = 0; large < 8; ++large) {
      free &= (at - state.position[large]).norm() > 11.05 * small;
    }
    if (free) add_sphere(state, at, 2 * speed(), small);
  }
  const auto sums = [](const ParticleState& now) {
    Vector3 momentum = Vector3::Zero();
    double energy = 0;
    double scale = 0;
    for (int i = 0; i < now.size(); ++i) {
      const double m = std::pow(now.radius[i] / 1e-3, 3);
      momentum += m * now.velocity[i];
      scale += m * now.velocity[i].norm();
      energy += m * now.velocity[i].squaredNorm();
    }
    return std::tuple(momentum, energy, scale);
  };
  const auto [momentum, energy, scale] = sums(state);
  const auto engine = make_engine(scene, state);
  run(*engine, 1e-3, 2e-6);
  const auto [momentum_after, energy_after, scale_after] = sums(engine->particles());
  fmt::print("{} spheres of 10:1, 500 steps: momentum off by {:.1e}, energy {:.2f} of the start\n",
             state.size(), (momentum_after - momentum).norm() / scale, energy_after / energy);
  EXPECT_LT((momentum_after - momentum).norm(), 1e-13 * scale);
  EXPECT_LT(energy_after, 0.95 * energy);
  EXPECT_GT(energy_after, 0.2 * energy);
  // None has slipped through another: no overlap of more than a tenth of a small sphere, where a
  // relative speed of 3 m/s gives 3 m/s · sqrt(m_eff / k) = 0.02 mm.
  double deepest = 0;
  const ParticleState& now = engine->particles();
  for (int large = 0; large < 8; ++large) {
    for (int i = 8; i < now.size(); ++i) {
      Vector3 apart = now.position[i] - now.position[large];
      for (int axis = 0; axis < 3; ++axis) apart[axis] -= 0.02 * std::round(apart[axis] / 0.02);
      deepest = std::max(deepest, 11 * small - apart.norm());
    }
  }
  EXPECT_LT(deepest, 0.1 * small);
}

TEST(Particle, at_a_thousand_metres_a_second_is_named_or_contained) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  scene.particles.time_step = 1e-5;
  add_laws(scene, 1000, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {1000, 0, 0}, r);
  state.id[0] = 7;
  const auto engine = make_engine(scene, state);
  const std::string text = message_of<NumericsError>([&] { run(*engine, 1e-4, 1e-5); });
  fmt::print("{}\n", text);
  expect_contains(text, "particle 7");
  engine->rollback();
  EXPECT_EQ(engine->particles().position[0], state.position[0]);
  // Stiff enough, and in steps short enough, it bounces to and fro.
  Scene stiff = box_scene({0.02, 0.02, 0.02});
  add_laws(stiff, 1e9, 1.0, 0.3);
  stiff.particles.time_step = 5e-9;
  stiff.coupling.window = 1e-6;
  const auto contained = make_engine(stiff, state);
  for (int window = 0; window < 100; ++window) run(*contained, 1e-6, 5e-9);
  EXPECT_NEAR(contained->particles().velocity[0].norm(), 1000, 1);
  EXPECT_LT(std::abs(contained->particles().position[0].x() - 0.01), 0.01);
}

TEST(Overlap, of_a_start_runs_apart_and_nothing_is_lost) {
  // Half a radius into each other: the springs hold k δ² / 2, which becomes the speed they part at.
  const double overlap = 0.5 * r;
  Scene scene = pair_scene(1000, 1, 1e-6);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, Vector3::Zero(), r);
  add_sphere(state, {0.01 + 2 * r - overlap, 0.01, 0.01}, Vector3::Zero(), r);
  const auto engine = make_engine(scene, state);
  const std::vector<Vector3> none(2, Vector3::Zero());
  engine->advance(1e-3, 1000, none, {});
  const double expected = overlap * std::sqrt(1000 / (2 * mass));  // of each
  EXPECT_NEAR(engine->particles().velocity[1].x(), expected, 1e-3 * expected);
  EXPECT_NEAR(engine->particles().velocity[0].x(), -expected, 1e-3 * expected);
}

TEST(Overlap, of_a_scene_is_refused_with_both_particles) {
  Scene scene = pair_scene(1000, 0.9, 1e-6);
  for (const double x : {0.01, 0.01 + 1.7 * r}) {
    InsertionSettings one;
    one.type = InsertionType::lattice;
    one.material = "glass";
    one.diameter = 2 * r;
    one.within.x = {x - 1.01 * r, x + 1.01 * r};
    one.within.y = one.within.z = {0.009 - 0.01 * r, 0.011 + 0.01 * r};
    scene.particles.insertion.push_back(one);
  }
  const std::string text =
      message_of<ConfigError>([&] { insert_particles(scene, make_box(scene.fluid.mesh)); });
  fmt::print("{}\n", text);
  expect_contains(text, "particle 2");
  expect_contains(text, "overlaps particle 1");
  expect_contains(text, "0.15 of the smaller diameter");
}

TEST(Count, of_none_and_one_is_fine) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  scene.scene.gravity = {0, 0, -9.81};
  add_laws(scene, 1000, 0.9, 0.3);
  const auto none = make_engine(scene, {});
  run(*none, 1e-3, 1e-6);
  EXPECT_EQ(none->particles().size(), 0);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, Vector3::Zero(), r);
  const auto one = make_engine(scene, state);
  run(*one, 1e-2, 1e-6);
  EXPECT_NEAR(one->particles().position[0].z(), 0.01 - 0.5 * 9.81 * 1e-4, 1e-12);
}

}  // namespace
}  // namespace fluxpact
