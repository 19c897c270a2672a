// The scalars of a scene: formulas, heat in its units, inner steps, refusals.
#include "cfd_server/scalars/fluid_scalars.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/rough_flow.hpp"

namespace fluxpact {
namespace {

/// Still fluid between two walls.
FluidCase still_box() {
  FluidCase box({4, 1, 1}, {0.04, 0.01, 0.01});
  box.scene.fluid.mesh.periodic = {Axis::y, Axis::z};
  box.side("left", Side::x_min, wall(Slip::none));
  box.side("right", Side::x_max, wall(Slip::none));
  box.make_mesh();
  return box;
}

ScalarSettings heat() {
  ScalarSettings settings;
  settings.kind = ScalarKind::temperature;
  settings.conductivity = 0.026;
  settings.heat_capacity = 1000;
  settings.initial = Formula(300);
  return settings;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(FluidScalars, of_heat_take_watts_and_warm_by_the_heat_capacity) {
  FluidCase box = still_box();
  ScalarSettings settings = heat();
  settings.boundaries["left"].flux = Formula(500);  // W/m² on 1e-4 m²
  settings.source = Formula(2000);                  // W/m³ of fluid
  box.scene.fluid.scalars["heat"] = settings;
  VansSolver solver(box.scene, box.mesh);
  const Solids solids(box.mesh, 0.5);
  solver.start(solids.voidage);
  for (int step = 1; step <= 10; ++step) run_window(solver, solids, step, 0.1);
  const ScalarField& field = solver.scalars()->committed(0);
  EXPECT_NEAR(sum(field.boundary_flux), -0.05, 1e-14);
  // Half of 4e-6 m³ is fluid.
  EXPECT_NEAR(field.source, 4e-3, 1e-15);
  const double mass = 1.2 * 0.5 * 1e-6;
  EXPECT_NEAR(sum(field.value) - 4 * 300, (0.05 + 4e-3) / (1000 * mass), 1e-8);
  EXPECT_GT(field.value[0], field.value[3]);
}

TEST(FluidScalars, follow_formulas_in_place_and_time) {
  FluidCase c = column(10, 0.1, 1);
  ScalarSettings& tracer = c.scene.fluid.scalars["tracer"];
  tracer.initial.text = "10 * x";
  tracer.boundaries["inlet"].value = Formula();
  tracer.boundaries["inlet"].value->text = "t > 0.0015 ? 5 : 0";
  VansSolver solver(c.scene, c.mesh);
  const Solids solids(c.mesh);
  solver.start(solids.voidage);
  EXPECT_NEAR(solver.scalars()->committed(0).value[3], 0.35, 1e-14);
  run_window(solver, solids, 1, 1e-3);
  // 1.2 kg/m³ · 1 m/s · 1e-4 m² of fluid a second.
  EXPECT_NEAR(solver.scalars()->committed(0).boundary_flux[0], 0, 1e-20);
  run_window(solver, solids, 2, 1e-3);
  double in = 0;
  for (const double flux : solver.scalars()->committed(0).boundary_flux) in -= std::min(flux, 0.0);
  EXPECT_NEAR(in, 5 * 1.2e-4, 1e-15);
}

TEST(FluidScalars, move_with_every_inner_step_and_with_second_order_time) {
  for (const TimeScheme scheme : {TimeScheme::euler, TimeScheme::bdf2}) {
    FluidCase c = column(20, 0.2, 1);
    c.scene.fluid.numerics.time = scheme;
    c.scene.fluid.numerics.courant_limit = 0.25;
    ScalarSettings& tracer = c.scene.fluid.scalars["tracer"];
    tracer.boundaries["inlet"].value = Formula(1);
    c.scene.fluid.scalars["uniform"].initial = Formula(1);
    c.scene.fluid.scalars["uniform"].boundaries["inlet"].value = Formula(1);
    VansSolver solver(c.scene, c.mesh);
    Solids solids(c.mesh);
    const auto move = [&](double t) {
      for (int cell = 0; cell < c.mesh.cells(); ++cell) {
        const double x = c.mesh.cell_centres[cell].x();
        solids.voidage[cell] = 0.7 + 0.2 * std::sin(60 * x - 40 * t);
      }
    };
    move(0);
    solver.start(solids.voidage);
    double inside = 0;
    for (int step = 1; step <= 30; ++step) {
      move(step * 0.01);
      run_window(solver, solids, step, 0.01);
      EXPECT_GE(solver.report().inner_steps, 4);
      const ScalarField& field = solver.scalars()->committed(0);
      double now = 0;
      for (int cell = 0; cell < c.mesh.cells(); ++cell)
        now += 1.2 * solids.voidage[cell] * c.mesh.cell_volumes[cell] * field.value[cell];
      EXPECT_NEAR(now - inside + 0.01 * sum(field.boundary_flux), 0, 1e-14 * now) << step;
      inside = now;
      for (const double value : solver.scalars()->committed(1).value) EXPECT_EQ(value, 1);
    }
  }
}

TEST(FluidScalars, diffuse_by_eddies_over_the_schmidt_number) {
  const RoughFlow flow(1);
  const ScalarBoundary boundary = same_everywhere(flow.stencil, ScalarFace::value, 0);
  const std::vector<double> ones(static_cast<std::size_t>(flow.stencil.cells), 1.0);
  const std::vector<double> eddy(ones.size(), 0.6);
  std::vector<double> conductance(static_cast<std::size_t>(flow.stencil.faces));
  diffusive_conductance(flow.stencil, boundary, ones, 0.1, eddy, 2.0, conductance);
  for (int f = 0; f < flow.stencil.faces; ++f)
    EXPECT_NEAR(conductance[f], (0.1 + 0.3) * flow.stencil.conductance[f], 1e-15);
}

TEST(FluidScalars, refuse_a_formula_without_a_finite_value) {
  FluidCase box = still_box();
  ScalarSettings settings = heat();
  settings.initial.text = "1 / (x - x)";
  box.scene.fluid.scalars["heat"] = settings;
  VansSolver solver(box.scene, box.mesh);
  try {
    solver.start(Solids(box.mesh).voidage);
    FAIL() << "no error";
  } catch (const NumericsError& error) {
    EXPECT_NE(std::string(error.what()).find("fluid.scalars.heat.initial"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace fluxpact
