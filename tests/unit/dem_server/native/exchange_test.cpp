// Particles that leave and enter at the end of a window, in every engine.
#include <cstring>

#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

using MakeEngine = std::unique_ptr<ParticleEngine> (*)(const Scene&, const Mesh&, ParticleState);

constexpr int count = 600;
constexpr double window = 3e-4;

bool same_bits(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vector3)) == 0;
}

void expect_same_bits(const ParticleState& a, const ParticleState& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.material, b.material);
  EXPECT_TRUE(same_bits(a.position, b.position));
  EXPECT_TRUE(same_bits(a.velocity, b.velocity));
  EXPECT_TRUE(same_bits(a.spin, b.spin));
}

Scene scene_of(int threads) {
  Scene scene = cloud_scene({Axis::y});
  scene.scene.gravity = {0, 0, -9.81};
  scene.particles.numerics.threads = threads;
  return scene;
}

void step(ParticleEngine& engine) {
  const std::vector<Vector3> force(engine.particles().size(), Vector3::Zero());
  engine.advance(window, 150, force, {});
}

/// Two small spheres at places that the test has made free.
ParticleState newcomers(const ParticleState& present, std::int64_t id, std::span<const int> free) {
  ParticleState state;
  for (const int row : free) {
    add_sphere(state, present.position[row], {0.1, 0, -0.2}, 0.5 * present.radius[row]);
    state.id.back() = id++;
  }
  return state;
}

class Exchange : public testing::TestWithParam<MakeEngine> {
 protected:
  std::unique_ptr<ParticleEngine> make(int threads) const {
    const Scene scene = scene_of(threads);
    return GetParam()(scene, make_box(scene.fluid.mesh), slow_cloud());
  }
  /// So slow that nobody reaches a wall: the kinematic engine passes through them.
  static ParticleState slow_cloud() { return random_cloud(count, 0.3); }
};

TEST_P(Exchange, takes_rows_out_and_appends_those_that_enter) {
  const auto engine = make(2);
  step(*engine);
  const ParticleState before = engine->particles();
  const std::vector<int> leaving{0, 7, count - 1};
  const ParticleState entering = newcomers(before, before.id.back() + 1, std::vector<int>{0, 7});
  engine->exchange(leaving, entering);
  ParticleState expected = before;
  exchange_rows(leaving, entering, expected);
  EXPECT_EQ(expected.size(), count - 1);
  expect_same_bits(engine->particles(), expected);
  engine->commit();
  expect_same_bits(engine->particles(), expected);
  step(*engine);  // and it goes on
  EXPECT_FALSE(same_bits(engine->particles().position, expected.position));
}

TEST_P(Exchange, is_undone_with_its_window_bit_for_bit) {
  const auto straight = make(1);
  const auto repeated = make(1);
  const std::vector<int> leaving{3, 4, 100};
  for (int w = 0; w < 4; ++w) {
    const ParticleState committed = repeated->particles();
    step(*repeated);
    repeated->exchange(std::vector<int>{0, 1, 50, 51},
                       newcomers(repeated->particles(), 30000, std::vector<int>{1}));
    repeated->rollback();
    expect_same_bits(committed, repeated->particles());
    for (ParticleEngine* engine : {straight.get(), repeated.get()}) {
      step(*engine);
      if (w % 2 == 0) {
        engine->exchange(leaving, newcomers(engine->particles(), 20000 + w, std::vector<int>{3}));
      }
      engine->commit();
    }
    expect_same_bits(straight->particles(), repeated->particles());
  }
}

TEST_P(Exchange, gives_the_same_bits_for_any_number_of_threads) {
  const auto one = make(1);
  const auto three = make(3);
  for (int w = 0; w < 3; ++w) {
    for (ParticleEngine* engine : {one.get(), three.get()}) {
      step(*engine);
      engine->exchange(std::vector<int>{5, 6},
                       newcomers(engine->particles(), 20000 + w, std::vector<int>{5}));
      engine->commit();
    }
  }
  expect_same_bits(one->particles(), three->particles());
}

TEST_P(Exchange, can_empty_and_fill_the_domain) {
  const auto engine = make(2);
  step(*engine);
  std::vector<int> everybody(count);
  for (int row = 0; row < count; ++row) everybody[row] = row;
  const ParticleState last = engine->particles();
  engine->exchange(everybody, {});
  EXPECT_EQ(engine->particles().size(), 0);
  engine->commit();
  step(*engine);
  engine->exchange({}, newcomers(last, 5000, everybody));
  EXPECT_EQ(engine->particles().size(), count);
  engine->rollback();
  EXPECT_EQ(engine->particles().size(), 0);
  step(*engine);
  engine->exchange({}, newcomers(last, 5000, everybody));
  engine->commit();
  step(*engine);
  EXPECT_EQ(engine->particles().size(), count);
}

TEST_P(Exchange, refuses_an_id_that_does_not_ascend) {
  const auto engine = make(1);
  step(*engine);
  EXPECT_THROW(engine->exchange({}, newcomers(engine->particles(), count - 1, std::vector<int>{0})),
               ConfigError);
}

INSTANTIATE_TEST_SUITE_P(Engines, Exchange,
                         testing::Values(&make_native_engine, &make_kinematic_engine),
                         [](const auto& engine) {
                           return engine.index == 0 ? "native" : "kinematic";
                         });

// A spring that held a sphere on the wall must hold it after others have gone.
TEST(NativeExchange, keeps_the_springs_of_those_that_stay) {
  Scene scene = box_scene(Vector3::Constant(0.03), {});
  add_laws(scene, 1000, 0.9, 0.3);
  scene.scene.gravity = {2, 0, -9.81};  // a slope below the angle of friction
  ParticleState state;
  for (int i = 0; i < 4; ++i) add_sphere(state, {5e-3 + 6e-3 * i, 0.015, 1e-3}, {0, 0, 0}, 1e-3);
  const auto stays = make_native_engine(scene, make_box(scene.fluid.mesh), state);
  const auto loses = make_native_engine(scene, make_box(scene.fluid.mesh), state);
  for (ParticleEngine* engine : {stays.get(), loses.get()}) run(*engine, 0.02, 1e-5);
  const std::vector<Vector3> three(3, Vector3::Zero());
  const std::vector<Vector3> four(4, Vector3::Zero());
  stays->advance(1e-3, 100, four, {});
  loses->advance(1e-3, 100, four, {});
  loses->exchange(std::vector<int>{1}, {});
  stays->commit();
  loses->commit();
  for (int w = 0; w < 10; ++w) {
    stays->advance(1e-3, 100, four, {});
    loses->advance(1e-3, 100, three, {});
    stays->commit();
    loses->commit();
  }
  // They roll down alike; a spring lost would let them slip by up to 0.3 m g / k, some 1e-8 m.
  EXPECT_NEAR(loses->particles().position[2].x(), stays->particles().position[3].x(), 1e-12);
  EXPECT_NEAR(loses->particles().spin[2].y(), stays->particles().spin[3].y(), 1e-6);
}

}  // namespace
}  // namespace fluxpact
