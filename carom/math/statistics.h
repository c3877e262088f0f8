// Mean, variance, extremes and percentiles of samples.
#pragma once

#include <cstdint>
#include <span>

#include "carom/export.h"

namespace carom::math {

/// Moments of a stream of numbers in one pass without cancellation (Welford 1962).
class CAROM_API RunningStatistics {
 public:
  void add(double x);
  /// As if all samples of `other` had been added (Chan, Golub and LeVeque 1979).
  void merge(const RunningStatistics& other);

  std::uint64_t count() const { return count_; }
  double mean() const { return mean_; }  ///< zero without samples
  /// Of the samples as a draw from a larger population: the sum of squares over n − 1. Zero for fewer than two.
  double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }
  /// Of the samples as the whole population: over n.
  double population_variance() const { return count_ > 0 ? squares_ / static_cast<double>(count_) : 0; }
  double standard_deviation() const;
  double minimum() const { return minimum_; }  ///< zero without samples
  double maximum() const { return maximum_; }

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0, squares_ = 0, minimum_ = 0, maximum_ = 0;
};

/// The value below which `percent` of the samples lie, 0 to 100 (clamped), interpolated linearly between order
/// statistics (type 7 of Hyndman and Fan 1996). NaN samples are left out; NaN where there is nothing left. Sorts a
/// copy.
CAROM_API double percentile(std::span<const double> samples, double percent);
inline double median(std::span<const double> samples) { return percentile(samples, 50); }

}  // namespace carom::math
