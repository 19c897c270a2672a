// Insertion into vessels that are no boxes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "dem_server/insertion/insertion.hpp"
#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/mesh/gmsh.hpp"

namespace fluxpact {
namespace {

InsertionSettings entry(InsertionType type, double diameter, int count = 0) {
  InsertionSettings settings;
  settings.type = type;
  settings.material = "glass";
  settings.diameter = diameter;
  settings.count = count;
  return settings;
}

/// A standing drum in a box: radius 10 mm, the box 24 mm wide and 30 mm high.
Scene drum_scene() {
  Scene scene;
  scene.fluid.mesh.box = {{-0.012, -0.012, 0}, {0.012, 0.012, 0.03}, {2, 2, 2}};
  scene.particles.materials["glass"].density = 2500;
  SurfaceSettings drum;
  drum.type = SurfaceType::cylinder;
  drum.direction = {0, 0, 1};
  drum.radius = 0.01;
  drum.side = SurfaceSide::inside;
  scene.particles.surfaces.emplace_back("drum", drum);
  return scene;
}

TEST(InsertionInRoom, packing_fills_a_drum_without_overlap_of_its_wall) {
  Scene scene = drum_scene();
  constexpr double diameter = 2e-3;
  constexpr int count = 900;  // 0.4 of the drum
  scene.particles.insertion.push_back(entry(InsertionType::packing, diameter, count));
  const ParticleState state = insert_particles(scene, make_box(scene.fluid.mesh));
  ASSERT_EQ(state.size(), count);
  double outermost = 0;
  for (const Vector3& x : state.position) outermost = std::max(outermost, std::hypot(x.x(), x.y()));
  // `packing_overlap` of a diameter, 1e-3.
  EXPECT_LE(outermost, 0.01 - 0.5 * diameter + 1e-3 * diameter);
  EXPECT_GT(outermost, 0.01 - 0.6 * diameter) << "spheres lie at the wall, too";
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < a; ++b) {
      ASSERT_GE((state.position[a] - state.position[b]).norm(), (1 - 1e-3) * diameter);
    }
  }
}

TEST(InsertionInRoom, packing_that_does_not_fit_into_the_drum_says_how_many_do) {
  Scene scene = drum_scene();
  // They would fit into the box: 0.48 of it, but 0.88 of the drum.
  scene.particles.insertion.push_back(entry(InsertionType::packing, 8e-3, 31));
  try {
    insert_particles(scene, make_box(scene.fluid.mesh));
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("between the walls in it"), std::string::npos) << text;
    EXPECT_NE(text.find("entry 1"), std::string::npos) << text;
  }
}

TEST(InsertionInRoom, lattice_leaves_out_what_the_wall_cuts) {
  Scene scene = drum_scene();
  constexpr double diameter = 2e-3;
  scene.particles.insertion.push_back(entry(InsertionType::lattice, diameter));
  const ParticleState in_drum = insert_particles(scene, make_box(scene.fluid.mesh));
  scene.particles.surfaces.clear();
  const ParticleState in_box = insert_particles(scene, make_box(scene.fluid.mesh));
  int inside = 0;
  for (const Vector3& x : in_box.position) {
    inside += std::hypot(x.x(), x.y()) <= 0.01 - 0.5 * diameter ? 1 : 0;
  }
  EXPECT_EQ(in_drum.size(), inside);
  EXPECT_GT(inside, 0);
  EXPECT_LT(inside, in_box.size());
}

TEST(InsertionInRoom, particle_of_a_file_behind_a_wall_is_refused_by_the_name_of_the_wall) {
  const std::string path = ::testing::TempDir() + "fluxpact_room_test.csv";
  std::ofstream(path) << "x,y,z\n0,0,0.01\n0.0115,0,0.01\n";
  Scene scene = drum_scene();
  scene.particles.insertion.push_back(entry(InsertionType::file, 1e-3));
  scene.particles.insertion.back().path = path;
  try {
    insert_particles(scene, make_box(scene.fluid.mesh));
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("particle 2"), std::string::npos) << text;
    EXPECT_NE(text.find("is behind the wall `drum` by 0.0015 m"), std::string::npos) << text;
  }
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

TEST(InsertionInRoom, packing_lies_in_the_pipe_of_a_mesh_from_a_file) {
  Scene scene = drum_scene();
  scene.particles.surfaces.clear();
  scene.fluid.boundaries["outlet"].type = BoundaryType::pressure;
  const Mesh mesh =
      with_geometry(read_gmsh(std::string(FLUXPACT_SOURCE_DIR) + "/configs/meshes/pipe.msh", 1e-3));
  scene.particles.insertion.push_back(entry(InsertionType::packing, 6e-3, 500));
  scene.particles.insertion.back().within.z = {0.0, 0.1};
  const ParticleState state = insert_particles(scene, mesh);
  ASSERT_EQ(state.size(), 500);
  for (const Vector3& x : state.position) {
    EXPECT_LE(std::hypot(x.x(), x.y()), 0.025 - 0.003 + 1e-3 * 6e-3);
    EXPECT_GE(x.z(), 0.003 * (1 - 1e-9));
    EXPECT_LE(x.z(), 0.1 - 0.003 * (1 - 1e-9));
  }
}

}  // namespace
}  // namespace fluxpact
