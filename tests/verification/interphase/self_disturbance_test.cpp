// A sphere that falls through a rising gas disturbs the gas that it sees. How much of its velocity
// is that error, by map and by size of the cells? Terminal velocity of one sphere of 0.1 mm after
// the case DEM06 of MFIX (Garg et al., Documentation of open-source MFIX-DEM software, 2012), here
// with the drag of Stokes, for which it is known in closed form: v = u − g d² (ρ_p − ρ)/(18 μ).
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coupled.hpp"
#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "tests/unit/dem_server/participant/free_flight.hpp"

namespace fluxpact {
namespace {

constexpr double diameter = 1e-4;
constexpr double density = 2000;
constexpr double gas_density = 1.2;
constexpr double viscosity = 1.8e-5;
constexpr double gravity = 9.81;
const double slip = gravity * diameter * diameter * (density - gas_density) / (18 * viscosity);

struct Rise {
  std::array<int, 3> cells{5, 20, 5};
  Vector3 size{0.01, 0.1, 0.01};  // m
  Vector3 start{0.005, 0.0925, 0.005};
  double inflow = 0;  // m/s along y
  double window = 1e-3;
  double end = 0.7;  // s
};

Scene scene_of(const Rise& setup, const VoidageSettings& map) {
  Scene scene;
  scene.coupling.window = setup.window;
  scene.scene.gravity = {0, -gravity, 0};
  scene.fluid.density = gas_density;
  scene.fluid.viscosity = viscosity;
  scene.fluid.mesh.box = {Vector3::Zero(), setup.size, setup.cells};
  scene.fluid.mesh.patches = {{"inlet", {Side::y_min, {}}}, {"outlet", {Side::y_max, {}}}};
  BoundarySettings inlet;
  inlet.type = BoundaryType::velocity;
  inlet.superficial = Vector3(0, setup.inflow, 0);
  BoundarySettings outlet;
  outlet.type = BoundaryType::pressure;
  BoundarySettings walls;
  walls.slip = Slip::free;
  scene.fluid.boundaries = {{"inlet", inlet}, {"outlet", outlet}, {"walls", walls}};
  scene.fluid.initial.superficial = Vector3(0, setup.inflow, 0);
  scene.fluid.numerics.threads = 1;
  scene.particles.time_step = setup.window;
  scene.particles.numerics.threads = 1;
  scene.interphase.voidage = map;
  scene.interphase.drag = DragLaw::stokes;
  return scene;
}

/// Velocity along y [m/s] at the end.
double final_velocity(const Rise& setup, const VoidageSettings& map, bool two_way) {
  const ParticleState sphere =
      single_sphere(setup.start, {0, setup.inflow - slip, 0}, diameter, density);
  Coupled coupled(scene_of(setup, map), [&](const Scene& scene, const Mesh&) {
    return std::make_unique<FreeFlight>(sphere, scene.scene.gravity, Vector3::Zero());
  });
  const int windows = static_cast<int>(std::lround(setup.end / setup.window));
  for (int step = 0; step < windows; ++step) coupled.advance(two_way);
  return coupled.particle("velocity").y();
}

TEST(SelfDisturbance, of_the_velocity_is_below_half_a_per_cent_with_maps_four_cells_wide) {
  // The reference falls at 0.0574 m/s through cells of 20 x 50 x 20 diameters. After 0.7 s, 11
  // relaxation times, what is left of the first window, in which no drag acts yet, is 2e-6.
  Rise rise;
  rise.inflow = slip - 0.0574;
  const double expected = rise.inflow - slip;
  fmt::print("DEM06: error of the velocity, over the velocity, 0.0574 m/s\n");
  for (const double width : {4e-3, 8e-3}) {
    for (const auto& [name, map] : all_maps(width)) {
      const bool wide = map.map == VoidageMap::kernel || map.map == VoidageMap::diffusion;
      if (!wide && width > 4e-3) continue;
      const double one_way = std::abs(final_velocity(rise, map, false) / expected - 1);
      const double two_way = std::abs(final_velocity(rise, map, true) / expected - 1);
      fmt::print("{:>10}{}: one-way {:.1e}, two-way {:.2e}\n", name,
                 wide ? fmt::format(", {:.0f} mm wide", 1e3 * width) : "", one_way, two_way);
      EXPECT_LE(one_way, 1e-5) << name;
      if (wide && width > 4e-3) {
        EXPECT_LE(two_way, 5e-3) << name;
      } else {
        EXPECT_LE(two_way, 0.05) << name;
      }
    }
  }
}

/// The share of the slip that a sphere held in a uniform stream does not see, with steady fluid.
double unseen_slip(const VoidageSettings& map, double cell) {
  Rise rise;
  rise.cells = {9, 18, 9};
  rise.size = cell * Vector3(9, 18, 9);
  rise.inflow = slip;
  rise.window = 0.5 * cell / slip;
  Scene scene = scene_of(rise, map);
  scene.scene.gravity = Vector3::Zero();
  scene.particles.backend = ParticleBackend::kinematic;
  scene.particles.materials["glass"].density = density;
  const ParticleState sphere = single_sphere(0.5 * rise.size, Vector3::Zero(), diameter, density);
  Coupled coupled(
      scene, [&](const Scene& s, const Mesh& m) { return make_kinematic_engine(s, m, sphere); });
  for (int step = 0; step < 80; ++step) coupled.advance();
  const double stokes = 3 * std::numbers::pi * viscosity * diameter;
  return 1 - coupled.impulse_given().y() / (rise.window * stokes * slip);
}

TEST(SelfDisturbance, by_map_and_size_of_the_cells) {
  fmt::print(
      "share of the slip that a sphere in a channel of 9 x 9 cells does not see; by edge of the "
      "cells\n");
  for (const double cells_wide : {2.0, 4.0}) {
    for (const auto& [name, map] : all_maps(1)) {
      const bool wide = map.map == VoidageMap::kernel || map.map == VoidageMap::diffusion;
      if (!wide && cells_wide > 2) continue;
      fmt::print("{:>10}{}:", name, wide ? fmt::format(", {} cells wide", cells_wide) : "");
      for (const double diameters : {1.0, 2.0, 5.0, 10.0}) {
        VoidageSettings settings = map;
        settings.width = cells_wide * diameters * diameter;
        const double unseen = unseen_slip(settings, diameters * diameter);
        fmt::print("  {:.0f} d: {:.2e}", diameters, unseen);
        EXPECT_GT(unseen, 0) << name;  // the fluid gives way
        if (cells_wide > 2 && diameters >= 5) {
          EXPECT_LE(unseen, 5e-3) << name;
        }
      }
      fmt::print("\n");
    }
  }
}

}  // namespace
}  // namespace fluxpact
