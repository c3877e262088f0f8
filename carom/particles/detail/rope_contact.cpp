// Particles of ropes against the shapes of the world; segments between them are in rope_edges.cpp.
#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/detail/rope_solver.h"
#include "carom/particles/detail/soft_obstacles.h"

namespace carom::particles::detail {

namespace {

constexpr double rope_slip = 0.01;                             // m/s: friction grows up to here
constexpr int touch_iterations = 6, friction_iterations = 15;  // in which what touches, and how it rubs, is found anew

}  // namespace

Vec3d RopeSolver::shape_point(const RopeShape& shape, Vec3d point) const {
  const RopeBody& body = set.bodies_[std::size_t(shape.body)];
  const Vec3d local = inverse_rotate(body.rotation, point - body.center) + body.local_center;
  return inverse_rotate(shape.turn, local - shape.place);
}

void RopeSolver::find_contacts(Rope& rope) {
  const std::size_t n = rope.position.size();
  if (!rope.collide) return;
  const double radius = rope.material.radius;
  geometry::Bounds3d bounds{rope.position[0], rope.position[0]};
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    bounds.low = min(bounds.low, rope.position[i]);
    bounds.high = max(bounds.high, rope.position[i]);
    fastest = math::max(fastest, length(rope.velocity[i]));
  }
  const double reach = 0.25 * rope.segment + 1.5 * dt * (fastest + dt * length(gravity));
  (void)world.overlap_bounds(grow(bounds, radius + reach), set.found_);

  for (RopeContact& contact : rope.contacts) contact.separation = 1e30;
  for (RopeEdge& edge : rope.edges) edge.contact.separation = 1e30;
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
    set.shapes_.push_back({*shape, id, index, Quatd(definition->local.q), Vec3d(definition->local.p)});
    const double friction = math::sqrt(rope.material.friction * double(definition->material.friction));
    const geometry::Bounds3f tight = geometry::bounds(*shape, {});
    for (std::size_t i = 0; i < n; ++i) {
      const double margin = 0.25 * rope.segment + 1.5 * dt * (length(rope.velocity[i]) + dt * length(gravity));
      const Vec3f local(shape_point(set.shapes_.back(), rope.position[i]));
      if (!contains(grow(tight, float(radius + margin)), geometry::Bounds3f{local, local})) continue;
      RopeContact& contact = rope.contacts[i];
      Vec3f normal;
      float separation = 0;
      if (!nearest_plane(*shape, local, float(radius), float(margin), normal, separation)) continue;
      if (double(separation) >= contact.separation) continue;
      if (contact.shape != id) contact.state = RopeHold::none;
      contact.separation = double(separation);
      contact.shape = id;
      contact.near = number;
      contact.body = index;
      contact.friction = friction;
    }
    find_edges(rope, set.shapes_.back(), number, friction, tight);
  }
  for (RopeContact& contact : rope.contacts)
    if (contact.separation == 1e30) contact = RopeContact{};
  for (RopeEdge& edge : rope.edges)
    if (edge.contact.separation == 1e30) edge = RopeEdge{};
}

void RopeSolver::place_contacts(Rope& rope) {
  if (!rope.collide) return;
  for (std::size_t i = 0; i < rope.position.size(); ++i) {
    RopeContact& contact = rope.contacts[i];
    RopeNode& node = rope.nodes[i];
    if (contact.near < 0 || node.hold == RopeHold::attached) continue;
    // The plane where the particle will be: that of the start would brake what runs round a post, since the tension of
    // the implicit step acts in the directions of its end.
    const RopeShape& near = set.shapes_[std::size_t(contact.near)];
    const RopeBody& body = set.bodies_[std::size_t(contact.body)];
    const float radius = float(rope.material.radius);
    const Vec3d drift = rope.velocity[i] - body.velocity_at(rope.position[i]);
    const Vec3d from = shape_point(near, rope.position[i]), to = shape_point(near, rope.position[i] + h * drift);
    Vec3f normal, side;
    float here = 0, there = 0;
    if (!nearest_plane(near.shape, Vec3f(from), radius, 1e3f, side, here) ||
        !nearest_plane(near.shape, Vec3f(to), radius, 1e3f, normal, there)) {
      contact.state = RopeHold::none;
      continue;
    }
    double ahead = double(there);
    if (dot(side, normal) < 0 && here > -radius && passes([&](double f) {
          Vec3f unused;
          float out = 1;
          (void)nearest_plane(near.shape, Vec3f(lerp(from, to, f)), radius, 1e3f, unused, out);
          return double(out);
        })) {  // what is thin: it stays on the side where it is
      normal = side;
      ahead = double(here) + dot(to - from, Vec3d(side));
    }
    contact.separation = double(here);
    node.normal = rotate(body.rotation, rotate(near.turn, Vec3d(normal)));
    place_hold(contact, node, rope.position[i], rope.velocity[i], ahead, rope.material.radius);
  }
}

/// What holds a point of the rope in this substep, by the plane that `node.normal` and the separations here and ahead
/// tell.
void RopeSolver::place_hold(RopeContact& contact, RopeNode& node, Vec3d position, Vec3d velocity, double ahead,
                            double radius) const {
  const RopeBody& body = set.bodies_[std::size_t(contact.body)];
  const Vec3d drift = velocity - body.velocity_at(position);
  node.body = contact.body;
  node.arm = position - radius * node.normal - body.center;
  // Where the step is to leave it at least: on the surface, or a fifth less deep than now.
  const double deep = math::min(contact.separation, 0.0), end = deep + math::min(-0.2 * deep, h * 1.0);
  node.target =
      body.velocity + cross(body.spin, node.arm) + (dot(node.normal, drift) + (end - ahead) / h) * node.normal;
  node.hold = contact.state;
  const double most = h * contact.friction * contact.push;
  node.resistance = most / rope_slip;
  node.grip = h * (contact.grip - dot(contact.grip, node.normal) * node.normal);
  if (contact.state != RopeHold::slide) return;
  const Vec3d against = velocity - node.target;
  node.resistance = most / math::max(length(against - dot(against, node.normal) * node.normal), rope_slip);
  node.grip = {};
}

Vec3d RopeSolver::change_at(const RopeNode& node) const {
  if (node.body < 0) return {};
  const RopeBody& body = set.bodies_[std::size_t(node.body)];
  if (body.column < 0) return {};
  const double* change = &set.right_[std::size_t(body.column) * 6];
  return Vec3d{change[0], change[1], change[2]} + cross(Vec3d{change[3], change[4], change[5]}, node.arm);
}

// Coulomb's friction as an implicit resistance whose coefficient follows the normal force and the slip of the last
// iteration. What sticks keeps its grip from substep to substep, so that it does not creep.
bool RopeSolver::update_hold(RopeContact& contact, RopeNode& node, Vec3d velocity, int iteration) const {
  const Vec3d against = velocity - node.target - change_at(node);
  const double closing = dot(node.normal, against);
  if (node.hold == RopeHold::none) {
    if (closing >= -1e-9 || iteration >= touch_iterations) return false;
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
