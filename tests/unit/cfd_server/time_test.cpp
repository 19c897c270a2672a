// Time: inner steps of a window, the second-order scheme, and that both balance mass exactly.
#include <gtest/gtest.h>

#include "cfd_server/vans/inner_steps.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

/// A box with inlet and outlet, and a cluster with sharp edges that moves through it.
FluidCase moving_cluster_case(bool open) {
  FluidCase c({8, 2, 12}, {0.08, 0.02, 0.12});
  if (open) {
    c.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
    c.side("outlet", Side::z_max, pressure_outlet());
    c.scene.fluid.initial.superficial = Vector3(0, 0, 1);
  } else {
    c.scene.fluid.mesh.periodic = {Axis::z};
  }
  c.scene.fluid.numerics.pressure_tolerance = 1e-4;
  c.make_mesh();
  return c;
}

/// ε = 0.45 in a slab one third of the height that moves at `speed`; the sum stays the same.
Solids cluster(const FluidCase& c, double time, double speed, double drag) {
  Solids solids(c.mesh);
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    const double cells_up = c.mesh.cell_centres[cell].z() / 0.01 - 0.5;
    const double front = speed * time / 0.01;
    double inside = 0;  // overlap of the cell with the slab, in cells
    for (const double lap : {-12.0, 0.0, 12.0}) {
      const double low = std::max(cells_up, std::fmod(front, 12.0) + lap);
      const double high = std::min(cells_up + 1, std::fmod(front, 12.0) + lap + 4);
      inside += std::max(0.0, high - low);
    }
    solids.voidage[cell] = 1 - 0.55 * inside;
    solids.drag[cell] = drag * inside * c.mesh.cell_volumes[cell];
    solids.source[cell] = solids.drag[cell] * Vector3(0, 0, speed);
  }
  return solids;
}

struct TimeCase {
  const char* name;
  bool open;
  TimeScheme time;
  double courant_limit;
};

class ClosedWindow : public ::testing::TestWithParam<TimeCase> {};

TEST_P(ClosedWindow, balances_mass_in_every_cell) {
  const TimeCase& p = GetParam();
  FluidCase c = moving_cluster_case(p.open);
  c.scene.fluid.numerics.time = p.time;
  c.scene.fluid.numerics.courant_limit = p.courant_limit;
  const double window = 2e-3;
  VansSolver solver(c.scene, c.mesh);
  std::vector<double> before = cluster(c, 0, 0.5, 2000).voidage;
  solver.start(before);
  int inner = 0;
  int second_order = 0;
  for (int step = 1; step <= 40; ++step) {
    const Solids solids = cluster(c, step * window, 0.5, 2000);
    run_window(solver, solids, step, window);
    inner += solver.report().inner_steps;
    second_order += solver.report().second_order_steps;
    const Balance balance =
        balance_of(c.mesh, c.scene.fluid.density, before, solver.committed(), window);
    // Each flux is rounded once; some twenty of its sizes meet in a cell, all of the order of
    // ρV/Δt.
    EXPECT_LE(balance.largest_residual, 2e-14) << "window " << step;
    EXPECT_LE(std::abs(balance.relative_imbalance), 1e-13) << "window " << step;
    before = solids.voidage;
  }
  EXPECT_EQ(inner > 40, p.courant_limit < 1);
  EXPECT_EQ(second_order > 30, p.time == TimeScheme::bdf2);
}

