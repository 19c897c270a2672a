// From weights to what the fluid sees of the particles' volume and motion. After the weights of a
// window, before drag (which needs the voidage).
#pragma once

#include <span>
#include <vector>

#include "dem_server/interphase/weights.hpp"

namespace fluxpact {

/// Below this a cell is fuller than spheres can be packed, whatever their sizes in practice.
inline constexpr double smallest_voidage = 0.05;

/// V_p = 4/3 π R³ [m³], one a particle.
void particle_volumes(const ParticleState& particles, std::vector<double>& volumes);

/// ε_c = 1 − Σ w V_p / V_c, one a cell, never clipped: Σ (1 − ε) V = Σ V_p up to the rounding of ε.
/// Throws NumericsError naming the cell, its centre [m] and ε where ε < `smallest_voidage`.
void map_voidage(const ParticleCellWeights& weights, std::span<const double> particle_volume,
                 std::span<const double> cell_volumes, std::span<const Vector3> cell_centres,
                 std::int64_t step, int threads, std::span<double> voidage);

/// Mean velocity of the particles in each cell, weighted by volume [m/s]; 0 where there is none.
void map_velocity(const ParticleCellWeights& weights, std::span<const double> particle_volume,
                  std::span<const Vector3> particle_velocity, int threads,
                  std::span<Vector3> velocity);

}  // namespace fluxpact
