#include "carom/math/statistics.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "carom/math/vec.h"

namespace carom::math {

void RunningStatistics::add(double x) {
  minimum_ = count_ == 0 ? x : min(minimum_, x);
  maximum_ = count_ == 0 ? x : max(maximum_, x);
  ++count_;
  const double d = x - mean_;
  mean_ += d / static_cast<double>(count_);
  squares_ += d * (x - mean_);
}

void RunningStatistics::merge(const RunningStatistics& b) {
  if (b.count_ == 0) return;
  if (count_ == 0) {
    *this = b;
    return;
  }
  const double n = static_cast<double>(count_), m = static_cast<double>(b.count_), d = b.mean_ - mean_;
  mean_ += d * m / (n + m);
  squares_ += b.squares_ + d * d * n * m / (n + m);
  minimum_ = min(minimum_, b.minimum_);
  maximum_ = max(maximum_, b.maximum_);
  count_ += b.count_;
}

double RunningStatistics::standard_deviation() const { return math::sqrt(variance()); }

double percentile(std::span<const double> samples, double percent) {
  std::vector<double> sorted;
  sorted.reserve(samples.size());
  for (const double x : samples) {
    if (x == x) sorted.push_back(x);
  }
  if (sorted.empty() || percent != percent) return std::numeric_limits<double>::quiet_NaN();
  std::sort(sorted.begin(), sorted.end());
  const double place = clamp(percent, 0.0, 100.0) / 100 * static_cast<double>(sorted.size() - 1);
  const std::size_t below = static_cast<std::size_t>(place), above = min(below + 1, sorted.size() - 1);
  const double fraction = place - static_cast<double>(below);
  return fraction == 0 ? sorted[below] : sorted[below] + fraction * (sorted[above] - sorted[below]);
}

}  // namespace carom::math
