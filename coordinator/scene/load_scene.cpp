#include "coordinator/scene/load_scene.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include "proto/base/errors.hpp"
#include "proto/scene/read_scene.hpp"

namespace fluxpact {
namespace {

constexpr std::uintmax_t largest_file =
    1 << 20;  // [bytes] of a scene; a mistaken path may lead to gigabytes

void check_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw ConfigError("{}: no such file; give the path of a scene, e.g. configs/quickstart.yaml",
                      path.string());
  }
  if (error) {
    throw SystemError(
        "{}: the scene cannot be read: {}; check the rights of the file and its folders",
        path.string(), error.message());
  }
  if (std::filesystem::is_directory(status)) {
    throw ConfigError("{}: a directory; give the path of the scene file inside it", path.string());
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw ConfigError("{}: not a regular file; give the path of a scene file", path.string());
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > largest_file) {
    throw ConfigError("{}: {} bytes; a scene has at most {}: is this the right file?",
                      path.string(), size, largest_file);
  }
}

/// A relative path starts at the folder of the scene; absolute, it means the same in the recorded
/// scene.
void resolve_paths(Scene& scene, const std::filesystem::path& file) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  const auto resolve = [&](std::string& path) {
    path = (folder / path).lexically_normal().string();
  };
  if (scene.fluid.mesh.polymesh) resolve(scene.fluid.mesh.polymesh->path);
  if (scene.fluid.mesh.gmsh) resolve(scene.fluid.mesh.gmsh->path);
  if (!scene.particles.program.empty()) resolve(scene.particles.program);
  for (auto& [name, surface] : scene.particles.surfaces) {
    if (surface.type == SurfaceType::stl) resolve(surface.path);
  }
  for (InsertionSettings& entry : scene.particles.insertion) {
    if (entry.type == InsertionType::file) resolve(entry.path);
  }
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  check_file(path);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) {
    throw SystemError("{}: the scene cannot be read: {}; check the rights of the file",
                      path.string(), std::generic_category().message(errno));
  }
  Scene scene = read_scene(text, path.string(), overrides);
  resolve_paths(scene, path);
  return scene;
}

}  // namespace fluxpact
