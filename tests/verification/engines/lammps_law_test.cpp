// The laws that LAMMPS takes by pairs of materials, for any sizes and masses, beside the native
// engine.
#include <fmt/core.h>

#include "dem_server/backends/lammps/lammps_script.hpp"
#include "tests/verification/engines/mixture.hpp"

namespace fluxpact {
namespace {

TEST(Law, without_friction_is_that_of_the_native_engine_for_any_masses) {
  const double linear = difference_after(mixture_of(ContactLaw::linear, 0), 100);
  const double hertz = difference_after(mixture_of(ContactLaw::hertz, 0), 100);
  fmt::print("velocities differ by {:.2g} (linear), {:.2g} (hertz)\n", linear, hertz);
  // The root of the polynomial of `damping tsuji` is good to 1e-13 of the dashpot; collisions let
  // it grow.
  EXPECT_LT(linear, 1e-9);
  EXPECT_LT(hertz, 1e-9);
}

// LAMMPS turns spheres by the lever r - δ/2: of the order of δ / 2r = 1e-2 of the spins' gains.
TEST(Law, with_friction_differs_by_the_lever) {
  const double linear = difference_after(mixture_of(ContactLaw::linear, 0.3), 40);
  const double hertz = difference_after(mixture_of(ContactLaw::hertz, 0.3), 40);
  fmt::print("velocities differ by {:.2g} (linear), {:.2g} (hertz)\n", linear, hertz);
  EXPECT_LT(linear, 5e-3);
  EXPECT_LT(hertz, 5e-3);
}

TEST(Law, finds_the_coefficient_that_lammps_turns_into_ours) {
  for (const double share : {0.0, 1e-3, 0.0671, 0.5, 1.2728, 2.0, 2.236}) {
    const double c = tsuji_coefficient(share);
    const double made =
        1.2728 +
        c * (-4.2783 + c * (11.087 + c * (-22.348 + c * (27.467 + c * (-18.022 + c * 4.8218)))));
    EXPECT_NEAR(made, share, 1e-13) << share;  // sums of numbers up to 28
  }
}

}  // namespace
}  // namespace fluxpact
