// The angle of repose: a layer on a rough base flows on above it and comes to rest below it.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {
namespace {

constexpr double d = 2e-3;
constexpr int along = 20;  // diameters
constexpr int across = 10;
constexpr double depth = 15;
constexpr double g = 9.81;
constexpr double base_density = 1e5 * 2250;  // so heavy that the flow does not move it
const double mass = std::numbers::pi / 6 * d * d * d * 2250;

/// A layer 15 diameters deep over a base of spheres at jittered heights, periodic sideways, sheared
/// by 0.3 m/s from bottom to top. Gravity comes as the force on each sphere, so that it can be
/// tilted and spare the base.
ParticleState sheared_layer() {
  ParticleState state;
  UniformRandom random(1);
  for (int i = 0; i < along * across; ++i) {
    const double height = 0.5 + 0.5 * random.next();
    add_sphere(state, d * Vector3(i % along + 0.5, i / along + 0.5, height), Vector3::Zero(),
               0.5 * d, base_density);
  }
  const double low = 1.5 * d;
  const PackingBox box{{0, 0, low}, {along * d, across * d, low + depth * d}, {true, true, false}};
  const int count = static_cast<int>(0.55 * box.volume() / (std::numbers::pi / 6 * d * d * d));
  const auto centres = random_packing(box, count, d, 2);
  for (const Vector3& centre : centres.value()) {
    add_sphere(state, centre, {0.3 * (centre.z() - low) / (depth * d), 0, 0}, 0.5 * d);
  }
  return state;
}

/// Mean velocity [m/s] along the slope, every 10 ms.
std::vector<double> flow_on_a_slope(double angle, double friction) {
  Scene scene = box_scene({along * d, across * d, 2.5 * depth * d}, {Axis::x, Axis::y});
  scene.particles.time_step = 2e-5;
  add_laws(scene, 1000, 0.88, friction);
  const ParticleState state = sheared_layer();
  const auto engine = make_engine(scene, state);
  const int base = along * across;
  const double slope = angle * std::numbers::pi / 180;
  std::vector<Vector3> weight(state.id.size(), Vector3::Zero());
  for (int i = base; i < state.size(); ++i) {
    weight[i] = mass * g * Vector3(std::sin(slope), 0, -std::cos(slope));
  }
  std::vector<double> speed;
  for (int window = 0; window < 50; ++window) {
    engine->advance(0.01, 500, weight, {});
    engine->commit();
    double mean = 0;
    for (int i = base; i < state.size(); ++i) {
      mean += engine->particles().velocity[i].x() / (state.size() - base);
    }
    speed.push_back(mean);
  }
  return speed;
}

TEST(Layer, comes_to_rest_below_the_angle_of_repose_and_flows_on_above) {
  // Spheres with friction 0.5 and no resistance to rolling, springs and dashpots like these. What
  // flows comes to rest below an angle of repose, flows steadily above it up to a largest angle,
  // and gains speed beyond (Silbert, Landry & Grest, Phys. Fluids 15, 2003, doi 10.1063/1.1521719).
  // Of a deep layer these are some 19.4 and 26 degrees (Silbert, Ertas, Grest, Halsey, Levine &
  // Plimpton, Phys. Rev. E 64, 2001, 051302), and slow flow has a friction of 0.33 to 0.39, 18.5
  // to 21.5 degrees (GDR MiDi, Eur. Phys. J. E 14, 2004, 341-365): these four numbers are quoted
  // from memory. So 15 and 24 degrees keep 4 and 2 degrees away from where the two begin.
  const std::vector<double> below = flow_on_a_slope(15, 0.5);
  const std::vector<double> above = flow_on_a_slope(24, 0.5);
  const std::vector<double> smooth = flow_on_a_slope(15, 0);
  std::size_t at_rest = 0;
  while (at_rest < below.size() && std::abs(below[at_rest]) > 1e-3) ++at_rest;
  fmt::print(
      "layer, mean speed after 0.1, 0.3, 0.5 s: 15 degrees {:.4f} {:.4f} {:.4f}, 24 degrees "
      "{:.4f} {:.4f} {:.4f}, 15 degrees without friction {:.4f} {:.4f} {:.4f} m/s\n",
      below[9], below[29], below[49], above[9], above[29], above[49], smooth[9], smooth[29],
      smooth[49]);
  ASSERT_LT(at_rest, below.size()) << "it does not come to rest";
  // The loss of momentum from 60 ms (the packing has settled) to when a third of it is left gives
  // the friction between slow and moderate flow.
  std::size_t late = 6;
  while (below[late] > below[5] / 3) ++late;
  const double loss = (below[5] - below[late]) / (0.01 * static_cast<double>(late - 5));
  const double slope = 15 * std::numbers::pi / 180;
  const double friction = std::tan(slope) + loss / (g * std::cos(slope));
  fmt::print("at rest after {:.2f} s; friction while it slows {:.3f} ({:.1f} degrees)\n",
             0.01 * static_cast<double>(at_rest + 1), friction,
             180 / std::numbers::pi * std::atan(friction));
  EXPECT_GT(friction, std::tan(18 * std::numbers::pi / 180));
  EXPECT_LT(friction, std::tan(23 * std::numbers::pi / 180));
  EXPECT_GT(above[49], above[29]);
  EXPECT_GT(smooth[49], smooth[29]);
}

}  // namespace
}  // namespace fluxpact
