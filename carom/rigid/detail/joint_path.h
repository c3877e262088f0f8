// The blocks of path joints: a curve in frame A, where on it B's anchor is, and what holds and drives it.
//
// γ(u) is piecewise cubic (Hermite) or straight; its tangent is t, its curvature vector k = dt/ds. The foot u of B's
// anchor d (in frame A) is where (d − γ)·γ′ = 0. Held are C_i = n_i·(d − γ) with n_i across t. As d − γ and the n_i
// stay across t, Ċ_i = n_i·ḋ at the foot exactly; so the row is that of a slider whose axis is the tangent. Along t
// runs an AxisLaw of the arc length s, with ṡ = t·ḋ where the anchor is on the curve. A body that follows has x of
// frame B along t: C_i = n_i·x_B, Ċ_i = (x_B × n_i)·(ω_B − ω_A) − (n_i·k) ṡ.
#pragma once

#include <cstring>

#include "carom/rigid/detail/joint_axis.h"
#include "carom/rigid/detail/joint_store.h"

namespace carom::rigid::detail {

template <class D>
class PathCurve {
 public:
  using Vector = typename D::Vector;
  struct Point {
    Vector p{}, d1{}, d2{};  ///< with derivatives by t
  };
  struct Knots {
    const Vector *p = nullptr, *tangent = nullptr;
    const float* arc = nullptr;
  };
  PathCurve() = default;
  PathCurve(const Knots& knots, std::int32_t count, bool closed, bool straight)
      : count_(count), closed_(closed), straight_(straight) {
    std::memcpy(knots_, &knots, sizeof knots);
  }
  bool closed() const { return closed_; }
  std::int32_t segments() const { return count_ - 1; }
  float length() const { return knots().arc[count_ - 1]; }

  Point at(PathPlace place) const {
    const Knots k = knots();
    const Vector a = k.p[place.segment], way = k.p[place.segment + 1] - a;
    if (straight_) return {a + place.t * way, way, {}};
    const Vector ta = k.tangent[place.segment], tb = k.tangent[place.segment + 1];
    const float t = clamp(place.t, 0.0f, 1.0f), s = 1 - t;
    Point r;
    r.p = a + (t * t * (1 + 2 * s)) * way + (t * s * s) * ta - (t * t * s) * tb;
    r.d1 = (6 * t * s) * way + (s * (1 - 3 * t)) * ta + (t * (3 * t - 2)) * tb;
    r.d2 = (6 - 12 * t) * way + (6 * t - 4) * ta + (6 * t - 2) * tb;
    if (place.t != t) {  // beyond an end
      r.p += (place.t - t) * r.d1;
      r.d2 = {};
    }
    return r;
  }
  /// The foot of d near `place`.
  PathPlace foot(const Vector& d, PathPlace place) const {
    int came_from = 0;  // −1: from the segment before, 1: from the one behind
    for (int i = 0; i < 16; ++i) {
      const Point g = at(place);
      const float speed = dot(g.d1, g.d1), slope = speed + dot(g.p - d, g.d2);
      const float step = -dot(g.p - d, g.d1) / (slope > 0.25f * speed ? slope : speed);
      place.t += clamp(step, -1.0f, 1.0f);
      const int past = place.t > 1 ? 1 : place.t < 0 ? -1 : 0;
      std::int32_t next = place.segment + past;
      if (closed_ && next < 0) next = segments() - 1;
      if (closed_ && next >= segments()) next = 0;
      if (past != 0 && next >= 0 && next < segments()) {
        if (came_from == past) {  // the corner itself is nearest
          place.t = past > 0 ? 1 : 0;
          return place;
        }
        came_from = -past;
        const float left = length_of(place.segment) / length_of(next);
        place = {next, past > 0 ? (place.t - 1) * left : 1 + place.t * left};
        place.t = clamp(place.t, 0.0f, 1.0f);
        continue;
      }
      if (math::abs(step) < 1e-6f) break;
    }
    return place;
  }
  /// The foot of d on the whole path.
  PathPlace nearest(const Vector& d) const {
    PathPlace best;
    float least = 3e38f;
    for (std::int32_t i = 0; i < segments(); ++i)
      for (int k = 0; k <= 8; ++k) {
        const PathPlace place{i, float(k) / 8};
        const float distance = math::length_squared(at(place).p - d);
        if (distance < least) least = distance, best = place;
      }
    return foot(d, best);
  }
  /// m from the first point.
  float arc(PathPlace place) const {
    const float start = knots().arc[place.segment];
    if (straight_) return start + place.t * length_of(place.segment);
    const float t = clamp(place.t, 0.0f, 1.0f);
    return start + arc_within(place.segment, t) + (place.t - t) * math::length(at({place.segment, t}).d1);
  }
  /// m from knot `segment` to the fraction t: Gauss and Legendre's rule of five points.
  float arc_within(std::int32_t segment, float t) const {
    constexpr float x[] = {-0.9061798459f, -0.5384693101f, 0, 0.5384693101f, 0.9061798459f};
    constexpr float w[] = {0.2369268851f, 0.4786286705f, 0.5688888889f, 0.4786286705f, 0.2369268851f};
    float sum = 0;
    for (int i = 0; i < 5; ++i) sum += w[i] * math::length(at({segment, 0.5f * t * (1 + x[i])}).d1);
    return 0.5f * t * sum;
  }

