// The gates of quality: a measured number beside its truth and its bar, checked by the test that measured it and kept
// for the table of docs/quality.md (test_quality --table).
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace carom::quality {

/// A bar and what is measured against it. `number` is the gate's in the list of docs/quality.md.
///
///   Gate(4, "slope at 1.02 of the critical angle: acceleration", 3, "m/s²").near(measured, truth, 0.01);
///   Gate(1, "40 unit cubes: sag after 60 s", 3, "m").not_yet(0.44).at_most(sag, 0.4);
///
/// `not_yet(reached)` marks a bar that the engine does not meet yet: the table says so, and the test holds the engine
/// to the value that it has reached, so that it gets no worse; a negative value: the bar holds.
class Gate {
 public:
  Gate(int number, std::string what, int dimension, std::string unit = "");
  Gate& not_yet(double reached);
  /// measured ≤ bar.
  void at_most(double measured, double bar);
  /// |measured − truth| ≤ tolerance · |truth|. With not_yet: `reached` is the relative error that is held.
  void near(double measured, double truth, double tolerance);
  /// measured = truth. With not_yet: |measured − truth| ≤ reached is held.
  void exactly(long measured, long truth);

 private:
  void record(const std::string& measured, const std::string& truth, const std::string& bar, bool met, bool held);
  int number_;
  std::string what_;
  int dimension_;
  std::string unit_;
  double reached_ = -1;
};

/// Markdown of all that was measured so far: the gates, one row a gate and case with a column for each dimension.
std::string gate_table();

}  // namespace carom::quality
