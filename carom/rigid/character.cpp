// Collide and slide by half-spaces: what is near gives planes, and the way that comes nearest to the wanted one and
// crosses none of them is a small quadratic programme (after the plane movers of Box2D 3.1; the solver is Hildreth's).
#include "carom/rigid/character.h"

#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/character_shape.h"
#include "carom/rigid/detail/check.h"
#include "carom/rigid/detail/contacts.h"
#include "carom/rigid/detail/seen_shapes.h"
#include "carom/rigid/detail/vicinity.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid {
namespace {

constexpr float tiny = 1e-6f;        // m
constexpr float ground_gap = 2e-3f;  // m beyond the skin at which the ground still carries

/// How far a point at `arm` from the centre of mass goes in dt with a body that moves and turns evenly.
Vec2f way_of_point(const Vec2f& velocity, float spin, const Vec2f& arm, float dt) {
  const Rot2f q{math::cos(spin * dt), math::sin(spin * dt)};
  return dt * velocity + (rotate(q, arm) - arm);
}
Vec3f way_of_point(const Vec3f& velocity, const Vec3f& spin, const Vec3f& arm, float dt) {
  const float rate = math::length(spin);
  if (rate * dt < 1e-7f) return dt * (velocity + cross(spin, arm));
  const Vec3f axis = spin / rate;
  const auto [s, c] = math::sincos(0.5f * rate * dt);
  return dt * velocity + (rotate(Quatf{c, s * axis}, arm) - arm);
}

/// Was the way x ended by a plane that was far away where it began? Only then another try is worth it: the rest stands
/// in the way for good.
template <class Planes, class Vector>
bool kept_from_afar(const Planes& planes, const Vector& x, float skin) {
  for (const auto& p : planes)
    if (p.gap > skin && p.gap + dot(p.normal, x) < tiny) return true;
  return false;
}

float spin_of(float w) { return math::abs(w); }
float spin_of(const Vec3f& w) { return math::length(w); }

}  // namespace

template <class D>
Character<D>::Character() : around_(std::make_unique<detail::Vicinity<D>>()) {}
template <class D>
Character<D>::Character(Character&&) noexcept = default;
template <class D>
Character<D>& Character<D>::operator=(Character&&) noexcept = default;
template <class D>
Character<D>::~Character() = default;

template <class D>
Result<Character<D>> Character<D>::create(World<D>& world, const CharacterDef<D>& d, Position feet) {
  detail::Complaint complaint("Character::create");
  const float size = detail::check_character(complaint, d, feet);
  detail::check_range(complaint, "skin", double(d.skin), 1e-4, double(d.radius));
  detail::check_range(complaint, "mass", double(d.mass), 0, detail::max_body_mass);
  detail::check_range(complaint, "push_force", double(d.push_force), 0, detail::max_force);
  if (!complaint.none_yet()) return complaint.error();

  Character c;
  c.definition_ = d;
  c.definition_.up = d.up / size;
  c.rotation_ = detail::upright(c.definition_.up);
  c.capsule_ = detail::make_capsule(D{}, d.half_length, d.radius);
  c.box_ = geometry::bounds(c.capsule_, typename D::Transform{{}, c.rotation_});
  c.least_up_ = math::cos(d.max_slope);
  c.position_ = feet + Position(c.definition_.up * (d.half_length + d.radius));
  BodyDef<D> body;
  body.type = BodyType::kinematic;
  body.position = c.position_;
  body.rotation = c.rotation_;
  body.user_data = d.user_data;
  ShapeDef<D> shape;
  shape.filter = d.filter;
  if (const Status s = detail::make_character(world, body, c.capsule_, shape, c.body_, c.shape_); !s.ok())
    return s.error();
  c.planes_.reserve(64);
  c.around_->found.reserve(64);
  c.around_->near.reserve(32);
  return c;
}

template <class D>
Status Character<D>::destroy(World<D>& world) {
  return world.destroy_body(body_);
}

template <class D>
typename Character<D>::Position Character<D>::feet() const {
  return position_ - Position(definition_.up * (definition_.half_length + definition_.radius));
}

