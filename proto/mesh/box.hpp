// A box of hexahedra as a face-based mesh.
#pragma once

#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// The mesh of a box: named patches by side and range, what is not named goes to the patch `walls`,
/// periodic pairs of sides become internal faces. A face belongs to the first patch whose range
/// holds its centre. Throws ConfigError if a patch has no face.
Mesh make_box(const MeshSettings& settings);

}  // namespace fluxpact
