// The linear solvers against each other and against the true residual.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <random>

#include "cfd_server/linear/blocked_sum.hpp"
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
    const auto solver = make_pressure_solver(choice, seen.lattice, stencil);
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

/// The conductances of a lattice of cells of one shape, each times 1 or `jump`.
PressureProblem with_jumps(std::array<int, 3> cells, const Vector3& cell_size, double jump) {
  PressureProblem problem(cells, {}, 0.0, true);
  std::mt19937 random(4);
  std::ranges::fill(problem.matrix.diagonal, 0.0);
  std::vector<double> mobility;
  for (int cell = 0; cell < problem.stencil.cells; ++cell) {
    // Blocks of 4 x 4 x 4 cells, so that the jumps lie across coarse cells, too.
    const int block = cell % cells[0] / 4 + cell / cells[0] % cells[1] / 4 * 7 +
                      cell / (cells[0] * cells[1]) / 4 * 31;
    mobility.push_back(block % 3 == 0 ? jump : 1.0);
  }
  for (int f = 0; f < problem.stencil.internal_faces; ++f) {
    const int p = problem.stencil.owner[f];
    const int n = problem.stencil.neighbour[f];
    int axis = 0;
    problem.stencil.area[f].cwiseAbs().maxCoeff(&axis);
    const double conductance = cell_size.prod() / (cell_size[axis] * cell_size[axis]);
    problem.matrix.coupling[f] = conductance * 2 / (1 / mobility[p] + 1 / mobility[n]);
    problem.matrix.diagonal[p] += problem.matrix.coupling[f];
    problem.matrix.diagonal[n] += problem.matrix.coupling[f];
  }
  const double end = cell_size.x() * cell_size.y() / cell_size.z();
  for (int cell = 0; cell < cells[0] * cells[1]; ++cell)
    problem.matrix.diagonal[cell] += 2 * end * mobility[cell];
  return problem;
}

/// Iterations from zero to 1e-6, the true residual checked.
int iterations_of(PressureProblem& problem, bool as_lattice) {
  Mesh seen = problem.mesh;
  if (!as_lattice) seen.lattice.reset();
  const auto solver =
      make_pressure_solver(LinearSolverChoice::automatic, seen.lattice, problem.stencil);
  std::vector<double> x(problem.rhs.size(), 0.0);
  solver->begin_window();
  solver->setup(problem.matrix);
  const int iterations =
      solve_pressure(*solver, problem.stencil, problem.matrix, problem.rhs, x, 1e-6);
  double norm = 0;
  for (const double value : problem.rhs) norm += value * value;
  const Residual residual = residual_of(problem.stencil, problem.matrix, problem.rhs, x);
  // 1e-12: what solve_pressure takes for the rounding of A x.
  EXPECT_LE(residual.norm, std::max(2e-6 * std::sqrt(norm), 1e-12 * residual.rounding_scale));
  return iterations;
}

TEST(PressureSolvers, survive_flat_and_tall_cells_and_jumps) {
  // Multigrid needs some ten iterations whatever the shape and the jump; gradients alone would need
  // hundreds. 40: what is measured (at most 29) with room for other versions of the library.
  for (const double aspect : {1e-3, 1.0, 1e3}) {
    for (const double jump : {1.0, 1e6}) {
      for (const bool as_lattice : {true, false}) {
        PressureProblem problem = with_jumps({24, 20, 28}, {1, 1, aspect}, jump);
        EXPECT_LE(iterations_of(problem, as_lattice), 40)
            << "aspect " << aspect << ", jump " << jump << ", lattice " << as_lattice;
      }
    }
  }
}

TEST(PressureSolvers, need_as_many_iterations_on_fine_meshes_as_on_coarse_ones) {
  for (const bool as_lattice : {true, false}) {
    PressureProblem coarse = with_jumps({12, 12, 12}, {1, 1, 1}, 10);
    PressureProblem fine = with_jumps({48, 48, 48}, {1, 1, 1}, 10);
    // 64 times as many cells; gradients alone would need four times the iterations.
    EXPECT_LE(iterations_of(fine, as_lattice), 1.5 * iterations_of(coarse, as_lattice));
  }
}