template <class D>
Status Character<D>::teleport(World<D>& world, Position feet) {
  const Position center = feet + Position(definition_.up * (definition_.half_length + definition_.radius));
  if (const Status s = world.set_pose(body_, center, rotation_); !s.ok()) return s;
  position_ = center;
  velocity_ = {};
  rise_ = 0;
  ground_ = {};
  dropping_ = false;
  return {};
}

template <class D>
void Character<D>::restore(const CharacterState<D>& state) {
  position_ = state.center;
  velocity_ = state.velocity;
  rise_ = state.rise;
  ground_ = state.ground;
  dropping_ = state.dropping;
}

/// The way nearest to `wanted` that crosses no plane: Hildreth's method on the dual, x = wanted + Σ λ n with λ ≥ 0.
/// What is too steep to walk on is a vertical wall for whatever does not fall. With keep_height, all but the ground is.
template <class D>
typename Character<D>::Vector Character<D>::fit(Vector wanted, bool keep_height) const {
  constexpr int most = 64;
  struct Row {
    Vector normal{};
    float least = 0, lambda = 0;
  } row[most];
  int count = 0;
  const Vector up = definition_.up;
  for (const Plane& p : planes_) {
    if (count == most) break;
    const float least = -p.gap;
    const float rise = dot(p.normal, up);
    const bool wall = keep_height ? !p.walkable && rise > 0 && p.height > 2 * definition_.skin
                                  : rise > 0 && rise < least_up_ && !carries(p);
    if (wall && rise < 0.9999f) {
      // A vertical wall through the nearest point: reached by the level way g/cos.
      const Vector level = p.normal - up * rise;
      const float size = math::length(level);
      if (dot(level, wanted) < 0 && count < most) row[count++] = {level / size, min(least / size, 0.0f), 0};
      if (count == most) break;
    }
    row[count++] = {p.normal, least, 0};
  }
  Vector x = wanted;
  for (int pass = 0; pass < 64; ++pass) {
    float change = 0;
    for (int i = 0; i < count; ++i) {
      const float next = max(row[i].lambda + row[i].least - dot(row[i].normal, x), 0.0f);
      const float step = next - row[i].lambda;
      if (step == 0) continue;
      x += row[i].normal * step;
      row[i].lambda = next;
      change = max(change, math::abs(step));
    }
    if (change < 0.01f * tiny) break;
  }
  return x;
}

/// Goes `way` as far as the planes let it; looks again where it was led aside.
template <class D>
void Character<D>::slide(const World<D>& world, Vector way, bool keep_height) {
  for (int i = 0; i < 4; ++i) {
    find_planes(world, {}, math::length(way) + ground_gap);
    const Vector x = fit(way, keep_height);
    position_ += Position(x);
    way -= x;
    if (math::length(x) < 0.01f * definition_.skin || math::length(way) < 0.01f * definition_.skin) break;
    if (!kept_from_afar(planes_, x, definition_.skin)) break;
  }
}

/// Goes straight in `direction` until something is at the skin; returns the way gone. Conservative advancement. Where
/// something stopped it, the planes are those of the place.
template <class D>
float Character<D>::advance(const World<D>& world, const Vector& direction, float way) {
  float gone = 0;
  stopped_ = false;
  for (int i = 0; i < 12 && way - gone > tiny; ++i) {
    // A short look first: who follows the ground finds it at once, with a few triangles.
    float step = i == 0 ? min(way, 0.2f * definition_.radius) : way - gone;
    find_planes(world, direction * step, ground_gap);
    const float most = step;
    for (const Plane& p : planes_) {
      const float toward = -dot(p.normal, direction);
      if (toward > 1e-3f) step = min(step, max(p.gap, 0.0f) / toward);
    }
    position_ += Position(direction * step);
    gone += step;
    // After a short way the planes are those of its end but for a hundredth of the skin, which is the sagitta of the
    // round end over it, and never nearer than the obstacle: distances of convex shapes are convex functions.
    const float bend = step * step / (2 * definition_.radius);
    stopped_ = step < 10 * tiny || (step < most && bend < 0.01f * definition_.skin);
    if (stopped_) {
      for (Plane& p : planes_) {
        p.gap += step * dot(p.normal, direction);
        p.height -= step * dot(direction, definition_.up);
      }
      break;
    }
  }
  return gone;
}

