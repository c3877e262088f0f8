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
std::vector<std::pair<std::string, std::string>>& peer_rows() {
  static std::vector<std::pair<std::string, std::string>> all;
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

void peer_row(const std::string& scene, const std::string& carom) { peer_rows().push_back({scene, carom}); }

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

std::string peer_table() {
  // Other engines on the same scenes: measured on one machine at their defaults (rigid-body.md 6.2 says which
  // versions).
  static constexpr const char* peers[] = {
      "Box3D 0.1, 4 substeps | 40 | 1:100 | .08 / 8.4 | .0012 | −34 %, 16 | 100 / .1 / 0 % | stops | 2.538",
      "Box3D 0.1, 8 substeps | 60 | 1:300 | .08 / .53 | .0003 | −19 %, 16 | – | stops | –",
      "Jolt 5.5, 1 step | 15 | 1:100 | .50 / 71 | .0000 | +.03 %, 13 | 0 / 30 / 35 % | needs linear cast | 2.507",
      "Jolt 5.5, 4 steps | 30 | 1:300 | .03 / .27 | .0000 | +.09 %, 14 | – | – | –",
      "Rapier 0.2x, 4 iterations | 40 | 1:100 | .26 / 8.0 | .0009 | +.23 %, 15 | 96 / 11 / 12 % | stops | 2.538",
      "PhysX 5.6 PGS | 10 | 1:30 | 23 / 109 | .13 | gyroscopic off | 100 / 0 / 0 % | tunnels | 2.507",
      "PhysX 5.6 TGS | 15 | 1:100 | .98 / 7.5 | .021 | gyroscopic off | – | – | 2.507",
      "Bullet 3.24 | 10 | 1:10 | 4.8 / 69 | .0001 | −68 %, 13 | 1 / 33 / 20 % | opt-in | 2.503",
      "ODE 0.16 Quick | 12 | 1:30 | 7.7 / 101 | .0014 | −10 %, 77 | 0 / 0 / 0 % | tunnels | 2.507",
      "ReactPhysics3D 0.10 | 12 | 1:30 | 27 / 60 | .003 | none | 0 / 0 / 0 % | tunnels | 2.507",
      "MuJoCo 2.2 Newton, 4 × 4 ms | 12 | 1:1000 | 0 / 0 | .065 | +53 %, 13 | – | tunnels | 2.54"};
  std::string head = "| engine |", rule = "|---|", values = "| **Carom** |";
  for (const auto& [scene, value] : peer_rows()) {
    head += " " + scene + " |";
    rule += "---|";
    values += " " + value + " |";
  }
  std::string out = head + "\n" + rule + "\n" + values + "\n";
  for (const char* peer : peers) out += "| " + std::string(peer) + " |\n";
  return out;
}

}  // namespace carom::quality
