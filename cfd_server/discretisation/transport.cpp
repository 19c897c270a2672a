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

inline Vector3 higher_order_part(Convection scheme, const Vector3& step, const Vector3& rise,
                                 const Vector3& to_face, const Matrix3& gradient, double share) {
  if (scheme == Convection::linear_upwind) return gradient * to_face;
  return share * limited_step(2 * rise - step, step);
}

void add_higher_order(const Stencil& s, const TransportCoefficients& c, Convection scheme,
                      std::span<const Vector3> velocity, std::span<const Matrix3> gradient,
                      std::span<Vector3> force) {
  for (int f = 0; f < s.internal_faces; ++f) {
    const int p = s.owner[f];
    const int n = s.neighbour[f];
    const bool out = c.mass_flux[f] >= 0;
    const int upwind = out ? p : n;
    const Vector3 step =
        out ? Vector3(velocity[n] - velocity[p]) : Vector3(velocity[p] - velocity[n]);
    const Vector3 along = out ? s.delta[f] : Vector3(-s.delta[f]);
    const Vector3& to_face = out ? s.from_owner[f] : s.from_neighbour[f];
    const double share = out ? s.weight[f] : 1 - s.weight[f];
    const Vector3 part = c.mass_flux[f] * higher_order_part(scheme, step, gradient[upwind] * along,
                                                            to_face, gradient[upwind], share);
    force[p] -= part;
    force[n] += part;
  }
}

void add_cross_diffusion(const Stencil& s, const TransportCoefficients& c,
                         std::span<const Matrix3> gradient, std::span<Vector3> force) {
  for (int f = 0; f < s.faces; ++f) {
    const double viscous = c.diffusion[f] / s.conductance[f];  // μ ε_f
    const int p = s.owner[f];
    if (f >= s.internal_faces) {
      force[p] += viscous * (gradient[p] * s.cross[f]);
      continue;
    }
    const int n = s.neighbour[f];
    const double w = s.weight[f];
    const Vector3 part = viscous * (((1 - w) * gradient[p] + w * gradient[n]) * s.cross[f]);
    force[p] += part;
    force[n] -= part;
  }
}

/// μ ε_f [(∇u)ᵀ·A − 2/3 (∇·u) A]: the part of the stress that vanishes where ε μ is uniform.
void add_transposed_stress(const Stencil& s, const TransportCoefficients& c,
                           std::span<const Matrix3> gradient, std::span<Vector3> force) {
  for (int f = 0; f < s.faces; ++f) {
    const double viscous = c.diffusion[f] / s.conductance[f];  // μ ε_f; 0 where no value is given
    const int p = s.owner[f];
    Matrix3 at_face = gradient[p];
    if (f < s.internal_faces) {
      at_face = (1 - s.weight[f]) * at_face + s.weight[f] * gradient[s.neighbour[f]];
    }
    const Vector3 part =
        viscous * (at_face.transpose() * s.area[f] - (2.0 / 3.0 * at_face.trace()) * s.area[f]);
    force[p] += part;
    if (f < s.internal_faces) force[s.neighbour[f]] -= part;
  }
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
  std::ranges::fill(force, Vector3::Zero());
  for (int f = 0; f < s.internal_faces; ++f) {
    const Vector3 step = velocity[s.neighbour[f]] - velocity[s.owner[f]];
    force[s.owner[f]] += c.into_owner[f] * step;
    force[s.neighbour[f]] -= c.into_neighbour[f] * step;
  }
  for (int f = s.internal_faces; f < s.faces; ++f) {
    force[s.owner[f]] += c.into_owner[f] * boundary_jump[f - s.internal_faces];
  }
  if (scheme != Convection::upwind) add_higher_order(s, c, scheme, velocity, gradient, force);
  if (!s.orthogonal) add_cross_diffusion(s, c, gradient, force);
  add_transposed_stress(s, c, gradient, force);
}

}  // namespace fluxpact
