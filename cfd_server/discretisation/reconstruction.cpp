#include "cfd_server/discretisation/reconstruction.hpp"

#include <Eigen/LU>

namespace fluxpact {

std::vector<Vector3> reconstruction_coefficients(const Stencil& s) {
  std::vector<Vector3> coefficients(s.side_face.size());
  for (int cell = 0; cell < s.cells; ++cell) {
    Matrix3 sum = Matrix3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      sum += s.area[f] * s.area[f].transpose() / s.area_size(f);
    }
    const Matrix3 inverse = sum.inverse();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      coefficients[side] = inverse * s.area[f] / s.area_size(f);
    }
  }
  return coefficients;
}

namespace {

/// add(part, side, sum): sum += part c
template <class Add>
void rebuild(const Stencil& s, std::span<const double> flux, std::span<const Matrix3> gradient,
             std::span<Vector3> out, const Add& add) {
  // A and φ change sign together when seen from the neighbour, so the sign of a side drops out.
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    Vector3 sum = Vector3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      double part = flux[f];
      if (!s.centred) {
        const Vector3 offset = s.side_sign[side] > 0 ? s.from_owner[f] : s.from_neighbour[f];
        part -= s.area[f].dot(gradient[cell] * offset);
      }
      add(part, side, sum);
    }
    out[cell] = sum;
  }
}

}  // namespace

void reconstruct(const Stencil& s, std::span<const Vector3> coefficients,
                 std::span<const double> flux, std::span<const Matrix3> gradient,
                 std::span<Vector3> out) {
  rebuild(s, flux, gradient, out,
          [&](double part, int side, Vector3& sum) { sum += part * coefficients[side]; });
}

void reconstruct(const Stencil& s, const AxisVectors& coefficients, std::span<const double> flux,
                 std::span<const Matrix3> gradient, std::span<Vector3> out) {
  rebuild(s, flux, gradient, out,
          [&](double part, int side, Vector3& sum) { coefficients.add(part, side, sum); });
}

}  // namespace fluxpact
