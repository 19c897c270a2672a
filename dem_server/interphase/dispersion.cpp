#include "dem_server/interphase/dispersion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fluxpact {
namespace {

/// Every bit of the result depends on every bit of the argument: the output function of SplitMix64
/// (G.L. Steele, D. Lea, C.H. Flood, OOPSLA 2014, 453-472).
std::uint64_t mixed(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15U;
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
  return bits ^ (bits >> 31U);
}

/// The numbers of one particle, in order.
struct Sequence {
  std::uint64_t key;
  std::uint64_t& drawn;

  /// In (0, 1).
  double uniform() {
    const std::uint64_t bits = mixed(key ^ mixed(drawn++));
    return (static_cast<double>(bits >> 11U) + 0.5) * 0x1.0p-53;
  }
  /// Standard normal (G.E.P. Box, M.E. Muller, Ann. Math. Stat. 29, 1958, 610-611).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  Vector3 vector() {
    Vector3 v;
    for (int i = 0; i < 3; ++i) v[i] = normal();
    return v;
  }
};

}  // namespace

double eddy_stay(const EddyPoint& point) {
  if (!(point.energy > 0) || !(point.dissipation > 0)) return 0;
  const double speed = std::sqrt(2.0 / 3.0 * point.energy);
  const double size = std::pow(0.09, 0.75) * std::pow(point.energy, 1.5) / point.dissipation;
  const double life = size / speed;
  const double reach = point.response * point.slip;  // how far the slip alone takes it
  if (!(reach > size)) return life;
  // Without drag the particle goes straight on: the limit of the logarithm.
  const double crossing =
      std::isinf(point.response) ? size / point.slip : -point.response * std::log1p(-size / reach);
  return std::min(life, crossing);
}

Vector3 mean_fluctuation(const EddyPoint& point, double window, std::uint64_t seed, std::int64_t id,
                         Eddy& eddy) {
  const double stay = eddy_stay(point);
  if (!(stay > 0)) {
    eddy.left = 0;
    return Vector3::Zero();
  }
  Sequence sequence{mixed(seed ^ mixed(static_cast<std::uint64_t>(id))), eddy.drawn};
  const double speed = std::sqrt(2.0 / 3.0 * point.energy);
  const double in_old = std::min(eddy.left, window);
  Vector3 path = in_old * eddy.velocity;
  eddy.left -= in_old;
  double rest = window - in_old;
  if (!(rest > 0)) return path / window;
  // Those that begin and end within the window: the sum of n normal paths is one with √n.
  const double whole = std::floor(rest / stay);
  if (whole > 0) path += stay * speed * std::sqrt(whole) * sequence.vector();
  rest = std::max(0.0, rest - whole * stay);
  eddy.velocity = speed * sequence.vector();
  eddy.left = stay - rest;
  path += rest * eddy.velocity;
  return path / window;
}

}  // namespace fluxpact
