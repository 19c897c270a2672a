#include "coordinator/scene/load_mesh.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/mesh/cell_order.hpp"
#include "proto/mesh/gmsh.hpp"
#include "proto/mesh/periodic_patches.hpp"
#include "proto/mesh/polymesh.hpp"
#include "proto/scene/findings.hpp"
#include "proto/scene/read_value.hpp"

namespace fluxpact {
namespace {

void check_path(const std::string& key, const std::filesystem::path& path, bool folder) {
  if (!std::filesystem::exists(path)) {
    throw ConfigError("{}.path: {}: no such {}; a relative path starts at the scene's folder", key,
                      path.string(), folder ? "folder" : "file");
  }
  if (std::filesystem::is_directory(path) != folder) {
    throw ConfigError("{}.path: {} is {}; {} is expected", key, path.string(),
                      folder ? "no folder" : "a folder",
                      folder ? "a folder polyMesh" : "a file of Gmsh (.msh)");
  }
}

Mesh read_mesh(const MeshFileSettings& file, bool polymesh) {
  const std::string key = polymesh ? "fluid.mesh.polymesh" : "fluid.mesh.gmsh";
  check_path(key, file.path, polymesh);
  try {
    MeshTopology mesh =
        polymesh ? read_polymesh(file.path, file.scale) : read_gmsh(file.path, file.scale);
    constexpr double tolerance = 1e-4;  // of a face's size: files may carry few digits
    for (const JoinSettings& pair : file.periodic) {
      mesh = join_periodic(std::move(mesh), pair.patches[0], pair.patches[1], tolerance);
    }
    Mesh sound = with_geometry(std::move(mesh));  // faults have the numbers of the file
    auto better = with_cells_in_better_order(sound);
    return better ? with_geometry(std::move(*better)) : sound;
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    if (!text.starts_with("mesh: ")) throw;  // the readers name file and line themselves
    throw ConfigError("{}: {}", file.path, text);
  }
}

/// The server takes `walls` without a condition for walls; from a file every patch must be meant.
void check_conditions(const Scene& scene, const Mesh& mesh) {
  std::vector<std::string> patches;
  std::string wrong;
  const auto add = [&](const std::string& text) { wrong += (wrong.empty() ? "" : "\n") + text; };
  for (const Patch& patch : mesh.patches) {
    patches.push_back(patch.name);
    if (scene.fluid.boundaries.contains(patch.name)) continue;
    if (!is_name(patch.name)) {
      add(fmt::format(
          "fluid.mesh: the patch `{}` of the file cannot be named in a scene; rename it "
          "there: a letter or _, then letters, digits, _ and -",
          shown(patch.name)));
      continue;
    }
    add(fmt::format("fluid.boundaries.{}: missing; required: the mesh has this patch, {} faces",
                    patch.name, patch.size));
  }
  for (const auto& [name, condition] : scene.fluid.boundaries) {
    if (mesh.find_patch(name) != nullptr) continue;
    add(fmt::format("fluid.boundaries.{}: no such patch in the mesh{}; patches: {}", name,
                    nearest_hint(name, patches), patches.empty() ? "none" : joined(patches)));
  }
  if (!wrong.empty()) throw ConfigError("{}", wrong);
}

}  // namespace

Mesh load_mesh(const Scene& scene) {
  const MeshSettings& settings = scene.fluid.mesh;
  if (settings.is_box()) return make_box(settings);
  Mesh mesh =
      settings.polymesh ? read_mesh(*settings.polymesh, true) : read_mesh(*settings.gmsh, false);
  check_conditions(scene, mesh);
  return mesh;
}

}  // namespace fluxpact
