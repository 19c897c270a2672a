// Committed and candidate state, and the same bits whatever the number of threads.
#include <omp.h>

#include <cmath>
#include <cstring>

#include "dem_server/backends/engine_state.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

bool same_bits(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vector3)) == 0;
}

void expect_same_bits(const ParticleState& a, const ParticleState& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_TRUE(same_bits(a.position, b.position));
  EXPECT_TRUE(same_bits(a.velocity, b.velocity));
  EXPECT_TRUE(same_bits(a.spin, b.spin));
}

std::vector<Vector3> some_force(int count, double scale) {
  std::vector<Vector3> force;
  force.reserve(count);
  for (int i = 0; i < count; ++i) force.emplace_back(scale * (i % 3), scale, -scale * (i % 5));
  return force;
}

Scene fast_cloud_scene(int threads, Precision precision = Precision::full) {
  Scene scene = cloud_scene({Axis::y});
  scene.scene.gravity = {0, 0, -9.81};
  scene.particles.numerics.threads = threads;
  scene.particles.numerics.precision = precision;
  return scene;
}

constexpr int count = 1000;

/// Several windows, each with several new lists (speeds of 1 m/s, skins of 0.3 mm, 0.5 ms).
ParticleState state_after_windows(int threads) {
  const auto engine = make_engine(fast_cloud_scene(threads), random_cloud(count, 1.0));
  for (int window = 1; window <= 3; ++window) {
    engine->advance(5e-4, 250, some_force(count, 1e-6 * window), {});
    engine->commit();
  }
  return engine->particles();
}

TEST(Threads, of_any_number_give_the_same_bits) {
  const ParticleState one = state_after_windows(1);
  expect_same_bits(one, state_after_windows(2));
  expect_same_bits(one, state_after_windows(3));
  const int before = omp_get_max_threads();
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    expect_same_bits(one, state_after_windows(0));
  }
  omp_set_num_threads(before);
}

class Rollback : public testing::TestWithParam<Precision> {};

INSTANTIATE_TEST_SUITE_P(Precisions, Rollback, testing::Values(Precision::full, Precision::mixed),
                         [](const auto& precision) {
                           return precision.param == Precision::full ? "full" : "mixed";
                         });

TEST_P(Rollback, presents_the_committed_state_and_repeats_the_bits) {
  ParticleState start = random_cloud(count, 1.0);
  for (int row = 0; row < count; ++row) start.spin[row] = {100.0 / (row + 1), 0, -row / 3.0};
  const auto engine = make_engine(fast_cloud_scene(2, GetParam()), start);
  const std::vector<Vector3> force = some_force(count, 1e-6);
  // 0.05 ms keeps the list, 0.6 ms remakes it several times: both must come back.
  for (const double window : {5e-5, 6e-4}) {
    const int steps = static_cast<int>(std::lround(window / 2e-6));
    const ParticleState committed = engine->particles();
    engine->advance(window, steps, force, {});
    const ParticleState first = engine->particles();
    EXPECT_FALSE(same_bits(committed.position, first.position));
    engine->rollback();
    expect_same_bits(committed, engine->particles());
    engine->advance(window, steps, some_force(count, 5e-5), {});  // an attempt that is given up
    EXPECT_FALSE(same_bits(first.velocity, engine->particles().velocity));
    engine->rollback();
    engine->advance(window, steps, force, {});
    expect_same_bits(first, engine->particles());
    engine->commit();
    expect_same_bits(first, engine->particles());
  }
}

TEST_P(Rollback, leaves_no_trace_in_later_windows) {
  const auto straight = make_engine(fast_cloud_scene(1, GetParam()), random_cloud(count, 1.0));
  const auto repeated = make_engine(fast_cloud_scene(1, GetParam()), random_cloud(count, 1.0));
  const std::vector<Vector3> force = some_force(count, 1e-6);
  for (int window = 0; window < 3; ++window) {
    straight->advance(3e-4, 150, force, {});
    straight->commit();
    repeated->advance(3e-4, 150, some_force(count, 1e-5), {});
    repeated->rollback();
    repeated->advance(3e-4, 150, force, {});
    repeated->commit();
  }
  expect_same_bits(straight->particles(), repeated->particles());
}

