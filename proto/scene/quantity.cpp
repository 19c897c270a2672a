#include "proto/scene/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

namespace fluxpact {
namespace {

/// Every unit of the table is a power of ten of the SI unit, which keeps the conversion exact.
struct Suffix {
  std::string_view name;
  Dimension dimension = Dimension::none;
  int exponent = 0;
};

/// The SI unit of a dimension comes first.
constexpr auto suffixes = std::to_array<Suffix>({
    {"s", Dimension::time, 0},
    {"ms", Dimension::time, -3},
    {"us", Dimension::time, -6},
    {"m", Dimension::length, 0},
    {"cm", Dimension::length, -2},
    {"mm", Dimension::length, -3},
    {"um", Dimension::length, -6},
    {"m/s", Dimension::velocity, 0},
    {"cm/s", Dimension::velocity, -2},
    {"mm/s", Dimension::velocity, -3},
    {"m/s2", Dimension::acceleration, 0},
    {"kg/m3", Dimension::density, 0},
    {"Pa", Dimension::pressure, 0},
    {"kPa", Dimension::pressure, 3},
    {"MPa", Dimension::pressure, 6},
    {"GPa", Dimension::pressure, 9},
    {"Pa.s", Dimension::viscosity, 0},
    {"N/m", Dimension::stiffness, 0},
    {"kg/s", Dimension::mass_flow, 0},
    {"g/s", Dimension::mass_flow, -3},
    {"m2/s", Dimension::diffusivity, 0},
    {"W/(m.K)", Dimension::conductivity, 0},
    {"J/(kg.K)", Dimension::heat_capacity, 0},
    {"J/m3", Dimension::energy_density, 0},
    {"kJ/m3", Dimension::energy_density, 3},
    {"J/m2", Dimension::surface_energy, 0},
    {"mJ/m2", Dimension::surface_energy, -3},
    {"m3", Dimension::volume, 0},
    {"cm3", Dimension::volume, -6},
    {"mm3", Dimension::volume, -9},
    {"rad", Dimension::angle, 0},
});

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::size_t digits_from(std::string_view text, std::size_t start) {
  std::size_t end = start;
  while (end < text.size() && is_digit(text[end])) {
    ++end;
  }
  return end;
}

/// Where sign, digits, point and exponent of a decimal number end.
struct Decimal {
  std::size_t mantissa_end = 0;
  std::size_t end = 0;  ///< 0: no decimal number stands at the start
};

Decimal scan_decimal(std::string_view text) {
  const std::size_t start = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  std::size_t end = digits_from(text, start);
  std::size_t digits = end - start;
  if (end < text.size() && text[end] == '.') {
    const std::size_t fraction = end + 1;
    end = digits_from(text, fraction);
    digits += end - fraction;
  }
  if (digits == 0) {
    return {};
  }
  Decimal decimal{end, end};
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    std::size_t exponent = end + 1;
    if (exponent < text.size() && (text[exponent] == '-' || text[exponent] == '+')) {
      ++exponent;
    }
    const std::size_t exponent_end = digits_from(text, exponent);
    if (exponent_end > exponent) {
      decimal.end = exponent_end;
    }
  }
  return decimal;
}

bool has_leading_zero(std::string_view text) {
  const std::size_t start = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  return text.size() > start + 1 && text[start] == '0' && is_digit(text[start + 1]);
}

bool is_prefixed(std::string_view text) {
  return text.size() > 1 && text[0] == '0' && (text[1] == 'x' || text[1] == 'o' || text[1] == 'b');
}

bool is_not_finite(std::string_view text) {
  std::string word;
  for (const char c : text) {
    if (c != '+' && c != '-' && c != '.') {
      word += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  return word == "inf" || word == "infinity" || word == "nan";
}

std::string why_not_decimal(std::string_view text) {
  if (is_not_finite(text)) {
    return "not a finite number";
  }
  if (is_prefixed(text)) {
    return "only decimal numbers are read, not hexadecimal, octal or binary ones";
  }
  return {};
}

constexpr std::string_view leading_zero =
    "a leading zero makes it octal for other readers of YAML; write it without";

/// The number `text` x 10^shift, rounded once.
Parsed<double> parse_shifted(std::string_view text, const Decimal& decimal, int shift) {
  std::string digits(
      text.substr(text[0] == '+' ? 1 : 0, decimal.mantissa_end - (text[0] == '+' ? 1 : 0)));
  int exponent = 0;
  if (decimal.end > decimal.mantissa_end) {
    std::string_view part =
        text.substr(decimal.mantissa_end + 1, decimal.end - decimal.mantissa_end - 1);
    part.remove_prefix(part[0] == '+' ? 1 : 0);
    const auto read = std::from_chars(part.data(), part.data() + part.size(), exponent);
    constexpr int largest_exponent = 100000;  // far beyond every double; keeps the sum below an int
    if (read.ec != std::errc() || std::abs(exponent) > largest_exponent) {
      return {0, "too large or too small for a double"};
    }
  }
  digits += fmt::format("e{}", exponent + shift);
  double value = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (read.ec != std::errc()) {
    return {0, "too large or too small for a double"};
  }
  return {value, {}};
}

}  // namespace

std::string_view si_unit(Dimension dimension) {
  const auto* const found = std::find_if(suffixes.begin(), suffixes.end(),
                                         [&](const Suffix& s) { return s.dimension == dimension; });
  return found == suffixes.end() ? std::string_view{} : found->name;
}

std::string unit_suffixes(Dimension dimension) {
  std::string list;
  for (const Suffix& suffix : suffixes) {
    if (suffix.dimension == dimension) {
      list += fmt::format("{}{}", list.empty() ? "" : ", ", suffix.name);
    }
  }
  return list;
}

bool Range::holds(double value) const {
  const bool above = without_lower ? value > lower : value >= lower;
  const bool below = without_upper ? value < upper : value <= upper;
  return above && below;
}

std::string Range::text() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::string from =
      lower == -infinity ? std::string{} : fmt::format("{} {}", without_lower ? ">" : ">=", lower);
  const std::string to =
      upper == infinity ? std::string{} : fmt::format("{} {}", without_upper ? "<" : "<=", upper);
  return from.empty() || to.empty() ? from + to : fmt::format("{} and {}", from, to);
}

Parsed<double> parse_number(std::string_view text, Dimension dimension) {
  const Decimal decimal = scan_decimal(text);
  if (std::string problem = why_not_decimal(text); !problem.empty()) {
    return {0, problem};
  }
  if (decimal.end == 0) {
    return {0, "not a number"};
  }
  if (has_leading_zero(text)) {
    return {0, std::string(leading_zero)};
  }
  std::string_view unit = text.substr(decimal.end);
  const std::size_t blank = unit.find_first_not_of(' ');
  unit.remove_prefix(blank == std::string_view::npos ? unit.size() : blank);
  if (unit.empty()) {
    return parse_shifted(text, decimal, 0);
  }
  const auto* const known = std::find_if(suffixes.begin(), suffixes.end(),
                                         [&](const Suffix& s) { return s.name == unit; });
  if (dimension == Dimension::none) {
    return {0,
            fmt::format("`{}` cannot stand here: a plain number without unit is expected", unit)};
  }
  if (known == suffixes.end() || known->dimension != dimension) {
    return {0, fmt::format("the unit `{}` is {}; expected: {}", unit,
                           known == suffixes.end() ? "not known" : "of another dimension",
                           unit_suffixes(dimension))};
  }
  return parse_shifted(text, decimal, known->exponent);
}

Parsed<int> parse_integer(std::string_view text) {
  if (std::string problem = why_not_decimal(text); !problem.empty()) {
    return {0, problem};
  }
  const std::size_t start = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  if (text.size() == start || digits_from(text, start) != text.size()) {
    return {0, "not a whole number written in digits"};
  }
  if (has_leading_zero(text)) {
    return {0, std::string(leading_zero)};
  }
  text.remove_prefix(text[0] == '+' ? 1 : 0);
  int value = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc()) {
    return {0, fmt::format("beyond the limits {} .. {}", std::numeric_limits<int>::min(),
                           std::numeric_limits<int>::max())};
  }
  return {value, {}};
}

}  // namespace fluxpact
