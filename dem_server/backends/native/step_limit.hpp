// The longest sub-step that resolves the contacts of given particles. Asked when the engine is
// made, and with Hertz' law, whose contacts are the shorter the faster they meet, before every
// window.
#pragma once

#include <span>
#include <string>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// The walls of one material.
struct WallsPresent {
  int material = 0;
  double speed = 0;  ///< [m/s] of the fastest of them
};

struct StepLimit {
  double longest = 0;  ///< [s]; infinite where nothing can touch
  std::string reason;  ///< what sets it, e.g. "a tenth of the contact time of [glass, walls], 2 ms"
};

/// Over all pairs that can meet (`walls`: those there are, of the walls' own material or of others)
/// the smallest of
///  - linear: a tenth of the contact time π sqrt(m*/k). Undamped, hence never longer than the
///  damped
///    one; k is the larger of k_n and what the spin feels: with friction 7/2 k_t (the tangential
///    spring of two rolling spheres), with a rolling spring 5/2 of its stiffness over R*² more.
///  - hertz: a fifth of Rayleigh's time π r sqrt(ρ/G) / (0.1631 ν + 0.8766), which bears overlaps
///  of
///    a tenth of R* with ten steps an oscillation of the contact (Thornton & Randall 1988); and a
///    tenth of the contact time 2.868 (m*²/(R* E*² v))^(1/5) (Johnson, Contact Mechanics, 1985,
///    eq. 11.24) at the largest speed v at which the two can meet, that is the sum of the
///    fastest of both materials, or of particle and wall, shortened as above by the tangential and
///    rolling springs.
/// The particles of one material must have one density. Throws ConfigError that names a pair that
/// can meet but has no law, or whose attraction by `sjkr` is stiffer than its linear spring.
StepLimit step_limit(const ContactLaws& laws, const ParticleState& particles,
                     std::span<const WallsPresent> walls);

/// Throws ConfigError with the limit, the contact that sets it and a value that passes if
/// `time_step` [s] is longer.
void check_time_step(const StepLimit& limit, double time_step);

}  // namespace fluxpact
