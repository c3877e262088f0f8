// Adaptive integration: the embedded pair of Dormand and Prince 5(4) with a proportional–integral step-size
// controller, dense output and event location.
// Sources: Dormand & Prince, J. Comput. Appl. Math. 6 (1980) 19–26; Hairer, Nørsett & Wanner, Solving Ordinary
// Differential Equations I, II.4–II.6 (controller, dense output of order 4, starting step).
#pragma once

#include <array>
#include <vector>

#include "carom/math/elementary.h"
#include "carom/ode/methods.h"

namespace carom::ode {

struct AdaptiveOptions {
  double relative_tolerance = 1e-8;
  double absolute_tolerance = 1e-8;
  double initial_step = 0;      ///< s; 0: chosen from the derivative
  double minimum_step = 0;      ///< s; 0: 16 ulp of the time
  double maximum_step = 0;      ///< s; 0: no limit
  int maximum_steps = 1000000;  ///< a call of `advance`, rejected ones included
};

/// Direction in which a function must pass zero to be an event.
enum class Crossing { any, rising, falling };

struct EventOptions {
  Crossing crossing = Crossing::any;
  double time_tolerance = 1e-12;  ///< s, absolute
  int samples = 4;                ///< parts of a step in which a change of sign is looked for
};

namespace detail {

/// The states an adaptive integrator owns: values, or spans over one vector that is allocated once.
template <class S, std::size_t count>
struct States {
  std::array<S, count> s{};
  explicit States(const S& like) { s.fill(like); }
  S& operator[](std::size_t i) { return s[i]; }
  const S& operator[](std::size_t i) const { return s[i]; }
  S* data() { return s.data(); }
};
template <std::size_t count>
struct States<Span, count> {
  std::vector<double> memory;
  std::array<Span, count> s{};
  explicit States(const Span& like) : memory(count * like.size()) {
    for (std::size_t i = 0; i < count; ++i) {
      s[i] = Span(memory).subspan(i * like.size(), like.size());
      copy(s[i], like);
    }
  }
  States(const States&) = delete;
  States& operator=(const States&) = delete;
  Span& operator[](std::size_t i) { return s[i]; }
  const Span& operator[](std::size_t i) const { return s[i]; }
  Span* data() { return s.data(); }
};

}  // namespace detail

/// Integrates ẏ = f(t, y) from (t₀, y₀), forward or backward in time. The state is copied; span states make the one
/// allocation when constructed. Every value state needs `components`.
template <class S>
class DormandPrince {
 public:
  DormandPrince(double t0, const S& y0, const AdaptiveOptions& options = {})
      : options_(options), states_(y0), t_(t0), previous_t_(t0), step_(options.initial_step) {}

  double t() const { return t_; }
  const S& y() const { return states_[y_now]; }
  double previous_t() const { return previous_t_; }
  int accepted() const { return accepted_; }
  int rejected() const { return rejected_; }
  double next_step() const { return step_; }  ///< s, the length that the controller would take now

  /// One accepted step toward t_end, and not beyond it.
  template <class F>
  [[nodiscard]] Outcome step(const F& f, double t_end) {
    const double span = t_end - t_;
    if (!math::is_finite(span) || !(options_.relative_tolerance > 0 || options_.absolute_tolerance > 0))
      return Outcome::bad_argument;
    if (span == 0) return Outcome::done;
    const double direction = span > 0 ? 1.0 : -1.0;
    if (!started_ || direction != direction_) start(f, direction);
    bool after_rejection = false;
    for (;;) {
      if (budget_ > 0) {
        --budget_;
        if (budget_ == 0) return Outcome::too_many_steps;
      }
      double h = math::abs(step_);
      if (options_.maximum_step > 0) h = math::min(h, options_.maximum_step);
      const double remaining = math::abs(t_end - t_);
      const double smallest = math::max(options_.minimum_step, 16 * 2.3e-16 * math::abs(t_));
      const bool last = h >= remaining * (1 - 1e-12);
      if (last)
        h = remaining;
      else if (h > 0.5 * remaining)
        h = 0.5 * remaining;  // two equal steps rather than a long and a tiny one
      if (!(h >= smallest) && !last) return Outcome::step_too_small;
      const double signed_h = direction * h;
      detail::dormand_prince_stages(f, t_, states_[y_now], signed_h, states_.data(), states_[y_next], states_[scratch]);
      const double error = error_ratio(signed_h);
      if (!math::is_finite(error)) {
        if (h <= smallest * 2 || h < 1e-200) return Outcome::not_finite;
        step_ = 0.1 * h;
        ++rejected_;
        after_rejection = true;
        continue;
      }
      if (error <= 1) {
        const double factor = controlled(error);
        if (!last || factor < 1)
          step_ = h * (after_rejection ? math::min(1.0, factor) : factor);
        else
          step_ = math::max(step_, h * factor);
        previous_error_ = math::max(error, 1e-4);
        accept(signed_h, last ? t_end : t_ + signed_h);
        return Outcome::done;
      }
      step_ = h * math::max(0.2, 0.9 * math::pow(error, -0.2));
      ++rejected_;
      after_rejection = true;
      if (last && step_ < smallest) return Outcome::step_too_small;
    }
  }

