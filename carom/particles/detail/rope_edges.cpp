// Segments of ropes against the shapes of the world, where these are sharper than the segments are short: a capsule's
// nearest point, held by a stiffness far above the row's own.
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

namespace {

constexpr double edge_stiffness = 1e6;  // over the mass of a segment's ends
// By which the middle is deeper than the ends, to be touched first, and to stay touched: in radii, or in fifths of a
// segment's length if that is more. On what is rounder than that (its radius more than two and a half segments) the
// particles lie: would now they and now the segments between them, a taut rope's way would change by more than it can
// stretch.
constexpr double edge_depth = 0.25, edge_kept = 0.1;
constexpr double edge_length = 0.2;
constexpr double deepest = 0.8;  // of the way from the surface to the middle of what is thin
constexpr int free_steps = 32;

}  // namespace

void RopeSolver::find_edges(Rope& rope, int number, const geometry::Bounds3f& tight, bool solved) {
  const double radius = rope.material.radius;
  const RopeShape& near = set.shapes_[std::size_t(number)];
  const RopeBody& body = set.bodies_[std::size_t(near.body)];
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    if (rope.broken[e]) continue;
    double fastest = 0;
    for (const std::size_t i : {e, e + 1}) {
      const Vec3d there = body.velocity_at(rope.position[i]);
      fastest = math::max(fastest, length(rope.velocity[i] - there));
      if (solved) fastest = math::max(fastest, length(rope.solution[i] - there));
    }
    const double margin = 0.5 * distance(rope.position[e], rope.position[e + 1]) + reach_at(rope, fastest);
    const Vec3f middle(shape_point(near, 0.5 * (rope.position[e] + rope.position[e + 1])));
    if (!contains(grow(tight, float(radius + margin)), geometry::Bounds3f{middle, middle})) continue;
    Vec3f normal;
    float separation = 0;
    if (!nearest_surface(near, middle, float(radius), float(margin), normal, separation)) continue;
    offer(rope.edges[e].contact, number, double(separation), length(body.velocity));
  }
}

void RopeSolver::place_edges(Rope& rope) {
  if (!rope.collide) return;
  for (std::size_t e = 0; e < rope.edges.size(); ++e) (void)place_edge(rope, e, false);
}

bool RopeSolver::place_edge(Rope& rope, std::size_t e, bool solved) {
  RopeEdge& edge = rope.edges[e];
  RopeContact& contact = edge.contact;
  if (!solved) edge.before = contact.state;
  const RopeHold before = contact.state;
  if (!solved) {
    edge.point = RopeNode{};
    contact.state = RopeHold::none;
  }
  if (contact.near < 0 || rope.broken[e]) return false;
  const double radius = rope.material.radius;
  const RopeShape& near = set.shapes_[std::size_t(contact.near)];
  const RopeBody& body = set.bodies_[std::size_t(contact.body)];
  const std::vector<Vec3d>& velocity = solved ? rope.solution : rope.velocity;
  // In the shape's frame, now and where the ends drift to.
  const RopePlace now = edge_place(rope, e, near), then = edge_place_after(rope, e, near, velocity, solved);
  double ends = 1e30;
  for (const Vec3d& end : then.end) ends = math::min(ends, nearest(near, {{end, end}}, radius).separation);
  const double width = distance(then.end[0], then.end[1]), motion = detail::motion(now, then);
  if (!solved) edge.nearest = ends - 0.5 * width - motion;
  if (ends - 0.5 * width > motion) return false;
  const RopeNearest last = nearest(near, then, radius);
  if (!solved) edge.nearest = math::max(edge.nearest, last.separation - motion);
  const RopeNearest meeting = meet(near, now, then, last, radius);
  edge.share = meeting.share;
  if (!solved) contact.separation = nearest(near, {{now.at(edge.share), now.at(edge.share)}}, radius).separation;
  const double depth = (before == RopeHold::none ? edge_depth : edge_kept) * math::max(radius, edge_length * width);
  if (edge.share < 0.01 || edge.share > 0.99 || ends - meeting.separation < depth) return false;
  if (!solved) contact.state = before;
  edge.point.normal = rotate(body.rotation, rotate(near.turn, Vec3d(meeting.normal)));
  place_hold(contact, edge.point, lerp(rope.position[e], rope.position[e + 1], edge.share),
             lerp(velocity[e], velocity[e + 1], edge.share), meeting.separation, radius, solved);
  return true;
}

namespace {

/// From the surface of a convex shape to its middle, where the side that is nearest turns over; 0: not told.
double half_thickness(const geometry::Shape3& shape) {
  using geometry::ShapeType3;
  switch (shape.type) {
    case ShapeType3::sphere:
      return double(shape.sphere.radius);
    case ShapeType3::capsule:
      return double(shape.capsule.radius);
    case ShapeType3::cylinder:
      return double(math::min(shape.cylinder.radius, shape.cylinder.half_height) + shape.cylinder.rounding);
    case ShapeType3::box: {
      const Vec3f half = shape.box.half_extents;
      return double(math::min(half.x, math::min(half.y, half.z)) + shape.box.radius);
    }
    default:
      return 0;
  }
}

}  // namespace

