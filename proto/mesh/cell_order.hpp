// The order of cells in memory: neighbours near each other. Used once, for meshes from files.
#pragma once

#include <optional>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// The mesh with its cells in reverse Cuthill-McKee order (Cuthill and McKee 1969, reversed as
/// George 1971) and its internal faces by cell, or nothing if that does not bring the two cells of
/// a face nearer by at least a factor of 2 on average. The distance decides whether the loops of a
/// solver wait for memory: on 1 million tetrahedra as Gmsh orders them, matrix times vector and a
/// loop over faces become 3 and 4 times faster; what blockMesh writes is left alone.
std::optional<MeshTopology> with_cells_in_better_order(const Mesh& mesh);

}  // namespace fluxpact
