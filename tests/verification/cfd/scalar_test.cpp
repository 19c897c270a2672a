// Scalars against exact solutions and over ten thousand windows: order, constancy, bounds, budget.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "cfd_server/scalars/fluid_scalars.hpp"
#include "proto/base/compensated_sum.hpp"
#include "tests/unit/cfd_server/rough_flow.hpp"

namespace fluxpact {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

double order(double coarse, double fine) { return std::log2(coarse / fine); }

/// A wave of a scalar carried once around a periodic box in two directions and damped by diffusion;
/// the mean error (L1) at the end.
double wave_error(int n, int steps, Convection convection) {
  FluidCase box({n, 1, n}, {1, 0.1, 1});
  box.scene.fluid.mesh.periodic = {Axis::x, Axis::y, Axis::z};
  box.make_mesh();
  const Stencil stencil = make_stencil(box.mesh);
  const Vector3 velocity(1, 0, 0.5);
  const double diffusivity = 1e-3;
  const double time = 0.5;
  const auto exact = [&](const Vector3& at, double t) {
    const Vector3 x = at - velocity * t;
    return 1 + std::sin(two_pi * x.x()) * std::cos(two_pi * x.z()) *
                   std::exp(-2 * diffusivity * two_pi * two_pi * t);
  };
  ScalarCase wave(stencil, same_everywhere(stencil, ScalarFace::zero_gradient, 0), convection,
                  1e-10);
  const std::vector<double> voidage(static_cast<std::size_t>(stencil.cells), 1.0);
  wave.set_diffusion(diffusivity, voidage);
  std::vector<double> flux;
  for (int f = 0; f < stencil.faces; ++f) flux.push_back(velocity.dot(stencil.area[f]));
  for (int cell = 0; cell < stencil.cells; ++cell)
    wave.value[cell] = exact(stencil.centre[cell], 0);
  for (int step = 0; step < steps; ++step)
    wave.advance({1.0, time / steps, voidage, voidage, flux, true});
  double error = 0;
  for (int cell = 0; cell < stencil.cells; ++cell)
    error += std::abs(wave.value[cell] - exact(stencil.centre[cell], time)) / stencil.cells;
  return error;
}

TEST(ScalarOrder, is_two_in_space_for_a_smooth_wave) {
  // Steps as the square of the spacing, so that the first order in time does not show.
  for (const Convection scheme : {Convection::limited, Convection::linear_upwind}) {
    const double coarse = wave_error(16, 64, scheme);
    const double middle = wave_error(32, 256, scheme);
    const double fine = wave_error(64, 1024, scheme);
    fmt::print("wave, scheme {}: L1 {:.2e} {:.2e} {:.2e}, order {:.2f} {:.2f}\n",
               static_cast<int>(scheme), coarse, middle, fine, order(coarse, middle),
               order(middle, fine));
    EXPECT_GE(order(middle, fine), 1.9);
  }
}

TEST(ScalarOrder, is_one_in_time) {
  const double coarse = wave_error(64, 100, Convection::limited);
  const double fine = wave_error(64, 200, Convection::limited);
  fmt::print("wave in time: L1 {:.2e} {:.2e}, order {:.2f}\n", coarse, fine, order(coarse, fine));
  EXPECT_NEAR(order(coarse, fine), 1, 0.2);
}

/// Blobs of solids that wander through the box, with edges a cell wide: the voidage drops to 0.4.
void move_clusters(const Mesh& mesh, double time, std::vector<double>& voidage) {
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    const Vector3& at = mesh.cell_centres[cell];
    double solids = 0;
    for (int blob = 0; blob < 3; ++blob) {
      const double phase = 2.1 * blob;
      const Vector3 centre(0.04 + 0.025 * std::sin(9 * time + phase), 0.005,
                           0.06 + 0.04 * std::cos(7 * time + 2 * phase));
      solids += 0.3 * (1 - std::tanh(((at - centre).norm() - 0.018) / 0.002));
    }
    voidage[cell] = 1 - std::min(solids, 0.6);
  }
}

struct Drift {
  double largest_error = 0;   ///< of c = 1
  double largest_budget = 0;  ///< in − out − stored over the amount, of any window
  double lowest = INFINITY, highest = -INFINITY;  ///< of a step that the jet brings in
};