/// The share of the substep's motion that leaves every segment on its side of the middle of what it lies on.
double RopeSolver::free_share(const Rope& rope) const {
  double share = 1;
  const double radius = rope.material.radius;
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    const RopeContact& contact = rope.edges[e].contact;
    if (contact.near < 0 || rope.broken[e]) continue;
    const RopeShape& near = set.shapes_[std::size_t(contact.near)];
    const double half = half_thickness(near.shape);
    if (half == 0) continue;
    const RopePlace now = edge_place(rope, e, near), then = edge_place_after(rope, e, near, rope.solution, false);
    const double motion = detail::motion(now, then);
    // Nearly at the middle, and so much nearer to it counts as there.
    const double core = radius + half, limit = -deepest * core, close = 0.05 * core;
    if (rope.edges[e].nearest - motion > limit) continue;
    RopeNearest at = nearest(near, now, radius);
    double gap = at.separation - limit;
    if (gap > motion) continue;
    if (gap < close) {
      const RopeNearest last = nearest(near, then, radius);
      if (last.separation > at.separation && dot(last.normal, at.normal) > 0) continue;
      return 0;
    }
    double here = 0;
    for (int k = 0; here + gap / motion < share; ++k) {
      here += gap / motion;
      gap = nearest(near, lerp(now, then, here), radius).separation - limit;
      if (gap < close || k == free_steps) share = here;
    }
  }
  return share;
}

/// What would go through something thin all the same goes as far as it may.
void RopeSolver::hold_back(Rope& rope) const {
  if (!rope.collide) return;
  const double share = free_share(rope);
  if (share == 1) return;
  for (std::size_t i = 0; i < rope.position.size(); ++i) rope.position[i] -= ((1 - share) * h) * rope.solution[i];
}

void RopeSolver::add_edges(Rope& rope) const {
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    RopeEdge& edge = rope.edges[e];
    const RopeNode& point = edge.point;
    if (point.hold == RopeHold::none) continue;
    const Mat3d normal = math::outer(point.normal, point.normal);
    edge.stiff = (edge_stiffness * (rope.mass[e] + rope.mass[e + 1])) * normal +
                 point.resistance * (Mat3d::identity() + (-1.0) * normal);
    const double b = edge.share, a = 1 - b;
    const Vec3d push = edge.stiff * point.target + point.grip;
    rope.diagonal[e] = rope.diagonal[e] + (a * a) * edge.stiff;
    rope.diagonal[e + 1] = rope.diagonal[e + 1] + (b * b) * edge.stiff;
    rope.upper[e] = rope.upper[e] + (a * b) * edge.stiff;
    rope.lower[e + 1] = rope.lower[e + 1] + (a * b) * edge.stiff;
    rope.momentum[e] += a * push;
    rope.momentum[e + 1] += b * push;
  }
}

/// What the edges beside a particle push on it where the body that they touch has this motion more.
Vec3d RopeSolver::edge_push(const Rope& rope, int node, int body, Vec3d velocity, Vec3d spin) const {
  Vec3d sum{};
  for (const int e : {node - 1, node}) {
    if (e < 0 || e >= int(rope.edges.size())) continue;
    const RopeEdge& edge = rope.edges[std::size_t(e)];
    if (edge.point.hold == RopeHold::none || edge.point.body != body) continue;
    sum += (e == node ? 1 - edge.share : edge.share) * (edge.stiff * (velocity + cross(spin, edge.point.arm)));
  }
  return sum;
}

/// The impulse of an edge on the rope for a unit of a body's motion.
Vec3d RopeSolver::edge_answer(const Rope& rope, std::size_t e, std::size_t t, int c) const {
  const RopeEdge& edge = rope.edges[e];
  const Vec3d* column = &rope.columns[(t * 6 + std::size_t(c)) * rope.position.size()];
  const int low = rope.reach[2 * t], high = rope.reach[2 * t + 1];
  const auto moved = [&](int i) { return i >= low && i <= high ? column[i] : Vec3d{}; };
  Vec3d against = -(1 - edge.share) * moved(int(e)) - edge.share * moved(int(e) + 1);
  const Vec3d unit{double(c % 3 == 0), double(c % 3 == 1), double(c % 3 == 2)};
  if (edge.point.body == rope.touched[t]) against += c < 3 ? unit : cross(unit, edge.point.arm);
  return edge.stiff * against;
}

void RopeSolver::react_edges(Rope& rope, bool coupled) const {
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    RopeEdge& edge = rope.edges[e];
    RopeNode& point = edge.point;
    if (point.hold == RopeHold::none) continue;
    const Vec3d change = coupled ? change_at(point.body, point.arm) : Vec3d{};
    const Vec3d velocity = lerp(rope.solution[e], rope.solution[e + 1], edge.share);
    point.reaction = edge.stiff * (point.target + change - velocity) + point.grip;
    // The rows know the body as it was: what its change pushes more is this edge's, not the particles' own hold.
    const Vec3d more = edge.stiff * change;
    if (rope.nodes[e].hold != RopeHold::none) rope.nodes[e].reaction -= (1 - edge.share) * more;
    if (rope.nodes[e + 1].hold != RopeHold::none) rope.nodes[e + 1].reaction -= edge.share * more;
  }
}

}  // namespace carom::particles::detail
