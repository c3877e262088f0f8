// Numerical differentiation, integration and least values of functions, and of evenly or unevenly spaced samples.
#pragma once

#include <limits>
#include <span>

#include "carom/export.h"

namespace carom::math {

/// (f(x + h) − f(x))/h: error ½ h f″ + rounding ε f/h.
template <class F>
constexpr double forward_difference(F&& f, double x, double h) {
  const double ahead = f(x + h);
  return (ahead - f(x)) / h;
}
/// (f(x + h) − f(x − h))/2h: error h² f‴/6 + rounding ε f/h.
template <class F>
constexpr double central_difference(F&& f, double x, double h) {
  const double ahead = f(x + h);
  return (ahead - f(x - h)) / (2 * h);
}
/// (f(x + h) − 2 f(x) + f(x − h))/h²: error h² f⁗/12.
template <class F>
constexpr double second_difference(F&& f, double x, double h) {
  const double ahead = f(x + h);
  const double here = f(x);
  return (ahead - 2 * here + f(x - h)) / (h * h);
}

/// ∫ f over [a, b] with n ≥ 1 trapezoids: error −(b − a) h² f″/12.
template <class F>
constexpr double trapezoid(F&& f, double a, double b, int n) {
  const double h = (b - a) / n;
  const double start = f(a);
  double sum = 0.5 * (start + f(b));
  for (int i = 1; i < n; ++i) sum += f(a + i * h);
  return h * sum;
}
/// ∫ f over [a, b] by Simpson's rule with n intervals, raised to an even number: error −(b − a) h⁴ f⁗/180, none for
/// cubics.
template <class F>
constexpr double simpson(F&& f, double a, double b, int n) {
  n += n & 1;
  const double h = (b - a) / n;
  const double start = f(a);
  double ends = start + f(b), odd = 0, even = 0;
  for (int i = 1; i < n; ++i) ((i & 1) != 0 ? odd : even) += f(a + i * h);
  return h / 3 * (ends + 4 * odd + 2 * even);
}

/// Where f is least between `low` and `high`, if it falls and then rises there: by the golden section, to .618 of the
/// interval with each of `steps` calls.
template <class F>
constexpr double least_place(F&& f, double low, double high, int steps) {
  constexpr double golden = 0.6180339887498949;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = f(a), at_b = f(b);
  for (int i = 0; i < steps; ++i) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = f(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = f(b);
    }
  }
  return 0.5 * (low + high);
}

/// The derivative at each of n evenly spaced samples, second order throughout (one-sided at the ends). `slope` must
/// hold n values and may not overlap `samples`. False, and nothing written, where n < 3, the sizes differ or spacing is
/// zero.
CAROM_API bool differentiate(std::span<const double> samples, double spacing, std::span<double> slope);
/// ∫ y dx over evenly spaced samples; zero for fewer than two.
CAROM_API double trapezoid(std::span<const double> samples, double spacing);
/// ∫ y dx over samples at any x; NaN where the sizes differ.
CAROM_API double trapezoid(std::span<const double> x, std::span<const double> y);
/// Simpson's rule over evenly spaced samples, exact for cubics with any number of samples from three on: an odd number
/// of intervals ends with the 3/8 rule. Two samples are a trapezoid.
CAROM_API double simpson(std::span<const double> samples, double spacing);

}  // namespace carom::math
