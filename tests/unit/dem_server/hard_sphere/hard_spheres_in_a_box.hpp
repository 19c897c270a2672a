// Scenes of a few hard spheres for the tests of the event-driven engine, built in code.
#pragma once

#include <numbers>
#include <optional>

#include "dem_server/backends/hard_sphere/hard_sphere_engine.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {

/// Restitution, friction and, if it is not what springs would give, tangential restitution of one
/// pair.
inline void add_collision(Scene& scene, const std::string& other, double e, double mu,
                          std::optional<double> tangential = {}) {
  PairSettings pair;
  pair.between = {"glass", other};
  pair.restitution = e;
  pair.friction = mu;
  pair.tangential_restitution = tangential;
  scene.particles.contact.pairs.push_back(pair);
}

/// The same between spheres and at walls.
inline void add_collisions(Scene& scene, double e, double mu,
                           std::optional<double> tangential = {}) {
  add_collision(scene, "glass", e, mu, tangential);
  add_collision(scene, "walls", e, mu, tangential);
}

inline std::unique_ptr<ParticleEngine> make_hard(const Scene& scene, const ParticleState& state) {
  return make_hard_sphere_engine(scene, make_box(scene.fluid.mesh), state);
}

inline double mass_of(const ParticleState& state, int row) {
  const double r = state.radius[row];
  return 4.0 / 3.0 * std::numbers::pi * r * r * r * state.density[row];
}

/// Of all free particles.
struct Sums {
  double energy = 0;                           ///< kinetic, with that of spin [J]
  Vector3 momentum = Vector3::Zero();          ///< [N s]
  Vector3 angular_momentum = Vector3::Zero();  ///< about the origin [N m s]
};
inline Sums sums_of(const ParticleState& state) {
  Sums sums;
  for (int row = 0; row < state.size(); ++row) {
    const double m = mass_of(state, row);
    const double inertia = 0.4 * m * state.radius[row] * state.radius[row];
    const Vector3& v = state.velocity[row];
    const Vector3& w = state.spin[row];
    sums.energy += 0.5 * m * v.squaredNorm() + 0.5 * inertia * w.squaredNorm();
    sums.momentum += m * v;
    sums.angular_momentum += m * state.position[row].cross(v) + inertia * w;
  }
  return sums;
}

}  // namespace fluxpact
