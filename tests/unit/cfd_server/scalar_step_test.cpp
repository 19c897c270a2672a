// What the transport of a scalar promises for any closed flow: uniform stays uniform, nothing is
// lost, no new extremum.
#include "cfd_server/scalars/scalar_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "proto/base/errors.hpp"
#include "proto/scene/names.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"
#include "tests/unit/cfd_server/rough_flow.hpp"

namespace fluxpact {
namespace {

class AnyScheme : public ::testing::TestWithParam<Convection> {};

std::string scheme_name(const ::testing::TestParamInfo<Convection>& param) {
  return std::string(name_of(param.param));
}

INSTANTIATE_TEST_SUITE_P(Schemes, AnyScheme,
                         ::testing::Values(Convection::upwind, Convection::linear_upwind,
                                           Convection::limited),
                         scheme_name);

TEST_P(AnyScheme, keeps_a_uniform_field_to_the_last_bit_in_a_rough_flow) {
  RoughFlow flow(1);
  ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::value, 0.3), GetParam(),
                    1e-10);
  std::ranges::fill(tracer.value, 0.3);
  for (int step = 0; step < 100; ++step) {
    flow.renew(2);
    tracer.set_diffusion(1e-3, flow.voidage);
    tracer.advance(flow.step());
    for (const double value : tracer.value) ASSERT_EQ(value, 0.3) << step;
  }
}

TEST_P(AnyScheme, makes_no_new_extremum_of_a_step_in_a_rough_flow) {
  for (const double courant : {0.1, 1.0, 20.0}) {
    RoughFlow flow(2);
    ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::backflow, 0.5),
                      GetParam(), 1e-14);
    for (int cell = 0; cell < flow.stencil.cells; ++cell)
      tracer.value[cell] = flow.stencil.centre[cell].x() < 0.025 ? 1.0 : 0.0;
    for (int step = 0; step < 100; ++step) {
      flow.renew(courant);
      tracer.advance(flow.step());
      const auto [low, high] = std::ranges::minmax(tracer.value);
      // The solver's tolerance times the change of a step (at most 1), and rounding of 100 steps.
      ASSERT_GE(low, -1e-12) << courant << ' ' << step;
      ASSERT_LE(high, 1 + 1e-12) << courant << ' ' << step;
    }
  }
}

TEST_P(AnyScheme, loses_nothing_at_any_tolerance_of_the_solver) {
  for (const double tolerance : {1e-1, 1e-2, 1e-4, 1e-8}) {
    RoughFlow flow(3);
    ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::value, 2.0),
                      GetParam(), tolerance);
    tracer.source.assign(static_cast<std::size_t>(flow.stencil.cells), 0.0);
    for (int cell = 0; cell < flow.stencil.cells; ++cell) {
      tracer.value[cell] = flow.uniform(0, 1);
      tracer.source[cell] = flow.uniform(0, 1e-4);
    }
    const double source =
        std::accumulate(tracer.source.begin(), tracer.source.end(), 0.0) * flow.window;
    for (int step = 0; step < 50; ++step) {
      flow.renew(3);
      tracer.set_diffusion(1e-4, flow.voidage);
      const double before = flow.amount(flow.old_voidage, tracer.value);
      tracer.advance(flow.step());
      const double after = flow.amount(flow.voidage, tracer.value);
      const double net = after - before + tracer.left() * flow.window - source;
      // Rounding of 90 cells and of the fluxes that close them: a few 1e-16 of what is there.
      ASSERT_LE(std::abs(net), 1e-14 * after) << tolerance << ' ' << step;
    }
  }
}

TEST_P(AnyScheme, drifts_where_the_fluxes_do_not_close_but_still_loses_nothing) {
  RoughFlow flow(4);
  ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::value, 1.0), GetParam(),
                    1e-6);
  std::ranges::fill(tracer.value, 1.0);
  flow.renew(1);
  for (double& flux : flow.face_flux) flux *= 1.01;  // a mass error of a per cent
  FluidStep step = flow.step();
  step.closed = false;
  const double before = flow.amount(flow.old_voidage, tracer.value);
  tracer.advance(step);
  const auto [low, high] = std::ranges::minmax(tracer.value);
  EXPECT_GT(high - low, 1e-3);
  const double after = flow.amount(flow.voidage, tracer.value);
  EXPECT_LE(std::abs(after - before + tracer.left() * flow.window), 1e-14 * after);
}

