// The force of one contact: the kernel of the native engine, inlined into the loops over pairs and
// walls.
#pragma once

#include <cmath>

#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/native/contact_list.hpp"

namespace fluxpact {

/// Two surfaces that touch, seen from the particle on which the force is wanted.
struct Touch {
  double normal[3];       ///< unit vector from the partner to the particle
  double overlap;         ///< [m]
  double velocity[3];     ///< [m/s] of the particle's centre relative to the partner's
  double radius_spin[3];  ///< [m/s] Σ radius × spin rate over both
};

/// Linear spring and dashpot in the normal direction:
///   F_n = k δ − c v_n        c = 2 ζ sqrt(k m_eff)
/// and with friction a tangential spring ξ that follows the contact, with half the dashpot:
///   ξ += v_t dt, kept tangential;   F_t = −(k_t ξ + c/2 v_t),   |F_t| ≤ μ |F_n|
/// Where the limit acts it acts on spring and dashpot together, and ξ is set back to what gives the
/// limit (Cundall & Strack, Géotechnique 29, 1979, 47-65; Silbert et al., Phys. Rev. E 64, 2001,
/// 051302). The lever arms are the radii, so v_t = v − v_n n − (r_i ω_i + r_j ω_j) × n.
/// Adds the force on the particle and its lever force −n × F_t to `load` [N]. `time_step` [s] is
/// what ξ advances by; `spring` is not read without friction.
template <bool friction>
inline void add_contact(const Touch& touch, const PairLaw& law, double damping, double time_step,
                        Spring* spring, Load& load) {
  const double* n = touch.normal;
  const double* v = touch.velocity;
  const double normal_velocity = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  const double normal_force = law[LawColumn::normal] * touch.overlap - damping * normal_velocity;
  for (int a = 0; a < 3; ++a) load.force[a] = normal_force * n[a];
  if constexpr (friction) {
    const double* w = touch.radius_spin;
    const double slip[3] = {v[0] - normal_velocity * n[0] - (w[1] * n[2] - w[2] * n[1]),
                            v[1] - normal_velocity * n[1] - (w[2] * n[0] - w[0] * n[2]),
                            v[2] - normal_velocity * n[2] - (w[0] * n[1] - w[1] * n[0])};
    double xi[3];
    for (int a = 0; a < 3; ++a) xi[a] = spring->x[a] + time_step * slip[a];
    const double along = xi[0] * n[0] + xi[1] * n[1] + xi[2] * n[2];
    double t[3];
    for (int a = 0; a < 3; ++a) {
      xi[a] -= along * n[a];
      t[a] = -(law[LawColumn::tangential] * xi[a] + 0.5 * damping * slip[a]);
    }
    const double limit = law[LawColumn::friction] * std::abs(normal_force);
    const double square = t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
    if (square > limit * limit) {
      const double share = limit / std::sqrt(square);
      for (int a = 0; a < 3; ++a) {
        t[a] *= share;
        xi[a] = -(t[a] + 0.5 * damping * slip[a]) / law[LawColumn::tangential];
      }
    }
    for (int a = 0; a < 3; ++a) {
      spring->x[a] = xi[a];
      load.force[a] += t[a];
    }
    load.lever_force[0] = -(n[1] * t[2] - n[2] * t[1]);
    load.lever_force[1] = -(n[2] * t[0] - n[0] * t[2]);
    load.lever_force[2] = -(n[0] * t[1] - n[1] * t[0]);
  }
}

}  // namespace fluxpact
