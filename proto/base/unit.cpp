#include "proto/base/unit.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

struct NamedUnit {
  std::string_view name;
  Unit unit;
};
constexpr auto known_units = std::to_array<NamedUnit>({
    {"kg", {1, 0, 0}},
    {"m", {0, 1, 0}},
    {"s", {0, 0, 1}},
    {"N", {1, 1, -2}},
    {"Pa", {1, -1, -2}},
    {"J", {1, 2, -2}},
    {"W", {1, 2, -3}},
    {"Hz", {0, 0, -1}},
});

/// Reads "kg/(m3.s)" from left to right.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : text_(text) {}

  Unit read() {
    const Unit unit = product(0);
    if (at_ < text_.size()) refuse(fmt::format("'{}' is not expected here", text_[at_]));
    return unit;
  }

 private:
  [[noreturn]] void refuse(const std::string& problem) const {
    throw ConfigError(
        "unit '{}': {} (character {}); expected m, s, kg, N, Pa, J, W, Hz with digits as powers, "
        "`.`, `/` and brackets, e.g. kg/(m3.s), or 1",
        text_, problem, at_ + 1);
  }

  Unit product(int depth) {
    Unit unit = factor(depth);
    while (at_ < text_.size() && (text_[at_] == '.' || text_[at_] == '/')) {
      const double sign = text_[at_++] == '.' ? 1 : -1;
      unit = unit * factor(depth).power(sign);
    }
    return unit;
  }

  Unit factor(int depth) {
    constexpr int deepest = 8;
    if (at_ >= text_.size()) refuse("it ends where a unit is expected");
    if (text_[at_] == '(') {
      if (depth == deepest) refuse("too many brackets");
      ++at_;
      const Unit unit = product(depth + 1);
      if (at_ >= text_.size() || text_[at_] != ')') refuse("')' is missing");
      ++at_;
      return unit;
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
    const std::string_view name = text_.substr(start, at_ - start);
    if (name.empty()) {
      if (text_[at_] != '1') refuse("a unit is expected");
      ++at_;
      return {};
    }
    for (const NamedUnit& known : known_units) {
      if (known.name == name) return known.unit.power(digits());
    }
    at_ = start;
    refuse(fmt::format("'{}' is not known", name));
  }

  double digits() {
    int value = 1;
    const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (read.ec == std::errc::invalid_argument) return 1;
    if (read.ec != std::errc() || value < 1 || value > 9) refuse("a power is 1 to 9");
    at_ = static_cast<std::size_t>(read.ptr - text_.data());
    return value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

bool Unit::operator==(const Unit& other) const {
  constexpr double round_off = 1e-9;  // powers such as 0.687 are added up in decimal text
  return std::abs(kg - other.kg) < round_off && std::abs(m - other.m) < round_off &&
         std::abs(s - other.s) < round_off;
}

Unit parse_unit(std::string_view text) { return UnitReader(text).read(); }

std::string unit_text(const Unit& unit) {
  std::string above;
  std::string below;
  int factors_below = 0;
  const auto put = [&](std::string_view name, double power) {
    if (Unit{power, 0, 0}.plain()) return;
    std::string& part = power > 0 ? above : below;
    if (power < 0) ++factors_below;
    const double size = std::abs(power);
    part += fmt::format("{}{}{}", part.empty() ? "" : ".", name,
                        size == 1 ? std::string{} : fmt::format("{:.6g}", size));
  };
  put("kg", unit.kg);
  put("m", unit.m);
  put("s", unit.s);
  if (above.empty()) above += '1';
  if (below.empty()) return above;
  return factors_below > 1 ? fmt::format("{}/({})", above, below)
                           : fmt::format("{}/{}", above, below);
}

}  // namespace fluxpact
