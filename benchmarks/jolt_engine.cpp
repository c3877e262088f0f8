// Jolt, with one collision step and its default iterations, without the damping that its bodies have by default.
#include <Jolt/Jolt.h>
// Jolt.h first.
#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/CylinderShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/Constraints/FixedConstraint.h>
#include <Jolt/Physics/Constraints/PointConstraint.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include <algorithm>

#include "benchmarks/engine.h"

namespace carom::bench {
namespace jolt {

JPH::Vec3 vector(Vec3d v) { return {float(v.x), float(v.y), float(v.z)}; }
Vec3d vector(JPH::Vec3 v) { return {v.GetX(), v.GetY(), v.GetZ()}; }

/// Layers: 0 fixed, 1 moving, 2 without collisions.
class BroadPhaseLayers final : public JPH::BroadPhaseLayerInterface {
 public:
  JPH::uint GetNumBroadPhaseLayers() const override { return 3; }
  JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer layer) const override {
    return JPH::BroadPhaseLayer(JPH::BroadPhaseLayer::Type(layer));
  }
};
class LayerToBroadPhase final : public JPH::ObjectVsBroadPhaseLayerFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer a, JPH::BroadPhaseLayer b) const override {
    const auto layer = JPH::BroadPhaseLayer::Type(b);
    return a < 2 && layer < 2 && a + layer > 0;
  }
};
class LayerToLayer final : public JPH::ObjectLayerPairFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer a, JPH::ObjectLayer b) const override { return a < 2 && b < 2 && a + b > 0; }
};

class Jolt final : public Engine {
 public:
  explicit Jolt(const Setting& setting) : steps_(setting.effort > 0 ? setting.effort : 1) {
    system_.Init(16384, 0, 65536, 32768, layers_, layer_to_broad_phase_, layer_to_layer_);
    system_.SetGravity(vector(setting.gravity));
    JPH::PhysicsSettings settings = system_.GetPhysicsSettings();
    settings.mAllowSleeping = setting.sleep;
    system_.SetPhysicsSettings(settings);
  }
  ~Jolt() override {
    for (auto& joint : joints_) system_.RemoveConstraint(joint);
    for (const JPH::BodyID body : bodies_) {
      interface().RemoveBody(body);
      interface().DestroyBody(body);
    }
  }
  void add(const Body& b) override {
    JPH::BodyCreationSettings s(
        shape_of(b), vector(b.position),
        JPH::Quat(float(b.rotation.x), float(b.rotation.y), float(b.rotation.z), float(b.rotation.w)).Normalized(),
        b.fixed ? JPH::EMotionType::Static : JPH::EMotionType::Dynamic,
        JPH::ObjectLayer(b.fixed ? 0 : (b.collides ? 1 : 2)));
    s.mLinearVelocity = vector(b.velocity);
    s.mAngularVelocity = vector(b.spin);
    s.mLinearDamping = s.mAngularDamping = 0;
    s.mFriction = float(b.friction);
    s.mRestitution = float(b.restitution);
    s.mApplyGyroscopicForce = b.spins;
    if (b.spins) s.mMaxAngularVelocity = 1000;
    if (b.bullet) s.mMotionQuality = JPH::EMotionQuality::LinearCast;
    s.mEnhancedInternalEdgeRemoval = b.slides;
    if (!b.fixed) {
      s.mOverrideMassProperties = JPH::EOverrideMassProperties::CalculateInertia;
      s.mMassPropertiesOverride.mMass = float(mass(b, 3));
    }
    if (b.moments) {
      s.mOverrideMassProperties = JPH::EOverrideMassProperties::MassAndInertiaProvided;
      s.mMassPropertiesOverride.mInertia = JPH::Mat44::sScale(vector(*b.moments));
    }
    bodies_.push_back(
        interface().CreateAndAddBody(s, b.fixed ? JPH::EActivation::DontActivate : JPH::EActivation::Activate));
  }
  void join(const Joint& j) override {
    JPH::Body& a = j.body_a < 0 ? JPH::Body::sFixedToWorld : body(j.body_a);
    JPH::Body& b = body(j.body_b);
    if (j.weld) {
      JPH::FixedConstraintSettings s;
      s.mPoint1 = s.mPoint2 = vector(j.at);
      joints_.push_back(s.Create(a, b));
    } else {
      JPH::PointConstraintSettings s;
      s.mPoint1 = s.mPoint2 = vector(j.at);
      joints_.push_back(s.Create(a, b));
    }
    system_.AddConstraint(joints_.back());
  }
  void step() override { system_.Update(1.0f / 60.0f, steps_, &memory_, &jobs_); }
  BodyMotion motion(int i) const override {
    const auto& interface = system_.GetBodyInterfaceNoLock();
    const JPH::BodyID b = bodies_[std::size_t(i)];
    const JPH::Quat q = interface.GetRotation(b);
    return {vector(interface.GetPosition(b)),
            {q.GetW(), q.GetX(), q.GetY(), q.GetZ()},
            vector(interface.GetLinearVelocity(b)),
            vector(interface.GetAngularVelocity(b))};
  }
  void set_velocity(int i, Vec3d velocity, Vec3d spin) override {
    interface().SetLinearAndAngularVelocity(bodies_[std::size_t(i)], vector(velocity), vector(spin));
  }
  bool awake(int i) const override { return system_.GetBodyInterfaceNoLock().IsActive(bodies_[std::size_t(i)]); }

 private:
  static JPH::Ref<JPH::Shape> shape_of(const Body& b) {
    const auto x = float(b.size.x), y = float(b.size.y);
    // The convex radius is Jolt's default where the body is not thinner.
    const float thin = float(std::min({b.size.x, b.size.y, b.size.z}));
    const float radius = std::min(JPH::cDefaultConvexRadius, 0.5f * thin);
    switch (b.kind) {
      case Kind::sphere:
        return new JPH::SphereShape(x);
      case Kind::capsule:
        return new JPH::CapsuleShape(x, y);
      case Kind::cylinder:
        return new JPH::CylinderShape(x, y, std::min(radius, 0.5f * x));
      case Kind::box:
        break;
    }
    return new JPH::BoxShape(vector(b.size), radius);
  }
  JPH::BodyInterface& interface() { return system_.GetBodyInterfaceNoLock(); }
  JPH::Body& body(int i) { return *system_.GetBodyLockInterfaceNoLock().TryGetBody(bodies_[std::size_t(i)]); }

  int steps_;
  BroadPhaseLayers layers_;
  LayerToBroadPhase layer_to_broad_phase_;
  LayerToLayer layer_to_layer_;
  JPH::TempAllocatorImpl memory_{64 << 20};
  JPH::JobSystemSingleThreaded jobs_{JPH::cMaxPhysicsJobs};
  JPH::PhysicsSystem system_;
  std::vector<JPH::BodyID> bodies_;
  std::vector<JPH::Ref<JPH::Constraint>> joints_;
};

/// What Jolt keeps for the whole program.
struct Registry {
  Registry() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory();
    JPH::RegisterTypes();
  }
};

}  // namespace jolt

std::unique_ptr<Engine> make_jolt(const Setting& setting) {
  static const jolt::Registry registry;
  return std::make_unique<jolt::Jolt>(setting);
}
std::string jolt_version() {
  return std::to_string(JPH_VERSION_MAJOR) + "." + std::to_string(JPH_VERSION_MINOR) + "." +
         std::to_string(JPH_VERSION_PATCH);
}

}  // namespace carom::bench
