#include "coordinator/scene/load_scene.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// A folder for one test, gone afterwards.
class LoadScene : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::temp_directory_path() /
        (std::string("fluxpact_load_scene_") + test->name() + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& text) const {
    std::ofstream(folder_ / "scene.yaml", std::ios::binary) << text;
    return folder_ / "scene.yaml";
  }

  std::filesystem::path folder_;
};

template <class Error>
std::string message_of(const std::filesystem::path& path) {
  try {
    load_scene(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "no such error";
}

TEST_F(LoadScene, reads_a_file_and_the_overrides) {
  const auto path = std::filesystem::path(FLUXPACT_SOURCE_DIR) / "configs/quickstart.yaml";
  EXPECT_EQ(load_scene(path, {"scene.name=other"}).scene.name, "other");
}

TEST_F(LoadScene, names_the_file_in_every_error_of_the_scene) {
  const auto path = write("version: 1\nnonsense: 1\n");
  EXPECT_NE(message_of<ConfigError>(path).find(path.string() + ":2:1: nonsense: unknown key"),
            std::string::npos);
}

TEST_F(LoadScene, paths_start_at_the_folder_of_the_scene_and_become_absolute) {
  const std::string text =
      "version: 1\n"
      "scene: {name: paths, end_time: 1}\n"
      "coupling: {window: 1}\n"
      "fluid: {density: 1, viscosity: 1, mesh: {gmsh: {path: PATH}}}\n"
      "particles:\n"
      "  backend: kinematic\n"
      "  materials: {glass: {density: 1}}\n"
      "  insertion: [{type: file, material: glass, diameter: 1, path: bed.csv}]\n";
  const auto load = [&](const std::string& path) {
    std::string with_path = text;
    return load_scene(write(with_path.replace(text.find("PATH"), 4, path)));
  };
  const Scene scene = load("meshes/../pipe.msh");
  EXPECT_EQ(scene.fluid.mesh.gmsh->path, (folder_ / "pipe.msh").string());
  EXPECT_EQ(scene.particles.insertion[0].path, (folder_ / "bed.csv").string());
  EXPECT_EQ(load("/elsewhere/pipe.msh").fluid.mesh.gmsh->path, "/elsewhere/pipe.msh");
}

TEST_F(LoadScene, says_what_is_wrong_with_the_path) {
  EXPECT_NE(message_of<ConfigError>(folder_ / "none.yaml").find("none.yaml: no such file"),
            std::string::npos);
  EXPECT_NE(message_of<ConfigError>(folder_).find(": a directory"), std::string::npos);
  EXPECT_NE(message_of<ConfigError>("/dev/null").find("not a regular file"), std::string::npos);
  EXPECT_NE(message_of<ConfigError>(write(std::string((1 << 20) + 1, '#'))).find("1048577 bytes"),
            std::string::npos);
}

TEST_F(LoadScene, cannot_read_what_the_system_refuses) {
  const auto path = write("version: 1\n");
  std::filesystem::permissions(path, std::filesystem::perms::none);
  if (::access(path.c_str(), R_OK) == 0) {
    // The superuser reads everything; a name that no file system takes is refused for everybody.
    EXPECT_NE(message_of<SystemError>(folder_ / std::string(5000, 'x')).find("cannot be read"),
              std::string::npos);
  } else {
    EXPECT_NE(message_of<SystemError>(path).find("cannot be read"), std::string::npos);
  }
}

}  // namespace
}  // namespace fluxpact
