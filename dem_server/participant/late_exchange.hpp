// Momentum in coupling.scheme parallel, where the fluid answers while the particles move.
//
// In window n the fluid meets the offer of the positions at the window's start, and the particles
// are given what it answered to the offer before that. An offer is made once the answer to the last
// one is known, and the forces of the window with it: so the particles' velocities at the window's
// end are known before they move, as far as contacts do as they did. The law offered is that of
// these velocities: without contacts the very law that scheme serial would offer, whose stability
// it has.
//
// Whoever leaves takes the impulse along that was in flight to it; whoever comes in has nothing of
// the fluid but buoyancy for one window.
#pragma once

#include <span>
#include <vector>

#include "dem_server/interphase/exchange.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

class LateExchange {
 public:
  /// What the window's offer is made from, beside the fluid.
  struct Here {
    const ExchangeSettings& settings;
    const ParticleState& particles;
    std::span<const double> voidage;       ///< of their positions, one a cell
    std::span<const double> cell_volumes;  ///< [m³]
    bool rows_change;                      ///< whether particles can come in or leave
    AddUp add_up{};
  };

  /// Forget everything: nothing was offered yet.
  void start(std::span<const double> voidage);

  /// Forces of the window from the fluid's newest fields, which answer the offer before; then fills
  /// `standing`, whose weights are those of the positions, with the window's law. Repeatable until
  /// commit. Throws ProtocolError if a field is missing, NumericsError as window_forces and
  /// OfferMaker do.
  void offer(const Here& here, const Window& window, const Fields& in, OfferMaker& maker,
             FluidView& view, Offer& standing);

  /// Whether what is given in the window is lent, to be taken back with the offer: in the first
  /// one.
  bool lends() const { return answered_.initial; }
  /// Whether the window that is to be advanced has its offer.
  bool offered() const { return offered_; }
  std::span<const Vector3> force() const { return forces_.force; }  ///< of the window [N]
  const ParticleBulk& bulk() const { return bulk_; }                ///< at the window's start
  /// What the fluid gave in the window [N s], one row a cell, by the weights it answered to.
  std::span<const Vector3> impulse_given() const { return impulse_given_; }
  /// The part of it that was on its way to particles which left in the window before [N s].
  const Vector3& departed_impulse() const { return departed_; }
  /// Of the last committed positions, one a cell.
  std::span<const double> voidage() const { return voidage_; }

  /// `committed`, whose offer the fluid has answered, moves to the past; `candidate` and `voidage`,
  /// of the new positions, take its place. `rows`: row of each particle before some left or came
  /// in; empty: none did.
  void commit(Offer& committed, Offer& candidate, std::vector<double>& voidage,
              std::span<const int> rows);
  void rollback() { offered_ = false; }

  /// The force in the last committed window on those that are there now [N]; 0 on who came in.
  std::vector<Vector3> last_force(int count) const;
  double last_length() const { return past_length_; }  ///< [s] of that window; 0: there was none

 private:
  void find_forces(const Here& here, const Window& window, const FluidSeen& fluid,
                   OfferMaker& maker, FluidView& view, Offer& standing);
  void match_rows(const Here& here);

  // Committed: the past of the particles that are there now.
  Offer answered_;  ///< the offer that the fluid's newest state answers; initial: none yet
  ParticleBulk answered_bulk_;
  ParticleState answered_places_;  ///< id and position, if rows change: for messages
  std::vector<int> rows_;          ///< row in the last window of each particle; empty: the same
  WindowForces past_forces_;
  std::vector<Vector3> past_velocity_;  ///< [m/s] at the start of the last window
  double past_length_ = 0;              ///< [s] of it; 0: there was none
  std::vector<double> voidage_;

  // Of the window that is offered.
  bool offered_ = false;
  double length_ = 0;  ///< [s]
  ParticleBulk bulk_;
  ParticleState places_;
  WindowForces answer_;  ///< in the rows of answered_, if they are others now
  WindowForces forces_;
  std::vector<Vector3> velocity_;
  std::vector<Vector3> ahead_;
  std::vector<Eddy> eddies_;
  std::vector<double> voidage_seen_;
  std::vector<Vector3> impulse_given_;
  Vector3 departed_{0, 0, 0};
};

}  // namespace fluxpact
