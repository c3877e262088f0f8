#include "tests/quality/gate.h"

#include <cmath>
#include <cstdio>
#include <vector>

namespace carom::quality {
namespace {

struct Row {
  int number;
  std::string what, truth, bar;
  std::string measured[2];  ///< in the plane, in space
  bool met[2] = {true, true};
};
std::vector<Row>& rows() {
  static std::vector<Row> all;
  return all;
}

std::string text(double value) {
  char buffer[32];
  const double size = std::abs(value);
  if (value == 0) return "0";
  if (size < 1e-3 || size >= 1e5)
    std::snprintf(buffer, sizeof buffer, "%.1e", value);
  else
    std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

}  // namespace

Gate::Gate(int number, std::string what, int dimension, std::string unit)
    : number_(number), what_(std::move(what)), dimension_(dimension), unit_(unit.empty() ? "" : " " + unit) {}

Gate& Gate::not_yet(double reached) {
  reached_ = reached;
  return *this;
}

void Gate::record(const std::string& measured, const std::string& truth, const std::string& bar, bool met, bool held) {
  const bool open = reached_ >= 0;
  if (open)
    EXPECT_TRUE(held) << "gate " << number_ << ", " << what_ << ": " << measured << ", worse than the "
                      << text(reached_) << " reached before (bar: " << bar << ")";
  else
    EXPECT_TRUE(met) << "gate " << number_ << ", " << what_ << ": " << measured << ", truth " << truth << ", bar "
                     << bar;
  if (open && met)
    std::printf("gate %d, %s (%dD) meets its bar now: tighten the test\n", number_, what_.c_str(), dimension_);
  Row* row = nullptr;
  for (Row& r : rows())
    if (r.number == number_ && r.what == what_) row = &r;
  if (row == nullptr) {
    rows().push_back({number_, what_, truth, bar, {}, {}});
    row = &rows().back();
    row->met[0] = row->met[1] = true;
  }
  const int column = dimension_ == 2 ? 0 : 1;
  if (row->truth != truth && row->measured[1 - column] != "")
    row->truth += " (" + std::to_string(dimension_) + "D: " + truth + ")";
  row->measured[column] = measured;
  row->met[column] = met;
}

void Gate::at_most(double measured, double bar) {
  record(text(measured) + unit_, "0", "≤ " + text(bar) + unit_, measured <= bar, measured <= reached_);
}
void Gate::near(double measured, double truth, double tolerance) {
  const double error = std::abs(measured - truth) / std::abs(truth);
  record(text(measured) + unit_, text(truth) + unit_, "± " + text(100 * tolerance) + " %", error <= tolerance,
         error <= reached_);
}
void Gate::exactly(long measured, long truth) {
  record(std::to_string(measured) + unit_, std::to_string(truth) + unit_, "exact", measured == truth,
         double(std::labs(measured - truth)) <= reached_);
}

std::string gate_table() {
  std::string out = "| # | test | truth | bar | Carom 3D | Carom 2D | bar met |\n|---|---|---|---|---|---|---|\n";
  for (int number = 0; number < 100; ++number)
    for (const Row& r : rows()) {
      if (r.number != number) continue;
      const bool met = (r.measured[0].empty() || r.met[0]) && (r.measured[1].empty() || r.met[1]);
      const auto cell = [](const std::string& s) { return s.empty() ? std::string("–") : s; };
      std::string verdict = "yes";
      if (!met) {
        const bool both = !r.measured[0].empty() && !r.measured[1].empty() && r.met[0] != r.met[1];
        verdict = both ? (r.met[1] ? "**not in 2D**" : "**not in 3D**") : "**no**";
      }
      out += "| " + std::to_string(r.number) + " | " + r.what + " | " + r.truth + " | " + r.bar + " | " +
             cell(r.measured[1]) + " | " + cell(r.measured[0]) + " | " + verdict + " |\n";
    }
  return out;
}

}  // namespace carom::quality
