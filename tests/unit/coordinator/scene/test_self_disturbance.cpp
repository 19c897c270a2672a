// What `check` and `run` say of single spheres that would hide a part of their slip from
// themselves.
#include "coordinator/scene/self_disturbance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/mesh/box.hpp"

namespace fluxpact {
namespace {

TEST(SelfDisturbance, is_within_a_quarter_of_what_was_measured) {
  // Of spheres held at a cell's centre (docs/theory.md, section 5), there with Stokes' drag.
  struct Measured {
    double cells, reynolds, share;
  };
  for (const Measured& m :
       {Measured{5, 0.1, 0.174}, Measured{10, 0.1, 0.0923}, Measured{5, 1, 0.1157},
        Measured{10, 1, 0.0427}, Measured{5, 10, 0.0186}, Measured{10, 10, 0.0055}}) {
    const double stronger = 1 + 0.15 * std::pow(m.reynolds, 0.687);
    const double with_that = stronger * m.share / (1 + (stronger - 1) * m.share);
    EXPECT_NEAR(self_disturbance(m.cells, m.reynolds) / with_that, 1, 0.25)
        << m.cells << " d, Re " << m.reynolds;
  }
  // The maps 20 and 40 diameters wide that left 0.13 and 0.03 % at Re = 4, with Stokes' drag: half
  // a per cent is between 8 d (0.71 %) and 20 d.
  EXPECT_GT(wide_enough(4.035), 8);
  EXPECT_LT(wide_enough(4.035), 20);
  EXPECT_GT(wide_enough(0.1), 2 * wide_enough(1));
}

TEST(SelfDisturbance, knows_the_terminal_slip) {
  FluidSettings gas;
  gas.density = 1.2;
  gas.viscosity = 1.8e-5;
  // DEM06 of MFIX: 0.45740 m/s.
  EXPECT_NEAR(terminal_reynolds(gas, 9.80665, 1e-4, 2000), 1.2 * 0.45740 * 1e-4 / 1.8e-5, 1e-3);
}

/// 10 spheres of 0.1 mm in a gas.
Scene few_in_gas(double edge) {
  Scene scene;
  scene.scene.gravity = {0, 0, -9.81};
  scene.fluid.density = 1.2;
  scene.fluid.viscosity = 1.8e-5;
  scene.fluid.mesh.box = {{0, 0, 0}, Vector3::Constant(10 * edge), {10, 10, 10}};
  scene.particles.materials["glass"].density = 2000;
  InsertionSettings entry;
  entry.material = "glass";
  entry.diameter = 1e-4;
  entry.count = 10;
  scene.particles.insertion = {entry};
  return scene;
}

std::vector<std::string> warnings(const Scene& scene) {
  return self_disturbance_warnings(scene, make_box(scene.fluid.mesh));
}

TEST(SelfDisturbance, is_told_with_its_number_and_what_helps) {
  const Scene scene = few_in_gas(5e-4);
  ASSERT_EQ(warnings(scene).size(), 1U);
  for (const char* part : {"interphase.voidage.map 'exact'", "5 diameters", "'glass'", "7.",
                           "self_disturbance: corrected", "width: 0.002 m", "Re = 3.1"}) {
    EXPECT_NE(warnings(scene).front().find(part), std::string::npos) << part << warnings(scene)[0];
  }
}

TEST(SelfDisturbance, is_not_told_where_it_does_not_matter) {
  EXPECT_TRUE(warnings(few_in_gas(2e-3)).empty());  // 20 d: 0.6 %
  Scene wide = few_in_gas(5e-4);
  wide.interphase.voidage.map = VoidageMap::kernel;
  EXPECT_TRUE(warnings(wide).empty());
  Scene bed = few_in_gas(5e-4);
  bed.particles.insertion.front().count = 60000;  // a quarter of the box
  EXPECT_TRUE(warnings(bed).empty());
  Scene from_file = few_in_gas(5e-4);
  from_file.particles.insertion.front().type = InsertionType::file;
  EXPECT_TRUE(warnings(from_file).empty());
  Scene corrected = few_in_gas(5e-4);
  corrected.interphase.self_disturbance = SelfDisturbance::corrected;
  EXPECT_TRUE(warnings(corrected).empty());
  corrected.particles.insertion.front().count = 60000;
  ASSERT_EQ(warnings(corrected).size(), 1U);  // a bed
  EXPECT_NE(warnings(corrected).front().find("is for single spheres"), std::string::npos);
  Scene floating = few_in_gas(5e-4);
  floating.scene.gravity.setZero();
  EXPECT_TRUE(warnings(floating).empty());
  Scene without = few_in_gas(5e-4);
  without.interphase.drag = DragLaw::none;
  EXPECT_TRUE(warnings(without).empty());
}

}  // namespace
}  // namespace fluxpact
