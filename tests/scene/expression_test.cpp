// Arithmetic of scene files: values, precedence, dimensions.
#include <gtest/gtest.h>

#include "carom/scene/detail/expression.h"

namespace carom::scene::detail {
namespace {

double value_of(std::string_view text) {
  const auto e = parse_expression(text);
  EXPECT_TRUE(e.ok()) << text << ": " << (e.ok() ? "" : e.error().message);
  if (!e.ok()) return -1e300;
  EXPECT_TRUE(check_expression(*e, {}).ok()) << text;
  return evaluate_expression(*e, {});
}

TEST(Expression, FollowsTheRulesOfArithmetic) {
  EXPECT_EQ(value_of("1 + 2*3"), 7);
  EXPECT_EQ(value_of("(1 + 2)*3"), 9);
  EXPECT_EQ(value_of("8/4/2"), 1);
  EXPECT_EQ(value_of("7 - 4 - 2"), 1);
  EXPECT_EQ(value_of("-2^2"), -4);
  EXPECT_EQ(value_of("2^-2"), 0.25);
  EXPECT_EQ(value_of("min(3, max(1, 2))"), 2);
  EXPECT_EQ(value_of("mod(-1, 3)"), 2);
  EXPECT_EQ(value_of("if(1 < 2, 5, 6)"), 5);
  EXPECT_EQ(value_of("sqrt(16) + abs(-3) + floor(2.7) + ceil(2.1)"), 12);
  EXPECT_DOUBLE_EQ(value_of("sin(30 deg)"), 0.5);
}

TEST(Expression, CarriesUnits) {
  EXPECT_DOUBLE_EQ(value_of("3 km + 200 m"), 3200);
  EXPECT_DOUBLE_EQ(value_of("30 mph"), 13.4112);
  EXPECT_DOUBLE_EQ(value_of("9.81 m/s^2 * 2 s"), 19.62);
  EXPECT_DOUBLE_EQ(value_of("6 kg/m^3/pi*pi"), 6) << "a name after a slash is no unit";
  EXPECT_DOUBLE_EQ(value_of("2 m*min(3, 4)"), 6) << "a function is no minute";
  EXPECT_DOUBLE_EQ(value_of("2 N*m + 3 kg*m^2/s^2"), 5);
  const auto e = parse_expression("sqrt(2*9.81 m/s^2*5 m)");
  ASSERT_TRUE(e.ok());
  const auto d = check_expression(*e, {});
  ASSERT_TRUE(d.ok());
  EXPECT_EQ(si_unit(*d), "m/s");
}

TEST(Expression, RefusesWhatMakesNoSense) {
  for (const char* bad :
       {"", "1 +", "(1", "1)", "foo(1)", "sqrt(1, 2)", "1 kgg", "2 ^ x", "@", "1..2", "min(1)", "a b"})
    EXPECT_FALSE(parse_expression(bad).ok()) << bad;
  for (const char* bad : {"1 m + 1 s", "1 m < 2 kg", "sin(1 m)", "sqrt(1 m)", "min(1 m, 1 s)", "if(1, 1 m, 1 s)"}) {
    const auto e = parse_expression(bad);
    ASSERT_TRUE(e.ok()) << bad;
    EXPECT_FALSE(check_expression(*e, {}).ok()) << bad;
  }
  EXPECT_FALSE(parse_expression(std::string(2000, '(')).ok());
  EXPECT_FALSE(parse_expression(std::string(2000, '-') + "1").ok());
}

TEST(Expression, RandomIsTheSameForTheSameArgumentsAndUniform) {
  EXPECT_EQ(value_of("random(1, 2, 3)"), value_of("random(1, 2, 3)"));
  EXPECT_NE(value_of("random(1, 2, 3)"), value_of("random(1, 3, 2)"));
  const auto e = parse_expression("random(i, 7)");
  ASSERT_TRUE(e.ok());
  double sum = 0, squares = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double names[] = {double(i)};
    const double u = evaluate_expression(*e, names);
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  // Standard error of the mean of n uniform numbers: 1/√(12 n) = 0.002; of the second moment 0.0021.
  EXPECT_NEAR(sum / n, 0.5, 0.01);
  EXPECT_NEAR(squares / n, 1.0 / 3, 0.011);
}

TEST(Quantity, ReadsFractionsAndRates) {
  EXPECT_EQ(parse_quantity("1/60 s")->value, 1.0 / 60);
  EXPECT_EQ(parse_quantity("1/240 s")->value, 1.0 / 240);
  EXPECT_FALSE(parse_quantity("1/0 s").ok());
  EXPECT_FALSE(parse_quantity("").ok());
}

}  // namespace
}  // namespace carom::scene::detail
