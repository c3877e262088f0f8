// The blocks of joints that act along or about one axis: spring, motor and limits of a coordinate, or its hold.
#pragma once

#include "carom/rigid/detail/joint_blocks.h"

namespace carom::rigid::detail {

/// Spring, motor and limits of one coordinate. Solved one after the other on the coordinate's own speed.
struct AxisLaw {
  enum Flag : std::uint8_t { spring = 1, motor = 2, lower = 4, upper = 8, rigid = 16, pull_only = 32, periodic = 64 };
  std::uint8_t flags = 0;
  Response response{};
  float rest = 0, speed = 0, max_spring_impulse = 0, max_motor_impulse = 0, low = 0, high = 0;
  float spring_impulse = 0, motor_impulse = 0, lower_impulse = 0, upper_impulse = 0;
  float before = 0;  ///< as in PointBlock

  bool has(Flag f) const { return (flags & f) != 0; }
  bool needs_coordinate() const { return (flags & (spring | lower | upper)) != 0; }
  float total() const { return spring_impulse + motor_impulse + lower_impulse - upper_impulse; }

  /// Returns the impulse to add; `v` is the rate of `coordinate`.
  float solve(float inverse_mass, float coordinate, float v, const JointPass& pass) {
    if (!(inverse_mass > 0)) return 0;
    const float mass = 1 / inverse_mass;
    float sum = 0;
    if (has(spring)) {
      if (!has(rigid) && !pass.use_bias) {
        before = v;
      } else {
        const Response& r = has(rigid) ? pass.rigid : response;
        const float error = has(periodic) ? wrap_angle(coordinate - rest) : coordinate - rest;
        const float old = spring_impulse;
        const float residual = r.velocity * v + r.position * error + (has(rigid) ? 0 : r.previous * before);
        spring_impulse = old - mass * residual - r.memory * old;
        if (has(pull_only)) spring_impulse = min(spring_impulse, 0.0f);
        if (max_spring_impulse > 0) spring_impulse = clamp(spring_impulse, -max_spring_impulse, max_spring_impulse);
        add(spring_impulse - old, inverse_mass, v, sum);
      }
    }
    if (has(motor)) {
      const float old = motor_impulse;
      motor_impulse = clamp(old - mass * (v - speed), -max_motor_impulse, max_motor_impulse);
      add(motor_impulse - old, inverse_mass, v, sum);
    }
    float x = coordinate;
    if (has(periodic) && (has(lower) || has(upper))) {
      const float middle = 0.5f * (low + high);
      x = middle + wrap_angle(coordinate - middle);  // the turn nearest to the permitted range
    }
    if (has(lower)) add(one_sided(lower_impulse, mass, x - low, v, pass), inverse_mass, v, sum);
    if (has(upper)) add(-one_sided(upper_impulse, mass, high - x, -v, pass), inverse_mass, v, sum);
    return sum;
  }

 private:
  static void add(float change, float inverse_mass, float& v, float& sum) {
    v += inverse_mass * change;
    sum += change;
  }
  /// A stop: `gap` may close within the substep, but no further. Returns the change of its impulse.
  static float one_sided(float& impulse, float mass, float gap, float v, const JointPass& pass) {
    const float old = impulse;
    float next;
    if (gap > 0) {
      next = old - mass * (v + gap * pass.inverse_h);
    } else {
      const Response& r = pass.rigid;
      next = old - mass * (r.velocity * v + r.position * gap) - r.memory * old;
    }
    impulse = max(next, 0.0f);
    return impulse - old;
  }
};

template <class D>
struct LinearAxis {
  using Vector = typename D::Vector;
  bool between_anchors = true;  ///< the axis runs from anchor to anchor; else it is fixed in A
  Vector arm_a{}, arm_b{}, offset{};
  Vector axis{};  ///< A's axis in the world at the start of the step; between anchors: used where they coincide
  AxisLaw law{};