TEST_P(AnyScheme, gives_the_same_steady_state_for_any_window) {
  // Carried in, diffused and eaten up on its way to the outlet: monotone, so nothing is cut.
  const auto steady = [](double window, int steps) {
    RoughFlow flow(5, {4, 1, 12});
    flow.window = window;
    std::ranges::fill(flow.voidage, 0.6);
    flow.old_voidage = flow.voidage;
    std::ranges::fill(flow.storage, 0.0);
    for (int f = 0; f < flow.stencil.faces; ++f) flow.face_flux[f] = 1.2 * flow.stencil.area[f].z();
    close_fluxes(flow.tree, flow.stencil, flow.storage, flow.face_flux);
    ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::backflow, 1.0),
                      GetParam(), 1e-12);
    tracer.set_diffusion(1e-3, flow.voidage);
    tracer.sink.assign(static_cast<std::size_t>(flow.stencil.cells), 0.0);
    for (int cell = 0; cell < flow.stencil.cells; ++cell)
      tracer.sink[cell] = 1e-5 * (1 + 20 * flow.stencil.centre[cell].x());
    for (int step = 0; step < steps; ++step) tracer.advance(flow.step());
    return tracer.value;
  };
  const std::vector<double> slow = steady(2e-3, 1000);
  const std::vector<double> fast = steady(5e-4, 4000);
  EXPECT_LT(slow.back(), 0.8);
  for (std::size_t cell = 0; cell < slow.size(); ++cell) {
    // Both stand at the fixed point of the same equations, to the tolerance of the solver.
    EXPECT_NEAR(slow[cell], fast[cell], 1e-10) << cell;
  }
}

TEST(Diffusion, is_exact_between_held_walls_across_a_jump_of_the_voidage) {
  FluidCase box({10, 1, 1}, {0.1, 0.01, 0.01});
  box.scene.fluid.mesh.periodic = {Axis::y, Axis::z};
  box.make_mesh();
  const Stencil stencil = make_stencil(box.mesh);
  ScalarBoundary ends = same_everywhere(stencil, ScalarFace::value, 0);
  for (int b = 0; b < stencil.boundary_faces(); ++b)
    ends.value[b] = stencil.area[stencil.internal_faces + b].x() < 0 ? 300.0 : 400.0;
  ScalarCase heat(stencil, ends, Convection::limited, 1e-14);
  std::vector<double> voidage(10, 0.4);
  std::fill(voidage.begin() + 5, voidage.end(), 1.0);
  heat.set_diffusion(2.0, voidage);
  const std::vector<double> still(static_cast<std::size_t>(stencil.faces), 0.0);
  for (int step = 0; step < 300; ++step) heat.advance({1.2, 0.01, voidage, voidage, still, true});
  // Resistances in series: 0.05/(0.4 · 2) + 0.05/2 = 0.0875 m s/kg; flux 100/0.0875 · 1e-4 m².
  const double flux = 100 / 0.0875 * 1e-4;
  for (int b = 0; b < stencil.boundary_faces(); ++b) {
    const double sign = ends.value[b] == 400.0 ? -1 : 1;  // it enters at the hot end
    EXPECT_NEAR(heat.boundary_flux[b], sign * flux, 1e-10 * flux);
  }
  EXPECT_NEAR(heat.value[4], 300 + 100 / 0.0875 * 0.045 / 0.8, 1e-9);
}

TEST(Influx, adds_what_it_says) {
  RoughFlow flow(6);
  ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::zero_gradient, 0),
                    Convection::limited, 1e-3);
  tracer.boundary.kind[3] = ScalarFace::influx;
  tracer.boundary.value[3] = 0.25;
  flow.window = 1e-4;
  std::ranges::fill(flow.face_flux, 0.0);
  flow.old_voidage = flow.voidage;
  tracer.advance(flow.step());
  EXPECT_EQ(tracer.left(), -0.25);
  EXPECT_NEAR(flow.amount(flow.voidage, tracer.value), 0.25e-4, 1e-18);
}

TEST(Bounds, hold_on_a_skewed_mesh_with_strong_cross_diffusion) {
  FluidCase box({8, 1, 8}, {1, 0.1, 1});
  box.scene.fluid.mesh.periodic = {Axis::x, Axis::y, Axis::z};
  box.make_mesh();
  const Mesh mesh = perturbed(box.mesh, {0.125, 0.1, 0.125}, 0.2, 5);
  const Stencil stencil = make_stencil(mesh);
  ASSERT_FALSE(stencil.orthogonal);
  ScalarCase tracer(stencil, same_everywhere(stencil, ScalarFace::value, 0), Convection::limited,
                    1e-13);
  tracer.value[27] = 1;
  const std::vector<double> voidage(static_cast<std::size_t>(stencil.cells), 1.0);
  const std::vector<double> still(static_cast<std::size_t>(stencil.faces), 0.0);
  tracer.set_diffusion(1.0, voidage);
  for (int step = 0; step < 20; ++step) {
    tracer.advance({1.0, 1e-3, voidage, voidage, still, true});
    EXPECT_GE(*std::ranges::min_element(tracer.value), -1e-12) << step;
  }
}

