// Box2D 2.4 (Debian's package), with its usual 8 velocity and 3 position iterations.
#include <box2d/box2d.h>

#include <cmath>

#include "benchmarks/engine.h"

namespace carom::bench {
namespace box2d_2 {

b2Vec2 vector(Vec3d v) { return {float(v.x), float(v.y)}; }

class Box2D final : public Engine {
 public:
  explicit Box2D(const Setting& setting) : world_(vector(setting.gravity)) {
    world_.SetAllowSleeping(setting.sleep);
    b2BodyDef ground;
    ground_ = world_.CreateBody(&ground);
  }
  void add(const Body& b) override {
    b2BodyDef definition;
    definition.type = b.fixed ? b2_staticBody : b2_dynamicBody;
    definition.position = vector(b.position);
    definition.angle = float(2 * std::atan2(b.rotation.z, b.rotation.w));
    definition.linearVelocity = vector(b.velocity);
    definition.angularVelocity = float(b.spin.z);
    definition.bullet = b.bullet;
    bodies_.push_back(world_.CreateBody(&definition));
    b2FixtureDef fixture;
    fixture.density = float(density(b, 2));
    fixture.friction = float(b.friction);
    fixture.restitution = float(b.restitution);
    if (!b.collides) fixture.filter.maskBits = 0;
    const auto attach = [&](const b2Shape& shape) {
      fixture.shape = &shape;
      bodies_.back()->CreateFixture(&fixture);
    };
    const auto x = float(b.size.x), y = float(b.size.y);
    b2PolygonShape polygon;
    b2CircleShape circle;
    if (b.kind == Kind::sphere) {
      circle.m_radius = x;
      attach(circle);
    } else if (b.kind == Kind::capsule) {  // of a box and two circles
      polygon.SetAsBox(y, x);
      attach(polygon);
      circle.m_radius = y;
      fixture.density = 0;
      for (const float end : {-x, x}) {
        circle.m_p.Set(0, end);
        attach(circle);
      }
      b2MassData data;
      data.mass = float(mass(b, 2));
      data.center.SetZero();
      data.I = float(moments(b, 2).z);
      if (!b.fixed) bodies_.back()->SetMassData(&data);
    } else {
      polygon.SetAsBox(x, y);
      attach(polygon);
    }
  }
  void join(const Joint& j) override {
    b2Body* a = j.body_a < 0 ? ground_ : bodies_[std::size_t(j.body_a)];
    b2Body* b = bodies_[std::size_t(j.body_b)];
    if (j.weld) {
      b2WeldJointDef definition;
      definition.Initialize(a, b, vector(j.at));
      world_.CreateJoint(&definition);
    } else {
      b2RevoluteJointDef definition;
      definition.Initialize(a, b, vector(j.at));
      world_.CreateJoint(&definition);
    }
  }
  void step() override { world_.Step(1.0f / 60.0f, 8, 3); }
  BodyMotion motion(int body) const override {
    const b2Body* b = bodies_[std::size_t(body)];
    const b2Vec2 p = b->GetPosition(), v = b->GetLinearVelocity();
    const double half = 0.5 * b->GetAngle();
    return {{p.x, p.y, 0}, {std::cos(half), 0, 0, std::sin(half)}, {v.x, v.y, 0}, {0, 0, b->GetAngularVelocity()}};
  }
  void set_velocity(int body, Vec3d velocity, Vec3d spin) override {
    bodies_[std::size_t(body)]->SetAwake(true);
    bodies_[std::size_t(body)]->SetLinearVelocity(vector(velocity));
    bodies_[std::size_t(body)]->SetAngularVelocity(float(spin.z));
  }
  bool awake(int body) const override { return bodies_[std::size_t(body)]->IsAwake(); }
  double deepest_overlap() const override {
    double deepest = 0;
    for (const b2Contact* contact = world_.GetContactList(); contact; contact = contact->GetNext()) {
      if (!contact->IsTouching()) continue;
      b2WorldManifold manifold;
      contact->GetWorldManifold(&manifold);
      for (int k = 0; k < contact->GetManifold()->pointCount; ++k)
        deepest = std::fmax(deepest, -manifold.separations[k]);
    }
    return deepest;
  }

 private:
  b2World world_;
  b2Body* ground_;
  std::vector<b2Body*> bodies_;
};

}  // namespace box2d_2

std::unique_ptr<Engine> make_box2d_2(const Setting& setting) { return std::make_unique<box2d_2::Box2D>(setting); }
std::string box2d_2_version() {
  return std::to_string(b2_version.major) + "." + std::to_string(b2_version.minor) + "." +
         std::to_string(b2_version.revision);
}

}  // namespace carom::bench
