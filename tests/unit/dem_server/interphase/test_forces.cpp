#include "dem_server/interphase/forces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "dem_server/interphase/dispersion.hpp"

namespace fluxpact {
namespace {

constexpr FluidProperties water{1000, 1e-3};
constexpr FluidProperties air{1.2, 1.8e-5};

/// u = (γ y, 0, 0): faster upwards in y. Its vorticity is −γ z.
LiftPoint in_shear(double diameter, double lag, double shear) {
  return {diameter, Vector3(lag, 0, 0), Vector3(0, 0, -shear), Vector3::Zero()};
}

TEST(AddedMass, is_half_the_fluid_displaced_and_grows_with_crowding) {
  EXPECT_EQ(added_mass_coefficient(Crowding::none, 0.5), 0.5);
  EXPECT_EQ(added_mass_coefficient(Crowding::zuber, 1.0), 0.5);
  // φ = 0.4: (1 + 0.8)/0.6 = 3.
  EXPECT_NEAR(added_mass_coefficient(Crowding::zuber, 0.6), 1.5, 1e-15);
}

TEST(SaffmanLift, has_the_value_of_saffman_and_mei) {
  // Re = 5, β = 1; 6.46 a² μ |u−v| √(γ/ν) = 2.5535e-8 N times (1 − 0.3314) e^−0.5 + 0.3314.
  EXPECT_NEAR(saffman_lift(in_shear(1e-3, 5e-3, 10), water).y(), 1.881770455376576e-08, 1e-22);
  // Re = 80, β = 1/16: the other branch.
  EXPECT_NEAR(saffman_lift(in_shear(1e-3, 0.08, 10), water).y(), 4.7871694771754226e-08, 1e-22);
}

TEST(SaffmanLift, drives_a_lagging_sphere_to_the_faster_side_and_a_leading_one_to_the_slower) {
  EXPECT_GT(saffman_lift(in_shear(1e-4, 1e-3, 10), water).y(), 0);
  EXPECT_LT(saffman_lift(in_shear(1e-4, -1e-3, 10), water).y(), 0);
  EXPECT_GT(saffman_lift(in_shear(1e-4, -1e-3, -10), water).y(), 0);  // faster downwards
  const Vector3 force = saffman_lift(in_shear(1e-4, 1e-3, 10), water);
  EXPECT_EQ(force.x(), 0);
  EXPECT_EQ(force.z(), 0);
}

TEST(SaffmanLift, tends_to_saffmans_own_for_creeping_flow_and_vanishes_without_shear_or_slip) {
  // Re = 1e-5 and β = 1 leave e^−Re/10 = 1 − 1e-6.
  const double d = 1e-5;
  const double lag = 1e-6;
  const double shear = 2 * lag / d;
  const double saffman = 6.46 * d * d / 4 * 1e-3 * lag * std::sqrt(shear * 1e6);
  EXPECT_NEAR(saffman_lift(in_shear(d, lag, shear), water).y() / saffman, 1, 2e-6);
  EXPECT_EQ(saffman_lift(in_shear(d, 0, 10), water), Vector3(0, 0, 0));
  EXPECT_EQ(saffman_lift(in_shear(d, lag, 0), water), Vector3(0, 0, 0));
  EXPECT_TRUE(saffman_lift(in_shear(d, 1e-300, 10), water).allFinite());
  // The two branches meet but for (1 − 0.3314 √β) e^−4, here 0.0162 (β = 1/8) of f = 0.1333.
  const double below = saffman_lift(in_shear(1e-3, 0.0399999, 10), water).y();
  const double above = saffman_lift(in_shear(1e-3, 0.0400001, 10), water).y();
  EXPECT_NEAR(above / below, 1 - 0.0162 / 0.1333, 1e-3);
}

TEST(MagnusLift, has_the_value_of_oesterle_and_bui_dinh) {
  // Re = 66.67, Re_r = 33.33, C = 0.47214.
  const LiftPoint point{1e-3, {-1, 0, 0}, {0, 0, 0}, {0, 0, 500}};
  EXPECT_NEAR(magnus_lift(point, air).y(), 2.2249045900988797e-07, 1e-21);
}

TEST(MagnusLift, bends_the_way_of_a_ball_with_back_spin_up) {
  // It flies along x through fluid at rest, and its top moves backwards: it rises.
  const LiftPoint back_spin{0.04, {-30, 0, 0}, {0, 0, 0}, {0, 0, 200}};
  const Vector3 surface_on_top = Vector3(0, 0, 200).cross(Vector3(0, 0.02, 0));
  EXPECT_LT(surface_on_top.x(), 0);
  EXPECT_GT(magnus_lift(back_spin, air).y(), 0);
  const LiftPoint top_spin{0.04, {-30, 0, 0}, {0, 0, 0}, {0, 0, -200}};
  EXPECT_LT(magnus_lift(top_spin, air).y(), 0);
}

TEST(MagnusLift, tends_to_rubinow_and_kellers_and_vanishes_without_relative_spin) {
  // Re_r = Re = 1e-6: the exponent is 0.057 (1e-6)^0.7 = 4e-6.
  const double d = 1e-6;
  const LiftPoint slow{d, {-1e-6, 0, 0}, {0, 0, 0}, {0, 0, 1}};
  const double creeping = std::numbers::pi / 8 * d * d * d * 1000 * 1e-6;
  EXPECT_NEAR(magnus_lift(slow, water).y() / creeping, 1, 1e-5);
  // It turns with the fluid.
  const LiftPoint turning_along{1e-3, {1, 0, 0}, {0, 0, 20}, {0, 0, 10}};
  EXPECT_EQ(magnus_lift(turning_along, water), Vector3(0, 0, 0));
  // Not turning in a shear flow that it lags behind: against Saffman's lift, and weaker.
  const LiftPoint lagging = in_shear(1e-4, 1e-3, 10);
  EXPECT_LT(magnus_lift(lagging, water).y(), 0);
  EXPECT_LT(-magnus_lift(lagging, water).y(), saffman_lift(lagging, water).y());
}

TEST(EddyStay, is_the_life_of_the_eddy_or_the_time_to_cross_it) {
  // l = 0.09^(3/4) k^1.5/ε; √(2k/3) = 1 for k = 1.5.
  const double size = std::pow(0.09, 0.75) * std::pow(1.5, 1.5) / 2;
  EXPECT_NEAR(eddy_stay({1.5, 2, 0, 1}), size, 1e-15);
  // Too little slip to get out of it.
  EXPECT_NEAR(eddy_stay({1.5, 2, size, 0.99}), size, 1e-15);
  // −τ ln(1 − l/(τ s)), half of it gone: ln 2.
  EXPECT_NEAR(eddy_stay({1.5, 2, 2 * size / 0.1, 0.1}), 0.1 * std::numbers::ln2, 1e-15);
  EXPECT_NEAR(eddy_stay({1.5, 2, 4.0, std::numeric_limits<double>::infinity()}), size / 4, 1e-15);
  EXPECT_EQ(eddy_stay({0, 2, 1, 1}), 0);
  EXPECT_EQ(eddy_stay({1.5, 0, 1, 1}), 0);
}

TEST(Dispersion, spreads_as_its_eddies_do_whether_windows_are_shorter_or_longer_than_them) {
  // Steps of length t_e with independent u': <x²> = σ² t_e t, whatever the window.
  const EddyPoint point{1.5, 2, 0, 1};  // σ = 1
  const double stay = eddy_stay(point);
  constexpr int count = 4000;
  for (const double ratio : {0.1, 0.7, 3.3, 40.0}) {
    const double window = ratio * stay;
    const int steps = static_cast<int>(std::ceil(60 / ratio));
    double sum = 0;
    Vector3 mean = Vector3::Zero();
    for (int i = 0; i < count; ++i) {
      Eddy eddy;
      Vector3 path = Vector3::Zero();
      for (int step = 0; step < steps; ++step)
        path += window * mean_fluctuation(point, window, 7, i, eddy);
      sum += path.squaredNorm() / 3;
      mean += path / count;
    }
    const double time = steps * window;
    // <x²> of 12000 normal components is known to √(2/12000) = 1.3 %; four of them. What is cut
    // off at the end is a part of one eddy in 60.
    EXPECT_NEAR(sum / count / (stay * time), 1, 0.052 + 1.0 / 60) << ratio;
    EXPECT_LE(mean.norm(), 5 * std::sqrt(stay * time / count)) << ratio;
  }
}

TEST(Dispersion, holds_an_eddy_until_it_ends) {
  const EddyPoint point{1.5, 2, 0, 1};
  const double stay = eddy_stay(point);
  Eddy eddy;
  const Vector3 first = mean_fluctuation(point, 0.4 * stay, 3, 5, eddy);
  EXPECT_EQ(mean_fluctuation(point, 0.4 * stay, 3, 5, eddy), first);
  const Vector3 mixed = mean_fluctuation(point, 0.4 * stay, 3, 5, eddy);
  EXPECT_LE((mixed - 0.5 * (first + eddy.velocity)).norm(), 1e-14);
  EXPECT_NE(eddy.velocity, first);
}

TEST(Dispersion, depends_on_seed_id_and_what_was_drawn_alone) {
  const EddyPoint point{1.5, 2, 0, 1};
  const auto walk = [&](std::uint64_t seed, std::int64_t id) {
    Eddy eddy;
    return mean_fluctuation(point, 1e-3, seed, id, eddy);
  };
  EXPECT_EQ(walk(1, 2), walk(1, 2));
  EXPECT_NE(walk(1, 2), walk(2, 1));
  EXPECT_NE(walk(1, 2), walk(1, 3));
  Eddy eddy{{1, 0, 0}, 1, 5};
  EXPECT_EQ(mean_fluctuation({0, 0, 0, 1}, 1e-3, 1, 1, eddy), Vector3(0, 0, 0));
  EXPECT_EQ(eddy.left, 0);
}

}  // namespace
}  // namespace fluxpact
