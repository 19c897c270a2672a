// What a sphere does to the fluid that it sees, from its own cells alone: interphase.
// self_disturbance: corrected.
//
// A drag law is for the velocity that the fluid would have without the sphere. Its map gives the
// velocity with it, less by G F, F the force. So F = ζ(s) s with s = s_seen + G F, and
//   F = ζ/(1 − ζ G) s_seen:
// another ζ, linear in the fluid's velocity, which is eliminated like any (exchange.hpp), keeps
// momentum as it is and needs no memory. After J. A. K. Horwitz, A. Mani, J. Comput. Phys. 318
// (2016) 85-109, and M. Esmaily, J. A. K. Horwitz, J. Comput. Phys. 375 (2018) 960-982, whose cell
// loses momentum to viscosity alone; here also to the flow through its faces, without constants to
// fit.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "dem_server/interphase/drag.hpp"
#include "dem_server/interphase/weights.hpp"
#include "proto/mesh/mesh.hpp"

namespace fluxpact {

class OwnDisturbance {
 public:
  explicit OwnDisturbance(const Mesh& mesh);

  /// G [m/s per N]: the steady loss of velocity that a particle sees of a unit force of its own,
  /// with the weights w of its row,
  ///   G = 2/3 S²/L,   S = Σ_c w_c d_c,   d_c = w_c/(ρ ε_c V_c),
  ///   L = Σ_c w_c/V_c Σ_f [max(s·A, 0) d_c − max(−s·A, 0) d_n + ν g (d_c − d_n)].
  /// d is the velocity that the force takes in unit time, L the rate at which its mean over the
  /// weights goes to the neighbours n: with the slip s that is seen, for the fluid leaves the cells
  /// with the velocity that it has there, and by viscosity (A out of c, g = |A|²/(A·δ); what is
  /// beyond a boundary is taken as one more cell). In one cube of edge h: G = 1/(3/2 (ρ |s| h² +
  /// 6 μ h)) along an axis. 2/3: the part of a point force that has no divergence, its mean over
  /// all wave numbers; the pressure takes the rest. 0 where nothing goes anywhere: in a mesh of one
  /// periodic cell. `voidage`: as seen through the weights, one a cell.
  double response(const ParticleCellWeights& weights, int particle, const FluidProperties& fluid,
                  std::span<const double> voidage, const Vector3& slip) const;

  /// Whether all cells of the particle's row hold the cube of `narrowest` of its diameters. In
  /// smaller ones the gas that it squeezes aside is as much of what it sees as the gas that it
  /// drags along, and G knows of the second alone.
  bool has_room(const ParticleCellWeights& weights, int particle, double radius) const;

 private:
  struct CellFace {
    int beyond = -1;         ///< -1: a boundary
    Vector3 area{0, 0, 0};   ///< [m²] out of the cell
    double conductance = 0;  ///< g [m]
  };
  std::vector<int> offsets_;  ///< cells + 1
  std::vector<CellFace> faces_;
  std::vector<double> volumes_;
};

/// ζ(s) for the slip s = s_seen/(1 − ζ G) that it leads to.
struct Undisturbed {
  double drag = 0;   ///< ζ(s) [kg/s]
  double share = 0;  ///< ζ G [-] of s that is not seen
};

/// The edge of the smallest cubes in which it holds, in diameters (docs/theory.md, section 3).
constexpr double narrowest = 5;

/// More of the slip unseen than this, and a cell is not what it is taken for here.
constexpr double most_unseen = 0.5;

/// Finds s for a slip that is seen [m/s] and a response G. drag(s): ζ, which in all laws grows
/// slower than s. Stops with all digits, or with a share above `most_unseen`.
template <class Drag>
Undisturbed undisturbed(double seen, double response, Drag&& drag) {
  Undisturbed found;
  double slip = seen;
  constexpr int rounds = 200;
  for (int round = 0; round < rounds; ++round) {
    found.drag = drag(slip);
    found.share = found.drag * response;
    if (!(found.share <= most_unseen)) return found;
    const double next = seen / (1 - found.share);
    const bool done = !(std::abs(next - slip) > 1e-15 * next);
    slip = next;
    if (done) break;
  }
  return found;
}

}  // namespace fluxpact