/// 10^4 windows with a scalar that is 1 everywhere, and one that comes in with half of the inlet.
Drift run_clusters(Continuity continuity, int windows, double pressure_tolerance) {
  FluidCase c({8, 1, 12}, {0.08, 0.01, 0.12});
  c.scene.coupling.continuity = continuity;
  c.scene.fluid.mesh.periodic = {Axis::y};
  c.scene.fluid.numerics.pressure_tolerance = pressure_tolerance;
  c.scene.fluid.mesh.patches.push_back({"jet", {Side::z_min, {{{0.0, 0.04}}, {}, {}}}});
  c.scene.fluid.boundaries["jet"] = superficial_inlet({0, 0, 1});
  c.side("inlet", Side::z_min, superficial_inlet({0, 0, 0.5}));
  c.side("outlet", Side::z_max, pressure_outlet());
  for (const char* name : {"step", "uniform"}) {
    ScalarSettings& scalar = c.scene.fluid.scalars[name];
    scalar.diffusivity = 1e-5;
    const bool uniform = std::string(name) == "uniform";
    scalar.initial = Formula(uniform ? 1 : 0);
    for (const char* patch : {"jet", "inlet", "outlet"})
      scalar.boundaries[patch].value = Formula(uniform || std::string(patch) == "jet" ? 1 : 0);
  }
  c.make_mesh();
  VansSolver solver(c.scene, c.mesh);
  Solids solids(c.mesh);
  move_clusters(c.mesh, 0, solids.voidage);
  solver.start(solids.voidage);
  const double window = 1e-3;
  Drift drift;
  std::vector<double> old_voidage = solids.voidage;
  std::vector<double> old_step;
  const auto amount = [&](const std::vector<double>& voidage, const std::vector<double>& value) {
    CompensatedSum sum;
    for (int cell = 0; cell < c.mesh.cells(); ++cell)
      sum.add(1.2 * voidage[cell] * c.mesh.cell_volumes[cell] * value[cell]);
    return sum.value();
  };
  for (int step = 1; step <= windows; ++step) {
    old_voidage = solids.voidage;
    old_step = solver.scalars()->committed(0).value;
    move_clusters(c.mesh, step * window, solids.voidage);
    for (int cell = 0; cell < c.mesh.cells(); ++cell)
      solids.drag[cell] = 3000 * (1 - solids.voidage[cell]) * c.mesh.cell_volumes[cell];
    run_window(solver, solids, step, window);
    for (const double value : solver.scalars()->committed(1).value)
      drift.largest_error = std::max(drift.largest_error, std::abs(value - 1));
    const ScalarField& field = solver.scalars()->committed(0);
    const auto [low, high] = std::ranges::minmax(field.value);
    drift.lowest = std::min(drift.lowest, low);
    drift.highest = std::max(drift.highest, high);
    CompensatedSum left;
    for (const double flux : field.boundary_flux) left.add(flux);
    const double now = amount(solids.voidage, field.value);
    const double net = now - amount(old_voidage, old_step) + left.value() * window;
    drift.largest_budget = std::max(drift.largest_budget, std::abs(net) / now);
  }
  return drift;
}

TEST(Clusters, leave_a_uniform_scalar_uniform_over_ten_thousand_windows) {
  const Drift conservative = run_clusters(Continuity::conservative, 10000, 1e-6);
  const Drift legacy = run_clusters(Continuity::legacy, 10000, 1e-6);
  fmt::print(
      "10^4 windows under moving clusters: c = 1 off by {:.1e} (conservative), {:.1e} "
      "(legacy); a step within [{:.1e}, 1 + {:.1e}] and [{:.3f}, {:.3f}]\n",
      conservative.largest_error, legacy.largest_error, conservative.lowest,
      conservative.highest - 1, legacy.lowest, legacy.highest);
  EXPECT_LE(conservative.largest_error, 1e-12);
  EXPECT_GE(legacy.largest_error, 1e-3);
  // Rounding, and the solver's tolerance of 1e-10 of a window's change.
  EXPECT_GE(conservative.lowest, -1e-10);
  EXPECT_LE(conservative.highest, 1 + 1e-10);
}

TEST(Clusters, do_not_touch_the_budget_of_a_scalar_at_any_tolerance_of_the_pressure) {
  for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
    const Drift drift = run_clusters(Continuity::conservative, 300, tolerance);
    fmt::print("pressure tolerance {:.0e}: budget {:.1e}, c = 1 off by {:.1e}\n", tolerance,
               drift.largest_budget, drift.largest_error);
    // Rounding of 96 cells: a few 1e-16 of what the fluid holds, which is little in the first
    // window.
    EXPECT_LE(drift.largest_budget, 1e-13);
    EXPECT_LE(drift.largest_error, 1e-13);
  }
}

}  // namespace
}  // namespace fluxpact
