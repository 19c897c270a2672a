// The coefficients of the time derivative, the same for mass, momentum and scalars.
//
// dq/dt = (now q^{n+1} − last q^n + before q^{n−1})/step. Euler, or the two-step backward
// differentiation formula for steps of varying length (Hairer, Norsett & Wanner, Solving Ordinary
// Differential Equations I, 2nd ed., III.5), with r = this step over the last one.
#pragma once

namespace fluxpact {

struct TimeCoefficients {
  double step = 0;   ///< [s]
  double ratio = 0;  ///< r; 0: Euler
  double now = 1;
  double last = 1;
  double before = 0;

  bool two_steps() const { return ratio > 0; }
};

inline TimeCoefficients euler(double step) { return {.step = step}; }

inline TimeCoefficients backward_two_steps(double step, double step_before) {
  const double r = step / step_before;
  return {.step = step,
          .ratio = r,
          .now = (1 + 2 * r) / (1 + r),
          .last = 1 + r,
          .before = r * r / (1 + r)};
}

/// q at the step's end by extrapolation from the two levels before it (Euler: the last one).
template <class T>
T extrapolated(const TimeCoefficients& time, const T& last, const T& before) {
  return last + time.ratio * (last - before);
}

}  // namespace fluxpact
