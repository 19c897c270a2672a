// What the contacts of the real YADE do, beside closed forms and beside the native engine.
#include <cmath>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/yade/yade_engine.hpp"
#include "tests/unit/dem_server/native/oblique_impact.hpp"

namespace fluxpact {
namespace {

using namespace oblique;

std::unique_ptr<ParticleEngine> make_yade(const Scene& scene, const ParticleState& state) {
  return make_yade_engine(scene, make_box(scene.fluid.mesh), state);
}

/// Of a linear contact whose force is cut where the dashpot would have it pull: 0.902 at e = 0.9
/// (Schwager & Pöschel, Granular Matter 9, 2007, 465-469).
double rebound_without_pull(double e) {
  const double z = damping_ratio(e);
  const double s = std::sqrt(1 - z * z);
  return std::exp(-z / s * (std::numbers::pi - std::atan2(2 * z * s, s * s - z * z)));
}

// YADE limits the spring by friction and lets the dashpot act beside it only while the contact
// sticks; its lever arms are shortened by half of the overlap; the moment of touching is known to
// a sub-step.
constexpr double tolerance_of_laws = 0.03;

void expect_impact(const Impact& given, const Impact& expected, const char* what) {
  SCOPED_TRACE(what);
  EXPECT_NEAR(given.normal / expected.normal, 1, tolerance_of_laws);
  EXPECT_NEAR(given.tangential / expected.tangential, 1, tolerance_of_laws);
  EXPECT_NEAR(given.spin / expected.spin, 1, tolerance_of_laws);
}

TEST(YadeImpact, at_low_speed_is_that_of_the_closed_forms) {
  Scene scene = box_scene({0.04, 0.04, 0.02});
  scene.particles.time_step = time_step;
  add_laws(scene, 1000, 0.9, 0.3);
  ParticleState state;
  const std::array speeds{0.5e-3, 15e-3};  // sticks, slips
  for (int i = 0; i < 2; ++i) {
    const double y = 0.01 + 0.02 * i;
    add_sphere(state, {0.01, y, r + 1e-9}, {speeds[i], 0, -approach}, r);
    add_sphere(state, {0.02, y, 0.01}, {approach, speeds[i], 0}, r);
    add_sphere(state, {0.02 + 2 * r + 1e-9, y, 0.01}, Vector3::Zero(), r);
    // On a fixed sphere as on a wall.
    add_sphere(state, {0.03, y, 0.01}, Vector3::Zero(), r);
    add_sphere(state, {0.03, y, 0.01 + 2 * r + 1e-9}, {speeds[i], 0, -approach}, r);
  }
  state.fixed.assign(10, 0);
  state.fixed[3] = state.fixed[8] = 1;
  const auto engine = make_yade(scene, state);
  run(*engine, 1e-3, time_step);
  const ParticleState& after = engine->particles();
  const auto impact = [&](int row, int normal, int tangential, int spin) {
    return Impact{1e3 * after.velocity[row][normal], 1e3 * after.velocity[row][tangential],
                  after.spin[row][spin]};
  };
  expect_impact(impact(0, 2, 0, 1), wall_sticks, "wall, sticks");
  expect_impact(impact(1, 0, 1, 2), pair_sticks, "pair, sticks");
  expect_impact(impact(5, 2, 0, 1), wall_slips(15e-3), "wall, slips");
  expect_impact(impact(6, 0, 1, 2), pair_slips(15e-3), "pair, slips");
  // The moment of touching, known to a sub-step, is worth 1e-3 (oblique_impact.hpp).
  EXPECT_NEAR(after.velocity[0].z() / approach, rebound_without_pull(0.9), 2e-3);
  EXPECT_NEAR((after.velocity[2].x() - after.velocity[1].x()) / approach, rebound_without_pull(0.9),
              2e-3);
  // The plane that a fixed sphere of the same size touches turns with the motion along it: by
  // 1.5 mm/s times the contact time of 0.3 ms over 2 r at most, a tenth of a percent.
  EXPECT_NEAR(after.velocity[4].z() / approach, rebound_without_pull(0.9), 3e-3);
  EXPECT_EQ(after.position[3], state.position[3]);
  EXPECT_EQ(after.velocity[3], Vector3::Zero());
}

TEST(YadeImpact, on_a_wall_may_be_stiffer_and_duller_than_among_particles) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  add_pair(scene, "glass", "glass", 1000, 0.9, 0.3);
  add_pair(scene, "glass", "walls", 4000, 0.5, 0.1);
  ParticleState state;
  add_sphere(state, {0.01, 0.01, r + 1e-9}, {0, 0, -approach}, r);
  const auto engine = make_yade(scene, state);
  run(*engine, 1e-3, time_step);
  const double rebound = rebound_without_pull(0.5);
  EXPECT_NEAR(rebound, 0.55, 0.001);
  // The dashpot acts as if stronger by the factor 1 + γ dt / 2, here 1.005, half a sub-step late.
  EXPECT_NEAR(engine->particles().velocity[0].z() / approach, rebound, 0.01 * rebound);
}

TEST(YadeImpact, of_some_dozen_spheres_go_as_in_the_native_engine) {
  Scene scene = box_scene({0.012, 0.012, 0.03});
  scene.scene.gravity = {0, 0, -9.81};
  scene.coupling.window = 5e-4;
  scene.particles.time_step = 5e-6;
  add_laws(scene, 1000, 0.9, 0.3);
  ParticleState state;
  for (int i = 0; i < 48; ++i) {
    const double shift = 1e-4 * (i % 7);
    add_sphere(state,
               {2e-3 + 2.6e-3 * (i % 4) + shift, 2e-3 + 2.6e-3 * (i / 4 % 4) - shift / 2 + 2e-4,
                1.05e-3 + 2.3e-3 * (i / 16)},
               {0.02 * (i % 3 - 1), 0.03 * (i % 5 - 2), -0.1}, r);
  }
  const auto yade = make_yade(scene, state);
  const auto native = make_engine(scene, state);
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  std::vector<Vector3> force(48);
  for (int i = 0; i < 48; ++i) force[i] = {1e-5 * (i % 3), 0, -0.3 * mass * (i % 2)};
  int window = 0;
  const auto go_to = [&](int last) {
    for (; window < last; ++window) {
      for (ParticleEngine* engine : {yade.get(), native.get()}) {
        engine->advance(5e-4, 100, force, {});
        engine->commit();
      }
    }
  };
  const auto worst = [&](const auto& of) {
    double most = 0;
    for (int i = 0; i < 48; ++i) most = std::max(most, of(i));
    return most;
  };
  const auto apart = [&] {
    return worst([&](int i) {
      return (yade->particles().position[i] - native->particles().position[i]).norm();
    });
  };
  const auto moved = [&] {
    return worst([&](int i) { return (yade->particles().position[i] - state.position[i]).norm(); });
  };
  go_to(10);  // each has met the floor or others once or twice
  // Few contacts have each changed what follows by what the laws differ in.
  EXPECT_GT(moved(), 5e-4);
  EXPECT_LT(apart(), tolerance_of_laws * moved());
  go_to(60);  // and lies still, or nearly so
  const auto mean_height = [&](const ParticleEngine& engine) {
    double sum = 0;
    for (const Vector3& position : engine.particles().position) sum += position.z();
    return sum / 48;
  };
  // Which sphere lies where is chance by now; how high they lie on each other is not.
  EXPECT_NEAR(mean_height(*yade), mean_height(*native), 0.1 * r);
}

}  // namespace
}  // namespace fluxpact