  /// Accepted steps until exactly t_end.
  template <class F>
  [[nodiscard]] Outcome advance(const F& f, double t_end) {
    return advance(f, t_end, [](const DormandPrince&) {});
  }
  /// The same; after every accepted step `observe(*this)` may ask `dense` for states between previous_t and t.
  template <class F, class Observer>
  [[nodiscard]] Outcome advance(const F& f, double t_end, Observer&& observe) {
    budget_ = options_.maximum_steps > 0 ? options_.maximum_steps + 1 : 0;
    while (t_ != t_end) {
      const Outcome outcome = step(f, t_end);
      if (outcome != Outcome::done) return outcome;
      observe(*this);
    }
    return Outcome::done;
  }

  /// The state at a time of the last accepted step, by a polynomial with an error of order h⁵ (global order 4).
  void dense(double time, S& out) const {
    if (dense_length_ == 0) return detail::copy(out, states_[y_now]);
    const double x = (time - previous_t_) / dense_length_, x1 = 1 - x;
    detail::copy(out, states_[y_before]);
    detail::add(out, x, states_[dense_difference]);
    detail::add(out, x * x1, states_[dense_start]);
    detail::add(out, x * x1 * x, states_[dense_end]);
    detail::add(out, x * x1 * x * x1, states_[dense_middle]);
  }
  S dense(double time) const
    requires(!std::is_same_v<S, std::span<double>>)
  {
    S out{};
    dense(time, out);
    return out;
  }

  /// Advances to t_end, or to the first zero of g(t, y) on the way: then `found` is set and t(), y() are those of the
  /// event, just past the zero by at most the time tolerance, so that a further call goes on from there.
  /// Two zeros within one part of a step (EventOptions::samples) are not seen.
  template <class F, class G>
  [[nodiscard]] Outcome advance_to_event(const F& f, double t_end, const G& g, bool& found,
                                         const EventOptions& event = {}) {
    found = false;
    budget_ = options_.maximum_steps > 0 ? options_.maximum_steps + 1 : 0;
    double before = value_of(g, t_, states_[y_now]);
    while (t_ != t_end) {
      const Outcome outcome = step(f, t_end);
      if (outcome != Outcome::done) return outcome;
      const int samples = math::max(event.samples, 1);
      double left = previous_t_;
      for (int i = 1; i <= samples; ++i) {
        const double right = i == samples ? t_ : previous_t_ + (t_ - previous_t_) * i / samples;
        const double after = i == samples ? value_of(g, t_, states_[y_now]) : value_at(g, right);
        if (is_crossing(before, after, event.crossing)) {
          const double time = locate(g, left, before, right, after, event.time_tolerance);
          truncate(f, time);
          found = true;
          return Outcome::done;
        }
        left = right;
        before = after;
      }
    }
    return Outcome::done;
  }

 private:
  // k₁ … k₇ first, because the stages are written by index.
  enum : std::size_t {
    y_now = 7,
    y_next,
    y_before,
    scratch,
    dense_difference,
    dense_start,
    dense_end,
    dense_middle,
    state_count
  };

  template <class F>
  void start(const F& f, double direction) {
    direction_ = direction;
    detail::evaluate(f, t_, states_[y_now], states_[0]);
    previous_error_ = 1e-4;
    const bool first = !started_;
    started_ = true;
    if (!first || options_.initial_step > 0) return;
    // Hairer's starting step: from the sizes of y, ẏ and an estimate of ÿ.
    const double d0 = scaled_norm(states_[y_now], states_[y_now]), d1 = scaled_norm(states_[0], states_[y_now]);
    const double h0 = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;
    detail::sum(states_[scratch], states_[y_now], direction * h0, states_[0]);
    detail::evaluate(f, t_ + direction * h0, states_[scratch], states_[1]);
    detail::add(states_[1], -1.0, states_[0]);
    const double d2 = scaled_norm(states_[1], states_[y_now]) / h0, d = math::max(d1, d2);
    const double h1 = d <= 1e-15 ? math::max(1e-6, h0 * 1e-3) : math::pow(0.01 / d, 0.2);
    step_ = math::min(100 * h0, h1);
    if (!math::is_finite(step_) || !(step_ > 0)) step_ = 1e-6;
  }

  double scaled_norm(const S& x, const S& y) const {
    double sum = 0;
    std::size_t n = 0;
    detail::for_each_component(x, y, y, [&](double value, double state, double) {
      const double scale = options_.absolute_tolerance + options_.relative_tolerance * math::abs(state);
      sum += math::square(value / scale);
      ++n;
    });
    return n == 0 ? 0 : math::sqrt(sum / double(n));
  }

