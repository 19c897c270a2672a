// The linear solvers of the pressure equation behind one small interface.
//
// The matrix is symmetric positive definite (a closed region's pressure is held by its first cell),
// set up once a window and solved for each corrector, warm-started from the last pressure.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cfd_server/discretisation/stencil.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// A_PP = diagonal; A_PN = −coupling for the internal face between P and N.
struct PressureMatrix {
  std::vector<double>
      diagonal;  ///< one a cell: all couplings of the cell, pressure faces and holds included
  std::vector<double> coupling;  ///< one an internal face, >= 0
};

/// (A x)_P. A cell that is its own neighbour couples with nothing.
inline double row_times(const Stencil& s, const PressureMatrix& matrix, std::span<const double> x,
                        int cell) {
  double sum = matrix.diagonal[cell] * x[cell];
  for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
    const int other = s.side_other[side];
    if (other >= 0 && other != cell) sum -= matrix.coupling[s.side_face[side]] * x[other];
  }
  return sum;
}

/// r = b − A x, and |A||x| + |b| as the scale of its rounding.
struct Residual {
  double norm = 0;
  double rounding_scale = 0;
};
Residual residual_of(const Stencil& stencil, const PressureMatrix& matrix,
                     std::span<const double> rhs, std::span<const double> x);

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;

  /// A window begins, or begins anew: what an attempt that was not committed left is forgotten.
  virtual void begin_window() {}
  /// The window in hand is committed.
  virtual void commit() {}
  /// Forget all windows before: the next one gives the same bits as in a new process.
  virtual void forget() {}

  /// The matrix stays where it is, unchanged, until the next set-up.
  virtual void setup(const PressureMatrix& matrix) = 0;
  /// Improve x until |b − A x| <= tolerance |b|. Returns the iterations.
  virtual int iterate(std::span<const double> rhs, std::span<double> x, double tolerance) = 0;
};

/// hypre's PFMG-preconditioned conjugate gradients on lattices, BoomerAMG on other meshes, Eigen's
/// conjugate gradients with an incomplete Cholesky factor without hypre. Asking for multigrid in a
/// build without hypre is a ConfigError.
/// lattice: that of the mesh.
std::unique_ptr<PressureSolver> make_pressure_solver(LinearSolverChoice choice,
                                                     const std::optional<Lattice>& lattice,
                                                     const Stencil& stencil);

/// Solve and check the true residual. Returns the iterations, 0 if x is good enough already; throws
/// NumericsError with what was reached if the solver fails. Residuals at the rounding of A x count
/// as converged.
int solve_pressure(PressureSolver& solver, const Stencil& stencil, const PressureMatrix& matrix,
                   std::span<const double> rhs, std::span<double> x, double tolerance);

}  // namespace fluxpact
