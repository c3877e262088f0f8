// What `carom run` says at the end, for a person and for a machine.
#pragma once

#include <string>
#include <vector>

#include "apps/host/simulation.h"

namespace carom::command {

/// A state hash as it is written everywhere: 16 hexadecimal digits.
std::string hex(std::uint64_t hash);

struct StepHash {
  std::uint64_t step = 0, hash = 0;
};

struct Report {
  std::string scene, title;
  int dimension = 3, threads = 1;
  double dt = 0, simulated = 0, wall = 0;
  std::uint64_t steps = 0;
  bool interrupted = false;
  std::string stopped;  ///< why the simulation ended early, or empty
  std::string message;  ///< the demo's verdict
  rigid::Counters counters;
  int most_contacts = 0;
  host::Budget start, end;
  double worst_penetration = 0, worst_joint_error = 0;
  double step_median = 0, step_worst = 0;  ///< ms
  double real_time_factor = 0;
  std::uint64_t hash = 0;
  std::vector<StepHash> hashes;
  std::vector<std::pair<std::string, std::string>> parameters;
  std::vector<host::Expectation> expectations;
  bool checked = false;  ///< expectations hold for this run (default values, declared duration)
  std::vector<std::string> files;
  std::vector<std::string> advice;  ///< what the settings cannot hold, before the first step

  bool passed() const;
};

std::string report_json(const Report& report);
std::string report_text(const Report& report);

}  // namespace carom::command
