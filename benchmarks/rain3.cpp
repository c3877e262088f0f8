// Box3D's rain: ragdolls of fourteen bodies fall on a hundred grids with a torus each, ten columns in turn.
#include <array>

#include "benchmarks/ragdoll_data.h"
#include "benchmarks/scene_pieces.h"

namespace carom::bench {
namespace {
using math::Quatf;
using math::Vec3d;
using math::Vec3f;

Vec3f vector(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
Quatf rotation(const float (&q)[4]) { return math::normalize(Quatf{q[3], q[0], q[1], q[2]}); }

class Rain3 final : public Scene<Dim3> {
  static constexpr int rows = 10, columns = 10, group = 3;
  using Ragdoll = std::array<BodyId, 14>;

  void build(World3& world) override {
    geometry::Triangles flat = geometry::make_grid_mesh(8, 8, {1.875f, 1.875f});
    for (Vec3f& p : flat.positions) p += Vec3f{-7.5f, 0, -7.5f};
    const geometry::Shape3 grid = mesh_of(std::move(flat)),
                           torus = mesh_of(geometry::make_torus_mesh(3.75f, 1, 16, 16));
    for (int i = 0; i < 10; ++i)
      for (int k = 0; k < 10; ++k) {
        const BodyId tile = add_fixed(world, {15 * (i - 4.5), 0, 15 * (k - 4.5)}, grid);
        world.add_shape(tile, torus).value();
      }
  }

  void before_step(World3& world, int step) override {
    if (step % 64 != 0 && step % 64 != 16) return;
    std::vector<Ragdoll>& column = columns_[std::size_t(next_)];
    for (const Ragdoll& ragdoll : column)
      for (const BodyId bone : ragdoll) world.destroy_body(bone).value();
    column.clear();
    for (int row = 0; row < rows; ++row)
      for (int k = 0; k < group; ++k)
        column.push_back(make_ragdoll(world, {-75 + 15 * (next_ + 0.5) + 0.75 * k, 20, -75 + 15 * (row + 0.5)}));
    next_ = (next_ + 1) % columns;
  }

  Ragdoll make_ragdoll(World3& world, Vec3d feet) {
    Ragdoll ragdoll;
    const std::int32_t own_group = -++count_;
    for (int i = 0; i < 14; ++i) {
      const RagdollBone& bone = ragdoll_bones[i];
      BodyDef<Dim3> body;
      body.position = feet + Vec3d{bone.position[0], bone.position[1], bone.position[2]};
      body.rotation = rotation(bone.rotation);
      ShapeDef<Dim3> flesh;
      flesh.material.rolling_resistance = 0.2f;
      if (i == ragdoll_spine_01 || i == ragdoll_thigh_l || i == ragdoll_thigh_r) flesh.filter.group = own_group;
      const Vec3f a = vector(bone.capsule_a), b = vector(bone.capsule_b);
      flesh.local.p = 0.5f * (a + b);
      flesh.local.q = math::from_to(Vec3f{0, 1, 0}, math::normalize(b - a));
      ragdoll[std::size_t(i)] =
          add_body<Dim3>(world, body, geometry::Capsule3{0.5f * math::length(b - a), bone.radius}, flesh);
    }
    for (const RagdollJoint& j : ragdoll_joints) {
      const auto connect = [&](auto joint) {
        joint.body_a = ragdoll[std::size_t(j.parent)];
        joint.body_b = ragdoll[std::size_t(j.child)];
        joint.frame_a = {vector(j.position_a), rotation(j.rotation_a)};
        joint.frame_b = {vector(j.position_b), rotation(j.rotation_b)};
        joint.spring = {1.0f, 0.7f};
        world.create_joint(joint).value();
      };
      if (j.hinge) {
        rigid::HingeJointDef<Dim3> hinge;
        hinge.limit = {true, j.lower, j.upper};
        hinge.motor = {true, 0, j.friction_torque};
        connect(hinge);
      } else {
        rigid::BallJointDef<Dim3> ball;
        ball.cone_angle = j.cone;
        ball.twist = {true, j.lower, j.upper};
        ball.friction_torque = j.friction_torque;
        connect(ball);
      }
    }
    return ragdoll;
  }

  std::array<std::vector<Ragdoll>, columns> columns_;
  int next_ = 0;
  std::int32_t count_ = 0;
};

}  // namespace

std::unique_ptr<Scene<Dim3>> make_rain3() { return std::make_unique<Rain3>(); }

}  // namespace carom::bench
