// Carom, through its public interface only.
#include "benchmarks/engine.h"
#include "benchmarks/measure.h"
#include "benchmarks/scene_list.h"

namespace carom::bench {
namespace {

template <class D>
RecipeOutcome run(const Recipe& recipe, const RecipeSettings& settings) {
  ListScene<D> scene(recipe);
  Outcome o = run_scene<D>(scene, {}, recipe.steps, {settings.threads, 4, settings.simd_width, settings.steps, false});
  return {std::move(o.step_ms), o.worst_drift,     o.rms_speed, o.worst_speed,
          o.worst_penetration,  o.worst_joint_gap, o.escaped};
}

template <class D>
class Carom final : public Engine {
 public:
  explicit Carom(const Setting& setting) : world_(definition(setting)) {}
  void add(const Body& b) override {
    BodyDef<D> body;
    body.type = b.fixed ? BodyType::fixed : BodyType::dynamic;
    body.position = position(b.position);
    body.rotation = rotation(b.rotation);
    body.linear_velocity = vector(b.velocity);
    body.angular_velocity = angular(b.spin);
    body.bullet = b.bullet;
    ShapeDef<D> surface;
    surface.density = float(density(b, D::dimension));
    surface.material.friction = float(b.friction);
    surface.material.restitution = float(b.restitution);
    if (!b.collides) surface.filter.mask = 0;
    const float size[3] = {float(b.size.x), float(b.size.y), float(b.size.z)};
    bodies_.push_back(add_body<D>(world_, body, shape_of<D>(b.kind, size), surface));
    if (!b.moments) return;
    if constexpr (D::dimension == 3) {
      geometry::MassProperties3 properties;
      properties.mass = mass(b, 3);
      properties.inertia = math::Mat3d::diagonal(*b.moments);
      world_.set_mass_properties(bodies_.back(), properties).value();
    }
  }
  void join(const Joint& j) override {
    const auto connect = [&](auto joint) {
      if (j.body_a >= 0) joint.body_a = bodies_[std::size_t(j.body_a)];
      joint.body_b = bodies_[std::size_t(j.body_b)];
      joint.frame_a = frame(j.body_a, j.at);
      joint.frame_b = frame(j.body_b, j.at);
      world_.create_joint(joint).value();
    };
    if (j.weld)
      connect(rigid::WeldJointDef<D>{});
    else
      connect(rigid::BallJointDef<D>{});
  }
  void step() override { world_.step(1.0f / 60.0f).value(); }
  BodyMotion motion(int body) const override {
    const auto s = world_.state(bodies_[std::size_t(body)]).value();
    const auto &p = s.pose.position, &v = s.linear_velocity, &w = s.angular_velocity;
    if constexpr (D::dimension == 2) {
      const double half = 0.5 * math::atan2(double(s.pose.rotation.s), double(s.pose.rotation.c));
      return {{p.x, p.y, 0}, {math::cos(half), 0, 0, math::sin(half)}, {v.x, v.y, 0}, {0, 0, w}};
    } else {
      return {p, Quatd(s.pose.rotation), Vec3d(v), Vec3d(w)};
    }
  }
  void set_velocity(int body, Vec3d velocity, Vec3d spin) override {
    world_.set_velocity(bodies_[std::size_t(body)], vector(velocity), angular(spin)).value();
  }
  bool awake(int body) const override { return world_.state(bodies_[std::size_t(body)]).value().awake; }

 private:
  static rigid::WorldDef<D> definition(const Setting& setting) {
    rigid::WorldDef<D> d;
    d.gravity = vector(setting.gravity);
    d.allow_sleep = setting.sleep;
    if (setting.effort > 0) d.substeps = setting.effort;
    return d;
  }
  static typename D::Position position(Vec3d p) {
    if constexpr (D::dimension == 2)
      return {p.x, p.y};
    else
      return p;
  }
  static typename D::Vector vector(Vec3d v) {
    if constexpr (D::dimension == 2)
      return {float(v.x), float(v.y)};
    else
      return math::Vec3f(v);
  }
  static typename D::Angular angular(Vec3d w) {
    if constexpr (D::dimension == 2)
      return float(w.z);
    else
      return math::Vec3f(w);
  }
  static typename D::Rotation rotation(Quatd q) {
    if constexpr (D::dimension == 2)
      return {float(q.w * q.w - q.z * q.z), float(2 * q.w * q.z)};
    else
      return math::Quatf(q);
  }
  /// A joint's frame at that point, level, in the body's.
  typename D::Transform frame(int body, Vec3d at) const {
    if (body < 0) return {vector(at), {}};
    const auto pose = world_.state(bodies_[std::size_t(body)]).value().pose;
    return {inverse_rotate(pose.rotation, typename D::Vector(position(at) - pose.position)), conjugate(pose.rotation)};
  }
  rigid::World<D> world_;
  std::vector<BodyId> bodies_;
};

}  // namespace

RecipeOutcome run_carom(const Recipe& recipe, const RecipeSettings& settings) {
  return recipe.dimension == 2 ? run<rigid::Dim2>(recipe, settings) : run<rigid::Dim3>(recipe, settings);
}
std::unique_ptr<Engine> make_carom(const Setting& setting) {
  if (setting.dimension == 2) return std::make_unique<Carom<Dim2>>(setting);
  return std::make_unique<Carom<Dim3>>(setting);
}

}  // namespace carom::bench