INSTANTIATE_TEST_SUITE_P(
    Of, ClosedWindow,
    ::testing::Values(TimeCase{"euler", true, TimeScheme::euler, 5},
                      TimeCase{"euler_inner_steps", true, TimeScheme::euler, 0.1},
                      TimeCase{"bdf2", true, TimeScheme::bdf2, 5},
                      TimeCase{"bdf2_inner_steps", true, TimeScheme::bdf2, 0.1},
                      TimeCase{"closed_bdf2", false, TimeScheme::bdf2, 50},
                      TimeCase{"closed_inner_steps", false, TimeScheme::euler, 0.01}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(InnerSteps, are_the_windows_of_a_finer_run) {
  FluidCase c = moving_cluster_case(true);
  c.scene.fluid.numerics.pressure_tolerance = 1e-12;
  const Solids start = cluster(c, 0, 0.5, 500);
  Solids end = cluster(c, 2e-3, 0.5, 500);
  FluidCase coarse = c;
  coarse.scene.fluid.numerics.courant_limit = 0.15;
  VansSolver solver(coarse.scene, coarse.mesh);
  solver.start(start.voidage);
  run_window(solver, end, 1, 2e-3);
  const int count = solver.report().inner_steps;
  ASSERT_GT(count, 1);
  c.scene.fluid.numerics.courant_limit = 50;
  VansSolver fine(c.scene, c.mesh);
  fine.start(start.voidage);
  std::vector<Vector3> mean(end.voidage.size(), Vector3::Zero());
  Solids between = end;
  for (int step = 1; step <= count; ++step) {
    interpolate_voidage(start.voidage, end.voidage, step, count, between.voidage);
    run_window(fine, between, step, 2e-3 / count);
    for (std::size_t cell = 0; cell < mean.size(); ++cell)
      mean[cell] += fine.committed().velocity[cell] / count;
  }
  EXPECT_EQ(fine.committed().velocity, solver.committed().velocity);
  EXPECT_EQ(fine.committed().face_flux, solver.committed().face_flux);
  for (std::size_t cell = 0; cell < mean.size(); ++cell) {
    EXPECT_LE((window_velocity(solver.committed())[cell] - mean[cell]).norm(), 1e-14);
  }
}

TEST(InnerSteps, too_many_are_refused_with_the_window_that_would_do) {
  FluidCase c = moving_cluster_case(true);
  c.scene.fluid.numerics.courant_limit = 1e-5;
  VansSolver solver(c.scene, c.mesh);
  const Solids solids(c.mesh);
  solver.start(solids.voidage);
  try {
    run_window(solver, solids, 3, 1e-2);
    FAIL();
  } catch (const NumericsError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("step 3"), std::string::npos) << text;
    EXPECT_NE(text.find("coupling.window of 1e-07 s"), std::string::npos) << text;
  }
}

/// Largest change of the velocity from `outer` to `outer` + 1 outer iterations in one long step.
double change_by_outer_iteration(int outer) {
  FluidCase c = moving_cluster_case(true);
  c.scene.fluid.numerics.pressure_tolerance = 1e-10;
  c.scene.fluid.numerics.courant_limit = 50;
  const Solids solids = cluster(c, 0, 0.5, 20);
  const auto run = [&](int iterations) {
    c.scene.fluid.numerics.outer_iterations = iterations;
    VansSolver solver(c.scene, c.mesh);
    solver.start(solids.voidage);
    run_window(solver, solids, 1, 2e-2);
    return solver.committed();
  };
  const FluidState one = run(outer);
  const FluidState other = run(outer + 1);
  double change = 0;
  for (std::size_t cell = 0; cell < one.velocity.size(); ++cell)
    change = std::max(change, (one.velocity[cell] - other.velocity[cell]).norm());
  return change;
}

TEST(OuterIterations, converge_to_a_flux_that_convects_itself) {
  const double first = change_by_outer_iteration(1);
  EXPECT_GT(first, 1e-4);  // m/s; the flow is about 1 m/s
  EXPECT_LT(change_by_outer_iteration(8), 0.1 * first);
}

TEST(SecondOrder, falls_back_where_a_front_crosses_half_a_cell) {
  FluidCase c = moving_cluster_case(true);
  c.scene.fluid.numerics.time = TimeScheme::bdf2;
  c.scene.fluid.numerics.courant_limit = 50;
  VansSolver solver(c.scene, c.mesh);
  const auto front_at = [&](double cells) { return cluster(c, cells, 0.01, 0); };
  solver.start(front_at(3).voidage);
  run_window(solver, front_at(3), 1, 1e-3);
  EXPECT_EQ(solver.report().second_order_steps, 0);  // one old level only
  run_window(solver, front_at(3.4), 2, 1e-3);
  EXPECT_EQ(solver.report().second_order_steps, 1);
  run_window(solver, front_at(4), 3, 1e-3);
  EXPECT_EQ(solver.report().second_order_steps, 0);
  run_window(solver, front_at(4.1), 4, 1e-3);
  EXPECT_EQ(solver.report().second_order_steps, 1);
}

TEST(SecondOrder, coefficients_differentiate_parabolas_exactly) {
  const TimeCoefficients time = backward_two_steps(0.3, 0.5);
  const auto q = [](double t) { return 2 + 3 * t - 4 * t * t; };
  EXPECT_NEAR((time.now * q(1) - time.last * q(0.7) + time.before * q(0.2)) / time.step, -5, 1e-13);
}

}  // namespace
}  // namespace fluxpact
