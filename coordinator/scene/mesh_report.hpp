// What the user is told about a mesh before anything runs on it.
#pragma once

#include <string>

#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Size, patches and quality as a table; then warnings and notes, one a line: what `check` prints.
std::string mesh_report(const Scene& scene, const Mesh& mesh);

/// The size and the worst numbers in one line, for the log.
std::string mesh_line(const Scene& scene, const Mesh& mesh);

}  // namespace fluxpact
