// Fixed points that stand for a ball, each for an equal part of its volume: the map `satellite`.
#pragma once

#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// `count` >= 1 points of the unit ball about the origin [-]. They stand in opposite pairs (an odd
/// one in the centre) in shells of equal volume, along the quasi-random sequence of Roberts (2018,
/// "The unreasonable effectiveness of quasirandom sequences"), and are then stretched so that from
/// six points on their second moments are those of the ball, 1/5 in each direction: what they
/// integrate of a polynomial of third order is exact. No two of them pass a plane face of a box at
/// once, as points of cubic symmetry do. A few may lie up to 6 % outside of the ball.
std::vector<Vector3> satellite_points(int count);

}  // namespace fluxpact
