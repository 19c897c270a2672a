#include <gtest/gtest.h>

#include "proto/scene/quantity.hpp"

namespace fluxpact {
namespace {

TEST(Quantity, is_a_plain_decimal_number) {
  for (const auto& [text, value] : {std::pair{"0", 0.0},
                                    {"-0", -0.0},
                                    {"1", 1.0},
                                    {"+2.5", 2.5},
                                    {".5", 0.5},
                                    {"5.", 5.0},
                                    {"1e-3", 1e-3},
                                    {"1.5E+3", 1500.0},
                                    {"-9.81", -9.81},
                                    {"0.1", 0.1}}) {
    const Parsed<double> parsed = parse_number(text, Dimension::none);
    EXPECT_EQ(parsed.problem, "") << text;
    EXPECT_EQ(parsed.value, value) << text;
  }
}

TEST(Quantity, with_a_unit_is_the_same_bits_as_the_si_number) {
  struct Case {
    const char* text;
    Dimension dimension;
    double si;
  };
  // Shifting the decimal exponent rounds once, so equality is exact; 1.1 * 0.001 would differ
  // from 1.1e-3.
  for (const Case& c : {Case{"1.1 mm", Dimension::length, 1.1e-3},
                        {"1.1mm", Dimension::length, 1.1e-3},
                        {"3 cm", Dimension::length, 0.03},
                        {"7 um", Dimension::length, 7e-6},
                        {"2 m", Dimension::length, 2.0},
                        {"1e-4 s", Dimension::time, 1e-4},
                        {"1.7 ms", Dimension::time, 1.7e-3},
                        {"9 us", Dimension::time, 9e-6},
                        {"20 m/s", Dimension::velocity, 20.0},
                        {"3 cm/s", Dimension::velocity, 0.03},
                        {"3 mm/s", Dimension::velocity, 3e-3},
                        {"-9.81 m/s2", Dimension::acceleration, -9.81},
                        {"2250 kg/m3", Dimension::density, 2250.0},
                        {"5 Pa", Dimension::pressure, 5.0},
                        {"1.3 kPa", Dimension::pressure, 1300.0},
                        {"1.8e-5 Pa.s", Dimension::viscosity, 1.8e-5},
                        {"1e3 N/m", Dimension::stiffness, 1e3},
                        {"2 kg/s", Dimension::mass_flow, 2.0},
                        {"1.1e+1 g/s", Dimension::mass_flow, 0.011}}) {
    const Parsed<double> parsed = parse_number(c.text, c.dimension);
    EXPECT_EQ(parsed.problem, "") << c.text;
    EXPECT_EQ(parsed.value, c.si) << c.text;
  }
}

TEST(Quantity, refuses_a_unit_of_another_dimension_and_names_the_right_ones) {
  EXPECT_EQ(parse_number("2 mm", Dimension::time).problem,
            "the unit `mm` is of another dimension; expected: s, ms, us");
  EXPECT_EQ(parse_number("2 foot", Dimension::length).problem,
            "the unit `foot` is not known; expected: m, cm, mm, um");
  EXPECT_NE(parse_number("2 mm", Dimension::none).problem.find("plain number"), std::string::npos);
}

TEST(Quantity, refuses_what_readers_of_yaml_disagree_about) {
  for (const char* text :
       {"012",   "-012", "00",  "0x1F", "0o14",  "0b1",    "1_000",         "1:30", ".inf",
        "-.inf", ".NaN", "nan", "inf",  "1e999", "1e-999", "1e99999999999", "",     "-",
        ".",     "e5",   "1e",  "abc",  "1 2",   "yes",    "1,5",           "--1"}) {
    EXPECT_NE(parse_number(text, Dimension::time).problem, "") << text;
  }
  EXPECT_NE(parse_number("012", Dimension::none).problem.find("octal"), std::string::npos);
  EXPECT_NE(parse_number("0o14", Dimension::none).problem.find("octal"), std::string::npos);
  EXPECT_NE(parse_number(".inf", Dimension::none).problem.find("finite"), std::string::npos);
}

TEST(Quantity, integer_is_digits_that_an_int_holds) {
  EXPECT_EQ(parse_integer("2147483647").value, 2147483647);
  EXPECT_EQ(parse_integer("-7").value, -7);
  EXPECT_EQ(parse_integer("+7").value, 7);
  for (const char* text :
       {"2147483648", "1e3", "1.0", "010", "0x10", "", "-", "12a", "99999999999999999999"}) {
    EXPECT_NE(parse_integer(text).problem, "") << text;
  }
}

TEST(Range, holds_its_ends_only_if_it_says_so) {
  EXPECT_FALSE(positive.holds(0));
  EXPECT_TRUE(positive.holds(1e-300));
  EXPECT_TRUE(not_negative.holds(0));
  EXPECT_FALSE(not_negative.holds(-1e-300));
  const Range share{.lower = 0, .upper = 1, .without_lower = true, .without_upper = true};
  EXPECT_FALSE(share.holds(1));
  EXPECT_EQ(share.text(), "> 0 and < 1");
  EXPECT_EQ(any_number.text(), "");
}

}  // namespace
}  // namespace fluxpact
