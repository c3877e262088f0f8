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

}  // namespace

template <class D>
bool joint_is_rigid(const AnyJointDef<D>& definition) {
  if (const auto* weld = std::get_if<WeldJointDef<D>>(&definition)) return !(weld->linear.hertz > 0);
  return !std::holds_alternative<MotorJointDef<D>>(definition) && !std::holds_alternative<MouseJointDef<D>>(definition);
}

template <class D>
JointState<D> measure_joint(const WorldImplementation<D>& world, std::int32_t joint) {
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  const JointHeader& header = world.joints.headers[std::size_t(joint)];
  const JointData<D>& data = world.joints.data[std::size_t(joint)];
  const BodyStore<D>& bodies = world.bodies;
  const JointFrames<D>& frames = frames_of(data.definition);
  JointState<D> out;
  out.type = JointType(data.definition.index());
  out.body_a = frames.body_a;
  out.body_b = frames.body_b;
  out.force = data.force;
  out.torque = data.torque;

  typename D::Position anchor_a = data.world_anchor;
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
      const auto& def = std::get<DistanceJointDef<D>>(data.definition);
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
      const auto& def = std::get<BallJointDef<D>>(data.definition);
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
      out.angular_error =
          max(z_angle(), angle_outside(out.coordinate, std::get<HingeJointDef<D>>(data.definition).limit));
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
                             outside(out.coordinate, std::get<SliderJointDef<D>>(data.definition).limit));
      out.angular_error = relative_angle<D>(relative_turn);
      break;
    }
    case JointType::weld:
    case JointType::motor:
      out.linear_error = distance;
      out.angular_error = relative_angle<D>(relative_turn);
      break;
    case JointType::mouse:
      out.linear_error = distance;
      break;
  }
  return out;
}

template bool joint_is_rigid<Dim2>(const AnyJointDef<Dim2>&);
template bool joint_is_rigid<Dim3>(const AnyJointDef<Dim3>&);
template JointState<Dim2> measure_joint(const WorldImplementation<Dim2>&, std::int32_t);
template JointState<Dim3> measure_joint(const WorldImplementation<Dim3>&, std::int32_t);

}  // namespace carom::rigid::detail
