// Clouds of spheres: what is conserved over very many collisions, and that none is missed.
#include <cmath>

#include "dem_server/backends/cell_grid.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double eps = 2.3e-16;

/// Spheres of a random packing with random velocities up to `speed` [m/s] and spins to match.
ParticleState cloud(const PackingBox& box, std::span<const double> diameters, double speed) {
  const auto centres = random_packing(box, diameters, 1);
  UniformRandom random(2);
  const auto vector = [&]() -> Vector3 {
    const double x = 2 * random.next() - 1;
    const double y = 2 * random.next() - 1;
    return {x, y, 2 * random.next() - 1};
  };
  ParticleState state;
  for (std::size_t i = 0; i < diameters.size(); ++i) {
    add_sphere(state, centres.value()[i], speed * vector(), 0.5 * diameters[i]);
    state.spin.back() = speed / diameters[i] * vector();
  }
  return state;
}

/// The largest overlap of any two, over the smaller radius.
double worst_overlap(const Scene& scene, const ParticleState& state) {
  const Domain domain = particle_domain(scene, make_box(scene.fluid.mesh));
  double worst = -INFINITY;
  for (int i = 0; i < state.size(); ++i) {
    for (int j = 0; j < i; ++j) {
      Vector3 apart = state.position[j] - state.position[i];
      for (int axis = 0; axis < 3; ++axis) {
        if (!domain.periodic(axis)) continue;
        apart[axis] -= domain.length(axis) * std::round(apart[axis] / domain.length(axis));
      }
      const double overlap = state.radius[i] + state.radius[j] - apart.norm();
      worst = std::max(worst, overlap / std::min(state.radius[i], state.radius[j]));
    }
  }
  return worst;
}

TEST(Gas, of_smooth_elastic_spheres_keeps_its_energy_and_momentum) {
  const double side = 0.02;
  Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
  add_collisions(scene, 1.0, 0.0);
  const std::vector<double> diameters(400, 2e-3);
  const ParticleState start =
      cloud({Vector3::Zero(), Vector3::Constant(side), {true, true, true}}, diameters, 1.0);
  const auto engine = make_hard(scene, start);
  const Sums before = sums_of(start);
  while (engine->counters().collisions < 120000) run(*engine, 0.05, 1e-4);
  const Sums after = sums_of(engine->particles());
  // Roundings of n collisions that go either way: sqrt(n) of one, a few times.
  const double roundings = 10 * std::sqrt(1.2e5) * eps;
  EXPECT_NEAR(after.energy / before.energy, 1, roundings);
  EXPECT_LT((after.momentum - before.momentum).norm(),
            roundings * mass_of(start, 0) * std::sqrt(400.0));
  EXPECT_LT(worst_overlap(scene, engine->particles()), 1e-12);
}

TEST(Gas, of_perfectly_rough_spheres_keeps_the_energy_of_speed_and_spin) {
  Scene scene = box_scene(Vector3::Constant(0.02));  // with walls, as rough
  add_collisions(scene, 1.0, 1e6, 1.0);
  const std::vector<double> diameters(200, 2e-3);
  const ParticleState start =
      cloud({Vector3::Zero(), Vector3::Constant(0.02), {false, false, false}}, diameters, 1.0);
  const auto engine = make_hard(scene, start);
  while (engine->counters().collisions < 20000) run(*engine, 0.05, 1e-4);
  EXPECT_NEAR(sums_of(engine->particles()).energy / sums_of(start).energy, 1,
              10 * std::sqrt(2e4) * eps);
}

