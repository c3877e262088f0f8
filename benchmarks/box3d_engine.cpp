// Box3D, with 4 substeps.
#include <box3d/box3d.h>

#include "benchmarks/engine.h"

namespace carom::bench {
namespace box3d {

b3Vec3 vector(Vec3d v) { return {float(v.x), float(v.y), float(v.z)}; }
Vec3d vector(b3Vec3 v) { return {v.x, v.y, v.z}; }
b3Quat rotation(Quatd q) { return {{float(q.x), float(q.y), float(q.z)}, float(q.w)}; }

class Box3D final : public Engine {
 public:
  explicit Box3D(const Setting& setting) : substeps_(setting.effort > 0 ? setting.effort : 4) {
    b3WorldDef definition = b3DefaultWorldDef();
    definition.gravity = vector(setting.gravity);
    definition.enableSleep = setting.sleep;
    world_ = b3CreateWorld(&definition);
    const b3BodyDef ground = b3DefaultBodyDef();
    ground_ = b3CreateBody(world_, &ground);
  }
  ~Box3D() override { b3DestroyWorld(world_); }
  void add(const Body& b) override {
    b3BodyDef definition = b3DefaultBodyDef();
    definition.type = b.fixed ? b3_staticBody : b3_dynamicBody;
    definition.position = {float(b.position.x), float(b.position.y), float(b.position.z)};
    definition.rotation = rotation(b.rotation);
    definition.linearVelocity = vector(b.velocity);
    definition.angularVelocity = vector(b.spin);
    definition.isBullet = b.bullet;
    definition.allowFastRotation = b.spins;
    const b3BodyId body = b3CreateBody(world_, &definition);
    bodies_.push_back(body);
    b3ShapeDef surface = b3DefaultShapeDef();
    surface.density = float(density(b, 3));
    surface.baseMaterial.friction = float(b.friction);
    surface.baseMaterial.restitution = float(b.restitution);
    if (!b.collides) surface.filter.maskBits = 0;
    const auto x = float(b.size.x), y = float(b.size.y);
    if (b.kind == Kind::sphere) {
      const b3Sphere sphere{{0, 0, 0}, x};
      b3CreateSphereShape(body, &surface, &sphere);
    } else if (b.kind == Kind::capsule) {
      const b3Capsule capsule{{0, -x, 0}, {0, x, 0}, y};
      b3CreateCapsuleShape(body, &surface, &capsule);
    } else if (b.kind == Kind::cylinder) {  // a hull, of as many sides as it takes
      b3HullData* hull = b3CreateCylinder(2 * x, y, -x, 32);
      b3CreateHullShape(body, &surface, hull);
      b3DestroyHull(hull);
    } else {
      const b3BoxHull box = b3MakeBoxHull(x, y, float(b.size.z));
      b3CreateHullShape(body, &surface, &box.base);
    }
    if (!b.moments) return;
    b3MassData data = b3Body_GetMassData(body);
    data.mass = float(mass(b, 3));
    data.inertia = {{float(b.moments->x), 0, 0}, {0, float(b.moments->y), 0}, {0, 0, float(b.moments->z)}};
    b3Body_SetMassData(body, data);
  }
  void join(const Joint& j) override {
    const b3BodyId a = j.body_a < 0 ? ground_ : bodies_[std::size_t(j.body_a)], b = bodies_[std::size_t(j.body_b)];
    const auto fill = [&](b3JointDef& base) {
      const b3Pos at = {float(j.at.x), float(j.at.y), float(j.at.z)};
      base.bodyIdA = a;
      base.bodyIdB = b;
      base.localFrameA = {b3Body_GetLocalPoint(a, at), b3Conjugate(b3Body_GetRotation(a))};
      base.localFrameB = {b3Body_GetLocalPoint(b, at), b3Conjugate(b3Body_GetRotation(b))};
    };
    if (j.weld) {
      b3WeldJointDef definition = b3DefaultWeldJointDef();
      fill(definition.base);
      b3CreateWeldJoint(world_, &definition);
    } else {
      b3SphericalJointDef definition = b3DefaultSphericalJointDef();
      fill(definition.base);
      b3CreateSphericalJoint(world_, &definition);
    }
  }
  void step() override { b3World_Step(world_, 1.0f / 60.0f, substeps_); }
  BodyMotion motion(int body) const override {
    const b3BodyId b = bodies_[std::size_t(body)];
    const b3Pos p = b3Body_GetPosition(b);
    const b3Quat q = b3Body_GetRotation(b);
    return {{p.x, p.y, p.z},
            {q.s, q.v.x, q.v.y, q.v.z},
            vector(b3Body_GetLinearVelocity(b)),
            vector(b3Body_GetAngularVelocity(b))};
  }
  void set_velocity(int body, Vec3d velocity, Vec3d spin) override {
    const b3BodyId b = bodies_[std::size_t(body)];
    b3Body_SetAwake(b, true);
    b3Body_SetLinearVelocity(b, vector(velocity));
    b3Body_SetAngularVelocity(b, vector(spin));
  }
  bool awake(int body) const override { return b3Body_IsAwake(bodies_[std::size_t(body)]); }

 private:
  int substeps_;
  b3WorldId world_;
  b3BodyId ground_;
  std::vector<b3BodyId> bodies_;
};

}  // namespace box3d

std::unique_ptr<Engine> make_box3d(const Setting& setting) { return std::make_unique<box3d::Box3D>(setting); }
std::string box3d_version() {
  const b3Version v = b3GetVersion();
  return std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.revision);
}

}  // namespace carom::bench