  struct Row {
    Vector n{};
    typename D::Angular lever_a{}, lever_b{};
    float coordinate = 0;
  };
  template <class Pair>
  Row row(const Pair& pair) const {
    const Vector a = rotate(pair.turn_a, arm_a), b = rotate(pair.turn_b, arm_b);
    const Vector reach = offset + pair.shift + b, d = reach - a;
    Row r;
    if (between_anchors) {
      r.coordinate = math::length(d);
      r.n = r.coordinate > 1e-6f ? d * (1 / r.coordinate) : axis;
      r.lever_a = cross(a, r.n);
    } else {
      r.n = rotate(pair.turn_a, axis);
      r.coordinate = dot(d, r.n);
      r.lever_a = cross(reach, r.n);
    }
    r.lever_b = cross(b, r.n);
    return r;
  }
  template <class Pair>
  void note_speed(const Pair& pair) {
    const Row r = row(pair);
    law.before = pair.row_velocity(r.n, r.lever_a, r.lever_b);
  }
  template <class Pair>
  void warm_start(Pair& pair) const {
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

/// The coordinate is the turn of frame B in frame A about z, or the angle between the z axes (cone, 3D).
/// What angle an AngularAxis is about. The Cardan angles are those of R = Rx(α) Ry(β) Rz(γ) from frame A to frame B.
enum class AngleKind : std::uint8_t { twist, cone, cardan_x, cardan_y, cardan_z };

template <class D>
struct AngularAxis {
  using Angular = typename D::Angular;
  typename D::Rotation frame_a{}, frame_b{};
  AngleKind kind = AngleKind::twist;
  AxisLaw law{};

  /// Of space. A row n such that the angle's rate is n·(ω_b − ω_a): with the axes e of the three angles, the one of
  /// their dual basis.
  static Vec3f cardan_row(AngleKind kind, const Quatf& a, const Quatf& b, float& coordinate) {
    const Vec3f x = rotate(a, Vec3f{1, 0, 0}), z = rotate(b, Vec3f{0, 0, 1}), u = cross(z, x);
    const float cosine = max(math::length(u), 0.02f);
    const Vec3f y = u * (1 / cosine);
    if (kind == AngleKind::cardan_y) {
      coordinate = math::atan2(dot(x, z), cosine);
      return y;
    }
    if (kind == AngleKind::cardan_x) {
      coordinate = math::atan2(-dot(rotate(a, Vec3f{0, 1, 0}), z), dot(rotate(a, Vec3f{0, 0, 1}), z));
      return cross(y, z) * (1 / cosine);
    }
    coordinate = math::atan2(-dot(x, rotate(b, Vec3f{0, 1, 0})), dot(x, rotate(b, Vec3f{1, 0, 0})));
    return cross(x, y) * (1 / cosine);
  }

  /// For the twist φ of a swing–twist decomposition φ̇ = (ω_b − ω_a)·(z_a + z_b)/(1 + z_a·z_b).
  template <class Pair>
  Angular row(const Pair& pair, bool with_coordinate, float& coordinate) const {
    coordinate = 0;
    if constexpr (D::dimension == 2) {
      if (with_coordinate) coordinate = twist_angle(conjugate(pair.turn_a * frame_a) * (pair.turn_b * frame_b));
      return 1;
    } else {
      const Quatf a = pair.turn_a * frame_a, b = pair.turn_b * frame_b;
      if (kind >= AngleKind::cardan_x) return cardan_row(kind, a, b, coordinate);
      const Vec3f z_a = rotate(a, Vec3f{0, 0, 1}), z_b = rotate(b, Vec3f{0, 0, 1});
      const float cosine = dot(z_a, z_b);
      if (kind == AngleKind::cone) {
        const Vec3f u = cross(z_a, z_b);
        const float sine = math::length(u);
        coordinate = math::atan2(sine, cosine);
        return sine > 1e-6f ? u * (1 / sine) : rotate(a, Vec3f{1, 0, 0});
      }
      if (with_coordinate) coordinate = twist_angle(conjugate(a) * b);
      return 1 + cosine > 0.02f ? (z_a + z_b) * (1 / (1 + cosine)) : Vec3f{};  // all but opposite: no twist
    }
  }
  template <class Pair>
  void note_speed(const Pair& pair) {
    float unused;
    law.before = inner(row(pair, false, unused), pair.spin_b - pair.spin_a);
  }
  template <class Pair>
  void warm_start(Pair& pair) const {
    float unused;
    pair.apply_angular(law.total() * row(pair, false, unused));
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    float coordinate;
    const Angular n = row(pair, law.needs_coordinate(), coordinate);
    const float inverse_mass = inner(n, pair.inverse_inertia_a * n) + inner(n, pair.inverse_inertia_b * n);
    const float change = law.solve(inverse_mass, coordinate, inner(n, pair.spin_b - pair.spin_a), pass);
    pair.apply_angular(change * n);
  }
};

}  // namespace carom::rigid::detail
