// The mesh of an OpenFOAM case: a folder `polyMesh`.
#pragma once

#include <filesystem>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// The mesh in the files points, faces, owner, neighbour and boundary of a folder, in ascii; lists
/// with or without their length, `faceList` or `faceCompactList`. Points are multiplied by `scale`.
/// Patches of the type `cyclic` are joined to internal faces, each with its `neighbourPatch`; those
/// without a face are left out; of all other types only the name matters. Throws ConfigError that
/// names file and line: a file is missing, compressed, binary or damaged, or a patch couples in a
/// way that is not supported (AMI, processor, rotations).
MeshTopology read_polymesh(const std::filesystem::path& folder, double scale);

}  // namespace fluxpact
