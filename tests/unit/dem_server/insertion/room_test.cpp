// Insertion into vessels that are no boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/insertion/inflow.hpp"
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

/// The pipe of configs/meshes: radius 25 mm along z, in at z = 0.
struct Pipe {
  Scene scene;
  Mesh mesh =
      with_geometry(read_gmsh(std::string(FLUXPACT_SOURCE_DIR) + "/configs/meshes/pipe.msh", 1e-3));

  Pipe() {
    scene.particles.materials["glass"].density = 2500;
    scene.fluid.boundaries["outlet"].type = BoundaryType::pressure;
    scene.coupling.window = 1e-3;
  }
};

SizeSettings two_sizes(double small, double large) {
  SizeSettings sizes;
  sizes.distribution = SizeDistribution::table;
  sizes.table = {{small, 1}, {large, 1}};
  return sizes;
}

/// Least gap between spheres and the pipe [m].
double gap_to_pipe(const ParticleState& state) {
  double least = INFINITY;
  for (int i = 0; i < state.size(); ++i) {
    const Vector3& x = state.position[i];
    least = std::min(least, 0.025 - std::hypot(x.x(), x.y()) - state.radius[i]);
  }
  return least;
}

TEST(InsertionInRoom, packing_of_two_sizes_lies_in_the_pipe_each_by_its_own_radius) {
  Pipe pipe;
  // So few that hardly any touch: nobody but the wall pushes the large ones inwards.
  for (const int count : {12, 120}) {
    InsertionSettings packing = entry(InsertionType::packing, 0, count);
    packing.sizes = two_sizes(4e-3, 14e-3);
    pipe.scene.particles.insertion = {packing};
    const ParticleState state = insert_particles(pipe.scene, pipe.mesh);
    ASSERT_EQ(state.size(), count);
    EXPECT_EQ(*std::max_element(state.radius.begin(), state.radius.end()), 7e-3);
    // `packing_overlap` of the larger diameter.
    EXPECT_GE(gap_to_pipe(state), -1e-3 * 14e-3) << count;
  }
}

TEST(InsertionInRoom, large_spheres_start_where_they_fit) {
  // A tube in the drum: small ones fit into it, but no push gets a large one out through its wall.
  Scene scene = drum_scene();
  SurfaceSettings tube = scene.particles.surfaces.front().second;
  tube.radius = 2.4e-3;
  tube.side = SurfaceSide::both;
  scene.particles.surfaces.emplace_back("tube", tube);
  scene.particles.insertion.push_back(entry(InsertionType::packing, 0, 200));
  scene.particles.insertion.back().sizes = two_sizes(1e-3, 5e-3);
  scene.particles.insertion.back().sizes->table = {{1e-3, 9}, {5e-3, 1}};
  const ParticleState state = insert_particles(scene, make_box(scene.fluid.mesh));
  ASSERT_EQ(state.size(), 200);
  int small_in_tube = 0;
  for (int i = 0; i < state.size(); ++i) {
    const double from_axis = std::hypot(state.position[i].x(), state.position[i].y());
    if (state.radius[i] < 1e-3) {
      small_in_tube += from_axis < 2.4e-3 ? 1 : 0;
    } else {
      // `packing_overlap` of the diameter.
      EXPECT_GE(from_axis, 2.4e-3 + (0.5 - 1e-3) * 5e-3) << i;
    }
  }
  EXPECT_GT(small_in_tube, 0);
}

