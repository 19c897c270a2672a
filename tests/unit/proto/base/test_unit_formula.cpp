#include "proto/base/unit_formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

const std::vector<UnitFormula::Variable> variables{
    {"length", {0, 1, 0}}, {"speed", {0, 1, -1}}, {"share", {}}};
const std::vector<UnitFormula::Constant> constants{{"pull", {0, 1, -2}, 9.81}, {"twice", {}, 2}};

/// Its value at length 3 m, speed 5 m/s, share 0.5.
double value(const std::string& text) {
  const UnitFormula formula(text, variables, constants);
  std::vector<UnitFormula::Values> inputs(3);
  inputs[0].fill(3);
  inputs[1].fill(5);
  inputs[2].fill(0.5);
  UnitFormula::Values result{};
  formula.evaluate(inputs, result);
  EXPECT_EQ(result.front(), result.back());
  return result.front();
}

std::string unit(const std::string& text) {
  return unit_text(UnitFormula(text, variables, constants).unit());
}

std::string refusal(const std::string& text) {
  try {
    const UnitFormula formula(text, variables, constants);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

void expect_refusal(const std::string& text, const std::string& part) {
  const std::string message = refusal(text);
  EXPECT_NE(message.find(part), std::string::npos) << text << " -> " << message;
}

TEST(UnitFormula, binds_as_one_writes) {
  EXPECT_EQ(value("1 + 2 * 3 ^ 2"), 19);
  EXPECT_EQ(value("-3 ^ 2"), -9);
  EXPECT_EQ(value("2 ^ 3 ^ 2"), 512);
  EXPECT_EQ(value("2 ^ -1"), 0.5);
  EXPECT_EQ(value("8 / 4 / 2"), 1);
  EXPECT_EQ(value("8 - 4 - 2"), 2);
  EXPECT_EQ(value("(8 - 4) * -2"), -8);
  EXPECT_EQ(value("--3 - -+2"), 5);
  EXPECT_EQ(value("1.5e1 + .5"), 15.5);
  EXPECT_EQ(value("1 < 2 && 2 <= 2 || 0 ? 7 : 8"), 7);
  EXPECT_EQ(value("0 ? 1 : 0 ? 2 : 3"), 3);
  EXPECT_EQ(value("(2 > 1) + (2 >= 2) + (1 == 1) + (1 != 1)"), 3);
}

TEST(UnitFormula, gives_the_values_of_its_variables_and_constants) {
  EXPECT_EQ(value("length / speed"), 0.6);
  EXPECT_EQ(value("twice * share"), 1);
  EXPECT_EQ(value("max(length, 4 * length) - min(length, 2 * length)"), 9);
  EXPECT_EQ(value("share < 0.8 ? length : 2 * length"), 3);
  EXPECT_EQ(value("share >= 0.8 ? length : 2 * length"), 6);
  EXPECT_EQ(value("speed ^ 2"), 25);
  EXPECT_EQ(value("speed ^ 3"), 125);
  EXPECT_EQ(value("speed ^ -1"), 0.2);
  EXPECT_EQ(value("speed ^ 0.5"), std::sqrt(5.0));
  EXPECT_EQ(value("speed ^ 1.7"), std::pow(5.0, 1.7));
  EXPECT_EQ(value("share ^ share"), std::pow(0.5, 0.5));
  EXPECT_EQ(value("abs(share - 1)"), 0.5);
  EXPECT_EQ(value("sqrt(pull * length)"), std::sqrt(9.81 * 3));
  EXPECT_EQ(value("exp(share) + ln(share) + log10(share) + tanh(share) + atan(share)"),
            std::exp(0.5) + std::log(0.5) + std::log10(0.5) + std::tanh(0.5) + std::atan(0.5));
  EXPECT_EQ(value("pi"), std::numbers::pi);
}

TEST(UnitFormula, takes_the_branch_that_is_finite) {
  EXPECT_EQ(value("share > 0 ? 1 : ln(share - 1)"), 1);
  EXPECT_EQ(value("share > 1 ? 1 / (share - 0.5) : 2"), 2);
}

TEST(UnitFormula, is_evaluated_point_by_point) {
  const UnitFormula formula("share < 0.5 ? length * share : length", variables, constants);
  std::vector<UnitFormula::Values> inputs(3);
  for (std::size_t i = 0; i < UnitFormula::block; ++i) {
    inputs[0][i] = static_cast<double>(i);
    inputs[2][i] = static_cast<double>(i) / UnitFormula::block;
  }
  UnitFormula::Values result{};
  formula.evaluate(inputs, result);
  for (std::size_t i = 0; i < UnitFormula::block; ++i) {
    const double share = inputs[2][i];
    EXPECT_EQ(result[i], share < 0.5 ? inputs[0][i] * share : inputs[0][i]);
  }
}

TEST(UnitFormula, works_out_the_unit) {
  EXPECT_EQ(unit("length / speed"), "s");
  EXPECT_EQ(unit("speed ^ 2 / pull"), "m");
  EXPECT_EQ(unit("sqrt(pull * length)"), "m/s");
  EXPECT_EQ(unit("1 / (length * speed)"), "s/m2");
  EXPECT_EQ(unit("(length ^ 0.657) ^ 2 * length ^ -0.314"), "m");
  EXPECT_EQ(unit("speed / pull / length"), "s/m");
  EXPECT_EQ(unit("length > 2 * length ? share : 1"), "1");
  EXPECT_EQ(unit("speed ^ twice"), "m2/s2");
}

TEST(UnitFormula, refuses_what_does_not_fit_at_its_place) {
  expect_refusal("length + speed", "`+` between m and m/s; both need the same unit (character 8)");
  expect_refusal("1 - length", "`-` between 1 and m");
  expect_refusal("share * (1 + 0.15 * length)", "(character 12)");
  expect_refusal("length < speed ? 1 : 2", "`<` between m and m/s");
  expect_refusal("share < 1 ? length : 1", "`:` between m and 1");
  expect_refusal("length ? 1 : 2", "the condition before `?` is in m");
  expect_refusal("length && 1", "what stands before `&&` is in m");
  expect_refusal("1 || speed", "what stands after `||` is in m/s");
  expect_refusal("min(length, 1)", "`min` between m and 1");
  expect_refusal("exp(length)", "what `exp` takes is in m; a plain number is needed (character 1)");
  expect_refusal("2 ^ length", "the exponent is in m");
  expect_refusal("length ^ share", "the base of `^` with an exponent that varies is in m");
}

TEST(UnitFormula, refuses_what_it_cannot_read_at_its_place) {
  expect_refusal("", "it ends where a value is expected (character 1)");
  expect_refusal("1 +", "it ends where a value is expected (character 4)");
  expect_refusal("(1", "')' is expected (character 3)");
  expect_refusal("1 2", "'2' where an operator or the end is expected (character 3)");
  expect_refusal("1 < 2 < 3", "'<' where an operator or the end is expected (character 7)");
  expect_refusal("2 m/s", "'m' where an operator");
  expect_refusal("2m", "a number carries no unit here");
  expect_refusal("1e999", "not a number of a double");
  expect_refusal("width", "'width' is not known; variables and constants are length, speed, share");
  expect_refusal("sin(1)", "there is no function 'sin'");
  expect_refusal("min(1)", "',' is expected");
  expect_refusal("x = 1", "'x' is not known");
  expect_refusal("share = 1", "'=' where an operator or the end is expected");
  expect_refusal("share ? 1", "':' is expected");
  expect_refusal(std::string(1000, '('), "too many brackets");
  std::string deep = "share";
  for (int i = 0; i < 40; ++i) deep = "share + share * (" + deep + ")";
  expect_refusal(deep, "too many open operations");
  EXPECT_EQ(refusal(std::string(100000, '-') + "1"), "");
}

TEST(UnitFormula, refuses_constants_that_cannot_be_named) {
  const auto refused = [](const std::string& name) {
    try {
      const UnitFormula formula("1", variables, std::vector<UnitFormula::Constant>{{name, {}, 1}});
    } catch (const ConfigError& error) {
      return std::string(error.what()).find("constant '" + name + "'") == 0;
    }
    return false;
  };
  EXPECT_TRUE(refused("length"));
  EXPECT_TRUE(refused("pi"));
  EXPECT_TRUE(refused("a-b"));
  EXPECT_FALSE(refused("a_b"));
}

TEST(UnitFormula, answers_to_any_text) {
  // Random strings of what formulas are made of: a formula, or a ConfigError.
  const std::vector<std::string> parts{"1", "length", "share", "+",     "-",  "*",   "/",    "^",
                                       "(", ")",      "?",     ":",     "<",  "==",  ",",    " ",
                                       ".", "e",      "max",   "sqrt(", "&&", "3.5", "twice"};
  std::mt19937_64 random(7);
  int read = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (auto n = random() % 9; n > 0; --n) text += parts[random() % parts.size()];
    read += refusal(text).empty() ? 1 : 0;
  }
  EXPECT_GT(read, 100);
}

TEST(Units, are_read_and_written) {
  EXPECT_EQ(unit_text(parse_unit("1")), "1");
  EXPECT_EQ(unit_text(parse_unit("kg/(m3.s)")), "kg/(m3.s)");
  EXPECT_EQ(unit_text(parse_unit("kg/m3/s")), "kg/(m3.s)");
  EXPECT_EQ(unit_text(parse_unit("Pa.s")), "kg/(m.s)");
  EXPECT_EQ(unit_text(parse_unit("N")), "kg.m/s2");
  EXPECT_EQ(unit_text(parse_unit("W/J")), "1/s");
  EXPECT_EQ(unit_text(parse_unit("1/Hz")), "s");
  for (const char* text : {"", "kg m", "mm", "kg/(m", "m0", "m10", "2", "kg//s", "((((((((((m"}) {
    EXPECT_THROW(parse_unit(text), ConfigError) << text;
  }
}

}  // namespace
}  // namespace fluxpact
