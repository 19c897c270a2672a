#include "cfd_server/linear/conjugate_gradient.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/Sparse>

namespace fluxpact {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Preconditioner = Eigen::IncompleteCholesky<double>;

class ConjugateGradient final : public PressureSolver {
 public:
  explicit ConjugateGradient(const Stencil& stencil)
      : stencil_(stencil), matrix_(stencil.cells, stencil.cells) {
    solver_.setMaxIterations(10 * stencil.cells + 100);
  }

  void setup(const PressureMatrix& matrix) override {
    entries_.clear();
    for (int cell = 0; cell < stencil_.cells; ++cell)
      entries_.emplace_back(cell, cell, matrix.diagonal[cell]);
    for (int f = 0; f < stencil_.internal_faces; ++f) {
      const int p = stencil_.owner[f];
      const int n = stencil_.neighbour[f];
      if (p == n) continue;
      entries_.emplace_back(p, n, -matrix.coupling[f]);
      entries_.emplace_back(n, p, -matrix.coupling[f]);
    }
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    solver_.compute(matrix_);
  }

  int iterate(std::span<const double> rhs, std::span<double> x, double tolerance) override {
    const Eigen::Map<const Eigen::VectorXd> b(rhs.data(), stencil_.cells);
    Eigen::Map<Eigen::VectorXd> solution(x.data(), stencil_.cells);
    solver_.setTolerance(tolerance);
    solution = solver_.solveWithGuess(b, solution).eval();
    return static_cast<int>(solver_.iterations()) + 1;  // Eigen counts from zero
  }

 private:
  const Stencil& stencil_;
  std::vector<Eigen::Triplet<double>> entries_;
  Matrix matrix_;
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Preconditioner> solver_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_conjugate_gradient(const Stencil& stencil) {
  return std::make_unique<ConjugateGradient>(stencil);
}

}  // namespace fluxpact
