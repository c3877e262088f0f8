#include "apps/host/host.h"

#include <utility>

namespace carom::host {

namespace {

constexpr std::size_t max_waiting_samples = 4096, most_deeds = 100'000;
constexpr double end_pause = 1.5;  // s

bool same(const BodyPlace& a, const BodyPlace& b) {
  return a.position == b.position && a.rotation == b.rotation && a.awake == b.awake;
}

}  // namespace

SimulationHost::SimulationHost(HostOptions options) : options_(std::move(options)), history_(options_.history) {}
SimulationHost::~SimulationHost() = default;

void SimulationHost::complain(std::string_view message) { send(error_message(message)); }

core::Status SimulationHost::open(core::Result<std::unique_ptr<Simulation>> opened) {
  if (!opened.ok()) return opened.error();
  simulation_ = std::move(opened).value();
  const double dt = simulation_->declaration().dt;
  // Enough steps for four-fold speed at 30 frames a second.
  clock_ = ode::FixedClock(dt, int(math::clamp(4.0 / 30.0 / dt + 1.0, 4.0, 256.0)));
  running_ = true;
  recorder_.reset();
  replay_.reset();
  send(simulation_->opened_text());
  begin();
  return {};
}

void SimulationHost::begin() {
  since_end_ = 0;
  clock_.reset();
  clock_.set_rate(speed_);
  simulation_->set_layers(layers_);
  if (!options_.game) history_.begin(*simulation_);
  opened_values_ = simulation_->values();
  done_.clear();
  done_is_lost_ = false;
  shown_ = simulation_->step_count();
  inspected_ = -1;
  send(values_message(simulation_->declaration(), simulation_->values()));
  send_scene();
  samples_.clear();
  sent_.clear();
  surfaces_sent_.clear();
  real_window_ = simulated_window_ = 0;
  real_time_factor_ = 1;
  acknowledged_ = sequence_;  // the page starts afresh
  restart_wanted_ = false;
  send_status();
  frame(true);
}

void SimulationHost::send_scene() {
  std::vector<std::uint32_t> ignored_added, ignored_removed;
  simulation_->take_changes(ignored_added, ignored_removed);
  send(simulation_->scene_text());
  meshes_sent_ = 0;
  send_meshes();
}

/// What the page did not read in time was dropped, and nobody knows what it was: it is told all that it must know.
void SimulationHost::tell_anew() {
  text_lost_ = false;
  send(simulation_->opened_text());
  send(values_message(simulation_->declaration(), simulation_->values()));
  send_scene();
  sent_.clear();
  surfaces_sent_.clear();
  send_status();
  key_wanted_ = true;
}

DeedOutcome SimulationHost::act(const Deed& deed) {
  if (options_.game) return do_deed(*simulation_, deed);
  forget_after_now();
  const auto outcome = std::make_shared<DeedOutcome>();
  history_.act(*simulation_, [outcome, deed](Simulation& s) { *outcome = do_deed(s, deed); });
  // A recording that begins later tells what was done before it.
  const DeedAtStep done{simulation_->step_count(), deed};
  done_is_lost_ = done_is_lost_ || done_.size() >= most_deeds;
  if (!done_is_lost_) done_.push_back(done);
  if (recorder_) recorder_->note(done);
  return *outcome;
}

/// From a step of the past the run goes on as its own: what came after is no part of it.
void SimulationHost::forget_after_now() {
  if (simulation_->step_count() >= history_.last()) return;
  while (!done_.empty() && done_.back().step >= simulation_->step_count()) done_.pop_back();
}

void SimulationHost::close() {
  if (simulation_) simulation_->release_all();
}

void SimulationHost::follow_game(double real_seconds) {
  const bool running = !options_.game->paused();
  if (std::exchange(running_, running) != running) send_status();
  if (simulation_->step_count() == shown_) return;
  simulated_window_ += double(simulation_->step_count() - shown_) * simulation_->declaration().dt;
  shown_ = simulation_->step_count();
  if ((real_window_ += real_seconds) > 0.5) {
    real_time_factor_ = simulated_window_ / real_window_;
    real_window_ = simulated_window_ = 0;
  }
  if (const core::Status status = simulation_->step(); !status.ok()) return complain(status.error().message);
  if (recorder_) record();
  frame_wanted_ = true;
  if (!running) {
    since_stats_ = options_.stats_interval;
    send_status();
  }
}

void SimulationHost::send_inspection() {
  if (inspected_ < 0) return;
  const std::string report = simulation_->inspect(std::uint32_t(inspected_));
  if (report.empty()) inspected_ = -1;
  send(inspected_message(report));
}

void SimulationHost::restart() {
  restart_wanted_ = false;
  finish_recording();
  core::Result<std::unique_ptr<Simulation>> fresh = simulation_->reopen(simulation_->values());
  if (!fresh.ok()) {
    running_ = false;
    complain(fresh.error().message);
    send_status();
    return;
  }
  simulation_ = std::move(fresh).value();
  begin();
}

bool SimulationHost::step_once() {
  if (const auto recorded = simulation_->recorded(); recorded && simulation_->step_count() >= recorded->last) {
    running_ = false;
    send_status();
    return false;
  }
  // From a step of the past the run goes on without the fingers that held then.
  if (!simulation_->recorded()) {
    forget_after_now();
    if (history_.branch(*simulation_)) (void)act({.kind = Deed::Kind::release_all, .name = {}, .spawned = {}});
  }
  const core::Status status = simulation_->step();
  if (!status.ok()) {
    running_ = false;
    complain("the simulation stopped: " + status.error().message);
    send_status();
    return false;
  }
  if (!simulation_->recorded()) history_.stepped(*simulation_);
  if (recorder_) record();
  StageBase::State& state = simulation_->base().state;
  samples_.insert(samples_.end(), state.samples.begin(), state.samples.end());
  state.samples.clear();
  if (samples_.size() > max_waiting_samples) {
    // The carrier is slow: keep every second sample, so that the curve stays whole.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples_.size(); i += 2) samples_[kept++] = samples_[i];
    samples_.resize(kept);
  }
  simulated_window_ += simulation_->declaration().dt;
  return true;
}

bool SimulationHost::at_end() const {
  const Declaration& d = simulation_->declaration();
  return d.loop && simulation_->time() + 0.5 * d.dt >= d.duration;
}

void SimulationHost::advance(double real_seconds) {
  if (!simulation_ || !(real_seconds >= 0) || !math::is_finite(real_seconds)) return;
  if (restart_wanted_) restart();
  if (text_lost_ && outbox_bytes_ <= options_.max_outbox / 2) tell_anew();
  if (replay_) go_on_with_replay(real_seconds);
  since_key_ += real_seconds;
  since_stats_ += real_seconds;
  // What loops shows its last picture for a moment.
  if (!options_.game && running_ && at_end() && (since_end_ += real_seconds) > end_pause) restart();
  if (options_.game) {
    follow_game(real_seconds);
    send_changes();
  } else if (running_ && !at_end()) {
    real_window_ += real_seconds;
    const ode::Frame due = clock_.advance(real_seconds);
    double spent = 0;
    for (int i = 0; i < due.steps; ++i) {
      if (at_end() || !step_once()) break;
      frame_wanted_ = true;
      // A scene heavier than the machine slows down instead of freezing the picture.
      spent += simulation_->profile().total;
      if (spent > 40) break;
    }
    if (real_window_ > 0.5) {
      real_time_factor_ = simulated_window_ / real_window_;
      real_window_ = simulated_window_ = 0;
    }
    send_changes();
  }
  const bool stale = since_key_ >= options_.key_interval && running_;
  // Two frames may be under way; the third waits for an acknowledgement.
  if ((frame_wanted_ || key_wanted_ || stale) && sequence_ - acknowledged_ < 2 && outbox_bytes_ < options_.max_outbox)
    frame(key_wanted_ || stale);
}

void SimulationHost::send_changes() {
  StageBase::State& state = simulation_->base().state;
  std::vector<std::uint32_t> added, removed;
  if (simulation_->take_changes(added, removed)) {
    std::vector<BodyView> views;
    if (!added.empty()) simulation_->describe(&added, views);
    send_meshes();
    send(bodies_message(views, removed));
  }
  if (state.values_changed) {
    state.values_changed = false;
    send(values_message(simulation_->declaration(), state.values));
  }
  if (state.message_changed) {
    state.message_changed = false;
    send_status();
  }
}

void SimulationHost::send_meshes() {
  const std::vector<Mesh>& meshes = simulation_->meshes().meshes();
  for (; meshes_sent_ < meshes.size(); ++meshes_sent_)
    send_binary(mesh_message(std::uint32_t(meshes_sent_), meshes[meshes_sent_]));
}

void SimulationHost::send_drawn(bool key) {
  const StageBase::State& state = simulation_->base().state;
  // An empty message takes the last points away.
  if (!state.points.positions.empty() || points_sent_) send_binary(points_message(state.points));
  points_sent_ = !state.points.positions.empty();
  surfaces_sent_.resize(state.surfaces.size());
  for (std::size_t i = 0; i < state.surfaces.size(); ++i) {
    const Surface& surface = state.surfaces[i];
    if (surface.corners.empty()) continue;
    send_binary(surface_message(std::uint32_t(i), surface, key || surfaces_sent_[i] != surface.topology));
    surfaces_sent_[i] = surface.topology;
  }
}

void SimulationHost::send_status() {
  StatusFields fields{running_, speed_};
  if (simulation_) {
    fields.time = simulation_->time();
    fields.step = simulation_->step_count();
    const std::optional<StepRange> recorded = simulation_->recorded();
    fields.first = options_.game ? fields.step : recorded ? recorded->first : history_.first();
    fields.last = options_.game ? fields.step : recorded ? recorded->last : history_.last();
    fields.recording = recorder_ != nullptr;
    fields.playing = recorded.has_value();
    fields.message = simulation_->base().state.message;
    simulation_->base().state.message_changed = false;
  }
  send(status_message(fields));
}

void SimulationHost::frame(bool key) {
  simulation_->places(now_);
  moved_.clear();
  if (key) {
    moved_ = now_;
  } else {
    // Both lists are in creation order, so identical ids meet.
    std::size_t j = 0;
    for (const BodyPlace& place : now_) {
      while (j < sent_.size() && sent_[j].id < place.id) ++j;
      if (j >= sent_.size() || sent_[j].id != place.id || !same(sent_[j], place)) moved_.push_back(place);
    }
  }
  FrameFields fields;
  fields.key = key;
  fields.dimension = simulation_->declaration().dimension;
  fields.sequence = ++sequence_;
  fields.step = std::uint32_t(simulation_->step_count());
  fields.time = simulation_->time();
  fields.origin = simulation_->declaration().camera.target;
  const int follow = simulation_->declaration().camera.follow;
  for (const BodyPlace& place : now_)
    if (follow >= 0 && place.id == std::uint32_t(follow)) fields.origin = place.position;
  fields.bodies = moved_;
  fields.samples = samples_;
  simulation_->lines(lines_);
  fields.lines = lines_;
  FrameStats stats;
  if (key || since_stats_ >= options_.stats_interval) {
    const rigid::Counters counters = simulation_->counters();
    const Budget budget = simulation_->budget();
    stats = {std::uint32_t(counters.bodies),
             std::uint32_t(counters.awake_bodies),
             std::uint32_t(counters.touching_contacts),
             std::uint32_t(counters.joints),
             std::uint32_t(counters.islands),
             std::uint32_t(simulation_->threads()),
             float(simulation_->profile().total),
             float(real_time_factor_),
             budget.kinetic,
             budget.potential,
             simulation_->state_hash(),
             simulation_->worst_penetration()};
    fields.stats = &stats;
    since_stats_ = 0;
    send(numbers_message({simulation_->profile(), budget, simulation_->arrows(), simulation_->hand_force(),
                          simulation_->worst_joint_error(), counters.bytes, simulation_->legend()}));
    send_inspection();
  }
  send_drawn(key);
  send_binary(frame_message(fields));
  samples_.clear();
  std::swap(sent_, now_);
  key_wanted_ = frame_wanted_ = false;
  if (key) since_key_ = 0;
}

void SimulationHost::send(std::string text) {
  if (outbox_bytes_ + text.size() > options_.max_outbox) {
    text_lost_ = true;
    return;
  }
  outbox_bytes_ += text.size() + sizeof(Message);
  outbox_.push_back({true, std::move(text)});
}

void SimulationHost::send_binary(std::string bytes) {
  outbox_bytes_ += bytes.size() + sizeof(Message);
  outbox_.push_back({false, std::move(bytes)});
}

bool SimulationHost::take(Message& message) {
  if (outbox_.empty()) return false;
  message = std::move(outbox_.front());
  outbox_.pop_front();
  outbox_bytes_ -= message.data.size() + sizeof(Message);
  return true;
}

}  // namespace carom::host
