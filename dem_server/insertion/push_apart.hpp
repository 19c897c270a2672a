// Overlapping spheres pushed apart until none overlaps by more than a share of its diameter: what
// random packings are made with, and starts that overlap are mended with.
//
// Pairs are pushed one after another (the projection of Jakobsen, "Advanced character physics", GDC
// 2001, section 3, over-relaxed and without velocities); the larger sphere of a pair moves less.
#pragma once

#include <span>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/walls/room.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

/// What pushing came to.
struct PushedApart {
  bool done = false;
  double overlap = 0;  ///< largest that is left, of the smaller diameter
  int a = -1;          ///< the pair that has it, -1: none
  int b = -1;          ///< -1: a wall of the room
};

/// Moves `centres` [m] until no two spheres overlap by more than `allowed` [of the smaller
/// diameter] and each is wholly inside the walls of the domain; periodic sides wrap, open ones hold
/// centres in. In a sweep over all pairs one pair moves its spheres by at most its overlap. Gives
/// up after 4000 sweeps. The same bits for the same arguments. Walls of a room push likewise; a
/// sphere that starts beyond one stays there. `alive` is called in every sweep.
PushedApart push_apart(const Domain& domain, std::span<const double> diameters, double allowed,
                       std::vector<Vector3>& centres, const Room* room = nullptr,
                       const Progress& alive = {});

}  // namespace fluxpact