TEST(Cloud, in_free_space_keeps_momentum_and_angular_momentum) {
  Scene scene = box_scene(Vector3::Constant(0.1));
  scene.particles.walls = WallSource::none;
  add_collision(scene, "glass", 0.7, 0.4);
  std::vector<double> diameters;
  for (int k = 0; k < 300; ++k) diameters.push_back(k % 3 == 0 ? 3e-3 : 1.5e-3);
  ParticleState start = cloud(
      {Vector3::Constant(0.04), Vector3::Constant(0.06), {false, false, false}}, diameters, 0.1);
  // They fly inwards, so that they meet.
  for (int row = 0; row < start.size(); ++row) {
    start.velocity[row] -= 20 * (start.position[row] - Vector3::Constant(0.05));
  }
  const auto engine = make_hard(scene, start);
  run(*engine, 0.05, 1e-5);
  EXPECT_GT(engine->counters().collisions, 1000);
  const Sums before = sums_of(start);
  const Sums after = sums_of(engine->particles());
  double size = 0;
  for (int row = 0; row < start.size(); ++row) {
    size += mass_of(start, row) * start.velocity[row].norm();
  }
  const double roundings = 10 * eps * std::sqrt(static_cast<double>(engine->counters().collisions));
  EXPECT_LT((after.momentum - before.momentum).norm(), roundings * size);
  EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(), roundings * size * 0.1);
  EXPECT_LT(after.energy, 0.9 * before.energy);
}

TEST(Cloud, of_sizes_ten_to_one_misses_no_collision) {
  // A missed one would leave an overlap. Under forces that differ, in a box with walls and images.
  Scene scene = box_scene(Vector3::Constant(0.03), {Axis::x});
  scene.scene.gravity = {0, 0, -9.81};
  add_collisions(scene, 0.95, 0.2);
  std::vector<double> diameters(8, 8e-3);
  diameters.resize(40, 3e-3);
  diameters.resize(900, 0.8e-3);
  const ParticleState start =
      cloud({Vector3::Zero(), Vector3::Constant(0.03), {true, false, false}}, diameters, 0.5);
  const auto engine = make_hard(scene, start);
  UniformRandom random(9);
  std::vector<Vector3> force(diameters.size());
  for (int window = 0; window < 20; ++window) {
    for (int row = 0; row < start.size(); ++row) {
      const double weight = mass_of(start, row) * 9.81;
      force[row] = 4 * weight * Vector3(random.next() - 0.5, random.next() - 0.5, random.next());
    }
    engine->advance(2e-3, 100, force, {});
    engine->commit();
    ASSERT_LT(worst_overlap(scene, engine->particles()), 1e-12) << window;
  }
  EXPECT_GT(engine->counters().collisions, 2000);
  for (int row = 0; row < start.size(); ++row) {
    const Vector3& x = engine->particles().position[row];
    for (const int axis : {1, 2}) {
      EXPECT_GE(x[axis], start.radius[row] * (1 - 1e-12));
      EXPECT_LE(x[axis], 0.03 - start.radius[row] * (1 - 1e-12));
    }
  }
}

TEST(Cloud, in_boxes_of_few_cells_misses_no_collision) {
  // One to three cells along each axis, of which some are periodic: images stand next to spheres.
  for (const double side : {2.2e-3, 4.5e-3, 6.5e-3}) {
    Scene scene = box_scene({side, 6.5e-3, 4.5e-3}, {Axis::x, Axis::z});
    add_collisions(scene, 1.0, 0.0);
    ParticleState start;
    UniformRandom random(6);
    for (int k = 0; k < static_cast<int>(side / 1e-3); ++k) {
      const double x = side * random.next();
      const double u = random.next() - 0.5;
      const double v = random.next() - 0.5;
      add_sphere(start, {x, 1.05e-3 + 2.1e-3 * (k % 3), 1.05e-3 + 2.2e-3 * (k / 3)},
                 {u, v, random.next() - 0.5}, 1e-3);
    }
    const auto engine = make_hard(scene, start);
    for (int window = 0; window < 40; ++window) {
      run(*engine, 1e-3, 1e-4);
      ASSERT_LT(worst_overlap(scene, engine->particles()), 1e-12) << side << " " << window;
    }
    EXPECT_GT(engine->counters().collisions, 5);
    EXPECT_NEAR(sums_of(engine->particles()).energy / sums_of(start).energy, 1, 1e-12);
  }
}

}  // namespace
}  // namespace fluxpact
