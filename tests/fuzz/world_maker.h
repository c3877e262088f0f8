// Bodies, shapes, joints and effectors of any kind with any numbers, for a world that is fuzzed.
#pragma once

#include "carom/carom.h"
#include "carom/environment/environment.h"
#include "tests/fuzz/source.h"

namespace carom::fuzz {

using namespace carom::rigid;

template <class D>
struct Maker {
  using Vector = typename D::Vector;
  Source in;
  WorldDef<D> definition{};
  World<D> world, foreign;
  std::vector<BodyId> bodies;  ///< alive or not
  std::vector<ShapeId> shapes;
  std::vector<JointId> joints;
  std::vector<EffectorId> effectors;

  Maker(Source source, const WorldDef<D>& d) : in(source), definition(d), world(d), foreign(d) {
    bodies.push_back(foreign.create_body({}).value());
    shapes.push_back(foreign.add_shape(bodies[0], geometry_of()).value());
    bodies.push_back({});
    shapes.push_back({});
    joints.push_back({});
    effectors.push_back({});
    BodyDef<D> ground;
    ground.type = BodyType::fixed;
    bodies.push_back(world.create_body(ground).value());
    if constexpr (D::dimension == 2)
      shapes.push_back(world.add_shape(bodies.back(), geometry::make_box2({50, 1})).value());
    else
      shapes.push_back(world.add_shape(bodies.back(), geometry::Box{{50, 1, 50}}).value());
  }
  static typename D::Shape geometry_of() {
    if constexpr (D::dimension == 2)
      return geometry::Circle{0.5f};
    else
      return geometry::Sphere{0.5f};
  }

  Vector vector(float scale = 1) {
    Vector v{};
    for (int i = 0; i < D::dimension; ++i) v[i] = in.number(scale);
    return v;
  }
  typename D::Angular angular() {
    if constexpr (D::dimension == 2)
      return in.number();
    else
      return vector();
  }
  typename D::Rotation rotation() {
    typename D::Rotation q{};
    if (in.byte() < 128) return q;
    if constexpr (D::dimension == 2)
      q = {in.number(), in.number()};
    else
      q = {in.number(), in.number(), in.number(), in.number()};
    return in.byte() < 200 ? math::normalize(q) : q;
  }
  typename D::Position position() { return typename D::Position(vector(2)) * (in.byte() > 250 ? 1e9 : 1.0); }
  typename D::Transform transform() { return {vector(0.2f), rotation()}; }
  BodyId body() { return bodies[in.byte() % bodies.size()]; }
  ShapeId shape() { return shapes[in.byte() % shapes.size()]; }

