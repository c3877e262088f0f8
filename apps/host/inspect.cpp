#include "apps/host/inspect.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "carom/rigid/advice.h"

namespace carom::host {

namespace {

using Json = nlohmann::json;

Json components(math::Vec3d v) { return {v.x, v.y, v.z}; }
Json spin(float w) { return {0, 0, w}; }
Json spin(math::Vec3f w) { return {w.x, w.y, w.z}; }
double speed_of(float w) { return double(math::abs(w)); }
double speed_of(math::Vec3f w) { return double(math::length(w)); }

constexpr const char* joint_names[] = {"distance", "ball",    "hinge", "slider", "weld",  "motor",
                                       "mouse",    "generic", "gear",  "rack",   "screw", "pulley"};

template <class D>
class Inspection {
 public:
  Inspection(Stage<D>& stage, rigid::BodyId body) : stage_(stage), world_(stage.world()), body_(body) {}

  Json report(std::uint32_t id) {
    const auto state = world_.state(body_);
    const auto definition = world_.body_definition(body_);
    if (!state.ok() || !definition.ok()) return {};
    constexpr const char* types[] = {"fixed", "kinematic", "dynamic"};
    Json contacts = contacts_json(), joints = joints_json();
    return {{"body", id},
            {"name", std::string(definition->name)},
            {"kind", types[int(state->type)]},
            {"mass", state->mass},
            {"position", components(in_space(state->center_of_mass))},
            {"velocity", components(in_space(state->linear_velocity))},
            {"angular_velocity", spin(state->angular_velocity)},
            {"awake", state->awake},
            {"why", why(*state, *definition)},
            {"weight", double(state->mass) * double(definition->gravity_scale) * double(definition->time_scale) *
                           double(definition->time_scale) * double(math::length(world_.definition().gravity))},
            {"contacts", std::move(contacts)},
            {"joints", std::move(joints)},
            {"advice", advice_json()}};
  }

 private:
  std::string name_of(rigid::BodyId body) const {
    const auto definition = world_.body_definition(body);
    if (!definition.ok()) return "the world";
    if (!definition->name.empty()) return std::string(definition->name);
    for (const auto& actor : stage_.actors())
      if (actor.body == body) return "body " + std::to_string(actor.id);
    return "a body";
  }

  Json contacts_json() {
    std::vector<rigid::ContactView<D>> all;
    world_.contacts(all);
    Json out = Json::array();
    for (const rigid::ContactView<D>& contact : all) {
      const auto a = world_.body_of(contact.shape_a), b = world_.body_of(contact.shape_b);
      if (!a.ok() || !b.ok() || (!(*a == body_) && !(*b == body_))) continue;
      const rigid::BodyId other = *a == body_ ? *b : *a;
      float normal = 0, deepest = 0;
      for (int i = 0; i < contact.count; ++i) {
        normal += contact.points[i].normal_impulse;
        deepest = math::min(deepest, contact.points[i].separation);
      }
      if (const auto state = world_.state(other); state.ok() && state->awake && state->type != rigid::BodyType::fixed &&
                                                  double(math::length(state->linear_velocity)) > fastest_neighbour_) {
        fastest_neighbour_ = double(math::length(state->linear_velocity));
        neighbour_ = name_of(other);
      }
      out.push_back({{"with", name_of(other)},
                     {"points", contact.count},
                     {"normal", components(in_space(*a == body_ ? -contact.normal : contact.normal))},
                     {"impulse", normal},
                     {"friction", math::length(contact.friction_impulse)},
                     {"depth", -deepest},
                     {"color", contact.color}});
      if (out.size() >= 64) break;
    }
    return out;
  }

  Json joints_json() {
    std::vector<rigid::JointId> all;
    world_.joints(all);
    Json out = Json::array();
    for (const rigid::JointId id : all) {
      const auto state = world_.joint_state(id);
      if (!state.ok() || (!(state->body_a == body_) && !(state->body_b == body_))) continue;
      const rigid::BodyId other = state->body_a == body_ ? state->body_b : state->body_a;
      if (state->type == rigid::JointType::mouse) held_ = true;
      out.push_back({{"type", joint_names[int(state->type)]},
                     {"with", name_of(other)},
                     {"force", math::length(state->force)},
                     {"torque", speed_of(state->torque)},
                     {"error", state->linear_error},
                     {"direct", state->direct}});
      if (out.size() >= 64) break;
    }
    return out;
  }

  /// In the order in which the engine would hold it against sleep.
  std::string why(const rigid::BodyState<D>& state, const rigid::BodyDef<D>& definition) const {
    if (state.type == rigid::BodyType::fixed) return "fixed: it never moves";
    if (!state.enabled) return "disabled: it takes no part";
    if (!state.awake) return "asleep: its island was slow for " + decimal(world_.definition().sleep_time) + " s";
    if (!world_.definition().allow_sleep) return "awake: this world lets nothing sleep";
    if (!definition.allow_sleep || definition.sleep_speed <= 0) return "awake: it is not allowed to sleep";
    if (held_) return "awake: a hand pulls at it";
    if (state.type == rigid::BodyType::kinematic) return "awake: a kinematic body moves as it is told";
    const double speed = double(math::length(state.linear_velocity));
    if (speed > double(definition.sleep_speed))
      return "awake: it moves at " + decimal(speed) + " m/s, above its sleep speed of " +
             decimal(definition.sleep_speed) + " m/s";
    if (speed_of(state.angular_velocity) > double(definition.sleep_speed))
      return "awake: it turns at " + decimal(speed_of(state.angular_velocity)) + " rad/s";
    if (fastest_neighbour_ > double(definition.sleep_speed))
      return "awake: it touches " + neighbour_ + ", which moves at " + decimal(fastest_neighbour_) + " m/s";
    return "awake: it has been slow for less than " + decimal(world_.definition().sleep_time) +
           " s, or something in its island moves";
  }

  Json advice_json() const {
    Json out = Json::array();
    for (const rigid::Advice& advice : rigid::advise(world_, float(stage_.declaration().dt))) {
      bool mine = advice.body == body_ || (advice.body.is_null() && advice.joint.is_null());  // or of the whole world
      if (const auto joint = world_.joint_state(advice.joint); joint.ok())
        mine = mine || joint->body_a == body_ || joint->body_b == body_;
      if (mine) out.push_back(advice.message);
    }
    return out;
  }

  static std::string decimal(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", x);
    return text;
  }
  static std::string decimal(float x) { return decimal(double(x)); }

  Stage<D>& stage_;
  const rigid::World<D>& world_;
  rigid::BodyId body_;
  bool held_ = false;
  double fastest_neighbour_ = 0;
  std::string neighbour_;
};

}  // namespace

template <class D>
std::string inspect_body(Stage<D>& stage, std::uint32_t id) {
  for (const auto& actor : stage.actors()) {
    if (actor.id != id) continue;
    const Json report = Inspection<D>(stage, actor.body).report(id);
    return report.is_object() ? report.dump(-1, ' ', false, Json::error_handler_t::replace) : std::string();
  }
  return {};
}

template std::string inspect_body(Stage2&, std::uint32_t);
template std::string inspect_body(Stage3&, std::uint32_t);

}  // namespace carom::host
