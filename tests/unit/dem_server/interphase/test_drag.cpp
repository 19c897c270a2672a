#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dem_server/interphase/drag.hpp"

namespace fluxpact {
namespace {

constexpr double pi = std::numbers::pi;
const FluidProperties air{1.2, 1.8e-5};

// Typed-in numbers carry 16 digits; the formulas are some ten operations.
constexpr double digits = 1e-14;

TEST(Drag, ergun_has_the_value_worked_out_by_hand) {
  // ε 0.4, d 1 mm, slip 0.5: viscous 150·0.6·1.8e-5/(0.4·1e-6) = 4050; inertial 1.75·1.2·0.5/1e-3 =
  // 1050; V_p = π/6 1e-9: ζ = 5100 π/6 1e-9.
  const double expected = 5100 * pi / 6 * 1e-9;
  EXPECT_NEAR(ergun_drag({0.4, 1e-3, 0.5}, air), expected, digits * expected);
}

TEST(Drag, wen_yu_has_the_values_worked_out_from_its_drag_curve) {
  // From β = 3/4 C_D ε (1−ε) ρ|u−v|/d ε^−2.65 in Python, ζ = V_p β/(1−ε).
  // ε 0.9, d 2 mm, slip 1: Re = 120, C_D = 1.00449, ζ:
  EXPECT_NEAR(wen_yu_drag({0.9, 2e-3, 1}, air), 2.2529164958296153e-06,
              digits * 2.2529164958296153e-06);
  // ε 0.85, d 5 mm, slip 10: Re = 2833, C_D = 0.44, ζ:
  EXPECT_NEAR(wen_yu_drag({0.85, 5e-3, 10}, air), 6.777859928982716e-05,
              digits * 6.777859928982716e-05);
}

TEST(Drag, stokes_is_three_pi_mu_d) {
  EXPECT_NEAR(stokes_drag({0.5, 1e-4, 3}, air), 3 * pi * 1.8e-9, digits * 3 * pi * 1.8e-9);
}

TEST(Drag, wen_yu_of_one_sphere_in_creeping_flow_is_stokes) {
  const double stokes = stokes_drag({1, 1e-4, 0}, air);
  EXPECT_NEAR(wen_yu_drag({1, 1e-4, 0}, air), stokes, digits * stokes);
}

TEST(Drag, of_a_fixed_bed_gives_the_pressure_drop_of_ergun) {
  const double e = 0.42;
  const double d = 3e-3;
  const double superficial = 0.7;
  const double spheres = (1 - e) / (pi / 6 * d * d * d);  // per volume of bed
  const double u = superficial / e;
  const double beta = spheres * ergun_drag({e, d, u}, air);
  // Steady model A: ε dp/dz = β u.
  const double drop = beta * u / e;
  const double expected =
      150 * (1 - e) * (1 - e) * air.viscosity * superficial / (e * e * e * d * d) +
      1.75 * (1 - e) * air.density * superficial * superficial / (e * e * e * d);
  EXPECT_NEAR(drop, expected, digits * expected);
}

TEST(Drag, is_continuous_and_finite_without_slip) {
  for (const auto law : {ergun_drag, wen_yu_drag, gidaspow_drag, stokes_drag}) {
    for (const double e : {0.4, 0.9, 0.99}) {
      const double still = law({e, 1e-3, 0}, air);
      EXPECT_GT(still, 0);
      // At slip 1e-12, Re is 7e-11: 0.15 Re^0.687 is 1.6e-8 at most, the inertial part of Ergun
      // 1e-12.
      EXPECT_NEAR(law({e, 1e-3, 1e-12}, air), still, 1e-7 * still);
    }
  }
}

TEST(Drag, grows_with_slip) {
  for (const auto law : {ergun_drag, wen_yu_drag, gidaspow_drag}) {
    double last = 0;
    for (int tenths = 0; tenths < 400; ++tenths) {  // passes Re = 1000
      const double slip = 0.1 * tenths;
      const double now = law({0.85, 1e-3, slip}, air);
      EXPECT_GT(now, last) << slip;
      last = now;
    }
  }
}

TEST(Drag, gidaspow_is_ergun_below_and_wen_yu_from_a_voidage_of_0_8) {
  const DragPoint dense{0.7999, 1e-3, 0.5};
  const DragPoint dilute{0.8, 1e-3, 0.5};
  EXPECT_EQ(gidaspow_drag(dense, air), ergun_drag(dense, air));
  EXPECT_EQ(gidaspow_drag(dilute, air), wen_yu_drag(dilute, air));
}

TEST(Drag, gidaspow_drops_at_0_8_by_as_much_as_it_says) {
  // Viscous parts: Ergun 150·0.2/0.8 = 37.5, Wen-Yu 18·0.8^−2.65 = 32.5...
  const auto drop = [](double slip) {
    return 1 - wen_yu_drag({0.8, 1e-3, slip}, air) / ergun_drag({0.8, 1e-3, slip}, air);
  };
  EXPECT_NEAR(drop(0), 0.13, 0.005);
  EXPECT_NEAR(drop(100 * air.viscosity / (0.8 * air.density * 1e-3)), 0.42, 0.005);
}

TEST(Drag, of_all_spheres_is_that_of_each) {
  const std::vector<DragPoint> points{{0.4, 1e-3, 0.5}, {0.9, 2e-3, 1}, {0.99, 1e-4, 0}};
  std::vector<double> all(3);
  using Single = double (*)(const DragPoint&, const FluidProperties&);
  const std::vector<std::pair<DragLaw, Single>> laws{{DragLaw::gidaspow, gidaspow_drag},
                                                     {DragLaw::ergun, ergun_drag},
                                                     {DragLaw::wen_yu, wen_yu_drag},
                                                     {DragLaw::stokes, stokes_drag}};
  for (const auto& [law, single] : laws) {
    drag_coefficients({.law = law}, PressureModel::a, air, points, 2, all);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(all[i], single(points[i], air));
  }
  drag_coefficients({.law = DragLaw::ergun}, PressureModel::b, air, points, 2, all);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(all[i], ergun_drag(points[i], air) / points[i].voidage);
  drag_coefficients({.law = DragLaw::none}, PressureModel::a, air, points, 2, all);
  for (const double value : all) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace fluxpact
