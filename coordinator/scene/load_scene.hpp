// The scene file of the command line -> a checked scene: the first thing every command of the
// coordinator does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Read and check the scene in a file; `overrides` are the `key.path=value` of `--set`. Paths of
/// meshes, particles and programs become absolute.
/// Throws ConfigError: no such file, a directory, larger than 1 MiB, or anything wrong in the scene
/// (all of it at once). Throws SystemError if the file is there but cannot be read.
Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

}  // namespace fluxpact
