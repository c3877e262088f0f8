// Particles of ropes against the shapes of the world; segments between them are in rope_edges.cpp.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

namespace {

constexpr double rope_slip = 0.01;       // m/s: friction grows up to here
constexpr int friction_iterations = 15;  // in which how things rub is found anew
constexpr double meet_depth = 0.25;      // radii: where a motion within a substep enters a shape
constexpr int meet_steps = 24;
constexpr double most_way = 0.5;      // of half a body, that it may come in a substep in which it is met
constexpr double most_turn = 0.3;     // rad, by which such a substep may change its turn
constexpr double most_stray = 0.2;    // of half a body: four times as far a way in its frame may bend off its chord
constexpr double least_turn = 0.005;  // rad in a substep: less is none

}  // namespace

Vec3d RopeSolver::shape_point(const RopeShape& shape, Vec3d point) const {
  const RopeBody& body = set.bodies_[std::size_t(shape.body)];
  const Vec3d local = inverse_rotate(body.rotation, point - body.center) + body.local_center;
  return inverse_rotate(shape.turn, local - shape.place);
}

/// How far from it what is near a particle is looked for.
double RopeSolver::reach_at(const Rope& rope, double speed) const {
  return 0.25 * rope.segment + 1.5 * dt * (speed + dt * length(gravity));
}

double RopeSolver::pace(const Rope& rope, std::size_t i, bool solved) const {
  const double speed = length(rope.velocity[i]);
  return solved ? math::max(speed, length(rope.solution[i])) : speed;
}

/// A blow may throw a particle beyond where it was to be in this step.
bool RopeSolver::strayed(const Rope& rope, bool solved) const {
  if (!rope.collide) return false;
  for (std::size_t i = 0; i < rope.position.size(); ++i)
    if (rope.room[i] < h * pace(rope, i, solved)) return true;
  return false;
}

bool RopeSolver::search(bool solved) {
  const std::size_t known = set.bodies_.size();
  bool any = false;
  for (Rope& rope : set.ropes_) {
    if (!strayed(rope, solved)) continue;
    find_contacts(rope, solved);
    any = true;
  }
  if (!any) return false;
  find_mobility(known);
  for (Rope& rope : set.ropes_) find_touched(rope);
  return true;
}

void RopeSolver::find_shapes(const geometry::Bounds3d& bounds) {
  (void)world.overlap_bounds(grow(bounds, dt * usual_body), set.found_);
  for (const FastShape& fast : set.fast_) {
    if (!overlaps(fast.way, bounds)) continue;
    alert = true;
    if (std::find(set.found_.begin(), set.found_.end(), fast.id) == set.found_.end()) set.found_.push_back(fast.id);
  }
}