/// Of two spheres that roll on each other, the first goes through a periodic side: until the next
/// list it stays beyond it, but is presented inside. In each window one engine takes a window back,
/// another is made from the stored state.
TEST_P(Rollback, and_storing_leave_a_pair_together_of_which_one_is_beyond_a_periodic_side) {
  constexpr double diameter = 1e-3;
  constexpr double length = 10 * diameter;
  Scene scene = box_scene({length, length, length}, {Axis::y});
  add_laws(scene, 1000, 0.9, 0.3);
  scene.particles.numerics.precision = GetParam();
  ParticleState start;
  const double y = length - 0.01 * diameter;
  for (const double behind : {0.0, (1 - 1e-3) * diameter}) {
    add_sphere(start, {0.5 * length, y - behind, 0.5 * length}, {0, 0.1, 0}, diameter / 2);
    start.spin.back() = {0, 0, 10};
  }
  const auto straight = make_engine(scene, start);
  const auto repeated = make_engine(scene, start);
  const std::vector<Vector3> none(2, Vector3::Zero());
  bool apart = false;
  for (int window = 0; window < 20; ++window) {
    repeated->advance(2e-5, 10, none, {});
    repeated->rollback();
    EngineState state;
    straight->store(state);
    const auto restored = make_engine(scene, start);
    restored->restore(state.fields());
    for (ParticleEngine* engine : {straight.get(), repeated.get(), restored.get()}) {
      engine->advance(2e-5, 10, none, {});
      engine->commit();
    }
    expect_same_bits(straight->particles(), repeated->particles());
    expect_same_bits(straight->particles(), restored->particles());
    EXPECT_EQ(straight->counters().rebuilds, restored->counters().rebuilds);
    const std::vector<Vector3>& position = straight->particles().position;
    apart = apart || position[0].y() < position[1].y();
  }
  EXPECT_TRUE(apart);
  EXPECT_EQ(straight->counters().rebuilds, repeated->counters().rebuilds);
}

/// Sub-steps look at close pairs only, for a while; a rollback has all pairs looked at again. If
/// that makes no difference, none was missed.
TEST(ClosePairs, are_all_that_touch) {
  const auto straight = make_engine(fast_cloud_scene(1), random_cloud(count, 1.0));
  const auto repeated = make_engine(fast_cloud_scene(1), random_cloud(count, 1.0));
  const std::vector<Vector3> force = some_force(count, 1e-5);
  for (int window = 0; window < 100; ++window) {
    straight->advance(6e-6, 3, force, {});
    straight->commit();
    repeated->advance(6e-6, 3, force, {});
    repeated->rollback();
    repeated->advance(6e-6, 3, force, {});
    repeated->commit();
  }
  expect_same_bits(straight->particles(), repeated->particles());
}

TEST(Advance, without_commit_starts_from_the_committed_state) {
  const auto engine = make_engine(fast_cloud_scene(1), random_cloud(count, 1.0));
  const std::vector<Vector3> force = some_force(count, 1e-6);
  engine->advance(3e-4, 150, force, {});
  const ParticleState first = engine->particles();
  engine->advance(3e-4, 150, force, {});
  expect_same_bits(first, engine->particles());
}

TEST(Advance, calls_progress_in_every_sub_step) {
  const auto engine = make_engine(fast_cloud_scene(1), random_cloud(50, 1.0));
  int calls = 0;
  engine->advance(1e-4, 50, some_force(50, 0), [&calls] { ++calls; });
  EXPECT_EQ(calls, 50);
}

TEST(NoParticles, are_fine) {
  const auto engine = make_engine(fast_cloud_scene(2), {});
  engine->advance(1e-3, 10, {}, {});
  engine->commit();
  EXPECT_EQ(engine->particles().size(), 0);
}

}  // namespace
}  // namespace fluxpact
