// A bed at rest: a loose random packing that the native engine lets settle before time 0.
//
// First with a soft, strongly damped contact and long steps, then with the scene's own contact and
// step, each time against a drag that takes the energy out, until the mean kinetic energy is below
// 1e-5 of what a particle gains by falling through its own diameter. The bed settles in its region
// alone: the sides of `within` are walls to it (or periodic), and the surfaces of the scene as
// drawn, at rest. In a mesh that is no box the boundary of the mesh holds it, and `within` can give
// its upper end only.
#pragma once

#include <string>

#include "dem_server/insertion/entry_sizes.hpp"
#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/read_particles.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

/// The bed of an entry of type settled, at rest. With `height` it is settled higher, and what
/// sticks out above the height is taken away; else all spheres are kept. Progress goes to the log,
/// and `alive` is called in every sub-step. Throws ConfigError if gravity does not point along an
/// axis, `within` cuts a mesh that is no box, or the loose packing does not fit in the domain above
/// the bottom of the box; NumericsError if the bed does not come to rest.
std::vector<ListedParticle> settled_bed(const Scene& scene, const std::string& entry,
                                        const InsertionSettings& settings, const PackingBox& box,
                                        const Domain& domain, const Mesh& mesh,
                                        const Progress& alive);

}  // namespace fluxpact
