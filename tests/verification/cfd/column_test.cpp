// One-dimensional columns with exact answers: voidage jumps, drag, rest, inlets.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

/// Left half at one voidage, right half at another.
void set_jump(const FluidCase& c, Solids& solids, double left, double right) {
  const double middle = 0.5 * c.scene.fluid.mesh.box.upper.x();
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    solids.voidage[cell] = c.mesh.cell_centres[cell].x() < middle ? left : right;
  }
}

FluidState steady_column(const FluidCase& c, const Solids& solids, double window, int steps) {
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= steps; ++step) run_window(solver, solids, step, window);
  return solver.committed();
}

TEST(Column, passes_on_all_mass_through_a_voidage_jump) {
  const FluidCase c = column(20, 0.2, 1.0);
  Solids solids(c.mesh);
  set_jump(c, solids, 0.42, 1.0);
  const FluidState state = steady_column(c, solids, 1e-3, 200);
  const Balance balance = balance_of(c.mesh, c.scene.fluid.density, solids.voidage, state, 1e-3);
  EXPECT_NEAR(balance.outflow / balance.inflow, 1.0, 1e-13);  // each flux is rounded once
}

class LegacyJump : public ::testing::TestWithParam<LegacyVelocity> {};

TEST_P(LegacyJump, loses_mass_as_calculated) {
  // Only the two cells beside the jump have a gradient. There Λ_e − Λ_w = −(ε_e − ε_w)/ε_P u_P, u_P
  // = (Λ_w + Λ_e)/2 by faces, (ε_w Λ_w + ε_e Λ_e)/(2 ε_P) by cells.
  const bool faces = GetParam() == LegacyVelocity::faces;
  const auto ratio = [faces](double west, double own, double east) {
    const double k = (east - west) / (2 * own);
    return faces ? (1 - k) / (1 + k) : (1 - k * west / own) / (1 + k * east / own);
  };
  const double expected = ratio(0.42, 0.42, 0.71) * ratio(0.71, 1.0, 1.0) / 0.42;
  ASSERT_NEAR(expected, faces ? 0.8654 : 0.77125, 5e-5);
  FluidCase c = column(20, 0.2, 1.0);
  c.scene.coupling.continuity = Continuity::legacy;
  c.scene.fluid.numerics.legacy = {1e-9, 100, GetParam()};
  Solids solids(c.mesh);
  set_jump(c, solids, 0.42, 1.0);
  const FluidState state = steady_column(c, solids, 1e-3, 200);
  const Balance balance = balance_of(c.mesh, c.scene.fluid.density, solids.voidage, state, 1e-3);
  // The lagged source is converged to 1e-9 of the flux, the contraction is about 1/2.
  EXPECT_NEAR(balance.outflow / balance.inflow, expected, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Velocity, LegacyJump,
                         ::testing::Values(LegacyVelocity::faces, LegacyVelocity::cells));

class DragJump : public ::testing::TestWithParam<double> {};

TEST_P(DragJump, has_the_exact_velocity_and_pressure_drop) {
  // Bed of ε = 0.4 between free ends; x = B Δt/(ρ ε V).
  const double x = GetParam();
  const double window = 1e-3;
  FluidCase c = column(40, 0.4, 1.0);
  c.scene.fluid.viscosity = 0;
  Solids solids(c.mesh);
  const double volume = c.mesh.cell_volumes[0];
  for (int cell = 10; cell < 30; ++cell) {
    solids.voidage[cell] = 0.4;
    solids.drag[cell] = x * c.scene.fluid.density * 0.4 * volume / window;
  }
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= 2000; ++step) run_window(solver, solids, step, window);
  const FluidState& state = solver.committed();
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    // Closed fluxes are exact; u is rebuilt from them.
    EXPECT_NEAR(state.voidage[cell] * state.velocity[cell].x(), 1.0, 1e-11) << "cell " << cell;
  }
  // Within the bed: ε dp/dx = −B u/V, u = 1/ε. Inertia adds at most a few ρ u² at the two jumps.
  const double slope = solids.drag[15] / volume / 0.4 / 0.4;
  const double inertia = 3 * c.scene.fluid.density / (0.4 * 0.4);
  EXPECT_NEAR(state.pressure[0] - state.pressure[39], slope * 0.2, inertia);
  EXPECT_NEAR(state.pressure_gradient[20].x(), -slope, 1e-9 * slope + 1e-9);
  EXPECT_NEAR((state.pressure[19] - state.pressure[20]) / 0.01, slope, 1e-9 * slope + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Strength, DragJump, ::testing::Values(0.45, 452.0));

