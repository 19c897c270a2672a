#include "proto/base/unit_formula.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

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
  if (above.empty()) above = "1";
  if (below.empty()) return above;
  return factors_below > 1 ? fmt::format("{}/({})", above, below)
                           : fmt::format("{}/{}", above, below);
}

/// Recursive descent: each rule appends to the program what puts its value on top of the stack.
class FormulaReader {
 public:
  FormulaReader(const std::string& text, std::span<const UnitFormula::Variable> variables,
                std::span<const UnitFormula::Constant> constants)
      : text_(text), variables_(variables), constants_(constants) {
    for (const UnitFormula::Constant& constant : constants_) check_name(constant.name);
  }

  Unit read() {
    const Term whole = choice();
    blanks();
    if (at_ < text_.size()) {
      refuse(at_, fmt::format("'{}' where an operator or the end is expected", text_[at_]));
    }
    return whole.unit;
  }

  std::vector<UnitFormula::Instruction> take() { return std::move(program_); }

 private:
  using Operation = UnitFormula::Operation;

  struct Term {
    Unit unit;
    std::optional<double> constant;  ///< the value if it depends on no variable
  };

  [[noreturn]] void refuse(std::size_t at, const std::string& problem) const {
    throw ConfigError("formula '{}': {} (character {})", text_, problem, at + 1);
  }

  void check_name(const std::string& name) const {
    bool sound = !name.empty() && is_letter(name[0]) && name != "pi";
    for (const char c : name) sound = sound && (is_letter(c) || is_digit(c));
    for (const UnitFormula::Variable& variable : variables_) {
      sound = sound && variable.name != name;
    }
    if (!sound) {
      throw ConfigError(
          "constant '{}': a name in a formula is made of letters, digits and _, and is none of {}, "
          "pi",
          name, variable_list());
    }
  }

  std::string variable_list() const {
    std::string list;
    for (const UnitFormula::Variable& variable : variables_) {
      list += (list.empty() ? "" : ", ") + variable.name;
    }
    return list;
  }

  // ---- the text ----

  void blanks() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  /// Steps over `mark` if it comes next.
  bool comes(std::string_view mark) {
    blanks();
    if (text_.compare(at_, mark.size(), mark) != 0) return false;
    at_ += mark.size();
    return true;
  }
  void demand(std::string_view mark) {
    if (!comes(mark)) refuse(at_, fmt::format("'{}' is expected", mark));
  }

  // ---- the program ----

  Term push(const UnitFormula::Instruction& instruction, const Unit& unit) {
    if (++depth_ > UnitFormula::deepest)
      refuse(at_, "too many open operations; use fewer brackets");
    program_.push_back(instruction);
    if (instruction.operation != Operation::constant) return {unit, std::nullopt};
    return {unit, instruction.value};
  }

  /// An operation on the topmost terms; of constants its value is put in their place.
  Term combine(Operation operation, const Unit& unit, std::span<const Term> terms) {
    bool constant = true;
    for (const Term& term : terms) constant = constant && term.constant.has_value();
    depth_ -= static_cast<int>(terms.size()) - 1;
    if (!constant) {
      program_.push_back({operation});
      return {unit, std::nullopt};
    }
    std::array<double, 3> value{};
    for (std::size_t i = 0; i < terms.size(); ++i) value.at(i) = *terms[i].constant;
    program_.resize(program_.size() - terms.size());
    program_.push_back(
        {Operation::constant, UnitFormula::apply(operation, value[0], value[1], value[2])});
    return {unit, program_.back().value};
  }

  // ---- units ----

  void demand_same(std::size_t at, std::string_view sign, const Unit& left, const Unit& right) {
    if (!(left == right)) {
      refuse(at, fmt::format("`{}` between {} and {}; both need the same unit", sign,
                             unit_text(left), unit_text(right)));
    }
  }
  void demand_plain(std::size_t at, std::string_view what, const Unit& unit) {
    if (!unit.plain()) {
      refuse(at, fmt::format("{} is in {}; a plain number is needed", what, unit_text(unit)));
    }
  }

  // ---- the rules, from the loosest to the tightest ----

