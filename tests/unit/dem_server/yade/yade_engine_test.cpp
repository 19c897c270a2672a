// The real YADE as a particle engine: free flight, particles that come and go, what is refused,
// and how its end shows.
#include "dem_server/backends/yade/yade_engine.hpp"

#include <signal.h>
#include <unistd.h>

#include <fstream>
#include <numbers>

#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double r = 1e-3;

std::unique_ptr<ParticleEngine> make_yade(const Scene& scene, const ParticleState& state) {
  return make_yade_engine(scene, make_box(scene.fluid.mesh), state);
}

Scene glass_in_a_box(double upper = 0.02) {
  Scene scene = box_scene({upper, upper, upper});
  add_laws(scene, 1000, 0.9, 0.3);
  return scene;
}

pid_t yade_child() {
  std::ifstream file(fmt::format("/proc/{0}/task/{0}/children", getpid()));
  pid_t child = 0;
  file >> child;
  return child;
}

TEST(YadeEngine, gives_a_free_particle_exactly_what_acts_on_it) {
  Scene scene = glass_in_a_box();
  scene.scene.gravity = {0, 0, -9.81};
  ParticleState state;
  const Vector3 start(0.01, 0.01, 0.01);
  const Vector3 velocity(0.1, -0.2, 0.3);
  add_sphere(state, start, velocity, r);
  const auto engine = make_yade(scene, state);
  const double mass = 4.0 / 3.0 * std::numbers::pi * r * r * r * 2250;
  Vector3 x = start;
  Vector3 v = velocity;
  // Windows of different forces and steps: nothing of one may leak into the next.
  for (const auto& [force, steps] : {std::pair{Vector3(1e-4, 0, 0), 1},
                                     {Vector3(-3e-4, 2e-4, 1e-4), 7},
                                     {Vector3(0, 0, 0), 3}}) {
    const double window = 1e-5 * steps;
    const Vector3 acceleration = force / mass + scene.scene.gravity;
    x += v * window + 0.5 * acceleration * window * window;
    v += acceleration * window;
    engine->advance(window, steps, std::vector{force}, {});
    engine->commit();
    // Round-off of seven sub-steps.
    EXPECT_LT((engine->particles().velocity[0] - v).norm(), 1e-14 * v.norm());
    EXPECT_LT((engine->particles().position[0] - x).norm(), 1e-14 * x.norm());
  }
}

TEST(YadeEngine, lets_particles_leave_and_enter_and_takes_that_back) {
  const Scene scene = glass_in_a_box();
  ParticleState state;
  for (int i = 0; i < 4; ++i) add_sphere(state, {0.003 + 0.004 * i, 0.01, 0.01}, {0, 0, 0.1}, r);
  const auto engine = make_yade(scene, state);
  ParticleState entering;
  add_sphere(entering, {0.01, 0.003, 0.003}, {0.2, 0, 0}, r);
  entering.id = {7};
  const std::vector<Vector3> none(4, Vector3::Zero());
  for (const bool keep : {false, true}) {
    engine->advance(1e-3, 100, none, {});
    engine->exchange(std::vector{0, 2}, entering);
    EXPECT_EQ(engine->particles().id, (std::vector<std::int64_t>{2, 4, 7}));
    if (keep) {
      engine->commit();
    } else {
      engine->rollback();
      EXPECT_EQ(engine->particles().id, state.id);
      EXPECT_EQ(engine->particles().position, state.position);
    }
  }
  engine->advance(1e-3, 100, std::vector<Vector3>(3, Vector3::Zero()), {});
  const ParticleState& now = engine->particles();
  const std::vector<Vector3> expected{
      {0.007, 0.01, 0.0102}, {0.015, 0.01, 0.0102}, {0.0102, 0.003, 0.003}};
  for (int row = 0; row < 3; ++row) {
    // Round-off of a hundred sub-steps.
    EXPECT_LT((now.position[row] - expected[row]).norm(), 1e-15) << row;
  }
}

TEST(YadeEngine, names_a_particle_that_got_lost_and_goes_back) {
  Scene scene = glass_in_a_box();
  scene.particles.walls = WallSource::none;
  scene.particles.outflow.emplace();  // nobody may leave
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {0, 0, 9}, r);
  const auto engine = make_yade(scene, state);
  const std::vector<Vector3> none(1, Vector3::Zero());
  const std::string text = message_of<NumericsError>([&] { engine->advance(2e-3, 100, none, {}); });
  expect_contains(text, "particle 1");
  expect_contains(text, "z_max");
  engine->rollback();
  EXPECT_EQ(engine->particles().position, state.position);
  engine->advance(1e-3, 100, none, {});
  EXPECT_NEAR(engine->particles().position[0].z(), 0.019, 1e-15);
}

TEST(YadeEngine, that_is_killed_is_a_named_error) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {0, 0, 0}, r);
  const auto engine = make_yade(glass_in_a_box(), state);
  ASSERT_GT(yade_child(), 0);
  kill(yade_child(), SIGKILL);
  const std::vector<Vector3> none(1, Vector3::Zero());
  const std::string text = message_of<ProtocolError>([&] { engine->advance(1e-3, 100, none, {}); });
  expect_contains(text, "YADE");
  expect_contains(text, "signal 9");
}

TEST(YadeEngine, that_is_silent_is_a_named_error) {
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {0, 0, 0}, r);
  Scene scene = glass_in_a_box();
  scene.launch.deadline = 4;
  const auto engine = make_yade(scene, state);
  kill(yade_child(), SIGSTOP);
  const std::vector<Vector3> none(1, Vector3::Zero());
  const std::string text = message_of<ProtocolError>([&] { engine->advance(1e-3, 100, none, {}); });
  expect_contains(text, "YADE");
  expect_contains(text, "silent for 3 s");
}

TEST(YadeEngine, refuses_what_it_cannot_do_before_it_starts) {
  ParticleState two;
  add_sphere(two, {0.005, 0.005, 0.005}, {0, 0, 0}, r);
  ParticleState fixed = two;
  fixed.fixed = {1};
  add_sphere(two, {0.01, 0.01, 0.01}, {0, 0, 0}, 0.5 * r);
  const auto refused = [](const Scene& scene, const ParticleState& state, const char* why) {
    expect_contains(message_of<ConfigError>([&] { make_yade(scene, state); }), why);
  };
  refused(glass_in_a_box(), two, "particle 2");
  refused(glass_in_a_box(), fixed, "nothing to move");
  Scene periodic = box_scene({0.02, 0.02, 0.02}, {Axis::y});
  add_laws(periodic, 1000, 0.9, 0.3);
  ParticleState one = fixed;
  one.fixed.clear();
  refused(periodic, one, "fluid.mesh.periodic");
  Scene coarse = glass_in_a_box();
  coarse.particles.time_step = 1e-4;
  refused(coarse, one, "particles.time_step");
  EXPECT_EQ(yade_child(), 0);
}

}  // namespace
}  // namespace fluxpact
