// Committed and candidate state, those that come and go, the stored state, and what is refused.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "dem_server/backends/engine_state.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr int count = 300;
constexpr double side = 0.02;

Scene dense_scene() {
  Scene scene = box_scene({side, side, 0.03}, {Axis::y});
  scene.scene.gravity = {0, 0, -9.81};
  add_collisions(scene, 0.8, 0.3);
  scene.particles.insertion.emplace_back();
  return scene;
}

ParticleState dense_cloud() {
  const PackingBox box{Vector3::Zero(), {side, side, 0.01}, {false, true, false}};
  const auto centres = random_packing(box, count, 2e-3, 1);
  UniformRandom random(4);
  ParticleState state;
  for (const Vector3& centre : centres.value()) {
    const double u = random.next() - 0.5;
    add_sphere(state, centre, {u, random.next() - 0.5, 0}, 1e-3);
  }
  return state;
}

std::vector<Vector3> forces(const ParticleState& state, int window) {
  std::vector<Vector3> force;
  for (int row = 0; row < state.size(); ++row) {
    force.emplace_back(1e-6 * (row % 3), 1e-6 * window, 1e-5 * (row % 7));
  }
  return force;
}

void step(ParticleEngine& engine, int window) {
  engine.advance(2e-3, 100, forces(engine.particles(), window), {});
}

bool same_bits(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vector3)) == 0;
}

void expect_same_bits(const ParticleState& a, const ParticleState& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_TRUE(same_bits(a.position, b.position));
  EXPECT_TRUE(same_bits(a.velocity, b.velocity));
  EXPECT_TRUE(same_bits(a.spin, b.spin));
}

/// One leaves and two come in, above the others.
void exchange(ParticleEngine& engine) {
  const ParticleState& now = engine.particles();
  ParticleState entering;
  for (const double x : {0.005, 0.015}) {
    add_sphere(entering, {x, 0.01, 0.028}, {0, 0, -1}, 5e-4);
    entering.id.back() = now.id.back() + static_cast<std::int64_t>(entering.id.size());
  }
  engine.exchange(std::vector<int>{5}, entering);
}

TEST(HardSphereRollback, presents_the_committed_state_and_repeats_the_bits) {
  const auto engine = make_hard(dense_scene(), dense_cloud());
  for (int window = 1; window <= 5; ++window) {
    const ParticleState committed = engine->particles();
    step(*engine, window);
    const ParticleState first = engine->particles();
    EXPECT_FALSE(same_bits(committed.position, first.position));
    engine->rollback();
    expect_same_bits(committed, engine->particles());
    step(*engine, window + 10);  // an attempt that is given up, with an exchange
    exchange(*engine);
    EXPECT_EQ(engine->particles().size(), count + 1);
    engine->rollback();
    expect_same_bits(committed, engine->particles());
    step(*engine, window);
    expect_same_bits(first, engine->particles());
    step(*engine, window);  // again, without a word
    expect_same_bits(first, engine->particles());
    engine->commit();
    expect_same_bits(first, engine->particles());
  }
}

TEST(HardSphereState, goes_on_with_the_same_bits_in_another_engine) {
  Scene scene = dense_scene();
  scene.particles.outflow.emplace();
  scene.particles.inflow.emplace_back().material = "glass";
  scene.particles.inflow.back().diameter = 1e-3;
  const auto straight = make_hard(scene, dense_cloud());
  auto restored = make_hard(scene, dense_cloud());
  for (int window = 1; window <= 8; ++window) {
    for (const auto& engine : {straight.get(), restored.get()}) {
      step(*engine, window);
      if (window == 3) exchange(*engine);
      engine->commit();
    }
    expect_same_bits(straight->particles(), restored->particles());
    if (window % 2 == 0) continue;
    EngineState state;
    restored->store(state);
    restored = make_hard(scene, {});  // whatever it was made with
    restored->restore(state.fields());
    expect_same_bits(straight->particles(), restored->particles());
  }
  EXPECT_GT(straight->counters().collisions, 1000);
}

