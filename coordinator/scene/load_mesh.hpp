// The mesh that a scene asks for: made or read once, here, and sent to the participants.
#pragma once

#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// The mesh of a scene that load_scene has read, every patch with a condition in fluid.boundaries.
/// The cells of a file stand in another order if theirs is bad for memory (cell_order.hpp).
/// Throws ConfigError: the file is missing or damaged (file and line), the mesh is not sound (see
/// with_geometry), or patches and conditions do not fit, all of these at once.
Mesh load_mesh(const Scene& scene);

}  // namespace fluxpact
