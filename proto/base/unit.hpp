// Units of quantities, for formulas that a scene gives.
#pragma once

#include <string>
#include <string_view>

namespace fluxpact {

/// Powers of the SI units kg, m, s; all 0: a plain number.
struct Unit {
  double kg = 0;
  double m = 0;
  double s = 0;

  Unit operator*(const Unit& other) const { return {kg + other.kg, m + other.m, s + other.s}; }
  Unit power(double exponent) const { return {kg * exponent, m * exponent, s * exponent}; }
  /// Equal but for round-off of fractional powers.
  bool operator==(const Unit& other) const;
  bool plain() const { return *this == Unit{}; }
};

/// From "1", "m/s", "Pa.s", "kg/(m3.s)": m, s, kg, N, Pa, J, W, Hz, powers as digits behind the
/// name. Throws ConfigError with the place in the text.
Unit parse_unit(std::string_view text);

/// "kg/(m3.s)"; "1" for a plain number.
std::string unit_text(const Unit& unit);

}  // namespace fluxpact
