// Box2D 3, with 4 substeps.
#include <box2d/box2d.h>

#include <cmath>

#include "benchmarks/engine.h"

namespace carom::bench {
namespace box2d_3 {

b2Vec2 vector(Vec3d v) { return {float(v.x), float(v.y)}; }

class Box2D final : public Engine {
 public:
  explicit Box2D(const Setting& setting) : substeps_(setting.effort > 0 ? setting.effort : 4) {
    b2WorldDef definition = b2DefaultWorldDef();
    definition.gravity = vector(setting.gravity);
    definition.enableSleep = setting.sleep;
    world_ = b2CreateWorld(&definition);
    const b2BodyDef ground = b2DefaultBodyDef();
    ground_ = b2CreateBody(world_, &ground);
  }
  ~Box2D() override { b2DestroyWorld(world_); }
  void add(const Body& b) override {
    b2BodyDef definition = b2DefaultBodyDef();
    definition.type = b.fixed ? b2_staticBody : b2_dynamicBody;
    definition.position = vector(b.position);
    definition.rotation = b2MakeRot(float(2 * std::atan2(b.rotation.z, b.rotation.w)));
    definition.linearVelocity = vector(b.velocity);
    definition.angularVelocity = float(b.spin.z);
    definition.isBullet = b.bullet;
    definition.allowFastRotation = b.spins;
    const b2BodyId body = b2CreateBody(world_, &definition);
    bodies_.push_back(body);
    b2ShapeDef surface = b2DefaultShapeDef();
    surface.density = float(density(b, 2));
    surface.material.friction = float(b.friction);
    surface.material.restitution = float(b.restitution);
    if (!b.collides) surface.filter.maskBits = 0;
    const auto x = float(b.size.x), y = float(b.size.y);
    if (b.kind == Kind::sphere) {
      const b2Circle circle{{0, 0}, x};
      b2CreateCircleShape(body, &surface, &circle);
    } else if (b.kind == Kind::capsule) {
      const b2Capsule capsule{{0, -x}, {0, x}, y};
      b2CreateCapsuleShape(body, &surface, &capsule);
    } else {
      const b2Polygon box = b2MakeBox(x, y);
      b2CreatePolygonShape(body, &surface, &box);
    }
  }
  void join(const Joint& j) override {
    const b2BodyId a = j.body_a < 0 ? ground_ : bodies_[std::size_t(j.body_a)], b = bodies_[std::size_t(j.body_b)];
    const auto fill = [&](b2JointDef& base) {
      base.bodyIdA = a;
      base.bodyIdB = b;
      base.localFrameA = {b2Body_GetLocalPoint(a, vector(j.at)), b2InvertRot(b2Body_GetRotation(a))};
      base.localFrameB = {b2Body_GetLocalPoint(b, vector(j.at)), b2InvertRot(b2Body_GetRotation(b))};
    };
    if (j.weld) {
      b2WeldJointDef definition = b2DefaultWeldJointDef();
      fill(definition.base);
      b2CreateWeldJoint(world_, &definition);
    } else {
      b2RevoluteJointDef definition = b2DefaultRevoluteJointDef();
      fill(definition.base);
      b2CreateRevoluteJoint(world_, &definition);
    }
  }
  void step() override { b2World_Step(world_, 1.0f / 60.0f, substeps_); }
  BodyMotion motion(int body) const override {
    const b2BodyId b = bodies_[std::size_t(body)];
    const auto p = b2Body_GetPosition(b);
    const b2Vec2 v = b2Body_GetLinearVelocity(b);
    const double half = 0.5 * double(b2Rot_GetAngle(b2Body_GetRotation(b)));
    return {{p.x, p.y, 0}, {std::cos(half), 0, 0, std::sin(half)}, {v.x, v.y, 0}, {0, 0, b2Body_GetAngularVelocity(b)}};
  }
  void set_velocity(int body, Vec3d velocity, Vec3d spin) override {
    const b2BodyId b = bodies_[std::size_t(body)];
    b2Body_SetAwake(b, true);
    b2Body_SetLinearVelocity(b, vector(velocity));
    b2Body_SetAngularVelocity(b, float(spin.z));
  }
  bool awake(int body) const override { return b2Body_IsAwake(bodies_[std::size_t(body)]); }

 private:
  int substeps_;
  b2WorldId world_;
  b2BodyId ground_;
  std::vector<b2BodyId> bodies_;
};

}  // namespace box2d_3

std::unique_ptr<Engine> make_box2d_3(const Setting& setting) { return std::make_unique<box2d_3::Box2D>(setting); }
std::string box2d_3_version() {
  const b2Version v = b2GetVersion();
  return std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.revision);
}

}  // namespace carom::bench
