// How a joint stands: coordinate, speed and errors from the poses as they are.
#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {
namespace {

float outside(float x, const JointLimit& limit) {
  if (!limit.enabled) return 0;
  return max(max(limit.lower - x, x - limit.upper), 0.0f);
}
/// The same for an angle: by the nearest turn.
float angle_outside(float x, const JointLimit& limit) {
  if (!limit.enabled) return 0;
  const float middle = 0.5f * (limit.lower + limit.upper);
  return outside(middle + wrap_angle(x - middle), limit);
}

template <class D>
float relative_angle(const typename D::Rotation& q) {
  if constexpr (D::dimension == 2)
    return math::abs(twist_angle(q));
  else
    return math::length(rotation_vector_of(q));
}

/// The first free coordinate; how far the others are from where they are held or may be.
template <class D>
void measure_generic(const GenericJointDef<D>& def, const typename D::Rotation& frame_a,
                     const typename D::Rotation& frame_b, typename D::Vector d, typename D::Vector v,
                     typename D::Angular spin, JointState<D>& out) {
  bool found = false;
  const auto note = [&](const JointAxis& axis, float x, float speed, float& error) {
    if (!axis.free) {
      error = max(error, math::abs(x));
      return;
    }
    if (!found) {
      out.coordinate = x;
      out.speed = speed;
      found = true;
    }
    error = max(error, outside(x, axis.limit));
  };
  BodyPair<D> pair;
  for (int i = 0; i < D::dimension; ++i) {
    typename D::Vector n{};
    n[i] = 1;
    n = rotate(frame_a, n);
    note(def.linear[i], dot(n, d), dot(n, v), out.linear_error);
  }
  for (int i = 0; i < (D::dimension == 2 ? 1 : 3); ++i) {
    AngularAxis<D> axis;
    axis.frame_a = frame_a;
    axis.frame_b = frame_b;
    if constexpr (D::dimension == 3) axis.kind = AngleKind(int(AngleKind::cardan_x) + i);
    float angle;
    const auto n = axis.row(pair, true, angle);
    const JointLimit& limit = def.angular[i].limit;
    const float middle = 0.5f * (limit.lower + limit.upper);
    if (limit.enabled) angle = middle + wrap_angle(angle - middle);
    note(def.angular[i], angle, inner(n, spin), out.angular_error);
  }
}

}  // namespace

template <class D>
bool joint_is_rigid(const JointData<D>& data) {
  if (const auto* weld = data.template get<WeldJointDef>()) return !(weld->linear.hertz > 0);
  return data.type != JointType::motor && data.type != JointType::mouse;
}

