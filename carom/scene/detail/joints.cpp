#include "carom/scene/detail/joints.h"

#include "carom/environment/frame.h"
#include "carom/scene/detail/ball_flight.h"
#include "carom/scene/detail/force_field.h"
#include "carom/scene/detail/projectile.h"

namespace carom::scene::detail {
namespace {
using namespace rigid;

enum JointChoice {
  distance_joint,
  ball_joint,
  hinge_joint,
  slider_joint,
  weld_joint,
  motor_joint,
  mouse_joint,
  generic_joint,
  gear_joint,
  rack_joint,
  screw_joint,
  pulley_joint,
  cylindrical_joint,
  planar_joint,
  universal_joint,
  wheel_joint,
  path_joint
};
/// Is the joint's axis x of its frames? Others have it along z.
bool along_x(int type) {
  return type == slider_joint || type == screw_joint || type == cylindrical_joint || type == universal_joint ||
         type == path_joint;
}
/// Do the frames sit at the bodies' origins unless something else is said?
bool needs_no_anchor(int type) {
  return type == motor_joint || type == gear_joint || type == rack_joint || type == path_joint;
}

/// The rotation that turns `from` (x or z) onto the axis by the shortest way.
math::Rot2d onto_axis(math::Vec3d axis, math::Vec3d, Dim2*) { return {axis.x, axis.y}; }
math::Quatd onto_axis(math::Vec3d axis, math::Vec3d from, Dim3*) {
  const double cosine = math::dot(from, axis);
  if (cosine < -1 + 1e-12) return {0, from.z != 0 ? math::Vec3d{1, 0, 0} : math::Vec3d{0, 0, 1}};
  return math::normalize(math::Quatd{1 + cosine, math::cross(from, axis)});
}

JointSpring read_spring(Reader& reader, const Object& o, const char* key, JointSpring spring) {
  Object s;
  if (!o.has(key) || !reader.open(*o.find(key), o.path_of(key), *tables().spring, s)) return spring;
  spring.hertz = float(reader.number(s, "frequency", spring.hertz));
  spring.damping_ratio = float(reader.number(s, "damping_ratio", spring.damping_ratio));
  return spring;
}
JointLimit read_limit(Reader& reader, const Object& o, const char* key, Measure measure) {
  JointLimit limit;
  Object l;
  if (!o.has(key) || !reader.open(*o.find(key), o.path_of(key), *tables().limit, l)) return limit;
  limit.enabled = reader.flag(l, "enabled", true);
  limit.lower = float(reader.number(l, "lower", 0, measure));
  limit.upper = float(reader.number(l, "upper", 0, measure));
  return limit;
}
JointMotor read_motor(Reader& reader, const Object& o, bool angular) {
  JointMotor motor;
  Object m;
  if (!o.has("motor") || !reader.open(*o.find("motor"), o.path_of("motor"), *tables().motor, m)) return motor;
  motor.enabled = reader.flag(m, "enabled", true);
  motor.speed = float(reader.number(m, "speed", 0, angular ? Measure::angular_speed : Measure::speed));
  const char* due = angular ? "max_torque" : "max_force";
  if (!m.has(due))
    reader.fail(*m.node, m.path, std::string("the key ") + quote(due) + " is missing in this joint's motor");
  motor.max_force = float(reader.number(m, due, 0));
  return motor;
}

JointAxis read_axis(Reader& reader, const Object& axes, const char* key, JointAxis axis, bool angular) {
  Object a;
  if (!axes.has(key) || !reader.open(*axes.find(key), axes.path_of(key), *tables().joint_axis, a)) return axis;
  axis.free = reader.flag(a, "free", true);
  axis.limit = a.has("limit") ? read_limit(reader, a, "limit", angular ? Measure::angle : Measure::length) : axis.limit;
  axis.spring = read_spring(reader, a, "spring", axis.spring);
  axis.target = float(reader.number(a, "target", 0, angular ? Measure::angle : Measure::length));
  axis.max_spring_force = float(reader.number(a, angular ? "max_spring_torque" : "max_spring_force", 0));
  if (a.has("motor")) axis.motor = read_motor(reader, a, angular);
  axis.friction = float(reader.number(a, angular ? "friction_torque" : "friction", 0));
  return axis;
}
template <class D>
void read_axes(Reader& reader, const Object& o, GenericJointDef<D>& d) {
  Object axes;
  if (!o.has("axes") || !reader.open(*o.find("axes"), o.path_of("axes"), *tables().joint_axes, axes)) return;
  constexpr const char* lines[] = {"x", "y", "z"};
  constexpr const char* turns[] = {"turn_x", "turn_y", "turn_z"};
  constexpr int first = D::dimension == 2 ? 2 : 0;
  for (int i = 0; i < D::dimension; ++i) d.linear[i] = read_axis(reader, axes, lines[i], d.linear[i], false);
  for (int i = first; i < 3; ++i) d.angular[i - first] = read_axis(reader, axes, turns[i], d.angular[i - first], true);
}

/// Frames from "frame_a" and "frame_b", or from anchors and an axis in the world.
template <class D>
class FrameReader {
 public:
  FrameReader(Reader& reader, const World<D>& world, const Object& o, int type)
      : reader_(reader), world_(world), o_(o), type_(type) {}

