// How servers are started: their program and its arguments.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "coordinator/session/command.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

std::string after(const std::vector<std::string>& words, const std::string& word) {
  const auto at = std::ranges::find(words, word);
  return at == words.end() || at + 1 == words.end() ? "" : *(at + 1);
}

TEST(ServerCommand, is_the_program_beside_ours_with_the_engine_of_the_scene) {
  Scene scene;
  scene.particles.backend = ParticleBackend::yade;
  const Command particles = server_command(scene, Role::particles, "ipc:///x", "info");
  EXPECT_EQ(particles.program.filename(), "dem_server");
  EXPECT_EQ(particles.program.parent_path(),
            std::filesystem::read_symlink("/proc/self/exe").parent_path());
  EXPECT_EQ(after(particles.arguments, "--connect"), "ipc:///x");
  EXPECT_EQ(after(particles.arguments, "--backend"), "yade");
  EXPECT_EQ(after(particles.arguments, "--with-parent"), std::to_string(getpid()));
  const Command fluid = server_command(scene, Role::fluid, "ipc:///x", "info");
  EXPECT_EQ(fluid.program.filename(), "cfd_server");
  EXPECT_EQ(after(fluid.arguments, "--backend"), "native");
}

TEST(ServerCommand, is_the_program_of_the_scene_for_an_engine_of_its_own) {
  Scene scene;
  scene.particles.backend = ParticleBackend::custom;
  scene.particles.program = "/opt/mine/server";
  EXPECT_EQ(server_command(scene, Role::particles, "ipc:///x", "info").program, "/opt/mine/server");
  EXPECT_EQ(server_command(scene, Role::fluid, "ipc:///x", "info").program.filename(),
            "cfd_server");
}

TEST(ServerCommand, goes_through_mpirun_for_several_ranks) {
  Scene scene;
  scene.particles.backend = ParticleBackend::lammps;
  scene.particles.ranks = 3;
  const Command command = server_command(scene, Role::particles, "ipc:///x", "info");
  EXPECT_EQ(command.program.filename(), "mpirun");
  EXPECT_EQ(after(command.arguments, "-np"), "3");
  EXPECT_EQ(std::filesystem::path(after(command.arguments, "3")).filename(), "dem_server");
  EXPECT_EQ(after(command.arguments, "--with-parent"), "any");
  EXPECT_EQ(server_command(scene, Role::fluid, "ipc:///x", "info").program.filename(),
            "cfd_server");

  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  EXPECT_THROW(server_command(scene, Role::particles, "ipc:///x", "info"), SystemError);
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace fluxpact