  Term choice() {
    constexpr int deepest = 64;
    if (++nested_ > deepest) refuse(at_, "too many brackets");
    const std::size_t start = at_;
    Term condition = either();
    if (comes("?")) {
      demand_plain(start, "the condition before `?`", condition.unit);
      const Term yes = choice();
      const std::size_t colon = at_;
      demand(":");
      const Term no = choice();
      demand_same(colon, ":", yes.unit, no.unit);
      condition = combine(Operation::choose, yes.unit, std::array{condition, yes, no});
    }
    --nested_;
    return condition;
  }

  template <class Rule>
  Term logical(std::string_view mark, Operation operation, const Rule& tighter) {
    std::size_t start = at_;
    Term left = tighter();
    while (comes(mark)) {
      demand_plain(start, fmt::format("what stands before `{}`", mark), left.unit);
      start = at_;
      const Term right = tighter();
      demand_plain(start, fmt::format("what stands after `{}`", mark), right.unit);
      left = combine(operation, {}, std::array{left, right});
    }
    return left;
  }
  Term either() {
    return logical("||", Operation::either, [this] { return both(); });
  }
  Term both() {
    return logical("&&", Operation::both, [this] { return comparison(); });
  }

  Term comparison() {
    static constexpr auto signs = std::to_array<std::pair<std::string_view, Operation>>({
        {"<=", Operation::less_equal},
        {">=", Operation::greater_equal},
        {"==", Operation::equal},
        {"!=", Operation::not_equal},
        {"<", Operation::less},
        {">", Operation::greater},
    });
    const Term left = sum();
    blanks();
    const std::size_t at = at_;
    for (const auto& [sign, operation] : signs) {
      if (!comes(sign)) continue;
      const Term right = sum();
      demand_same(at, sign, left.unit, right.unit);
      return combine(operation, {}, std::array{left, right});
    }
    return left;
  }

  Term sum() {
    Term left = product();
    for (;;) {
      blanks();
      const std::size_t at = at_;
      const bool plus = comes("+");
      if (!plus && !comes("-")) return left;
      const Term right = product();
      demand_same(at, plus ? "+" : "-", left.unit, right.unit);
      left =
          combine(plus ? Operation::add : Operation::subtract, left.unit, std::array{left, right});
    }
  }

  Term product() {
    Term left = signed_power();
    for (;;) {
      const bool times = comes("*");
      if (!times && !comes("/")) return left;
      const Term right = signed_power();
      left = combine(times ? Operation::multiply : Operation::divide,
                     left.unit * right.unit.power(times ? 1 : -1), std::array{left, right});
    }
  }

  Term signed_power() {
    bool minus = false;
    for (bool more = true; more;) {
      const bool turns = comes("-");
      more = turns || comes("+");
      minus = minus != turns;
    }
    const Term term = power();
    return minus ? combine(Operation::negate, term.unit, std::array{term}) : term;
  }

  Term power() {
    const Term base = primary();
    blanks();
    const std::size_t at = at_;
    if (!comes("^")) return base;
    const Term exponent = signed_power();
    demand_plain(at, "the exponent", exponent.unit);
    if (!exponent.constant) {
      demand_plain(at, "the base of `^` with an exponent that varies", base.unit);
      return combine(Operation::power, {}, std::array{base, exponent});
    }
    const Unit unit = base.unit.power(*exponent.constant);
    const std::optional<Operation> direct = direct_power(*exponent.constant);
    if (base.constant || !direct)
      return combine(Operation::power, unit, std::array{base, exponent});
    program_.pop_back();  // the exponent
    --depth_;
    return combine(*direct, unit, std::array{base});
  }

  static std::optional<Operation> direct_power(double exponent) {
    if (exponent == 2) return Operation::square;
    if (exponent == 3) return Operation::cube;
    if (exponent == -1) return Operation::reciprocal;
    if (exponent == 0.5) return Operation::square_root;
    return std::nullopt;
  }

  Term primary() {
    blanks();
    const std::size_t start = at_;
    if (comes("(")) {
      const Term inner = choice();
      demand(")");
      return inner;
    }
    if (at_ < text_.size() && (is_digit(text_[at_]) || text_[at_] == '.')) return number();
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string name = text_.substr(start, at_ - start);
    if (name.empty()) {
      refuse(start, start < text_.size()
                        ? fmt::format("'{}' where a value is expected", text_[start])
                        : "it ends where a value is expected");
    }
    if (comes("(")) return function(start, name);
    return named(start, name);
  }

