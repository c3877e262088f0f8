#include "apps/host/demos/figures/figure.h"

#include "carom/math/rotation.h"

namespace carom::host::demo {

using rigid::BodyId;
using rigid::Dim3;
using rigid::JointId;

namespace {

constexpr double ankle_height = 0.08, knee_height = 0.5, hip_height = 0.92, waist_height = 1.1, neck_height = 1.5,
                 shoulder_height = 1.42, elbow_height = 1.12;
constexpr float joint_friction = 0.2f;  // N·m: a muscle of 5 Hz gives way to it by 2° at a foot
constexpr std::uint32_t skin = 0xd9a07a;
/// z of the joint frame: down along the limb.
const Quatf downward = from_axis_angle(Vec3f{1, 0, 0}, 0.5f * pi_f);

}  // namespace

Figure Figure::create(Stage3& stage, Vec3d place, std::uint32_t shirt, std::uint32_t trousers, BodyId holder) {
  Figure f;
  const auto part = [&](int which, const char* name, Vec3d at, const geometry::Shape3& shape, std::uint32_t color) {
    rigid::BodyDef<Dim3> body;
    body.name = name;
    body.position = place + at;
    rigid::ShapeDef<Dim3> d;
    d.density = 950;
    d.material.friction = which >= foot ? 0.9f : 0.5f;
    f.body[which] = stage.add(body, shape, d, color);
  };
  part(pelvis, "pelvis", {0, 1.0, 0}, geometry::Box{{0.06f, 0.05f, 0.1f}, 0.05f}, trousers);
  part(chest, "chest", {0, 1.3, 0}, geometry::Box{{0.05f, 0.14f, 0.11f}, 0.06f}, shirt);
  part(head, "head", {0.02, 1.64, 0}, geometry::Ellipsoid{{0.11f, 0.13f, 0.09f}}, skin);
  for (int k = 0; k < 2; ++k) {
    const double side = k == 0 ? -1 : 1;
    part(upper_arm + k, "upper arm", {0, 0.5 * (shoulder_height + elbow_height), 0.23 * side},
         geometry::Capsule3{0.12f, 0.05f}, shirt);
    part(forearm + k, "forearm", {0, elbow_height - 0.15, 0.23 * side}, geometry::Capsule3{0.13f, 0.04f}, skin);
    part(thigh + k, "thigh", {0, 0.5 * (hip_height + knee_height), 0.1 * side}, geometry::Capsule3{0.15f, 0.075f},
         trousers);
    part(shin + k, "shin", {0, 0.5 * (knee_height + ankle_height), 0.1 * side}, geometry::Capsule3{0.15f, 0.055f},
         trousers);
    part(foot + k, "foot", {0.05, 0.04, 0.1 * side}, geometry::Box{{0.11f, 0.02f, 0.03f}, 0.02f}, dark);
  }
  const auto frames = [&](auto& d, int a, int b, Vec3d at, Quatf frame) {
    d.body_a = f.body[a], d.body_b = f.body[b];
    d.frame_a = {Vec3f(place + at - stage.at(d.body_a).pose.position), frame};
    d.frame_b = {Vec3f(place + at - stage.at(d.body_b).pose.position), frame};
  };
  const auto ball = [&](int a, int b, Vec3d at, float cone, float twist) {
    rigid::BallJointDef<Dim3> d;
    frames(d, a, b, at, downward);
    d.cone_angle = cone;
    d.twist = {true, -twist, twist};
    d.friction_torque = joint_friction;
    return stage.keep(stage.world().create_joint(d));
  };
  const auto hinge = [&](int a, int b, Vec3d at, float lower, float upper) {
    rigid::HingeJointDef<Dim3> d;
    frames(d, a, b, at, {});
    d.limit = {true, lower, upper};
    d.motor = {true, 0, joint_friction};
    return stage.keep(stage.world().create_joint(d));
  };
  f.waist = ball(pelvis, chest, {0, waist_height, 0}, 0.8f, 0.6f);
  f.neck = ball(chest, head, {0, neck_height, 0}, 0.7f, 1);
  for (int k = 0; k < 2; ++k) {
    const double side = k == 0 ? -1 : 1;
    f.shoulder[k] = ball(chest, upper_arm + k, {0, shoulder_height, 0.23 * side}, 2.9f, 1.5f);
    f.elbow[k] = hinge(upper_arm + k, forearm + k, {0, elbow_height, 0.23 * side}, -0.05f, 2.5f);
    f.hip[k] = ball(pelvis, thigh + k, {0, hip_height, 0.1 * side}, 1.6f, 0.6f);
    f.knee[k] = hinge(thigh + k, shin + k, {0, knee_height, 0.1 * side}, -2.5f, 0.02f);
    f.ankle[k] = ball(shin + k, foot + k, {0, ankle_height, 0.1 * side}, 0.9f, 0.4f);
  }
  rigid::WeldJointDef<Dim3> hold;
  hold.body_a = holder, hold.body_b = f.body[pelvis];
  hold.frame_a.p = Vec3f(stage.at(hold.body_b).pose.position - stage.at(holder).pose.position);
  (void)stage.keep(stage.world().create_joint(hold));
  core::Result<rigid::Articulation3> made = rigid::Articulation3::create(stage.world(), f.body[pelvis]);
  if (made.ok())
    f.mechanism = std::move(made).value();
  else
    stage.fail(made.error());
  return f;
}

/// The target of a ball joint whose frames stand downward.
static Quatd turn_of(Vec3d turn) { return from_rotation_vector(inverse_rotate(Quatd(downward), turn)); }

void Figure::set_pose(Stage3& stage, const Pose& pose) {
  const auto ball = [&](JointId joint, Vec3d turn) {
    stage.check(mechanism.set_target(mechanism.find(joint), Quatf(turn_of(turn))));
  };
  const auto hinge = [&](JointId joint, double angle) {
    stage.check(mechanism.set_target(mechanism.find(joint), angle));
  };
  ball(waist, pose.waist), ball(neck, pose.neck);
  for (int k = 0; k < 2; ++k) {
    ball(shoulder[k], pose.shoulder[k]), ball(hip[k], pose.hip[k]), ball(ankle[k], pose.ankle[k]);
    hinge(elbow[k], pose.elbow[k]), hinge(knee[k], -pose.knee[k]);
  }
}

double Figure::farthest_from(const Pose& pose) const {
  double most = 0;
  const auto at = [&](JointId joint) {
    const int j = mechanism.find(joint);
    return j < 0 ? nullptr : mechanism.coordinates().data() + mechanism.joints()[std::size_t(j)].first;
  };
  const auto ball = [&](JointId joint, Vec3d turn) {
    if (const double* q = at(joint))
      most =
          max(most, length(rotation_vector(from_rotation_vector(Vec3d{q[0], q[1], q[2]}) * conjugate(turn_of(turn)))));
  };
  const auto hinge = [&](JointId joint, double angle) {
    if (const double* q = at(joint)) most = max(most, abs(q[0] - angle));
  };
  ball(waist, pose.waist), ball(neck, pose.neck);
  for (int k = 0; k < 2; ++k) {
    ball(shoulder[k], pose.shoulder[k]), ball(hip[k], pose.hip[k]), ball(ankle[k], pose.ankle[k]);
    hinge(elbow[k], pose.elbow[k]), hinge(knee[k], -pose.knee[k]);
  }
  return most;
}

}  // namespace carom::host::demo
