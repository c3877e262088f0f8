#include "carom/scene/write_scene.h"

#include <map>
#include <set>

#include "carom/scene/destruction.h"
#include "carom/scene/detail/environment.h"
#include "carom/scene/detail/text.h"

namespace carom::scene {
namespace {
using namespace rigid;
using namespace detail;

geometry::MassProperties2 mass_of(const World2& w, BodyId b) { return w.mass_properties2(b).value_or({}); }
geometry::MassProperties3 mass_of(const World3& w, BodyId b) { return w.mass_properties3(b).value_or({}); }
bool same_mass(const geometry::MassProperties2& a, const geometry::MassProperties2& b) {
  return a.mass == b.mass && a.center == b.center && a.inertia == b.inertia;
}
bool same_mass(const geometry::MassProperties3& a, const geometry::MassProperties3& b) {
  return a.mass == b.mass && a.center == b.center && a.inertia == b.inertia;
}
std::string inertia_text(double i) { return digits(i); }
std::string inertia_text(const math::Mat3d& i) {
  std::string out = "[" + digits(i(0, 0)) + ", " + digits(i(1, 1)) + ", " + digits(i(2, 2));
  if (i(0, 1) != 0 || i(0, 2) != 0 || i(1, 2) != 0)
    out += ", " + digits(i(0, 1)) + ", " + digits(i(0, 2)) + ", " + digits(i(1, 2));
  return out + "]";
}

template <class D>
class SceneWriter {
 public:
  SceneWriter(const World<D>& world, const WriteOptions& options, std::span<const SceneBody> names,
              const Destruction* destruction = nullptr)
      : world_(world), options_(options), destruction_(destruction) {
    for (const SceneBody& n : names)
      if (!n.name.empty()) given_.emplace(n.id.packed(), &n);
  }

  Result<std::string> write() {
    const WorldDef<D>& def = world_.definition();
    std::string out = "{\n  \"name\": " + quote(options_.name) + ",\n";
    if (!options_.description.empty()) out += "  \"description\": " + quote(options_.description) + ",\n";
    out += "  \"dimension\": " + std::to_string(D::dimension) + ",\n  \"step\": " + digits(options_.dt) +
           ",\n  \"substeps\": " + std::to_string(def.substeps) + ",\n  \"duration\": " + digits(options_.duration) +
           ",\n  \"gravity\": " + vector_text(def.gravity) + ",\n  \"world\": " + world_text() + ",\n  \"bodies\": [";
    std::vector<BodyId> bodies;
    world_.bodies(bodies);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::string body = body_text(bodies[i], i);
      if (failed_) return error_;
      out += (i == 0 ? "\n    " : ",\n    ") + body;
    }
    out += "\n  ],\n  \"joints\": [";
    std::vector<JointId> joints;
    world_.joints(joints);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const Result<AnyJointDef<D>> d = world_.joint_definition(joints[i]);
      if (!d) return d.error();
      out += (i == 0 ? "\n    " : ",\n    ") + std::visit([this](const auto& j) { return this->joint_text(j); }, *d);
    }
    out += "\n  ],\n  \"effectors\": [";
    std::vector<EffectorId> effectors;
    world_.effectors(effectors);
    bool first = true;
    std::string environment;
    for (const EffectorId id : effectors) {
      const Result<EffectorDef<D>> d = world_.effector_definition(id);
      if (!d) return d.error();
      if (std::holds_alternative<CustomEffector<D>>(*d)) continue;
      if (const auto* around = std::get_if<Surroundings<D>>(&*d)) {  // the last one counts
        environment = environment_text(*around->environment, D::dimension);
        continue;
      }
      out += (first ? "\n    " : ",\n    ") + std::visit([this](const auto& e) { return this->effector_text(e); }, *d);
      first = false;
    }
    out += "\n  ]";
    if (!environment.empty()) out += ",\n  \"environment\": " + environment;
    if (const std::string charges = explosions_text(); !charges.empty())
      out += ",\n  \"explosions\": [" + charges + "]";
    return out + "\n}\n";
  }

