// Bullet (Debian's package), with its defaults: 10 solver iterations, sequential impulses.
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

#include "benchmarks/engine.h"

namespace carom::bench {
namespace bullet {

btVector3 vector(Vec3d v) { return {btScalar(v.x), btScalar(v.y), btScalar(v.z)}; }
Vec3d vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

class Bullet final : public Engine {
 public:
  explicit Bullet(const Setting& setting) : sleep_(setting.sleep) {
    world_.setGravity(vector(setting.gravity));
    if (setting.effort > 0) world_.getSolverInfo().m_numIterations = setting.effort;
  }
  ~Bullet() override {
    for (auto& joint : joints_) world_.removeConstraint(joint.get());
    for (auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void add(const Body& b) override {
    shapes_.push_back(shape_of(b));
    const btScalar m = b.fixed ? 0 : btScalar(mass(b, 3));
    btVector3 inertia(0, 0, 0);
    if (m > 0) shapes_.back()->calculateLocalInertia(m, inertia);
    if (b.moments) inertia = vector(*b.moments);
    btRigidBody::btRigidBodyConstructionInfo info(m, nullptr, shapes_.back().get(), inertia);
    info.m_startWorldTransform.setOrigin(vector(b.position));
    const Quatd q = b.rotation;
    info.m_startWorldTransform.setRotation({btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)});
    // Bullet multiplies the two coefficients: square roots give the same for pairs of equal ones.
    info.m_friction = btScalar(std::sqrt(b.friction));
    info.m_restitution = btScalar(std::sqrt(b.restitution));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *bodies_.back();
    body.setLinearVelocity(vector(b.velocity));
    body.setAngularVelocity(vector(b.spin));
    if (!sleep_) body.setActivationState(DISABLE_DEACTIVATION);
    if (b.bullet) {
      const double least = b.kind == Kind::box ? std::min({b.size.x, b.size.y, b.size.z})
                                               : (b.kind == Kind::sphere ? b.size.x : b.size.y);
      body.setCcdMotionThreshold(btScalar(least));
      body.setCcdSweptSphereRadius(btScalar(0.9 * least));
    }
    world_.addRigidBody(&body, b.fixed ? 2 : 1, b.collides ? -1 : 0);
  }
  void join(const Joint& j) override {
    btRigidBody& b = *bodies_[std::size_t(j.body_b)];
    btRigidBody& a = j.body_a < 0 ? btTypedConstraint::getFixedBody() : *bodies_[std::size_t(j.body_a)];
    const btTransform at(btQuaternion::getIdentity(), vector(j.at));
    const btTransform in_a = a.getCenterOfMassTransform().inverse() * at,
                      in_b = b.getCenterOfMassTransform().inverse() * at;
    if (j.weld)
      joints_.push_back(std::make_unique<btFixedConstraint>(a, b, in_a, in_b));
    else
      joints_.push_back(std::make_unique<btPoint2PointConstraint>(a, b, in_a.getOrigin(), in_b.getOrigin()));
    world_.addConstraint(joints_.back().get(), true);
  }
  void step() override { world_.stepSimulation(btScalar(1.0 / 60.0), 0); }
  BodyMotion motion(int body) const override {
    const btRigidBody& b = *bodies_[std::size_t(body)];
    const btQuaternion q = b.getOrientation();
    return {vector(b.getCenterOfMassPosition()),
            {q.w(), q.x(), q.y(), q.z()},
            vector(b.getLinearVelocity()),
            vector(b.getAngularVelocity())};
  }
  void set_velocity(int body, Vec3d velocity, Vec3d spin) override {
    btRigidBody& b = *bodies_[std::size_t(body)];
    b.activate();
    b.setLinearVelocity(vector(velocity));
    b.setAngularVelocity(vector(spin));
  }
  bool awake(int body) const override { return bodies_[std::size_t(body)]->isActive(); }
  double deepest_overlap() const override {
    double deepest = 0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold->getNumContacts(); ++k)
        deepest = std::fmax(deepest, -manifold->getContactPoint(k).getDistance());
    }
    return deepest;
  }

 private:
  static std::unique_ptr<btCollisionShape> shape_of(const Body& b) {
    const auto x = btScalar(b.size.x), y = btScalar(b.size.y);
    switch (b.kind) {
      case Kind::sphere:
        return std::make_unique<btSphereShape>(x);
      case Kind::capsule:
        return std::make_unique<btCapsuleShape>(y, 2 * x);
      case Kind::cylinder:
        return std::make_unique<btCylinderShape>(btVector3(y, x, y));
      case Kind::box:
        break;
    }
    return std::make_unique<btBoxShape>(vector(b.size));
  }
  bool sleep_;
  btDefaultCollisionConfiguration configuration_;
  mutable btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace bullet

std::unique_ptr<Engine> make_bullet(const Setting& setting) { return std::make_unique<bullet::Bullet>(setting); }
std::string bullet_version() {
  return std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
}

}  // namespace carom::bench
