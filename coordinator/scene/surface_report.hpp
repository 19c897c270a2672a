// What the user is told about the surfaces of particles that come from files.
#pragma once

#include <string>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// One line for each surface of type stl, in the order of the scene: triangles, extent, open and
/// crowded edges, the smallest triangle. Reads the files. Throws ConfigError as read_stl does, and
/// if a surface with a `side` is not closed.
std::vector<std::string> surface_lines(const Scene& scene);

}  // namespace fluxpact