 private:
  std::string world_text() const {
    const WorldDef<D>& d = world_.definition();
    Fields f;
    f.put("restitution_threshold", d.restitution_threshold).put("contact_frequency", d.contact_hertz);
    f.put("contact_damping_ratio", d.contact_damping_ratio).put("contact_push_speed", d.contact_push_speed);
    f.put("joint_frequency", d.joint_hertz).put("joint_damping_ratio", d.joint_damping_ratio);
    constexpr const char* solvers[] = {"automatic", "iterative", "direct"};
    if (d.joint_solver != JointSolver::automatic) f.put("joint_solver", quote(solvers[int(d.joint_solver)]));
    f.put("maximum_linear_speed", d.maximum_linear_speed).put("sleep_time", d.sleep_time);
    f.flag("allow_sleep", d.allow_sleep, true).flag("continuous", d.continuous, true);
    std::vector<MaterialPair> pairs;
    world_.pair_rules(pairs);
    std::string list;
    for (const MaterialPair& pair : pairs) {
      Fields p;
      p.put("materials", "[" + std::to_string(pair.material_a) + ", " + std::to_string(pair.material_b) + "]");
      p.put("friction", pair.rule.friction).put("restitution", pair.rule.restitution);
      p.unless("static_friction", pair.rule.static_friction, 0.0f);
      p.unless("rolling_resistance", pair.rule.rolling_resistance, 0.0f);
      p.unless("spinning_resistance", pair.rule.spinning_resistance, 0.0f);
      list += (list.empty() ? "" : ", ") + p.object();
    }
    if (!list.empty()) f.put("material_pairs", "[" + list + "]");
    return f.object();
  }

  std::string name_of(BodyId id, std::string_view own, std::size_t index) {
    const auto given = given_.find(id.packed());
    std::string name = given != given_.end() ? given->second->name : std::string(own);
    if (name.empty()) name = "body_" + std::to_string(index);
    while (!used_.insert(name).second) name += "_";
    return name;
  }

  std::string body_text(BodyId id, std::size_t index) {
    const Result<BodyDef<D>> found = world_.body_definition(id);
    if (!found) return failed_ = true, error_ = found.error(), std::string();
    const BodyDef<D>& d = *found;
    const BodyDef<D> fallback;
    // Joints name what is no body "world".
    const std::string name = name_of(id, d.name == "world" && d.type != BodyType::fixed ? "world_" : d.name, index);
    names_.emplace(id.packed(), name);
    constexpr const char* types[] = {"fixed", "kinematic", "dynamic"};
    Fields f;
    f.put("name", quote(name)).put("type", quote(types[int(d.type)])).put("position", vector_text(d.position));
    f.put("rotation", rotation_text(d.rotation)).put("velocity", vector_text(d.linear_velocity));
    f.put("angular_velocity", angular_text(d.angular_velocity));
    f.unless("linear_damping", d.linear_damping, 0.0f).unless("angular_damping", d.angular_damping, 0.0f);
    f.unless("gravity_scale", d.gravity_scale, 1.0f).unless("sleep_speed", d.sleep_speed, fallback.sleep_speed);
    f.unless("time_scale", d.time_scale, 1.0f);
    if (d.substeps != 0) f.put("substeps", double(d.substeps));
    put_locks(d.locks, f);
    f.flag("awake", d.awake, true)
        .flag("allow_sleep", d.allow_sleep, true)
        .flag("bullet", d.bullet, false)
        .flag("enabled", d.enabled, true);
    if (d.user_data != 0) f.put("user_data", bits_text(d.user_data));
    if (const auto given = given_.find(id.packed()); given != given_.end()) {
      if (given->second->colored) f.put("color", quote(color_text(given->second->color)));
      f.flag("trail", given->second->trail, false);
    }
    put_shapes(id, d, f);
    return f.object();
  }

