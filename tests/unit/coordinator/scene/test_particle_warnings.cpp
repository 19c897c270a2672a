// What `check` and `run` say of a scene that leaves out what its numbers ask for.
#include <gtest/gtest.h>

#include "coordinator/scene/particle_report.hpp"

namespace fluxpact {
namespace {

/// Sand of 2500 kg/m³ in a fluid.
Scene scene_in(double fluid_density) {
  Scene scene;
  scene.fluid.density = fluid_density;
  scene.particles.materials["sand"].density = 2500;
  InsertionSettings entry;
  entry.material = "sand";
  scene.particles.insertion = {entry};
  return scene;
}

TEST(ParticleWarnings, name_the_key_that_a_liquid_asks_for) {
  const std::vector<std::string> texts = particle_warnings(scene_in(1000));
  ASSERT_EQ(texts.size(), 1U);
  for (const char* part : {"interphase.forces", "added_mass", "'sand'", "2.5 times", "20 %"}) {
    EXPECT_NE(texts.front().find(part), std::string::npos) << part << " in " << texts.front();
  }
}

TEST(ParticleWarnings, are_silent_where_nothing_is_missing) {
  EXPECT_TRUE(particle_warnings(scene_in(1.2)).empty());
  EXPECT_TRUE(particle_warnings(scene_in(250)).empty());  // ten times as dense: 5 %
  EXPECT_EQ(particle_warnings(scene_in(251)).size(), 1U);
  Scene complete = scene_in(1000);
  complete.interphase.forces.push_back(InterphaseForce::added_mass);
  EXPECT_TRUE(particle_warnings(complete).empty());
  Scene fixed = scene_in(1000);
  fixed.particles.insertion.front().motion = Mobility::fixed;
  EXPECT_TRUE(particle_warnings(fixed).empty());
  Scene kinematic = scene_in(1000);
  kinematic.particles.backend = ParticleBackend::kinematic;
  EXPECT_TRUE(particle_warnings(kinematic).empty());
  Scene empty = scene_in(1000);
  empty.particles.insertion.clear();
  EXPECT_TRUE(particle_warnings(empty).empty());
}

TEST(ParticleWarnings, are_of_the_lightest_that_may_move) {
  Scene scene = scene_in(1000);
  scene.particles.materials["cork"].density = 200;
  InflowSettings inflow;
  inflow.material = "cork";
  scene.particles.inflow = {inflow};
  ASSERT_EQ(particle_warnings(scene).size(), 1U);
  EXPECT_NE(particle_warnings(scene).front().find("'cork'"), std::string::npos);
}

}  // namespace
}  // namespace fluxpact
