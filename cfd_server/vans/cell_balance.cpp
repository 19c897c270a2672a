#include "cfd_server/vans/cell_balance.hpp"

#include "cfd_server/discretisation/gradient.hpp"

namespace fluxpact {
namespace {

/// What the levels before leave on a face: ρ (last φ^n − before φ^{n−1})/step [kg/s²].
double carried_flux(const FluidState& old_state, const TimeCoefficients& time, int face) {
  double carried = time.last * old_state.face_flux[face];
  if (time.two_steps()) carried -= time.before * old_state.before.face_flux[face];
  return carried / time.step;
}

}  // namespace

std::vector<Vector3> cell_balance_coefficients(const Stencil& s) {
  return gradient_coefficients(
      s, std::vector<std::uint8_t>(static_cast<std::size_t>(s.boundary_faces()), 1));
}

void balance_cells(const Stencil& s, const BoundaryConditions& conditions,
                   const BoundaryValues& values, const MomentumCoefficients& m,
                   const FluidState& old_state, const TimeCoefficients& time,
                   std::span<const Vector3> coefficients, const CellBalanceInput& in,
                   std::span<Vector3> velocity, std::span<Vector3> pressure_gradient) {
  // ∂p/∂n |A| that local forces and inertia make on the side of one cell, along the face's A.
  const auto local = [&](int cell, int f) {
    const double share = in.pressure_share[cell];
    const double volume = s.volume[cell];
    const double resistance =
        (m.inertia[cell] + m.drag[cell]) / (share * in.voidage[cell] * volume);
    return m.source[cell].dot(s.area[f]) / (share * volume) +
           carried_flux(old_state, time, f) / share - resistance * in.flux[f];
  };
  for (int cell = 0; cell < s.cells; ++cell) {
    if (s.few_faces[cell] == 0) continue;
    Vector3 gradient = Vector3::Zero();
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int f = s.side_face[side];
      const int other = s.side_other[side];
      const double sign = s.side_sign[side];
      const double normal_path = s.area_size[f] / s.conductance[f];  // d·n
      double rise = 0;
      if (other >= 0) {
        const double beyond = sign > 0 ? 1 - s.weight[f] : s.weight[f];
        rise = in.pressure[other] - in.pressure[cell] +
               beyond * normal_path * sign * (local(cell, f) - local(other, f)) / s.area_size[f];
      } else if (conditions.kind[f - s.internal_faces] == FaceKind::pressure) {
        rise = values.pressure[f - s.internal_faces] - in.pressure[cell];
      } else {
        // No pressure is known here: what the local forces make of it along the normal, and the
        // slope in hand along the face.
        const Vector3 normal = s.area[f] / s.area_size[f];
        const Vector3 along = s.delta[f] - normal_path * normal;
        rise = normal_path * local(cell, f) / s.area_size[f] + along.dot(in.slope[cell]);
      }
      gradient += rise * coefficients[side];
    }
    pressure_gradient[cell] = gradient;
    const Vector3 driving = m.known[cell] + in.force[cell] +
                            m.transport[cell] * in.velocity_before[cell] -
                            in.pressure_share[cell] * s.volume[cell] * gradient;
    velocity[cell] = driving / (m.inertia[cell] + m.drag[cell] + m.transport[cell]);
  }
}

}  // namespace fluxpact
