// One sphere crosses a face of a channel: what the fluid's pressure says to it as the window gets
// shorter. The rate at which a cell fills is bounded if the map is continuous, else V_p/Δt; and the
// pressure that makes the fluid follow goes with the rate of that.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "coupled.hpp"
#include "dem_server/backends/kinematic/kinematic_engine.hpp"

namespace fluxpact {
namespace {

Scene channel(const VoidageSettings& map, double window) {
  Scene scene;
  scene.coupling.window = window;
  scene.scene.gravity = Vector3::Zero();
  scene.fluid.density = 1.2;
  scene.fluid.viscosity = 1.8e-5;
  scene.fluid.mesh.box = {Vector3::Zero(), {0.1, 0.01, 0.01}, {10, 1, 1}};
  scene.fluid.mesh.patches = {{"inlet", {Side::x_min, {}}}, {"outlet", {Side::x_max, {}}}};
  BoundarySettings inlet;
  inlet.type = BoundaryType::velocity;
  inlet.superficial = Vector3(1, 0, 0);
  BoundarySettings outlet;
  outlet.type = BoundaryType::pressure;
  BoundarySettings walls;
  walls.slip = Slip::free;
  scene.fluid.boundaries = {{"inlet", inlet}, {"outlet", outlet}, {"walls", walls}};
  scene.fluid.initial.superficial = Vector3(1, 0, 0);
  scene.fluid.numerics.pressure_tolerance = 1e-10;
  scene.fluid.numerics.threads = 1;
  scene.particles.time_step = window;
  scene.particles.numerics.threads = 1;
  scene.particles.backend = ParticleBackend::kinematic;
  scene.particles.materials["glass"].density = 2500;
  scene.interphase.voidage = map;
  scene.interphase.drag = DragLaw::none;
  return scene;
}

/// Largest |p| [Pa] of any cell while a sphere of 4 mm goes 10 mm at 0.5 m/s, over a face midway.
double peak_pressure(const VoidageSettings& map, double window, bool trace) {
  const double speed = 0.5;
  const ParticleState sphere = single_sphere({0.045, 0.005, 0.005}, {speed, 0, 0}, 4e-3, 2500);
  Coupled coupled(channel(map, window), [&](const Scene& scene, const Mesh& mesh) {
    return make_kinematic_engine(scene, mesh, sphere);
  });
  const int windows = static_cast<int>(std::lround(0.01 / speed / window));
  double peak = 0;
  for (int step = 1; step <= windows; ++step) {
    coupled.advance();
    double largest = 0;
    for (const double p : coupled.pressure()) largest = std::max(largest, std::abs(p));
    // The fluid starts without the motion that the sphere's asks of it; not what is looked at.
    if (step * 10 > windows) peak = std::max(peak, largest);
    if (trace) fmt::print(" {:.2g}", largest);
  }
  if (trace) fmt::print("\n");
  return peak;
}

TEST(Crossing, of_a_face_keeps_the_pressure_bounded_with_continuous_maps_only) {
  fmt::print("largest |p| (Pa) as one sphere of 0.4 cells crosses a face; in brackets: growth\n");
  for (const auto& [name, map] : all_maps(0.016)) {
    std::array<double, 3> peak{};
    const std::array<double, 3> lengths{1e-3, 1e-4, 1e-5};
    for (std::size_t k = 0; k < 3; ++k) peak.at(k) = peak_pressure(map, lengths.at(k), false);
    fmt::print("{:>10}: window 1 ms {:.3g}, 0.1 ms {:.3g} ({:.3g}), 0.01 ms {:.3g} ({:.3g})\n",
               name, peak[0], peak[1], peak[1] / peak[0], peak[2], peak[2] / peak[1]);
    fmt::print("            trace at 1 ms:");
    peak_pressure(map, lengths[0], true);
    if (map.map == VoidageMap::centroid || map.map == VoidageMap::satellite) {
      // A jump of the cell's volume: the velocity over the face goes with 1/Δt, its rate with
      // another.
      EXPECT_GT(peak[1], 8 * peak[0]) << name;
      EXPECT_GT(peak[2], 8 * peak[1]) << name;
    } else {
      EXPECT_LT(peak[1], 1.5 * peak[0]) << name;  // 1 ms is an eighth of the crossing: not resolved
      EXPECT_LT(peak[2], 1.1 * peak[1]) << name;
    }
  }
}

}  // namespace
}  // namespace fluxpact