TEST(UniformBed, has_the_pressure_gradient_of_the_drag_law) {
  // Ergun drag recomputed from the last velocity, as the particle side would; ε = 0.45, d = 2 mm.
  const double voidage = 0.45;
  const double diameter = 2e-3;
  FluidCase c = column(20, 0.1, 1.0);
  c.scene.fluid.viscosity = 1.8e-5;
  Solids solids(c.mesh, voidage);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  const auto exchange = [&](double speed) {
    const double solid = 1 - voidage;
    return 150 * solid * solid * 1.8e-5 / (voidage * diameter * diameter) +
           1.75 * solid * c.scene.fluid.density * speed / diameter;
  };
  for (int step = 1; step <= 300; ++step) {
    for (int cell = 0; cell < c.mesh.cells(); ++cell) {
      solids.drag[cell] =
          exchange(solver.committed().velocity[cell].norm()) * c.mesh.cell_volumes[cell];
    }
    run_window(solver, solids, step, 1e-3);
  }
  const double expected = -exchange(1.0 / voidage) / voidage / voidage;
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    const double got = solver.committed().pressure_gradient[cell].x();
    EXPECT_NEAR(got / expected, 1.0, 1e-10) << "cell " << cell;
  }
}

TEST(Inlets, jet_and_background_and_mass_flow_give_exactly_what_is_asked) {
  FluidCase c({10, 2, 6}, {0.1, 0.02, 0.06});
  c.scene.fluid.mesh.patches.push_back({"jet", {Side::z_min, {std::array{0.04, 0.06}, {}, {}}}});
  c.side("background", Side::z_min, superficial_inlet({0, 0, 0.5}));
  c.side("feed", Side::x_min, {});
  c.side("outlet", Side::z_max, pressure_outlet(101325));
  c.scene.fluid.boundaries["jet"] = superficial_inlet({0, 0, 5});
  c.scene.fluid.boundaries["feed"].type = BoundaryType::mass_flow;
  c.scene.fluid.boundaries["feed"].rate = 3e-4;
  c.make_mesh();
  Solids solids(c.mesh, 0.5);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= 20; ++step) run_window(solver, solids, step, 1e-3);
  const auto sum = [&](const std::string& name) {
    const Patch& patch = *c.mesh.find_patch(name);
    CompensatedSum total;
    for (int f = patch.first; f < patch.first + patch.size; ++f)
      total.add(solver.committed().face_flux[f]);
    return total.value();
  };
  // A dozen faces, each rounded a few times.
  EXPECT_NEAR(sum("jet") / (-1.2 * 5 * 0.02 * 0.02), 1, 1e-14);
  EXPECT_NEAR(sum("background") / (-1.2 * 0.5 * 0.08 * 0.02), 1, 1e-14);
  EXPECT_NEAR(sum("feed") / -3e-4, 1, 1e-14);
  EXPECT_NEAR(sum("outlet") + sum("jet") + sum("background") + sum("feed"), 0,
              1e-14 * sum("outlet"));
}

TEST(Inlets, interstitial_velocity_carries_the_voidage_of_the_cell) {
  FluidCase c = column(5, 0.05, 1.0);
  c.scene.fluid.boundaries["inlet"].superficial.reset();
  c.scene.fluid.boundaries["inlet"].interstitial = Vector3(2, 0, 0);
  Solids solids(c.mesh, 0.6);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  run_window(solver, solids, 1, 1e-3);
  const Patch& inlet = *c.mesh.find_patch("inlet");
  EXPECT_NEAR(solver.committed().face_flux[inlet.first], -1.2 * 0.6 * 2 * 1e-4, 1e-18);
}

/// Largest |u| after some windows at rest: a bed with a sharp surface under gravity.
double largest_speed_at_rest(FluidCase& c, double outlet_pressure_level) {
  c.scene.scene.gravity = Vector3(0, 0, -9.81);
  c.make_mesh();
  Solids solids(c.mesh);
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    if (c.mesh.cell_centres[cell].z() > 0.03 || c.mesh.cell_centres[cell].x() > 0.03) continue;
    solids.voidage[cell] = 0.4;
    solids.drag[cell] = 1000 * c.mesh.cell_volumes[cell];
  }
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= 50; ++step) run_window(solver, solids, step, 1e-3);
  double largest = 0;
  for (const Vector3& u : solver.committed().velocity) largest = std::max(largest, u.norm());
  for (const double p : solver.committed().pressure)
    EXPECT_NEAR(p, outlet_pressure_level, 1e-9 * 101325);
  return largest;
}

