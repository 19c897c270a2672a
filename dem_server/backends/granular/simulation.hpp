// What LAMMPS and LIGGGHTS have in common for us: spheres are put in, moved, and taken out again,
// on one or several ranks of MPI. What lasts from window to window stands in our own arrays; the
// library holds nothing between two windows that is not loaded anew.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// What changes from sub-step to sub-step, one row a particle.
struct Motions {
  std::vector<Vector3> position;  ///< [m]
  std::vector<Vector3> velocity;  ///< [m/s]
  std::vector<Vector3> spin;      ///< [rad/s]
  /// Of gravity and contacts at the velocity half a sub-step before [N], [N m]: the next half kick
  /// takes them. Empty before the first window: the library then finds them.
  std::vector<Vector3> force;
  std::vector<Vector3> torque;
  /// What the library remembers of each particle's contacts, in its own form: rows
  /// offsets[row] .. offsets[row + 1]. Empty before the first window.
  std::vector<double> contacts;
  std::vector<std::int64_t> offsets;
};

inline std::span<const double> contacts_of(const Motions& motions, std::size_t row) {
  const auto first = static_cast<std::size_t>(motions.offsets[row]);
  return std::span(motions.contacts)
      .subspan(first, static_cast<std::size_t>(motions.offsets[row + 1]) - first);
}

/// What `save` writes of one particle: its row, position, velocity, spin, force and torque (with
/// those of the window), how many numbers of contacts follow; then these.
inline constexpr int saved_numbers = 17;

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Throws ConfigError for spheres that it was not made for.
  virtual void check(const ParticleState& spheres) const = 0;
  /// Takes these spheres in place of all it has. All ranks give the same rows; each keeps those in
  /// its part of space. `force` [N]: of the coming window, on each.
  virtual void load(const ParticleState& spheres, const Motions& motions,
                    std::span<const Vector3> force, double time_step) = 0;
  /// Sub-steps of the time step given to `load`.
  virtual void run(int steps) = 0;
  /// Appends the rows that this rank has (saved_numbers and contacts of each).
  virtual void save(const ParticleState& spheres, std::vector<double>& rows) const = 0;
  /// Whether this can be what `save` wrote of one particle's contacts.
  virtual bool fits(std::span<const double> contacts) const = 0;
  /// Of the list of neighbours, since `load`.
  virtual std::int64_t rebuilds() const = 0;
};

}  // namespace fluxpact
