#include "cfd_server/linear/momentum_solver.hpp"

#include <algorithm>
#include <cmath>

#include "cfd_server/linear/blocked_sum.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double tolerance = 1e-10;
constexpr int most_iterations = 1000;

double dot(const Stencil& s, const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  return blocked_sum<double>(s.cells, s.threads, [&](int i) { return a[i].dot(b[i]); });
}

/// y += factor x
void add(const Stencil& s, double factor, const std::vector<Vector3>& x, std::vector<Vector3>& y) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int i = 0; i < s.cells; ++i) y[i] += factor * x[i];
}

}  // namespace

MomentumSolver::MomentumSolver(const Stencil& stencil, std::vector<SlipFace> slip_faces)
    : slip(std::move(slip_faces)), stencil_(stencil) {
  const auto cells = static_cast<std::size_t>(stencil.cells);
  diagonal.assign(cells, 0.0);
  weight.assign(stencil.side_face.size(), 0.0);
  for (auto* values : {&residual, &change, &shadow_, &direction_, &hat_, &product_, &second_}) {
    values->assign(cells, Vector3::Zero());
  }
}

void MomentumSolver::multiply(const std::vector<Vector3>& x, std::vector<Vector3>& y) const {
#pragma omp parallel for schedule(static) num_threads(stencil_.threads)
  for (int cell = 0; cell < stencil_.cells; ++cell) {
    Vector3 sum = diagonal[cell] * x[cell];
    for (int side = stencil_.side_offsets[cell]; side < stencil_.side_offsets[cell + 1]; ++side) {
      const int other = stencil_.side_other[side];
      if (other >= 0) sum -= weight[side] * x[other];
    }
    y[cell] = sum;
  }
  for (const SlipFace& face : slip) {
    y[face.cell] -= face.weight * (x[face.cell] - x[face.cell].dot(face.normal) * face.normal);
  }
}

void MomentumSolver::precondition(const std::vector<Vector3>& x, std::vector<Vector3>& y) const {
#pragma omp parallel for schedule(static) num_threads(stencil_.threads)
  for (int i = 0; i < stencil_.cells; ++i) y[i] = x[i] / diagonal[i];
}

int MomentumSolver::solve(double scale_squared) {
  std::ranges::fill(change, Vector3::Zero());
  const double target = tolerance * tolerance * scale_squared;
  double norm = dot(stencil_, residual, residual);
  double rho = 0;
  int iterations = 0;
  bool restart = true;
  while (!(norm <= target)) {
    if (iterations == most_iterations || !std::isfinite(norm)) {
      throw NumericsError(
          "fluid: the momentum predictor has the relative residual {} after {} iterations; shorten "
          "coupling.window",
          std::sqrt(norm / scale_squared), iterations);
    }
    if (restart) {
      shadow_ = residual;
      direction_ = residual;
      rho = norm;
      restart = false;
    }
    precondition(direction_, hat_);
    multiply(hat_, product_);
    const double projection = dot(stencil_, shadow_, product_);
    if (projection == 0) {
      restart = true;
      ++iterations;
      continue;
    }
    const double alpha = rho / projection;
    add(stencil_, alpha, hat_, change);
    add(stencil_, -alpha, product_, residual);
    precondition(residual, hat_);
    multiply(hat_, second_);
    const double squared = dot(stencil_, second_, second_);
    const double omega = squared > 0 ? dot(stencil_, second_, residual) / squared : 0.0;
    add(stencil_, omega, hat_, change);
    add(stencil_, -omega, second_, residual);
    norm = dot(stencil_, residual, residual);
    ++iterations;
    const double rho_next = dot(stencil_, shadow_, residual);
    // The recurrence breaks down when the residual turns orthogonal to the shadow: start it anew
    // from here.
    if (std::abs(rho_next) < 1e-12 * std::sqrt(norm) * std::sqrt(dot(stencil_, shadow_, shadow_)) ||
        omega == 0) {
      restart = true;
      continue;
    }
    const double beta = rho_next / rho * (alpha / omega);
#pragma omp parallel for schedule(static) num_threads(stencil_.threads)
    for (int i = 0; i < stencil_.cells; ++i) {
      direction_[i] = residual[i] + beta * (direction_[i] - omega * product_[i]);
    }
    rho = rho_next;
  }
  return iterations;
}

}  // namespace fluxpact
