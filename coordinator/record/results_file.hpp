// results.h5: its names, its format, and the mesh in it. Shared by those that write and read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "proto/io/hdf5.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Grows when a reader of older files would misread a new one.
inline constexpr std::int64_t results_format_version = 1;

inline constexpr auto results_file_name = "results.h5";

/// A new results.h5 with the attributes format_version, program, program_version and continuity.
Hdf5File create_results(const std::filesystem::path& path, const std::string& program_version,
                        Continuity continuity);

/// An existing one, to read. Throws SystemError if it is none of ours or of a newer format.
Hdf5File open_results(const std::filesystem::path& path);

/// Writes /mesh/*: topology, geometry, patches (/mesh/patches/{name,first,size}: first face and
/// number of faces of each), periodic faces, and the nodes of the lattice if there is one.
void write_mesh(Hdf5File& file, const Mesh& mesh);

/// "000007": group of the record number `index`, sorted by name as by number up to a million.
std::string record_name(std::size_t index);

}  // namespace fluxpact
