// A sum whose rounding error does not grow with the number of terms.
#pragma once

#include <cmath>

namespace fluxpact {

/// Neumaier's variant of Kahan summation (Neumaier, ZAMM 54, 1974, 39-51). Units: those of the
/// terms.
class CompensatedSum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    compensation_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  double value() const { return sum_ + compensation_; }

 private:
  double sum_ = 0.0;
  double compensation_ = 0.0;
};

}  // namespace fluxpact
