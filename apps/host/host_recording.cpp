// Recordings of a host: made, received, run again.
#include <utility>

#include "apps/host/host.h"
#include "apps/host/messages.h"

namespace carom::host {

void SimulationHost::receive_binary(std::string_view bytes) {
  if (outbox_bytes_ >= options_.max_outbox) {
    text_lost_ = true;
    upload_ = {};  // a file with a part missing is none
    return;
  }
  if (!greeted_) return complain("send hello first");
  if (bytes.size() < 4 || bytes[0] != file_message_kind)
    return complain("binary message: expected a part of a recording (docs/protocol.md)");
  if (upload_.size() + bytes.size() > options_.max_recording) {
    upload_ = {};
    return complain("recording: expected at most " + std::to_string(options_.max_recording >> 20) + " MiB");
  }
  upload_.insert(upload_.end(), bytes.begin() + 4, bytes.end());
  if (bytes[1] == 0) return;  // more follows
  const core::Status status = open(open_recording(std::exchange(upload_, {})));
  if (!status.ok()) return complain(status.error().message);
  source_name_.clear(), source_text_.clear();
}

core::Status SimulationHost::start_recording() {
  recorded_.clear();
  Origin origin{opened_values_, {}, options_.game == nullptr};
  // Where the past is shown, what was done after the step that is shown is not part of it.
  const std::uint64_t now = simulation_->step_count();
  const bool looking_back = !options_.game && now < history_.last();
  for (const DeedAtStep& done : done_)
    if (!looking_back || done.step < now) origin.past.push_back(done);
  origin.runs_again = origin.runs_again && !done_is_lost_;
  core::Result<scene::Recorder> made = scene::Recorder::open(
      [this](std::span<const std::uint8_t> bytes) -> core::Status {
        if (recorded_.size() + bytes.size() > options_.max_recording) return core::Error{"the recording is full"};
        recorded_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return {};
      },
      recording_header(*simulation_, origin));
  if (!made.ok()) return made.error();
  recorder_ = std::make_unique<RunRecorder>(std::move(made).value(), *simulation_);
  send_status();
  record();
  return {};
}

void SimulationHost::record() {
  // Before there is no room for the index either: a file with all its parts is better than a longer one.
  if (recorded_.size() > options_.max_recording - options_.max_recording / 8) {
    complain("the recording ends here: it is full");
    return finish_recording();
  }
  // A step that is shown again ends the recording rather than spoil it, and so does its size.
  if (const core::Status status = recorder_->add(*simulation_, simulation_->base().state.samples); !status.ok()) {
    complain("the recording ends here: " + status.error().message);
    finish_recording();
  }
}

void SimulationHost::finish_recording() {
  if (!recorder_) return;
  (void)recorder_->finish();
  recorder_.reset();
  std::string message{file_message_kind, 1, 0, 0};
  message += recorded_;
  recorded_.clear();
  send_binary(std::move(message));
  send_status();
}

core::Status SimulationHost::start_replay() {
  std::shared_ptr<scene::Recording> recording = simulation_->recording();
  if (!recording) return core::Error{"verify: no recording is open"};
  core::Result<Replay> opened = Replay::open(std::move(recording), {options_.threads});
  if (!opened.ok()) return opened.error();
  replay_ = std::make_unique<Replay>(std::move(opened).value());
  since_told_ = 0;
  running_ = false;  // who plays and who compares would turn the pages of one file against each other
  send_status();
  send(verified_message(replay_->report()));
  return {};
}

void SimulationHost::go_on_with_replay(double real_seconds) {
  constexpr double slice = 12;  // ms of the engine: the page goes on being answered
  const core::Status status = replay_->advance(slice);
  if (!status.ok()) {
    complain(status.error().message);
    replay_.reset();
    return;
  }
  since_told_ += real_seconds;
  if (!replay_->report().done && since_told_ < options_.stats_interval) return;
  since_told_ = 0;
  send(verified_message(replay_->report()));
  if (replay_->report().done) replay_.reset();
}

}  // namespace carom::host
