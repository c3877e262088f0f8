#include "carom/scene/scene_world.h"

#include "carom/core/hash.h"
#include "carom/core/spelling.h"
#include "carom/math/elementary.h"
#include "carom/scene/destruction.h"
#include "carom/scene/detail/document.h"
#include "carom/scene/detail/expression.h"
#include "carom/scene/detail/flight.h"
#include "carom/scene/matter.h"

namespace carom::scene {
namespace {
using namespace rigid;

struct QuantityName {
  std::string_view name;
  std::string_view unit;
  int components;  ///< 0: one number; 1: a vector (.x .y .z); 2: a turn (a number in the plane, a vector in space)
};
enum WorldField {
  time_field,
  step_field,
  kinetic,
  potential,
  total_energy,
  momentum,
  angular_momentum,
  center_field,
  mass_field,
  contact_count,
  penetration,
  joint_error,
  awake_count,
  body_count
};
constexpr QuantityName world_names[] = {{"time", "s", 0},
                                        {"step", "", 0},
                                        {"energy.kinetic", "J", 0},
                                        {"energy.potential", "J", 0},
                                        {"energy.total", "J", 0},
                                        {"momentum", "kg*m/s", 1},
                                        {"angular_momentum", "kg*m^2/s", 2},
                                        {"center_of_mass", "m", 1},
                                        {"mass", "kg", 0},
                                        {"contacts", "", 0},
                                        {"penetration", "m", 0},
                                        {"joint_error", "m", 0},
                                        {"awake", "", 0},
                                        {"bodies", "", 0}};
enum BodyField { position, center, velocity, speed, angular_velocity, angle, tilt, body_mass, body_awake, body_energy };
constexpr QuantityName body_names[] = {{"position", "m", 1},
                                       {"center", "m", 1},
                                       {"velocity", "m/s", 1},
                                       {"speed", "m/s", 0},
                                       {"angular_velocity", "rad/s", 2},
                                       {"angle", "rad", 0},
                                       {"tilt", "rad", 0},
                                       {"mass", "kg", 0},
                                       {"awake", "", 0},
                                       {"kinetic_energy", "J", 0}};
enum JointField { coordinate, joint_speed, force, torque, linear_error, angular_error };
constexpr QuantityName joint_names[] = {{"coordinate", "", 0}, {"speed", "", 0},         {"force", "N", 1},
                                        {"torque", "N*m", 2},  {"linear_error", "m", 0}, {"angular_error", "rad", 0}};

/// Whether `text` is one of the names, with ".x" and so on where it has components.
bool match_quantity(std::string_view text, std::span<const QuantityName> names, int dimension, int& field,
                    int& component) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const QuantityName& q = names[i];
    if (text.substr(0, q.name.size()) != q.name) continue;
    const std::string_view rest = text.substr(q.name.size());
    const bool vector = q.components == 1 || (q.components == 2 && dimension == 3);
    field = int(i);
    component = q.components == 2 && dimension == 2 ? 2 : 0;
    if (!vector) {
      if (rest.empty()) return true;
      continue;
    }
    if (rest.size() != 2 || rest[0] != '.' || rest[1] < 'x' || rest[1] > (dimension == 2 ? 'y' : 'z')) continue;
    component = rest[1] - 'x';
    return true;
  }
  return false;
}

math::Vec3d wide(math::Vec2d v) { return {v.x, v.y, 0}; }
math::Vec3d wide(math::Vec3d v) { return v; }
math::Vec3d wide(math::Vec2f v) { return {v.x, v.y, 0}; }
math::Vec3d wide(math::Vec3f v) { return math::Vec3d(v); }
math::Vec3d wide(float w) { return {0, 0, w}; }
math::Vec3d wide(double w) { return {0, 0, w}; }

double angle_of(const math::Rot2f& q) { return math::atan2(double(q.s), double(q.c)); }
double angle_of(const math::Quatf& q) {
  return 2 * math::atan2(math::length(math::Vec3d(q.vector())), math::abs(double(q.w)));
}
double tilt_of(const math::Rot2f& q) { return math::abs(angle_of(q)); }
double tilt_of(const math::Quatf& q) {
  const math::Vec3d up = math::rotate(math::Quatd(q), math::Vec3d{0, 1, 0});
  return math::atan2(math::sqrt(up.x * up.x + up.z * up.z), up.y);
}
double spin_energy(const World2& world, BodyId body, float w) {
  const auto m = world.mass_properties2(body);
  return m.ok() ? 0.5 * m->inertia * double(w) * double(w) : 0;
}
double spin_energy(const World3& world, BodyId body, math::Vec3f w) {
  const auto m = world.mass_properties3(body);
  const auto state = world.state(body);
  if (!m.ok() || !state.ok()) return 0;
  const math::Vec3d local = math::inverse_rotate(math::Quatd(state->pose.rotation), math::Vec3d(w));
  return 0.5 * math::dot(local, m->inertia * local);
}