  static void put_locks(const MotionLocks& l, Fields& f) {
    std::string list;
    const std::pair<bool, const char*> all[] = {{l.x, "x"},
                                                {l.y, "y"},
                                                {l.z, "z"},
                                                {l.rotation_x, "rotation_x"},
                                                {l.rotation_y, "rotation_y"},
                                                {l.rotation_z, "rotation_z"}};
    for (const auto& [locked, name] : all)
      if (locked) list += (list.empty() ? "" : ", ") + quote(name);
    if (!list.empty()) f.put("locks", "[" + list + "]");
  }

  void put_shapes(BodyId id, BodyDef<D> d, Fields& f) {
    // A copy in an empty world shows what mass the shapes alone give; only another one needs to be written.
    d.awake = true;
    d.name = {};
    const Result<BodyId> copy = scratch_.create_body(d);
    std::vector<ShapeId> shapes;
    world_.shapes(id, shapes);
    std::string list;
    for (const ShapeId s : shapes) {
      const Result<typename D::Shape> shape = world_.shape_geometry(s);
      const Result<ShapeDef<D>> definition = world_.shape_definition(s);
      if (!shape || !definition) continue;
      list += (list.empty() ? "" : ", ") + shape_text<D>(*shape, *definition);
      if (copy) (void)scratch_.add_shape(*copy, *shape, *definition);
    }
    if (!list.empty()) f.put("shapes", "[" + list + "]");
    const typename D::MassProperties alone = copy ? mass_of(scratch_, *copy) : typename D::MassProperties{};
    if (copy) (void)scratch_.destroy_body(*copy);
    const typename D::MassProperties now = mass_of(world_, id);
    if (d.type != BodyType::dynamic || !(now.mass > 0) || same_mass(now, alone)) return;
    Fields m;
    m.put("mass", now.mass).put("center", vector_text(now.center)).put("inertia", inertia_text(now.inertia));
    f.put("mass_properties", m.object());
  }

  std::string quoted_name(BodyId id) const {
    if (id.is_null()) return quote("world");
    const auto found = names_.find(id.packed());
    return quote(found == names_.end() ? "" : found->second);
  }
  Fields joint_fields(const char* type, const JointFrames<D>& j, bool with_a = true) const {
    const auto frame = [](const typename D::Transform& t) {
      return Fields().put("position", vector_text(t.p)).put("rotation", rotation_text(t.q)).object();
    };
    Fields f;
    f.put("type", quote(type));
    if (with_a) f.put("body_a", quoted_name(j.body_a)).put("frame_a", frame(j.frame_a));
    f.put("body_b", quoted_name(j.body_b)).put("frame_b", frame(j.frame_b));
    f.unless("break_force", j.break_force, 0.0f).unless("break_torque", j.break_torque, 0.0f);
    return f.flag("collide_connected", j.collide_connected, false);
  }
  static std::string spring_text(const JointSpring& s) {
    return Fields().put("frequency", s.hertz).put("damping_ratio", s.damping_ratio).object();
  }
  static std::string limit_text(const JointLimit& l) {
    return Fields().put("lower", l.lower).put("upper", l.upper).flag("enabled", l.enabled, true).object();
  }
  static std::string motor_text(const JointMotor& m, bool angular) {
    return Fields()
        .put("speed", m.speed)
        .put(angular ? "max_torque" : "max_force", m.max_force)
        .flag("enabled", m.enabled, true)
        .object();
  }
  static void put_drive(Fields& f, const JointSpring& s, const JointLimit& l, const JointMotor& m, bool angular) {
    if (!(s == JointSpring{})) f.put("spring", spring_text(s));
    if (!(l == JointLimit{})) f.put("limit", limit_text(l));
    if (!(m == JointMotor{})) f.put("motor", motor_text(m, angular));
  }

