// The budget of the particles over one window, from what their side sent: how many and how much
// mass there were, came in, left, and are.
//
// Stands beside the mass audit. Counts are exact; a mass is a sum over the particles, known to
// round-off. Where none can come in or leave, nothing may change.
#pragma once

#include <cstdint>

#include "proto/base/compensated_sum.hpp"
#include "proto/base/vector.hpp"

namespace fluxpact {

/// What was sent about one window.
struct ParticleWindow {
  std::int64_t count = 0;   ///< at the window's end
  double mass = 0;          ///< [kg]
  double excess_moved = 0;  ///< solids that over-full cells have passed to others [m³]
  std::int64_t entered = 0;
  std::int64_t left = 0;
  std::int64_t waiting = 0;           ///< due so far, without room
  double mass_entered = 0;            ///< [kg]
  double mass_left = 0;               ///< [kg]
  Vector3 momentum_entered{0, 0, 0};  ///< [N s]
  Vector3 momentum_left{0, 0, 0};     ///< [N s]
};

/// Particles at time 0 and what has come in and left since.
struct ParticleTotal {
  double initial_mass = 0;  ///< [kg]
  std::int64_t count = 0;   ///< that there must be
  CompensatedSum gained;    ///< Σ entered − left [kg]
  CompensatedSum entered;   ///< [kg]
  CompensatedSum left;      ///< [kg]
  std::int64_t count_entered = 0;
  std::int64_t count_left = 0;
};

struct ParticleAudit {
  ParticleWindow window;
  /// |initial + entered − left − mass| over initial + entered, all since time 0 [-]; 0/0 is 0.
  double mass_error = 0;
  double count_error = 0;  ///< |expected − count|, in particles
  ParticleTotal total;     ///< to be kept if the window is committed
};

/// The total at time 0.
ParticleTotal start_particles(std::int64_t count, double mass);

/// A pure function of the window and of the committed total, so a window can be repeated. A mass
/// that is not finite ends up in the result, which the gate refuses.
ParticleAudit audit_particles(const ParticleWindow& window, const ParticleTotal& committed);

}  // namespace fluxpact