constexpr double missing = __builtin_nan("");

template <class D>
double read_world(const World<D>& world, const Probe::Source& source) {
  switch (source.field) {
    case time_field:
      return world.time();
    case step_field:
      return double(world.step_count());
    case kinetic:
      return world.totals().kinetic_energy;
    case potential:
      return world.totals().potential_energy;
    case total_energy: {
      const Totals<D> t = world.totals();
      return t.kinetic_energy + t.potential_energy;
    }
    case momentum:
      return wide(world.totals().momentum)[source.component];
    case angular_momentum:
      return wide(world.totals().angular_momentum)[source.component];
    case center_field:
      return wide(world.totals().center_of_mass)[source.component];
    case mass_field:
      return world.totals().mass;
    case contact_count:
      return world.counters().touching_contacts;
    case penetration:
      return double(world.worst_penetration());
    case joint_error:
      return double(world.worst_joint_error());
    case awake_count:
      return world.counters().awake_bodies;
    default:
      return world.counters().bodies;
  }
}
template <class D>
double read_body(const World<D>& world, const Probe::Source& source) {
  const Result<BodyState<D>> state = world.state(source.body);
  if (!state) return missing;
  const BodyState<D>& s = *state;
  switch (source.field) {
    case position:
      return wide(s.pose.position)[source.component];
    case center:
      return wide(s.center_of_mass)[source.component];
    case velocity:
      return wide(s.linear_velocity)[source.component];
    case speed:
      return math::length(wide(s.linear_velocity));
    case angular_velocity:
      return wide(s.angular_velocity)[source.component];
    case angle:
      return angle_of(s.pose.rotation);
    case tilt:
      return tilt_of(s.pose.rotation);
    case body_mass:
      return double(s.mass);
    case body_awake:
      return s.awake;
    default:
      return 0.5 * double(s.mass) * math::length_squared(wide(s.linear_velocity)) +
             spin_energy(world, source.body, s.angular_velocity);
  }
}
template <class D>
double read_joint_state(const World<D>& world, const Probe::Source& source) {
  const Result<JointState<D>> state = world.joint_state(source.joint);
  if (!state) return missing;
  switch (source.field) {
    case coordinate:
      return double(state->coordinate);
    case joint_speed:
      return double(state->speed);
    case force:
      return wide(state->force)[source.component];
    case torque:
      return wide(state->torque)[source.component];
    case linear_error:
      return double(state->linear_error);
    default:
      return double(state->angular_error);
  }
}

/// Splits "name.quantity" where name is that of a body or joint; names may hold points.
template <class List>
const auto* longest_owner(const List& list, std::string_view text, std::string_view& rest) {
  decltype(&list[0]) found = nullptr;
  std::size_t best = 0;
  for (const auto& entry : list) {
    const std::size_t n = entry.name.size();
    if (n < best || n == 0 || text.size() <= n + 1 || text[n] != '.' || text.substr(0, n) != entry.name) continue;
    best = n;
    found = &entry;
    rest = text.substr(n + 1);
  }
  return found;
}

}  // namespace

namespace {
template <class D>
Status step_world(SceneWorld& scene, World<D>& world) {
  Destruction* const destruction = scene.destruction.get();
  if (destruction != nullptr)
    if (Status s = destruction->before(world, scene.dt, scene.matter.get()); !s) return s;
  const auto advance = [&] {
    return destruction != nullptr ? destruction->step(world, scene.dt) : world.step(float(scene.dt));
  };
  const Status done = scene.matter
                          ? scene.matter->step(world, scene.dt, environment_of(world, scene.environment).get(), advance)
                          : advance();
  return done.ok() && destruction != nullptr ? destruction->after(world, scene.dt) : done;
}

template <class T>
[[gnu::noinline]] Status move_character(SceneWorld& scene, T& walker, math::Vec3f v) {
  if constexpr (std::is_same_v<T, rigid::Character2> || std::is_same_v<T, rigid::DynamicCharacter2>)
    return walker.move(*scene.world2, {v.x, v.y}, float(scene.dt));
  else if constexpr (!std::is_same_v<T, std::monostate>)
    return walker.move(*scene.world3, v, float(scene.dt));
  else
    return {};
}
}  // namespace

