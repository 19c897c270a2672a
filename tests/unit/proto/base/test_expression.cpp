#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "proto/base/errors.hpp"
#include "proto/base/expression.hpp"

namespace fluxpact {
namespace {

std::string refusal(const std::string& text) {
  try {
    const Expression expression(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Expression, evaluates_in_space_and_time) {
  const Expression expression("0.7 + 0.1*sin(2*pi*x)*exp(-t) + y^2*(z > 1 ? 1 : 0)");
  const double expected = 0.7 + 0.1 * std::sin(2 * std::numbers::pi * 0.2) * std::exp(-0.5) + 9;
  // A handful of operations on numbers below 10.
  EXPECT_NEAR(expression({0.2, 3, 2}, 0.5), expected, 1e-14);
  EXPECT_NEAR(expression({0.2, 3, 0}, 0.5), expected - 9, 1e-14);
}

TEST(Expression, can_be_moved_and_still_sees_its_variables) {
  Expression first("x + 10*y + 100*z + 1000*t");
  Expression second("1");
  second = std::move(first);
  EXPECT_EQ(second({1, 2, 3}, 4), 4321);
}

TEST(Expression, names_an_unknown_variable_and_its_place) {
  const std::string text = refusal("0.5 + radius");
  EXPECT_NE(text.find("radius"), std::string::npos) << text;
  EXPECT_NE(text.find("character 7"), std::string::npos) << text;
}

TEST(Expression, refuses_what_is_not_one_formula) {
  EXPECT_NE(refusal(""), "");
  EXPECT_NE(refusal("1 +"), "");
  EXPECT_NE(refusal("(x"), "");
  EXPECT_NE(refusal("1, 2").find("gives 2 values"), std::string::npos);
  EXPECT_NE(refusal("x = 1").find("assigns"), std::string::npos);
  EXPECT_EQ(refusal("x == 1 ? 2 : (y <= 1) + (z != 2) + (t >= 1)"), "");
}

}  // namespace
}  // namespace fluxpact
