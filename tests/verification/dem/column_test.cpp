// A column between walls with friction: the walls carry the weight beyond a depth of their own, as
// Janssen has it; without friction the floor carries all of it.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "dem_server/insertion/packing.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double d = 2e-3;
constexpr double width = 8 * d;
constexpr double g = 9.81;
constexpr double stiffness = 1000;
constexpr double particle_friction = 0.5;
const double mass = std::numbers::pi / 6 * d * d * d * 2250;

constexpr int samples = 25;  // over the last 50 ms: the column still rings at some 100 Hz

/// What the floor carries of a column at rest, over its weight [-]; and the speed left in it.
struct Load {
  double share = 0;
  double speed = 0;  // m/s, root mean square
};

Load floor_load(int count, double wall_friction) {
  const double filled = count * std::numbers::pi / 6 * d * d * d / (0.55 * width * width);
  Scene scene = box_scene({width, width, filled + 2 * d});
  scene.scene.gravity = {0, 0, -g};
  scene.particles.time_step = 2e-5;
  add_pair(scene, "glass", "glass", stiffness, 0.5, particle_friction);
  add_pair(scene, "glass", "walls", stiffness, 0.5, wall_friction);
  const PackingBox box{Vector3::Zero(), {width, width, filled}, {}};
  const auto centres = random_packing(box, count, d, 1);
  ParticleState state;
  for (const Vector3& centre : centres.value()) {
    add_sphere(state, centre, Vector3::Zero(), 0.5 * d);
  }
  const auto engine = make_engine(scene, state);
  run(*engine, 0.35, 2e-5);
  Load load;
  for (int sample = 0; sample < samples; ++sample) {
    run(*engine, 2e-3, 2e-5);
    for (int i = 0; i < count; ++i) {
      const double overlap = 0.5 * d - engine->particles().position[i].z();
      load.share += stiffness * std::max(0.0, overlap) / (samples * count * mass * g);
      load.speed += engine->particles().velocity[i].squaredNorm() / (samples * count);
    }
  }
  load.speed = std::sqrt(load.speed);
  return load;
}

TEST(Column, between_walls_with_friction_saturates_as_janssen_has_it) {
  // Janssen (Z. Ver. dt. Ing. 39, 1895, 1045; translated by Sperl, Granul. Matter 8, 2006, 59-65):
  // the floor carries no more than a height D / (4 μ K) of the column, whatever its own. K is the
  // ratio of the horizontal to the vertical stress: 1 if the stress were isotropic, not below that
  // of active failure, (1 − sin φ) / (1 + sin φ) = 0.4 for an angle of internal friction of 25
  // degrees (Nedderman, Statics and Kinematics of Granular Materials, 1992). Simulations of spheres
  // in silos find forces at the walls close to, not at, those of slip, and a region at the top in
  // which the stress grows as in a liquid, so that Janssen's law holds in part only (Landry, Grest
  // & Plimpton, arXiv:cond-mat/0302115, 2003). Both lower the K that is seen; we allow half of it
  // (an estimate of ours); the floor with some fifty spheres on it fluctuates by a tenth. So 0.2
  // to 1.1; without friction at the walls 0.07 would be seen.
  constexpr double wall_friction = 0.5;
  std::array<double, 2> carried{};  // [m] of the column
  for (const int times : {1, 2}) {
    const int count = 2000 * times;
    const Load load = floor_load(count, wall_friction);
    const double height = count * std::numbers::pi / 6 * d * d * d / (0.59 * width * width);
    carried[times - 1] = load.share * height;
    fmt::print(
        "column of {} spheres, {:.1f} D high: floor carries {:.1f} % of it, {:.2f} D, K "
        "{:.2f}; left over {:.1e} m/s\n",
        count, height / width, 100 * load.share, carried[times - 1] / width,
        width / (4 * wall_friction * carried[times - 1]), load.speed);
    EXPECT_LT(load.speed, 1e-3);
  }
  const double ratio = width / (4 * wall_friction * carried[1]);
  EXPECT_GT(ratio, 0.2);
  EXPECT_LT(ratio, 1.1);
  // Twice the column, no more on the floor than two fluctuations allow.
  EXPECT_NEAR(carried[1] / carried[0], 1, 0.25);
}

TEST(Column, between_walls_without_friction_rests_on_the_floor) {
  const Load load = floor_load(2000, 0);
  fmt::print("smooth walls: floor carries {:.2f} % of the column, left over {:.1e} m/s\n",
             100 * load.share, load.speed);
  // What still rings, 2 π f v / g = 0.1 of the weight at 100 Hz and 1.6 mm/s, less the mean over
  // five periods.
  EXPECT_NEAR(load.share, 1, 0.02);
}

}  // namespace
}  // namespace fluxpact
