// LIGGGHTS tells a few kinds of spheres apart: more are refused before the first window.
#include "proto/base/errors.hpp"
#include "tests/verification/engines/mixture.hpp"

namespace fluxpact {
namespace {

TEST(Kinds, beyond_what_liggghts_tells_apart_are_refused) {
  const Mixture mixture = mixture_of(ContactLaw::linear, 0.3);  // every sphere has its own size
  const std::string text =
      message_of<ConfigError>([&] { make_under_test(mixture.scene, mixture.state); });
  expect_contains(text, "at most 8 kinds");
  expect_contains(text, "lammps");
}

TEST(Kinds, without_walls_are_one) {
  Scene scene = cloud_scene({});
  scene.particles.walls = WallSource::none;
  ParticleState state;
  add_sphere(state, {0.01, 0.01, 0.01}, {0, 0, 0}, 1e-3);
  EXPECT_NE(make_under_test(scene, state), nullptr);
  add_sphere(state, {0.02, 0.02, 0.02}, {0, 0, 0}, 2e-3);
  expect_contains(message_of<ConfigError>([&] { make_under_test(scene, state); }),
                  "at most 1 kinds");
}

}  // namespace
}  // namespace fluxpact
