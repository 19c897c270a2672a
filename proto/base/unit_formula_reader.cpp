// From the text of a formula to its program, with its units checked on the way.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "proto/base/errors.hpp"
#include "proto/base/unit_formula.hpp"

namespace fluxpact {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

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

}  // namespace fluxpact
