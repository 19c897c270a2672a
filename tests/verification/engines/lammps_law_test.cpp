// The laws that LAMMPS takes by pairs of materials, for any sizes and masses, beside the native
// engine.
#include <fmt/core.h>

#include "dem_server/backends/lammps/lammps_script.hpp"
#include "tests/unit/dem_server/native/random_cloud.hpp"
#include "tests/verification/engines/under_test.hpp"

namespace fluxpact {
namespace {

/// Two materials of different density, spheres of mixed sizes; some of them fixed.
struct Mixture {
  Scene scene;
  ParticleState state;
};

Mixture mixture_of(ContactLaw law, double friction) {
  Mixture mixture{cloud_scene({Axis::x}), random_cloud(200, 0.3)};
  Scene& scene = mixture.scene;
  scene.scene.gravity = {0, 0, -9.81};
  scene.particles.materials["steel"].density = 7800;
  scene.particles.contact.law = law;
  scene.particles.contact.pairs.clear();
  if (law == ContactLaw::hertz) {
    scene.particles.materials["glass"].youngs_modulus = 5e6;
    scene.particles.materials["glass"].poisson_ratio = 0.2;
    scene.particles.materials["steel"].youngs_modulus = 2e7;
    scene.particles.materials["steel"].poisson_ratio = 0.3;
    scene.particles.contact.walls = WallMaterialSettings{1e7, 0.25};
  }
  add_pair(scene, "glass", "glass", 1000, 0.9, friction);
  add_pair(scene, "glass", "steel", 1500, 0.8, friction);
  add_pair(scene, "steel", "steel", 2000, 1.0, 0.5 * friction);
  add_pair(scene, "glass", "walls", 1200, 0.7, friction);
  add_pair(scene, "steel", "walls", 2000, 0.5, friction);
  scene.particles.time_step = 1e-6;
  mixture.state.fixed.assign(mixture.state.id.size(), 0);
  for (int row = 0; row < mixture.state.size(); ++row) {
    if (row % 3 == 0) {
      mixture.state.material[row] = 1;
      mixture.state.density[row] = 7800;
    }
    if (row % 50 == 7) {
      mixture.state.fixed[row] = 1;
      mixture.state.velocity[row].setZero();
    }
  }
  return mixture;
}

/// Root mean square of the difference of velocities over that of the native engine's.
double difference_after(const Mixture& mixture, int windows) {
  const auto engine = make_under_test(mixture.scene, mixture.state);
  const auto native = make_engine(mixture.scene, mixture.state);
  for (int k = 0; k < windows; ++k) {
    run(*engine, 5e-5, 1e-6);
    run(*native, 5e-5, 1e-6);
  }
  double square = 0;
  double all = 0;
  for (int row = 0; row < mixture.state.size(); ++row) {
    const Vector3& velocity = native->particles().velocity[row];
    square += (engine->particles().velocity[row] - velocity).squaredNorm();
    all += velocity.squaredNorm();
    if (mixture.state.is_fixed(row)) {
      EXPECT_EQ(engine->particles().position[row], mixture.state.position[row]);
    }
  }
  return std::sqrt(square / all);
}

TEST(Law, without_friction_is_that_of_the_native_engine_for_any_masses) {
  const double linear = difference_after(mixture_of(ContactLaw::linear, 0), 100);
  const double hertz = difference_after(mixture_of(ContactLaw::hertz, 0), 100);
  fmt::print("velocities differ by {:.2g} (linear), {:.2g} (hertz)\n", linear, hertz);
  // The root of the polynomial of `damping tsuji` is good to 1e-13 of the dashpot; collisions let
  // it grow.
  EXPECT_LT(linear, 1e-9);
  EXPECT_LT(hertz, 1e-9);
}

// LAMMPS turns spheres by the lever r - δ/2: of the order of δ / 2r = 1e-2 of the spins' gains.
TEST(Law, with_friction_differs_by_the_lever) {
  const double linear = difference_after(mixture_of(ContactLaw::linear, 0.3), 40);
  const double hertz = difference_after(mixture_of(ContactLaw::hertz, 0.3), 40);
  fmt::print("velocities differ by {:.2g} (linear), {:.2g} (hertz)\n", linear, hertz);
  EXPECT_LT(linear, 5e-3);
  EXPECT_LT(hertz, 5e-3);
}

TEST(Law, finds_the_coefficient_that_lammps_turns_into_ours) {
  for (const double share : {0.0, 1e-3, 0.0671, 0.5, 1.2728, 2.0, 2.236}) {
    const double c = tsuji_coefficient(share);
    const double made =
        1.2728 +
        c * (-4.2783 + c * (11.087 + c * (-22.348 + c * (27.467 + c * (-18.022 + c * 4.8218)))));
    EXPECT_NEAR(made, share, 1e-13) << share;  // sums of numbers up to 28
  }
}

}  // namespace
}  // namespace fluxpact