TEST(HardSphereState, of_another_kind_or_damaged_is_refused_and_harms_nothing) {
  const auto engine = make_hard(dense_scene(), dense_cloud());
  EngineState state;
  engine->store(state);
  const Fields whole = state.fields();
  const ParticleState before = engine->particles();
  const auto message = [&](const Fields& fields) {
    return message_of<ConfigError>([&] { engine->restore(fields); });
  };
  expect_contains(message({}), "hard_sphere_state");
  for (const char* name : {"reach", "activity", "position"}) {
    EngineState damaged;
    for (const FieldView& view : whole.views()) {
      if (view.components == 3) {
        const auto rows = as_vectors(view.values);
        std::vector<Vector3>& values = damaged.add_vectors(view.name);
        if (view.name != name) values.assign(rows.begin(), rows.end());
        continue;
      }
      auto& values = damaged.add_scalars(view.name);
      values.assign(view.values.begin(), view.values.end());
      if (view.name == name) values[3] = -1;
    }
    for (const auto& [key, value] : whole.numbers()) damaged.add_number(key, value);
    expect_contains(message(damaged.fields()),
                    std::string(name) == "position" ? "array `position`" : "damaged");
  }
  step(*engine, 1);
  EXPECT_THROW(engine->store(state), ProtocolError);
  engine->rollback();
  expect_same_bits(before, engine->particles());
}

TEST(HardSphereRows, that_overlap_are_refused_by_name) {
  Scene scene = dense_scene();
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, Vector3::Zero(), 1e-3);
  add_sphere(state, {0.0117, 0.01, 0.01}, Vector3::Zero(), 1e-3);
  const auto message = [&] { return message_of<ConfigError>([&] { make_hard(scene, state); }); };
  expect_contains(message(), "particle 1 at (0.01, 0.01, 0.01) m overlaps particle 2 by 0.15");
  state.position[1] = {0.03, 0.01, 0.01};
  EXPECT_THROW(make_hard(scene, state), NumericsError);  // outside
  state.position[1] = {0.015, 0.01, 0.85e-3};
  expect_contains(message(),
                  "particle 2 at (0.015, 0.01, 0.00085) m overlaps the wall z_min by 0.15");
}

TEST(HardSphereRows, without_room_collide_without_end_and_are_refused_by_name) {
  // Between two walls that leave it 2e-9 m, and pushed: 5e4 collisions in the time of a contact.
  Scene scene = box_scene({0.02, 0.02, 2e-3 * (1 + 2e-6)});
  add_collisions(scene, 0.9, 0.3);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 1e-3 * (1 + 2e-6)}, {0, 0, 1.0}, 1e-3);
  const auto engine = make_hard(scene, state);
  const std::string message = message_of<NumericsError>([&] { run(*engine, 1e-3, 1e-4); });
  expect_contains(message, "particle 1 at (0.01, 0.01, 0.001");
  expect_contains(message, "collides without end");
  engine->rollback();
  expect_same_bits(engine->particles(), state);
}

TEST(HardSphereRows, that_get_lost_or_are_pushed_by_no_number_are_refused) {
  Scene scene = dense_scene();
  scene.fluid.mesh.patches = {};
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, Vector3::Zero(), 1e-3);
  const auto engine = make_hard(scene, state);
  const std::vector<Vector3> wrong{Vector3(0, std::nan(""), 0)};
  expect_contains(message_of<NumericsError>([&] { engine->advance(1e-3, 1, wrong, {}); }),
                  "particle 1: the force on it");
  scene.fluid.mesh.periodic = {Axis::x, Axis::y};
  scene.fluid.mesh.box.upper = {1.9e-3, side, side};
  state.position[0].x() = 0.9e-3;
  expect_contains(message_of<ConfigError>([&] { make_hard(scene, state); }), "its own image");
}

TEST(HardSphereRows, of_none_are_fine) {
  const auto engine = make_hard(dense_scene(), {});
  engine->advance(1e-3, 10, {}, {});
  engine->commit();
  EXPECT_EQ(engine->particles().size(), 0);
}

TEST(HardSphereRows, that_overlapped_grow_to_their_size_when_they_have_room) {
  Scene scene = box_scene({0.1, 0.1, 0.1});
  add_collisions(scene, 1.0, 0.0);
  ParticleState state;
  add_sphere(state, {0.05, 0.05, 0.05}, {-0.01, 0, 0}, 1e-3);
  add_sphere(state, {0.05198, 0.05, 0.05}, {0.01, 0, 0}, 1e-3);
  const auto engine = make_hard(scene, state);
  const auto reach = [&] {
    EngineState stored;
    engine->store(stored);
    const Fields fields = stored.fields();
    return std::ranges::find(fields.views(), "reach", &FieldView::name)->values[0];
  };
  EXPECT_NEAR(reach(), 1e-3 * (0.99 - 1e-5), 1e-12);
  run(*engine, 1e-3, 1e-4);
  EXPECT_LT(reach(), 1e-3);
  for (int window = 0; window < 3; ++window) run(*engine, 0.05, 1e-3);
  EXPECT_EQ(reach(), 1e-3);
  EXPECT_EQ(engine->counters().collisions, 0);
}

}  // namespace
}  // namespace fluxpact
