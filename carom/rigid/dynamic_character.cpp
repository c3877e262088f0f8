#include "carom/rigid/dynamic_character.h"

#include "carom/geometry/mass_properties.h"
#include "carom/math/elementary.h"
#include "carom/rigid/detail/character_shape.h"
#include "carom/rigid/detail/check.h"

namespace carom::rigid {
namespace {

constexpr float thinner = 0.97f;   // of the probe, in radii
constexpr float fastest_drop = 5;  // m/s with which it is kept on ground that falls away
constexpr float through = 0.02f;   // radii that a contact without an impulse reaches in, at least, to be none
constexpr float inward = 0.1f;     // radii inward of an edge at which its top is looked for

}  // namespace

template <class D>
Result<DynamicCharacter<D>> DynamicCharacter<D>::create(World<D>& world, const DynamicCharacterDef<D>& d,
                                                        Position feet) {
  detail::Complaint complaint("DynamicCharacter::create");
  const float size = detail::check_character(complaint, d, feet);
  detail::check_range(complaint, "mass", double(d.mass), 1e-6, detail::max_body_mass);
  detail::check_range(complaint, "leg_force", double(d.leg_force), 0, detail::max_force);
  detail::check_range(complaint, "air_force", double(d.air_force), 0, detail::max_force);
  if (!complaint.none_yet()) return complaint.error();

  DynamicCharacter c;
  c.definition_ = d;
  c.definition_.up = d.up / size;
  c.rotation_ = detail::upright(c.definition_.up);
  c.probe_ = detail::make_capsule(D{}, d.half_length, thinner * d.radius);
  c.least_up_ = math::cos(d.max_slope);
  BodyDef<D> body;
  body.position = feet + Position(c.definition_.up * (d.half_length + d.radius));
  body.rotation = c.rotation_;
  body.locks.rotation_x = body.locks.rotation_y = body.locks.rotation_z = true;
  body.allow_sleep = false;
  body.user_data = d.user_data;
  ShapeDef<D> shape;
  shape.filter = d.filter;
  shape.material.friction = 0;
  const typename D::Shape capsule = detail::make_capsule(D{}, d.half_length, d.radius);
  shape.density = float(double(d.mass) / geometry::mass_properties(capsule, 1).mass);
  if (const Status s = detail::make_character(world, body, capsule, shape, c.body_, c.shape_); !s.ok())
    return s.error();
  c.contacts_.reserve(16);
  return c;
}

template <class D>
Status DynamicCharacter<D>::destroy(World<D>& world) {
  return world.destroy_body(body_);
}

template <class D>
typename DynamicCharacter<D>::Position DynamicCharacter<D>::center(const World<D>& world) const {
  const Result<BodyState<D>> state = world.state(body_);
  return state.ok() ? state.value().pose.position : Position{};
}
template <class D>
typename DynamicCharacter<D>::Position DynamicCharacter<D>::feet(const World<D>& world) const {
  return center(world) - Position(definition_.up * (definition_.half_length + definition_.radius));
}
template <class D>
typename DynamicCharacter<D>::Vector DynamicCharacter<D>::velocity(const World<D>& world) const {
  const Result<BodyState<D>> state = world.state(body_);
  return state.ok() ? state.value().linear_velocity : Vector{};
}

template <class D>
Status DynamicCharacter<D>::teleport(World<D>& world, Position feet) {
  const Position center = feet + Position(definition_.up * (definition_.half_length + definition_.radius));
  if (const Status s = world.set_pose(body_, center, rotation_); !s.ok()) return s;
  ground_ = {};
  return world.set_velocity(body_, {}, {});
}

template <class D>
typename DynamicCharacter<D>::Touch DynamicCharacter<D>::touch_of(const RayHit<D>& hit, Position center) const {
  const Position feet = center - Position(definition_.up * (definition_.half_length + definition_.radius));
  return {hit.normal, hit.point, dot(hit.normal, definition_.up),
          float(dot(hit.point - feet, Position(definition_.up))), hit.shape};
}

/// Whether a little inward of a touched edge there is a surface to stand on, no higher than `highest` above the feet.
template <class D>
bool DynamicCharacter<D>::has_top(const World<D>& world, const Touch& t, float highest) const {
  const Vector up = definition_.up;
  const Vector level = t.normal - up * t.rise;
  const float size = math::length(level);
  if (t.rise < -0.05f || t.height > highest || size < 1e-3f) return false;
  const float r = inward * definition_.radius, above = highest + r;
  const Position side = t.point - Position(level * (r / size));
  const Position from = side + Position(up * (above - t.height));
  const auto hit =
      world.ray_cast(from, up * -(above - t.height + r), {definition_.filter.category, definition_.filter.mask, body_});
  return hit.ok() && hit.value().shape && hit.value().fraction > 0 && dot(hit.value().normal, up) >= least_up_;
}

/// The step that it is climbing and has lost touch with for a moment.
template <class D>
bool DynamicCharacter<D>::find_ahead(const World<D>& world, const Vector& walk, Touch& found) const {
  const Vector up = definition_.up;
  const float speed = math::length(walk);
  if (speed == 0 || dot(ground_.normal, up) >= least_up_) return false;
  const Position here = center(world);
  const auto hit = world.shape_cast(probe_, {here, rotation_}, walk * (0.2f * definition_.radius / speed),
                                    {definition_.filter.category, definition_.filter.mask, body_});
  if (!hit.ok() || !hit.value().shape) return false;
  found = touch_of(hit.value(), here);
  return found.rise < least_up_ && has_top(world, found, definition_.step_height);
}

/// The ground within a step below, for who stood a moment ago.
template <class D>
bool DynamicCharacter<D>::find_below(const World<D>& world, Touch& found, float& distance) const {
  const Vector up = definition_.up;
  const Position here = center(world);
  const float way = definition_.step_height + (1 - thinner) * definition_.radius;
  const auto hit = world.shape_cast(probe_, {here, rotation_}, up * -way,
                                    {definition_.filter.category, definition_.filter.mask, body_});
  if (!hit.ok() || !hit.value().shape || hit.value().fraction == 0) return false;
  found = touch_of(hit.value(), here);
  distance = way * hit.value().fraction;
  return found.rise >= least_up_ ||
         (found.rise > 0.05f && has_top(world, found, max(found.height, 0.0f) + definition_.radius));
}

template <class D>
void DynamicCharacter<D>::stand_on(const World<D>& world, const Touch& t, GroundState state) {
  ground_ = {};
  const Result<BodyId> body = world.body_of(t.shape);
  if (!body.ok()) return;
  ground_.state = state;
  ground_.shape = t.shape;
  ground_.body = body.value();
  ground_.point = t.point;
  ground_.normal = t.normal;
  ground_.slope = math::acos(clamp(t.rise, -1.0f, 1.0f));
  const Result<BodyState<D>> s = world.state(body.value());
  if (s.ok() && s.value().type != BodyType::fixed)
    ground_.velocity =
        s.value().linear_velocity + cross(s.value().angular_velocity, Vector(t.point - s.value().center_of_mass));
  const Result<ShapeDef<D>> shape = world.shape_definition(t.shape);
  if (!s.ok() || !shape.ok()) return;
  const ShapeDef<D>& def = shape.value();
  ground_.belt = detail::belt_velocity(rotate((s.value().pose * def.local).rotation, def.surface_velocity),
                                       def.material, t.normal);
  ground_.velocity += ground_.belt;
}

/// Finds what is under the feet: what touches, a step that the walk leads against, or ground a step below.
template <class D>
void DynamicCharacter<D>::look(const World<D>& world, Position feet, const Vector& walk, bool jumps) {
  const Vector up = definition_.up;
  const bool stood = ground_.state == GroundState::on_ground;
  drop_ = 0;
  world.contacts(body_, contacts_);
  Touch best, step, steep;
  bool stands = false, climbs = false, leans = false;
  for (const ContactView<D>& c : contacts_) {
    Touch t;
    const bool first = c.shape_a == shape_;
    t.shape = first ? c.shape_b : c.shape_a;
    t.normal = first ? -c.normal : c.normal;
    t.rise = dot(t.normal, up);
    int deepest = 0;
    for (int i = 1; i < c.count; ++i)
      if (c.points[i].separation < c.points[deepest].separation) deepest = i;
    // What pushes nothing however deep it reaches lets it through: one-way surfaces, contacts that were switched off.
    float pushed = 0;
    for (int i = 0; i < c.count; ++i) pushed += c.points[i].normal_impulse;
    if (pushed == 0 && c.points[deepest].separation < -through * definition_.radius) continue;
    t.point = c.points[deepest].point;
    t.height = float(dot(t.point - feet, Position(up)));
    const bool walkable = t.rise >= least_up_;
    if (walkable || (t.rise > 0.05f && t.height < definition_.radius && has_top(world, t, definition_.radius))) {
      if (!stands || t.rise > best.rise) best = t, stands = true;
    } else if (t.rise > 0.05f && (!leans || t.rise > steep.rise)) {
      steep = t, leans = true;
    }
    if (!walkable && stood && !jumps && dot(walk, t.normal) < -0.3f * math::length(walk) &&
        has_top(world, t, definition_.step_height) && (!climbs || t.rise < step.rise))
      step = t, climbs = true;
  }
  if (!climbs && !stands && stood && !jumps) climbs = find_ahead(world, walk, step);
  if (climbs) return stand_on(world, step, GroundState::on_ground);
  if (stands) return stand_on(world, best, GroundState::on_ground);
  Touch below;
  if (stood && !jumps && find_below(world, below, drop_)) return stand_on(world, below, GroundState::on_ground);
  drop_ = 0;
  if (leans) return stand_on(world, steep, GroundState::on_steep);
  ground_ = {};
}

/// The force toward the walk over ground, that holds against gravity along it too.
template <class D>
typename D::Vector DynamicCharacter<D>::legs(const Vector& walk, const Vector& velocity, const Vector& gravity,
                                             float dt) const {
  const Vector up = definition_.up, n = ground_.normal;
  // Along the ground: for a step's riser that is straight up.
  Vector along = walk * dot(n, up) - up * dot(walk, n);
  const float size = math::length(along);
  if (size > 1e-6f) along *= math::length(walk) / size;
  // Against a riser it leans, so as not to lose it on the way up.
  if (dot(n, up) < least_up_) along -= n * (0.25f * math::length(walk));
  Vector change = ground_.velocity + along - velocity;
  // The ground itself sees to the speed into it.
  change -= n * max(dot(change, n), 0.0f);
  Vector force = change * (definition_.mass / dt) - (gravity - n * dot(gravity, n)) * definition_.mass;
  const float strength = math::length(force);
  if (strength > definition_.leg_force) force *= definition_.leg_force / strength;
  return force;
}

template <class D>
Status DynamicCharacter<D>::move(World<D>& world, Vector velocity, float dt) {
  detail::Complaint complaint("DynamicCharacter::move");
  detail::check_size(complaint, "velocity", velocity, detail::max_velocity);
  detail::check_range(complaint, "dt", double(dt), 1e-9, 1);
  if (complaint.none_yet() && !world.contains(body_))
    complaint.say("the character's body does not exist in this world");
  if (!complaint.none_yet()) return complaint.error();
  const Vector up = definition_.up;
  const BodyState<D> state = world.state(body_).value();
  const float mass = definition_.mass;
  const float jump = dot(velocity, up);
  const Vector walk = velocity - up * jump;
  const bool jumps = jump > 0 && ground_.state == GroundState::on_ground;
  look(world, feet(world), walk, jumps);
  Vector now = state.linear_velocity;
  const auto react = [&](const Vector& force) {  // the ground's part of what the legs do
    const Result<BodyState<D>> ground = world.state(ground_.body);
    if (ground.ok() && ground.value().type == BodyType::dynamic)
      (void)world.add_force_at(ground_.body, -force, ground_.point);
  };
  if (jumps && ground_.state == GroundState::on_ground) {
    const float rise = jump + max(dot(ground_.velocity, up), 0.0f) - dot(now, up);
    if (rise > 0) {
      const Vector impulse = up * (mass * rise);
      if (const Status s = world.add_impulse(body_, impulse); !s.ok()) return s;
      react(impulse / dt);
      now += up * rise;
    }
    ground_ = {};
  }
  if (ground_.state == GroundState::on_ground) {
    if (drop_ > 0) {  // kept on ground that falls away
      const float down = min(drop_ / dt, fastest_drop) - dot(ground_.velocity - now, up);
      if (down > 0)
        if (const Status s = world.add_impulse(body_, up * (-mass * down)); !s.ok()) return s;
    }
    const Vector force = legs(walk, now, world.definition().gravity, dt);
    if (const Status s = world.add_force(body_, force); !s.ok()) return s;
    react(force);
    return {};
  }
  // Steering in the air, never up a slope that is too steep.
  Vector change = walk - (now - up * dot(now, up));
  if (ground_.state == GroundState::on_steep) {
    const Vector level = ground_.normal - up * dot(ground_.normal, up);
    const float size2 = dot(level, level), against = dot(change, level);
    if (against < 0 && size2 > 0) change -= level * (against / size2);
  }
  Vector force = change * (mass / dt);
  const float strength = math::length(force);
  if (strength > definition_.air_force) force *= definition_.air_force / strength;
  return world.add_force(body_, force);
}

template class DynamicCharacter<Dim2>;
template class DynamicCharacter<Dim3>;

}  // namespace carom::rigid