  typename D::Shape any_shape() {
    if constexpr (D::dimension == 2) {
      switch (in.byte() % 5) {
        case 0:
          return geometry::Circle{in.size()};
        case 1:
          return geometry::Capsule2{in.size(), in.size()};
        case 2: {
          const Vector points[5] = {vector(), vector(), vector(), vector(), vector()};
          const auto polygon = geometry::make_polygon(points, in.flag() ? in.size() : 0);
          return polygon.ok() ? geometry::Shape2(*polygon) : geometry::Shape2(geometry::Circle{1});
        }
        case 3: {
          auto chain = geometry::make_chain({vector(5), vector(5), vector(5), vector(5)}, in.flag());
          return chain.ok() ? geometry::Shape2(*chain) : geometry::Shape2(geometry::Segment{vector(), vector()});
        }
        default:
          return in.byte() < 200 ? geometry::make_box2({0.1f + math::abs(float(in.byte())) / 128, 0.3f})
                                 : geometry::make_box2({in.size(), in.size()});
      }
    } else {
      switch (in.byte() % 12) {
        case 0:
          return geometry::Sphere{in.size()};
        case 1:
          return geometry::Capsule3{in.size(), in.size()};
        case 2:
          return geometry::Cylinder{in.size(), in.size(), in.flag() ? in.size() : 0.0f};
        case 3:
          return geometry::Cone{in.size(), in.size(), in.flag() ? in.size() : 0.0f};
        case 4: {
          const Vector points[6] = {vector(), vector(), vector(), vector(), vector(), vector()};
          const auto hull = geometry::make_hull(points);
          return hull.ok() ? geometry::Shape3(*hull) : geometry::Shape3(geometry::Sphere{1});
        }
        case 5: {
          auto mesh = geometry::make_triangle_mesh({vector(5), vector(5), vector(5), vector(5)}, {0, 1, 2, 0, 2, 3});
          return mesh.ok() ? geometry::Shape3(*mesh) : geometry::Shape3(geometry::Plane{});
        }
        case 6: {
          auto field = geometry::make_height_field(3, 3, {in.size(), in.size()},
                                                   {0, in.number(), 0, in.number(), 0, in.number(), 0, 0.1f, 0});
          return field.ok() ? geometry::Shape3(*field) : geometry::Shape3(geometry::Plane{vector()});
        }
        case 8:
          return geometry::Ellipsoid{{in.size(), in.size(), in.size()}};
        case 9: {
          std::vector<std::uint8_t> cells;
          for (int i = 0; i < 27; ++i) cells.push_back(std::uint8_t(in.byte() % 3));
          auto grid = geometry::make_voxel_grid(3, 3, 3, in.size(), cells);
          return grid.ok() ? geometry::Shape3(*grid) : geometry::Shape3(geometry::Box{});
        }
        case 10: {  // closed, where its corners are no plane: a body of its own
          auto mesh = geometry::make_triangle_mesh({vector(), vector(), vector(), vector()},
                                                   {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, {0, 1, 0, in.byte()});
          return mesh.ok() ? geometry::Shape3(*mesh) : geometry::Shape3(geometry::Sphere{});
        }
        case 7: {
          auto compound = geometry::make_compound({{geometry::Box{{in.size(), in.size(), in.size()}}, transform()},
                                                   {geometry::Sphere{in.size()}, transform()}});
          return compound.ok() ? geometry::Shape3(*compound) : geometry::Shape3(geometry::Box{});
        }
        default:
          return geometry::Box{{in.size(), in.size(), in.size()}, in.flag() ? in.size() : 0};
      }
    }
  }

  bool add_body() {
    BodyDef<D> d;
    d.type = BodyType(in.byte() % (in.byte() < 250 ? 3 : 200));
    d.position = position();
    d.rotation = rotation();
    d.linear_velocity = vector(4);
    d.angular_velocity = angular();
    const std::uint8_t options = in.byte();
    d.bullet = (options & 1) != 0;
    d.awake = (options & 2) == 0;
    d.enabled = (options & 12) != 12;
    d.allow_sleep = (options & 16) == 0;
    d.locks.x = (options & 96) == 96;
    d.locks.rotation_z = (options & 192) == 192;
    if (options == 77) d.name = "named";
    if (in.byte() > 200) d.linear_damping = in.number(), d.gravity_scale = in.number(), d.time_scale = in.number();
    const auto made = world.create_body(d);
    if (made.ok()) bodies.push_back(*made);
    return made.ok();
  }
  bool add_shape() {
    ShapeDef<D> d;
    const std::uint8_t options = in.byte();
    d.sensor = (options & 7) == 7;
    d.hit_events = (options & 8) != 0;
    d.modify_contacts = (options & 48) == 48;
    if ((options & 192) == 192) d.local = transform();
    if (in.byte() > 180) {
      d.density = in.number(1000);
      d.material = {in.number(), in.number(), in.number(), in.number(), in.number(), in.byte() % 4u};
      d.filter = {in.byte(), in.byte(), std::int32_t(in.byte()) - 128};
    }
    if (in.byte() > 230) d.surface_velocity = vector();
    while (in.byte() > 200) d.surfaces.push_back({{in.number(), in.number()}, vector()});
    if (in.byte() > 230) d.one_way = vector();
    const auto made = world.add_shape(body(), any_shape(), d);
    if (made.ok()) shapes.push_back(*made);
    return made.ok();
  }
  template <class Def>
  bool make_joint(Def d) {
    d.body_a = body();
    d.body_b = body();
    d.frame_a = transform();
    d.frame_b = transform();
    d.collide_connected = in.flag();
    if constexpr (requires { d.spring; }) d.spring = {in.number(4), in.number()};
    if constexpr (requires { d.limit; }) d.limit = {in.flag(), in.number(), in.number()};
    if constexpr (requires { d.motor; }) d.motor = {in.flag(), in.number(), in.number(100)};
    if constexpr (requires { d.target; }) d.target = position();
    if constexpr (requires { d.length; }) d.length = in.number();
    if (in.byte() > 180) {
      if constexpr (requires { d.target_rotation; }) d.target_rotation = rotation();
      if constexpr (requires { d.target_position; }) d.target_position = vector();
      if constexpr (requires { d.target_velocity; }) d.target_velocity = vector(4), d.hold_position = in.flag();
      if constexpr (requires { d.target_spin; }) d.target_spin = angular(), d.hold_rotation = in.flag();
      if constexpr (requires { d.max_spring_torque; }) d.max_spring_torque = in.number(10);
      if constexpr (requires { d.max_spring_force; }) d.max_spring_force = in.number(10);
      d.break_force = in.number(1000);
    }
    if constexpr (requires { d.ratio; }) d.ratio = in.number();
    if constexpr (requires { d.radius; }) d.radius = in.number();
    if constexpr (requires { d.pitch; }) d.pitch = in.number();
    if constexpr (requires { d.ground_a; }) d.ground_a = position(), d.ground_b = position();
    if constexpr (requires { d.points; }) {
      const Vector points[] = {vector(), vector(), vector(4), vector(4)};
      d.points = std::span(points).first(in.byte() % 5u);
      d.closed = in.flag(), d.straight = in.flag(), d.follow = in.flag();
      const auto made = world.create_joint(d);
      if (made.ok()) joints.push_back(*made);
      return made.ok();
    }
    if constexpr (requires { d.angular[0]; }) {
      for (JointAxis& axis : d.linear) axis = any_axis();
      for (JointAxis& axis : d.angular) axis = any_axis();
    }
    const auto made = world.create_joint(d);
    if (made.ok()) joints.push_back(*made);
    return made.ok();
  }
  JointAxis any_axis() {
    if (in.flag()) return {};
    JointAxis a;
    a.free = true;
    a.limit = {in.flag(), in.number(), in.number()};
    a.spring = {in.number(4), in.number()};
    a.target = in.number(), a.friction = in.number();
    return a;
  }
  bool add_joint() {
    const std::uint8_t kind = in.byte();
    if (kind >= 200) {
      switch (kind % 6) {
        case 0:
          return make_joint(GenericJointDef<D>{});
        case 1:
          return make_joint(GearJointDef<D>{});
        case 2:
          return make_joint(RackJointDef<D>{});
        case 3:
          return make_joint(PulleyJointDef<D>{});
        case 4:
          return make_joint(PathJointDef<D>{});
        default:
          if constexpr (D::dimension == 3) return make_joint(ScrewJointDef<D>{});
      }
    }
    switch (kind % 7) {
      case 0:
        return make_joint(DistanceJointDef<D>{});
      case 1:
        return make_joint(BallJointDef<D>{});
      case 2:
        return make_joint(HingeJointDef<D>{});
      case 3:
        return make_joint(SliderJointDef<D>{});
      case 4:
        return make_joint(WeldJointDef<D>{});
      case 5:
        return make_joint(MotorJointDef<D>{});
      default:
        return make_joint(MouseJointDef<D>{});
    }
  }
  EffectorDef<D> any_effector() {
    switch (in.byte() % 14) {
      case 12: {
        LiftingSurface<D> e;
        e.body = body();
        e.law.aspect_ratio = double(in.number(20));
        e.law.stall_angle = double(in.number(1));
        e.point = vector();
        e.forward = vector();
        e.area = double(in.number(5));
        return e;
      }
      case 13: {
        CylinderDrag<D> e;
        e.body = body();
        e.axis = vector();
        e.length = double(in.number(5));
        return e;
      }
      case 0: {
        LinearDrag<D> e;
        e.body = in.flag() ? body() : BodyId{};
        e.coefficient = double(in.number(10));
        return e;
      }
      case 1:
        return Wind<D>{vector()};
      case 2: {
        SpringDamper<D> e;
        e.body_a = body();
        e.body_b = in.flag() ? body() : BodyId{};
        e.point_b = position();
        e.stiffness = double(in.number(1000));
        e.damping = double(in.number(10));
        e.break_force = in.flag() ? double(in.number(100)) : 0;
        return e;
      }
      case 3: {
        Buoyancy<D> e;
        e.level = double(in.number());
        e.linear_drag = double(in.number());
        e.added_mass = vector();
        return e;
      }
      case 7: {
        Surroundings<D> e;
        environment::Environment::Definition d;
        d.wind.mean.velocity = {double(in.number(50)), double(in.number(50)), 0};
        d.frame.rate = {0, 0, double(in.number(3))};
        d.gravity.kind = in.flag() ? environment::GravityField::Kind::spherical : environment::GravityField::Kind::none;
        const environment::WaveComponent wave{double(in.number(2)), 0.1 + double(in.byte()), double(in.number(3))};
        auto sea = environment::Sea::make({.level = double(in.number(5))}, {&wave, 1});
        if (sea.ok()) d.water = std::move(sea).value();
        auto made = environment::Environment::make(std::move(d));
        if (made.ok()) e.environment = std::make_shared<const environment::Environment>(std::move(made).value());
        return e;  // null where the numbers were bad: refused
      }
      case 8: {
        BodyDrag<D> e;
        e.body = in.flag() ? body() : BodyId{};
        e.law.kind = forces::DragLaw::Kind(in.byte() % 8);
        e.law.coefficient = double(in.number(3));
        e.diameter = double(in.number(5));
        e.area = double(in.number(5));
        e.point = vector();
        return e;
      }
      case 9: {
        MagnusLift<D> e;
        e.radius = double(in.number(2));
        return e;
      }
      case 10: {
        TurningFrame<D> e;
        e.center = position();
        if constexpr (D::dimension == 2)
          e.rate = in.number(20);
        else
          e.rate = vector();
        e.centrifugal = in.flag();
        return e;
      }
      case 11: {
        ElectromagneticField<D> e;
        e.body = in.flag() ? body() : BodyId{};
        e.charge = double(in.number(100));
        e.electric = vector();
        e.magnetic = {in.number(9), in.number(9), in.number(9)};
        return e;
      }
      case 4: {
        RadialField<D> e;
        e.center = position();
        e.strength = double(in.number());
        e.exponent = double(in.number());
        return e;
      }
      case 5: {
        CustomEffector<D> e;
        e.body = in.flag() ? body() : BodyId{};
        const float x = in.number(100);  // not finite, too
        e.model = [x](const EffectorInput<D>&) {
          Wrench<D> w;
          w.force.x = x;
          return w;
        };
        return e;
      }
      default: {
        QuadraticDrag<D> e;
        e.area = double(in.number());
        return e;
      }
    }
  }
};

}  // namespace carom::fuzz