  void read(JointFrames<D>& out) {
    const bool framed_a = o_.has("frame_a"), framed_b = o_.has("frame_b");
    if (framed_a) out.frame_a = frame("frame_a");
    if (framed_b) out.frame_b = frame("frame_b");
    if (!framed_a && type_ == path_joint)
      out.frame_a = of_world(out.body_a);
    else if (!framed_a && type_ != mouse_joint)
      out.frame_a = anchored(out.body_a, "anchor_a");
    if (!framed_b) out.frame_b = anchored(out.body_b, "anchor_b");
  }

 private:
  typename D::Transform frame(const char* key) {
    typename D::Transform t{};
    Object f;
    if (!reader_.open(*o_.find(key), o_.path_of(key), *tables().frame, f)) return t;
    t.p = vector_for(reader_.vector(f, "position"), static_cast<D*>(nullptr));
    t.q = rotation_for(reader_, f, "rotation", static_cast<D*>(nullptr));
    return t;
  }
  /// The world's axes in a body.
  typename D::Transform of_world(BodyId body) {
    typename D::Transform t{};
    const Result<BodyState<D>> state = world_.state(body);
    if (!reader_.accept(state.ok() ? Status{} : Status{state.error()}, *o_.node, o_.path)) return t;
    t.p = math::local_point(state->pose, typename D::Position{});
    t.q = math::normalize(math::conjugate(state->pose.rotation) * typename D::Rotation{});
    return t;
  }
  typename D::Transform anchored(BodyId body, const char* key) {
    typename D::Transform t{};
    const bool anchored = o_.has("anchor") || o_.has(key);
    if (!anchored && !needs_no_anchor(type_)) {
      reader_.fail(*o_.node, o_.path, std::string("the joint needs the key \"anchor\", ") + quote(key) + " or a frame");
    }
    if (reader_.failed()) return t;
    const Result<BodyState<D>> state = world_.state(body);
    if (!reader_.accept(state.ok() ? Status{} : Status{state.error()}, *o_.node, o_.path)) return t;
    const math::Vec3d point = o_.has(key) ? reader_.vector(o_, key) : reader_.vector(o_, "anchor");
    if (anchored) t.p = math::local_point(state->pose, position_of(point, static_cast<D*>(nullptr)));
    if (!anchored && type_ == motor_joint) return t;
    if (type_ == path_joint && !o_.has("axis")) return t;
    const bool rack = type_ == rack_joint && key[7] == 'b';
    const char* const name = rack ? "slide_axis" : "axis";
    const math::Vec3d unit = rack || along_x(type_) ? math::Vec3d{1, 0, 0} : math::Vec3d{0, 0, 1};
    const bool turned = o_.has(name) && (D::dimension == 3 || rack || type_ == slider_joint || type_ == path_joint);
    if (rack && !turned) reader_.fail(*o_.node, o_.path, "the rack needs the key \"slide_axis\" or \"frame_b\"");
    const math::Vec3d axis = turned ? math::normalize(reader_.vector(o_, name)) : unit;
    if (!reader_.failed() && axis == math::Vec3d{})
      reader_.fail(*o_.find(name), o_.path_of(name), "the axis has no direction");
    using Rotation = typename D::Rotation;
    const Rotation world_rotation = turned ? Rotation(onto_axis(axis, unit, static_cast<D*>(nullptr))) : Rotation{};
    t.q = math::normalize(math::conjugate(state->pose.rotation) * world_rotation);
    return t;
  }

