// The bounds that carom/math/elementary.h states, against MPFR with 200 bits.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "tests/math/mpfr_reference.h"

namespace carom::test::elementary_accuracy_tests {
namespace {

struct Range {
  double low, high;  // uniform arguments, or binades where `spread`
  bool spread;
};
constexpr int samples = 10000;

template <class T>
double worst_unary(MpfrUnary reference, T (*f)(T), std::initializer_list<Range> ranges, int count = samples) {
  MpfrReference mpfr;
  Arguments arguments(0x9e3779b97f4a7c15ULL);
  double worst = 0;
  for (const Range& r : ranges) {
    for (int i = 0; i < count; ++i) {
      const T x = static_cast<T>(r.spread ? arguments.spread(static_cast<int>(r.low), static_cast<int>(r.high))
                                          : arguments.between(r.low, r.high));
      const double error = mpfr.unary(reference, x, f(x));
      if (error > worst) worst = error;
      if (error > 2) ADD_FAILURE() << "x = " << std::hexfloat << x << " gives " << f(x) << ", " << error << " ulp off";
      if (error > 2) return worst;
    }
  }
  return worst;
}

struct Case {
  const char* name;
  MpfrUnary reference;
  double (*wide)(double);
  float (*narrow)(float);
  double bound;  // ulp of a double
  std::initializer_list<Range> ranges;
};

class Unary : public ::testing::TestWithParam<Case> {};

TEST_P(Unary, StaysWithinItsStatedUlp) {
  const Case& c = GetParam();
  const double wide = worst_unary<double>(c.reference, c.wide, c.ranges);
  RecordProperty("worst_ulp", std::to_string(wide));
  EXPECT_LT(wide, c.bound);
  // Near-halfway cases excepted, a float rounded from an accurate double is the nearest one.
  const double narrow = worst_unary<float>(c.reference, c.narrow, c.ranges, samples / 4);
  EXPECT_LT(narrow, 0.501);
  if (std::getenv("CAROM_SHOW_ULP")) std::printf("%s %.4f %.5f\n", c.name, wide, narrow);
}

const Range tiny{-1022, -30, true}, common{-30, 4, true}, large{4, 120, true}, huge{120, 1023, true};

const Case cases[] = {
    {"sin", mpfr_sin, math::sin, math::sin, 0.9, {{-0.8, 0.8, false}, {-100, 100, false}, tiny, common, large, huge}},
    {"cos", mpfr_cos, math::cos, math::cos, 0.9, {{-0.8, 0.8, false}, {-100, 100, false}, tiny, common, large, huge}},
    {"tan", mpfr_tan, math::tan, math::tan, 1.0, {{-0.8, 0.8, false}, {-100, 100, false}, tiny, common, large, huge}},
    {"asin", mpfr_asin, math::asin, math::asin, 0.6, {{-1, 1, false}, {0.999, 1, false}, tiny, {-30, 0, true}}},
    {"acos", mpfr_acos, math::acos, math::acos, 0.6, {{-1, 1, false}, {0.999, 1, false}, tiny, {-30, 0, true}}},
    {"atan", mpfr_atan, math::atan, math::atan, 0.6, {{-2, 2, false}, tiny, common, large, huge}},
    {"exp", mpfr_exp, math::exp, math::exp, 0.6, {{-1, 1, false}, {-708, 709.7, false}, tiny, common}},
    {"exp2", mpfr_exp2, math::exp2, math::exp2, 0.6, {{-1, 1, false}, {-1021, 1023.9, false}, tiny, common}},
    {"expm1", mpfr_expm1, math::expm1, math::expm1, 0.8, {{-1, 1, false}, {-50, 709.7, false}, tiny, common}},
    {"log", mpfr_log, math::log, math::log, 0.6, {{0.5, 2, false}, {0.99, 1.01, false}, {0, 1000, false}, tiny, huge}},
    {"log2",
     mpfr_log2,
     math::log2,
     math::log2,
     0.6,
     {{0.5, 2, false}, {0.99, 1.01, false}, {0, 1e3, false}, tiny, huge}},
    {"log10",
     mpfr_log10,
     math::log10,
     math::log10,
     0.6,
     {{0.5, 2, false}, {0.99, 1.01, false}, {0, 1e3, false}, tiny, huge}},
    {"log1p", mpfr_log1p, math::log1p, math::log1p, 0.6, {{-0.99, 2, false}, {-0.01, 0.01, false}, tiny, common, huge}},
    {"cbrt", mpfr_cbrt, math::cbrt, math::cbrt, 0.6, {{-10, 10, false}, tiny, common, huge, {-1074, -1022, true}}},
    {"sinh", mpfr_sinh, math::sinh, math::sinh, 0.8, {{-1, 1, false}, {-710, 710, false}, tiny, common}},
    {"cosh", mpfr_cosh, math::cosh, math::cosh, 0.8, {{-1, 1, false}, {-710, 710, false}, tiny, common}},
    {"tanh", mpfr_tanh, math::tanh, math::tanh, 0.8, {{-1, 1, false}, {-25, 25, false}, tiny, common}},
};
INSTANTIATE_TEST_SUITE_P(Elementary, Unary, ::testing::ValuesIn(cases),
                         [](const auto& info) { return std::string(info.param.name); });

// Where the result is subnormal it is rounded twice.
TEST(ElementaryAccuracy, SubnormalExponentialsWithinOneUlp) {
  EXPECT_LT(worst_unary<double>(mpfr_exp, math::exp, {{-746, -708, false}}), 1.0);
  EXPECT_LT(worst_unary<double>(mpfr_exp2, math::exp2, {{-1075, -1021, false}}), 1.0);
}

// Doubles that come closest to a multiple of π/2 (found with continued fractions: Kahan 1983, Muller 2006).
TEST(ElementaryAccuracy, HardestReductions) {
  MpfrReference mpfr;
  for (const double x : {0x1.6ac5b262ca1ffp+849, 0x1.bb951a99d36cap+57, 0x1.921fb54442d18p+0, 0x1.921fb54442d18p+1,
                         0x1.921fb54442d18p+20, 0x1.fffffffffffffp+1023, 1e22, 1647099.0, 0x1.921fb54442d18p+21}) {
    EXPECT_LT(mpfr.unary(mpfr_sin, x, math::sin(x)), 0.9) << x;
    EXPECT_LT(mpfr.unary(mpfr_cos, x, math::cos(x)), 0.9) << x;
    EXPECT_LT(mpfr.unary(mpfr_tan, x, math::tan(x)), 1.0) << x;
  }
}

double worst_binary(MpfrBinary reference, double (*f)(double, double), Range a, Range b) {
  MpfrReference mpfr;
  Arguments arguments(0x1234567);
  const auto draw = [&](Range r) {
    return r.spread ? arguments.spread(static_cast<int>(r.low), static_cast<int>(r.high))
                    : arguments.between(r.low, r.high);
  };
  double worst = 0;
  for (int i = 0; i < samples; ++i) {
    const double x = draw(a), y = draw(b), error = mpfr.binary(reference, x, y, f(x, y));
    if (error > worst) worst = error;
    if (error > 2)
      ADD_FAILURE() << std::hexfloat << x << ", " << y << " gives " << f(x, y) << ", " << error << " ulp off";
    if (error > 2) return worst;
  }
  return worst;
}

TEST(ElementaryAccuracy, Pow) {
  double worst = 0;
  worst = std::max(worst, worst_binary(mpfr_pow, math::pow, {0, 10, false}, {-300, 300, false}));
  worst = std::max(worst, worst_binary(mpfr_pow, math::pow, {0.999, 1.001, false}, {-7e5, 7e5, false}));
  worst = std::max(worst, worst_binary(mpfr_pow, math::pow, {-1000, 1000, true}, {-1.02, 1.02, false}));
  worst = std::max(worst, worst_binary(mpfr_pow, math::pow, {0.5, 2, false}, {-1000, 1000, false}));
  EXPECT_LT(worst, 0.65);
  if (std::getenv("CAROM_SHOW_ULP")) std::printf("pow %.4f\n", worst);
}

TEST(ElementaryAccuracy, Atan2AndHypot) {
  double worst = 0, root = 0;
  for (const Range r : {Range{-1, 1, false}, Range{-40, 40, true}, Range{-1000, -900, true}, Range{900, 1000, true}}) {
    worst = std::max(worst, worst_binary(mpfr_atan2, math::atan2, r, r));
    root = std::max(root, worst_binary(mpfr_hypot, math::hypot, r, r));
  }
  EXPECT_LT(worst, 0.6);
  EXPECT_LT(root, 0.6);
  if (std::getenv("CAROM_SHOW_ULP")) std::printf("atan2 %.4f hypot %.4f\n", worst, root);
}

TEST(ElementaryAccuracy, FmodIsExact) {
  EXPECT_EQ(worst_binary(mpfr_fmod, math::fmod, {-40, 60, true}, {-40, 60, true}), 0);
  EXPECT_EQ(worst_binary(mpfr_fmod, math::fmod, {-1074, 1000, true}, {-1074, 1000, true}), 0);
}

}  // namespace
}  // namespace carom::test::elementary_accuracy_tests
