// Uniform random numbers whose bits do not depend on the standard library.
#pragma once

#include <cstdint>
#include <random>

namespace fluxpact {

/// std::mt19937_64 is fixed by the standard to the bit; its distributions are not, so we make the
/// doubles.
class UniformRandom {
 public:
  explicit UniformRandom(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1), with 53 random bits.
  double next() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fluxpact
