#include "proto/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fluxpact {
namespace {

/// The quotient of two decimal numbers in doubles: each is off by half an ulp, the division by
/// another half. Four times that bound still tells every quotient apart that a person would call
/// different.
bool is_whole(double quotient) {
  constexpr double slack = 8 * std::numeric_limits<double>::epsilon();
  return std::abs(quotient - std::round(quotient)) <= slack * quotient;
}

}  // namespace

int sub_steps(const Scene& scene) {
  if (scene.particles.time_step <= 0) {
    return 1;
  }
  const double quotient = scene.coupling.window / scene.particles.time_step;
  return static_cast<int>(is_whole(quotient) ? std::round(quotient) : std::ceil(quotient));
}

bool has_particles(const Scene& scene) {
  return !scene.particles.insertion.empty() || !scene.particles.inflow.empty();
}

bool knows_contacts(ParticleBackend backend) {
  return knows_springs(backend) || backend == ParticleBackend::hard_sphere;
}

bool knows_springs(ParticleBackend backend) {
  switch (backend) {
    case ParticleBackend::native:
    case ParticleBackend::lammps:
    case ParticleBackend::liggghts:
    case ParticleBackend::yade:
      return true;
    case ParticleBackend::kinematic:
    case ParticleBackend::hard_sphere:
    case ParticleBackend::custom:
      return false;
  }
  return false;
}

bool has_force(const Scene& scene, InterphaseForce force) {
  const auto& forces = scene.interphase.forces;
  return std::find(forces.begin(), forces.end(), force) != forces.end();
}

bool particles_flow(const Scene& scene) {
  const ParticleSettings& particles = scene.particles;
  if (!has_particles(scene)) return false;
  if (!particles.inflow.empty()) return true;
  if (particles.outflow) return !particles.outflow->empty();
  if (particles.walls == WallSource::none) return true;
  return std::any_of(
      scene.fluid.boundaries.begin(), scene.fluid.boundaries.end(),
      [](const auto& boundary) { return boundary.second.type == BoundaryType::pressure; });
}

int windows(const Scene& scene) {
  const double quotient = scene.scene.end_time / scene.coupling.window;
  return is_whole(quotient) ? static_cast<int>(std::round(quotient)) : 0;
}

}  // namespace fluxpact
