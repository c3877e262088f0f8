// The same small scene in Carom and in Bullet (Debian's package, its defaults).
#pragma once

#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>
#include <vector>

#include "carom/rigid/world.h"

namespace carom::differential {

enum class Kind { box, sphere };
struct Body {
  Kind kind = Kind::box;
  math::Vec3f size{0.5f, 0.5f, 0.5f};  ///< half extents, or the radius three times
  math::Vec3d position{};
  math::Quatf rotation{};
  math::Vec3f velocity{}, spin{};
  float density = 1000, friction = 0.5f, restitution = 0;
  bool fixed = false;
};
struct Pin {
  int body = 0;
  math::Vec3f anchor{};  ///< in the body
};
struct Scene {
  math::Vec3f gravity{0, -9.81f, 0};
  std::vector<Body> bodies;
  std::vector<Pin> pins;  ///< to the world
};
struct Outcome {
  std::vector<math::Vec3d> position, velocity;
  std::vector<double> mass;
  math::Vec3d momentum() const {
    math::Vec3d p{};
    for (std::size_t i = 0; i < mass.size(); ++i) p += velocity[i] * mass[i];
    return p;
  }
  double energy() const {
    double e = 0;
    for (std::size_t i = 0; i < mass.size(); ++i) e += 0.5 * mass[i] * dot(velocity[i], velocity[i]);
    return e;
  }
};

inline double volume(const Body& b) {
  const double x = double(b.size.x);
  return b.kind == Kind::sphere ? 4.0 / 3 * math::pi * x * x * x : 8 * x * double(b.size.y) * double(b.size.z);
}

inline Outcome run_carom(const Scene& scene, int steps) {
  using namespace rigid;
  WorldDef<Dim3> definition;
  definition.gravity = scene.gravity;
  definition.allow_sleep = false;
  World3 world(definition);
  std::vector<BodyId> ids;
  for (const Body& b : scene.bodies) {
    BodyDef<Dim3> d;
    d.type = b.fixed ? BodyType::fixed : BodyType::dynamic;
    d.position = b.position;
    d.rotation = b.rotation;
    d.linear_velocity = b.velocity;
    d.angular_velocity = b.spin;
    ids.push_back(world.create_body(d).value());
    ShapeDef<Dim3> s;
    s.density = b.density;
    s.material.friction = b.friction;
    s.material.restitution = b.restitution;
    const geometry::Shape3 shape =
        b.kind == Kind::sphere ? geometry::Shape3(geometry::Sphere{b.size.x}) : geometry::Shape3(geometry::Box{b.size});
    world.add_shape(ids.back(), shape, s).value();
  }
  for (const Pin& pin : scene.pins) {
    BallJointDef<Dim3> d;
    d.body_b = ids[std::size_t(pin.body)];
    d.frame_b.p = pin.anchor;
    d.frame_a.p = math::Vec3f(world_point(world.state(d.body_b).value().pose, pin.anchor));
    world.create_joint(d).value();
  }
  for (int i = 0; i < steps; ++i) world.step(1.0f / 60).value();
  Outcome out;
  for (const BodyId id : ids) {
    const BodyState<Dim3> s = world.state(id).value();
    out.position.push_back(s.pose.position);
    out.velocity.push_back(math::Vec3d(s.linear_velocity));
    out.mass.push_back(double(s.mass));
  }
  return out;
}

inline Outcome run_bullet(const Scene& scene, int steps) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  const auto vector = [](const math::Vec3f& v) { return btVector3(v.x, v.y, v.z); };
  world.setGravity(vector(scene.gravity));
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> pins;
  for (const Body& b : scene.bodies) {
    if (b.kind == Kind::sphere)
      shapes.push_back(std::make_unique<btSphereShape>(b.size.x));
    else
      shapes.push_back(std::make_unique<btBoxShape>(vector(b.size)));
    const btScalar mass = b.fixed ? 0 : btScalar(volume(b) * double(b.density));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes.back()->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shapes.back().get(), inertia);
    info.m_startWorldTransform.setOrigin(vector(math::Vec3f(b.position)));
    info.m_startWorldTransform.setRotation({b.rotation.x, b.rotation.y, b.rotation.z, b.rotation.w});
    // Bullet multiplies the coefficients of a pair; Carom takes √(ab) and the larger restitution.
    info.m_friction = std::sqrt(b.friction);
    info.m_restitution = std::sqrt(b.restitution);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setLinearVelocity(vector(b.velocity));
    bodies.back()->setAngularVelocity(vector(b.spin));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
  }
  for (const Pin& pin : scene.pins) {
    pins.push_back(std::make_unique<btPoint2PointConstraint>(*bodies[std::size_t(pin.body)], vector(pin.anchor)));
    world.addConstraint(pins.back().get());
  }
  for (int i = 0; i < steps; ++i) world.stepSimulation(btScalar(1.0 / 60), 0);
  Outcome out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const btVector3 p = bodies[i]->getCenterOfMassPosition(), v = bodies[i]->getLinearVelocity();
    out.position.push_back({p.x(), p.y(), p.z()});
    out.velocity.push_back({v.x(), v.y(), v.z()});
    out.mass.push_back(scene.bodies[i].fixed ? 0 : volume(scene.bodies[i]) * double(scene.bodies[i].density));
  }
  for (auto& pin : pins) world.removeConstraint(pin.get());
  for (auto& body : bodies) world.removeRigidBody(body.get());
  return out;
}

}  // namespace carom::differential
