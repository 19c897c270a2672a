// Drag in the first window of a run, before the fluid has answered any offer.
//
// The particles know the velocity that the fluid starts with, no more. What it would answer is
// found in each cell as if that were alone, its drag implicit, without pressure and neighbours:
//   u' = (ρ ε V u + Δt S)/(ρ ε V + Δt B),   impulse = Δt k (Σ w u' − v),
// so no window is too long for it, and whoever follows the fluid at once is not carried away from
// it. It is drag alone, towards the velocity v that the particle has: one that rests in a fluid at
// rest is left alone, whether it is held by contacts or falls. Fixed particles have no use for it.
//
// The fluid is not asked for it before, so it is lent: the particles take it in window 1, and the
// offer of that window has it in S, beside the drag at the window's end. So the fluid loses what
// the particles gained, to round-off, as in every other window.
#pragma once

#include "dem_server/interphase/exchange.hpp"
#include "dem_server/interphase/voidage.hpp"

namespace fluxpact {

/// Where the particles are before the first window.
struct FirstWindow {
  std::int64_t step = 1;
  double length = 0;  ///< Δt [s]
  const ParticleState& particles;
  const ParticleBulk& bulk;
  std::span<const double> voidage;       ///< one a cell
  std::span<const double> cell_volumes;  ///< [m³]
  AddUp add_up{};
};

/// Forces of the first window from the fluid's initial velocity. `offer`, whose weights are those
/// of the positions, becomes what the drag was found with. Throws NumericsError as OfferMaker and
/// window_forces do.
void first_forces(const ExchangeSettings& settings, const FirstWindow& at, const FluidSeen& fluid,
                  OfferMaker& maker, FluidView& view, Offer& offer, WindowForces& forces);

/// S [N] of window 1 has what was lent: less `impulse_given` [N s] of it over its length [s].
void take_back(std::span<const Vector3> impulse_given, double length,
               std::span<Vector3> drag_source);

}  // namespace fluxpact
