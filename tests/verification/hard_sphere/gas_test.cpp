// Gases of hard spheres: the rate of collisions, and how inelastic ones cool.
#include <fmt/core.h>

#include "tests/unit/dem_server/hard_sphere/hard_spheres_in_a_box.hpp"
#include "tests/verification/dem/granular_gas.hpp"

namespace fluxpact {
namespace {

using namespace granular_gas;

TEST(HardGas, collides_as_often_as_enskog_says) {
  for (const double solids : {0.1, 0.45}) {
    const double side = side_of(solids);
    Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
    add_collision(scene, "glass", 1.0, 0.0);
    const auto engine = make_hard(scene, gas(side));
    const double window = 10 / enskog_rate(solids);
    // The order of the packing is forgotten after some tens of collisions.
    for (int k = 0; k < 6; ++k) run(*engine, window, window / 1000);
    const std::int64_t before = engine->counters().collisions;
    for (int k = 0; k < 10; ++k) run(*engine, window, window / 1000);
    const double rate =
        2.0 * static_cast<double>(engine->counters().collisions - before) / (count * 10 * window);
    fmt::print("solids {}: {:.4f} of Enskog's rate\n", solids, rate / enskog_rate(solids));
    // 100,000 collisions: 0.3 %, three times; Carnahan & Starling's g0 is good to 0.5 %.
    EXPECT_NEAR(rate / enskog_rate(solids), 1, 0.015) << solids;
  }
}

TEST(HardGas, cools_by_the_law_of_haff) {
  const double side = side_of(fraction);
  for (const double e : {0.95, 0.9}) {
    const double haff = haff_time(e);
    Scene scene = box_scene(Vector3::Constant(side), {Axis::x, Axis::y, Axis::z});
    add_collision(scene, "glass", e, 0);
    const double window = 0.02 * haff;
    const auto engine = make_hard(scene, gas(side));
    CoolingLine line;
    for (int w = 1; w <= 100; ++w) {
      run(*engine, window, window / 1000);
      line.add(w * window, engine->particles());
    }
    const double found = line.time();
    fmt::print("e {}: tau {:.5f} s, Haff's {:.5f} s ({:+.2f} %)\n", e, found, haff,
               100 * (found / haff - 1));
    // Statistics of 35,000 collisions and more 0.5 %, three times; velocities not quite Gaussian
    // 0.3 %; and those of neighbours that go along with each other (as for the soft spheres).
    EXPECT_NEAR(found / haff, 1, 0.025) << e;
    EXPECT_NEAR(line.start(), 1, 0.02) << e;
  }
}

}  // namespace
}  // namespace fluxpact
