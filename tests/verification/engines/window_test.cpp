// Windows that are repeated, undone, stored, and taken up by another engine; particles that leave
// and enter; who is lost is named. Beside the native engine.
#include <fmt/core.h>

#include <algorithm>

#include "dem_server/backends/engine_state.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"
#include "tests/verification/engines/under_test.hpp"

namespace fluxpact {
namespace {

constexpr double window = 1e-4;
constexpr int steps = 20;

/// A few hundred spheres of one size that fall, collide and rest on a floor.
struct Bed {
  Scene scene;
  ParticleState state;
};

Bed bed_of(int count, std::vector<Axis> periodic) {
  Bed bed{cloud_scene(std::move(periodic)), random_cloud(count, 0.3)};
  bed.scene.scene.gravity = {0, 0, -9.81};
  bed.scene.particles.time_step = window / steps;
  const double smallest = *std::ranges::min_element(bed.state.radius);
  bed.state.radius.assign(bed.state.radius.size(), smallest);
  return bed;
}

std::vector<Vector3> forces(const ParticleState& state, int k) {
  std::vector<Vector3> force;
  for (int row = 0; row < state.size(); ++row) {
    force.push_back(1e-5 * Vector3(std::sin(row + k), std::cos(3 * row + k), std::sin(7 * row)));
  }
  return force;
}

void advance(ParticleEngine& engine, int k) {
  engine.advance(window, steps, forces(engine.particles(), k), {});
}
void go(ParticleEngine& engine, int from, int to) {
  for (int k = from; k < to; ++k) {
    advance(engine, k);
    engine.commit();
  }
}

void expect_same_bits(const ParticleState& a, const ParticleState& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.spin, b.spin);
}

TEST(Window, is_the_same_to_the_bit_when_it_is_repeated) {
  const Bed bed = bed_of(300, {Axis::x});
  const auto engine = make_under_test(bed.scene, bed.state);
  go(*engine, 0, 100);
  const ParticleState before = engine->particles();
  advance(*engine, 100);
  const ParticleState first = engine->particles();
  engine->rollback();
  expect_same_bits(engine->particles(), before);
  // Another attempt in between, with other forces and sub-steps.
  engine->advance(0.5 * window, 7, forces(before, 3), {});
  engine->rollback();
  advance(*engine, 100);
  expect_same_bits(engine->particles(), first);
}

TEST(Window, goes_on_with_the_same_bits_in_another_engine) {
  const Bed bed = bed_of(300, {Axis::x, Axis::y});
  const auto engine = make_under_test(bed.scene, bed.state);
  go(*engine, 0, 100);
  EngineState stored;
  engine->store(stored);
  const auto other = make_under_test(bed.scene, bed.state);
  other->restore(stored.fields());
  expect_same_bits(engine->particles(), other->particles());
  go(*engine, 100, 110);
  go(*other, 100, 110);
  expect_same_bits(engine->particles(), other->particles());
}

TEST(State, is_refused_where_it_is_damaged_or_of_another_engine) {
  const Bed bed = bed_of(50, {});
  const auto engine = make_under_test(bed.scene, bed.state);
  go(*engine, 0, 50);
  EngineState stored;
  engine->store(stored);
  const Fields whole = stored.fields();
  std::vector<double> damaged;
  Fields fields;
  for (const FieldView& view : whole.views()) {
    if (view.name == "contacts") {
      damaged.assign(view.values.begin(), view.values.end());
      damaged.front() = 1e6;
      fields.add(view.name, std::span<const double>(damaged));
    } else if (view.components == 3) {
      fields.add(view.name, as_vectors(view.values));
    } else {
      fields.add(view.name, view.values);
    }
  }
  for (const auto& [name, value] : whole.numbers()) fields.add_number(name, value);
  const ParticleState before = engine->particles();
  expect_contains(message_of<ConfigError>([&] { engine->restore(fields); }), "damaged");
  expect_same_bits(engine->particles(), before);
  const auto native = make_engine(bed.scene, bed.state);
  EngineState other;
  native->store(other);
  EXPECT_THROW(engine->restore(other.fields()), ConfigError);
}

/// Root mean square of the difference over that of the speed.
double difference(const ParticleState& a, const ParticleState& b) {
  double square = 0;
  double all = 0;
  for (int row = 0; row < a.size(); ++row) {
    square += (a.velocity[row] - b.velocity[row]).squaredNorm();
    all += b.velocity[row].squaredNorm();
  }
  return std::sqrt(square / all);
}

TEST(Trajectories, of_colliding_spheres_are_those_of_the_native_engine) {
  const Bed bed = bed_of(400, {Axis::y});
  const auto engine = make_under_test(bed.scene, bed.state);
  const auto native = make_engine(bed.scene, bed.state);
  for (const int k : {0, 10, 20, 30, 40, 50}) {
    go(*engine, k, k + 10);
    go(*native, k, k + 10);
    const double off = difference(engine->particles(), native->particles());
    fmt::print("{} after {} windows: velocities differ by {:.2g}\n", under_test().name, k + 10,
               off);
    EXPECT_LT(off, under_test().trajectory_tolerance);
  }
}

// The contacts, their springs and the half kick between two windows are what they are within one.
TEST(Window, leaves_no_trace_where_it_ends) {
  const Bed bed = bed_of(400, {Axis::y});
  const std::vector<Vector3> force = forces(bed.state, 0);
  const auto whole = make_under_test(bed.scene, bed.state);
  whole->advance(60 * window, 60 * steps, force, {});
  const auto cut = make_under_test(bed.scene, bed.state);
  for (int k = 0; k < 60; ++k) {
    cut->advance(window, steps, force, {});
    cut->commit();
  }
  const double off = difference(cut->particles(), whole->particles());
  fmt::print("{}: one window or 60: velocities differ by {:.2g}\n", under_test().name, off);
  // The order of sums differs once lists are made anew: round-off, grown by collisions.
  EXPECT_LT(off, under_test().round_off);
}

TEST(Exchange, takes_particles_out_and_in_and_undoes_it) {
  Bed bed = bed_of(200, {});
  bed.scene.particles.outflow.emplace();
  const auto engine = make_under_test(bed.scene, bed.state);
  go(*engine, 0, 50);
  const ParticleState before = engine->particles();
  ParticleState entering;
  add_sphere(entering, {0.015, 0.015, 0.028}, {0, 0, -0.1}, before.radius[0]);
  entering.id[0] = before.id.back() + 1;
  const std::vector<int> leaving{3, 77};
  const auto attempt = [&] {
    advance(*engine, 50);
    engine->exchange(leaving, entering);
    return engine->particles();
  };
  const ParticleState first = attempt();
  EXPECT_EQ(first.size(), before.size() - 1);
  engine->rollback();
  expect_same_bits(engine->particles(), before);
  expect_same_bits(attempt(), first);
  engine->commit();
  go(*engine, 51, 60);
  const ParticleState& after = engine->particles();
  EXPECT_EQ(std::ranges::count(after.id, before.id[77]), 0);
  // The new one falls freely for nine windows.
  EXPECT_NEAR(after.velocity.back().z(), -0.1 - 9.81 * 9 * window, 0.03);
  EXPECT_LT(after.position.back().z(), 0.028);
}

TEST(Exchange, begins_with_none_and_ends_with_none) {
  Scene scene = cloud_scene({});
  scene.scene.gravity = {0, 0, -9.81};
  InflowSettings inflow;
  inflow.material = "glass";
  inflow.diameter = 2e-3;
  inflow.number_rate = 1;
  scene.particles.inflow.push_back(inflow);
  scene.particles.outflow.emplace();
  const auto engine = make_under_test(scene, {});
  engine->advance(window, steps, {}, {});
  ParticleState entering;
  add_sphere(entering, {0.015, 0.015, 0.015}, {0, 0, 0}, 1e-3);
  engine->exchange({}, entering);
  engine->commit();
  run(*engine, window, window / steps);
  EXPECT_NEAR(engine->particles().velocity.at(0).z(), -9.81 * window, 1e-15);
  engine->advance(window, steps, std::vector<Vector3>{Vector3::Zero()}, {});
  engine->exchange(std::vector<int>{0}, {});
  engine->commit();
  engine->advance(window, steps, {}, {});
  engine->commit();
  EXPECT_EQ(engine->particles().size(), 0);
}

TEST(Particles, that_are_lost_are_named) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  scene.particles.walls = WallSource::none;
  scene.particles.outflow.emplace();
  add_laws(scene, 1000, 0.9, 0.3);
  ParticleState state;
  for (int k = 0; k < 3; ++k) add_sphere(state, {0.005 + 0.004 * k, 0.01, 0.01}, {0, 0, 0}, 1e-3);
  state.velocity[1].z() = 20;
  const auto engine = make_under_test(scene, state);
  const std::vector<Vector3> none(3, Vector3::Zero());
  const std::string near = message_of<NumericsError>([&] { engine->advance(1e-3, 100, none, {}); });
  expect_contains(near, "particle 2");
  expect_contains(near, "z_max");
  engine->rollback();
  // Beyond all that the library follows.
  const std::string far = message_of<NumericsError>([&] { engine->advance(1e-2, 1000, none, {}); });
  expect_contains(far, "particle 2");
  engine->rollback();
  EXPECT_EQ(engine->particles().position, state.position);
}

}  // namespace
}  // namespace fluxpact