TEST(PressureSolvers, say_what_was_reached_when_they_fail) {
  PressureProblem problem({4, 4, 4}, {}, 1.0, true);
  const auto solver = make_pressure_solver(LinearSolverChoice::conjugate_gradient,
                                           problem.mesh.lattice, problem.stencil);
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

/// Windows on a matrix that changes by a factor a window, with multigrid that is kept.
struct ChangingMatrix {
  PressureProblem problem;
  PressureMatrix matrix;
  std::unique_ptr<PressureSolver> solver;

  ChangingMatrix() : problem({12, 10, 14}, {}, 1.0, true), matrix(problem.matrix) {
    Mesh seen = problem.mesh;
    seen.lattice.reset();
    solver = make_pressure_solver(LinearSolverChoice::automatic, seen.lattice, problem.stencil);
  }

  /// The matrix of window `step`: conductances grow in one half of the cells.
  void change(int step, double rate) {
    const Stencil& s = problem.stencil;
    for (int f = 0; f < s.internal_faces; ++f) {
      const bool grows = s.owner[f] % 12 < 6;
      matrix.coupling[f] = problem.matrix.coupling[f] * (grows ? std::exp(rate * step) : 1.0);
    }
    std::ranges::fill(matrix.diagonal, 0.0);
    for (int f = 0; f < s.internal_faces; ++f) {
      matrix.diagonal[s.owner[f]] += matrix.coupling[f];
      matrix.diagonal[s.neighbour[f]] += matrix.coupling[f];
    }
    for (int cell = 0; cell < 120; ++cell) matrix.diagonal[cell] += 1;
  }

  std::vector<double> advance(int step, double rate, int* iterations = nullptr) {
    change(step, rate);
    std::vector<double> x(problem.rhs.size(), 0.0);
    solver->begin_window();
    solver->setup(matrix);
    const int needed = solve_pressure(*solver, problem.stencil, matrix, problem.rhs, x, 1e-9);
    if (iterations != nullptr) *iterations = needed;
    return x;
  }
};

TEST(KeptMultigrid, follows_a_matrix_that_changes_beyond_recognition) {
  ChangingMatrix kept;
  int most = 0;
  for (int step = 0; step < 40; ++step) {
    int iterations = 0;
    kept.advance(step, 0.5, &iterations);  // e^20 in the end; the true residual is checked
    kept.solver->commit();
    most = std::max(most, iterations);
  }
  // A fresh one needs about ten; without renewal there would be hundreds.
  EXPECT_LE(most, 40);
}

TEST(KeptMultigrid, gives_the_same_bits_in_a_repeated_window) {
  ChangingMatrix direct;
  ChangingMatrix repeated;
  for (int step = 0; step < 12; ++step) {
    const auto expected = direct.advance(step, 0.5);
    direct.solver->commit();
    repeated.advance(step + 30, 0.5);  // given up: a matrix for which what is kept does not do
    EXPECT_EQ(repeated.advance(step, 0.5), expected) << step;
    repeated.solver->commit();
  }
}

TEST(KeptMultigrid, forgets_so_that_a_restored_run_gives_the_same_bits) {
  ChangingMatrix running;
  for (int step = 0; step < 4; ++step) {
    running.advance(step, 0.1);
    running.solver->commit();
  }
  running.solver->forget();
  ChangingMatrix restored;
  for (int step = 4; step < 8; ++step) {
    EXPECT_EQ(running.advance(step, 0.1), restored.advance(step, 0.1)) << step;
    running.solver->commit();
    restored.solver->commit();
  }
}

TEST(BlockedSum, has_the_same_bits_for_any_number_of_threads) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const int count : {0, 1, 2047, 2048, 2049, 300000}) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(unit(random));
    const auto sum = [&](int threads) {
      return blocked_sum<double>(count, threads, [&](int i) { return values[i]; });
    };
    EXPECT_EQ(sum(1), sum(2));
    EXPECT_EQ(sum(1), sum(3));
    EXPECT_NEAR(sum(3), std::accumulate(values.begin(), values.end(), 0.0),
                1e-16 * count * std::sqrt(count) + 1e-300);
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
  std::vector<double> into_owner(static_cast<std::size_t>(stencil.faces));
  std::vector<double> into_neighbour(into_owner.size());
  for (auto* weights : {&into_owner, &into_neighbour}) {
    for (double& weight : *weights) weight = 100 * unit(random);
  }
  solver.into_owner = into_owner;
  solver.into_neighbour = into_neighbour;
  for (int cell = 0; cell < stencil.cells; ++cell) {
    double sum = 0.1;  // inertia far below the couplings: a long window
    Vector3 right = Vector3::Zero();
    for (int side = stencil.side_offsets[cell]; side < stencil.side_offsets[cell + 1]; ++side) {
      if (stencil.side_other[side] < 0) continue;
      const int f = stencil.side_face[side];
      const double weight = stencil.side_sign[side] > 0 ? into_owner[f] : into_neighbour[f];
      sum += weight;
      right -= weight * exact[stencil.side_other[side]];
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

// Open MPI, on which Debian's hypre is built, would give all single processes of a machine one
// folder of temporary files, and two that start at the same time would trip over each other's.
TEST(Pressure, solver_starts_without_a_folder_for_temporary_files) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        setenv("TMPDIR", "/proc/nowhere", 1);
        const PressureProblem problem({4, 4, 4}, {}, 1, true);
        make_pressure_solver(LinearSolverChoice::automatic, {}, problem.stencil);
        std::exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace fluxpact
