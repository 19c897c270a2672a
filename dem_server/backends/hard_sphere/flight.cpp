#include "dem_server/backends/hard_sphere/flight.hpp"

#include <array>

namespace fluxpact {
namespace {

/// Root of `value` in [low, high], where it changes its sign: Newton's method, and halving where
/// that leaves the bracket or its steps do not halve.
template <class Value, class Slope>
double bracketed_root(const Value& value, const Slope& slope, double low, double high) {
  const bool falls = value(low) > 0;
  double t = 0.5 * (low + high);
  double last_step = high - low;
  while (true) {
    const double here = value(t);
    ((here > 0) == falls ? low : high) = t;
    double next = t - here / slope(t);
    const bool good = next > low && next < high && std::abs(next - t) <= 0.5 * last_step;
    if (!good) next = 0.5 * (low + high);
    if (next == t || next <= low || next >= high) return t;  // as near as numbers are
    last_step = std::abs(next - t);
    t = next;
  }
}

/// Up to three times in (0, horizon), ascending, at which the separation has an extremum.
struct Extrema {
  std::array<double, 5> time{};  // with 0 in front and the horizon behind
  int count = 0;
  void add(double t) { time.at(static_cast<std::size_t>(count++)) = t; }
};

Extrema extrema_of(const Separation& separation, double horizon) {
  const double* c = separation.c;
  const Fall curvature{c[2], 3 * c[3], 12 * c[4]};  // half the second derivative
  // Between its zeros the slope is monotone.
  std::array<double, 4> cut{0, horizon, horizon, horizon};
  int cuts = 1;
  const double square =
      curvature.speed * curvature.speed - 2 * curvature.acceleration * curvature.distance;
  if (curvature.acceleration > 0 && square > 0) {
    const double q = -(curvature.speed + std::copysign(std::sqrt(square), curvature.speed));
    const double one = q / curvature.acceleration;
    const double other = 2 * curvature.distance / q;
    for (const double t : {std::min(one, other), std::max(one, other)}) {
      if (t > 0 && t < horizon) cut.at(static_cast<std::size_t>(cuts++)) = t;
    }
  } else if (curvature.acceleration == 0 && curvature.speed != 0) {
    const double t = -curvature.distance / curvature.speed;
    if (t > 0 && t < horizon) cut.at(static_cast<std::size_t>(cuts++)) = t;
  }
  Extrema extrema;
  extrema.add(0);
  const auto slope = [&](double t) { return separation.slope(t); };
  const auto bend = [&](double t) { return 2 * c[2] + t * (6 * c[3] + t * 12 * c[4]); };
  for (int k = 0; k < cuts; ++k) {
    const double low = cut.at(static_cast<std::size_t>(k));
    const double high = k + 1 < cuts ? cut.at(static_cast<std::size_t>(k) + 1) : horizon;
    if ((slope(low) > 0) == (slope(high) > 0)) continue;
    extrema.add(bracketed_root(slope, bend, low, high));
  }
  extrema.add(horizon);
  return extrema;
}

}  // namespace

double root_between(const Separation& separation, double low, double high) {
  return bracketed_root([&](double t) { return separation.at(t); },
                        [&](double t) { return separation.slope(t); }, low, high);
}

double first_touch_of_any(const Separation& separation, double horizon) {
  if (separation.c[0] <= 0 && separation.c[1] < 0) return 0;
  const Extrema extrema = extrema_of(separation, horizon);
  for (int k = 0; k + 1 < extrema.count; ++k) {
    const double low = extrema.time.at(static_cast<std::size_t>(k));
    const double high = extrema.time.at(static_cast<std::size_t>(k) + 1);
    const double from = separation.at(low);
    const double to = separation.at(high);
    if (to >= from) continue;  // it rises here
    if (from <= 0) return low;
    if (to <= 0) return root_between(separation, low, high);
  }
  return never;
}

}  // namespace fluxpact
