// Fixed steps under a variable frame rate: the accumulator that every game loop needs (chapter 7.1).
#pragma once

#include <cstdint>

#include "carom/math/vec.h"

namespace carom::ode {

/// What to do in one frame.
struct Frame {
  int steps = 0;         ///< fixed steps to take now
  double alpha = 0;      ///< 0 … 1: show lerp(previous state, current state, alpha)
  double dropped = 0;    ///< s of this frame that will never be simulated, because the limit was reached
  bool refused = false;  ///< the frame time was negative or not finite, and counted as zero
};

/// The caller's loop: `Frame frame = clock.advance(seconds since last frame); for (…frame.steps…) world.step(dt)`.
class FixedClock {
 public:
  /// `step` in s; anything that is not a finite number > 0 becomes 1/60. At least one step a frame is allowed.
  explicit FixedClock(double step = 1.0 / 60.0, int max_steps_per_frame = 8)
      : step_(step > 0 && math::is_finite(step) ? step : 1.0 / 60.0),
        max_steps_(max_steps_per_frame < 1 ? 1 : max_steps_per_frame) {}

  /// Adds the time since the last frame (s) and says how many steps are due. Time beyond the limit is dropped, so
  /// that a slow frame does not make the next one slower still.
  Frame advance(double seconds) {
    Frame frame;
    if (!(seconds >= 0) || !math::is_finite(seconds)) {
      frame.refused = true;
      seconds = 0;
    }
    seconds *= rate_;
    const double available = accumulator_ + seconds;
    // A frame that is a whole number of steps long must not lose one to rounding.
    const double due = (available + 1e-9 * step_) / step_;
    if (due >= double(max_steps_) + 1.0) {
      frame.steps = max_steps_;
      frame.dropped = available - double(max_steps_) * step_;
      accumulator_ = 0;
    } else {
      frame.steps = int(due);
      accumulator_ = math::max(0.0, available - double(frame.steps) * step_);
    }
    dropped_ += frame.dropped;
    steps_ += std::uint64_t(frame.steps);
    frame.alpha = math::min(1.0, accumulator_ / step_);
    return frame;
  }

  double step() const { return step_; }
  double time() const { return double(steps_) * step_; }              ///< s simulated: no sum, so no drift
  double show_time() const { return time() - step_ + accumulator_; }  ///< s, of the interpolated state
  std::uint64_t steps() const { return steps_; }
  double dropped() const { return dropped_; }  ///< s in all
  double rate() const { return rate_; }
  /// Slow motion and fast forward: simulated seconds a second; negative or not finite is ignored.
  void set_rate(double rate) {
    if (rate >= 0 && math::is_finite(rate)) rate_ = rate;
  }
  void reset() { *this = FixedClock(step_, max_steps_); }

 private:
  double step_;
  int max_steps_;
  double rate_ = 1;
  double accumulator_ = 0;
  double dropped_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace carom::ode
