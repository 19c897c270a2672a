// What must not change the motion of a bed: the order of its rows, where the origin is, the number
// of threads, and windows that were rolled back.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr int count = 5000;
constexpr double time_step = 5e-6;
constexpr double width = 0.03;
constexpr double height = 0.08;

/// A dense bed on a floor between two walls, in fast motion: a new list every 20 steps or so.
Scene bed_scene(int threads) {
  Scene scene = box_scene({width, width, height}, {Axis::y});
  scene.scene.gravity = {0, 0, -9.81};
  scene.particles.time_step = time_step;
  scene.particles.numerics.threads = threads;
  add_laws(scene, 1000, 0.9, 0.3);
  return scene;
}

ParticleState moving_bed() {
  const PackingBox box{Vector3::Zero(), {width, width, 0.045}, {false, true, false}};
  const auto centres = random_packing(box, count, 2e-3, 1);
  UniformRandom random(2);
  ParticleState state;
  for (const Vector3& centre : centres.value()) {
    const Vector3 speed(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
    add_sphere(state, centre, 2 * speed, 1e-3 * (0.9 + 0.1 * random.next()));
  }
  return state;
}

bool same_bits(const ParticleState& a, const ParticleState& b) {
  const auto same = [](const std::vector<Vector3>& p, const std::vector<Vector3>& q) {
    return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof(Vector3)) == 0;
  };
  return a.id == b.id && same(a.position, b.position) && same(a.velocity, b.velocity) &&
         same(a.spin, b.spin);
}

void run_windows(ParticleEngine& engine, int windows) {
  for (int window = 0; window < windows; ++window) run(engine, 20 * time_step, time_step);
}

TEST(Bed, is_the_same_bit_for_bit_whatever_the_order_of_its_rows) {
  const ParticleState state = moving_bed();
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  UniformRandom random(3);
  for (int i = count - 1; i > 0; --i) {
    std::swap(order[i], order[static_cast<int>(random.next() * (i + 1))]);
  }
  ParticleState mixed = state;
  for (int i = 0; i < count; ++i) {
    mixed.id[i] = state.id[order[i]];
    mixed.position[i] = state.position[order[i]];
    mixed.velocity[i] = state.velocity[order[i]];
    mixed.radius[i] = state.radius[order[i]];
  }
  const auto engine = make_engine(bed_scene(1), state);
  const auto other = make_engine(bed_scene(1), mixed);
  run_windows(*engine, 20);
  run_windows(*other, 20);
  EXPECT_TRUE(same_bits(engine->particles(), other->particles()));
  EXPECT_FALSE(same_bits(engine->particles(), state));
}

TEST(Bed, moves_alike_wherever_the_origin_is) {
  const ParticleState state = moving_bed();
  // The cells of the search lie on the box, so contacts and sums come in the same order; positions
  // are rounded to 1e-16 of the shift.
  const Vector3 shift(1.1, -0.37, 0.23);
  Scene scene = bed_scene(1);
  scene.fluid.mesh.box.lower += shift;
  scene.fluid.mesh.box.upper += shift;
  ParticleState moved = state;
  for (Vector3& x : moved.position) x += shift;
  const auto engine = make_engine(bed_scene(1), state);
  const auto other = make_engine(scene, moved);
  double worst = 0;
  for (int window = 1; window <= 5; ++window) {
    run_windows(*engine, 1);
    run_windows(*other, 1);
    worst = 0;
    for (int i = 0; i < count; ++i) {
      Vector3 apart = other->particles().position[i] - shift - engine->particles().position[i];
      apart.y() -=
          width * std::round(apart.y() / width);  // rounding may wrap one and not the other
      worst = std::max(worst, apart.norm());
    }
    fmt::print("shifted bed, step {:>3}: farthest apart {:.1e} m\n", 20 * window, worst);
  }
  // Rounding of 2e-16 m in each of 100 steps, grown by a collision or two: each multiplies what is
  // apart by some diameters over a mean free path, a few tens.
  EXPECT_LT(worst, 1e-10);
}

TEST(Bed, is_the_same_bit_for_bit_for_any_number_of_threads) {
  const auto one = make_engine(bed_scene(1), moving_bed());
  run_windows(*one, 10);
  for (const int threads : {2, 3}) {
    const auto other = make_engine(bed_scene(threads), moving_bed());
    run_windows(*other, 10);
    EXPECT_TRUE(same_bits(one->particles(), other->particles())) << threads;
  }
}

TEST(Bed, repeats_a_window_bit_for_bit_after_a_rollback) {
  const auto straight = make_engine(bed_scene(2), moving_bed());
  const auto repeated = make_engine(bed_scene(2), moving_bed());
  const std::vector<Vector3> none(count, Vector3::Zero());
  const std::vector<Vector3> storm(count, Vector3(1e-3, -2e-3, 5e-4));
  for (int window = 0; window < 4; ++window) {
    straight->advance(40 * time_step, 40, none, {});
    straight->commit();
    // An attempt under another force that remakes the list several times, then one that is right
    // but given up.
    repeated->advance(100 * time_step, 100, storm, {});
    repeated->rollback();
    repeated->advance(40 * time_step, 40, none, {});
    repeated->rollback();
    repeated->advance(40 * time_step, 40, none, {});
    repeated->commit();
    ASSERT_TRUE(same_bits(straight->particles(), repeated->particles())) << window;
  }
}

}  // namespace
}  // namespace fluxpact
