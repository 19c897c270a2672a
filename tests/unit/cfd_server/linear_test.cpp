// The linear solvers against each other and against the true residual.
#include <gtest/gtest.h>

#include <random>

#include "cfd_server/linear/momentum_solver.hpp"
#include "cfd_server/linear/pressure_solver.hpp"
#include "proto/base/errors.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"

namespace fluxpact {
namespace {

/// Couplings between 1 and 10^spread; a few cells tied to the outside, or one only.
struct PressureProblem {
  Mesh mesh;
  Stencil stencil;
  PressureMatrix matrix;
  std::vector<double> rhs;

  PressureProblem(std::array<int, 3> cells, const std::vector<Axis>& periodic, double spread,
                  bool open) {
    FluidCase c(cells, Vector3(cells[0], cells[1], cells[2]));
    c.scene.fluid.mesh.periodic = periodic;
    c.make_mesh();
    mesh = c.mesh;
    stencil = make_stencil(mesh);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> unit(0, 1);
    matrix.diagonal.assign(mesh.cell_volumes.size(), 0.0);
    for (int f = 0; f < stencil.internal_faces; ++f) {
      matrix.coupling.push_back(std::pow(10, spread * unit(random)));
      if (stencil.owner[f] == stencil.neighbour[f]) continue;
      matrix.diagonal[stencil.owner[f]] += matrix.coupling.back();
      matrix.diagonal[stencil.neighbour[f]] += matrix.coupling.back();
    }
    double sum = 0;
    for (int cell = 0; cell < stencil.cells; ++cell) {
      rhs.push_back(unit(random) - 0.5);
      sum += rhs.back();
    }
    for (double& value : rhs) value -= sum / stencil.cells;
    if (open) {
      for (int cell = 0; cell < cells[0] * cells[1]; ++cell) matrix.diagonal[cell] += 1;
    } else {
      matrix.diagonal[0] *= 2;
    }
  }

  std::vector<double> solve(LinearSolverChoice choice, bool as_lattice, double tolerance) {
    Mesh seen = mesh;
    if (!as_lattice) seen.lattice.reset();
    const auto solver = make_pressure_solver(choice, seen, stencil);
    std::vector<double> x(rhs.size(), 0.0);
    for (int repeat = 0; repeat < 2; ++repeat) {  // a second set-up must not remember the first
      std::ranges::fill(x, 0.0);
      solver->setup(matrix);
      EXPECT_GT(solve_pressure(*solver, stencil, matrix, rhs, x, tolerance), 0);
    }
    double norm = 0;
    for (const double value : rhs) norm += value * value;
    EXPECT_LE(residual_of(stencil, matrix, rhs, x).norm, 2 * tolerance * std::sqrt(norm));
    EXPECT_EQ(solve_pressure(*solver, stencil, matrix, rhs, x, 3 * tolerance), 0)
        << "a good start needs no work";
    return x;
  }
};

void expect_agreement(PressureProblem problem) {
  const auto lattice = problem.solve(LinearSolverChoice::automatic, true, 1e-11);
  const auto algebraic = problem.solve(LinearSolverChoice::automatic, false, 1e-11);
  const auto gradients = problem.solve(LinearSolverChoice::conjugate_gradient, true, 1e-11);
  double size = 0;
  for (const double value : gradients) size = std::max(size, std::abs(value));
  for (std::size_t cell = 0; cell < gradients.size(); ++cell) {
    // Residuals of 1e-11 times a condition number of some thousands.
    EXPECT_NEAR(lattice[cell], gradients[cell], 1e-6 * size);
    EXPECT_NEAR(algebraic[cell], gradients[cell], 1e-6 * size);
  }
}

TEST(PressureSolvers, agree_on_boxes_slices_and_rows) {
  expect_agreement({{9, 7, 8}, {}, 1.0, true});
  expect_agreement({{16, 2, 24}, {}, 2.0, true});
  expect_agreement({{30, 1, 1}, {}, 1.0, true});
}

TEST(PressureSolvers, agree_with_periods_of_one_two_odd_and_even) {
  for (const int period : {1, 2, 3, 4, 5, 8})
    expect_agreement({{8, period, 10}, {Axis::y}, 1.0, true});
  expect_agreement({{6, 4, 8}, {Axis::x, Axis::y, Axis::z}, 1.0, false});
}

TEST(PressureSolvers, solve_closed_regions) { expect_agreement({{8, 4, 10}, {}, 1.0, false}); }

TEST(PressureSolvers, say_what_was_reached_when_they_fail) {
  PressureProblem problem({4, 4, 4}, {}, 1.0, true);
  const auto solver =
      make_pressure_solver(LinearSolverChoice::conjugate_gradient, problem.mesh, problem.stencil);
  solver->setup(problem.matrix);
  problem.matrix.diagonal[20] *=
      3;  // the solver now works on another matrix than the one it is checked against
  std::vector<double> x(problem.rhs.size(), 0.0);
  try {
    solve_pressure(*solver, problem.stencil, problem.matrix, problem.rhs, x, 1e-10);
    FAIL() << "the true residual must be checked";
  } catch (const NumericsError& error) {
    EXPECT_NE(std::string(error.what()).find("relative residual"), std::string::npos)
        << error.what();
  }
}

TEST(MomentumSolver, solves_convection_diffusion_and_free_slip) {
  FluidCase c({6, 5, 4}, {6, 5, 4});
  c.make_mesh();
  const Stencil stencil = make_stencil(c.mesh);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SlipFace> slip;
  slip.reserve(static_cast<std::size_t>(stencil.boundary_faces()));
  for (int f = stencil.internal_faces; f < stencil.faces; ++f) {
    // Oblique normals: the three components are coupled.
    slip.push_back({f, stencil.owner[f], Vector3(1, 2, -1).normalized(), 5.0});
  }
  MomentumSolver solver(stencil, slip);
  std::vector<Vector3> exact;
  exact.reserve(c.mesh.cell_volumes.size());
  for (int cell = 0; cell < stencil.cells; ++cell)
    exact.emplace_back(unit(random), unit(random), unit(random));
  for (double& weight : solver.weight) weight = 100 * unit(random);
  for (int cell = 0; cell < stencil.cells; ++cell) {
    double sum = 0.1;  // inertia far below the couplings: a long window
    Vector3 right = Vector3::Zero();
    for (int side = stencil.side_offsets[cell]; side < stencil.side_offsets[cell + 1]; ++side) {
      if (stencil.side_other[side] < 0) continue;
      sum += solver.weight[side];
      right -= solver.weight[side] * exact[stencil.side_other[side]];
    }
    for (const SlipFace& face : slip) {
      if (face.cell != cell) continue;
      sum += face.weight;
      right -= face.weight * (exact[cell] - exact[cell].dot(face.normal) * face.normal);
    }
    solver.diagonal[cell] = sum;
    solver.residual[cell] = right + sum * exact[cell];
  }
  double scale = 0;
  for (const Vector3& r : solver.residual) scale += r.squaredNorm();
  EXPECT_GT(solver.solve(scale), 1);
  for (int cell = 0; cell < stencil.cells; ++cell) {
    EXPECT_LE((solver.change[cell] - exact[cell]).norm(),
              1e-6);  // 1e-10 times a condition of some thousands
  }
}

}  // namespace
}  // namespace fluxpact
