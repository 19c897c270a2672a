#include "cfd_server/linear/preconditioned_gradients.hpp"

namespace fluxpact {

PreconditionedGradients::PreconditionedGradients(const Stencil& stencil) : stencil_(stencil) {
  for (auto* values : {&residual_, &direction_, &product_})
    values->assign(static_cast<std::size_t>(stencil.cells), 0.0);
}

void PreconditionedGradients::start(const PressureMatrix& matrix, std::span<const double> rhs,
                                    std::span<const double> x) {
  squared_ = blocked_sum<double>(stencil_.cells, stencil_.threads, [&](int cell) {
    residual_[cell] = rhs[cell] - row_times(stencil_, matrix, x, cell);
    return residual_[cell] * residual_[cell];
  });
  scale_squared_ = blocked_sum<double>(stencil_.cells, stencil_.threads,
                                       [&](int cell) { return rhs[cell] * rhs[cell]; });
}

double PreconditionedGradients::project() const {
  return blocked_sum<double>(stencil_.cells, stencil_.threads,
                             [&](int cell) { return residual_[cell] * product_[cell]; });
}

void PreconditionedGradients::turn(double beta) {
#pragma omp parallel for schedule(static) num_threads(stencil_.threads)
  for (int cell = 0; cell < stencil_.cells; ++cell)
    direction_[cell] = product_[cell] + beta * direction_[cell];
}

double PreconditionedGradients::multiply(const PressureMatrix& matrix) {
  return blocked_sum<double>(stencil_.cells, stencil_.threads, [&](int cell) {
    product_[cell] = row_times(stencil_, matrix, direction_, cell);
    return product_[cell] * direction_[cell];
  });
}

double PreconditionedGradients::advance(double step, std::span<double> x) {
  return blocked_sum<double>(stencil_.cells, stencil_.threads, [&](int cell) {
    x[cell] += step * direction_[cell];
    residual_[cell] -= step * product_[cell];
    return residual_[cell] * residual_[cell];
  });
}

}  // namespace fluxpact
