#include "proto/base/unit_formula.hpp"

#include <cmath>
#include <stdexcept>

namespace fluxpact {

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