void RopeSolver::find_contacts(Rope& rope, bool solved) {
  const std::size_t n = rope.position.size();
  if (!rope.collide) return;
  const double radius = rope.material.radius;
  geometry::Bounds3d bounds{rope.position[0], rope.position[0]};
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    bounds.low = min(bounds.low, rope.position[i]);
    bounds.high = max(bounds.high, rope.position[i]);
    const double speed = pace(rope, i, solved);
    fastest = math::max(fastest, speed);
    rope.room[i] = reach_at(rope, speed);
  }
  const double reach = reach_at(rope, fastest);
  find_shapes(grow(bounds, radius + reach));

  const auto forget = [](RopeContact& contact) {
    contact.separation = contact.comes_in = 1e30, contact.near = contact.coming = -1;
  };
  for (RopeContact& contact : rope.contacts) forget(contact);
  for (RopeEdge& edge : rope.edges) forget(edge.contact);
  for (const rigid::ShapeId id : set.found_) {
    const auto definition = world.shape_definition(id);
    const auto owner = world.body_of(id);
    if (!definition || !owner || definition->sensor) continue;
    if (!filters_meet(definition->filter, rope.filter)) continue;
    bool ignored = false;
    for (const RopeGrip& grip : rope.grips) ignored |= grip.attachment.body == *owner && !grip.attachment.collide;
    if (ignored) continue;
    const auto shape = world.shape_geometry(id);
    const int index = body_index(*owner);
    if (!shape || index < 0) continue;
    const int number = int(set.shapes_.size());
    const geometry::Bounds3f tight = geometry::bounds(*shape, {});
    const Vec3f extents = tight.extents();
    const bool fast = length(set.bodies_[std::size_t(index)].velocity) > usual_body;
    set.shapes_.push_back({fast, *shape, id, index, double(math::min(extents.x, math::min(extents.y, extents.z))),
                           double(definition->material.friction), Quatd(definition->local.q),
                           Vec3d(definition->local.p)});
    const RopeBody& body = set.bodies_[std::size_t(index)];
    for (std::size_t i = 0; i < n; ++i) {
      double speed = length(rope.velocity[i] - body.velocity_at(rope.position[i]));
      if (solved) speed = math::max(speed, length(rope.solution[i] - body.velocity_at(rope.position[i])));
      const double margin = reach_at(rope, speed);
      const Vec3f local(shape_point(set.shapes_.back(), rope.position[i]));
      if (!contains(grow(tight, float(radius + margin)), geometry::Bounds3f{local, local})) continue;
      Vec3f normal;
      float separation = 0;
      if (!nearest_surface(set.shapes_.back(), local, float(radius), float(margin), normal, separation)) continue;
      offer(rope.contacts[i], number, double(separation), length(body.velocity));
    }
    find_edges(rope, number, tight, solved);
  }
  const auto take = [&](RopeContact& contact) {
    const RopeHold state = contact.state;
    const rigid::ShapeId before = contact.shape;
    if (contact.near < 0) {
      const int coming = contact.coming;
      contact = RopeContact{};
      contact.coming = coming;
      return;
    }
    touch(contact, rope, contact.near);
    contact.state = contact.shape == before ? state : RopeHold::none;
  };
  for (RopeContact& contact : rope.contacts) take(contact);
  for (RopeEdge& edge : rope.edges) {
    take(edge.contact);
    if (edge.contact.near < 0) edge = RopeEdge{.contact = edge.contact};
  }
}

/// What is nearest, and beside it what comes fast and may be met before the step ends.
void RopeSolver::offer(RopeContact& contact, int number, double separation, double speed) const {
  if (speed > usual_body) {
    if (separation / speed >= contact.comes_in) return;
    contact.comes_in = separation / speed;
    contact.coming = number;
    return;
  }
  if (separation >= contact.separation) return;
  contact.separation = separation;
  contact.near = number;
}

void RopeSolver::touch(RopeContact& contact, const Rope& rope, int number) const {
  const RopeShape& near = set.shapes_[std::size_t(number)];
  contact.near = number;
  contact.shape = near.id;
  contact.body = near.body;
  contact.friction = math::sqrt(rope.material.friction * near.friction);
}

/// What comes fast and may be here within the substep takes the place of what does not touch.
void RopeSolver::choose(Rope& rope) {
  const auto look = [&](RopeContact& contact, Vec3d at, Vec3d velocity, double reach) {
    if (contact.coming < 0 || contact.state != RopeHold::none || contact.near == contact.coming) return;
    const RopeShape& near = set.shapes_[std::size_t(contact.coming)];
    const RopeBody& body = set.bodies_[std::size_t(near.body)];
    if (contact.near >= 0) {
      // Not before it can be here.
      const double way = h * length(velocity - body.velocity_at(at));
      const Vec3d local = shape_point(near, at);
      if (nearest(near, {{local, local}}, rope.material.radius).separation > 1.5 * way + reach) return;
    }
    touch(contact, rope, contact.coming);
  };
  for (std::size_t i = 0; i < rope.position.size(); ++i) look(rope.contacts[i], rope.position[i], rope.velocity[i], 0);
  for (std::size_t e = 0; e < rope.edges.size(); ++e)
    look(rope.edges[e].contact, 0.5 * (rope.position[e] + rope.position[e + 1]),
         0.5 * (rope.velocity[e] + rope.velocity[e + 1]), 0.5 * distance(rope.position[e], rope.position[e + 1]));
}

