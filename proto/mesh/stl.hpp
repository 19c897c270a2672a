// Surfaces from STL files.
#pragma once

#include <filesystem>

#include "proto/mesh/triangle_surface.hpp"

namespace fluxpact {

/// The triangles of an STL file, ascii or binary (told apart by the length that a binary file
/// announces), times `scale` [m per unit of the file]. The file's normals are not read: the order
/// of the corners says which side is out. Points nearer to each other than the file's single
/// precision can tell (1e-6 of the largest coordinate) become one, and triangles that this flattens
/// to an edge are dropped.
/// Throws ConfigError with file and line or triangle: missing, cut short, not a number, no
/// triangle at all, or a triangle whose corners lie on one line.
TriangleSurface read_stl(const std::filesystem::path& path, double scale);

}  // namespace fluxpact
