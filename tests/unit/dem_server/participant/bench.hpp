// A periodic box, a fluid that the test writes itself, and particles without contacts.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "dem_server/participant/particle_participant.hpp"
#include "free_flight.hpp"
#include "proto/mesh/box.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact::testing_bench {

inline const Progress quiet = [] {};

/// A scene of one periodic box and a fluid whose fields the test writes itself.
struct Bench {
  explicit Bench(std::array<int, 3> cells = {3, 3, 3}) {
    scene.scene.gravity = {0, 0, -9.81};
    scene.coupling.window = 1e-3;
    scene.particles.time_step = 2.5e-4;
    scene.particles.numerics.threads = 1;
    scene.fluid.density = 1.2;
    scene.fluid.viscosity = 1.8e-5;
    scene.fluid.mesh.box = {{0, 0, 0}, {0.3, 0.3, 0.3}, cells};
    scene.fluid.mesh.periodic = {Axis::x, Axis::y, Axis::z};
    scene.interphase.drag = DragLaw::stokes;
    mesh = make_box(scene.fluid.mesh);
    velocity.assign(mesh.cell_volumes.size(), Vector3::Zero());
    gradient.assign(mesh.cell_volumes.size(), Vector3::Zero());
  }

  std::unique_ptr<ParticleParticipant> take_part(const ParticleState& initial, bool held = false) {
    auto side = std::make_unique<ParticleParticipant>("test", [&, held, initial](const Scene& s,
                                                                                 const Mesh&) {
      return std::make_unique<FreeFlight>(initial, s.scene.gravity, Vector3::Constant(0.3), held);
    });
    side->configure(scene, mesh);
    return side;
  }

  Fields fluid() const {
    Fields in;
    in.add(field::velocity, velocity);
    in.add(field::pressure_gradient, gradient);
    return in;
  }
  Window window(std::int64_t step) const {
    const double length = scene.coupling.window;
    return {step, static_cast<double>(step - 1) * length, length};
  }

  Scene scene;
  Mesh mesh;
  std::vector<Vector3> velocity;
  std::vector<Vector3> gradient;
};

/// 60 light spheres all over the box, moving.
inline ParticleState cloud() {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> place(0, 0.3);
  ParticleState particles;
  for (int i = 0; i < 60; ++i) {
    particles.id.push_back(i + 1);
    particles.position.emplace_back(place(random), place(random), place(random));
    particles.velocity.emplace_back(place(random), place(random), place(random));
    particles.spin.emplace_back(Vector3::Zero());
    particles.radius.push_back(0.004 + 0.02 * place(random));
    particles.density.push_back(100);
    particles.material.push_back(0);
  }
  return particles;
}

inline Vector3 sum(std::span<const Vector3> values) {
  Vector3 total = Vector3::Zero();
  for (const Vector3& value : values) total += value;
  return total;
}

/// Of the committed particles.
struct Velocities {
  std::vector<Vector3> value;          ///< [m/s], by rows
  Vector3 momentum = Vector3::Zero();  ///< of all [kg m/s]
};

inline Velocities velocities(ParticleParticipant& side) {
  Fields state;
  side.snapshot(state);
  const int count = static_cast<int>(state.views().front().values.size());
  const auto v = state.vectors("velocity", count);
  const auto radius = state.scalars("radius", count);
  const auto density = state.scalars("density", count);
  Velocities all{{v.begin(), v.end()}};
  for (int i = 0; i < count; ++i) all.momentum += density[i] * ball_volume(radius[i]) * v[i];
  return all;
}

/// The fields and numbers of a message but the time it took, to compare with another.
inline std::map<std::string, std::vector<double>> copy(const Fields& fields) {
  std::map<std::string, std::vector<double>> all;
  for (const FieldView& view : fields.views()) {
    all[view.name] = {view.values.begin(), view.values.end()};
  }
  for (const auto& [name, value] : fields.numbers()) {
    if (name != field::wall_seconds) all[name] = {value};
  }
  return all;
}

}  // namespace fluxpact::testing_bench
