// What a particle will do in the coming window as far as it is known before: the past of an offer
// (exchange.hpp), and velocities ahead of a window in coupling.scheme parallel.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "dem_server/interphase/exchange.hpp"

namespace fluxpact {

/// v* [m/s], the velocity at the end of the coming window without its drag:
///   v* = v + Δt [(1 − s) a − s J/(m Δt)],
/// a: gravity, buoyancy, E, and the pressure gradient of the fluid's newest state (unless it is
/// eliminated); s in [0, 1]: the share of the load that contacts carried in the window just ended,
/// s = −c·l/|l|² with the load l (all but contacts, per mass) and the contact part c = Δv/Δt − l. A
/// particle that rests on others will not fall, and its contacts will answer the drag as they did;
/// one in free flight has s = 0.
struct Prediction {
  std::span<const Vector3> velocity_before;  ///< [m/s] at the start of the window just ended
  double length = 0;                         ///< [s] of that window; 0: there was none, s = 0
  const WindowForces* forces = nullptr;      ///< that acted in it
  /// Row of each particle in that window, -1 for one that has just come in: s = 0. Empty: the same
  /// rows.
  std::span<const int> row_before = {};
  std::span<const Eddy> eddies = {};  ///< of that window's offer
  /// Velocities [m/s] at the start of the coming window, if that is not now (velocities_ahead): the
  /// window just ended is then the one that leads there. Empty: those of the particles.
  std::span<const Vector3> ahead = {};
};

/// Velocities [m/s] at the end of a window of `length` [s] that is yet to come under `forces` (rows
/// as they are now): v + Δt (1 − s) l, l the load by gravity and these forces, s the share that
/// contacts carried in the window just ended, `past`. Without contacts that is exact.
void velocities_ahead(const ExchangeSettings& settings, const ParticleState& particles,
                      const ParticleBulk& bulk, const Prediction& past, const WindowForces& forces,
                      double length, std::vector<Vector3>& velocity);

/// The velocity [m/s] of a particle where the coming window starts.
inline const Vector3& velocity_of(const ParticleState& particles, const Prediction& past, int i) {
  return past.ahead.empty() ? particles.velocity[i] : past.ahead[i];
}

/// The row of a particle in the window just ended; -1: there was none, or it was not there.
inline int past_row(const Prediction& past, int i) {
  if (!(past.length > 0)) return -1;
  return past.row_before.empty() ? i : past.row_before[i];
}

/// s of a particle that was in row `before` and now has this velocity [m/s].
inline double carried_in_past(const ExchangeSettings& settings, const Prediction& past,
                              const Vector3& velocity, double per_mass, int before) {
  const Vector3 load = settings.gravity + per_mass * past.forces->force[before];
  const double load_squared = load.squaredNorm();
  if (!(load_squared > 0)) return 0;
  const Vector3 change = velocity - past.velocity_before[before];
  return std::clamp(-(1 / past.length * change - load).dot(load) / load_squared, 0.0, 1.0);
}

}  // namespace fluxpact