Vec3d RopeSolver::shape_point_after(const RopeShape& shape, Vec3d point, Vec3d velocity, bool solved) const {
  const RopeBody& body = set.bodies_[std::size_t(shape.body)];
  Vec3d drift = velocity - body.velocity_at(point);
  if (solved) drift -= change_at(shape.body, point - body.center);
  // What stays by the surface goes round with it. What comes from afar keeps its line while the body turns.
  if (h * length(drift) < 0.5 * shape.half) return shape_point(shape, point + h * drift);
  drift = velocity - body.velocity;
  Vec3d spin = body.spin;
  if (solved) {
    drift -= change_at(shape.body, {});
    spin += spin_change(shape.body);
  }
  const Quatd rotation = length_squared(spin) > 0 ? integrate(body.rotation, h * spin) : body.rotation;
  const Vec3d local = inverse_rotate(rotation, point + h * drift - body.center) + body.local_center;
  return inverse_rotate(shape.turn, local - shape.place);
}

RopePlace RopeSolver::edge_place(const Rope& rope, std::size_t e, const RopeShape& shape) const {
  return {{shape_point(shape, rope.position[e]), shape_point(shape, rope.position[e + 1])}};
}

RopePlace RopeSolver::edge_place_after(const Rope& rope, std::size_t e, const RopeShape& shape,
                                       const std::vector<Vec3d>& velocity, bool solved) const {
  return {{shape_point_after(shape, rope.position[e], velocity[e], solved),
           shape_point_after(shape, rope.position[e + 1], velocity[e + 1], solved)}};
}

RopeNearest RopeSolver::nearest(const RopeShape& shape, const RopePlace& place, double radius) const {
  RopeNearest found;
  const auto separation = [&](double share) {
    float out = 1e30f;
    (void)nearest_surface(shape, Vec3f(place.at(share)), float(radius), 1e3f, found.normal, out);
    return double(out);
  };
  if (place.end[0] != place.end[1]) found.share = nearest_share(separation);
  found.separation = separation(found.share);
  return found;
}

RopeNearest RopeSolver::meet(const RopeShape& shape, const RopePlace& now, const RopePlace& then,
                             const RopeNearest& last, double radius) const {
  const double motion = detail::motion(now, then);
  const double room = meet_depth * radius;
  if (last.separation - motion > -room) return last;
  RopeNearest at = nearest(shape, now, radius);
  // What is deep already may come out, and go no deeper. Nowhere on the way is it deeper than the mean of both ends
  // less half of the motion, since a distance changes by no more than that.
  const double least = math::min(-room, at.separation - 0.5 * room);
  if (0.5 * (at.separation + last.separation - motion) > least) return last;
  double share = 0;
  for (int k = 0; k < meet_steps && at.separation > least + 0.1 * room; ++k) {
    share += (at.separation - least) / motion;
    if (share >= 1) return last;
    at = nearest(shape, lerp(now, then, share), radius);
  }
  at.separation += dot(then.at(at.share) - lerp(now, then, share).at(at.share), Vec3d(at.normal));
  return at;
}

/// Something that moves is to be met that comes farther in this substep than through half of a half of itself.
bool RopeSolver::comes_far() const {
  const auto far = [&](const RopeContact& contact, const RopeNode& node, Vec3d velocity, double radius) {
    if (contact.near < 0 || node.body < 0 || node.hold == RopeHold::attached) return false;
    const RopeBody& body = set.bodies_[std::size_t(contact.body)];
    if (!body.moves && body.type != rigid::BodyType::kinematic) return false;
    if (dot(node.normal, velocity - node.target) >= 0) return false;
    const double closing = dot(node.normal, body.velocity + cross(body.spin, node.arm) - velocity);
    return h * closing > most_way * (set.shapes_[std::size_t(contact.near)].half + radius);
  };
  for (const Rope& rope : set.ropes_) {
    if (!rope.collide) continue;
    const double radius = rope.material.radius;
    for (std::size_t i = 0; i < rope.position.size(); ++i)
      if (far(rope.contacts[i], rope.nodes[i], rope.start[i], radius)) return true;
    for (std::size_t e = 0; e < rope.edges.size(); ++e) {
      const RopeEdge& edge = rope.edges[e];
      if (far(edge.contact, edge.point, lerp(rope.start[e], rope.start[e + 1], edge.share), radius)) return true;
    }
  }
  return false;
}

