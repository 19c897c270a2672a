// Formulas of quantities with units: a text is read once, its units are checked operation by
// operation, and it is then evaluated for many points at a time. For what a scene lets the user
// write in the place of a law (a drag law of one's own); formulas in place and time are
// expression.hpp.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "proto/base/unit.hpp"

namespace fluxpact {

/// A formula with + - * / ^, < <= > >= == != && ||, ?:, the functions sqrt, exp, ln, log10, tanh,
/// atan, abs, min, max, and pi. Numbers in it are plain; what has a unit is a variable or a named
/// constant.
class UnitFormula {
 public:
  struct Variable {
    std::string name;
    Unit unit;
  };
  struct Constant {
    std::string name;
    Unit unit;
    double value = 0;
  };

  /// Throws ConfigError with the place in the text (characters count from 1): it cannot be read,
  /// names something unknown, or puts together what does not have the same unit.
  UnitFormula(const std::string& text, std::span<const Variable> variables,
              std::span<const Constant> constants);

  const Unit& unit() const { return unit_; }

  static constexpr int block = 64;  ///< points at a time
  using Values = std::array<double, block>;

  /// result[i] from inputs[v][i], v in the order of the variables. Rows of the block that the
  /// caller does not need may hold anything. Both branches of ?: are evaluated, one is taken. Does
  /// not allocate; many threads may call at once.
  void evaluate(std::span<const Values> inputs, Values& result) const;

 private:
  friend class FormulaReader;

  enum class Operation {
    constant,
    variable,
    add,
    subtract,
    multiply,
    divide,
    negate,
    power,
    square,
    cube,
    reciprocal,
    square_root,
    exponential,
    natural_logarithm,
    decimal_logarithm,
    hyperbolic_tangent,
    arc_tangent,
    absolute,
    minimum,
    maximum,
    less,
    less_equal,
    greater,
    greater_equal,
    equal,
    not_equal,
    both,
    either,
    choose,
  };
  struct Instruction {
    Operation operation = Operation::constant;
    double value = 0;  ///< of a constant
    int variable = 0;  ///< number of a variable
  };
  static constexpr int deepest = 24;  ///< blocks on the stack of a thread while it evaluates
  static int arguments(Operation operation);
  static Values& apply(Operation operation, Values* top);
  static void apply_function(Operation operation, Values& a);
  static double apply(Operation operation, double a, double b, double c);

  std::vector<Instruction> program_;  ///< postfix
  Unit unit_;
};

}  // namespace fluxpact
