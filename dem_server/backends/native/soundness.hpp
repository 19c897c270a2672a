// What a particle must be for the engine to go on, and the errors that say what is wrong.
#pragma once

#include "dem_server/backends/domain.hpp"
#include "proto/base/vector.hpp"

namespace fluxpact {

/// One particle at one time.
struct Motion {
  Vector3 position;  ///< [m]
  Vector3 velocity;  ///< [m/s]
  double radius;     ///< [m]
};

/// For messages.
struct SubStep {
  double time_step;  ///< [s]
  int number, of;
};

/// Finite, inside, and not so fast that it moves by more than its radius in `time_step` [s] (0: as
/// fast as it likes): it could then pass through what it should touch.
bool is_sound_after_all(const Domain& domain, const Motion& motion, double time_step);
/// The same, soon told of those whose centres are well inside, as most are.
inline bool is_sound(const Domain& domain, const Motion& motion, double time_step) {
  const Vector3& x = motion.position;
  // (No comparison holds for what is not finite. The 0.99 is for rounding.)
  const bool inside = (x.array() > domain.lower.array()).all() &&
                      (x.array() < domain.upper.array()).all() &&
                      motion.velocity.squaredNorm() * (time_step * time_step) <
                          0.99 * motion.radius * motion.radius;
  return inside || is_sound_after_all(domain, motion, time_step);
}

/// Throws the NumericsError of a particle that is not sound.
[[noreturn]] void refuse(const Domain& domain, std::int64_t id, const Motion& motion,
                         const SubStep& sub_step);

/// Throws the NumericsError of a particle that a surface does not hold any more.
[[noreturn]] void refuse_lost_in_surface(std::int64_t id);

/// Throws the NumericsError of a force that is not finite.
[[noreturn]] void refuse_force(std::int64_t id, const Vector3& force);

/// Throws ConfigError if a particle could meet its own image: a period shorter than `shortest` [m].
void check_periods(const Domain& domain, double largest_diameter, double shortest);

}  // namespace fluxpact