  Term number() {
    double value = 0;
    const char* const begin = text_.data() + at_;
    const auto read = std::from_chars(begin, text_.data() + text_.size(), value);
    if (read.ec != std::errc() || !std::isfinite(value)) refuse(at_, "not a number of a double");
    at_ += static_cast<std::size_t>(read.ptr - begin);
    if (at_ < text_.size() && (is_letter(text_[at_]) || text_[at_] == '.')) {
      refuse(at_, "a number carries no unit here: name it in `constants`, or put an operator");
    }
    return push({Operation::constant, value}, {});
  }

  Term named(std::size_t start, const std::string& name) {
    if (name == "pi") return push({Operation::constant, std::numbers::pi}, {});
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      if (variables_[i].name == name) {
        return push({Operation::variable, 0, static_cast<int>(i)}, variables_[i].unit);
      }
    }
    std::string known;
    for (const UnitFormula::Constant& constant : constants_) {
      if (constant.name == name) return push({Operation::constant, constant.value}, constant.unit);
      known += ", " + constant.name;
    }
    refuse(start, fmt::format("'{}' is not known; variables and constants are {}, pi{}", name,
                              variable_list(), known));
  }

  struct Function {
    std::string_view name;
    Operation operation;
    int arguments;
    bool keeps_unit;
  };

  Term function(std::size_t start, const std::string& name) {
    static constexpr auto known = std::to_array<Function>({
        {"sqrt", Operation::square_root, 1, true},
        {"abs", Operation::absolute, 1, true},
        {"min", Operation::minimum, 2, true},
        {"max", Operation::maximum, 2, true},
        {"exp", Operation::exponential, 1, false},
        {"ln", Operation::natural_logarithm, 1, false},
        {"log10", Operation::decimal_logarithm, 1, false},
        {"tanh", Operation::hyperbolic_tangent, 1, false},
        {"atan", Operation::arc_tangent, 1, false},
    });
    const auto* const found =
        std::find_if(known.begin(), known.end(), [&](const Function& f) { return f.name == name; });
    if (found == known.end()) {
      refuse(start, fmt::format("there is no function '{}'; known: sqrt, exp, ln, log10, tanh, "
                                "atan, abs, min, max",
                                name));
    }
    const Term first = choice();
    if (!found->keeps_unit) demand_plain(start, fmt::format("what `{}` takes", name), first.unit);
    if (found->arguments == 2) {
      demand(",");
      const Term second = choice();
      demand_same(start, name, first.unit, second.unit);
      demand(")");
      return combine(found->operation, first.unit, std::array{first, second});
    }
    demand(")");
    const bool root = found->operation == Operation::square_root;
    return combine(found->operation, first.unit.power(root ? 0.5 : 1), std::array{first});
  }

  const std::string& text_;
  std::span<const UnitFormula::Variable> variables_;
  std::span<const UnitFormula::Constant> constants_;
  std::size_t at_ = 0;
  int nested_ = 0;
  int depth_ = 0;
  std::vector<UnitFormula::Instruction> program_;
};

UnitFormula::UnitFormula(const std::string& text, std::span<const Variable> variables,
                         std::span<const Constant> constants) {
  FormulaReader reader(text, variables, constants);
  unit_ = reader.read();
  program_ = reader.take();
}

// One value by way of a block: the same code, and so the same bits, as in the loop.
double UnitFormula::apply(Operation operation, double a, double b, double c) {
  std::array<Values, 3> stack{};
  stack[0][0] = a;
  stack[1][0] = b;
  stack[2][0] = c;
  return apply(operation, stack.data() + arguments(operation) - 1)[0];
}

int UnitFormula::arguments(Operation operation) {
  switch (operation) {
    case Operation::constant:
    case Operation::variable:
      return 0;
    case Operation::negate:
    case Operation::square:
    case Operation::cube:
    case Operation::reciprocal:
    case Operation::square_root:
    case Operation::exponential:
    case Operation::natural_logarithm:
    case Operation::decimal_logarithm:
    case Operation::hyperbolic_tangent:
    case Operation::arc_tangent:
    case Operation::absolute:
      return 1;
    case Operation::choose:
      return 3;
    default:
      return 2;
  }
}

namespace {

using Values = UnitFormula::Values;

template <class Function>
void of_one(Values& a, const Function& function) {
  for (double& value : a) value = function(value);
}
template <class Function>
void of_two(Values& a, const Values& b, const Function& function) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = function(a[i], b[i]);
}

}  // namespace

