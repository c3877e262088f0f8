// Scenes whose bodies are an engine-neutral list (recipe.h).
#pragma once

#include "benchmarks/recipe.h"
#include "benchmarks/scene_pieces.h"

namespace carom::bench {

template <class D>
typename D::Position position_of(const BodyRecipe& b) {
  if constexpr (D::dimension == 2)
    return {b.position[0], b.position[1]};
  else
    return {b.position[0], b.position[1], b.position[2]};
}

template <class D>
typename D::Shape shape_of(Kind kind, const float (&size)[3]) {
  if constexpr (D::dimension == 2) {
    if (kind == Kind::sphere) return geometry::Circle{size[0]};
    if (kind == Kind::capsule) return geometry::Capsule2{size[0], size[1]};
    return geometry::make_box2({size[0], size[1]});
  } else {
    if (kind == Kind::sphere) return geometry::Sphere{size[0]};
    if (kind == Kind::capsule) return geometry::Capsule3{size[0], size[1]};
    if (kind == Kind::cylinder) return geometry::Cylinder{size[0], size[1]};
    return geometry::Box{{size[0], size[1], size[2]}};
  }
}

template <class D>
class ListScene final : public Scene<D> {
 public:
  explicit ListScene(Recipe recipe) : recipe_(std::move(recipe)) {}
  void define(rigid::WorldDef<D>& definition) override {
    definition.gravity.y = -recipe_.gravity;
    definition.allow_sleep = recipe_.sleep;
  }
  void build(rigid::World<D>& world) override {
    std::vector<BodyId> bodies;
    for (const BodyRecipe& b : recipe_.bodies) {
      BodyDef<D> body;
      body.type = b.fixed ? BodyType::fixed : BodyType::dynamic;
      body.position = position_of<D>(b);
      body.linear_damping = body.angular_damping = recipe_.damping;
      if constexpr (D::dimension == 3) body.rotation = {b.rotation[0], b.rotation[1], b.rotation[2], b.rotation[3]};
      ShapeDef<D> surface;
      surface.density = recipe_.density;
      surface.material.friction = b.fixed ? recipe_.ground_friction : recipe_.friction;
      if (!b.collides) surface.filter = {2, ~std::uint64_t{2}, 0};
      bodies.push_back(add_body(world, body, shape_of<D>(b.kind, b.size), surface));
    }
    for (const JointRecipe& j : recipe_.joints) {
      const auto connect = [&](auto joint) {
        joint.body_a = bodies[std::size_t(j.body_a)];
        joint.body_b = bodies[std::size_t(j.body_b)];
        for (int k = 0; k < D::dimension; ++k) joint.frame_a.p[k] = j.anchor_a[k], joint.frame_b.p[k] = j.anchor_b[k];
        world.create_joint(joint).value();
      };
      if constexpr (D::dimension == 2)
        connect(rigid::HingeJointDef<D>{});
      else
        connect(rigid::BallJointDef<D>{});
    }
  }

 private:
  Recipe recipe_;
};

template <class D>
std::unique_ptr<Scene<D>> list_scene(Recipe recipe) {
  return std::make_unique<ListScene<D>>(std::move(recipe));
}

}  // namespace carom::bench
