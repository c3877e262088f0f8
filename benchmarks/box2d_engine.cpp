// The recipes of the plane in Box2D 2.4 (Debian's package), with its usual 8 velocity and 3 position iterations.
#include <box2d/box2d.h>

#include <chrono>
#include <cmath>

#include "benchmarks/recipe.h"

namespace carom::bench {

RecipeOutcome run_box2d(const Recipe& recipe, const RecipeSettings& settings) {
  b2World world({0, -recipe.gravity});
  world.SetAllowSleeping(recipe.sleep);
  std::vector<b2Body*> bodies;
  for (const BodyRecipe& b : recipe.bodies) {
    b2BodyDef definition;
    definition.type = b.fixed ? b2_staticBody : b2_dynamicBody;
    definition.position.Set(float(b.position[0]), float(b.position[1]));
    bodies.push_back(world.CreateBody(&definition));
    b2FixtureDef fixture;
    b2PolygonShape polygon;
    b2CircleShape circle;
    circle.m_radius = b.size[0];
    polygon.SetAsBox(b.size[0], b.size[1]);
    fixture.shape = b.kind == Kind::box ? static_cast<b2Shape*>(&polygon) : &circle;
    fixture.density = recipe.density;
    fixture.friction = b.fixed ? recipe.ground_friction : recipe.friction;
    if (!b.collides) fixture.filter.maskBits = 0;
    bodies.back()->CreateFixture(&fixture);
  }
  for (const JointRecipe& j : recipe.joints) {
    b2RevoluteJointDef definition;
    definition.bodyA = bodies[std::size_t(j.body_a)];
    definition.bodyB = bodies[std::size_t(j.body_b)];
    definition.localAnchorA.Set(j.anchor_a[0], j.anchor_a[1]);
    definition.localAnchorB.Set(j.anchor_b[0], j.anchor_b[1]);
    world.CreateJoint(&definition);
  }

  RecipeOutcome outcome;
  const int steps = settings.steps > 0 ? settings.steps : recipe.steps;
  for (int i = 0; i < steps; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    world.Step(1.0f / 60.0f, 8, 3);
    outcome.step_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  double sum = 0;
  int moving = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (recipe.bodies[i].fixed) continue;
    const b2Vec2 p = bodies[i]->GetPosition();
    const double speed = bodies[i]->GetLinearVelocity().Length();
    ++moving;
    sum += speed * speed;
    outcome.worst_speed = std::fmax(outcome.worst_speed, speed);
    outcome.worst_drift = std::fmax(outcome.worst_drift,
                                    std::hypot(p.x - recipe.bodies[i].position[0], p.y - recipe.bodies[i].position[1]));
    if (p.Length() > 200) ++outcome.escaped;
  }
  outcome.rms_speed = std::sqrt(sum / std::fmax(1, moving));
  for (b2Contact* contact = world.GetContactList(); contact; contact = contact->GetNext()) {
    if (!contact->IsTouching()) continue;
    b2WorldManifold manifold;
    contact->GetWorldManifold(&manifold);
    for (int k = 0; k < contact->GetManifold()->pointCount; ++k)
      outcome.worst_penetration = std::fmax(outcome.worst_penetration, -manifold.separations[k]);
  }
  for (b2Joint* joint = world.GetJointList(); joint; joint = joint->GetNext())
    outcome.worst_joint_gap = std::fmax(outcome.worst_joint_gap, (joint->GetAnchorA() - joint->GetAnchorB()).Length());
  return outcome;
}

}  // namespace carom::bench