/// Up, on, and down again: true and there, if that leads farther than the wall did and ends on ground. Nothing stands
/// in the way of what has come as far as it `wanted` to along the way; uphill that is less than the length of the walk.
template <class D>
bool Character<D>::climb(const World<D>& world, const Vector& way, float wanted, const Position& start) {
  const Vector up = definition_.up;
  const Position stopped = position_;
  const float length = math::length(way);
  const Vector ahead = way / length;
  const float before = float(dot(stopped - start, Position(ahead)));
  if (before > 0.99f * wanted) return false;
  // What can be walked on is no step.
  bool steep = false;
  for (const Plane& p : planes_) steep = steep || (!p.walkable && dot(p.normal, ahead) < 0);
  if (!steep) return false;
  position_ = start;
  const float raised = advance(world, up, definition_.step_height);
  slide(world, way, true);
  const float went = float(dot(position_ - start, Position(ahead)));
  if (went > before + 0.25f * length) {  // less is only the skin at an edge
    advance(world, -up, raised + ground_gap);
    if (!stopped_) find_planes(world, {}, ground_gap);
    // What carries it must not lie higher above where it began than a step: it has not been lifted over an edge.
    const float lifted = float(dot(position_ - start, Position(up)));
    for (const Plane& p : planes_)
      if (p.gap < ground_gap && lifted + p.height < definition_.step_height + 2 * definition_.skin && carries(p))
        return true;
  }
  position_ = stopped;
  return false;
}

/// Gives what stands in the way the speed of the walk, with no more than push_force.
template <class D>
void Character<D>::push_bodies(World<D>& world, const Vector& walk) {
  const Vector up = definition_.up;
  for (Plane& p : planes_) {
    if (!p.dynamic || dot(p.normal, up) > 0.7f) continue;
    Vector to = p.normal - up * dot(p.normal, up);
    const float size = math::length(to);
    if (size < 1e-3f) continue;
    to *= -1 / size;
    const float wanted = dot(walk, to);
    if (wanted <= 0 || p.gap > wanted * dt_ + 0.5f * definition_.skin) continue;
    const BodyId body = of(p).body_id;
    const BodyState<D>& s = of(p).body;
    const Vector arm(p.point - s.center_of_mass);
    const float moves = dot(s.linear_velocity + cross(s.angular_velocity, arm), to);
    if (moves >= wanted) continue;
    const float impulse = min(definition_.push_force * dt_, (wanted - moves) * s.mass);
    if (!(impulse > 0)) continue;
    (void)world.add_impulse_at(body, to * impulse, p.point);
    const Result<BodyState<D>> now = world.state(body);
    if (now.ok()) {
      for (detail::Neighbour<D>& n : around_->near)
        if (n.body_id == body) n.body = now.value();
      const float closing =
          dot(way_of_point(now.value().linear_velocity, now.value().angular_velocity, arm, dt_), p.normal);
      p.gap += p.closing - min(closing, 0.0f);
      p.closing = min(closing, 0.0f);
    }
  }
}

/// The way that the ground goes in this move.
template <class D>
typename Character<D>::Vector Character<D>::carry(const World<D>& world) {
  if (ground_.state != GroundState::on_ground) return {};
  const Result<BodyState<D>> state = world.state(ground_.body);
  if (!state.ok()) return {};
  const BodyState<D>& s = state.value();
  const Vector belt = ground_.belt * dt_;
  if (s.type == BodyType::fixed || !s.awake) return belt;
  return way_of_point(s.linear_velocity, s.angular_velocity, Vector(ground_.point - s.center_of_mass), dt_) + belt;
}

