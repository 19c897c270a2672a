// Where the particles of a scene start.
#pragma once

#include "dem_server/backends/particle_engine.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Materials in a fixed order (that of the scene's map); ParticleState::material indexes it.
std::vector<std::string> material_names(const ParticleSettings& settings);

/// All particles that scene.particles.insertion asks for, ids 1, 2, ... in order. Reproducible from
/// the seeds. `alive` is called now and then: a bed may take minutes to settle. Throws ConfigError
/// that names the entry, particle and place: outside the domain, overlapping another particle by
/// more than 10 % of the smaller diameter, no room for the count, an unreadable file (line);
/// NumericsError if a bed does not settle.
ParticleState insert_particles(const Scene& scene, const Mesh& mesh, const Progress& alive = {});

}  // namespace fluxpact
