// Segments of ropes against the shapes of the world, where these are sharper than the segments are short: a capsule's
// nearest point, held by a stiffness far above the row's own.
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"
#include "carom/particles/detail/soft_obstacles.h"

namespace carom::particles::detail {

namespace {

constexpr double edge_stiffness = 1e6;  // over the mass of a segment's ends
// By which the middle is deeper than the ends, to be touched first, and to stay touched: in radii, or in fifths of a
// segment's length if that is more. On what is rounder than that (its radius more than two and a half segments) the
// particles lie: would now they and now the segments between them, a taut rope's way would change by more than it can
// stretch.
constexpr double edge_depth = 0.25, edge_kept = 0.1;
constexpr double edge_length = 0.2;

}  // namespace

void RopeSolver::find_edges(Rope& rope, const RopeShape& near, int number, double friction,
                            const geometry::Bounds3f& tight) {
  const double radius = rope.material.radius;
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    if (rope.broken[e]) continue;
    const double fastest = math::max(length(rope.velocity[e]), length(rope.velocity[e + 1]));
    const double margin = 0.5 * distance(rope.position[e], rope.position[e + 1]) + 0.25 * rope.segment +
                          1.5 * dt * (fastest + dt * length(gravity));
    const Vec3f middle(shape_point(near, 0.5 * (rope.position[e] + rope.position[e + 1])));
    if (!contains(grow(tight, float(radius + margin)), geometry::Bounds3f{middle, middle})) continue;
    RopeContact& contact = rope.edges[e].contact;
    Vec3f normal;
    float separation = 0;
    if (!nearest_plane(near.shape, middle, float(radius), float(margin), normal, separation)) continue;
    if (double(separation) >= contact.separation) continue;
    if (contact.shape != near.id) contact.state = RopeHold::none;
    contact.separation = double(separation);
    contact.shape = near.id;
    contact.near = number;
    contact.body = near.body;
    contact.friction = friction;
  }
}

void RopeSolver::place_edges(Rope& rope) {
  if (!rope.collide) return;
  const float radius = float(rope.material.radius);
  for (std::size_t e = 0; e < rope.edges.size(); ++e) {
    RopeEdge& edge = rope.edges[e];
    RopeContact& contact = edge.contact;
    edge.point = RopeNode{};
    if (contact.near < 0) continue;
    const RopeHold before = contact.state;
    contact.state = RopeHold::none;
    if (rope.broken[e]) continue;
    const RopeShape& near = set.shapes_[std::size_t(contact.near)];
    const RopeBody& body = set.bodies_[std::size_t(contact.body)];
    // In the shape's frame, now and where the ends drift to.
    Vec3d now[2], then[2];
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3d at = rope.position[e + k];
      now[k] = shape_point(near, at);
      then[k] = shape_point(near, at + h * (rope.velocity[e + k] - body.velocity_at(at)));
    }
    Vec3f normal;
    bool good = true;
    const auto separation = [&](Vec3d local) {
      float out = 0;
      good = good && nearest_plane(near.shape, Vec3f(local), radius, 1e3f, normal, out);
      return double(out);
    };
    const double ends = math::min(separation(then[0]), separation(then[1]));
    const double beyond = ends - 0.5 * distance(then[0], then[1]);
    if (!good || beyond > math::max(distance(now[0], then[0]), distance(now[1], then[1]))) continue;
    edge.share = nearest_share([&](double s) { return separation(lerp(then[0], then[1], s)); });
    const Vec3d from = lerp(now[0], now[1], edge.share), to = lerp(then[0], then[1], edge.share);
    contact.separation = separation(from);
    const Vec3f side = normal;
    double ahead = separation(to);
    // Through what is thin it would go within the substep: it stays on the side where it is.
    const bool through = dot(side, normal) < 0 && contact.separation > -double(radius) &&
                         passes([&](double f) { return separation(lerp(from, to, f)); });
    if (through) {
      normal = side;
      ahead = contact.separation + dot(to - from, Vec3d(side));
    }
    if (beyond > 0 && !through) continue;
    const double depth = (before == RopeHold::none ? edge_depth : edge_kept) *
                         math::max(rope.material.radius, edge_length * distance(then[0], then[1]));
    if (!good || edge.share < 0.01 || edge.share > 0.99 || ends - ahead < depth) continue;
    contact.state = before;
    edge.point.normal = rotate(body.rotation, rotate(near.turn, Vec3d(normal)));
    place_hold(contact, edge.point, lerp(rope.position[e], rope.position[e + 1], edge.share),
               lerp(rope.velocity[e], rope.velocity[e + 1], edge.share), ahead, rope.material.radius);
  }
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
    const Vec3d change = coupled ? change_at(point) : Vec3d{};
    const Vec3d velocity = lerp(rope.solution[e], rope.solution[e + 1], edge.share);
    point.reaction = edge.stiff * (point.target + change - velocity) + point.grip;
    // The rows know the body as it was: what its change pushes more is this edge's, not the particles' own hold.
    const Vec3d more = edge.stiff * change;
    if (rope.nodes[e].hold != RopeHold::none) rope.nodes[e].reaction -= (1 - edge.share) * more;
    if (rope.nodes[e + 1].hold != RopeHold::none) rope.nodes[e + 1].reaction -= edge.share * more;
  }
}

}  // namespace carom::particles::detail