/// Sets what is under the feet; who stood and did not jump is kept on the ground down a step.
template <class D>
void Character<D>::follow_ground(const World<D>& world, bool jumped, bool stood) {
  const Vector up = definition_.up;
  const Position here = position_;
  stopped_ = false;
  if (stood && !jumped) advance(world, -up, definition_.step_height + ground_gap);
  if (!stopped_) find_planes(world, {}, ground_gap);
  ground_ = {};
  const Plane* best = nullptr;
  for (const Plane& p : planes_) {
    if (p.gap > ground_gap || dot(p.normal, up) < 0.05f || (jumped && rise_ > 0)) continue;
    if (best == nullptr || (carries(p) && !carries(*best)) ||
        (carries(p) == carries(*best) && dot(p.normal, up) > dot(best->normal, up)))
      best = &p;
  }
  if (best == nullptr || !carries(*best)) position_ = here;
  if (best == nullptr) return;
  ground_.state = carries(*best) ? GroundState::on_ground : GroundState::on_steep;
  ground_.body = of(*best).body_id;
  ground_.shape = of(*best).id;
  ground_.point = best->point;
  ground_.normal = best->normal;
  ground_.slope = math::acos(clamp(dot(best->normal, up), -1.0f, 1.0f));
  if (const BodyState<D>& s = of(*best).body; s.type != BodyType::fixed)
    ground_.velocity = s.linear_velocity + cross(s.angular_velocity, Vector(best->point - s.center_of_mass));
  ground_.belt = belt_of(world, *best);
  ground_.velocity += ground_.belt;
}

template <class D>
Status Character<D>::move(World<D>& world, Vector velocity, float dt) {
  detail::Complaint complaint("Character::move");
  detail::check_size(complaint, "velocity", velocity, detail::max_velocity);
  detail::check_range(complaint, "dt", double(dt), 1e-9, 1);
  if (complaint.none_yet() && !world.contains(body_))
    complaint.say("the character's body does not exist in this world");
  if (!complaint.none_yet()) return complaint.error();
  dt_ = dt;
  held_ = false;
  const Vector up = definition_.up;
  const Position begin = position_;
  const bool stood = ground_.state == GroundState::on_ground;
  const bool jumped = stood && dot(velocity, up) > 0;
  Vector walk = velocity - up * dot(velocity, up);
  const float speed = math::length(walk);
  const Vector ride = carry(world);
  if (jumped) rise_ = dot(velocity, up) + max(dot(ground_.velocity, up), 0.0f);

  // Along the ground where it stands; else it falls by v t + ½ g t².
  Vector way = walk * dt;
  if (stood && !jumped) {
    rise_ = 0;
    const float n = dot(ground_.normal, up);
    if (speed > 0 && n >= least_up_) {
      Vector along = walk - up * (dot(walk, ground_.normal) / n);
      way = along * (dt * speed / math::length(along));
    }
    if (definition_.mass > 0) {
      const Result<BodyState<D>> state = world.state(ground_.body);
      const float weight = -dot(world.definition().gravity, up) * definition_.mass;
      if (state.ok() && state.value().type == BodyType::dynamic && weight > 0)
        (void)world.add_impulse_at(ground_.body, up * (-weight * dt), ground_.point);
    }
  } else {
    const float pull = dot(world.definition().gravity, up);
    way += up * (rise_ * dt + 0.5f * pull * dt * dt);
    rise_ += pull * dt;
  }
  reach_ = 1.3f * (math::length(way) + math::length(ride)) + 2 * (ground_gap + definition_.skin);
  look_around(world, {});
  find_planes(world, {}, math::length(way) + math::length(ride) + ground_gap);
  if (speed > 0) push_bodies(world, walk);
  const Vector allowed = fit(way + ride, false);
  position_ += Position(allowed);
  Vector rest = way + ride - allowed;
  if (math::length(rest) > definition_.skin && math::length(allowed) > 0.01f * definition_.skin &&
      kept_from_afar(planes_, allowed, definition_.skin))
    slide(world, rest, false);
  if (stood && !jumped && speed > 0) climb(world, walk * dt, dot(way, walk) / speed, begin + Position(ride));
  if (!stood || jumped) {
    const float rose = float(dot(position_ - begin, Position(up)));
    if (math::abs(rose - dot(way, up)) > 10 * tiny)  // something stopped it
      rise_ = rise_ > 0 ? min(rise_, max(rose / dt, 0.0f)) : max(rise_, min(rose / dt, 0.0f));
  }
  follow_ground(world, jumped, stood);
  if (ground_.state == GroundState::on_ground) rise_ = 0;
  dropping_ = dropping_ && held_;
  velocity_ = Vector(position_ - begin) / dt;
  return world.set_pose(body_, position_, rotation_);
}

}  // namespace carom::rigid

#include "carom/rigid/detail/character_planes.inl"

namespace carom::rigid {

template class Character<Dim2>;
template class Character<Dim3>;

}  // namespace carom::rigid
