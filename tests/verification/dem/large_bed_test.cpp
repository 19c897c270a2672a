// Two million spheres: a short run on a lattice that falls and touches.
#include <fmt/core.h>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

TEST(LargeBed, of_two_million_spheres_keeps_all_of_them_and_their_momentum) {
  constexpr int side = 126;
  constexpr double spacing = 2.02e-3;
  Scene scene = box_scene(Vector3::Constant(side * spacing), {Axis::x, Axis::y, Axis::z});
  scene.particles.time_step = 5e-6;
  add_laws(scene, 1000, 0.9, 0.3);
  ParticleState state;
  // Neighbours approach each other in x at up to 0.4 m/s: they touch after 10 steps or more.
  Vector3 before = Vector3::Zero();
  for (int i = 0; i < side * side * side; ++i) {
    const Vector3 at(i % side + 0.5, i / side % side + 0.5, i / (side * side) + 0.5);
    const Vector3 velocity(i % 2 == 0 ? 0.2 : -0.2, 0.01 * (i % 7), -0.01 * (i % 5));
    add_sphere(state, spacing * at, velocity, 1e-3);
    before += velocity;
  }
  const auto engine = make_engine(scene, state);
  run(*engine, 2e-4, 5e-6);
  Vector3 after = Vector3::Zero();
  double energy = 0;
  for (const Vector3& v : engine->particles().velocity) {
    after += v;
    energy += v.squaredNorm();
  }
  const double turned = energy / (0.04 * side * side * side);
  fmt::print("{} spheres, 40 steps: momentum off by {:.1e} of 0.2 m/s each, energy {:.3f}\n",
             engine->particles().size(), (after - before).norm() / (0.2 * side * side * side),
             turned);
  EXPECT_EQ(engine->particles().size(), side * side * side);
  // The plain sums over two million grow to 6e4: each addition rounds by 1e-11, at random.
  EXPECT_LT((after - before).norm(), 1e-11 * 0.2 * side * side * side);
  EXPECT_LT(turned, 0.9);  // they did collide
}

}  // namespace
}  // namespace fluxpact
