// The particles as the native engine holds them: rows in cell order, laid out for the vector
// registers that read them. `Real` is the type of all but positions: double, or float where the
// scene asks for mixed precision. `turning`: spins are followed (some contact has friction).
#pragma once

#include <algorithm>

#include "dem_server/backends/native/huge_vector.hpp"

namespace fluxpact {

/// What a contact reads of each partner. Between sub-steps of a window the velocity is half a step
/// behind the position. Aligned for its widest row, the position.
template <class Real, bool turning>
struct alignas(4 * sizeof(double)) Body {
  double position[3];   ///< [m]
  double radius;        ///< [m]
  Real velocity[3];     ///< [m/s]
  Real inverse_mass;    ///< [1/kg]; 0 holds the particle in place
  Real radius_spin[3];  ///< [m/s] radius times spin
  Real inverse_radius;  ///< [1/m]
};

template <class Real>
struct alignas(4 * sizeof(double)) Body<Real, false> {
  double position[3];
  double radius;
  Real velocity[3];
  Real inverse_mass;
};

/// Sum over the contacts of a particle. The lever arm is the same for all of them, its radius, so
/// the torque is the radius times `lever`.
template <class Real, bool turning>
struct alignas(8 * sizeof(Real)) Load {
  Real force[4];  ///< [N]; the last number is 0
  Real lever[4];  ///< [N] Σ (arm direction) × (tangential force); the last number is 0
};

template <class Real>
struct alignas(4 * sizeof(Real)) Load<Real, false> {
  Real force[4];
};

/// The same between two windows, without the zeros. Within a window `force` is what drives the
/// particle beside its contacts [m/s²].
template <class Real, bool turning>
struct KeptLoad {
  Real force[3];
  Real lever[3];
};
template <class Real>
struct KeptLoad<Real, false> {
  Real force[4];  // the last number is 0
};

template <class Real, bool turning>
KeptLoad<Real, turning> kept(const Load<Real, turning>& load) {
  KeptLoad<Real, turning> row{};
  std::copy_n(load.force, 3, row.force);
  if constexpr (turning) std::copy_n(load.lever, 3, row.lever);
  return row;
}
template <class Real, bool turning>
Load<Real, turning> full(const KeptLoad<Real, turning>& row) {
  Load<Real, turning> load{};
  std::copy_n(row.force, 3, load.force);
  if constexpr (turning) std::copy_n(row.lever, 3, load.lever);
  return load;
}

/// Equal ranges of particles: the unit of work. They depend on the number of particles only, and
/// each sum runs within a block, so that any number of threads gives the same bits.
struct Blocks {
  int particles = 0;
  int block_size = 1;

  int count() const { return (particles + block_size - 1) / block_size; }
  int first(int block) const { return block * block_size; }
  int last(int block) const { return std::min(first(block) + block_size, particles); }
  int holding(int particle) const { return particle / block_size; }
};

}  // namespace fluxpact
