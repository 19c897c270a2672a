#include "dem_server/interphase/lattice_shares.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fluxpact {
namespace {

// Overlaps below this share of R³ are the rounding of a ball that does not touch the cell.
constexpr double touching = 1e-14;

/// Volumes beyond all planes of each set of them; a set is a number of bits.
std::array<double, 8> beyond_sets(double radius, int count, const std::array<double, 3>& h) {
  std::array<double, 8> beyond{};
  beyond[0] = ball_volume(radius);
  for (int i = 0; i < count; ++i) beyond[1 << i] = cut_ball_volume(radius, -h[i]);
  if (count >= 2) beyond[3] = beyond_edge(radius, h[0], h[1]);
  if (count == 3) {
    beyond[5] = beyond_edge(radius, h[0], h[2]);
    beyond[6] = beyond_edge(radius, h[1], h[2]);
    beyond[7] = beyond_corner(radius, {h[0], h[1], h[2]});
  }
  return beyond;
}

}  // namespace

bool LatticeOverlap::find_cuts(const Ball& ball, Cuts& cuts) const {
  const double radius = ball.radius;
  if (!(radius > 0)) return false;
  for (int k = 0; k < 3; ++k) {
    const LatticeAxis& axis = axes_[k];
    double x = ball.centre[k];
    const int i = axis.interval(x);
    if (i < 0) return false;
    cuts.cell += i * axis.stride;
    const double low = x - axis.nodes[i];
    const double high = axis.nodes[i + 1] - x;
    if (std::min(low, high) >= radius) continue;
    if (std::max(low, high) < radius) return false;
    const bool below = low < high;
    int other = below ? i - 1 : i + 1;
    if (other < 0 || other > axis.last) {
      if (!axis.periodic) {
        cuts.walls |= 1 << cuts.count;
        other = i;
      } else {
        other = below ? axis.last : 0;
      }
    }
    const double distance = below ? low : high;
    if (axis.nodes[other + 1] - axis.nodes[other] < radius - distance) return false;
    cuts.distance[cuts.count] = distance;
    cuts.beyond[cuts.count] = (other - i) * axis.stride;
    ++cuts.count;
  }
  return true;
}

bool LatticeOverlap::find(const Ball& ball, LatticeShares& shares) const {
  Cuts cuts;
  if (!find_cuts(ball, cuts)) return false;
  const double radius = ball.radius;
  shares.cells[0] = cuts.cell;
  shares.count = 1;
  if (cuts.count == 0) {
    shares.volumes[0] = shares.total = ball_volume(radius);
    return true;
  }
  const std::array<double, 8> beyond = beyond_sets(radius, cuts.count, cuts.distance);
  const int sets = 1 << cuts.count;
  const double smallest = touching * radius * radius * radius;
  shares.total = 0;
  shares.count = 0;
  for (int set = 0; set < sets; ++set) {
    if ((set & cuts.walls) != 0) continue;
    double volume = 0;  // beyond the planes of this set, and of no other
    int place = cuts.cell;
    for (int i = 0; i < cuts.count; ++i) place += (set >> i & 1) * cuts.beyond[i];
    for (int more = 0; more < sets; ++more) {
      if ((more & set) != set) continue;
      volume +=
          std::popcount(static_cast<unsigned>(more ^ set)) % 2 == 1 ? -beyond[more] : beyond[more];
    }
    if (volume <= smallest) continue;
    shares.cells[shares.count] = place;
    shares.volumes[shares.count++] = volume;
    shares.total += volume;
  }
  return true;
}

}  // namespace fluxpact
