// The recipes in Carom, through its public interface only.
#include <chrono>
#include <cmath>

#include "benchmarks/recipe.h"
#include "carom/carom.h"

namespace carom::bench {
namespace {

template <class D>
typename D::Position position_of(const BodyRecipe& b) {
  if constexpr (D::dimension == 2)
    return {b.position[0], b.position[1]};
  else
    return {b.position[0], b.position[1], b.position[2]};
}

template <class D>
typename D::Shape shape_of(const BodyRecipe& b) {
  if constexpr (D::dimension == 2) {
    if (b.kind == Kind::sphere) return geometry::Circle{b.size[0]};
    if (b.kind == Kind::capsule) return geometry::Capsule2{b.size[0], b.size[1]};
    return geometry::make_box2({b.size[0], b.size[1]});
  } else {
    if (b.kind == Kind::sphere) return geometry::Sphere{b.size[0]};
    if (b.kind == Kind::capsule) return geometry::Capsule3{b.size[0], b.size[1]};
    return geometry::Box{{b.size[0], b.size[1], b.size[2]}};
  }
}

template <class D>
Outcome run(const Recipe& recipe, const Settings& settings) {
  rigid::WorldDef<D> definition;
  definition.gravity.y = -recipe.gravity;
  definition.substeps = settings.substeps;
  definition.threads = settings.threads;
  definition.simd_width = settings.simd_width;
  definition.allow_sleep = recipe.sleep;
  rigid::World<D> world(definition);

  std::vector<rigid::BodyId> bodies;
  for (const BodyRecipe& b : recipe.bodies) {
    rigid::BodyDef<D> body;
    body.type = b.fixed ? rigid::BodyType::fixed : rigid::BodyType::dynamic;
    body.position = position_of<D>(b);
    if constexpr (D::dimension == 3) body.rotation = {b.rotation[0], b.rotation[1], b.rotation[2], b.rotation[3]};
    bodies.push_back(world.create_body(body).value());
    rigid::ShapeDef<D> shape;
    shape.density = recipe.density;
    shape.material.friction = b.fixed ? recipe.ground_friction : recipe.friction;
    if (!b.collides) shape.filter.mask = 0;
    world.add_shape(bodies.back(), shape_of<D>(b), shape).value();
  }
  for (const JointRecipe& j : recipe.joints) {
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

  Outcome outcome;
  const int steps = settings.steps > 0 ? settings.steps : recipe.steps;
  for (int i = 0; i < steps; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    world.step(1.0f / 60.0f).value();
    outcome.step_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  double sum = 0;
  int moving = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (recipe.bodies[i].fixed) continue;
    const auto state = world.state(bodies[i]).value();
    const double speed = math::length(state.linear_velocity);
    ++moving;
    sum += speed * speed;
    outcome.worst_speed = math::max(outcome.worst_speed, speed);
    outcome.worst_drift =
        math::max(outcome.worst_drift, math::distance(state.pose.position, position_of<D>(recipe.bodies[i])));
    if (math::length(state.pose.position) > 200) ++outcome.escaped;
  }
  outcome.rms_speed = std::sqrt(sum / math::max(1, moving));
  outcome.worst_penetration = world.worst_penetration();
  outcome.worst_joint_gap = world.worst_joint_error();
  outcome.bytes = world.counters().bytes;
  outcome.hash = world.state_hash();
  return outcome;
}

}  // namespace

Outcome run_carom(const Recipe& recipe, const Settings& settings) {
  return recipe.dimension == 2 ? run<rigid::Dim2>(recipe, settings) : run<rigid::Dim3>(recipe, settings);
}

}  // namespace carom::bench
