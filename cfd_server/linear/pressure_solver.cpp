#include "cfd_server/linear/pressure_solver.hpp"

#include <algorithm>
#include <cmath>

#include "cfd_server/linear/blocked_sum.hpp"
#include "cfd_server/linear/conjugate_gradient.hpp"
#include "proto/base/errors.hpp"
#ifdef FLUXPACT_HAS_HYPRE
#include "cfd_server/linear/algebraic_multigrid.hpp"
#include "cfd_server/linear/lattice_multigrid.hpp"
#endif

namespace fluxpact {
namespace {

struct Squares {
  double residual = 0;
  double scale = 0;

  Squares& operator+=(const Squares& other) {
    residual += other.residual;
    scale += other.scale;
    return *this;
  }
};

}  // namespace

Residual residual_of(const Stencil& s, const PressureMatrix& matrix, std::span<const double> rhs,
                     std::span<const double> x) {
  const auto squares = blocked_sum<Squares>(s.cells, s.threads, [&](int cell) {
    const double residual = rhs[cell] - row_times(s, matrix, x, cell);
    const double size = 2 * matrix.diagonal[cell] * std::abs(x[cell]) + std::abs(rhs[cell]);
    return Squares{residual * residual, size * size};
  });
  return {std::sqrt(squares.residual), std::sqrt(squares.scale)};
}

std::unique_ptr<PressureSolver> make_pressure_solver(
    LinearSolverChoice choice, [[maybe_unused]] const std::optional<Lattice>& lattice,
    const Stencil& stencil) {
#ifdef FLUXPACT_HAS_HYPRE
  if (choice != LinearSolverChoice::conjugate_gradient) {
    if (lattice) return make_lattice_multigrid(*lattice, stencil);
    return make_algebraic_multigrid(stencil);
  }
#else
  if (choice == LinearSolverChoice::multigrid) {
    throw ConfigError(
        "fluid.numerics.solver: multigrid needs hypre, and this build is without; install "
        "libhypre-dev and build "
        "again, or choose 'automatic' or 'conjugate_gradient'");
  }
#endif
  return make_conjugate_gradient(stencil);
}

int solve_pressure(PressureSolver& solver, const Stencil& stencil, const PressureMatrix& matrix,
                   std::span<const double> rhs, std::span<double> x, double tolerance) {
  // Rounding of A x: a few units in the last place of its terms.
  constexpr double rounding = 1e-15;
  const double norm_of_rhs = std::sqrt(blocked_sum<double>(
      stencil.cells, stencil.threads, [&](int cell) { return rhs[cell] * rhs[cell]; }));
  if (norm_of_rhs == 0) {
    std::ranges::fill(x, 0.0);
    return 0;
  }
  const auto reached = [&](const Residual& residual, double slack) {
    return residual.norm <=
           slack * std::max(tolerance * norm_of_rhs, rounding * residual.rounding_scale);
  };
  Residual residual = residual_of(stencil, matrix, rhs, x);
  if (reached(residual, 1.0)) return 0;
  int iterations = 0;
  // The recurrence of conjugate gradients may run ahead of the true residual: start again from
  // where it stopped.
  for (int attempt = 0; attempt < 3 && !reached(residual, 2.0); ++attempt) {
    iterations += solver.iterate(rhs, x, tolerance);
    residual = residual_of(stencil, matrix, rhs, x);
  }
  // Demands beyond double precision end at the rounding of the equations, which grows with the
  // spread of A.
  if (!reached(residual, 2.0) && !(residual.norm <= 1e3 * rounding * residual.rounding_scale)) {
    throw NumericsError(
        "fluid: the pressure equation has the relative residual {} after {} iterations, {} was "
        "asked for; raise "
        "fluid.numerics.pressure_tolerance or choose another fluid.numerics.solver",
        residual.norm / norm_of_rhs, iterations, tolerance);
  }
  return iterations;
}

}  // namespace fluxpact