TEST(InsertionInRoom, sphere_that_sticks_into_a_wall_is_relaxed_out_of_it) {
  const std::string path = ::testing::TempDir() + "fluxpact_relax_test.csv";
  std::ofstream(path) << "x,y,z\n0.009,0,0.01\n";  // 1 mm of its 4 mm are out
  Scene scene = drum_scene();
  scene.particles.insertion.push_back(entry(InsertionType::file, 4e-3));
  scene.particles.insertion.back().path = path;
  EXPECT_THROW(insert_particles(scene, make_box(scene.fluid.mesh)), ConfigError);
  scene.particles.overlaps = Overlaps::relax;
  const ParticleState state = insert_particles(scene, make_box(scene.fluid.mesh));
  EXPECT_NEAR(state.position[0].x(), 0.008, 0.01 * 4e-3);  // 1 % may be left
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

void add_law(Scene& scene) {
  for (const char* other : {"glass", "walls"}) {
    PairSettings pair;
    pair.between = {"glass", other};
    pair.normal_stiffness = 1000;
    pair.restitution = 0.5;
    pair.friction = 0.3;
    scene.particles.contact.pairs.push_back(pair);
  }
  scene.scene.gravity = {0, 0, -9.81};
  scene.coupling.window = 1e-3;
  scene.particles.time_step = 5e-5;
}

double highest(const ParticleState& state) {
  double top = 0;
  for (int i = 0; i < state.size(); ++i) {
    top = std::max(top, state.position[i].z() + state.radius[i]);
  }
  return top;
}

TEST(InsertionInRoom, bed_settles_in_the_pipe_of_a_mesh_and_stays_there) {
  Pipe pipe;
  add_law(pipe.scene);
  pipe.scene.particles.insertion.push_back(entry(InsertionType::settled, 6e-3, 200));
  const ParticleState bed = insert_particles(pipe.scene, pipe.mesh);
  ASSERT_EQ(bed.size(), 200);
  // 200 of 113 mm³ on 1963 mm² are 11.5 mm of solid, between 0.4 and 0.64 in a pipe of 8 diameters.
  EXPECT_GT(highest(bed), 11.5e-3 / 0.64);
  EXPECT_LT(highest(bed), 11.5e-3 / 0.4 + 6e-3);
  for (const Vector3& x : bed.position) {
    EXPECT_LE(std::hypot(x.x(), x.y()), 0.025 - 0.003 + 0.01 * 6e-3);
    EXPECT_GE(x.z(), 0.003 - 0.01 * 6e-3);
  }
  // In the run it stays, but for a sphere at the top that lay so that the springs of friction held
  // it, which begin anew: such a one may roll into the next hollow.
  const auto engine = make_native_engine(pipe.scene, pipe.mesh, bed);
  const std::vector<Vector3> none(bed.id.size(), Vector3::Zero());
  for (int window = 0; window < 50; ++window) {
    engine->advance(1e-3, 20, none, {});
    engine->commit();
  }
  double sunk = 0;
  for (int i = 0; i < bed.size(); ++i) {
    const Vector3 moved = engine->particles().position[i] - bed.position[i];
    EXPECT_LT(moved.norm(), 0.5 * 6e-3);
    sunk += std::abs(moved.z()) / bed.size();
  }
  EXPECT_LT(sunk, 0.01 * 6e-3);
}

TEST(InsertionInRoom, bed_of_a_height_is_cut_in_a_mesh_and_within_may_not_cut_the_mesh) {
  Pipe pipe;
  add_law(pipe.scene);
  pipe.scene.particles.insertion.push_back(entry(InsertionType::settled, 6e-3, 0));
  InsertionSettings& bed = pipe.scene.particles.insertion.back();
  bed.height = 0.03;
  const ParticleState state = insert_particles(pipe.scene, pipe.mesh);
  EXPECT_LE(highest(state), 0.03);
  EXPECT_GT(highest(state), 0.03 - 3e-3);
  bed.within.x = {0.0, 0.025};
  try {
    insert_particles(pipe.scene, pipe.mesh);
    ADD_FAILURE() << "no error was thrown";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("ends at x = 0 m inside a mesh"), std::string::npos)
        << error.what();
  }
}

/// What comes in within 0.2 s.
ParticleState all_of(Inflow& inflow) {
  ParticleState all;
  ParticleState entering;
  for (int step = 1; step <= 200; ++step) {
    inflow.advance(1e-3 * step, {}, {}, entering);
    inflow.commit();
    all.position.insert(all.position.end(), entering.position.begin(), entering.position.end());
    all.radius.insert(all.radius.end(), entering.radius.begin(), entering.radius.end());
    all.id.insert(all.id.end(), entering.id.begin(), entering.id.end());
  }
  return all;
}

TEST(InflowInRoom, comes_into_the_pipe_clear_of_its_wall) {
  for (const bool patch : {true, false}) {
    Pipe pipe;
    InflowSettings inflow;
    if (patch) {
      inflow.patch = "inlet";
    } else {
      inflow.within.emplace();
      inflow.within->z = {0.0, 0.05};
    }
    inflow.material = "glass";
    inflow.sizes = two_sizes(2e-3, 10e-3);
    inflow.number_rate = 5000;
    inflow.velocity = {0, 0, 1};
    pipe.scene.particles.inflow.push_back(inflow);
    Inflow source(pipe.scene, pipe.mesh, 1);
    const ParticleState all = all_of(source);
    EXPECT_EQ(all.size(), 1000);
    // The facets of the mesh are within the circle; round-off of `Room::fits` beside it.
    EXPECT_GE(gap_to_pipe(all), -1e-9 * 10e-3) << patch;
    EXPECT_LE(gap_to_pipe(all), 1e-3) << "they come in at the wall, too";
  }
}

TEST(InflowInRoom, keeps_clear_of_a_wall_that_moves_where_it_is_by_then) {
  Scene scene = drum_scene();
  scene.coupling.window = 1e-3;
  SurfaceSettings piston;
  piston.normal = {0, 0, 1};
  piston.motion.type = MotionType::translation;
  piston.motion.velocity = {0, 0, 0.1};
  scene.particles.surfaces = {{"piston", piston}};
  InflowSettings inflow;
  inflow.within.emplace();
  inflow.material = "glass";
  inflow.diameter = 2e-3;
  inflow.number_rate = 5000;
  scene.particles.inflow.push_back(inflow);
  Inflow source(scene, make_box(scene.fluid.mesh), 1);
  ParticleState entering;
  double lowest_gap = INFINITY;
  for (int step = 1; step <= 200; ++step) {
    source.advance(1e-3 * step, {}, {}, entering);
    source.commit();
    for (const Vector3& x : entering.position) {
      lowest_gap = std::min(lowest_gap, x.z() - 1e-3 - 0.1e-3 * step);
    }
  }
  EXPECT_GE(lowest_gap, -1e-9 * 1e-3);
  EXPECT_LE(lowest_gap, 1e-3);
}

}  // namespace
}  // namespace fluxpact
