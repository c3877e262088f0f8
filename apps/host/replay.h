// A recording run again from what opened it, and compared: every pose bit by bit, every state hash.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/host/run_recorder.h"
#include "carom/scene/recording.h"

namespace carom::host {

struct ReplayReport {
  std::uint64_t first = 0, last = 0;  ///< steps of the recording
  std::uint64_t step = 0;             ///< reached so far
  std::size_t frames = 0, hashes = 0;
  bool done = false;
  struct Difference {
    std::uint64_t step = 0;   ///< of the first frame that differs
    std::uint64_t after = 0;  ///< of the last one that did not; equal to `first` where none was before
    std::string what;
  };
  std::optional<Difference> difference;
  std::string recorded_by, run_by;  ///< builds
  bool equal() const { return done && !difference; }
  /// One or two sentences for a person.
  std::string text() const;
};

class Replay {
 public:
  /// Errors: the recording does not say what opened it, or that cannot be opened here.
  static core::Result<Replay> open(std::shared_ptr<scene::Recording> recording, const SimulationOptions& options = {});

  /// One step of the run or more, until about so many milliseconds of the engine's own time have passed. Errors are
  /// damage to the file, or the run ending itself.
  core::Status advance(double milliseconds);
  const ReplayReport& report() const { return report_; }

 private:
  Replay() = default;
  core::Status do_due();
  core::Status step();
  core::Status compare();
  void differ(std::string what);

  std::shared_ptr<scene::Recording> recording_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<DeedAtStep> due_;
  std::size_t next_deed_ = 0, index_ = 0;
  scene::RecordedFrame frame_;
  std::uint64_t agreed_ = 0;
  std::vector<BodyPlace> places_;
  ReplayReport report_;
};

}  // namespace carom::host
