// How both sides come from one committed window to the next: one function for each coupling.scheme.
//
//   serial    particles under the committed fluid -> their new voidage and drag -> fluid
//   parallel  the particles' offer of drag, for where they are -> both at once: the fluid meets
//             the offer and the voidage of the window's start, the particles what the fluid
//             answered to the offer before
//
// What follows, audit and commit, knows no schemes.
#pragma once

#include "coordinator/session/session.hpp"

namespace fluxpact {

/// What both sides have sent of one window, not yet judged.
struct Advanced {
  /// What the fluid was told of the particles: voidage of its window's end, drag.
  Message offered;
  Message particles;
  Message fluid;
  double wall_fluid = 0;      ///< [s] that the fluid side took
  double wall_particles = 0;  ///< [s] that the particle side took
  double wall_both = 0;       ///< [s] of these in which both were at work
};

/// What does not change from window to window.
struct Coupling {
  const Scene& scene;
  const Mesh& mesh;
  Session& session;
};

/// What is committed, as the sides have sent it: `offered` is what the fluid was told last.
struct Committed {
  Message& offered;
  Message& particles;
  Message& fluid;
};

/// One window in the scheme of the scene; nothing is committed yet. Throws ProtocolError,
/// NumericsError.
Advanced advance_both_sides(const Coupling& coupling, const Window& window, Committed state);

/// κ = φ/ε R (ε + c)/(ε + c R), how strongly particles answer, through pressure and added mass, to
/// the fluid that they displace, at the voidage ε and the largest density ratio R of fluid and
/// particles; 0 if none can move. Coupled at once they swing up for κ > √5 − 1, in turn for κ > 2:
/// docs/theory.md, section 4. φ counts up to 0.64, the densest packing of spheres at random: cells
/// that are fuller are small ones.
double late_response(const Scene& scene, double voidage);
inline constexpr double most_late_response = 1.2360679774997898;

/// What the fluid is told of solids: of their voidage in `state`, and of the drag in `offer`.
Message tell_of_solids(const Coupling& coupling, Message& state, Message& offer);

}  // namespace fluxpact
