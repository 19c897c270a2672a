// Spheres of two materials and mixed sizes, some of them fixed, in an engine and in the native one.
#pragma once

#include "tests/unit/dem_server/native/random_cloud.hpp"
#include "tests/verification/engines/under_test.hpp"

namespace fluxpact {

/// Two materials of different density, spheres of mixed sizes; some of them fixed.
struct Mixture {
  Scene scene;
  ParticleState state;
};

inline Mixture mixture_of(ContactLaw law, double friction) {
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
inline double difference_after(const Mixture& mixture, int windows) {
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

}  // namespace fluxpact
