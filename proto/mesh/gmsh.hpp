// The mesh of a file of Gmsh.
#pragma once

#include <filesystem>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// The mesh in a file of the format MSH 4.1, ascii: tetrahedra, hexahedra, prisms and pyramids of
/// the first order, of all volumes. The boundary faces of a physical surface are the patch of its
/// name; those without one are the patch `walls`. Points are multiplied by `scale`. Points of the
/// geometry that no cell uses (a circle's centre) are left out. Throws ConfigError that names file
/// and line: another version, binary, a damaged file, an element of another type, a surface in two
/// physical groups, a face of a physical surface on no cell or between two.
MeshTopology read_gmsh(const std::filesystem::path& file, double scale);

}  // namespace fluxpact