TEST(Rest, stays_at_rest_in_a_closed_box_and_under_an_outlet) {
  FluidCase closed({6, 1, 6}, {0.06, 0.01, 0.06});
  EXPECT_LE(largest_speed_at_rest(closed, 0), 1e-13);
  FluidCase open({6, 1, 6}, {0.06, 0.01, 0.06});
  open.side("outlet", Side::z_max, pressure_outlet(101325));
  EXPECT_LE(largest_speed_at_rest(open, 101325 + 1.2 * 9.81 * 0.06), 1e-13);
}

TEST(UniformBed, is_exact_on_a_perturbed_mesh) {
  // Uniform drag, uniform flow, linear pressure: exact on any mesh if gradients, reconstruction and
  // the non-orthogonal part of the pressure flux are.
  FluidCase c({6, 4, 8}, {0.06, 0.04, 0.08});
  c.scene.fluid.mesh.periodic = {Axis::x, Axis::y};
  c.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
  c.side("outlet", Side::z_max, pressure_outlet(50));
  c.scene.fluid.initial.superficial = Vector3(0, 0, 1);
  c.make_mesh();
  c.mesh = perturbed(c.mesh, {0.01, 0.01, 0.01}, 0.15, 5);
  Solids solids(c.mesh, 0.45);
  for (int cell = 0; cell < c.mesh.cells(); ++cell)
    solids.drag[cell] = 2000 * c.mesh.cell_volumes[cell];
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= 400; ++step) run_window(solver, solids, step, 1e-3);
  const double slope = 2000 / 0.45 / 0.45;
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    const FluidState& state = solver.committed();
    // The lagged non-orthogonal part and the pressure solver (1e-12) settle to about 1e-10.
    EXPECT_LE((state.velocity[cell] * 0.45 - Vector3(0, 0, 1)).norm(), 1e-9) << "cell " << cell;
    EXPECT_LE((state.pressure_gradient[cell] + Vector3(0, 0, slope)).norm(), 1e-9 * slope);
    EXPECT_NEAR(state.pressure[cell], 50 + slope * (0.08 - c.mesh.cell_centres[cell].z()),
                1e-9 * slope);
  }
}

/// A bed of ε = 0.4 at B Δt/(ρ ε V) = 1e4 with a sharp bubble whose lowest cell layer is `first`.
Solids bed_with_bubble(const FluidCase& c, int first, double window) {
  Solids solids(c.mesh);
  const double spacing = 0.01;
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    const Vector3& x = c.mesh.cell_centres[cell];
    const double across = (x.x() - 0.08) / spacing;
    const double up = x.z() / spacing - first - 4;
    if (across * across + up * up < 16) continue;
    solids.voidage[cell] = 0.4;
    solids.drag[cell] = 1e4 * c.scene.fluid.density * 0.4 * c.mesh.cell_volumes[cell] / window;
    solids.source[cell] = solids.drag[cell] * Vector3(0, 0, 1);
  }
  return solids;
}

TEST(Front, stays_bounded_when_it_crosses_a_cell_a_window_through_strong_drag) {
  const double window = 0.01;
  FluidCase c({16, 1, 40}, {0.16, 0.01, 0.4});
  c.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
  c.side("outlet", Side::z_max, pressure_outlet());
  c.scene.fluid.boundaries["walls"] = wall(Slip::free);
  c.scene.fluid.initial.superficial = Vector3(0, 0, 1);
  c.make_mesh();
  VansSolver solver(c.scene, c.mesh);
  solver.start(bed_with_bubble(c, 2, window).voidage);
  double largest = 0;
  for (int step = 1; step <= 28; ++step) {
    run_window(solver, bed_with_bubble(c, 2 + step, window), step, window);
    for (const Vector3& u : solver.committed().velocity) largest = std::max(largest, u.norm());
  }
  fmt::print("bubble through stiff drag, one cell a window: at most {:.1f} m/s\n", largest);
  EXPECT_LT(largest,
            30.0);  // some 10 times the inlet's 1 m/s over ε is what such a front calls for
}

}  // namespace
}  // namespace fluxpact