  std::string joint_text(const DistanceJointDef<D>& j) const {
    Fields f = joint_fields("distance", j);
    f.put("length", j.length).flag("rope", j.rope, false);
    put_drive(f, j.spring, j.limit, j.motor, false);
    return f.object();
  }
  std::string joint_text(const BallJointDef<D>& j) const {
    Fields f = joint_fields("ball", j);
    if (!(j.target_rotation == typename D::Rotation{})) f.put("target_rotation", rotation_text(j.target_rotation));
    f.unless("cone_angle", j.cone_angle, -1.0f).unless("friction_torque", j.friction_torque, 0.0f);
    if (!(j.spring == JointSpring{})) f.put("spring", spring_text(j.spring));
    if (!(j.twist == JointLimit{})) f.put("twist", limit_text(j.twist));
    return f.object();
  }
  std::string joint_text(const HingeJointDef<D>& j) const {
    Fields f = joint_fields("hinge", j);
    f.unless("target_angle", j.target_angle, 0.0f).unless("max_spring_torque", j.max_spring_torque, 0.0f);
    put_drive(f, j.spring, j.limit, j.motor, true);
    return f.object();
  }
  std::string joint_text(const SliderJointDef<D>& j) const {
    Fields f = joint_fields("slider", j);
    f.unless("target_translation", j.target_translation, 0.0f).unless("max_spring_force", j.max_spring_force, 0.0f);
    put_drive(f, j.spring, j.limit, j.motor, false);
    return f.object();
  }
  std::string joint_text(const WeldJointDef<D>& j) const {
    return joint_fields("weld", j)
        .put("linear_spring", spring_text(j.linear))
        .put("angular_spring", spring_text(j.angular))
        .object();
  }
  std::string joint_text(const MotorJointDef<D>& j) const {
    Fields f = joint_fields("motor", j);
    f.put("linear_spring", spring_text(j.linear)).put("angular_spring", spring_text(j.angular));
    using V = typename D::Vector;
    if (!(j.target_position == V{})) f.put("target_position", vector_text(j.target_position));
    if (!(j.target_rotation == typename D::Rotation{})) f.put("target_rotation", rotation_text(j.target_rotation));
    if (!(j.target_velocity == V{})) f.put("target_velocity", vector_text(j.target_velocity));
    if (!(j.target_spin == typename D::Angular{})) f.put("target_spin", angular_text(j.target_spin));
    f.flag("hold_position", j.hold_position, true).flag("hold_rotation", j.hold_rotation, true);
    return f.put("max_force", j.max_force).put("max_torque", j.max_torque).object();
  }
  std::string joint_text(const MouseJointDef<D>& j) const {
    Fields f = joint_fields("mouse", j, false);
    return f.put("target", vector_text(j.target))
        .put("spring", spring_text(j.spring))
        .put("max_force", j.max_force)
        .object();
  }

  static std::string axis_text(const JointAxis& a, bool angular) {
    Fields f;
    if (!(a.limit == JointLimit{})) f.put("limit", limit_text(a.limit));
    if (!(a.spring == JointSpring{})) f.put("spring", spring_text(a.spring));
    if (!(a.motor == JointMotor{})) f.put("motor", motor_text(a.motor, angular));
    f.unless("target", a.target, 0.0f);
    f.unless(angular ? "max_spring_torque" : "max_spring_force", a.max_spring_force, 0.0f);
    f.unless(angular ? "friction_torque" : "friction", a.friction, 0.0f);
    return f.flag("free", a.free, true).object();
  }
  std::string joint_text(const GenericJointDef<D>& j) const {
    Fields axes;
    constexpr const char* lines[] = {"x", "y", "z"};
    constexpr const char* turns[] = {"turn_x", "turn_y", "turn_z"};
    constexpr int first = D::dimension == 2 ? 2 : 0;
    for (int i = 0; i < D::dimension; ++i)
      if (!(j.linear[i] == JointAxis{})) axes.put(lines[i], axis_text(j.linear[i], false));
    for (int i = first; i < 3; ++i)
      if (!(j.angular[i - first] == JointAxis{})) axes.put(turns[i], axis_text(j.angular[i - first], true));
    return joint_fields("generic", j).put("axes", axes.object()).object();
  }
  std::string joint_text(const GearJointDef<D>& j) const {
    return joint_fields("gear", j).put("ratio", j.ratio).object();
  }
  std::string joint_text(const RackJointDef<D>& j) const {
    return joint_fields("rack", j).put("radius", j.radius).object();
  }
  std::string joint_text(const ScrewJointDef<D>& j) const {
    return joint_fields("screw", j).put("pitch", j.pitch).object();
  }
  std::string joint_text(const PulleyJointDef<D>& j) const {
    return joint_fields("pulley", j)
        .put("ground_a", vector_text(j.ground_a))
        .put("ground_b", vector_text(j.ground_b))
        .put("length", j.length)
        .put("ratio", j.ratio)
        .object();
  }

