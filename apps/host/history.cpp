#include "apps/host/history.h"

#include <algorithm>

namespace carom::host {

namespace {
constexpr std::size_t most_actions = 100'000;
}

void History::begin(Simulation& simulation) {
  const double dt = simulation.declaration().dt;
  interval_ = std::uint64_t(math::clamp(options_.interval / dt, 1.0, 1e6));
  window_ = std::uint64_t(math::clamp(options_.window / dt, 1.0, 1e8));
  values_ = simulation.values();
  saved_.clear();
  done_.clear();
  last_ = next_save_ = simulation.step_count();
  copies_ = true;
  own_time_ = false;
  save(simulation);
}

void History::save(Simulation& simulation) {
  next_save_ = simulation.step_count() + interval_;
  if (!copies_ || own_time_) return;
  Saved saved{simulation.step_count(), simulation.save()};
  copies_ = saved.state != nullptr;
  if (!copies_) return;
  saved_.push_back(std::move(saved));
  thin();
}

void History::thin() {
  while (saved_.size() > 2 && saved_[1].step + window_ <= last_) saved_.pop_front();
  std::size_t bytes = 0;
  for (const Saved& saved : saved_) bytes += saved.state->bytes();
  if (bytes > options_.bytes && saved_.size() > 3) {
    // The first and the newest stay; of the rest every second one.
    std::deque<Saved> kept;
    for (std::size_t i = 0; i < saved_.size(); ++i)
      if (i % 2 == 0 || i + 1 == saved_.size()) kept.push_back(std::move(saved_[i]));
    saved_.swap(kept);
    interval_ *= 2;
  } else if (bytes > options_.bytes && saved_.size() > 1) {
    saved_.pop_front();
  }
  while (!done_.empty() && done_.front().step < saved_.front().step) done_.pop_front();
}

void History::act(Simulation& simulation, Action action) {
  branch(simulation);
  action(simulation);
  if (done_.size() >= most_actions) {
    // Nobody does that much within a minute: only this step is remembered from here.
    saved_.clear();
    done_.clear();
    save(simulation);
    return;
  }
  done_.push_back({simulation.step_count(), std::move(action)});
}

bool History::branch(const Simulation& simulation) {
  const std::uint64_t now = simulation.step_count();
  if (now >= last_ || own_time_) return false;
  while (!saved_.empty() && saved_.back().step > now) saved_.pop_back();
  while (!done_.empty() && done_.back().step >= now) done_.pop_back();
  last_ = now;
  next_save_ = now + interval_;
  return true;
}

void History::stepped(Simulation& simulation) {
  const std::uint64_t now = simulation.step_count();
  own_time_ = own_time_ || now <= last_;
  last_ = now;
  if (own_time_) {
    saved_.clear();
    done_.clear();
  } else if (last_ >= next_save_) {
    save(simulation);
  }
}

std::uint64_t History::first() const {
  if (own_time_) return last_;
  if (copies_) return saved_.empty() ? last_ : std::max(saved_.front().step, last_ > window_ ? last_ - window_ : 0);
  return last_ <= window_ ? 0 : last_;
}

core::Result<bool> History::seek(std::unique_ptr<Simulation>& simulation, std::uint64_t step) {
  if (own_time_) return core::Error{"seek: this demo turns its own time back; its past cannot be shown"};
  step = std::clamp(step, first(), last_);
  const std::uint64_t now = simulation->step_count();
  if (step == now) return false;
  bool another = false;
  // From before it where that is remembered: what a demo draws is made by its steps, not saved.
  auto after = std::lower_bound(saved_.begin(), saved_.end(), step,
                                [](const Saved& saved, std::uint64_t wanted) { return saved.step < wanted; });
  if (after == saved_.begin() && after != saved_.end() && after->step == step) ++after;
  const Saved* from = after == saved_.begin() ? nullptr : &*std::prev(after);
  // Forward from where it stands is shorter where no saved state lies between.
  const bool ahead = now < step && (from == nullptr || from->step <= now);
  if (!ahead && from != nullptr) {
    if (const core::Status status = simulation->restore(*from->state); !status.ok()) return status.error();
  } else if (!ahead) {
    core::Result<std::unique_ptr<Simulation>> fresh = simulation->reopen(values_);
    if (!fresh.ok()) return fresh.error();
    simulation = std::move(fresh).value();
    another = true;
  }
  auto next = std::lower_bound(done_.begin(), done_.end(), simulation->step_count(),
                               [](const Done& done, std::uint64_t wanted) { return done.step < wanted; });
  while (simulation->step_count() < step) {
    for (; next != done_.end() && next->step <= simulation->step_count(); ++next) next->action(*simulation);
    if (const core::Status status = simulation->step(); !status.ok()) return status.error();
  }
  simulation->base().state.samples.clear();  // they were sent when the step was new
  return another;
}

}  // namespace carom::host