TEST(SkewedMesh, keeps_a_linear_field_between_held_walls_and_its_budget) {
  FluidCase box({6, 5, 4}, {0.6, 0.5, 0.4});
  box.make_mesh();
  const Mesh mesh = perturbed(box.mesh, {0.1, 0.1, 0.1}, 0.15, 7);
  const Stencil stencil = make_stencil(mesh);
  ASSERT_FALSE(stencil.orthogonal);
  ScalarBoundary walls = same_everywhere(stencil, ScalarFace::value, 0);
  const auto linear = [](const Vector3& at) { return 1 + at.x() - 2 * at.y() + 0.5 * at.z(); };
  for (int b = 0; b < stencil.boundary_faces(); ++b) {
    const int f = stencil.internal_faces + b;
    walls.value[b] = linear(stencil.centre[stencil.owner[f]] + stencil.from_owner[f]);
  }
  ScalarCase heat(stencil, walls, Convection::limited, 1e-14);
  const std::vector<double> voidage(static_cast<std::size_t>(stencil.cells), 1.0);
  const std::vector<double> still(static_cast<std::size_t>(stencil.faces), 0.0);
  heat.set_diffusion(1.0, voidage);
  for (int cell = 0; cell < stencil.cells; ++cell) heat.value[cell] = linear(stencil.centre[cell]);
  const auto amount = [&] {
    CompensatedSum sum;
    for (int cell = 0; cell < stencil.cells; ++cell)
      sum.add(stencil.volume[cell] * heat.value[cell]);
    return sum.value();
  };
  const FluidStep step{1.0, 1e-4, voidage, voidage, still, true};
  for (int number = 0; number < 20; ++number) {
    heat.advance(step);
    for (int cell = 0; cell < stencil.cells; ++cell)
      ASSERT_NEAR(heat.value[cell], linear(stencil.centre[cell]), 1e-12) << number;
  }
  heat.value[40] += 1;  // and its budget where it is not steady
  for (int number = 0; number < 20; ++number) {
    const double before = amount();
    heat.advance(step);
    ASSERT_NEAR(amount() - before + heat.left() * step.length, 0, 1e-15) << number;
  }
}

TEST(Correction, is_cut_to_the_range_of_the_neighbours_on_both_sides_alike) {
  FluidCase box({3, 1, 1}, {3, 1, 1});
  box.make_mesh();
  const Stencil stencil = make_stencil(box.mesh);
  const ScalarBoundary ends = same_everywhere(stencil, ScalarFace::zero_gradient, 0);
  CorrectionWork work;
  resize(work, stencil);
  const std::vector<double> low{0.0, 0.9, 1.0};
  const std::vector<double> capacity{1.0, 1.0, 1.0};
  const std::vector<double> no_weight(static_cast<std::size_t>(stencil.faces), 0.0);
  const CorrectedField field{low, ends, no_weight};
  std::vector<double> flux(static_cast<std::size_t>(stencil.faces), 0.0);
  flux[0] = -0.4;  // out of cell 1 into cell 0, which may rise to 0.9; cell 1 may fall to 0
  flux[1] = 0.3;   // out of cell 1 into cell 2, which is at the maximum already
  limit_correction(stencil, field, capacity, work, flux);
  EXPECT_EQ(flux[0], -0.4);
  EXPECT_EQ(flux[1], 0.0);
  flux[0] = -2.0;  // would leave -1.1
  limit_correction(stencil, field, capacity, work, flux);
  EXPECT_NEAR(flux[0], -0.9, 1e-15);
}

TEST(Solver, that_fails_names_the_scalar) {
  RoughFlow flow(7);
  ScalarCase tracer(flow.stencil, same_everywhere(flow.stencil, ScalarFace::value, std::nan("")),
                    Convection::upwind, 1e-10);
  try {
    tracer.set_diffusion(1, flow.voidage);
    tracer.advance(flow.step());
    FAIL() << "no error";
  } catch (const NumericsError& error) {
    EXPECT_NE(std::string(error.what()).find("'tracer'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace fluxpact