template <class D>
JointState<D> measure_joint(const WorldImplementation<D>& world, std::int32_t joint) {
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  const JointHeader& header = world.joints.headers[std::size_t(joint)];
  const JointData<D>& data = world.joints.at(joint);
  const BodyStore<D>& bodies = world.bodies;
  const JointFrames<D>& frames = data.frames();
  JointState<D> out;
  out.type = data.type;
  out.body_a = frames.body_a;
  out.body_b = frames.body_b;
  out.force = data.force;
  out.torque = data.torque;
  out.direct = world.joints.tree_of(joint) != none;

  typename D::Position anchor_a = data.world_anchor();
  typename D::Rotation frame_a = frames.frame_a.q;
  Vector velocity_a{}, arm_a{};
  Angular spin_a{};
  if (header.body[0] != none) {
    const std::size_t a = std::size_t(header.body[0]);
    anchor_a = world_point(bodies.pose[a], frames.frame_a.p);
    frame_a = bodies.pose[a].rotation * frame_a;
    arm_a = rotate(bodies.pose[a].rotation, frames.frame_a.p - bodies.motion[a].local_center);
    velocity_a = bodies.solver[a].linear_velocity;
    spin_a = bodies.solver[a].angular_velocity;
  }
  const std::size_t b = std::size_t(header.body[1]);
  const typename D::Rotation frame_b = bodies.pose[b].rotation * frames.frame_b.q;
  const Vector arm_b = rotate(bodies.pose[b].rotation, frames.frame_b.p - bodies.motion[b].local_center);
  const Vector d = Vector(world_point(bodies.pose[b], frames.frame_b.p) - anchor_a);
  const Angular spin = bodies.solver[b].angular_velocity - spin_a;
  const Vector v = bodies.solver[b].linear_velocity + cross(bodies.solver[b].angular_velocity, arm_b) - velocity_a -
                   cross(spin_a, arm_a);
  const typename D::Rotation relative_turn = conjugate(frame_a) * frame_b;
  const float distance = math::length(d);

  const auto along_z = [&]() -> Angular {
    if constexpr (D::dimension == 2)
      return 1;
    else
      return rotate(frame_a, Vec3f{0, 0, 1});
  };
  const auto z_angle = [&]() -> float {
    if constexpr (D::dimension == 2) {
      return 0;
    } else {
      const Vec3f z_a = rotate(frame_a, Vec3f{0, 0, 1}), z_b = rotate(frame_b, Vec3f{0, 0, 1});
      return math::atan2(math::length(cross(z_a, z_b)), dot(z_a, z_b));
    }
  };
  switch (out.type) {
    case JointType::distance: {
      const auto& def = (*data.template get<DistanceJointDef>());
      out.coordinate = distance;
      out.speed = distance > 0 ? dot(d, v) / distance : 0;
      if (def.rope) {
        const bool elastic = def.spring.hertz > 0;
        const float longest = def.limit.enabled ? def.limit.upper : def.length;
        out.linear_error = elastic && !def.limit.enabled ? 0 : max(distance - longest, 0.0f);
      } else if (def.limit.enabled) {
        out.linear_error = outside(distance, def.limit);
      } else if (!(def.spring.hertz > 0) && !def.motor.enabled) {
        out.linear_error = math::abs(distance - def.length);
      }
      break;
    }
    case JointType::ball: {
      const auto& def = (*data.template get<BallJointDef>());
      out.linear_error = distance;
      const float twist = twist_angle(relative_turn);
      out.angular_error = angle_outside(twist, def.twist);
      if constexpr (D::dimension == 2) {
        out.coordinate = twist;
        out.speed = spin;
      } else {
        out.coordinate = z_angle();
        const Vec3f u = cross(rotate(frame_a, Vec3f{0, 0, 1}), rotate(frame_b, Vec3f{0, 0, 1}));
        const float sine = math::length(u);
        out.speed = sine > 1e-6f ? dot(u, spin) / sine : 0;
        if (def.cone_angle >= 0) out.angular_error = max(out.angular_error, out.coordinate - def.cone_angle);
      }
      break;
    }
    case JointType::hinge:
      out.coordinate = twist_angle(relative_turn);
      out.speed = inner(along_z(), spin);
      out.linear_error = distance;
      out.angular_error = max(z_angle(), angle_outside(out.coordinate, (*data.template get<HingeJointDef>()).limit));
      break;
    case JointType::slider: {
      Vector x{};
      if constexpr (D::dimension == 2)
        x = rotate(frame_a, Vec2f{1, 0});
      else
        x = rotate(frame_a, Vec3f{1, 0, 0});
      out.coordinate = dot(x, d);
      out.speed = dot(x, v) - dot(x, cross(spin_a, d));  // as A sees it
      out.linear_error = max(math::length(d - out.coordinate * x),
                             outside(out.coordinate, (*data.template get<SliderJointDef>()).limit));
      out.angular_error = relative_angle<D>(relative_turn);
      break;
    }
    case JointType::motor: {
      const auto& def = *data.template get<MotorJointDef>();
      if (def.hold_position) out.linear_error = math::length(d - rotate(frame_a, def.target_position));
      if (def.hold_rotation) out.angular_error = relative_angle<D>(conjugate(def.target_rotation) * relative_turn);
      break;
    }
    case JointType::weld:
      out.linear_error = distance;
      out.angular_error = relative_angle<D>(relative_turn);
      break;
    case JointType::mouse:
      out.linear_error = distance;
      break;
    case JointType::generic:
      measure_generic(*data.template get<GenericJointDef>(), frame_a, frame_b, d, v - cross(spin_a, d), spin, out);
      break;
    case JointType::gear:
      out.angular_error = math::abs(data.memory.drift);
      break;
    case JointType::rack:
    case JointType::screw:
      out.linear_error = math::abs(data.memory.drift);
      break;
    case JointType::path: {
      const auto& def = *data.template get<PathJointDef>();
      const PathCurve<D> curve = curve_of(world.joints, data);
      const Vector local = inverse_rotate(frame_a, d);
      const PathPlace place =
          data.more().fresh_path() ? curve.nearest(local) : curve.foot(local, data.more().path_place);
      const auto g = curve.at(place);
      const Vector t = rotate(frame_a, g.d1 * (1 / math::length(g.d1)));
      out.coordinate = curve.arc(place);
      out.speed = dot(t, v - cross(spin_a, d));
      out.linear_error = math::distance(local, g.p);
      if (def.limit.enabled) out.linear_error = max(out.linear_error, outside(out.coordinate, def.limit));
      if (def.follow) {
        Vector x{};
        x[0] = 1;
        x = rotate(frame_b, x);
        out.angular_error = math::atan2(magnitude(cross(t, x)), dot(t, x));
      }
      break;
    }
    case JointType::pulley: {
      const auto& def = *data.template get<PulleyJointDef>();
      const Vector to_a = Vector(anchor_a - def.ground_a),
                   to_b = Vector(world_point(bodies.pose[b], frames.frame_b.p) - def.ground_b);
      out.coordinate = math::length(to_a) + def.ratio * math::length(to_b);
      out.linear_error = max(out.coordinate - def.length, 0.0f);
      break;
    }
  }
  return out;
}

template bool joint_is_rigid(const JointData<Dim2>&);
template bool joint_is_rigid(const JointData<Dim3>&);
template JointState<Dim2> measure_joint(const WorldImplementation<Dim2>&, std::int32_t);
template JointState<Dim3> measure_joint(const WorldImplementation<Dim3>&, std::int32_t);

}  // namespace carom::rigid::detail
