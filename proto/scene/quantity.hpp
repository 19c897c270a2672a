// Numbers as they stand in a scene: strict decimal text, with or without a unit that is checked.
#pragma once

#include <limits>
#include <string>
#include <string_view>

namespace fluxpact {

/// What a number of the scene measures.
enum class Dimension {
  none,
  time,
  length,
  velocity,
  acceleration,
  density,
  pressure,
  viscosity,
  stiffness,
  mass_flow,
  diffusivity,
  conductivity,
  heat_capacity,
  energy_density,
  surface_energy,
  volume,
  angle,
};

/// The SI unit in which numbers without a suffix are taken, e.g. "m/s"; empty for Dimension::none.
std::string_view si_unit(Dimension dimension);

/// All suffixes that a number of this dimension may carry, e.g. "s, ms, us".
std::string unit_suffixes(Dimension dimension);

/// The numbers that a key allows.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool without_lower = false;  ///< the lower end itself is not allowed
  bool without_upper = false;

  bool holds(double value) const;
  std::string text() const;  ///< "> 0", "0 .. 1", ...; empty if everything is allowed
};

inline constexpr Range any_number{};
inline constexpr Range positive{.lower = 0, .without_lower = true};
inline constexpr Range not_negative{.lower = 0};

/// A value, or the reason why the text is none.
template <class T>
struct Parsed {
  T value{};
  std::string problem;
};

/// Decimal text with an optional suffix of the dimension, in SI units. The suffix shifts the
/// decimal exponent, so `2 mm` and `2e-3` are the same bits. Refuses what readers of YAML disagree
/// about: octal, hexadecimal, 1_000, .inf.
Parsed<double> parse_number(std::string_view text, Dimension dimension);

/// A whole decimal number that an int holds.
Parsed<int> parse_integer(std::string_view text);

}  // namespace fluxpact
