// The checks and the order that every engine wants of the particles it is given.
#pragma once

#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

/// The same particles, ascending by id. Throws ConfigError that names the particle if an id stands
/// twice, a radius or density is not positive, a material is not among `materials`, or a number is
/// not finite; and if the arrays differ in length.
ParticleState checked_rows(ParticleState particles, int materials);

}  // namespace fluxpact
