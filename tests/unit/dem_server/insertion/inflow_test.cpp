// Particles that come in: how many, where, and the same again after a rollback.
#include "dem_server/insertion/inflow.hpp"

#include <gtest/gtest.h>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

constexpr double window = 1e-3;

Scene open_box() {
  Scene scene;
  scene.coupling.window = window;
  scene.fluid.mesh.box = {Vector3::Zero(), {0.02, 0.02, 0.05}, {4, 4, 10}};
  scene.fluid.mesh.patches = {{"hole", {Side::z_max, {std::array{0.005, 0.015}, {}, {}}}}};
  scene.fluid.boundaries["hole"].type = BoundaryType::velocity;
  scene.fluid.boundaries["walls"].type = BoundaryType::wall;
  scene.particles.materials["glass"].density = 2500;
  InflowSettings inflow;
  inflow.patch = "hole";
  inflow.material = "glass";
  inflow.diameter = 1e-3;
  inflow.number_rate = 1234.5;
  inflow.velocity = {0, 0, -2};
  scene.particles.inflow.push_back(inflow);
  return scene;
}

Inflow make(const Scene& scene, std::int64_t first_id = 1) {
  return {scene, make_box(scene.fluid.mesh), first_id};
}

TEST(Inflow, brings_the_whole_number_that_is_due) {
  Inflow inflow = make(open_box(), 50);
  ParticleState entering;
  std::int64_t count = 0;
  for (int step = 1; step <= 200; ++step) {
    inflow.advance(step * window, {}, {}, entering);
    inflow.commit();
    count += entering.size();
    EXPECT_EQ(count, static_cast<std::int64_t>(std::floor(1234.5 * step * window + 1e-6)));
    EXPECT_EQ(entering.id.empty() ? 49 + count : entering.id.back(), 49 + count);
  }
  EXPECT_EQ(inflow.waiting(), 0);
}

TEST(Inflow, comes_in_behind_its_patch_alone_and_evenly) {
  Inflow inflow = make(open_box());
  ParticleState entering;
  double x = 0;
  double depth = 0;
  int count = 0;
  for (int step = 1; step <= 2000; ++step) {
    inflow.advance(step * window, {}, {}, entering);
    inflow.commit();
    for (int i = 0; i < entering.size(); ++i) {
      const Vector3& at = entering.position[i];
      EXPECT_GE(at.x(), 0.005);
      EXPECT_LE(at.x(), 0.015);
      EXPECT_GE(at.y(), 0.5e-3 * (1 - 1e-9));  // walls are not touched
      EXPECT_LE(at.y(), 0.02 - 0.5e-3 * (1 - 1e-9));
      EXPECT_LE(at.z(), 0.05 - 0.5e-3 * (1 - 1e-9));
      EXPECT_GE(at.z(), 0.05 - 0.5e-3 - 2 * window);
      EXPECT_EQ(entering.velocity[i], Vector3(0, 0, -2));
      x += at.x();
      depth += 0.05 - 0.5e-3 - at.z();
      ++count;
    }
  }
  // Uniform over 10 mm and 2 mm: the mean of 2469 scatters by 0.29 of the length over 50; five
  // times.
  ASSERT_EQ(count, 2469);
  EXPECT_NEAR(x / count, 0.01, 5 * 0.01 * 0.29 / 49);
  EXPECT_NEAR(depth / count, 1e-3, 5 * 2e-3 * 0.29 / 49);
}

TEST(Inflow, touches_nobody_and_waits_for_room) {
  Scene scene = open_box();
  scene.particles.inflow[0].number_rate = 1e6;  // 1000 in a window: a few fit
  Inflow inflow = make(scene);
  ParticleState present;
  ParticleState entering;
  for (int step = 1; step <= 3; ++step) {
    inflow.advance(step * window, present, {}, entering);
    inflow.commit();
    EXPECT_EQ(present.size() + entering.size() + inflow.waiting(), 1000 * step);
    for (int i = 0; i < entering.size(); ++i) {
      present.id.push_back(entering.id[i]);
      present.position.push_back(entering.position[i]);
      present.radius.push_back(entering.radius[i]);
    }
  }
  EXPECT_GT(present.size(), 100);
  for (int a = 0; a < present.size(); ++a) {
    for (int b = a + 1; b < present.size(); ++b) {
      ASSERT_GE((present.position[a] - present.position[b]).norm(), 1e-3 * (1 - 1e-12));
    }
  }
}

TEST(Inflow, gives_the_same_after_a_rollback) {
  Scene scene = open_box();
  scene.particles.inflow[0].diameter = 0;
  scene.particles.inflow[0].sizes.emplace();
  scene.particles.inflow[0].sizes->distribution = SizeDistribution::uniform;
  scene.particles.inflow[0].sizes->range = {0.5e-3, 1.5e-3};
  scene.particles.inflow[0].number_rate = 0;
  scene.particles.inflow[0].mass_rate = 5e-3;
  Inflow straight = make(scene);
  Inflow repeated = make(scene);
  ParticleState first;
  ParticleState again;
  int count = 0;
  for (int step = 1; step <= 20; ++step) {
    straight.advance(step * window, {}, {}, first);
    straight.commit();
    repeated.advance((step + 3) * window, {}, {}, again);  // an attempt that is given up
    repeated.rollback();
    repeated.advance(step * window, {}, {}, again);
    repeated.commit();
    EXPECT_EQ(first.id, again.id);
    EXPECT_EQ(first.position, again.position);
    EXPECT_EQ(first.radius, again.radius);
    count += first.size();
  }
  EXPECT_GT(count, 20);
}

TEST(Inflow, starts_and_stops) {
  Scene scene = open_box();
  scene.particles.inflow[0].number_rate = 1000;
  scene.particles.inflow[0].start = 0.01;
  scene.particles.inflow[0].stop = 0.02;
  Inflow inflow = make(scene);
  ParticleState entering;
  int count = 0;
  for (int step = 1; step <= 40; ++step) {
    inflow.advance(step * window, {}, {}, entering);
    inflow.commit();
    EXPECT_TRUE(step > 10 || entering.size() == 0);
    count += entering.size();
  }
  EXPECT_EQ(count, 10);
}

TEST(Inflow, refuses_a_place_that_is_none) {
  Scene scene = open_box();
  scene.particles.inflow[0].patch = "door";
  EXPECT_THROW(make(scene), ConfigError);
  scene.particles.inflow[0].patch.clear();
  scene.particles.inflow[0].within.emplace();
  scene.particles.inflow[0].within->z = {0.0495, 0.05};
  EXPECT_THROW(make(scene), ConfigError);  // half a diameter high
}

}  // namespace
}  // namespace fluxpact
