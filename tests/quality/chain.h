// A chain of capsules of 1 kg (radius .1 m, half length .4 m) on ball joints at x = 0, 1, …, n from a fixed point, with
// a ball of radius 1 m beyond the last where its mass is not zero; released level or hanging (rigid-body.md 6.2 c).
#pragma once

#include <algorithm>

#include "tests/rigid/scene_pieces.h"

namespace carom::quality {

template <class D>
struct Chain {
  rigid::World<D> world;
  std::vector<rigid::JointId> joints;
  double worst_gap = 0;  ///< m, at any joint after any step

  Chain(int links, float ball_mass, bool hanging = false) : world(rigid::test::world_with<D>()) {
    using namespace rigid;
    const auto place = [&](double s) { return hanging ? rigid::test::at<D>(0, -s) : rigid::test::at<D>(s, 0); };
    const auto arm = [&](float s) { return rigid::test::along<D>(0, s); };
    BodyId before{};
    const auto join = [&](BodyId body, float half_before, float half) {
      BallJointDef<D> joint;
      joint.body_a = before;
      joint.body_b = body;
      if (!before.is_null()) joint.frame_a.p = arm(half_before);
      joint.frame_b.p = arm(-half);
      joints.push_back(world.create_joint(joint).value());
      before = body;
    };
    for (int i = 0; i <= links; ++i) {
      const bool ball = i == links;
      if (ball && !(ball_mass > 0)) break;
      BodyDef<D> def;
      def.position = place(ball ? i + 1.0 : i + 0.5);
      def.rotation = rigid::test::turned<D>(hanging ? math::pi : -math::pi / 2);  // local y points along the chain
      const BodyId body = world.create_body(def).value();
      ShapeDef<D> shape;
      shape.filter.group = -1;
      if constexpr (D::dimension == 2)
        world
            .add_shape(body,
                       ball ? geometry::Shape2(geometry::Circle{1}) : geometry::Shape2(geometry::Capsule2{0.4f, 0.1f}),
                       shape)
            .value();
      else
        world
            .add_shape(body,
                       ball ? geometry::Shape3(geometry::Sphere{1}) : geometry::Shape3(geometry::Capsule3{0.4f, 0.1f}),
                       shape)
            .value();
      set_mass(body, ball ? double(ball_mass) : 1.0);
      join(body, 0.5f, ball ? 1.0f : 0.5f);
    }
  }
  /// Gives the body that mass, its inertia in proportion.
  void set_mass(rigid::BodyId body, double mass) {
    if constexpr (D::dimension == 2) {
      auto properties = world.mass_properties2(body).value();
      properties.inertia *= mass / properties.mass;
      properties.mass = mass;
      world.set_mass_properties(body, properties).value();
    } else {
      auto properties = world.mass_properties3(body).value();
      properties.inertia = properties.inertia * (mass / properties.mass);
      properties.mass = mass;
      world.set_mass_properties(body, properties).value();
    }
  }
  void run(int seconds) {
    for (int i = 0; i < 60 * seconds; ++i) {
      world.step(rigid::test::frame).value();
      for (const rigid::JointId joint : joints)
        worst_gap = std::max(worst_gap, double(world.joint_state(joint).value().linear_error));
    }
  }
};

}  // namespace carom::quality
