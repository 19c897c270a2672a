// YAML text -> Scene, strictly: every error at once, with file:line:column.
#pragma once

#include <string>
#include <vector>

#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Read and check a scene. `source` is the name for messages. `overrides` are `a.b.c=value` from
/// `--set`. Throws one ConfigError whose text lists every error, one a line: `source:line:column:
/// key.path: what was seen; what is allowed; nearest known key`.
Scene read_scene(const std::string& text, const std::string& source,
                 const std::vector<std::string>& overrides = {});

/// The resolved scene as YAML text, every default filled in. `read_scene(write_scene(s))` equals s
/// bit for bit.
std::string write_scene(const Scene& scene);

/// The reference of all keys as Markdown: key, type, unit, default, range, meaning.
std::string scene_reference();

}  // namespace fluxpact
