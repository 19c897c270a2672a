// Continuity of every cell and of the whole, at any tolerance of the pressure solver and on any
// mesh.
#include <gtest/gtest.h>

#include <random>

#include "cfd_server/vans/flux_closure.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"
#include "tests/unit/cfd_server/perturbed_box.hpp"

namespace fluxpact {
namespace {

/// A box with jet, outlet and a periodic direction.
FluidCase jet_box() {
  FluidCase c({8, 4, 12}, {0.08, 0.04, 0.12});
  c.scene.fluid.mesh.periodic = {Axis::y};
  c.scene.fluid.mesh.patches.push_back({"jet", {Side::z_min, {std::array{0.03, 0.05}, {}, {}}}});
  c.scene.fluid.boundaries["jet"] = superficial_inlet({0, 0, 8});
  c.side("background", Side::z_min, superficial_inlet({0, 0, 0.7}));
  c.side("outlet", Side::z_max, pressure_outlet());
  c.make_mesh();
  return c;
}

/// Voidage and drag anew at random in every window: far rougher than any bed.
void randomise(Solids& solids, const Mesh& mesh, std::mt19937& random) {
  std::uniform_real_distribution<double> voidage(0.35, 1.0);
  std::uniform_real_distribution<double> drag(0.0, 5000.0);
  std::uniform_real_distribution<double> velocity(-1.0, 1.0);
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    solids.voidage[cell] = voidage(random);
    solids.drag[cell] = drag(random) * mesh.cell_volumes[cell];
    solids.source[cell] =
        solids.drag[cell] * Vector3(velocity(random), velocity(random), velocity(random));
  }
}

struct ClosureCase {
  double tolerance;
  bool perturbed;
  LinearSolverChoice solver;
};

/// The name of the case in the test's name.
void PrintTo(const ClosureCase& each, std::ostream* out) {
  *out << each.tolerance << (each.perturbed ? " perturbed" : " box")
       << (each.solver == LinearSolverChoice::automatic ? "" : " cg");
}

class Closure : public ::testing::TestWithParam<ClosureCase> {};

TEST_P(Closure, is_exact_at_any_solver_tolerance) {
  FluidCase c = jet_box();
  c.scene.fluid.numerics.pressure_tolerance = GetParam().tolerance;
  c.scene.fluid.numerics.solver = GetParam().solver;
  if (GetParam().perturbed) c.mesh = perturbed(c.mesh, {0.01, 0.01, 0.01}, 0.15, 7);
  ASSERT_EQ(c.mesh.lattice.has_value(), !GetParam().perturbed);
  Solids solids(c.mesh);
  std::mt19937 random(11);
  randomise(solids, c.mesh, random);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  const double window = 1e-3;
  for (int step = 1; step <= 10; ++step) {
    const std::vector<double> before = solver.committed().voidage;
    randomise(solids, c.mesh, random);
    run_window(solver, solids, step, window);
    const Balance balance =
        balance_of(c.mesh, c.scene.fluid.density, before, solver.committed(), window);
    // Each cell's sum has a dozen roundings of fluxes up to ~10 ρV/Δt.
    EXPECT_LE(balance.largest_residual, 1e-13) << "step " << step;
    EXPECT_LE(std::abs(balance.relative_imbalance), 1e-13) << "step " << step;
    EXPECT_GT(balance.inflow, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Tolerances, Closure,
    ::testing::Values(ClosureCase{1e-1, false, LinearSolverChoice::automatic},
                      ClosureCase{1e-2, false, LinearSolverChoice::automatic},
                      ClosureCase{1e-4, false, LinearSolverChoice::conjugate_gradient},
                      ClosureCase{1e-8, false, LinearSolverChoice::automatic},
                      ClosureCase{1e-1, true, LinearSolverChoice::automatic},
                      ClosureCase{1e-2, true, LinearSolverChoice::conjugate_gradient},
                      ClosureCase{1e-4, true, LinearSolverChoice::automatic},
                      ClosureCase{1e-8, true, LinearSolverChoice::automatic}));

TEST(Closure, does_not_add_up_its_rounding_over_the_cells) {
  const FluidCase c = column(4000, 4, 1.0);
  const Stencil stencil = make_stencil(c.mesh);
  const BoundaryConditions conditions = read_boundaries(c.scene, c.mesh, stencil);
  ClosureTree tree = make_closure_tree(stencil, conditions, find_regions(stencil, conditions));
  // Without the carry the roundings walk at random: one seed may come home by chance.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> change(-1, 1);
    std::vector<double> storage(c.mesh.cell_volumes.size());
    std::vector<double> flux(c.mesh.owner.size(), 0.0);
    CompensatedSum stored;
    for (double& value : storage) {
      value = change(random);
      stored.add(value);
    }
    const double largest = close_fluxes(tree, stencil, storage, flux);
    const double out = flux[c.mesh.find_patch("outlet")->first];
    EXPECT_GT(largest, 1);
    // Only the outlet's own rounding is left: half a unit in its last place, and half a one of the
    // sum it is held against.
    EXPECT_LE(std::abs(out + stored.value()), 1.2e-16 * std::abs(out) * 2) << "seed " << seed;
  }
}

TEST(Closure, reports_what_it_moved) {
  FluidCase c = jet_box();
  std::mt19937 random(3);
  Solids solids(c.mesh);
  randomise(solids, c.mesh, random);
  double last = 1;
  for (const double tolerance : {1e-2, 1e-6, 1e-10}) {
    c.scene.fluid.numerics.pressure_tolerance = tolerance;
    VansSolver solver(c.scene, c.mesh);
    solver.start(solids.voidage);
    run_window(solver, solids, 1, 1e-3);
    EXPECT_LT(solver.report().closure_correction, 100 * tolerance);
    EXPECT_LT(solver.report().closure_correction, last);
    last = solver.report().closure_correction;
  }
}

TEST(ClosedRegion, accepts_solids_that_move_within_it) {
  FluidCase c({5, 4, 6}, {0.05, 0.04, 0.06});
  c.make_mesh();
  Solids solids(c.mesh, 0.5);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> pick(0, c.mesh.cells() - 1);
  for (int step = 1; step <= 10; ++step) {
    const std::vector<double> before = solids.voidage;
    // Pairs of equal cells exchange solids: the sum changes by rounding only.
    for (int i = 0; i < 40; ++i) {
      const int a = pick(random);
      const int b = pick(random);
      if (a == b) continue;
      const double amount = 0.3 * std::min(1 - solids.voidage[a], solids.voidage[b] - 0.2);
      solids.voidage[a] += amount;
      solids.voidage[b] -= amount;
    }
    run_window(solver, solids, step, 1e-3);
    const Balance balance =
        balance_of(c.mesh, c.scene.fluid.density, before, solver.committed(), 1e-3);
    EXPECT_LE(balance.largest_residual, 1e-13) << "step " << step;
    for (int f = c.mesh.internal_faces(); f < c.mesh.faces(); ++f)
      EXPECT_EQ(solver.committed().face_flux[f], 0);
  }
}

TEST(ClosedRegion, refuses_a_changing_sum_and_says_why) {
  FluidCase c({5, 4, 6}, {0.05, 0.04, 0.06});
  c.make_mesh();
  Solids solids(c.mesh, 0.5);
  VansSolver solver(c.scene, c.mesh);
  solver.start(solids.voidage);
  solids.voidage[17] = 0.6;
  try {
    run_window(solver, solids, 4, 1e-3);
    FAIL() << "a closed box cannot store more";
  } catch (const NumericsError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("step 4"), std::string::npos) << text;
    EXPECT_NE(text.find("no pressure outlet"), std::string::npos) << text;
    EXPECT_NE(text.find("0.00012"), std::string::npos)
        << text;  // 1.2 kg/m³ · 1e-6 m³ · 0.1 / 1e-3 s
  }
}

TEST(ClosedRegion, needs_balanced_inlets) {
  FluidCase c({6, 2, 2}, {0.06, 0.02, 0.02});
  c.side("in", Side::x_min, superficial_inlet({1, 0, 0}));
  c.side("out", Side::x_max, superficial_inlet({1, 0, 0}));
  c.make_mesh();
  Solids solids(c.mesh, 0.5);
  VansSolver balanced(c.scene, c.mesh);
  balanced.start(solids.voidage);
  run_window(balanced, solids, 1, 1e-3);
  EXPECT_LE(balance_of(c.mesh, 1.2, solids.voidage, balanced.committed(), 1e-3).largest_residual,
            1e-13);
  c.scene.fluid.boundaries["out"] = superficial_inlet({1.001, 0, 0});
  VansSolver unbalanced(c.scene, c.mesh);
  unbalanced.start(solids.voidage);
  EXPECT_THROW(run_window(unbalanced, solids, 1, 1e-3), NumericsError);
}

}  // namespace
}  // namespace fluxpact