  static std::string points_text(std::span<const typename D::Vector> points) {
    std::string text;
    for (const auto& p : points) text += (text.empty() ? "" : ", ") + vector_text(p);
    return "[" + text + "]";
  }
  std::string joint_text(const PathJointDef<D>& j) const {
    Fields f = joint_fields("path", j);
    f.put("points", points_text(j.points));
    if (!j.tangents.empty()) f.put("tangents", points_text(j.tangents));
    f.flag("straight", j.straight, false).flag("closed", j.closed, false).flag("follow", j.follow, false);
    f.unless("target_distance", j.target_distance, 0.0f).unless("max_spring_force", j.max_spring_force, 0.0f);
    f.unless("friction", j.friction, 0.0f);
    put_drive(f, j.spring, j.limit, j.motor, false);
    return f.object();
  }

  Fields effector_fields(const char* type, BodyId body = {}) const {
    Fields f;
    f.put("type", quote(type));
    if (!body.is_null()) f.put("body", quoted_name(body));
    return f;
  }
  std::string effector_text(const SphericalGravity<D>& e) const {
    return effector_fields("spherical_gravity", e.body)
        .put("center", vector_text(e.center))
        .put("gm", e.gm)
        .put("minimum_radius", e.minimum_radius)
        .object();
  }
  std::string effector_text(const LinearDrag<D>& e) const {
    return effector_fields("linear_drag", e.body)
        .put("coefficient", e.coefficient)
        .put("angular_coefficient", e.angular_coefficient)
        .object();
  }
  std::string effector_text(const QuadraticDrag<D>& e) const {
    Fields f = effector_fields("quadratic_drag", e.body);
    f.put("density", e.density)
        .put("drag_coefficient", e.drag_coefficient)
        .put("area", e.area)
        .put("point", vector_text(e.point));
    return f.put("angular_coefficient", e.angular_coefficient).object();
  }
  std::string effector_text(const rigid::Wind<D>& e) const {
    return effector_fields("wind").put("velocity", vector_text(e.velocity)).object();
  }
  std::string effector_text(const SpringDamper<D>& e) const {
    Fields f = effector_fields("spring");
    f.put("body_a", quoted_name(e.body_a));
    if (!e.body_b.is_null()) f.put("body_b", quoted_name(e.body_b));
    f.put("point_a", vector_text(e.point_a)).put("point_b", vector_text(e.point_b)).put("rest_length", e.rest_length);
    return f.put("stiffness", e.stiffness).put("damping", e.damping).unless("break_force", e.break_force, 0.0).object();
  }
  std::string effector_text(const Buoyancy<D>& e) const {
    Fields f = effector_fields("buoyancy", e.body);
    f.put("density", e.density)
        .put("level", e.level)
        .put("linear_drag", e.linear_drag)
        .put("angular_drag", e.angular_drag);
    f.put("current", vector_text(e.current));
    if (e.added_mass != typename D::Vector{}) f.put("added_mass", vector_text(e.added_mass));
    if (e.added_inertia != typename D::Angular{}) f.put("added_inertia", angular_text(e.added_inertia));
    std::string waves;
    for (int i = 0; i < e.wave_count; ++i)
      waves += (i > 0 ? ", " : "") + Fields()
                                         .put("amplitude", e.waves[i].amplitude)
                                         .put("wavelength", e.waves[i].wavelength)
                                         .put("phase", e.waves[i].phase)
                                         .object();
    if (!waves.empty()) f.put("waves", "[" + waves + "]");
    return f.object();
  }
  std::string effector_text(const Thrust<D>& e) const {
    return effector_fields("thrust", e.body)
        .put("point", vector_text(e.point))
        .put("force", vector_text(e.force))
        .object();
  }
  std::string effector_text(const RadialField<D>& e) const {
    Fields f = effector_fields("radial_field", e.body);
    f.put("center", vector_text(e.center)).put("strength", e.strength).put("reference", e.reference);
    return f.put("exponent", e.exponent).put("range", e.range).object();
  }
  std::string effector_text(const VortexField<D>& e) const {
    Fields f = effector_fields("vortex_field", e.body);
    f.put("center", vector_text(e.center));
    if (D::dimension == 3) f.put("axis", vector_text(e.axis));
    return f.put("circulation", e.circulation).put("core_radius", e.core_radius).put("rate", e.rate).object();
  }
  std::string effector_text(const CustomEffector<D>&) const { return {}; }
  std::string effector_text(const Surroundings<D>&) const { return {}; }
  std::string effector_text(const BodyDrag<D>& e) const {
    constexpr const char* laws[] = {"constant", "sphere", "cylinder", "disc", "by_reynolds", "by_mach"};
    Fields f = effector_fields("body_drag", e.body);
    f.put("law", quote(laws[int(e.law.kind)])).put("drag_coefficient", e.law.coefficient);
    std::string table;
    for (const forces::CoefficientPoint& p : e.law.table.points())
      table += (table.empty() ? "" : ", ") + digits(p.x) + ", " + digits(p.y);
    if (!table.empty()) f.put("table", "[" + table + "]").flag("logarithmic", e.law.table.logarithmic(), false);
    f.put("diameter", e.diameter).put("area", e.area).put("point", vector_text(e.point)).put("density", e.density);
    return f.put("viscosity", e.viscosity).put("speed_of_sound", e.speed_of_sound).object();
  }
  std::string effector_text(const MagnusLift<D>& e) const {
    return effector_fields("magnus_lift", e.body)
        .put("lift", "[" + digits(e.law.a) + ", " + digits(e.law.b) + "]")
        .put("radius", e.radius)
        .put("density", e.density)
        .object();
  }
  std::string effector_text(const LiftingSurface<D>& e) const {
    Fields f = effector_fields("lifting_surface", e.body);
    f.put("aspect_ratio", e.law.aspect_ratio)
        .put("zero_lift_angle", e.law.zero_lift_angle)
        .put("stall_angle", e.law.stall_angle)
        .put("profile_drag", e.law.profile_drag)
        .put("efficiency", e.law.efficiency);
    f.put("point", vector_text(e.point)).put("forward", vector_text(e.forward));
    if (D::dimension == 3) f.put("up", vector_text(e.up));
    return f.put("area", e.area).put("chord", e.chord).put("density", e.density).object();
  }
  std::string effector_text(const CylinderDrag<D>& e) const {
    Fields f = effector_fields("cylinder_drag", e.body);
    f.put("point", vector_text(e.point)).put("axis", vector_text(e.axis)).put("diameter", e.diameter);
    return f.put("length", e.length).put("density", e.density).put("viscosity", e.viscosity).object();
  }
  std::string effector_text(const TurningFrame<D>& e) const {
    return effector_fields("turning_frame", e.body)
        .put("angular_velocity", angular_text(e.rate))
        .put("center", vector_text(e.center))
        .flag("centrifugal", e.centrifugal, false)
        .object();
  }
  std::string effector_text(const ElectromagneticField<D>& e) const {
    Fields f = effector_fields("electromagnetic_field", e.body);
    f.put("charge", e.charge).put("electric", vector_text(e.electric));
    return f.put("magnetic", D::dimension == 2 ? digits(e.magnetic.z) : vector_text(e.magnetic)).object();
  }

