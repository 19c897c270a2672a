// BiCGSTAB with the diagonal as preconditioner (van der Vorst, SIAM J. Sci. Stat. Comput. 13, 1992,
// 631-644), for one unknown a cell: a vector (momentum) or a number (scalars, turbulence).
//
// For transport equations: diagonally dominant, not symmetric. Small Courant numbers need a handful
// of iterations, and unlike relaxation sweeps it does not stall when diffusion or a large Courant
// number couples the whole mesh. Sums run in the order of the cells: the same bits every time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// Memory of a solve, one entry a cell each.
template <class Value>
struct BicgstabWork {
  explicit BicgstabWork(std::size_t cells, const Value& zero)
      : shadow(cells, zero),
        direction(cells, zero),
        hat(cells, zero),
        product(cells, zero),
        second(cells, zero) {}
  std::vector<Value> shadow, direction, hat, product, second;
};

struct BicgstabOutcome {
  int iterations = 0;
  double residual_squared = 0;  ///< |residual|² reached, by the recurrence
  bool converged = false;
};

namespace bicgstab_detail {

inline double dot(double a, double b) { return a * b; }
inline double dot(const Vector3& a, const Vector3& b) { return a.dot(b); }

template <class Value>
double dot(const std::vector<Value>& a, const std::vector<Value>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

/// y += factor x
template <class Value>
void add(double factor, const std::vector<Value>& x, std::vector<Value>& y) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
}

template <class Value>
void precondition(std::span<const double> diagonal, const std::vector<Value>& x,
                  std::vector<Value>& y) {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = x[i] / diagonal[i];
}

}  // namespace bicgstab_detail

/// Solve A change = residual from the `change` 0 until |residual|² <= target. `multiply(x, y)` sets
/// y = A x; `diagonal`: that of A, no entry 0. `residual` is overwritten.
template <class Value, class Multiply>
BicgstabOutcome solve_bicgstab(const Multiply& multiply, std::span<const double> diagonal,
                               double target, int most_iterations, std::vector<Value>& residual,
                               std::vector<Value>& change, BicgstabWork<Value>& work) {
  using namespace bicgstab_detail;
  double norm = dot(residual, residual);
  double rho = 0;
  int iterations = 0;
  bool restart = true;
  while (!(norm <= target)) {
    if (iterations == most_iterations || !std::isfinite(norm)) return {iterations, norm, false};
    if (restart) {
      work.shadow = residual;
      work.direction = residual;
      rho = norm;
      restart = false;
    }
    precondition(diagonal, work.direction, work.hat);
    multiply(work.hat, work.product);
    const double projection = dot(work.shadow, work.product);
    if (projection == 0) {
      restart = true;
      ++iterations;
      continue;
    }
    const double alpha = rho / projection;
    add(alpha, work.hat, change);
    add(-alpha, work.product, residual);
    precondition(diagonal, residual, work.hat);
    multiply(work.hat, work.second);
    const double squared = dot(work.second, work.second);
    const double omega = squared > 0 ? dot(work.second, residual) / squared : 0.0;
    add(omega, work.hat, change);
    add(-omega, work.second, residual);
    norm = dot(residual, residual);
    ++iterations;
    const double rho_next = dot(work.shadow, residual);
    // The recurrence breaks down when the residual turns orthogonal to the shadow: start it anew
    // from here.
    if (std::abs(rho_next) < 1e-12 * std::sqrt(norm) * std::sqrt(dot(work.shadow, work.shadow)) ||
        omega == 0) {
      restart = true;
      continue;
    }
    const double beta = rho_next / rho * (alpha / omega);
    for (std::size_t i = 0; i < work.direction.size(); ++i) {
      work.direction[i] = residual[i] + beta * (work.direction[i] - omega * work.product[i]);
    }
    rho = rho_next;
  }
  return {iterations, norm, true};
}

}  // namespace fluxpact
