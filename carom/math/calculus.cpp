#include "carom/math/calculus.h"

namespace carom::math {

bool differentiate(std::span<const double> y, double h, std::span<double> slope) {
  const std::size_t n = y.size();
  if (n < 3 || slope.size() != n || h == 0) return false;
  slope[0] = (-3 * y[0] + 4 * y[1] - y[2]) / (2 * h);
  for (std::size_t i = 1; i + 1 < n; ++i) slope[i] = (y[i + 1] - y[i - 1]) / (2 * h);
  slope[n - 1] = (3 * y[n - 1] - 4 * y[n - 2] + y[n - 3]) / (2 * h);
  return true;
}

double trapezoid(std::span<const double> y, double h) {
  if (y.size() < 2) return 0;
  double sum = 0.5 * (y.front() + y.back());
  for (std::size_t i = 1; i + 1 < y.size(); ++i) sum += y[i];
  return h * sum;
}

double trapezoid(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (std::size_t i = 1; i < x.size(); ++i) sum += 0.5 * (x[i] - x[i - 1]) * (y[i] + y[i - 1]);
  return sum;
}

double simpson(std::span<const double> y, double h) {
  std::size_t intervals = y.empty() ? 0 : y.size() - 1;
  if (intervals < 2) return trapezoid(y, h);
  double tail = 0;
  if (intervals % 2 == 1) {
    const std::size_t k = intervals;
    tail = 0.375 * h * (y[k - 3] + 3 * (y[k - 2] + y[k - 1]) + y[k]);
    intervals -= 3;
  }
  double sum = 0;
  for (std::size_t i = 0; i < intervals; i += 2) sum += y[i] + 4 * y[i + 1] + y[i + 2];
  return h / 3 * sum + tail;
}

}  // namespace carom::math
