#include "cfd_server/vans/face_flux.hpp"

namespace fluxpact {

double rebuilt_share(const Stencil& s, int face) {
  if (s.uniform) return 1.0;
  if (s.few_faces.empty()) return 0.2;
  const bool few = s.few_faces[s.owner[face]] != 0 ||
                   (face < s.internal_faces && s.few_faces[s.neighbour[face]] != 0);
  return few ? 0.05 : 0.2;
}

double carried_flux(const FluidState& old_state, const TimeCoefficients& time, int face) {
  double carried = time.last * old_state.face_flux[face];
  if (time.two_steps()) carried -= time.before * old_state.before.face_flux[face];
  return carried / time.step;
}

void resize(FaceCoefficients& c, const Stencil& s) {
  for (auto* values : {&c.mobility, &c.transport_resistance, &c.memory}) {
    values->assign(static_cast<std::size_t>(s.faces), 0.0);
  }
}

void assemble_faces(const Stencil& s, const BoundaryConditions& conditions,
                    const MomentumCoefficients& m, std::span<const double> voidage,
                    std::span<const double> pressure_share, const FluidState& old_state,
                    const TimeCoefficients& time, FaceCoefficients& c) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) {
    const bool internal = f < s.internal_faces;
    if (!internal && conditions.kind[f - s.internal_faces] != FaceKind::pressure) continue;
    const int p = s.owner[f];
    const double w = s.weight[f];
    const double part_p = w / (pressure_share[p] * voidage[p] * s.volume[p]);
    double transport = part_p * m.transport[p];
    double rest = part_p * (m.inertia[p] + m.drag[p]);
    double inverse_share = w / pressure_share[p];
    if (internal) {
      const int n = s.neighbour[f];
      const double part_n = (1 - w) / (pressure_share[n] * voidage[n] * s.volume[n]);
      transport += part_n * m.transport[n];
      rest += part_n * (m.inertia[n] + m.drag[n]);
      inverse_share += (1 - w) / pressure_share[n];
    }
    c.transport_resistance[f] = transport;
    c.mobility[f] = 1 / (transport + rest);
    c.memory[f] = carried_flux(old_state, time, f) * inverse_share;
  }
}

void explicit_flux(const Stencil& s, const BoundaryConditions& conditions,
                   const BoundaryValues& values, const FaceCoefficients& c, const FaceFluxInput& in,
                   std::span<double> flux) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) {
    const bool internal = f < s.internal_faces;
    const int b = f - s.internal_faces;
    if (!internal && conditions.kind[b] != FaceKind::pressure) {
      flux[f] = values.flux[b];
      continue;
    }
    const int p = s.owner[f];
    const double w = s.weight[f];
    Vector3 force = w * in.specific_force[p];
    Vector3 value = in.superficial[p] + s.from_owner.multiplied(in.superficial_gradient[p], f);
    Vector3 slope = Vector3::Zero();
    if (!s.orthogonal)
      slope = internal ? Vector3((1 - w) * in.pressure_gradient[p]) : in.pressure_gradient[p];
    if (internal) {
      const int n = s.neighbour[f];
      force += (1 - w) * in.specific_force[n];
      value = 0.5 * (value + in.superficial[n] +
                     s.from_neighbour.multiplied(in.superficial_gradient[n], f));
      if (!s.orthogonal) slope += w * in.pressure_gradient[n];
    }
    const double rebuilt = rebuilt_share(s, f);
    const double face_value = rebuilt * s.area.dot(value, f) + (1 - rebuilt) * in.last_flux[f];
    double driving = s.area.dot(force, f) + c.memory[f] + c.transport_resistance[f] * face_value;
    if (!s.orthogonal) driving -= s.cross[f].dot(slope);
    flux[f] = c.mobility[f] * driving;
  }
}

void add_pressure_flux(const Stencil& s, const BoundaryValues& values, const FaceCoefficients& c,
                       std::span<const double> pressure, std::span<double> flux) {
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) {
    const double outside =
        f < s.internal_faces ? pressure[s.neighbour[f]] : values.pressure[f - s.internal_faces];
    flux[f] -= c.mobility[f] * s.conductance[f] * (outside - pressure[s.owner[f]]);
  }
}

void predict_flux(const Stencil& s, const FluidState& old_state, double density,
                  std::span<const Vector3> superficial, std::span<double> flux) {
  const auto change_of = [&](int cell) -> Vector3 {
    return superficial[cell] - old_state.voidage[cell] * old_state.velocity[cell];
  };
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int f = 0; f < s.faces; ++f) {
    const int p = s.owner[f];
    const double w = s.weight[f];
    Vector3 change = change_of(p);
    if (f < s.internal_faces) {
      const int n = s.neighbour[f];
      change = (1 - w) * change + w * change_of(n);
    }
    flux[f] = old_state.face_flux[f] / density + change.dot(s.area[f]);
  }
}

}  // namespace fluxpact
