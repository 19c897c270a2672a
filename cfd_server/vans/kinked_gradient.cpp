#include "cfd_server/vans/kinked_gradient.hpp"

#include <algorithm>

#include "cfd_server/discretisation/gradient.hpp"

namespace fluxpact {

void kinked_gradient_coefficients(const Stencil& s, const MomentumCoefficients& m,
                                  std::span<const double> voidage,
                                  std::span<const double> pressure_share,
                                  std::span<Vector3> coefficients) {
  const auto resistance = [&](int cell) {
    return (m.inertia[cell] + m.drag[cell] + m.transport[cell]) /
           (pressure_share[cell] * voidage[cell] * s.volume[cell]);
  };
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    const double own = resistance(cell);
    Matrix3 normal = Matrix3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      const Vector3 d = s.side_sign[side] * s.delta(s.side_face[side]);
      const double trust = other >= 0 ? std::min(1.0, own / resistance(other)) : 1.0;
      coefficients[side] = trust / d.squaredNorm() * d;
      normal += coefficients[side] * d.transpose();
    }
    const Matrix3 inverse = inverse_on_range(normal);
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side)
      coefficients[side] = inverse * coefficients[side];
  }
}

void kinked_gradient(const Stencil& s, const BoundaryConditions& conditions,
                     const BoundaryValues& values, const MomentumCoefficients& m,
                     const FluidState& old_state, const TimeCoefficients& time,
                     std::span<const Vector3> coefficients, const KinkedGradientInput& in,
                     std::span<Vector3> gradient) {
  // L of one side of a face, along the face's A.
  const auto local = [&](int cell, int f) {
    const double share = in.pressure_share[cell];
    const double volume = s.volume[cell];
    const double resistance =
        (m.inertia[cell] + m.drag[cell]) / (share * in.voidage[cell] * volume);
    return m.source[cell].dot(s.area[f]) / (share * volume) +
           carried_flux(old_state, time, f) / share - resistance * in.flux[f];
  };
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int cell = 0; cell < s.cells; ++cell) {
    Vector3 sum = Vector3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      const int other = s.side_other[side];
      const double sign = s.side_sign[side];
      const double normal_path = s.area_size(f) / s.conductance[f];  // d_n
      double rise = 0;
      if (other >= 0) {
        const double beyond = sign > 0 ? 1 - s.weight[f] : s.weight[f];
        rise = in.pressure[other] - in.pressure[cell] +
               beyond * normal_path * sign * (local(cell, f) - local(other, f)) / s.area_size(f);
      } else if (conditions.kind[f - s.internal_faces] == FaceKind::pressure) {
        rise = values.pressure[f - s.internal_faces] - in.pressure[cell];
      } else {
        const Vector3 normal = s.area[f] / s.area_size(f);
        const Vector3 along = s.delta(f) - normal_path * normal;
        rise = normal_path * local(cell, f) / s.area_size(f) + along.dot(gradient[cell]);
      }
      sum += rise * coefficients[side];
    }
    gradient[cell] = sum;
  }
}

}  // namespace fluxpact
