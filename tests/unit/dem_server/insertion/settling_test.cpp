// Beds that settle before time 0.
#include "dem_server/insertion/settling.hpp"

#include <gtest/gtest.h>

#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/insertion/insertion.hpp"
#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

/// 12 mm wide, 40 mm high, for spheres of 2 mm.
Scene column() {
  Scene scene;
  scene.scene.gravity = {0, 0, -9.81};
  scene.coupling.window = 2e-4;
  scene.fluid.mesh.box = {Vector3::Zero(), {0.012, 0.012, 0.04}, {2, 2, 4}};
  scene.fluid.mesh.patches = {{"top", {Side::z_max, {}}}};
  scene.fluid.boundaries["top"].type = BoundaryType::pressure;
  scene.fluid.boundaries["walls"].type = BoundaryType::wall;
  scene.particles.time_step = 2e-5;
  scene.particles.materials["glass"].density = 2500;
  scene.particles.numerics.threads = 1;
  for (const char* other : {"glass", "walls"}) {
    PairSettings pair;
    pair.between = {"glass", other};
    pair.normal_stiffness = 500;
    scene.particles.contact.pairs.push_back(pair);
  }
  InsertionSettings entry;
  entry.type = InsertionType::settled;
  entry.material = "glass";
  entry.diameter = 2e-3;
  scene.particles.insertion.push_back(entry);
  return scene;
}

ParticleState insert(const Scene& scene) {
  return insert_particles(scene, make_box(scene.fluid.mesh));
}

double top(const ParticleState& state) {
  double highest = 0;
  for (int i = 0; i < state.size(); ++i) {
    highest = std::max(highest, state.position[i].z() + state.radius[i]);
  }
  return highest;
}

TEST(Settled, bed_has_the_count_and_stays_where_it_is) {
  Scene scene = column();
  scene.particles.insertion[0].count = 300;
  const ParticleState bed = insert(scene);
  ASSERT_EQ(bed.size(), 300);
  // 300 of 4.19 mm³ on 144 mm² are 8.7 mm of solid: fractions of 0.5 to 0.62 between walls 6
  // diameters apart, where a layer more or less at the top counts.
  EXPECT_GT(top(bed), 8.7e-3 / 0.64);
  EXPECT_LT(top(bed), 8.7e-3 / 0.45);
  const auto engine = make_native_engine(scene, make_box(scene.fluid.mesh), bed);
  for (int window = 0; window < 250; ++window) {  // 50 ms
    engine->advance(2e-4, 10, std::vector<Vector3>(300, Vector3::Zero()), {});
    engine->commit();
  }
  // Springs across begin at zero, so it creeps a little: a twentieth of a diameter on the mean.
  double moved = 0;
  for (int i = 0; i < 300; ++i) {
    moved += (engine->particles().position[i] - bed.position[i]).norm() / 300;
  }
  EXPECT_LT(moved, 0.05 * 2e-3);
}

TEST(Settled, bed_of_a_height_is_cut_there) {
  Scene scene = column();
  scene.particles.insertion[0].height = 0.015;
  const ParticleState bed = insert(scene);
  EXPECT_LE(top(bed), 0.015);
  EXPECT_GT(top(bed), 0.015 - 2e-3);  // less than a layer is missing
  for (const Vector3& velocity : bed.velocity) EXPECT_EQ(velocity, Vector3::Zero());
}

TEST(Settled, bed_is_the_same_for_the_same_seed_and_any_threads) {
  Scene scene = column();
  scene.particles.insertion[0].count = 100;
  const ParticleState first = insert(scene);
  scene.particles.numerics.threads = 2;
  EXPECT_EQ(first.position, insert(scene).position);
  scene.particles.insertion[0].seed = 9;
  EXPECT_NE(first.position, insert(scene).position);
}

TEST(Settled, calls_alive_and_refuses_what_cannot_settle) {
  Scene scene = column();
  scene.particles.insertion[0].count = 20;
  int calls = 0;
  insert_particles(scene, make_box(scene.fluid.mesh), [&] { ++calls; });
  EXPECT_GT(calls, 100);
  scene.scene.gravity = {3, 0, -9.81};
  EXPECT_THROW(insert(scene), ConfigError);
  scene = column();
  scene.particles.insertion[0].count = 900;  // more than the domain holds loosely
  EXPECT_THROW(insert(scene), ConfigError);
}

}  // namespace
}  // namespace fluxpact
