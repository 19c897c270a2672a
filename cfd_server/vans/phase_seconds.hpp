// Where the time of a window goes: read by the report, the log and the bench.
#pragma once

#include <chrono>

namespace fluxpact {

/// Wall time of the phases of one window [s].
struct PhaseSeconds {
  double assembly = 0;   ///< coefficients, net forces, explicit fluxes, right-hand sides
  double setup = 0;      ///< of the pressure solver
  double pressure = 0;   ///< pressure solves
  double predictor = 0;  ///< implicit momentum
  double closure = 0;    ///< flux closure, velocity and gradient rebuilt from the fluxes
};

/// Gives the time since it was last asked, or since it was made.
class LapClock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> spent = now - last_;
    last_ = now;
    return spent.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace fluxpact
