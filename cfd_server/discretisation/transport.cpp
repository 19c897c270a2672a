#include "cfd_server/discretisation/transport.hpp"

#include <algorithm>

namespace fluxpact {
namespace {

/// Harmonic mean of the slopes before and after, zero at an extremum: van Leer's ψ(r) times `step`,
/// r = before/step.
inline Vector3 limited_step(const Vector3& before, const Vector3& step) {
  const Eigen::Array3d product = before.array() * step.array();
  return (product > 0).select(2 * product / (before + step).array(), 0.0).matrix();
}

void add_lowest_order(const Stencil& s, const TransportCoefficients& c, const CellShare& share,
                      std::span<const Vector3> velocity, std::span<const Vector3> boundary_jump,
                      std::span<Vector3> force) {
  for_faces(share, 0, s.internal_faces, [&](int f) {
    const Vector3 step = velocity[s.neighbour[f]] - velocity[s.owner[f]];
    if (share.has(s.owner[f])) force[s.owner[f]] += c.into_owner[f] * step;
    if (share.has(s.neighbour[f])) force[s.neighbour[f]] -= c.into_neighbour[f] * step;
  });
  for_faces(share, s.internal_faces, s.faces, [&](int f) {
    force[s.owner[f]] += c.into_owner[f] * boundary_jump[f - s.internal_faces];
  });
}

void add_higher_order(const Stencil& s, const TransportCoefficients& c, const CellShare& share,
                      Convection scheme, std::span<const Vector3> velocity,
                      std::span<const Matrix3> gradient, std::span<Vector3> force) {
  for_faces(share, 0, s.internal_faces, [&](int f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    const bool out = c.mass_flux[f] >= 0;
    const int upwind = out ? p : n;
    const Vector3 step =
        out ? Vector3(velocity[n] - velocity[p]) : Vector3(velocity[p] - velocity[n]);
    // What the gradient says of the face, from the upwind centre and from the one beyond.
    const Vector3 to_face = (out ? s.from_owner : s.from_neighbour).multiplied(gradient[upwind], f);
    Vector3 part = c.mass_flux[f] * to_face;
    if (scheme == Convection::limited) {
      const Vector3 from_beyond =
          (out ? s.from_neighbour : s.from_owner).multiplied(gradient[upwind], f);
      const double weight = out ? s.weight[f] : 1 - s.weight[f];
      part = c.mass_flux[f] * weight * limited_step(2 * (to_face - from_beyond) - step, step);
    }
    if (share.has(p)) force[p] -= part;
    if (share.has(n)) force[n] += part;
  });
}

void add_cross_diffusion(const Stencil& s, const TransportCoefficients& c, const CellShare& share,
                         std::span<const Matrix3> gradient, std::span<Vector3> force) {
  for_faces(share, 0, s.internal_faces, [&](int f) {
    const double viscous = c.diffusion[f] / s.conductance[f];  // μ ε_f
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    const double w = s.weight[f];
    const Vector3 part = viscous * (((1 - w) * gradient[p] + w * gradient[n]) * s.cross[f]);
    if (share.has(p)) force[p] += part;
    if (share.has(n)) force[n] -= part;
  });
  for_faces(share, s.internal_faces, s.faces, [&](int f) {
    const double viscous = c.diffusion[f] / s.conductance[f];
    force[s.owner[f]] += viscous * (gradient[s.owner[f]] * s.cross[f]);
  });
}

/// μ ε_f [(∇u)ᵀ·A − 2/3 (∇·u) A]: the part of the stress that vanishes where ε μ is uniform.
void add_transposed_stress(const Stencil& s, const TransportCoefficients& c, const CellShare& share,
                           std::span<const Matrix3> gradient, std::span<Vector3> force) {
  const auto part = [&](int f, const Matrix3& at_face) -> Vector3 {
    const double viscous = c.diffusion[f] / s.conductance[f];  // μ ε_f; 0 where no value is given
    return viscous *
           (s.area.multiplied_transposed(at_face, f) - (2.0 / 3.0 * at_face.trace()) * s.area[f]);
  };
  for_faces(share, 0, s.internal_faces, [&](int f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    const double w = s.weight[f];
    const Vector3 through = part(f, (1 - w) * gradient[p] + w * gradient[n]);
    if (share.has(p)) force[p] += through;
    if (share.has(n)) force[n] -= through;
  });
  for_faces(share, s.internal_faces, s.faces,
            [&](int f) { force[s.owner[f]] += part(f, gradient[s.owner[f]]); });
}

}  // namespace

void finish_coefficients(TransportCoefficients& c, int threads) {
  const int faces = static_cast<int>(c.mass_flux.size());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int f = 0; f < faces; ++f) {
    c.into_owner[f] = std::max(-c.mass_flux[f], 0.0) + c.diffusion[f];
    c.into_neighbour[f] = std::max(c.mass_flux[f], 0.0) + c.diffusion[f];
  }
}

void transport_force(const Stencil& s, const TransportCoefficients& c, Convection scheme,
                     std::span<const Vector3> velocity, std::span<const Vector3> boundary_jump,
                     std::span<const Matrix3> gradient, std::span<Vector3> force) {
  const int shares = static_cast<int>(s.shares.size());
#pragma omp parallel for schedule(static) num_threads(s.threads)
  for (int i = 0; i < shares; ++i) {
    const CellShare& share = s.shares[static_cast<std::size_t>(i)];
    std::fill(force.begin() + share.first, force.begin() + share.last, Vector3::Zero());
    add_lowest_order(s, c, share, velocity, boundary_jump, force);
    if (scheme != Convection::upwind)
      add_higher_order(s, c, share, scheme, velocity, gradient, force);
    if (!s.orthogonal) add_cross_diffusion(s, c, share, gradient, force);
    add_transposed_stress(s, c, share, gradient, force);
  }
}

}  // namespace fluxpact
