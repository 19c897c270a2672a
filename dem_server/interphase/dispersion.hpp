// Turbulent dispersion: the random velocities of the eddies that a particle meets, from k and ε.
//
// Discrete random walk: a particle stays in an eddy of velocity u' (normal, √(2k/3) a component)
// until the eddy has died, after t_e = l/√(2k/3) with l = C_μ^{3/4} k^{3/2}/ε, or the particle has
// crossed it, after −τ ln(1 − l/(τ |u−v|)); then the next (A.D. Gosman, E. Ioannides, J. Energy 7,
// 1983, 482-490). Drag then acts towards u + u'. The walk takes fluctuations of neighbours as
// independent, and particles drift to where k is small if they follow the fluid wholly.
#pragma once

#include <cstdint>
#include <span>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// The eddy in which a particle is, and how many numbers it has drawn.
struct Eddy {
  Vector3 velocity{0, 0, 0};  ///< u' [m/s]
  double left = 0;            ///< [s] until the next; 0: in none
  std::uint64_t drawn = 0;
};

/// What decides how the coming eddies look.
struct EddyPoint {
  double energy = 0;       ///< k [m²/s²]
  double dissipation = 0;  ///< ε [m²/s³]
  double slip = 0;         ///< |u − v| [m/s], means
  double response = 0;     ///< τ = m/ζ [s]; infinity: drag does not move it
};

/// How long a particle stays in an eddy that it meets here [s]; 0 without turbulence.
double eddy_stay(const EddyPoint& point);

/// The mean of u' [m/s] over the coming window [s], exact for windows shorter and longer than the
/// eddies; `eddy` goes on to the window's end. The numbers depend on seed, id and eddy.drawn alone.
Vector3 mean_fluctuation(const EddyPoint& point, double window, std::uint64_t seed, std::int64_t id,
                         Eddy& eddy);

}  // namespace fluxpact
