// Committed and candidate state of the real YADE, and what is stored of it.
#include <cstring>

#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/yade/yade_engine.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double r = 1e-3;
constexpr int count = 60;

std::unique_ptr<ParticleEngine> make_yade(const Scene& scene, const ParticleState& state) {
  return make_yade_engine(scene, make_box(scene.fluid.mesh), state);
}

void expect_same_bits(const ParticleState& a, const ParticleState& b) {
  const auto same = [](const std::vector<Vector3>& x, const std::vector<Vector3>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(Vector3)) == 0;
  };
  EXPECT_EQ(a.id, b.id);
  EXPECT_TRUE(same(a.position, b.position));
  EXPECT_TRUE(same(a.velocity, b.velocity));
  EXPECT_TRUE(same(a.spin, b.spin));
}

/// Spheres that fall on each other, ten times as fast as on earth so that a few windows make a heap
/// of them.
struct Heap {
  Scene scene = box_scene({0.01, 0.01, 0.03});
  ParticleState state;
  std::vector<Vector3> push;

  Heap() {
    scene.scene.gravity = {0, 0, -98.1};
    scene.particles.time_step = 5e-6;
    add_laws(scene, 1000, 0.3, 0.3);
    for (int i = 0; i < count; ++i) {
      add_sphere(state,
                 {1.2e-3 + 2.4e-3 * (i % 4) + 1e-5 * (i % 7), 1.2e-3 + 2.4e-3 * (i / 4 % 4),
                  1.01e-3 + 2.02e-3 * (i / 16)},
                 {0.1 * (i % 3 - 1), 0.1 * (i % 5 - 2), -0.2}, r);
      push.emplace_back(1e-5 * (i % 3), 0, -1e-5 * (i % 2));
    }
  }
  void window(ParticleEngine& engine) const { engine.advance(1e-3, 200, push, {}); }
  void windows(ParticleEngine& engine, int number) const {
    for (int i = 0; i < number; ++i) {
      window(engine);
      engine.commit();
    }
  }
};

TEST(YadeState, rollback_presents_the_committed_state_and_repeats_the_bits) {
  const Heap heap;
  const auto engine = make_yade(heap.scene, heap.state);
  for (int round = 0; round < 2; ++round) {
    const ParticleState committed = engine->particles();
    heap.window(*engine);
    const ParticleState first = engine->particles();
    engine->rollback();
    expect_same_bits(committed, engine->particles());
    engine->advance(2e-4, 60, std::vector<Vector3>(count, Vector3::Zero()), {});  // given up
    engine->rollback();
    heap.window(*engine);
    expect_same_bits(first, engine->particles());
    engine->commit();
  }
  // Beside one that never went back.
  const auto other = make_yade(heap.scene, heap.state);
  heap.windows(*other, 2);
  expect_same_bits(other->particles(), engine->particles());
}

TEST(YadeState, goes_on_with_the_same_bits_in_another_process) {
  const Heap heap;
  const auto engine = make_yade(heap.scene, heap.state);
  heap.windows(*engine, 8);
  EngineState state;
  engine->store(state);
  EXPECT_GE(state.fields().number("contacts"), 30);  // several of one sphere: sums have an order
  const auto other = make_yade(heap.scene, heap.state);
  heap.window(*other);  // a candidate that is forgotten
  other->restore(state.fields());
  expect_same_bits(engine->particles(), other->particles());
  heap.windows(*engine, 3);
  heap.windows(*other, 3);
  expect_same_bits(engine->particles(), other->particles());

  heap.window(*engine);
  EXPECT_THROW(engine->store(state), ProtocolError);  // a candidate is pending
  EngineState foreign;
  foreign.add_number("native_state", 1);
  expect_contains(message_of<ConfigError>([&] { other->restore(foreign.fields()); }), "yade_state");
}

/// Storing has YADE build its lists anew: sums in another order, the same contacts.
TEST(YadeState, that_was_stored_goes_on_as_if_it_had_not_been_but_for_round_off) {
  const Heap heap;
  const auto engine = make_yade(heap.scene, heap.state);
  const auto other = make_yade(heap.scene, heap.state);
  heap.windows(*engine, 5);
  heap.windows(*other, 5);
  EngineState state;
  engine->store(state);
  heap.windows(*engine, 1);
  heap.windows(*other, 1);
  double apart = 0;
  for (int i = 0; i < count; ++i) {
    apart =
        std::max(apart, (engine->particles().position[i] - other->particles().position[i]).norm());
  }
  // Round-off of velocities of 0.1 m/s in 200 sub-steps, some times grown by contacts.
  EXPECT_LT(apart, 1e-10 * r);
}

}  // namespace
}  // namespace fluxpact