 private:
  float length_of(std::int32_t segment) const { return knots().arc[segment + 1] - knots().arc[segment]; }
  Knots knots() const {
    Knots k;
    std::memcpy(&k, knots_, sizeof k);
    return k;
  }
  alignas(4) unsigned char knots_[sizeof(Knots)] = {};  ///< as bytes: records hold nothing of wider alignment
  std::int32_t count_ = 0;
  bool closed_ = false, straight_ = false;
};

/// Where the curve is and where B's anchor is on it.
template <class D>
struct PathPose {
  using Vector = typename D::Vector;
  static constexpr int across = D::dimension - 1;
  Vector arm_a{}, arm_b{}, offset{};  ///< as in PinBlock; arm_a: to the origin of frame A
  typename D::Rotation frame_a{};     ///< in the world at the start of the step
  PathCurve<D> curve{};
  PathPlace place{};
  Vector normal{};  ///< in frame A: the first of those across the tangent

  struct Now {
    Vector tangent{}, normal[across], curvature{};  ///< world; curvature in 1/m
    Vector reach{}, b{};                            ///< from the centres to B's anchor
    float error[across] = {};                       ///< m, along the normals
  };
  template <class Pair>
  Now now(const Pair& pair) {
    Now r;
    r.b = rotate(pair.turn_b, arm_b);
    r.reach = offset + pair.shift + r.b;
    const auto q = pair.turn_a * frame_a;
    const Vector d = inverse_rotate(q, r.reach - rotate(pair.turn_a, arm_a));
    place = curve.foot(d, place);
    const auto g = curve.at(place);
    const float speed_squared = dot(g.d1, g.d1);
    const Vector t = g.d1 * (1 / math::sqrt(speed_squared));
    Vector n[across];
    if constexpr (D::dimension == 2) {
      n[0] = {-t.y, t.x};
    } else {  // the normal of before, laid across
      Vec3f first = normal - dot(normal, t) * t;
      if (!(dot(first, first) > 1e-4f)) first = cross(t, math::abs(t.x) < 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0});
      n[0] = normalize(first);
      n[1] = cross(t, n[0]);
    }
    normal = n[0];
    r.tangent = rotate(q, t);
    r.curvature = rotate(q, (g.d2 - dot(t, g.d2) * t) * (1 / speed_squared));
    for (int i = 0; i < across; ++i) {
      r.normal[i] = rotate(q, n[i]);
      r.error[i] = dot(n[i], d - g.p);
    }
    return r;
  }
};