  static std::string case_text(const CaseDef& d) {
    Fields f;
    f.put("mass", d.mass).put("shape", quote(d.shape == blast::CaseShape::cylinder ? "cylinder" : "sphere"));
    f.put("explosive", quote(d.gurney_constant == blast::gurney_tnt ? "tnt" : "composition_b"));
    f.put("fragments", double(d.fragments)).put("density", d.density).put("drag_coefficient", d.drag_coefficient);
    return f.put("lifetime", d.lifetime).put("seed", double(d.seed)).object();
  }

  /// Charges that have not done their work yet; the time of the world begins anew.
  std::string explosions_text() const {
    std::string list;
    if (destruction_ == nullptr) return list;
    for (const auto& entry : destruction_->of<D>().explosions) {
      const blast::Explosion<D>& e = entry.thing.explosion;
      if (e.finished(world_.time())) continue;
      const blast::Charge<D>& c = e.charge();
      Fields f;
      f.put("name", quote(entry.name)).put("position", vector_text(c.position)).put("mass", c.mass);
      f.put("burst", quote(c.burst == blast::Burst::ground     ? "ground"
                           : c.burst == blast::Burst::free_air ? "free_air"
                                                               : "air"));
      if (c.burst == blast::Burst::air) f.put("ground", c.ground);
      f.put("time", c.time - world_.time()).put("reach", c.reach).flag("clearing", c.clearing, true);
      f.put("shelter", c.shelter);
      if (entry.thing.casing && !entry.thing.casing->thrown())
        f.put("case", case_text(entry.thing.casing->definition()));
      if (!c.casing.is_null()) f.put("casing", quoted_name(c.casing));
      if (c.mask != ~std::uint64_t{0}) f.put("mask", bits_text(c.mask));
      if (c.obstacles != ~std::uint64_t{0}) f.put("obstacles", bits_text(c.obstacles));
      list += (list.empty() ? "\n    " : ",\n    ") + f.object();
    }
    return list;
  }

