// BiCGSTAB with the diagonal as preconditioner (van der Vorst, SIAM J. Sci. Stat. Comput. 13, 1992,
// 631-644), for one unknown a cell: a vector (momentum) or a number (scalars, turbulence).
//
// For transport equations: diagonally dominant, not symmetric. Small Courant numbers need a handful
// of iterations, and unlike relaxation sweeps it does not stall when diffusion or a large Courant
// number couples the whole mesh. Sums run in fixed blocks: the same bits for any number of threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "cfd_server/linear/bicgstab_work.hpp"
#include "cfd_server/linear/blocked_sum.hpp"
#include "proto/base/vector.hpp"

namespace fluxpact {

struct BicgstabOutcome {
  int iterations = 0;
  double residual_squared = 0;  ///< |residual|² reached, by the recurrence
  bool converged = false;
};

namespace bicgstab_detail {

inline double dot(double a, double b) { return a * b; }
inline double dot(const Vector3& a, const Vector3& b) { return a.dot(b); }

template <class Value>
double dot(int threads, const std::vector<Value>& a, const std::vector<Value>& b) {
  return blocked_sum<double>(static_cast<int>(a.size()), threads,
                             [&](int i) { return dot(a[i], b[i]); });
}

/// Two sums from one pass over memory.
struct TwoSums {
  double first = 0;
  double second = 0;

  TwoSums& operator+=(const TwoSums& other) {
    first += other.first;
    second += other.second;
    return *this;
  }
};

template <class Value>
void precondition(int threads, std::span<const double> diagonal, const std::vector<Value>& x,
                  std::vector<Value>& y) {
  const auto size = static_cast<int>(y.size());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int i = 0; i < size; ++i) y[i] = x[i] / diagonal[i];
}

}  // namespace bicgstab_detail

/// Solve A change = residual from the `change` 0 until |residual|² <= target. `multiply(x, y)` sets
/// y = A x; `diagonal`: that of A, no entry 0. `residual` is overwritten.
template <class Value, class Multiply>
BicgstabOutcome solve_bicgstab(const Multiply& multiply, std::span<const double> diagonal,
                               int threads, double target, int most_iterations,
                               std::vector<Value>& residual, std::vector<Value>& change,
                               BicgstabWork<Value>& work) {
  using namespace bicgstab_detail;
  double norm = dot(threads, residual, residual);
  double rho = 0;
  double shadow_squared = 0;
  const auto size = static_cast<int>(residual.size());
  int iterations = 0;
  bool restart = true;
  while (!(norm <= target)) {
    if (iterations == most_iterations || !std::isfinite(norm)) return {iterations, norm, false};
    if (restart) {
#pragma omp parallel for schedule(static) num_threads(threads)
      for (int i = 0; i < size; ++i) work.shadow[i] = work.direction[i] = residual[i];
      rho = shadow_squared = norm;
      restart = false;
    }
    precondition(threads, diagonal, work.direction, work.hat);
    multiply(work.hat, work.product);
    const double projection = dot(threads, work.shadow, work.product);
    if (projection == 0) {
      restart = true;
      ++iterations;
      continue;
    }
    const double alpha = rho / projection;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int i = 0; i < size; ++i) {
      change[i] += alpha * work.hat[i];
      residual[i] -= alpha * work.product[i];
      work.hat[i] = residual[i] / diagonal[i];
    }
    multiply(work.hat, work.second);
    const TwoSums minimum = blocked_sum<TwoSums>(size, threads, [&](int i) {
      return TwoSums{dot(work.second[i], work.second[i]), dot(work.second[i], residual[i])};
    });
    const double omega = minimum.first > 0 ? minimum.second / minimum.first : 0.0;
    const TwoSums left = blocked_sum<TwoSums>(size, threads, [&](int i) {
      change[i] += omega * work.hat[i];
      residual[i] -= omega * work.second[i];
      return TwoSums{dot(residual[i], residual[i]), dot(work.shadow[i], residual[i])};
    });
    norm = left.first;
    ++iterations;
    const double rho_next = left.second;
    // The recurrence breaks down when the residual turns orthogonal to the shadow: start it anew
    // from here.
    if (std::abs(rho_next) < 1e-12 * std::sqrt(norm) * std::sqrt(shadow_squared) || omega == 0) {
      restart = true;
      continue;
    }
    const double beta = rho_next / rho * (alpha / omega);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int i = 0; i < size; ++i) {
      work.direction[i] = residual[i] + beta * (work.direction[i] - omega * work.product[i]);
    }
    rho = rho_next;
  }
  return {iterations, norm, true};
}

}  // namespace fluxpact