SceneWorld::SceneWorld() = default;
SceneWorld::~SceneWorld() = default;
SceneWorld::SceneWorld(SceneWorld&&) noexcept = default;
SceneWorld& SceneWorld::operator=(SceneWorld&&) noexcept = default;

Status SceneWorld::step() {
  for (SceneCharacter& c : characters) {
    const math::Vec3f v(c.velocity);
    const auto walk = [&](auto& walker) { return move_character(*this, walker, v); };
    if (const Status s = std::visit(walk, c.walker); !s.ok()) return s;
  }
  if (world2) return step_world(*this, *world2);
  if (world3) return step_world(*this, *world3);
  if (!flight) return core::Error{"the scene has no world"};
  if (flight->at + 1 >= flight->rows.size()) return core::Error{"the flight has ended"};
  ++flight->at;
  return {};
}
double SceneWorld::time() const {
  if (world2) return world2->time();
  if (world3) return world3->time();
  return flight ? flight->now().time : 0;
}
std::uint64_t SceneWorld::step_count() const {
  if (world2) return world2->step_count();
  if (world3) return world3->step_count();
  return flight ? flight->at : 0;
}
std::uint64_t SceneWorld::state_hash() const {
  core::StateHash hash;
  if (world2 || world3) {
    const std::uint64_t bodies_hash = world2 ? world2->state_hash() : world3->state_hash();
    if (!matter && !destruction) return bodies_hash;
    hash.add(bodies_hash);
    if (matter) matter->add_to(hash);
    if (destruction) destruction->add_to(hash);
    return hash.digest();
  }
  if (!flight) return 0;
  const FreeBodyState& s = flight->now().state;
  for (int i = 0; i < 3; ++i) hash.add(s.position[i]).add(s.velocity[i]).add(s.angular_velocity[i]);
  hash.add(s.attitude.w).add(s.attitude.x).add(s.attitude.y).add(s.attitude.z);
  return hash.digest();
}

std::optional<FlightPlace> SceneWorld::flight_place() const {
  if (!flight) return {};
  // North, up, east from north, east, down; likewise the body's axes.
  const auto upright = [](math::Vec3d ned) { return math::Vec3d{ned.x, -ned.z, ned.y}; };
  const rigid::FlightCase& c = flight->definition;
  const rigid::FlightRow &row = flight->now(), &start = flight->rows.front();
  FlightPlace out;
  const math::Quatd q = to_attitude(row.angles);
  out.rotation = math::Quatf(math::Quatd{q.w, upright(q.vector())});
  if (c.world == FlightWorld::flat) {
    const math::Vec3d p = row.state.position - start.state.position;
    out.position = {p.x, row.altitude, p.y};
  } else {
    const double r = c.ellipsoid.equatorial_radius;
    out.position = {(row.latitude - start.latitude) * r, row.altitude,
                    (row.longitude - start.longitude) * r * math::cos(start.latitude)};
  }
  // I_x = m (b² + c²)/3 with half extents a, b, c.
  const math::Vec3d i{c.inertia(0, 0), c.inertia(2, 2), c.inertia(1, 1)};
  const double sum = i.x + i.y + i.z;
  for (int k = 0; k < 3; ++k)
    out.half_extents[k] = math::sqrt(math::max(0.0, 1.5 * (sum - 2 * i[k]) / math::max(c.mass, 1e-30)));
  return out;
}

const SceneBody* SceneWorld::find_body(std::string_view name) const {
  for (const SceneBody& b : bodies)
    if (b.name == name) return &b;
  return nullptr;
}
const SceneBody* SceneWorld::find_body(BodyId id) const {
  for (const SceneBody& b : bodies)
    if (b.id == id) return &b;
  return nullptr;
}
const SceneJoint* SceneWorld::find_joint(std::string_view name) const {
  for (const SceneJoint& j : joints)
    if (j.name == name) return &j;
  return nullptr;
}