/// What was solved turns something by more than its arms and planes are good for, or goes through a plane, since who
/// holds what was not settled.
bool RopeSolver::goes_wrong() const {
  const auto wrong = [&](const RopeContact& contact, const RopeNode& node, Vec3d solved, double radius) {
    if (contact.near < 0 || node.body < 0 || node.hold == RopeHold::attached) return false;
    const RopeBody& body = set.bodies_[std::size_t(contact.body)];
    if (node.hold == RopeHold::none)
      return length(solved - body.velocity) > 0.5 * usual_body &&
             h * dot(node.normal, solved - node.target - change_at(node.body, node.arm)) < -radius;
    const Vec3d spin = spin_change(contact.body);
    return h * length(spin) > most_turn || h * length(body.spin + spin) > 2 * most_turn;
  };
  for (const Rope& rope : set.ropes_) {
    if (!rope.collide) continue;
    const double radius = rope.material.radius;
    for (std::size_t i = 0; i < rope.position.size(); ++i)
      if (wrong(rope.contacts[i], rope.nodes[i], rope.solution[i], radius)) return true;
    for (std::size_t e = 0; e < rope.edges.size(); ++e) {
      const RopeEdge& edge = rope.edges[e];
      if (wrong(edge.contact, edge.point, lerp(rope.solution[e], rope.solution[e + 1], edge.share), radius))
        return true;
    }
  }
  return false;
}

/// Something turns so much in this substep while it comes or is come by that its way in its own frame is no line.
bool RopeSolver::turns_on_its_way() const {
  for (const RopeShape& near : set.shapes_) {
    const RopeBody& body = set.bodies_[std::size_t(near.body)];
    const double turn = h * length(body.spin);
    if (turn < least_turn) continue;
    const Vec3f extents = geometry::bounds(near.shape, {}).extents();
    const Vec3d middle = body.place(near.place);
    for (const Rope& rope : set.ropes_) {
      if (!rope.collide) continue;
      const double reach = length(Vec3d(extents)) + rope.material.radius + rope.segment;
      for (std::size_t i = 0; i < rope.position.size(); ++i) {
        const double way = h * length(rope.velocity[i] - body.velocity);
        if (turn * way > most_stray * (near.half + rope.material.radius) &&
            distance(rope.position[i], middle) < reach + way)
          return true;
      }
    }
  }
  return false;
}

void RopeSolver::place_contacts(Rope& rope) {
  if (!rope.collide) return;
  choose(rope);
  for (std::size_t i = 0; i < rope.position.size(); ++i) {
    if (rope.contacts[i].near < 0 || rope.nodes[i].hold == RopeHold::attached) continue;
    place_contact(rope, i, false);
  }
}

// The plane where the particle will be: that of the start would brake what runs round a post, since the tension of the
// implicit step acts in the directions of its end.
void RopeSolver::place_contact(Rope& rope, std::size_t i, bool solved) {
  RopeContact& contact = rope.contacts[i];
  RopeNode& node = rope.nodes[i];
  const RopeShape& near = set.shapes_[std::size_t(contact.near)];
  const Vec3d at = rope.position[i], velocity = solved ? rope.solution[i] : rope.velocity[i];
  const double radius = rope.material.radius;
  const Vec3d from = shape_point(near, at), to = shape_point_after(near, at, velocity, solved);
  const RopeNearest last = nearest(near, {{to, to}}, radius);
  const RopeNearest meeting = meet(near, {{from, from}}, {{to, to}}, last, radius);
  if (!solved) contact.separation = nearest(near, {{from, from}}, radius).separation;
  const RopeBody& body = set.bodies_[std::size_t(contact.body)];
  node.normal = rotate(body.rotation, rotate(near.turn, Vec3d(meeting.normal)));
  place_hold(contact, node, at, velocity, meeting.separation, radius, solved);
}