  Reader& reader_;
  const World<D>& world_;
  const Object& o_;
  int type_;
};

BodyId named_body(Reader& reader, BodyNames& names, const Object& o, const char* key) {
  const std::string name = reader.text(o, key);
  if (reader.failed()) return {};
  return names.find_body(*o.find(key), o.path_of(key), name);
}

}  // namespace

template <class D>
bool read_joint(Reader& reader, BodyNames& names, const World<D>& world, const Object& o, ReadJoint<D>& out) {
  const int type = reader.choice(o, "type", 0);
  if (reader.failed()) return false;
  JointFrames<D> frames;
  for (const char* key : {"body_a", "body_b"}) {
    if (type == mouse_joint && key[5] == 'a') continue;
    if (!o.has(key))
      return reader.fail(*o.node, o.path, std::string("the key ") + quote(key) + " is missing in a joint"), false;
    (key[5] == 'a' ? frames.body_a : frames.body_b) = named_body(reader, names, o, key);
  }
  if (reader.failed()) return false;
  frames.collide_connected = reader.flag(o, "collide_connected", false);
  FrameReader<D>(reader, world, o, type).read(frames);
  frames.break_force = float(reader.number(o, "break_force", 0));
  frames.break_torque = float(reader.number(o, "break_torque", 0));
  const bool angular = type == hinge_joint;
  const bool wheel = type == wheel_joint;
  out.has_spring = !wheel && o.has("spring");
  out.has_limit = !wheel && o.has("limit");
  out.has_motor = !wheel && o.has("motor");
  out.spring = read_spring(reader, o, "spring", type == mouse_joint ? JointSpring{5, 1} : JointSpring{});
  out.limit = read_limit(reader, o, "limit", angular ? Measure::angle : Measure::length);
  out.motor = read_motor(reader, o, angular || wheel);
  switch (type) {
    case distance_joint: {
      DistanceJointDef<D> d{frames};
      d.spring = out.spring;
      d.limit = out.limit;
      d.motor = out.motor;
      d.rope = reader.flag(o, "rope", false);
      if (o.has("length")) {
        d.length = float(reader.number(o, "length", 1));
      } else if (!reader.failed()) {
        const auto a = world.state(frames.body_a), b = world.state(frames.body_b);
        if (a.ok() && b.ok())
          d.length = float(math::distance(math::world_point(a->pose, frames.frame_a.p),
                                          math::world_point(b->pose, frames.frame_b.p)));
      }
      if (d.rope && !out.has_limit) d.limit = {true, 0, d.length};
      out.definition = d;
      break;
    }
    case ball_joint: {
      BallJointDef<D> d{frames};
      d.spring = out.spring;
      if (o.has("target_rotation"))
        d.target_rotation = rotation_for(reader, o, "target_rotation", static_cast<D*>(nullptr));
      d.cone_angle = float(reader.number(o, "cone_angle", d.cone_angle));
      d.twist = read_limit(reader, o, "twist", Measure::angle);
      d.friction_torque = float(reader.number(o, "friction_torque", 0));
      out.definition = d;
      break;
    }
    case hinge_joint: {
      HingeJointDef<D> d{frames};
      d.spring = out.spring;
      d.target_angle = float(reader.number(o, "target_angle", 0));
      d.max_spring_torque = float(reader.number(o, "max_spring_torque", 0));
      d.limit = out.limit;
      d.motor = out.motor;
      out.definition = d;
      break;
    }
    case slider_joint: {
      SliderJointDef<D> d{frames};
      d.spring = out.spring;
      d.target_translation = float(reader.number(o, "target_translation", 0));
      d.max_spring_force = float(reader.number(o, "max_spring_force", 0));
      d.limit = out.limit;
      d.motor = out.motor;
      out.definition = d;
      break;
    }
    case weld_joint: {
      WeldJointDef<D> d{frames};
      d.linear = read_spring(reader, o, "linear_spring", d.linear);
      d.angular = read_spring(reader, o, "angular_spring", d.angular);
      out.definition = d;
      break;
    }
    case motor_joint: {
      MotorJointDef<D> d{frames};
      d.linear = read_spring(reader, o, "linear_spring", d.linear);
      d.angular = read_spring(reader, o, "angular_spring", d.angular);
      d.max_force = float(reader.number(o, "max_force", d.max_force));
      d.max_torque = float(reader.number(o, "max_torque", d.max_torque));
      d.target_position = vector_for(reader.vector(o, "target_position"), static_cast<D*>(nullptr));
      if (o.has("target_rotation"))
        d.target_rotation = rotation_for(reader, o, "target_rotation", static_cast<D*>(nullptr));
      d.target_velocity = vector_for(reader.vector(o, "target_velocity"), static_cast<D*>(nullptr));
      d.target_spin = angular_for(reader.angular(o, "target_spin"), static_cast<D*>(nullptr));
      d.hold_position = reader.flag(o, "hold_position", true);
      d.hold_rotation = reader.flag(o, "hold_rotation", true);
      out.definition = d;
      break;
    }
    case generic_joint:
    case cylindrical_joint:
    case planar_joint:
    case universal_joint:
    case wheel_joint: {
      GenericJointDef<D> d{frames, {}, {}};
      if (wheel) {
        d = make_wheel_joint<D>(frames, out.spring, out.limit);
        d.angular[D::dimension == 2 ? 0 : 2].motor = out.motor;
      } else if constexpr (D::dimension == 3) {
        if (type == cylindrical_joint) d = make_cylindrical_joint<D>(frames);
        if (type == planar_joint) d = make_planar_joint<D>(frames);
        if (type == universal_joint) d = make_universal_joint<D>(frames);
      } else if (type != generic_joint) {
        reader.fail(*o.find("type"), o.path_of("type"), "this joint is for space, expected another type in the plane");
      }
      read_axes<D>(reader, o, d);
      out.definition = d;
      break;
    }
    case gear_joint: {
      GearJointDef<D> d{frames};
      d.ratio = float(reader.number(o, "ratio", d.ratio));
      out.definition = d;
      break;
    }
    case rack_joint: {
      RackJointDef<D> d{frames};
      d.radius = float(reader.number(o, "radius", d.radius));
      out.definition = d;
      break;
    }
    case screw_joint: {
      ScrewJointDef<D> d{frames};
      d.pitch = float(reader.number(o, "pitch", d.pitch));
      out.definition = d;
      break;
    }
    case path_joint: {
      PathJointDef<D> d{frames};
      for (const math::Vec3d& p : reader.points(o, "points"))
        out.points.push_back(vector_for(p, static_cast<D*>(nullptr)));
      for (const math::Vec3d& t : reader.points(o, "tangents"))
        out.tangents.push_back(vector_for(t, static_cast<D*>(nullptr)));
      d.points = out.points;
      d.tangents = out.tangents;
      d.straight = reader.flag(o, "straight", false);
      d.closed = reader.flag(o, "closed", false);
      d.follow = reader.flag(o, "follow", false);
      d.spring = out.spring;
      d.target_distance = float(reader.number(o, "target_distance", 0));
      d.max_spring_force = float(reader.number(o, "max_spring_force", 0));
      d.limit = out.limit;
      d.motor = out.motor;
      d.friction = float(reader.number(o, "friction", 0));
      out.definition = d;
      break;
    }
    case pulley_joint: {
      PulleyJointDef<D> d{frames};
      for (const char* key : {"ground_a", "ground_b"})
        if (!o.has(key))
          reader.fail(*o.node, o.path, std::string("the key ") + quote(key) + " is missing in a pulley joint");
      d.ground_a = position_of(reader.vector(o, "ground_a"), static_cast<D*>(nullptr));
      d.ground_b = position_of(reader.vector(o, "ground_b"), static_cast<D*>(nullptr));
      d.ratio = float(reader.number(o, "ratio", d.ratio));
      if (o.has("length")) {
        d.length = float(reader.number(o, "length", 1));
      } else if (!reader.failed()) {
        const auto a = world.state(frames.body_a), b = world.state(frames.body_b);
        if (a.ok() && b.ok())
          d.length = float(math::distance(math::world_point(a->pose, frames.frame_a.p), d.ground_a) +
                           double(d.ratio) * math::distance(math::world_point(b->pose, frames.frame_b.p), d.ground_b));
      }
      out.definition = d;
      break;
    }
    default: {
      MouseJointDef<D> d{frames};
      if (!o.has("target")) reader.fail(*o.node, o.path, "the key \"target\" is missing in a mouse joint");
      d.target = position_of(reader.vector(o, "target"), static_cast<D*>(nullptr));
      d.spring = out.spring;
      d.max_force = float(reader.number(o, "max_force", d.max_force));
      out.definition = d;
    }
  }
  return !reader.failed();
}

namespace {

template <class D>
EffectorDef<D> read_effector_of(Reader& reader, BodyNames& names, const Object& o, World<D>* world, int type) {
  D* const d = nullptr;
  EffectorTarget target;
  if (o.has("body")) target.body = named_body(reader, names, o, "body");
  switch (type) {
    case 0: {
      SphericalGravity<D> e{target};
      e.center = position_of(reader.vector(o, "center"), d);
      e.gm = reader.number(o, "gm", e.gm);
      e.minimum_radius = reader.number(o, "minimum_radius", e.minimum_radius);
      return e;
    }
    case 1: {
      LinearDrag<D> e{target};
      e.coefficient = reader.number(o, "coefficient", 0);
      e.angular_coefficient = reader.number(o, "angular_coefficient", 0, Measure::angular_damping);
      return e;
    }
    case 2: {
      QuadraticDrag<D> e{target};
      e.density = reader.number(o, "density", e.density);
      e.drag_coefficient = reader.number(o, "drag_coefficient", e.drag_coefficient);
      e.area = reader.number(o, "area", e.area);
      e.point = vector_for(reader.vector(o, "point"), d);
      e.angular_coefficient = reader.number(o, "angular_coefficient", 0, Measure::quadratic_angular_damping);
      return e;
    }
    case 3:
      return rigid::Wind<D>{vector_for(reader.vector(o, "velocity"), d)};
    case 4: {
      SpringDamper<D> e;
      if (!o.has("body_a"))
        reader.fail(*o.node, o.path, "the key \"body_a\" is missing in a spring");
      else
        e.body_a = named_body(reader, names, o, "body_a");
      if (o.has("body_b")) e.body_b = named_body(reader, names, o, "body_b");
      e.point_a = vector_for(reader.vector(o, "point_a"), d);
      e.point_b = position_of(reader.vector(o, "point_b"), d);
      e.rest_length = reader.number(o, "rest_length", e.rest_length);
      e.stiffness = reader.number(o, "stiffness", e.stiffness);
      e.damping = reader.number(o, "damping", e.damping);
      e.break_force = reader.number(o, "break_force", e.break_force);
      return e;
    }
    case 5: {
      Buoyancy<D> e;
      e.body = target.body;
      e.density = reader.number(o, "density", e.density);
      e.level = reader.number(o, "level", e.level);
      e.linear_drag = reader.number(o, "linear_drag", 0);
      e.angular_drag = reader.number(o, "angular_drag", 0);
      e.current = vector_for(reader.vector(o, "current"), d);
      e.added_mass = vector_for(reader.vector(o, "added_mass"), d);
      e.added_inertia = angular_for(reader.angular(o, "added_inertia"), d);
      const Node* waves = o.find("waves");
      if (waves == nullptr) return e;
      const std::string path = o.path_of("waves");
      if (!waves->is_array() || waves->children.size() > 4) {
        reader.expected(*waves, path, "a list of at most four waves");
        return e;
      }
      for (std::size_t i = 0; i < waves->children.size(); ++i) {
        Object w;
        if (!reader.open(waves->children[i], index_path(path, i), *tables().wave, w)) return e;
        e.waves[i].amplitude = reader.number(w, "amplitude", 0);
        e.waves[i].wavelength = reader.number(w, "wavelength", 10);
        e.waves[i].phase = reader.number(w, "phase", 0);
        ++e.wave_count;
      }
      return e;
    }
    case 6: {
      Thrust<D> e{target};
      e.point = vector_for(reader.vector(o, "point"), d);
      e.force = vector_for(reader.vector(o, "force"), d);
      return e;
    }
    case 7: {
      RadialField<D> e{target};
      e.center = position_of(reader.vector(o, "center"), d);
      e.strength = reader.number(o, "strength", e.strength);
      e.reference = reader.number(o, "reference", e.reference);
      e.exponent = reader.number(o, "exponent", e.exponent);
      e.range = reader.number(o, "range", e.range);
      return e;
    }
    case 9: {
      BodyDrag<D> e{target};
      e.law.kind = forces::DragLaw::Kind(reader.choice(o, "law", int(e.law.kind)));
      e.law.coefficient = reader.number(o, "drag_coefficient", e.law.coefficient);
      if (o.has("table")) {
        const std::vector<double> table = reader.numbers(o, "table");
        const std::size_t most = 2 * forces::CoefficientTable::capacity;
        if (!reader.failed() && (table.empty() || table.size() % 2 != 0 || table.size() > most))
          reader.expected(*o.find("table"), o.path_of("table"), "up to 1024 pairs of x and C_d, one after another");
        std::vector<forces::CoefficientPoint> points;
        for (std::size_t i = 0; i + 1 < table.size() && i < most; i += 2) points.push_back({table[i], table[i + 1]});
        e.law.table = forces::CoefficientTable(std::move(points), reader.flag(o, "logarithmic", false));
      }
      e.diameter = reader.number(o, "diameter", e.diameter);
      e.area = reader.number(o, "area", 0.25 * math::pi * e.diameter * e.diameter);
      e.point = vector_for(reader.vector(o, "point"), d);
      e.density = reader.number(o, "density", e.density);
      e.viscosity = reader.number(o, "viscosity", e.viscosity);
      e.speed_of_sound = reader.number(o, "speed_of_sound", e.speed_of_sound);
      return e;
    }
    case 10: {
      MagnusLift<D> e{target};
      constexpr forces::LiftLaw balls[] = {forces::rough_ball_lift, forces::baseball_lift, forces::tennis_lift};
      e.law = balls[reader.choice(o, "ball", 0)];
      if (o.has("lift")) {
        const std::vector<double> lift = reader.numbers(o, "lift", 2);
        if (lift.size() == 2) e.law = {lift[0], lift[1]};
      }
      e.radius = reader.number(o, "radius", e.radius);
      e.density = reader.number(o, "density", e.density);
      return e;
    }
    case 11: {
      TurningFrame<D> e{target};
      e.rate = angular_for(reader.angular(o, "angular_velocity"), d);
      if (o.has("latitude")) {
        if (o.has("angular_velocity"))
          reader.fail(*o.node, o.path, "found both angular_velocity and latitude, expected one of them");
        const math::Vec3d rate =
            environment::earth_rate(reader.number(o, "latitude", 0), reader.number(o, "bearing", 0.5 * math::pi));
        e.rate = angular_for(rate, d);
      }
      e.center = position_of(reader.vector(o, "center"), d);
      e.centrifugal = reader.flag(o, "centrifugal", false);
      return e;
    }
    case 12: {
      ElectromagneticField<D> e{target};
      e.charge = reader.number(o, "charge", 0);
      e.electric = vector_for(reader.vector(o, "electric"), d);
      e.magnetic = math::Vec3f(reader.angular(o, "magnetic"));
      return e;
    }
    case 15: {
      LiftingSurface<D> e;
      e.body = target.body;
      e.law.aspect_ratio = reader.number(o, "aspect_ratio", e.law.aspect_ratio);
      e.law.zero_lift_angle = reader.number(o, "zero_lift_angle", e.law.zero_lift_angle);
      e.law.stall_angle = reader.number(o, "stall_angle", e.law.stall_angle);
      e.law.profile_drag = reader.number(o, "profile_drag", e.law.profile_drag);
      e.law.efficiency = reader.number(o, "efficiency", e.law.efficiency);
      e.point = vector_for(reader.vector(o, "point"), d);
      e.forward = vector_for(reader.vector(o, "forward", {1, 0, 0}), d);
      if (D::dimension == 3) e.up = math::Vec3f(reader.vector(o, "up", {0, 1, 0}));
      e.area = reader.number(o, "area", e.area);
      e.chord = reader.number(o, "chord", e.chord);
      e.density = reader.number(o, "density", e.density);
      return e;
    }
    case 16: {
      CylinderDrag<D> e;
      e.body = target.body;
      e.point = vector_for(reader.vector(o, "point"), d);
      e.axis = vector_for(reader.vector(o, "axis", {1, 0, 0}), d);
      e.diameter = reader.number(o, "diameter", e.diameter);
      e.length = reader.number(o, "length", e.length);
      e.density = reader.number(o, "density", e.density);
      e.viscosity = reader.number(o, "viscosity", e.viscosity);
      return e;
    }
    case 17:
      return read_force_field<D>(reader, o, target.body);
    case 13:
      return read_projectile<D>(reader, o, target.body);
    case 14:
      return read_ball_flight<D>(reader, o, target.body, world);
    default: {
      VortexField<D> e{target};
      e.center = position_of(reader.vector(o, "center"), d);
      if (D::dimension == 3) e.axis = math::Vec3f(reader.vector(o, "axis", {0, 1, 0}));
      e.circulation = reader.number(o, "circulation", e.circulation);
      e.core_radius = reader.number(o, "core_radius", e.core_radius);
      e.rate = reader.number(o, "rate", e.rate);
      return e;
    }
  }
}

}  // namespace

template <class D>
bool read_effector(Reader& reader, BodyNames& names, const Object& o, World<D>* world, EffectorDef<D>& out) {
  const int type = reader.choice(o, "type", 0);
  if (reader.failed()) return false;
  out = read_effector_of<D>(reader, names, o, world, type);
  return !reader.failed();
}

template bool read_joint<Dim2>(Reader&, BodyNames&, const World<Dim2>&, const Object&, ReadJoint<Dim2>&);
template bool read_joint<Dim3>(Reader&, BodyNames&, const World<Dim3>&, const Object&, ReadJoint<Dim3>&);
template bool read_effector<Dim2>(Reader&, BodyNames&, const Object&, World<Dim2>*, EffectorDef<Dim2>&);
template bool read_effector<Dim3>(Reader&, BodyNames&, const Object&, World<Dim3>*, EffectorDef<Dim3>&);

}  // namespace carom::scene::detail
