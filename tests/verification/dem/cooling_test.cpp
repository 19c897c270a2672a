// A gas of inelastic spheres cools as Haff's law has it.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "tests/verification/dem/granular_gas.hpp"

namespace fluxpact {
namespace {

using namespace granular_gas;

constexpr double stiffness = 3e4;
const double mass = std::numbers::pi / 6 * diameter * diameter * diameter * 2250;

TEST(Gas, cools_by_the_law_of_haff) {
  const double side = side_of(fraction);
  for (const double e : {0.95, 0.9}) {
    const double haff = haff_time(e);
    Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
    add_pair(scene, "glass", "glass", stiffness, e, 0);
    const double contact_time = std::numbers::pi * std::sqrt(0.5 * mass / stiffness);
    const double window = 0.02 * haff;
    const double time_step = window / std::ceil(window / (0.05 * contact_time));
    scene.particles.time_step = time_step;
    const auto engine = make_engine(scene, gas(side));
    CoolingLine line;
    for (int w = 1; w <= 100; ++w) {
      run(*engine, window, time_step);
      // From 0.1 τ on: contacts have formed by then.
      if (w >= 5) line.add(w * window, engine->particles());
    }
    const double found = line.time();
    fmt::print(
        "e {}: tau {:.5f} s, Haff's {:.5f} s ({:+.2f} %); T / T0 at 2 tau {:.4f} (0.1111); "
        "{:.0f} collisions a particle\n",
        e, found, haff, 100 * (found / haff - 1),
        temperature(engine->particles()) / (thermal_speed * thermal_speed),
        enskog_rate(fraction) * haff * std::log(3.0));
    // Statistics of 35,000 collisions and more 0.5 %, three times; a rate of collisions lower by
    // the share of time in contact, ω t_c = 0.5 %; the dashpot stronger by γ dt / 2 < 0.5 %;
    // velocities not quite Gaussian 0.3 % (van Noije & Ernst, Granul. Matter 1, 1998, 57-64). The
    // rate that simulations of hard spheres find is somewhat lower still, for velocities of
    // neighbours that go along with each other (Nakanishi, Energy decay rate in free cooling
    // process of inelastic hard sphere system, Newton Institute, Cambridge 2003); no figure is
    // given there. Homogeneous cooling gives way to clusters after many more collisions (Brito &
    // Ernst, Europhys. Lett. 43, 1998, 497) than the few a particle has here.
    EXPECT_NEAR(found / haff, 1, 0.025) << e;
    EXPECT_NEAR(line.start(), 1, 0.02) << e;
  }
}

}  // namespace
}  // namespace fluxpact
