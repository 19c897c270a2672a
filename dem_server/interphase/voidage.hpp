// From weights to what the fluid sees of the particles' volume and motion. After the weights of a
// window, before drag (which needs the voidage).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "dem_server/interphase/weights.hpp"

namespace fluxpact {

/// n vectors as the 3n numbers that they are, to be changed.
inline std::span<double> numbers_in(std::span<Vector3> vectors) {
  return {vectors.empty() ? nullptr : vectors.front().data(), 3 * vectors.size()};
}

/// Adds up the amounts of all processes that share the particles, one a cell; empty: there is one.
using AddUp = std::function<void(std::span<double>)>;

/// V_p = 4/3 π R³ [m³], one a particle.
void particle_volumes(const ParticleState& particles, std::vector<double>& volumes);

/// ε_c = 1 − Σ W V_p / V_c, one a cell, never clipped: Σ (1 − ε) V = Σ V_p up to the rounding of ε.
/// What over-full cells pass on becomes part of the weights (`weights.excess`). Returns that volume
/// [m³]. Throws NumericsError naming the cell, its centre [m] and ε where there is no room for it.
double map_voidage(ParticleCellWeights& weights, std::span<const double> particle_volume,
                   std::span<const double> cell_volumes, ExcessFinder& excess, std::int64_t step,
                   int threads, std::span<double> voidage, const AddUp& add_up = {});

/// Mean velocity of the particles in each cell, weighted by volume [m/s]; 0 where there is none.
/// `solids` is filled with that volume [m³].
void map_velocity(const ParticleCellWeights& weights, std::span<const double> particle_volume,
                  std::span<const Vector3> particle_velocity, int threads,
                  std::vector<double>& solids, std::span<Vector3> velocity,
                  const AddUp& add_up = {});

}  // namespace fluxpact
