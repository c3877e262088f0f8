// A run as a recording while it goes on: what a page shows of it, and what it takes to run it again.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/host/deed.h"
#include "apps/host/simulation.h"
#include "carom/scene/recording.h"

namespace carom::host {

/// Something that was done before the step that follows this one.
struct DeedAtStep {
  std::uint64_t step = 0;
  Deed deed;
};

/// Where a run comes from. Without values it cannot be run again, only looked at.
struct Origin {
  std::vector<double> values;  ///< at its start
  std::vector<DeedAtStep> past;
  bool runs_again = true;
};

/// The header for a recording that begins now.
scene::RecordingHeader recording_header(Simulation& simulation, const Origin& origin);
/// The text of `origin` in a header, and back. Errors name what is missing.
struct OriginText {
  std::string demo, version, engine, compiler;
  std::vector<std::pair<std::string, double>> values;
  std::vector<DeedAtStep> past;
};
core::Result<OriginText> read_origin(const std::string& text);
core::Result<DeedAtStep> read_deed_at_step(const std::string& text);
/// This build, as origins name it.
OriginText this_build();

class RunRecorder {
 public:
  /// `recorder` has been opened with the header of this simulation.
  RunRecorder(scene::Recorder recorder, Simulation& simulation);

  /// What was done since the last frame; it goes into the next.
  void note(const DeedAtStep& deed);
  /// The run as it is now, with the samples since the last frame. Hashes come every `hash_interval` frames.
  core::Status add(Simulation& simulation, std::span<const Sample> samples);
  core::Status finish() { return recorder_.finish(); }

  static constexpr std::size_t hash_interval = 10;

 private:
  core::Status introduce(Simulation& simulation);

  scene::Recorder recorder_;
  scene::RecordedFrame frame_;
  std::vector<std::uint32_t> known_;  ///< ids that the file describes, rising
  std::size_t meshes_known_ = 0, frames_ = 0;
  std::vector<BodyPlace> places_;
  std::vector<Line> lines_;
};

}  // namespace carom::host
