// What an integrator needs of a state. Three kinds work: values with + and multiplication by a double on the left
// (double, Vec3d, a struct of the user), `Motion` of such values where a method must know which half is velocity,
// and std::span<double> with memory lent by the caller.
#pragma once

#include <cstring>
#include <span>
#include <type_traits>

#include "carom/math/quat.h"

namespace carom::ode {

/// How many doubles a value state consists of. Specialise it for a trivially copyable struct of doubles, and error
/// control and Newton's iteration work with it too:
/// `template <> inline constexpr int carom::ode::components<MyState> = 13;`
template <class S>
inline constexpr int components = 0;
template <>
inline constexpr int components<double> = 1;
template <>
inline constexpr int components<math::Vec2d> = 2;
template <>
inline constexpr int components<math::Vec3d> = 3;
template <>
inline constexpr int components<math::Vec4d> = 4;
template <>
inline constexpr int components<math::Quatd> = 4;

/// Position and velocity of a second-order system ẋ = v, v̇ = a(t, x, v). As a derivative it holds (v, a).
/// A span state is split in the middle: positions first, then as many velocities.
template <class Q>
struct Motion {
  Q position{};
  Q velocity{};
  friend constexpr Motion operator+(const Motion& a, const Motion& b) {
    return {a.position + b.position, a.velocity + b.velocity};
  }
  friend constexpr Motion operator*(double s, const Motion& a) { return {s * a.position, s * a.velocity}; }
};
template <class Q>
inline constexpr int components<Motion<Q>> = 2 * components<Q>;

/// How a step or an integration ended.
enum class Outcome {
  done,
  not_partitioned,  ///< the method needs to know velocities: use Motion or a span of even length
  no_convergence,   ///< the implicit equation was not solved: the step is too long
  not_finite,       ///< the derivative or the state became NaN or infinite
  step_too_small,   ///< the tolerance asks for steps below the smallest one allowed
  too_many_steps,
  bad_argument,  ///< a step, tolerance or workspace that cannot be used
};

namespace detail {

template <class S>
inline constexpr bool is_motion = false;
template <class Q>
inline constexpr bool is_motion<Motion<Q>> = true;
using Span = std::span<double>;

template <class S>
void copy(S& to, const S& from) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i];
  } else {
    to = from;
  }
}

/// out ← h x
template <class S>
void scale(S& out, double h, const S& x) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = h * x[i];
  } else {
    out = h * x;
  }
}

/// y ← y + h x
template <class S>
void add(S& y, double h, const S& x) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = y[i] + h * x[i];
  } else {
    y = y + h * x;
  }
}

/// out ← y + h x
template <class S>
void sum(S& out, const S& y, double h, const S& x) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < y.size(); ++i) out[i] = y[i] + h * x[i];
  } else {
    out = y + h * x;
  }
}

/// out ← f(t, y)
template <class S, class F>
void evaluate(const F& f, double t, const S& y, S& out) {
  if constexpr (std::is_same_v<S, Span>)
    f(t, std::span<const double>(y), out);
  else
    out = f(t, y);
}

template <class S>
constexpr std::size_t size_of(const S& y) {
  if constexpr (std::is_same_v<S, Span>)
    return y.size();
  else
    return std::size_t(components<S>);
}

/// The doubles of a state, in place for spans, copied for values.
template <class S>
void unpack(const S& y, double* out) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < y.size(); ++i) out[i] = y[i];
  } else {
    static_assert(std::is_trivially_copyable_v<S> && sizeof(S) == std::size_t(components<S>) * sizeof(double),
                  "specialise carom::ode::components for this state");
    std::memcpy(out, &y, sizeof(S));
  }
}
template <class S>
void pack(const double* values, S& y) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = values[i];
  } else {
    std::memcpy(static_cast<void*>(&y), values, sizeof(S));
  }
}

/// Component by component loop over two or three states without copying spans.
template <class S, class Visitor>
void for_each_component(const S& a, const S& b, const S& c, Visitor&& visit) {
  if constexpr (std::is_same_v<S, Span>) {
    for (std::size_t i = 0; i < a.size(); ++i) visit(a[i], b[i], c[i]);
  } else {
    constexpr std::size_t n = std::size_t(components<S>);
    double x[n], y[n], z[n];
    unpack(a, x);
    unpack(b, y);
    unpack(c, z);
    for (std::size_t i = 0; i < n; ++i) visit(x[i], y[i], z[i]);
  }
}

}  // namespace detail
}  // namespace carom::ode
