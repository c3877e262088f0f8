// The recipes in Bullet (Debian's package), with its defaults: 10 solver iterations, sequential impulses.
#include <btBulletDynamicsCommon.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "benchmarks/recipe.h"

namespace carom::bench {

RecipeOutcome run_bullet(const Recipe& recipe, const RecipeSettings& settings) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity({0, -recipe.gravity, 0});

  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  for (const BodyRecipe& b : recipe.bodies) {
    double volume = 1;
    switch (b.kind) {
      case Kind::box:
        shapes.push_back(std::make_unique<btBoxShape>(btVector3(b.size[0], b.size[1], b.size[2])));
        volume = 8.0 * b.size[0] * b.size[1] * b.size[2];
        break;
      case Kind::sphere:
        shapes.push_back(std::make_unique<btSphereShape>(b.size[0]));
        volume = 4.18879 * std::pow(b.size[0], 3);
        break;
      case Kind::capsule:
        shapes.push_back(std::make_unique<btCapsuleShape>(b.size[1], 2 * b.size[0]));
        volume = 6.283185 * b.size[0] * b.size[1] * b.size[1] + 4.18879 * std::pow(b.size[1], 3);
    }
    const btScalar mass = b.fixed ? 0 : btScalar(volume * recipe.density);
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes.back()->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shapes.back().get(), inertia);
    info.m_startWorldTransform.setOrigin({btScalar(b.position[0]), btScalar(b.position[1]), btScalar(b.position[2])});
    info.m_startWorldTransform.setRotation({b.rotation[1], b.rotation[2], b.rotation[3], b.rotation[0]});
    // Bullet multiplies the two coefficients: square roots give the same pair friction as √(ab).
    info.m_friction = btScalar(std::sqrt(b.fixed ? recipe.ground_friction : recipe.friction));
    bodies.push_back(std::make_unique<btRigidBody>(info));
    if (!recipe.sleep) bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get(), b.fixed ? 2 : 1, b.collides ? -1 : 0);
  }
  for (const JointRecipe& j : recipe.joints) {
    joints.push_back(std::make_unique<btPoint2PointConstraint>(*bodies[std::size_t(j.body_a)],
                                                               *bodies[std::size_t(j.body_b)],
                                                               btVector3(j.anchor_a[0], j.anchor_a[1], j.anchor_a[2]),
                                                               btVector3(j.anchor_b[0], j.anchor_b[1], j.anchor_b[2])));
    world.addConstraint(joints.back().get(), true);
  }

  RecipeOutcome outcome;
  const int steps = settings.steps > 0 ? settings.steps : recipe.steps;
  for (int i = 0; i < steps; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    world.stepSimulation(btScalar(1.0 / 60.0), 0);
    outcome.step_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  double sum = 0;
  int moving = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (recipe.bodies[i].fixed) continue;
    const btVector3 p = bodies[i]->getCenterOfMassPosition();
    const double speed = bodies[i]->getLinearVelocity().length();
    const double* start = recipe.bodies[i].position;
    ++moving;
    sum += speed * speed;
    outcome.worst_speed = std::fmax(outcome.worst_speed, speed);
    outcome.worst_drift =
        std::fmax(outcome.worst_drift, std::hypot(p.x() - start[0], p.y() - start[1], p.z() - start[2]));
    if (p.length() > 200) ++outcome.escaped;
  }
  outcome.rms_speed = std::sqrt(sum / std::fmax(1, moving));
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold->getNumContacts(); ++k)
      outcome.worst_penetration = std::fmax(outcome.worst_penetration, -manifold->getContactPoint(k).getDistance());
  }
  for (const JointRecipe& j : recipe.joints) {
    const btTransform& a = bodies[std::size_t(j.body_a)]->getCenterOfMassTransform();
    const btTransform& b = bodies[std::size_t(j.body_b)]->getCenterOfMassTransform();
    const btVector3 gap = a * btVector3(j.anchor_a[0], j.anchor_a[1], j.anchor_a[2]) -
                          b * btVector3(j.anchor_b[0], j.anchor_b[1], j.anchor_b[2]);
    outcome.worst_joint_gap = std::fmax(outcome.worst_joint_gap, gap.length());
  }
  for (auto& joint : joints) world.removeConstraint(joint.get());
  for (auto& body : bodies) world.removeRigidBody(body.get());
  return outcome;
}

}  // namespace carom::bench