template <class D>
struct PathBlock {
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  static constexpr int across = D::dimension - 1, most = 2 * across;
  PathPose<D> pose{};
  bool follow = false;
  Vector along_b{};          ///< x of frame B in the world at the start of the step
  float impulse[most] = {};  ///< of the rows that follow, then of those that hold

  struct Row {
    Vector n{};
    Angular lever_a{}, lever_b{};
    float error = 0;
  };
  template <class Pair>
  int rows(const Pair& pair, Row (&row)[most]) {
    const auto now = pose.now(pair);
    int count = 0;
    for (int i = 0; i < across && follow; ++i) {
      const Vector x = rotate(pair.turn_b, along_b), n = -dot(now.normal[i], now.curvature) * now.tangent;
      const Angular turn = cross(x, now.normal[i]);
      row[count++] = {n, turn + cross(now.reach, n), turn + cross(now.b, n), dot(now.normal[i], x)};
    }
    for (int i = 0; i < across; ++i)
      row[count++] = {now.normal[i], cross(now.reach, now.normal[i]), cross(now.b, now.normal[i]), now.error[i]};
    return count;
  }
  template <class Pair>
  void warm_start(Pair& pair) {
    Row row[most];
    const int count = rows(pair, row);
    for (int i = 0; i < count; ++i) pair.apply_row(impulse[i], row[i].n, row[i].lever_a, row[i].lever_b);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    Row row[most];
    const int count = rows(pair, row);
    const Response& r = pass.rigid;
    for (int i = 0; i < count; ++i) {
      const float mobility = pair.row_inverse_mass(row[i].lever_a, row[i].lever_b);
      const float residual =
          r.velocity * pair.row_velocity(row[i].n, row[i].lever_a, row[i].lever_b) + r.position * row[i].error;
      const float change = -solve_mobility(mobility, residual) - r.memory * impulse[i];
      impulse[i] += change;
      pair.apply_row(change, row[i].n, row[i].lever_a, row[i].lever_b);
    }
  }
};

/// Spring, motor and stops along a path.
template <class D>
struct PathAxis {
  PathPose<D> pose{};
  AxisLaw law{};

  struct Row {
    typename D::Vector n{};
    typename D::Angular lever_a{}, lever_b{};
    float coordinate = 0;
  };
  template <class Pair>
  Row row(const Pair& pair) {
    const auto now = pose.now(pair);
    Row r{now.tangent, cross(now.reach, now.tangent), cross(now.b, now.tangent), 0};
    if (!law.needs_coordinate()) return r;
    r.coordinate = pose.curve.arc(pose.place);
    if (pose.curve.closed() && law.has(AxisLaw::spring)) {  // the shorter way to the target
      const float length = pose.curve.length(), away = (r.coordinate - law.rest) / length;
      r.coordinate = law.rest + length * (away - math::floor(away + 0.5f));
    }
    return r;
  }
  template <class Pair>
  void note_speed(const Pair& pair) {
    const Row r = row(pair);
    law.before = pair.row_velocity(r.n, r.lever_a, r.lever_b);
  }
  template <class Pair>
  void warm_start(Pair& pair) {
    const Row r = row(pair);
    pair.apply_row(law.total(), r.n, r.lever_a, r.lever_b);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    const Row r = row(pair);
    const float change = law.solve(pair.row_inverse_mass(r.lever_a, r.lever_b), r.coordinate,
                                   pair.row_velocity(r.n, r.lever_a, r.lever_b), pass);
    pair.apply_row(change, r.n, r.lever_a, r.lever_b);
  }
};

/// The knots of a definition that was found right go to the end of the store's.
template <class D>
void add_knots(JointStore<D>& joints, JointData<D>& data);
/// The curve of a path joint.
template <class D>
PathCurve<D> curve_of(const JointStore<D>& joints, const JointData<D>& data);
/// Takes a joint's knots out.
template <class D>
void drop_knots(JointStore<D>& joints, std::int32_t joint);
/// The definition with what its spans had when the joint was made.
template <class D>
AnyJointDef<D> whole_definition(const JointStore<D>& joints, const JointData<D>& data);

}  // namespace carom::rigid::detail