// Takes its arguments from the stack whose top is given, and puts the result in place of the first.
UnitFormula::Values& UnitFormula::apply(Operation operation, Values* top) {
  Values& a = *(top - (arguments(operation) - 1));
  const Values& b = *top;  // of two arguments the second
  switch (operation) {
    case Operation::constant:
    case Operation::variable:
      break;  // evaluate() has put them there
    case Operation::add:
      of_two(a, b, [](double x, double y) { return x + y; });
      break;
    case Operation::subtract:
      of_two(a, b, [](double x, double y) { return x - y; });
      break;
    case Operation::multiply:
      of_two(a, b, [](double x, double y) { return x * y; });
      break;
    case Operation::divide:
      of_two(a, b, [](double x, double y) { return x / y; });
      break;
    case Operation::power:
      of_two(a, b, [](double x, double y) { return std::pow(x, y); });
      break;
    case Operation::minimum:
      of_two(a, b, [](double x, double y) { return y < x ? y : x; });
      break;
    case Operation::maximum:
      of_two(a, b, [](double x, double y) { return x < y ? y : x; });
      break;
    case Operation::less:
      of_two(a, b, [](double x, double y) { return x < y ? 1.0 : 0.0; });
      break;
    case Operation::less_equal:
      of_two(a, b, [](double x, double y) { return x <= y ? 1.0 : 0.0; });
      break;
    case Operation::greater:
      of_two(a, b, [](double x, double y) { return x > y ? 1.0 : 0.0; });
      break;
    case Operation::greater_equal:
      of_two(a, b, [](double x, double y) { return x >= y ? 1.0 : 0.0; });
      break;
    case Operation::equal:
      of_two(a, b, [](double x, double y) { return x == y ? 1.0 : 0.0; });
      break;
    case Operation::not_equal:
      of_two(a, b, [](double x, double y) { return x != y ? 1.0 : 0.0; });
      break;
    case Operation::both:
      of_two(a, b, [](double x, double y) { return x != 0 && y != 0 ? 1.0 : 0.0; });
      break;
    case Operation::either:
      of_two(a, b, [](double x, double y) { return x != 0 || y != 0 ? 1.0 : 0.0; });
      break;
    case Operation::choose:
      for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] != 0 ? (*(top - 1))[i] : b[i];
      break;
    default:
      apply_function(operation, a);
  }
  return a;
}

void UnitFormula::apply_function(Operation operation, Values& a) {
  switch (operation) {
    case Operation::negate:
      return of_one(a, [](double x) { return -x; });
    case Operation::square:
      return of_one(a, [](double x) { return x * x; });
    case Operation::cube:
      return of_one(a, [](double x) { return x * x * x; });
    case Operation::reciprocal:
      return of_one(a, [](double x) { return 1 / x; });
    case Operation::square_root:
      return of_one(a, [](double x) { return std::sqrt(x); });
    case Operation::exponential:
      return of_one(a, [](double x) { return std::exp(x); });
    case Operation::natural_logarithm:
      return of_one(a, [](double x) { return std::log(x); });
    case Operation::decimal_logarithm:
      return of_one(a, [](double x) { return std::log10(x); });
    case Operation::hyperbolic_tangent:
      return of_one(a, [](double x) { return std::tanh(x); });
    case Operation::arc_tangent:
      return of_one(a, [](double x) { return std::atan(x); });
    case Operation::absolute:
      return of_one(a, [](double x) { return std::abs(x); });
    default:
      throw std::logic_error("an operation of a formula is not one of one argument");
  }
}

void UnitFormula::evaluate(std::span<const Values> inputs, Values& result) const {
  std::array<Values, deepest> stack;  // NOLINT(*-member-init): written before it is read
  Values* top = stack.data() - 1;
  for (const Instruction& instruction : program_) {
    if (instruction.operation == Operation::constant) {
      (++top)->fill(instruction.value);
    } else if (instruction.operation == Operation::variable) {
      *++top = inputs[static_cast<std::size_t>(instruction.variable)];
    } else {
      apply(instruction.operation, top);
      top -= arguments(instruction.operation) - 1;
    }
  }
  result = stack[0];
}

}  // namespace fluxpact