  const World<D>& world_;
  const WriteOptions& options_;
  const Destruction* destruction_;
  World<D> scratch_;
  std::map<std::uint64_t, const SceneBody*> given_;
  std::map<std::uint64_t, std::string> names_;
  std::set<std::string> used_;
  bool failed_ = false;
  core::Error error_;
};

}  // namespace

Result<std::string> write_scene(const World2& world, const WriteOptions& options, std::span<const SceneBody> names) {
  return SceneWriter<Dim2>(world, options, names).write();
}
Result<std::string> write_scene(const World3& world, const WriteOptions& options, std::span<const SceneBody> names) {
  return SceneWriter<Dim3>(world, options, names).write();
}
Result<std::string> write_scene(const SceneWorld& world, const WriteOptions& options) {
  if (world.matter != nullptr)
    return core::Error{
        "only bodies, joints, effectors and charges can be written: this scene has ropes, cloth, liquids, grains or "
        "particles too"};
  const Destruction* const destruction = world.destruction.get();
  const auto more = [](const auto& of) {
    return !of.guns.empty() || !of.structures.empty() || !of.rockets.empty() || !of.shells.empty();
  };
  if (destruction != nullptr && (more(destruction->plane) || more(destruction->space)))
    return core::Error{
        "only bodies, joints, effectors and charges can be written: this scene has guns, rockets, shells or structures "
        "that break too"};
  if (world.world2) return SceneWriter<Dim2>(*world.world2, options, world.bodies, destruction).write();
  if (world.world3) return SceneWriter<Dim3>(*world.world3, options, world.bodies, destruction).write();
  return core::Error{"only worlds of bodies can be written"};
}

}  // namespace carom::scene
