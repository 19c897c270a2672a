// The engine that a program of these tests is about: LAMMPS or LIGGGHTS, which cannot stand in one
// program. The same tests are built with each.
#pragma once

#include <memory>
#include <string>

#include "dem_server/backends/particle_engine.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {

struct UnderTest {
  std::string name;
  /// Of the speeds after an impact at low speed, against the closed form.
  double impact_tolerance;
  /// Of velocities against the native engine's, relative to the largest, after a few collisions.
  double trajectory_tolerance;
  /// The same, of two ways through the same windows that differ by round-off at each step.
  double round_off;
};

UnderTest under_test();

std::unique_ptr<ParticleEngine> make_under_test(const Scene& scene, const ParticleState& state);

}  // namespace fluxpact
