#include "carom/forces/suvat.h"

#include "carom/math/vec.h"

namespace carom::forces {

using core::Error;
using core::Result;

namespace detail {

constexpr const char* no_motion = "constant acceleration: no motion has these three values";
constexpr const char* many_motions = "constant acceleration: these three values leave the motion undetermined";

void keep(MotionSolutions& out, const ConstantAcceleration& motion) {
  if (!math::is_finite(motion.displacement) || !math::is_finite(motion.initial_velocity) ||
      !math::is_finite(motion.final_velocity) || !math::is_finite(motion.acceleration) || !math::is_finite(motion.time))
    return;
  if (out.count == 1 && out.motion[0].time == motion.time &&
      out.motion[0].initial_velocity == motion.initial_velocity &&
      out.motion[0].final_velocity == motion.final_velocity)
    return;
  out.motion[out.count++] = motion;
}

/// From u, v and one of a, s: the time by the formula that does not cancel.
double time_of(double s, double u, double v, double a) {
  return math::abs(u + v) > math::abs(v - u) ? 2 * s / (u + v) : (v - u) / a;
}

}  // namespace detail

double residual(const ConstantAcceleration& m) {
  const double s = m.displacement, u = m.initial_velocity, v = m.final_velocity, a = m.acceleration, t = m.time;
  const auto relative = [](double x, double size) { return size > 0 ? math::abs(x) / size : 0.0; };
  const double size_v = math::abs(u) + math::abs(v) + math::abs(a * t);
  const double size_s = math::abs(s) + math::abs(u * t) + math::abs(v * t) + math::abs(a * t * t);
  const double size_2 = u * u + v * v + 2 * math::abs(a * s);
  double worst = relative(v - (u + a * t), size_v);
  worst = math::max(worst, relative(s - (u * t + 0.5 * a * t * t), size_s));
  worst = math::max(worst, relative(s - (v * t - 0.5 * a * t * t), size_s));
  worst = math::max(worst, relative(v * v - (u * u + 2 * a * s), size_2));
  return math::max(worst, relative(s - 0.5 * (u + v) * t, size_s));
}

Result<MotionSolutions> solve_constant_acceleration(const KnownMotion& known) {
  const std::optional<double>* const fields[5] = {&known.displacement, &known.initial_velocity, &known.final_velocity,
                                                  &known.acceleration, &known.time};
  constexpr const char* names[5] = {"displacement", "initial_velocity", "final_velocity", "acceleration", "time"};
  int given = 0;
  for (int i = 0; i < 5; ++i) {
    if (!fields[i]->has_value()) continue;
    ++given;
    if (!math::is_finite(**fields[i]))
      return Error{std::string("constant acceleration: ") + names[i] + " is not finite, expected a number"};
  }
  if (given != 3)
    return Error{"constant acceleration: found " + std::to_string(given) + " known values, expected exactly three"};

  const bool has_s = known.displacement.has_value(), has_u = known.initial_velocity.has_value(),
             has_v = known.final_velocity.has_value(), has_a = known.acceleration.has_value(),
             has_t = known.time.has_value();
  const double s = known.displacement.value_or(0), u = known.initial_velocity.value_or(0),
               v = known.final_velocity.value_or(0), a = known.acceleration.value_or(0), t = known.time.value_or(0);
  MotionSolutions out;
  if (has_t && t == 0 && !(has_a && !has_s && (has_u || has_v))) {
    // At t = 0: s = 0 and u = v, whatever a is.
    const bool consistent = (!has_s || s == 0) && (!(has_u && has_v) || u == v);
    return Error{consistent ? detail::many_motions : detail::no_motion};
  }
  if (has_t) {
    if (has_u && has_v)
      detail::keep(out, {0.5 * (u + v) * t, u, v, (v - u) / t, t});
    else if (has_u && has_a)
      detail::keep(out, {u * t + 0.5 * a * t * t, u, u + a * t, a, t});
    else if (has_v && has_a)
      detail::keep(out, {v * t - 0.5 * a * t * t, v - a * t, v, a, t});
    else if (has_u && has_s)
      detail::keep(out, {s, u, 2 * s / t - u, 2 * (s - u * t) / (t * t), t});
    else if (has_v && has_s)
      detail::keep(out, {s, 2 * s / t - v, v, 2 * (v * t - s) / (t * t), t});
    else
      detail::keep(out, {s, s / t - 0.5 * a * t, s / t + 0.5 * a * t, a, t});
  } else if (has_u && has_v && has_a) {
    if (a == 0) return Error{u == v ? detail::many_motions : detail::no_motion};
    const double time = (v - u) / a;
    detail::keep(out, {0.5 * (u + v) * time, u, v, a, time});
  } else if (has_u && has_v && has_s) {
    if (u + v == 0) {
      // The way out and back takes any time: s = 0.
      return Error{s == 0 ? detail::many_motions : detail::no_motion};
    }
    const double time = 2 * s / (u + v);
    if (time == 0) return Error{u == v ? detail::many_motions : detail::no_motion};
    detail::keep(out, {s, u, v, (v - u) / time, time});
  } else {
    // s, a and one velocity w: the other is ±√(w² ± 2as).
    const double w = has_u ? u : v, square = w * w + (has_u ? 2 : -2) * a * s;
    if (square < 0) return Error{detail::no_motion};
    if (a == 0 && w == 0) return Error{s == 0 ? detail::many_motions : detail::no_motion};
    const double root = math::sqrt(square);
    for (const double other : {root, -root}) {
      const double first = has_u ? w : other, last = has_u ? other : w;
      if (a == 0 && first + last == 0) continue;
      detail::keep(out, {s, first, last, a, detail::time_of(s, first, last, a)});
    }
  }
  if (out.count == 0) return Error{detail::no_motion};
  if (out.count == 2) {
    const double t0 = out.motion[0].time, t1 = out.motion[1].time;
    if ((t1 >= 0 && t0 < 0) || ((t0 >= 0) == (t1 >= 0) && t1 < t0)) {
      const ConstantAcceleration first = out.motion[0];
      out.motion[0] = out.motion[1];
      out.motion[1] = first;
    }
  }
  return out;
}

}  // namespace carom::forces
