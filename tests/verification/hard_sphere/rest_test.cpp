// Beds that come to rest on the ground, and clusters that would collapse: the work stays bounded,
// nothing overlaps, and what little motion is left is what the theory of the guard says.
#include <fmt/core.h>

#include <cmath>

#include "dem_server/insertion/packing.hpp"
#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double g = 9.81;
constexpr double diameter = 2e-3;

double worst_overlap(const ParticleState& state) {
  double worst = -INFINITY;
  for (int i = 0; i < state.size(); ++i) {
    for (int j = 0; j < i; ++j) {
      const double apart = (state.position[i] - state.position[j]).norm();
      worst = std::max(worst, 1 - apart / (state.radius[i] + state.radius[j]));
    }
  }
  return worst;
}

double mean_height(const ParticleState& state) {
  double sum = 0;
  for (const Vector3& x : state.position) sum += x.z();
  return sum / state.size();
}

/// Root of the mean square of the speed along one axis [m/s].
double agitation(const ParticleState& state) {
  double sum = 0;
  for (const Vector3& v : state.velocity) sum += v.squaredNorm() / 3;
  return std::sqrt(sum / state.size());
}

TEST(HardBed, comes_to_rest_under_gravity_with_bounded_work) {
  constexpr int count = 1000;
  const double contact_time = 5e-5;
  const double side = 10 * diameter;
  const double height = count * 4.19e-9 / (side * side) / 0.4;  // a loose packing
  Scene scene = box_scene({side, side, 2 * height});
  scene.scene.gravity = {0, 0, -g};
  add_collisions(scene, 0.9, 0.3);
  const PackingBox box{Vector3::Zero(), {side, side, height}, {false, false, false}};
  const auto centres = random_packing(box, count, diameter, 1);
  ParticleState state;
  for (const Vector3& x : centres.value()) add_sphere(state, x, Vector3::Zero(), 0.5 * diameter);
  const auto engine = make_hard(scene, state);
  for (int window = 0; window < 100; ++window) run(*engine, 2e-3, contact_time);
  const std::int64_t before = engine->counters().collisions;
  const double z = mean_height(engine->particles());
  double worst = -INFINITY;
  double speed = 0;
  for (int window = 0; window < 25; ++window) {
    run(*engine, 2e-3, contact_time);
    worst = std::max(worst, worst_overlap(engine->particles()));
    speed = std::max(speed, agitation(engine->particles()));
  }
  const double rate =
      2.0 * static_cast<double>(engine->counters().collisions - before) / (count * 0.05);
  // With n layers above, a sphere gets n m g from collisions of some 2 m v at this rate.
  const double layers = 2 * z / diameter;
  fmt::print(
      "overlap {:.1e}, agitation {:.2e} m/s, {:.2f} collisions in a contact's time; "
      "sinks {:.2e} m\n",
      worst, speed, rate * contact_time, z - mean_height(engine->particles()));
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(rate * contact_time, 3);  // the guard's rate is about one to two
  EXPECT_LT(speed, layers * g * contact_time);
  EXPECT_LT(std::abs(z - mean_height(engine->particles())), 0.05 * diameter);
}

TEST(HardBed, of_soft_spheres_that_overlap_goes_on) {
  // A column of four squeezed between two walls by 0.5 %: as soft spheres at rest leave it.
  const double squeezed = 0.995 * diameter;
  Scene scene = box_scene({4 * squeezed, 4 * squeezed, 0.02});
  scene.scene.gravity = {0, 0, -g};
  add_collisions(scene, 0.9, 0.3);
  ParticleState state;
  for (int k = 0; k < 64; ++k) {
    add_sphere(state, squeezed * Vector3(k % 4 + 0.5, k / 4 % 4 + 0.5, k / 16 + 0.5),
               Vector3::Zero(), 0.5 * diameter);
  }
  const auto engine = make_hard(scene, state);
  for (int window = 0; window < 50; ++window) run(*engine, 1e-3, 2e-5);
  // They cannot come apart sideways, so they stay as much smaller as they were; none gets through.
  EXPECT_LT(worst_overlap(engine->particles()), 0.0052);
  EXPECT_LT(agitation(engine->particles()), 0.02);
  EXPECT_NEAR(mean_height(engine->particles()), 2 * squeezed, 0.05 * diameter);
}

TEST(HardCluster, that_would_collapse_does_not) {
  // Three on a line with e = 0.05 collide for ever in a finite time (McNamara & Young 1992: below
  // e = 0.0718 for three).
  Scene scene = box_scene({0.1, 0.02, 0.02});
  add_collisions(scene, 0.05, 0.0);
  ParticleState state;
  add_sphere(state, {0.04, 0.01, 0.01}, {1, 0, 0}, 1e-3);
  add_sphere(state, {0.05, 0.01, 0.01}, {0, 0, 0}, 1e-3);
  add_sphere(state, {0.06, 0.01, 0.01}, {-1, 0, 0}, 1e-3);
  const auto engine = make_hard(scene, state);
  run(*engine, 0.02, 1e-5);
  EXPECT_LT(engine->counters().collisions, 200);
  EXPECT_GT(engine->counters().collisions, 10);
  EXPECT_LT(worst_overlap(engine->particles()), 1e-12);
  // What is left of the energy when the guard comes is nothing against what there was.
  EXPECT_LT(sums_of(engine->particles()).energy, 1e-3 * sums_of(state).energy);
}

}  // namespace
}  // namespace fluxpact
