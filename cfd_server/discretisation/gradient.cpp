#include "cfd_server/discretisation/gradient.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace fluxpact {
namespace {

/// From the cell's centre to where the other value stands.
Vector3 reach(const Stencil& s, int side) {
  return static_cast<double>(s.side_sign[side]) * s.delta(s.side_face[side]);
}

/// add(jump, side, sum): sum += jump cᵀ
template <class Add>
void vector_gradient(const Stencil& s, std::span<const Vector3> field,
                     std::span<const Vector3> boundary_jump, std::span<Matrix3> out,
                     const Add& add) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    Matrix3 sum = Matrix3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      const Vector3 jump = other >= 0 ? Vector3(field[other] - field[cell])
                                      : boundary_jump[s.side_face[side] - s.internal_faces];
      add(jump, side, sum);
    }
    out[cell] = sum;
  }
}

template <class Coefficients>
void scalar_gradient(const Stencil& s, const Coefficients& coefficients,
                     std::span<const double> field, std::span<const double> boundary_jump,
                     std::span<Vector3> out) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    Vector3 sum = Vector3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      const double jump = other >= 0 ? field[other] - field[cell]
                                     : boundary_jump[s.side_face[side] - s.internal_faces];
      sum += jump * coefficients[side];
    }
    out[cell] = sum;
  }
}

}  // namespace

Matrix3 inverse_on_range(const Matrix3& matrix) {
  const double mean = matrix.trace() / 3;
  if (matrix.determinant() > 1e-4 * mean * mean * mean) return matrix.inverse();
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(matrix);
  const Vector3& values = solver.eigenvalues();
  Matrix3 inverse = Matrix3::Zero();
  for (int i = 0; i < 3; ++i) {
    if (values[i] < 1e-8) continue;
    const Vector3 axis = solver.eigenvectors().col(i);
    inverse += axis * axis.transpose() / values[i];
  }
  return inverse;
}

std::vector<Vector3> gradient_coefficients(const Stencil& s,
                                           std::span<const std::uint8_t> gives_value) {
  std::vector<Vector3> coefficients(s.side_face.size(), Vector3::Zero());
  const auto counts = [&](int side) {
    return s.side_other[side] >= 0 || gives_value[s.side_face[side] - s.internal_faces] != 0;
  };
  for (int cell = 0; cell < s.cells; ++cell) {
    Matrix3 normal = Matrix3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      if (!counts(side)) continue;
      const Vector3 d = reach(s, side);
      normal += d * d.transpose() / d.squaredNorm();
    }
    const Matrix3 inverse = inverse_on_range(normal);
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      if (!counts(side)) continue;
      const Vector3 d = reach(s, side);
      coefficients[side] = inverse * d / d.squaredNorm();
    }
  }
  return coefficients;
}

void gradient(const Stencil& s, std::span<const Vector3> coefficients,
              std::span<const Vector3> field, std::span<const Vector3> boundary_jump,
              std::span<Matrix3> out) {
  vector_gradient(s, field, boundary_jump, out, [&](const Vector3& jump, int side, Matrix3& sum) {
    sum.noalias() += jump * coefficients[side].transpose();
  });
}

void gradient(const Stencil& s, const AxisVectors& coefficients, std::span<const Vector3> field,
              std::span<const Vector3> boundary_jump, std::span<Matrix3> out) {
  vector_gradient(s, field, boundary_jump, out, [&](const Vector3& jump, int side, Matrix3& sum) {
    coefficients.add_outer(jump, side, sum);
  });
}

void gradient(const Stencil& s, std::span<const Vector3> coefficients,
              std::span<const double> field, std::span<const double> boundary_jump,
              std::span<Vector3> out) {
  scalar_gradient(s, coefficients, field, boundary_jump, out);
}

}  // namespace fluxpact
