// Conjugate gradients around a library's multigrid (Hestenes & Stiefel, J. Res. Nat. Bur. Stand.
// 49, 1952, 409-436).
//
// The loop is ours, the preconditioner hypre's, for three reasons: its vectors run on threads
// (Debian's hypre has none) with sums of the same bits for any number of them; hypre's own loop
// applies the preconditioner once more after the last iteration, one cycle in six of a warm-started
// solve to 1e-6; and multigrid may belong to an older matrix than the gradients (lagged set-up).
#pragma once

#include <span>
#include <vector>

#include "cfd_server/linear/blocked_sum.hpp"
#include "cfd_server/linear/pressure_solver.hpp"

namespace fluxpact {

class PreconditionedGradients {
 public:
  explicit PreconditionedGradients(const Stencil& stencil);

  /// Improve x until the recurrence has |r| <= tolerance |rhs|, in `most` iterations at most.
  /// precondition(r, z): z = M⁻¹ r, M symmetric positive definite. Returns the iterations.
  template <class Precondition>
  int solve(const PressureMatrix& matrix, std::span<const double> rhs, std::span<double> x,
            double tolerance, int most, const Precondition& precondition);

  /// Whether the last solve reached its tolerance.
  bool converged() const { return converged_; }

 private:
  /// r = b − A x; |b|² and |r|².
  void start(const PressureMatrix& matrix, std::span<const double> rhs, std::span<const double> x);
  /// product = A direction; direction · product.
  double multiply(const PressureMatrix& matrix);
  /// x += step direction, r −= step product; |r|².
  double advance(double step, std::span<double> x);
  void turn(double beta);
  double project() const;

  const Stencil& stencil_;
  std::vector<double> residual_, direction_, product_;
  double squared_ = 0;        ///< |r|²
  double scale_squared_ = 0;  ///< |b|²
  bool converged_ = false;
};

template <class Precondition>
int PreconditionedGradients::solve(const PressureMatrix& matrix, std::span<const double> rhs,
                                   std::span<double> x, double tolerance, int most,
                                   const Precondition& precondition) {
  start(matrix, rhs, x);
  const double target = tolerance * tolerance * scale_squared_;
  int iterations = 0;
  double projected = 0;
  converged_ = squared_ <= target;
  while (!converged_ && iterations < most) {
    precondition(std::span<const double>(residual_), std::span<double>(product_));
    const double before = projected;
    projected = project();
    // Not positive: the residual is rounding, or not a number; the caller looks at the true one.
    if (!(projected > 0)) break;
    turn(iterations == 0 ? 0.0 : projected / before);
    const double curvature = multiply(matrix);
    if (!(curvature > 0)) break;
    squared_ = advance(projected / curvature, x);
    ++iterations;
    converged_ = squared_ <= target;
  }
  return iterations;
}

}  // namespace fluxpact
