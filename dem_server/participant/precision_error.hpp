// What mixed precision costs: the last committed state goes on for one window in mixed and in
// double precision, and the difference is told. Done once, after the last window.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Over all free particles, after one window.
struct PrecisionError {
  /// Of the velocities, over the rms of what they gained in the window, or over what gravity gives
  /// in it where that is more (in a bed at rest nothing is gained).
  double velocity_rms = 0, velocity_max = 0;
  /// Of the overlaps of touching spheres, over their mean overlap; 0 if none touch.
  double overlap_rms = 0, overlap_max = 0;
  /// Of the positions, over the radius of each.
  double position_rms = 0, position_max = 0;
};

/// The difference of two states that were `before` a window of `window` [s] ago, `exact` in double
/// precision; rows of the same particles.
PrecisionError precision_error(const Scene& scene, const Mesh& mesh, double window,
                               const ParticleState& before, const ParticleState& exact,
                               const ParticleState& mixed);

/// Advances `engine`, of mixed precision and without a candidate, and an engine in double precision
/// that takes its state, by `window` [s] in `sub_steps` under `force` [N]; the state of `engine`
/// stays as it is. Throws what `advance` throws.
PrecisionError measure_precision(const Scene& scene, const Mesh& mesh, ParticleEngine& engine,
                                 double window, int sub_steps, std::span<const Vector3> force,
                                 const Progress& progress);

/// Adds them to a result: the fields precision_*.
void publish_precision(const PrecisionError& error, Fields& out);

}  // namespace fluxpact