  double error_ratio(double h) {
    S& e = states_[scratch];
    detail::scale(e, h * (71.0 / 57600), states_[0]);
    detail::add(e, h * (-71.0 / 16695), states_[2]);
    detail::add(e, h * (71.0 / 1920), states_[3]);
    detail::add(e, h * (-17253.0 / 339200), states_[4]);
    detail::add(e, h * (22.0 / 525), states_[5]);
    detail::add(e, h * (-1.0 / 40), states_[6]);
    double sum = 0;
    std::size_t n = 0;
    bool finite = true;
    detail::for_each_component(e, states_[y_now], states_[y_next], [&](double error, double y0, double y1) {
      const double scale =
          options_.absolute_tolerance + options_.relative_tolerance * math::max(math::abs(y0), math::abs(y1));
      finite = finite && math::is_finite(error) && math::is_finite(y1);
      sum += math::square(error / scale);
      ++n;
    });
    if (!finite) return __builtin_nan("");
    return n == 0 ? 0 : math::sqrt(sum / double(n));
  }

  /// Gustafsson's proportional–integral control: h ← h · 0.9 · error^(−0.7/5) · previous^(0.4/5), within [0.2, 10].
  double controlled(double error) const {
    if (error < 1e-30) return 10;
    const double factor = 0.9 * math::pow(error, -0.7 / 5) * math::pow(previous_error_, 0.4 / 5);
    return math::clamp(factor, 0.2, 10.0);
  }

  void accept(double h, double t_next) {
    detail::copy(states_[y_before], states_[y_now]);
    detail::copy(states_[y_now], states_[y_next]);
    S &difference = states_[dense_difference], &first = states_[dense_start], &last = states_[dense_end],
      &middle = states_[dense_middle];
    detail::sum(difference, states_[y_now], -1.0, states_[y_before]);
    detail::scale(first, h, states_[0]);
    detail::add(first, -1.0, difference);
    detail::sum(last, difference, -h, states_[6]);
    detail::add(last, -1.0, first);
    detail::scale(middle, h * (-12715105075.0 / 11282082432.0), states_[0]);
    detail::add(middle, h * (87487479700.0 / 32700410799.0), states_[2]);
    detail::add(middle, h * (-10690763975.0 / 1880347072.0), states_[3]);
    detail::add(middle, h * (701980252875.0 / 199316789632.0), states_[4]);
    detail::add(middle, h * (-1453857185.0 / 822651844.0), states_[5]);
    detail::add(middle, h * (69997945.0 / 29380423.0), states_[6]);
    detail::copy(states_[0], states_[6]);  // the last stage is the first of the next step
    previous_t_ = t_;
    t_ = t_next;
    dense_length_ = t_next - previous_t_;
    ++accepted_;
  }

  template <class G>
  double value_of(const G& g, double t, const S& y) const {
    if constexpr (std::is_same_v<S, std::span<double>>)
      return g(t, std::span<const double>(y));
    else
      return g(t, y);
  }
  template <class G>
  double value_at(const G& g, double time) {
    dense(time, states_[scratch]);
    return value_of(g, time, states_[scratch]);
  }
  static bool is_crossing(double before, double after, Crossing crossing) {
    const bool rising = before < 0 && after >= 0, falling = before > 0 && after <= 0;
    return crossing == Crossing::any ? rising || falling : (crossing == Crossing::rising ? rising : falling);
  }
  /// The Illinois variant of the secant method, held in its bracket, with a bisection whenever that shrinks slowly.
  /// Returns the end of the bracket beyond the zero.
  template <class G>
  double locate(const G& g, double left, double g_left, double right, double g_right, double tolerance) {
    const bool rising = g_left < 0;
    int side = 0;
    for (int i = 0; i < 200 && math::abs(right - left) > tolerance; ++i) {
      const double width = right - left;
      double middle = i % 3 == 2 ? left + 0.5 * width : left + width * (g_left / (g_left - g_right));
      if (!(math::abs(middle - left) < math::abs(width)) || (middle - left) * width <= 0) middle = left + 0.5 * width;
      if (middle == left || middle == right) break;
      const double value = value_at(g, middle);
      if (rising ? value >= 0 : value <= 0) {
        right = middle;
        g_right = value;
        if (side == 1) g_left *= 0.5;
        side = 1;
      } else {
        left = middle;
        g_left = value;
        if (side == -1) g_right *= 0.5;
        side = -1;
      }
    }
    return right;
  }
  /// Makes (time, dense(time)) the current state. The polynomial of the step stays as it is.
  template <class F>
  void truncate(const F& f, double time) {
    if (time == t_) return;
    dense(time, states_[scratch]);
    detail::copy(states_[y_now], states_[scratch]);
    t_ = time;
    detail::evaluate(f, t_, states_[y_now], states_[0]);
  }

  AdaptiveOptions options_;
  detail::States<S, state_count> states_;
  double t_, previous_t_, step_;
  double dense_length_ = 0;  // of the step that the polynomial spans, from previous_t_
  double previous_error_ = 1e-4;
  double direction_ = 0;
  bool started_ = false;
  int accepted_ = 0, rejected_ = 0;
  int budget_ = 0;
};

}  // namespace carom::ode