/// Where a substep is to leave what is this deep at least: on the surface, or a fifth less deep than now.
double RopeSolver::depth_allowed(double separation) const {
  const double deep = math::min(separation, 0.0);
  return deep + math::min(-0.2 * deep, h * 1.0);
}

/// What holds a point of the rope in this substep, by the plane that `node.normal` and the separations here and ahead
/// tell.
void RopeSolver::place_hold(RopeContact& contact, RopeNode& node, Vec3d position, Vec3d velocity, double ahead,
                            double radius, bool solved) const {
  const RopeBody& body = set.bodies_[std::size_t(contact.body)];
  Vec3d drift = velocity - body.velocity_at(position);
  if (solved) drift -= change_at(contact.body, position - body.center);
  node.body = contact.body;
  node.arm = position - radius * node.normal - body.center;
  node.target = body.velocity + cross(body.spin, node.arm) +
                (dot(node.normal, drift) + (depth_allowed(contact.separation) - ahead) / h) * node.normal;
  if (!solved)
    node.hold = contact.state;
  else if (node.hold == RopeHold::none)
    node.hold = RopeHold::slide;
  const double most = h * contact.friction * contact.push;
  node.resistance = most / rope_slip;
  node.grip = h * (contact.grip - dot(contact.grip, node.normal) * node.normal);
  if (node.hold != RopeHold::slide) return;
  const Vec3d against = velocity - node.target;
  node.resistance = most / math::max(length(against - dot(against, node.normal) * node.normal), rope_slip);
  node.grip = {};
}

bool RopeSolver::place_again(Rope& rope) {
  if (!rope.collide) return false;
  bool any = false;
  const double radius = rope.material.radius, room = meet_depth * radius;
  // What moves as the planes were placed for is left out.
  const auto as_expected = [&](std::size_t i, const RopeContact& contact) {
    const RopeBody& body = set.bodies_[std::size_t(contact.body)];
    const Vec3d change = change_at(contact.body, rope.position[i] - body.center);
    return length(rope.solution[i] - rope.start[i] - change) < 0.5 * room / h;
  };
  const auto too_deep = [&](const RopeContact& contact, const RopePlace& now, const RopePlace& then) {
    const RopeShape& near = set.shapes_[std::size_t(contact.near)];
    return meet(near, now, then, nearest(near, then, radius), radius).separation <
           math::min(depth_allowed(contact.separation), 0.0) - room;
  };
  for (std::size_t i = 0; i < rope.position.size(); ++i) {
    const RopeContact& contact = rope.contacts[i];
    if (contact.near < 0 || rope.nodes[i].hold == RopeHold::attached || as_expected(i, contact)) continue;
    const RopeShape& near = set.shapes_[std::size_t(contact.near)];
    const Vec3d now = shape_point(near, rope.position[i]),
                then = shape_point_after(near, rope.position[i], rope.solution[i], true);
    if (!too_deep(contact, {{now, now}}, {{then, then}})) continue;
    place_contact(rope, i, true);
    any = true;
  }
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    const RopeContact& contact = rope.edges[e].contact;
    if (contact.near < 0 || rope.broken[e] || (as_expected(e, contact) && as_expected(e + 1, contact))) continue;
    const RopeShape& near = set.shapes_[std::size_t(contact.near)];
    const RopePlace now = edge_place(rope, e, near), then = edge_place_after(rope, e, near, rope.solution, true);
    if (too_deep(contact, now, then)) any |= place_edge(rope, e, true);
  }
  return any;
}

Vec3d RopeSolver::change_at(int index, Vec3d arm) const {
  if (index < 0) return {};
  const RopeBody& body = set.bodies_[std::size_t(index)];
  if (body.column < 0) return {};
  const double* change = &set.right_[std::size_t(body.column) * 6];
  return Vec3d{change[0], change[1], change[2]} + cross(Vec3d{change[3], change[4], change[5]}, arm);
}

Vec3d RopeSolver::spin_change(int index) const {
  const RopeBody& body = set.bodies_[std::size_t(index)];
  if (body.column < 0) return {};
  const double* change = &set.right_[std::size_t(body.column) * 6];
  return {change[3], change[4], change[5]};
}

