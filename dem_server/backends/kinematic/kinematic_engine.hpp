// Particles on rails: each keeps its velocity for ever (zero: a frozen bed), whatever acts on it.
#pragma once

#include <memory>

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Particles pass through each other and through walls' planes up to a radius; periodic sides wrap,
/// and those that let particles out are flown through.
/// Throws ConfigError for particles that are not sound (see checked_rows). Its `advance` throws
/// NumericsError that names the particle which leaves the domain; `rollback` presents the committed
/// state again.
std::unique_ptr<ParticleEngine> make_kinematic_engine(const Scene& scene, const Mesh& mesh,
                                                      ParticleState initial);

}  // namespace fluxpact