Result<Probe> SceneWorld::probe(std::string_view text) const {
  if (!text.empty() && text[0] == '=') text.remove_prefix(1);
  core::Result<detail::Expression> parsed = detail::parse_expression(text);
  if (!parsed) return parsed.error();
  Probe probe;
  probe.text = std::string(text);
  std::vector<detail::Dimension> dimensions;
  for (const std::string& name : parsed->names) {
    Probe::Source source;
    std::string_view unit, rest;
    if (flight) {
      const std::span<const detail::FlightField> fields = detail::flight_fields();
      std::size_t i = 0;
      while (i < fields.size() && name != fields[i].name) ++i;
      if (i == fields.size()) {
        std::vector<std::string_view> known;
        for (const auto& f : fields) known.push_back(f.name);
        return core::Error{"found the quantity " + detail::quote(name) + " that a flight does not have" +
                           core::did_you_mean(name, known)};
      }
      source.kind = Probe::Source::Kind::flight;
      source.field = int(i);
      unit = fields[i].unit;
    } else if (match_quantity(name, world_names, dimension, source.field, source.component)) {
      unit = world_names[source.field].unit;
    } else if (const SceneJoint* joint = name.rfind("joint.", 0) == 0
                                             ? longest_owner(joints, std::string_view(name).substr(6), rest)
                                             : nullptr;
               joint != nullptr && match_quantity(rest, joint_names, dimension, source.field, source.component)) {
      source.kind = Probe::Source::Kind::joint;
      source.joint = joint->id;
      unit = joint_names[source.field].unit;
      if (source.field <= joint_speed) {
        bool turns = false;
        if (world2)
          turns = world2->joint_state(joint->id).ok() && world2->joint_state(joint->id)->type == JointType::hinge;
        if (world3)
          turns = world3->joint_state(joint->id).ok() && world3->joint_state(joint->id)->type == JointType::hinge;
        unit = source.field == coordinate ? (turns ? "rad" : "m") : (turns ? "rad/s" : "m/s");
      }
    } else if (matter && matter->find(name, dimension, source, unit)) {
    } else if (destruction && destruction->find(name, dimension, source, unit)) {
    } else if (const SceneBody* body = longest_owner(bodies, name, rest);
               body != nullptr && match_quantity(rest, body_names, dimension, source.field, source.component)) {
      source.kind = Probe::Source::Kind::body;
      source.body = body->id;
      unit = body_names[source.field].unit;
    } else {
      std::string message = "found the quantity " + detail::quote(name);
      std::vector<std::string_view> known;
      if (body != nullptr) {
        message += " that the body " + detail::quote(body->name) + " does not have";
        for (const QuantityName& q : body_names) known.push_back(q.name);
        return core::Error{message + ", expected .position.x, .velocity.y, .speed, .angle and so on" +
                           core::did_you_mean(rest, known)};
      }
      const std::string owner = name.substr(0, name.find('.'));
      for (const QuantityName& q : world_names) known.push_back(q.name);
      for (const SceneBody& b : bodies) known.push_back(b.name);
      std::vector<std::string> things = matter ? matter->names() : std::vector<std::string>();
      if (destruction)
        for (std::string& thing : destruction->names()) things.push_back(std::move(thing));
      for (const std::string& thing : things) known.push_back(thing);
      return core::Error{message + ", expected one of the world (time, energy.kinetic, …) or body.quantity" +
                         core::did_you_mean(owner, known)};
    }
    dimensions.push_back(detail::parse_unit(unit).value_or(detail::Quantity{}).dimension);
    probe.sources.push_back(source);
  }
  if (probe.sources.size() > 32) return core::Error{"found more than 32 quantities in one expression"};
  const core::Result<detail::Dimension> result = detail::check_expression(*parsed, dimensions);
  if (!result) return result.error();
  probe.unit = detail::si_unit(*result);
  probe.expression = std::make_shared<const detail::Expression>(std::move(*parsed));
  return probe;
}

double SceneWorld::read(const Probe& probe) const {
  if (!probe.expression) return missing;
  double values[32] = {};
  for (std::size_t i = 0; i < probe.sources.size() && i < 32; ++i) {
    const Probe::Source& s = probe.sources[i];
    switch (s.kind) {
      case Probe::Source::Kind::world:
        values[i] = world2 ? read_world(*world2, s) : world3 ? read_world(*world3, s) : missing;
        break;
      case Probe::Source::Kind::body:
        values[i] = world2 ? read_body(*world2, s) : world3 ? read_body(*world3, s) : missing;
        break;
      case Probe::Source::Kind::joint:
        values[i] = world2 ? read_joint_state(*world2, s) : world3 ? read_joint_state(*world3, s) : missing;
        break;
      case Probe::Source::Kind::matter:
        values[i] = matter ? matter->read(s) : missing;
        break;
      case Probe::Source::Kind::destruction:
        values[i] = destruction ? destruction->read(s, time()) : missing;
        break;
      case Probe::Source::Kind::flight:
        values[i] = flight ? detail::flight_fields()[std::size_t(s.field)].read(flight->now()) : missing;
        break;
    }
  }
  return detail::evaluate_expression(*probe.expression, values);
}

}  // namespace carom::scene
