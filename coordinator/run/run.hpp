// `coordinator run`: a scene from its file to its results.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/base/errors.hpp"

namespace fluxpact {

struct RunOptions {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< key.path=value
  std::optional<std::filesystem::path> directory;
  std::optional<double> until;  ///< [s] instead of scene.end_time
  bool quiet = false;
  std::string log_level = "info";
};

/// Returns `done` or `interrupted`; throws Error otherwise. Whatever was committed is on disk
/// either way.
ExitCode run_scene(const RunOptions& options);

}  // namespace fluxpact
