// Values at the boundary: formulas, tables, ramps, mass flow with a shape, moving and slipping
// walls.
#include <gtest/gtest.h>

#include "cfd_server/vans/boundary_conditions.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"

namespace fluxpact {
namespace {

Formula formula(const char* text) {
  Formula result;
  result.text = text;
  return result;
}

BoundaryValues values_at(const FluidCase& c, double time, double voidage = 1) {
  const Stencil stencil = make_stencil(c.mesh);
  const BoundaryConditions conditions = read_boundaries(c.scene, c.mesh, stencil);
  BoundaryValues values;
  const std::vector<double> all(c.mesh.cell_volumes.size(), voidage);
  update_boundary_values(stencil, conditions, all, 0, values);
  update_boundary_values(stencil, conditions, all, time, values);
  return values;
}

double outflow(const FluidCase& c, const BoundaryValues& values, const char* patch) {
  const Patch* faces = c.mesh.find_patch(patch);
  double sum = 0;
  for (int f = faces->first; f < faces->first + faces->size; ++f)
    sum += values.flux[f - c.mesh.internal_faces()];
  return sum;
}

TEST(Profile, tables_are_linear_between_their_points_and_constant_beyond) {
  const std::vector<std::array<double, 2>> points{{0, 1}, {2, 5}, {3, 0}};
  EXPECT_EQ(interpolate(points, -1), 1);
  EXPECT_EQ(interpolate(points, 0), 1);
  EXPECT_EQ(interpolate(points, 0.5), 2);
  EXPECT_EQ(interpolate(points, 2), 5);
  EXPECT_EQ(interpolate(points, 2.25), 3.75);
  EXPECT_EQ(interpolate(points, 4), 0);
}

TEST(Profile, formulas_tables_and_ramp_multiply) {
  FluidCase c({1, 1, 4}, {1, 1, 1});
  BoundarySettings inlet;
  inlet.type = BoundaryType::velocity;
  inlet.superficial = VectorFormula();
  inlet.superficial->components[0] = formula("2*z + t");
  inlet.profile = {{Along::z, {{0, 0}, {1, 1}}}, {Along::time, {{0, 1}, {4, 3}}}};
  inlet.ramp = 4;
  c.side("inlet", Side::x_min, inlet);
  c.side("outlet", Side::x_max, pressure_outlet());
  c.make_mesh();
  const BoundaryValues values = values_at(c, 2);
  const int first = c.mesh.find_patch("inlet")->first - c.mesh.internal_faces();
  for (int i = 0; i < 4; ++i) {
    const double z = 0.125 + 0.25 * i;
    // formula × table along z × table along time at 2 s × half of the ramp
    EXPECT_NEAR(values.velocity[first + i].x(), (2 * z + 2) * z * 2 * 0.5, 1e-15);
  }
}

TEST(Profile, pressure_follows_its_formula_in_time) {
  FluidCase c({1, 1, 1}, {1, 1, 1});
  BoundarySettings outlet = pressure_outlet();
  outlet.value = formula("10 + 3*t");
  c.side("outlet", Side::x_max, outlet);
  c.make_mesh();
  const int face = c.mesh.find_patch("outlet")->first - c.mesh.internal_faces();
  EXPECT_NEAR(values_at(c, 2).pressure[face] - values_at(c, 0).pressure[face], 6, 1e-14);
}

TEST(Profile, mass_flow_keeps_its_total_whatever_its_shape) {
  FluidCase c({1, 1, 7}, {1, 1, 1});
  BoundarySettings feed;
  feed.type = BoundaryType::mass_flow;
  feed.rate = formula("0.3*t");
  feed.profile = {{Along::z, {{0, 0}, {0.3, 2}, {1, 0.5}}}};
  c.side("feed", Side::x_min, feed);
  c.side("outlet", Side::x_max, pressure_outlet());
  c.make_mesh();
  const BoundaryValues values = values_at(c, 2, 0.5);
  // Inflow is negative; seven terms of one rounding each.
  EXPECT_NEAR(c.scene.fluid.density * outflow(c, values, "feed"), -0.6, 1e-15);
  const int first = c.mesh.find_patch("feed")->first - c.mesh.internal_faces();
  EXPECT_GT(values.flux[first], values.flux[first + 2]);  // less at the edge than near z = 0.3
}

/// What the first use of these conditions says against them.
std::string refusal(const FluidCase& c, double time) {
  try {
    values_at(c, time);
  } catch (const NumericsError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Profile, formulas_without_a_finite_value_are_refused_with_patch_place_and_time) {
  FluidCase c({1, 1, 1}, {1, 1, 1});
  BoundarySettings inlet;
  inlet.type = BoundaryType::velocity;
  inlet.superficial = VectorFormula();
  inlet.superficial->components[0] = formula("sqrt(1 - t)");
  BoundarySettings outlet = pressure_outlet();
  outlet.value = formula("log(2 - t)");
  c.side("inlet", Side::x_min, inlet);
  c.side("outlet", Side::x_max, outlet);
  c.make_mesh();
  EXPECT_EQ(refusal(c, 0.5), "no error");
  EXPECT_NE(refusal(c, 1.5).find("fluid.boundaries.inlet has no finite value at (0, 0.5, 0.5) m, "
                                 "t = 1.5 s"),
            std::string::npos)
      << refusal(c, 1.5);
  c.scene.fluid.boundaries["inlet"].superficial->components[0] = 1.0;
  EXPECT_NE(refusal(c, 3).find("fluid.boundaries.outlet has no finite value"), std::string::npos)
      << refusal(c, 3);
}

TEST(Profile, mass_flow_without_a_positive_shape_is_refused) {
  FluidCase c({1, 1, 2}, {1, 1, 1});
  BoundarySettings feed;
  feed.type = BoundaryType::mass_flow;
  feed.rate = 1.0;
  feed.profile = {{Along::z, {{0, 0}, {1, 0}}}};
  c.side("feed", Side::x_min, feed);
  c.side("outlet", Side::x_max, pressure_outlet());
  c.make_mesh();
  EXPECT_THROW(values_at(c, 0), ConfigError);
}

/// Flow along x between a wall at rest (z = 0) and one that moves at 1 m/s; the lower one slips.
double slip_profile_error(Slip slip, double slip_length) {
  FluidCase c({1, 1, 8}, {0.1, 0.1, 1});
  c.scene.fluid.density = 1;
  c.scene.fluid.viscosity = 1;
  c.scene.fluid.mesh.periodic = {Axis::x, Axis::y};
  BoundarySettings lower = wall(slip);
  lower.slip_length = slip_length;
  BoundarySettings upper = wall(Slip::none);
  upper.velocity = Vector3(1, 0, 0.5);  // the part normal to the wall is left out
  c.side("lower", Side::z_min, lower);
  c.side("upper", Side::z_max, upper);
  c.make_mesh();
  const Solids solids(c.mesh);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  for (int step = 1; step <= 60; ++step) run_window(solver, solids, step, 1.0);
  double error = 0;
  for (int cell = 0; cell < c.mesh.cells(); ++cell) {
    const double z = c.mesh.cell_centres[cell].z();
    const double exact = slip == Slip::free ? 1 : (z + slip_length) / (1 + slip_length);
    error = std::max(error, (solver.committed().velocity[cell] - Vector3(exact, 0, 0)).norm());
  }
  return error;
}

TEST(Walls, moving_and_slipping_give_the_exact_linear_profile) {
  // Linear profiles are exact in the discretisation; sixty windows of one diffusion time bring the
  // start down to rounding (implicit Euler: a factor of at least 3.4 a window). What is left is the
  // predictor's tolerance, 1e-10.
  EXPECT_LE(slip_profile_error(Slip::none, 0), 1e-9);
  EXPECT_LE(slip_profile_error(Slip::partial, 0.1), 1e-9);
  EXPECT_LE(slip_profile_error(Slip::partial, 0.5), 1e-9);
  EXPECT_LE(slip_profile_error(Slip::free, 0), 1e-9);
}

}  // namespace
}  // namespace fluxpact
