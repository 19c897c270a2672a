#include "cfd_server/linear/momentum_solver.hpp"

#include <algorithm>
#include <cmath>

#include "cfd_server/linear/bicgstab.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double tolerance = 1e-10;
constexpr int most_iterations = 1000;

}  // namespace

MomentumSolver::MomentumSolver(const Stencil& stencil, std::vector<SlipFace> slip_faces)
    : slip(std::move(slip_faces)),
      stencil_(stencil),
      work_(static_cast<std::size_t>(stencil.cells), Vector3::Zero()) {
  const auto cells = static_cast<std::size_t>(stencil.cells);
  diagonal.assign(cells, 0.0);
  residual.assign(cells, Vector3::Zero());
  change.assign(cells, Vector3::Zero());
}

void MomentumSolver::multiply(const std::vector<Vector3>& x, std::vector<Vector3>& y) const {
#pragma omp parallel for schedule(static) num_threads(stencil_.threads)
  for (int cell = 0; cell < stencil_.cells; ++cell) {
    Vector3 sum = diagonal[cell] * x[cell];
    for (int side = stencil_.side_offsets[cell]; side < stencil_.side_offsets[cell + 1]; ++side) {
      const int other = stencil_.side_other[side];
      if (other < 0) continue;
      const int f = stencil_.side_face[side];
      sum -= (stencil_.side_sign[side] > 0 ? into_owner[f] : into_neighbour[f]) * x[other];
    }
    y[cell] = sum;
  }
  for (const SlipFace& face : slip) {
    y[face.cell] -= face.weight * (x[face.cell] - x[face.cell].dot(face.normal) * face.normal);
  }
}

int MomentumSolver::solve(double scale_squared) {
#pragma omp parallel for schedule(static) num_threads(stencil_.threads)
  for (int cell = 0; cell < stencil_.cells; ++cell) change[cell] = Vector3::Zero();
  const BicgstabOutcome outcome = solve_bicgstab(
      [this](const std::vector<Vector3>& x, std::vector<Vector3>& y) { multiply(x, y); }, diagonal,
      stencil_.threads, tolerance * tolerance * scale_squared, most_iterations, residual, change,
      work_);
  if (!outcome.converged) {
    throw NumericsError(
        "fluid: the momentum predictor has the relative residual {} after {} iterations; shorten "
        "coupling.window",
        std::sqrt(outcome.residual_squared / scale_squared), outcome.iterations);
  }
  return outcome.iterations;
}

}  // namespace fluxpact
