// What mixed precision costs: the measure, and who is told.
#include "dem_server/participant/precision_error.hpp"

#include <gtest/gtest.h>

#include "bench.hpp"
#include "dem_server/backends/native/native_engine.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace fluxpact {
namespace {

constexpr double window = 2e-4;

TEST(PrecisionError, is_the_difference_in_the_units_that_it_says) {
  Scene scene = box_scene({0.01, 0.01, 0.01}, {Axis::x});
  const Mesh mesh = make_box(scene.fluid.mesh);
  ParticleState before;
  // Two that overlap by 0.1 mm across the periodic side, and one alone.
  add_sphere(before, {0.5e-3, 5e-3, 5e-3}, {0, 0, 0}, 1e-3);
  add_sphere(before, {8.6e-3, 5e-3, 5e-3}, {0, 0, 0}, 1e-3);
  add_sphere(before, {5e-3, 5e-3, 9e-3}, {0, 0, 0}, 0.5e-3);
  ParticleState exact = before;
  for (Vector3& velocity : exact.velocity) velocity = {0, 0.3, 0.4};  // gains of 0.5 m/s
  ParticleState mixed = exact;
  mixed.velocity[0].z() += 1e-3;
  mixed.position[1].x() += 1e-6;  // overlap 1e-6 more
  const PrecisionError error = precision_error(scene, mesh, window, before, exact, mixed);
  EXPECT_NEAR(error.velocity_max, 1e-3 / 0.5, 1e-12);
  EXPECT_NEAR(error.velocity_rms, 1e-3 / 0.5 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(error.overlap_max, 1e-6 / 1e-4, 1e-8);
  EXPECT_NEAR(error.overlap_rms, 1e-6 / 1e-4, 1e-8);
  EXPECT_NEAR(error.position_max, 1e-6 / 1e-3, 1e-9);
  EXPECT_NEAR(error.position_rms, 1e-6 / 1e-3 / std::sqrt(3.0), 1e-9);
}

TEST(PrecisionError, knows_images_fixed_particles_and_a_bed_at_rest) {
  Scene scene = box_scene({0.01, 0.01, 0.01}, {Axis::x});
  scene.scene.gravity = {0, 0, -10};
  const Mesh mesh = make_box(scene.fluid.mesh);
  ParticleState state;
  add_sphere(state, {1e-9, 5e-3, 5e-3}, {0, 0, 0}, 1e-3);
  add_sphere(state, {5e-3, 5e-3, 5e-3}, {0, 0, 0}, 1e-3);
  state.fixed = {0, 1};
  ParticleState mixed = state;
  mixed.position[0].x() = 0.01 - 1e-9;
  mixed.velocity[0].x() = 1e-6;
  const PrecisionError error = precision_error(scene, mesh, window, state, state, mixed);
  EXPECT_NEAR(error.position_max, 2e-9 / 1e-3, 1e-12);
  EXPECT_NEAR(error.position_rms, error.position_max, 1e-12) << "of the free one alone";
  EXPECT_NEAR(error.velocity_rms, 1e-6 / (10 * window), 1e-9) << "of what gravity would give";
  EXPECT_EQ(error.overlap_rms, 0);
  const PrecisionError none = precision_error(scene, mesh, window, {}, {}, {});
  EXPECT_EQ(none.velocity_rms, 0);
}

TEST(PrecisionError, of_a_cloud_is_that_of_floats_and_leaves_it_as_it_is) {
  Scene scene = cloud_scene({Axis::y});
  scene.scene.gravity = {0, 0, -9.81};
  scene.particles.numerics.precision = Precision::mixed;
  const Mesh mesh = make_box(scene.fluid.mesh);
  const auto engine = make_native_engine(scene, mesh, random_cloud(500, 0.3));
  run(*engine, window, 2e-6);
  const ParticleState before = engine->particles();
  const std::vector<Vector3> none(before.id.size(), Vector3::Zero());
  const PrecisionError error = measure_precision(scene, mesh, *engine, window, 100, none, {});
  EXPECT_EQ(engine->particles().position, before.position);
  EXPECT_EQ(engine->particles().velocity, before.velocity);
  // A velocity is rounded by 2^-25 of itself on average in each of 100 sub-steps, an overlap by
  // that of the distance of the centres. So one contact in thousands begins a sub-step earlier or
  // later, which is a dashpot's impulse in one sub-step, γ dt = 2e-3 of the speed, of few
  // particles.
  constexpr double rounding = 0x1p-25;
  EXPECT_GT(error.velocity_rms, rounding);
  EXPECT_LT(error.velocity_rms, 1e-3);
  EXPECT_LT(error.velocity_max, 1e-2);
  EXPECT_GT(error.overlap_rms, 0);
  EXPECT_LT(error.overlap_rms, 1e-3);
  EXPECT_GT(error.position_rms, 0);
  EXPECT_LT(error.position_max, 1e-2 * 0.3 * window / 1e-3);
}

/// Participants of the native engine, which tell at the end what mixed precision has cost.
std::map<std::string, double> figures_of(Precision precision, int windows) {
  testing_bench::Bench bench;
  bench.scene.particles.materials["glass"].density = 100;
  bench.scene.particles.numerics.precision = precision;
  bench.scene.particles.time_step = 1e-5;
  add_laws(bench.scene, 1000, 0.9, 0.3);
  ParticleState particles;
  for (int i = 0; i < 27; ++i) {
    add_sphere(particles, 0.099 * Vector3(i % 3 + 0.5, i / 3 % 3 + 0.5, i / 9 + 0.5),
               {0.1 * (i % 2), 0, 0}, 0.02, 100);
  }
  ParticleParticipant side("native", [&](const Scene& scene, const Mesh& mesh) {
    return make_native_engine(scene, mesh, particles);
  });
  side.configure(bench.scene, bench.mesh);
  Fields out;
  side.start({}, out);
  for (int step = 1; step <= windows; ++step) {
    Fields result;
    side.advance(bench.window(step), bench.fluid(), result, testing_bench::quiet);
    side.commit();
  }
  Fields snapshot;
  side.snapshot(snapshot);
  const auto before = testing_bench::copy(snapshot);
  Fields figures;
  side.figures(figures, testing_bench::quiet);
  Fields later;
  side.snapshot(later);
  EXPECT_EQ(testing_bench::copy(later), before);
  EXPECT_TRUE(figures.views().empty());
  return figures.numbers();
}

TEST(Figures, of_a_run_in_mixed_precision_are_its_error_and_of_others_nothing) {
  const auto mixed = figures_of(Precision::mixed, 2);
  ASSERT_EQ(mixed.size(), 6U);
  EXPECT_GT(mixed.at(field::precision_velocity_rms), 0);
  EXPECT_LT(mixed.at(field::precision_velocity_rms), 1e-4);
  EXPECT_TRUE(figures_of(Precision::full, 2).empty());
  EXPECT_TRUE(figures_of(Precision::mixed, 0).empty());
}

}  // namespace
}  // namespace fluxpact
