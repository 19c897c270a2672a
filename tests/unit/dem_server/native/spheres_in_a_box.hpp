// Scenes of a few spheres for the tests of the particle engines, built in code.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "dem_server/backends/native/native_engine.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {

/// One material `glass` in a closed box, no gravity.
inline Scene box_scene(const Vector3& upper, std::vector<Axis> periodic = {}) {
  Scene scene;
  scene.scene.gravity = Vector3::Zero();
  scene.coupling.window = 1e-3;
  scene.fluid.mesh.box = {Vector3::Zero(), upper, {2, 2, 2}};
  scene.fluid.mesh.periodic = std::move(periodic);
  scene.particles.time_step = 1e-6;
  scene.particles.materials["glass"].density = 2250;
  scene.particles.numerics.threads = 1;
  return scene;
}

inline void add_pair(Scene& scene, const std::string& a, const std::string& b, double stiffness,
                     double e, double mu) {
  PairSettings pair;
  pair.between = {a, b};
  pair.normal_stiffness = stiffness;
  pair.restitution = e;
  pair.friction = mu;
  scene.particles.contact.pairs.push_back(pair);
}

/// The same law between spheres and at walls.
inline void add_laws(Scene& scene, double stiffness, double e, double mu) {
  add_pair(scene, "glass", "glass", stiffness, e, mu);
  add_pair(scene, "glass", "walls", stiffness, e, mu);
}

inline void add_sphere(ParticleState& state, const Vector3& position, const Vector3& velocity,
                       double radius, double density = 2250) {
  state.id.push_back(state.size() + 1);
  state.position.push_back(position);
  state.velocity.push_back(velocity);
  state.spin.push_back(Vector3::Zero());
  state.radius.push_back(radius);
  state.density.push_back(density);
  state.material.push_back(0);
}

inline std::unique_ptr<ParticleEngine> make_engine(const Scene& scene, const ParticleState& state) {
  return make_native_engine(scene, make_box(scene.fluid.mesh), state);
}

/// Run without forces for `duration` [s] in sub-steps of `time_step` [s].
inline void run(ParticleEngine& engine, double duration, double time_step) {
  const std::vector<Vector3> none(engine.particles().id.size(), Vector3::Zero());
  const int steps = static_cast<int>(std::lround(duration / time_step));
  engine.advance(duration, steps, none, {});
  engine.commit();
}

/// The text of the error that `act` throws.
template <class E>
std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const E& error) {
    return error.what();
  }
  ADD_FAILURE() << "no such error was thrown";
  return {};
}

inline void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "`" << part << "` is not in: " << text;
}

}  // namespace fluxpact