// Coulomb's friction as an implicit resistance whose coefficient follows the normal force and the slip of the last
// iteration. What sticks keeps its grip from substep to substep, so that it does not creep.
bool RopeSolver::update_hold(RopeContact& contact, RopeNode& node, Vec3d velocity, int iteration) const {
  const Vec3d against = velocity - node.target - change_at(node.body, node.arm);
  const double closing = dot(node.normal, against);
  if (node.hold == RopeHold::none) {
    if (closing >= -1e-9) return false;
    node.hold = RopeHold::slide;
    node.resistance = 0;
    node.grip = {};
    return true;
  }
  const double push = dot(node.normal, node.reaction);
  if (push < 0) {
    node.hold = RopeHold::none;
    return true;
  }
  if (contact.friction == 0 || iteration >= friction_iterations) return false;
  const double most = contact.friction * push, speed = length(against - closing * node.normal);
  contact.slip = speed;
  const Vec3d along = node.reaction - push * node.normal;
  const double held = length(along);
  bool changed = false;
  if (node.hold == RopeHold::stick && held > most * 1.0001) {
    node.hold = RopeHold::slide;
    changed = true;
  }
  const Vec3d grip = node.grip;
  const double before = node.resistance;
  if (node.hold == RopeHold::stick) {
    node.resistance = most / rope_slip;
  } else if (speed > rope_slip) {
    node.resistance = most / speed;
    node.grip = {};
  } else {
    // About to slide: all of the friction that there is, the way it held; a tenth of it gives way with the slip.
    node.resistance = 0.1 * most / rope_slip;
    node.grip = held > 0 ? (math::max(most - node.resistance * speed, 0.0) / held) * along : Vec3d{};
  }
  return changed || math::abs(node.resistance - before) > 0.004 * (node.resistance + before) ||
         length(node.grip - grip) > 0.01 * most;
}

bool RopeSolver::update_holds(Rope& rope, int iteration) {
  if (!rope.collide) return false;
  bool changed = false;
  for (std::size_t i = 0; i < rope.position.size(); ++i) {
    if (rope.contacts[i].near < 0 || rope.nodes[i].hold == RopeHold::attached) continue;
    changed |= update_hold(rope.contacts[i], rope.nodes[i], rope.solution[i], iteration);
  }
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    RopeEdge& edge = rope.edges[e];
    if (edge.point.body < 0) continue;
    changed |=
        update_hold(edge.contact, edge.point, lerp(rope.solution[e], rope.solution[e + 1], edge.share), iteration);
  }
  return changed;
}

void RopeSolver::keep_contact(RopeContact& contact, const RopeNode& node, bool gone) const {
  contact.state = gone ? RopeHold::none : node.hold;
  contact.push = gone ? 0 : math::max(dot(node.normal, node.reaction), 0.0) / h;
  contact.grip = {};
  if (gone) return;
  Vec3d grip = node.reaction / h - (dot(node.normal, node.reaction) / h) * node.normal;
  const double size = length(grip), most = contact.friction * contact.push;
  contact.state = node.hold == RopeHold::slide && contact.slip > rope_slip ? RopeHold::slide : RopeHold::stick;
  if (size > most) grip = grip * (most / size);
  contact.grip = grip;
}

/// Both segments are held at one place: there they meet without touching.
bool RopeSolver::tied_together(const RopeCross& cross) const {
  const Rope &a = set.ropes_[std::size_t(cross.rope[0])], &b = set.ropes_[std::size_t(cross.rope[1])];
  const double near = 2 * (a.material.radius + b.material.radius);
  for (const RopeGrip& one : a.grips) {
    const int i = one.attachment.node;
    if (i != cross.segment[0] && i != cross.segment[0] + 1) continue;
    for (const RopeGrip& other : b.grips) {
      const int j = other.attachment.node;
      if (j != cross.segment[1] && j != cross.segment[1] + 1) continue;
      if (one.attachment.body == other.attachment.body &&
          distance(a.position[std::size_t(i)], b.position[std::size_t(j)]) < near)
        return true;
    }
  }
  return false;
}

}  // namespace carom::particles::detail
