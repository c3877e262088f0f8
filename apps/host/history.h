// The past of a run: its state every half second and what was done to it in between, so that any step of the last
// minute can be shown again, bit for bit. A demo that cannot be copied is run again from its start.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>

#include "apps/host/simulation.h"

namespace carom::host {

struct HistoryOptions {
  double window = 60;             ///< s that are remembered
  double interval = 0.5;          ///< s between saved states
  std::size_t bytes = 32u << 20;  ///< of saved states; beyond it every second one goes, and going back takes longer
};

class History {
 public:
  using Action = std::function<void(Simulation&)>;

  explicit History(HistoryOptions options = {}) : options_(options) {}

  /// A run begins: forgets everything.
  void begin(Simulation& simulation);
  /// Does something to the run, and remembers that it was done before the next step.
  void act(Simulation& simulation, Action action);
  /// Call before a step: what had come after is forgotten, the run goes another way from here. True where it did.
  bool branch(const Simulation& simulation);
  /// Call after a step.
  void stepped(Simulation& simulation);

  std::uint64_t first() const;  ///< the earliest step that can be shown
  std::uint64_t last() const { return last_; }
  /// Brings the run to this step, which is taken to the nearest one remembered. True where `simulation` is another
  /// object now, whose bodies have other ids.
  core::Result<bool> seek(std::unique_ptr<Simulation>& simulation, std::uint64_t step);

 private:
  struct Saved {
    std::uint64_t step = 0;
    std::unique_ptr<Memento> state;
  };
  struct Done {
    std::uint64_t step = 0;  ///< before the step that follows this one
    Action action;
  };
  void save(Simulation& simulation);
  void thin();

  HistoryOptions options_;
  std::vector<double> values_;  ///< at the start
  std::deque<Saved> saved_;
  std::deque<Done> done_;
  std::uint64_t last_ = 0, next_save_ = 0, interval_ = 30, window_ = 3600;
  bool copies_ = true;     ///< of the demo can be made
  bool own_time_ = false;  ///< its steps do not rise by one: what was shown cannot be found by its step
};

}  // namespace carom::host
