// Materials of YADE from contact laws: two in series give what the scene asks for.
#include "dem_server/backends/yade/yade_springs.hpp"

#include <cmath>

#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr YadeSpheres glass{1e-3, 2250, 0};

/// YADE's own: a zero is left out.
double in_series(double a, double b) {
  const double softness = (a != 0 ? 1 / a : 0) + (b != 0 ? 1 / b : 0);
  return softness != 0 ? 1 / softness : 0;
}

Scene two_laws(double own, double own_e, double wall, double wall_e) {
  Scene scene = box_scene({0.02, 0.02, 0.02});
  add_pair(scene, "glass", "glass", own, own_e, 0.3);
  add_pair(scene, "glass", "walls", wall, wall_e, 0.1);
  return scene;
}

TEST(YadeSprings, in_series_are_the_contact_that_was_asked_for) {
  const double mass = sphere_mass(glass.radius, glass.density);
  for (const auto& [own, own_e, wall, wall_e] : {std::array{1000., 0.9, 1000., 0.9},
                                                 {1000., 0.9, 5000., 0.2},
                                                 {1000., 1., 2000., 0.3},
                                                 {1000., 0.9, 300., 1.}}) {
    const Scene scene = two_laws(own, own_e, wall, wall_e);
    const YadeMaterials made = yade_materials(ContactLaws(scene.particles), glass);
    ASSERT_EQ(made.kn.size(), 3);  // free, fixed glass, walls
    const auto expect = [&](int kind, double stiffness, double restitution, double effective) {
      const double damping = 2 * damping_ratio(restitution) * std::sqrt(stiffness * effective);
      const double undamped = damping == 0 ? 1e-9 * made.cn[0] : 0;  // nothing in series gives 0
      // Round-off of a difference of reciprocals, some ten times that of its operands.
      EXPECT_NEAR(in_series(made.kn[0], made.kn[kind]) / stiffness, 1, 1e-14);
      EXPECT_NEAR(in_series(made.ks[0], made.ks[kind]) * 3.5 / stiffness, 1, 1e-14);
      EXPECT_NEAR(in_series(made.cn[0], made.cn[kind]), damping, 1e-14 * damping + undamped);
      EXPECT_NEAR(in_series(made.cs[0], made.cs[kind]), damping / 2, 1e-14 * damping + undamped);
    };
    expect(0, own, own_e, mass / 2);
    expect(1, own, own_e, mass);  // the fixed one is infinitely heavy
    expect(2, wall, wall_e, mass);
    EXPECT_DOUBLE_EQ(std::tan(made.friction_angle[0]), 0.3);
    EXPECT_DOUBLE_EQ(std::tan(made.friction_angle[2]), 0.1);
    EXPECT_EQ(made.friction_angle[2], made.friction_angle[6]);
  }
}

TEST(YadeSprings, of_a_body_may_be_missing_or_negative) {
  EXPECT_EQ(in_series_with(0, 3), 3);
  EXPECT_EQ(in_series_with(2, 2), 0);
  EXPECT_EQ(in_series_with(2, 4), -4);
  EXPECT_EQ(in_series_with(4, 2), 4);
}

}  // namespace
}  // namespace fluxpact
