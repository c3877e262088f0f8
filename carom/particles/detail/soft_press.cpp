// What the system left undone where something fast touches: a corner of several faces is held off one plane there.
#include <algorithm>

#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/nearest_share.h"
#include "carom/particles/detail/soft_face.h"

namespace carom::particles::detail {

namespace {

using Shape = SoftObstacles::Shape;

constexpr int press_sweeps = 30;
constexpr float press_least = 1e-6f;  // m, that a place may come too deep in a substep
constexpr float least_end = 0.01f;    // of an edge: nearer to its end the corner tells
constexpr float most_back = 0.2f;     // cosine to where the shape is, of what pushes an edge
constexpr int most_corners = 64;      // of a hull, each of which is asked for

/// The points of a convex shape that may come through a face: its corners, or where it is round those that are farthest
/// along a direction and beside it.
template <class F>
void visit_points(const geometry::Shape3& shape, Vec3f along, const F& visit) {
  if (shape.type == geometry::ShapeType3::box) {
    const Vec3f half = shape.box.half_extents;
    for (int k = 0; k < 8; ++k)
      visit(Vec3f{k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
    return;
  }
  if (shape.type == geometry::ShapeType3::hull && shape.hull->vertices.size() <= most_corners) {
    for (const Vec3f& vertex : shape.hull->vertices) visit(vertex + shape.hull->radius * along);
    return;
  }
  visit(geometry::support(shape, along));
  if (shape.type == geometry::ShapeType3::sphere) return;
  const Vec3f u = normalize(math::abs(along.x) < 0.6f ? cross(along, Vec3f{1, 0, 0}) : cross(along, Vec3f{0, 1, 0})),
              v = cross(along, u);
  for (const Vec3f& beside : {u, -u, v, -v}) visit(geometry::support(shape, normalize(along + beside)));
}

/// Where something fast meets a face and its edges.
void touch_face(SoftThing& thing, const Shape& shape, Vec3d middle, const std::uint32_t* corner, float h) {
  SoftFaceView face;
  if (!view_face(thing, shape, middle, corner, h, face)) return;
  const Vec3f from(middle - face.corner), nearest = nearest_share(face.u, face.v, from);
  const float apart = float(thing.apart), outer = float(shape.outer);
  if (length_squared(from - nearest.y * face.u - nearest.z * face.v) > math::square(outer + apart + face.margin))
    return;
  SoftFaceTouch touch;
  touch.plane.body = shape.body;
  touch.plane.friction = shape.friction;
  for (int k = 0; k < 3; ++k) touch.corner[k] = corner[k];
  const auto see = [&](Vec3f local) {
    touch.plane.at = shape.place + rotate(shape.turn, Vec3d(local));
    const Vec3f seen(touch.plane.at - face.corner);
    const float above = dot(face.to_shape, seen);
    if (above - apart > face.margin || above < -outer) return;
    touch.share = nearest_share(face.u, face.v, seen);
    const Vec3f beside = seen - above * face.to_shape - touch.share.y * face.u - touch.share.z * face.v;
    if (length(beside) > 0.01f * apart) return;
    touch.plane.normal = Vec3d(-face.to_shape);
    touch.plane.separation = double(above - apart);
    thing.face_touches.push_back(touch);
  };
  const Vec3f along(inverse_rotate(shape.turn, Vec3d(-face.to_shape)));
  if (shape.shape.type == geometry::ShapeType3::compound)
    for (const geometry::CompoundChild& part : shape.shape.compound->children)
      visit_points(part.shape, inverse_rotate(part.local.q, along),
                   [&](Vec3f point) { see(transform_point(part.local, point)); });
  else
    visit_points(shape.shape, along, see);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const std::uint64_t low = math::min(corner[k], corner[next]), high = math::max(corner[k], corner[next]),
                        edge = low << 32 | high;
    if (std::find(thing.seen_edges.begin(), thing.seen_edges.end(), edge) != thing.seen_edges.end()) continue;
    const Vec3f start(thing.position[corner[k]] - middle),
        way(thing.position[corner[next]] - thing.position[corner[k]]);
    const float along_way = math::clamp(-dot(start, way) / length_squared(way), 0.0f, 1.0f);
    if (length_squared(start + along_way * way) > math::square(outer + apart + face.margin)) continue;
    const float share = meet_edge(thing, shape, corner[k], corner[next], touch.plane);
    // What an edge is pushed out of must be on its side of the face; from the middle of a shape either way is as near.
    if (dot(Vec3f(touch.plane.normal), face.to_shape) > most_back) continue;
    thing.seen_edges.push_back(edge);
    if (touch.plane.separation > double(face.margin) || math::min(share, 1 - share) < least_end) continue;
    touch.share = {};
    touch.share[k] = 1 - share;
    touch.share[next] = share;
    thing.face_touches.push_back(touch);
  }
}

/// What the body of a touch answers to an impulse of 1 N·s along its normal.
SoftTwist answer_of(const SoftPlane& plane, const SoftObstacles& obstacles, const SoftSolver& solver) {
  const SoftObstacles::Body& body = obstacles.bodies[std::size_t(plane.body)];
  if (!body.moves) return {};
  const auto& m = solver.movers[std::size_t(plane.body)].mass;
  math::Mat3d inertia;
  for (int k = 0; k < 3; ++k) inertia.column(k) = {m[3][3 + k], m[4][3 + k], m[5][3 + k]};
  const Vec3d n = plane.normal;
  return {{n.x / m[0][0], n.y / m[1][1], n.z / m[2][2]}, math::inverse(inertia) * cross(plane.at - body.center, n)};
}

}  // namespace

void find_face_touches(SoftThing& thing, float h) {
  const std::span<const std::uint32_t> corners = thing.faces();
  for (std::size_t i = 0; i < thing.position.size(); ++i)
    if (thing.touches[i].near) {
      const std::uint32_t k = std::uint32_t(i);
      thing.face_touches.push_back({{k, k, k}, {1, 0, 0}, thing.touches[i].plane, 0, 0, {}, 0});
    }
  for (const Shape& shape : thing.obstacles.shapes()) {
    if (!shape.fast || !(is_convex(shape.shape) || shape.shape.type == geometry::ShapeType3::compound)) continue;
    const Vec3d middle = shape.middle();
    thing.seen_edges.clear();
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
      if (thing.folded.empty() || thing.folded[k / 3] == 0) touch_face(thing, shape, middle, &corners[k], h);
  }
}

void press_faces(SoftThing& thing, float h, Vec3d* pin_impulse) {
  SoftObstacles& obstacles = thing.obstacles;
  SoftSolver& solver = thing.solver;
  const auto lightness_of = [&](std::size_t i) { return thing.pin_of[i] >= 0 ? 0 : 1 / thing.mass[i]; };
  for (SoftFaceTouch& touch : thing.face_touches) {
    const Vec3d n = touch.plane.normal;
    const float deep = float(touch.plane.separation);
    touch.least = deep > 0 ? -deep / h : math::min(-0.2f * deep / h, greatest_rise(touch.plane, obstacles));
    touch.answer = answer_of(touch.plane, obstacles, solver);
    const Vec3d arm = touch.plane.at - obstacles.bodies[std::size_t(touch.plane.body)].center;
    touch.lightness = float(dot(n, touch.answer.at(arm)));
    for (int k = 0; k < 3; ++k) touch.lightness += math::square(touch.share[k]) * lightness_of(touch.corner[k]);
  }
  for (int sweep = 0; sweep < press_sweeps; ++sweep) {
    float most = 0;
    for (SoftFaceTouch& touch : thing.face_touches) {
      const SoftObstacles::Body& body = obstacles.bodies[std::size_t(touch.plane.body)];
      SoftMover& mover = solver.movers[std::size_t(touch.plane.body)];
      const Vec3d arm = touch.plane.at - body.center;
      Vec3f against(-body.velocity_at(touch.plane.at) - mover.change.at(arm));
      for (int k = 0; k < 3; ++k) {
        const std::size_t i = touch.corner[k];
        against += touch.share[k] * (thing.velocity[i] + solver.change[i].vector());
      }
      const Vec3f n(touch.plane.normal);
      if (!(touch.lightness > 0)) continue;
      const float missing = touch.least - dot(n, against);
      const float push = math::max(touch.impulse + missing / touch.lightness, 0.0f) - touch.impulse;
      if (!(math::abs(push) > 0)) continue;
      most = math::max(most, math::abs(push) * touch.lightness * h);
      touch.impulse += push;
      mover.change = mover.change - double(push) * touch.answer;
      for (int k = 0; k < 3; ++k) {
        const std::size_t i = touch.corner[k];
        solver.change[i] += (push * touch.share[k] * lightness_of(i)) * n;
      }
    }
    if (most < press_least) break;
  }
  for (const SoftFaceTouch& touch : thing.face_touches) {
    if (touch.impulse == 0) continue;
    const Vec3d impulse = double(touch.impulse) * touch.plane.normal;
    obstacles.push(touch.plane.body, touch.plane.at, -impulse);
    for (int k = 0; k < 3; ++k) {
      const int pin = thing.pin_of[touch.corner[k]];
      if (pin < 0) continue;
      if (pin_impulse) pin_impulse[pin] += double(touch.share[k]) * impulse;
      obstacles.push(thing.pins[std::size_t(pin)].index, thing.position[touch.corner[k]],
                     double(touch.share[k]) * impulse);
    }
  }
}

}  // namespace carom::particles::detail
