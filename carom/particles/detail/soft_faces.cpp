// Faces of cloth and soft bodies that something meets between their corners, and how far what is fast may come in a
// substep.
#include "carom/geometry/compound.h"
#include "carom/math/calculus.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/nearest_share.h"
#include "carom/particles/detail/nearest_surface.h"
#include "carom/particles/detail/soft_face.h"

namespace carom::particles::detail {

namespace {

using Shape = SoftObstacles::Shape;

constexpr float least_share = 0.1f;  // a corner that bears less of a touch is left to itself
constexpr int rim_steps = 12;
constexpr double small_outer = 3;       // edges, of a whole shape that lies between corners
constexpr double meeting_way = 0.5;     // of what is between the middle of a shape and what it meets
constexpr double meeting_turn = 0.2;    // rad, of what touches with its corners
constexpr double stretching_way = 0.5;  // of an edge

/// The farthest point of a shape, which may be of several parts, along a direction of the world; of it turned `as`, but
/// where it is now.
Vec3d farthest_along(const Shape& shape, const Quatd& as, Vec3f direction) {
  const Vec3f along(inverse_rotate(as, Vec3d(direction)));
  if (shape.shape.type != geometry::ShapeType3::compound)
    return shape.place + rotate(shape.turn, Vec3d(geometry::support(shape.shape, along)));
  Vec3f best{};
  bool found = false;
  for (const geometry::CompoundChild& part : shape.shape.compound->children) {
    const Vec3f point = transform_point(part.local, geometry::support(part.shape, inverse_rotate(part.local.q, along)));
    if (found && dot(point, along) <= dot(best, along)) continue;
    found = true;
    best = point;
  }
  return shape.place + rotate(shape.turn, Vec3d(best));
}

/// Where a shape meets a face, if it comes there by its motion in h.
bool meet_face(const SoftThing& thing, const Shape& shape, Vec3d middle, const std::uint32_t* corner, float h,
               SoftPlane& plane, Vec3f& share) {
  SoftFaceView face;
  if (!view_face(thing, shape, middle, corner, h, face)) return false;
  const Vec3f to_shape = face.to_shape, u = face.u, v = face.v;
  const float apart = float(thing.apart);
  Vec3d point = farthest_along(shape, shape.turn, -to_shape);
  const Vec3d spin = thing.obstacles.bodies[std::size_t(shape.body)].spin;
  if (spin != Vec3d{} && shape.shape.type != geometry::ShapeType3::sphere) {
    // A corner that will have turned below that one.
    const Vec3d then = farthest_along(shape, integrate(shape.turn, double(h) * spin), -to_shape), more = then - point;
    if (dot(Vec3d(to_shape), more + double(h) * cross(spin, more)) < 0) point = then;
  }
  const Vec3f seen(point - face.corner);
  const float above = dot(to_shape, seen);
  if (above - apart > face.margin || (thing.closed && above < -thing.mean_edge)) return false;
  share = nearest_share(u, v, seen);
  const Vec3f foot = share.y * u + share.z * v;
  plane.body = shape.body;
  plane.friction = shape.friction;
  if (length(seen - above * to_shape - foot) < 0.01f * apart) {
    plane.at = point;
    plane.normal = Vec3d(-to_shape);
    plane.separation = double(above - apart);
    return true;
  }
  // Beside the face: its rim may be met.
  int beyond = 0;
  for (int k = 1; k < 3; ++k)
    if (share[k] < share[beyond]) beyond = k;
  const int first = (beyond + 1) % 3, second = (beyond + 2) % 3;
  if (share[beyond] > 0 || math::min(share[first], share[second]) == 0) return false;
  share[second] = meet_edge(thing, shape, corner[first], corner[second], plane);
  share[first] = 1 - share[second];
  return plane.separation <= double(face.margin) && math::min(share[first], share[second]) >= least_share &&
         (!thing.closed || dot(Vec3f(plane.normal), face.outward) < 0);
}

/// The side of a sheet that a shape comes from, by the nearest face; as before while it stays near.
void find_side(const SoftThing& thing, Shape& shape) {
  const Vec3d middle = shape.middle();
  const std::span<const std::uint32_t> corners = thing.faces();
  float nearest = 1e30f, height = 0;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    const Vec3d a = thing.position[corners[k]];
    const Vec3f u(thing.position[corners[k + 1]] - a), v(thing.position[corners[k + 2]] - a), seen(middle - a);
    const Vec3f share = nearest_share(u, v, seen), twice = cross(u, v);
    const float away = length_squared(seen - share.y * u - share.z * v), size = length(twice);
    if (!(size > 1e-12f)) continue;
    const float above = dot(twice, seen) / size;
    // Of faces that share the nearest edge the one that it stands out from most tells.
    const float same = 1e-5f * (away + nearest);
    if (away > nearest + same || (away > nearest - same && math::abs(above) <= math::abs(height))) continue;
    nearest = math::min(nearest, away);
    height = above;
  }
  const bool near = nearest < math::square(float(shape.outer + 2 * thing.apart));
  if (!near)
    shape.side = 0;
  else if (shape.side == 0)
    shape.side = height >= 0 ? 1 : -1;
}

/// Whether faces meet a shape between their corners.
bool meets_faces(const SoftThing& thing, const Shape& shape) {
  if (!is_convex(shape.shape) && shape.shape.type != geometry::ShapeType3::compound) return false;
  const double edge = double(thing.mean_edge);
  return shape.fast || (shape.half <= edge && shape.outer <= small_outer * edge);
}

}  // namespace

bool view_face(const SoftThing& thing, const Shape& shape, Vec3d middle, const std::uint32_t* corner, float h,
               SoftFaceView& face) {
  face.corner = thing.position[corner[0]];
  face.u = Vec3f(thing.position[corner[1]] - face.corner);
  face.v = Vec3f(thing.position[corner[2]] - face.corner);
  const Vec3f from(middle - face.corner), velocity(thing.obstacles.bodies[std::size_t(shape.body)].velocity);
  float fastest = 0;
  for (int k = 0; k < 3; ++k) fastest = math::max(fastest, length_squared(thing.velocity[corner[k]] - velocity));
  const float apart = float(thing.apart), closing = math::sqrt(fastest) + float(shape.speed) - length(velocity);
  face.margin = apart + 2 * h * (closing + 20 * h);
  const float reach = float(shape.outer) + apart + face.margin;
  if (length_squared(from) > math::square(reach + math::max(length(face.u), length(face.v)))) return false;
  const Vec3f twice = cross(face.u, face.v);
  const float size = length(twice);
  if (!(size > 1e-12f)) return false;
  face.outward = twice / size;
  const float height = dot(face.outward, from);
  if (math::abs(height) > reach || (thing.closed && height < -thing.mean_edge)) return false;
  // Its middle may come beyond a face of a sheet that bears it, by less than half of itself.
  const bool kept = shape.side != 0 && math::abs(height) < float(shape.half);
  const bool before = thing.closed || (kept ? shape.side > 0 : height >= 0);
  face.to_shape = before ? face.outward : -face.outward;
  return true;
}

float meet_edge(const SoftThing& thing, const Shape& shape, std::uint32_t first, std::uint32_t second,
                SoftPlane& plane) {
  const auto local = [&](std::uint32_t i) { return inverse_rotate(shape.turn, thing.position[i] - shape.place); };
  const Vec3d from = local(first), to = local(second);
  const float radius = float(thing.apart);
  Vec3f normal{};
  const auto separation = [&](double at) {
    float out = 1e30f;
    (void)nearest_surface(shape.shape, Vec3f(lerp(from, to, at)), radius, 1e3f, normal, out);
    return double(out);
  };
  const double at = math::least_place(separation, 0, 1, rim_steps);
  plane.separation = separation(at);
  plane.normal = rotate(shape.turn, Vec3d(normal));
  plane.at = lerp(thing.position[first], thing.position[second], at) - (plane.separation + thing.apart) * plane.normal;
  return float(at);
}

void find_sides(SoftThing& thing) {
  if (thing.closed) return;
  for (Shape& shape : thing.obstacles.shapes())
    if (meets_faces(thing, shape)) find_side(thing, shape);
}

void meet_faces(SoftThing& thing, float h) {
  const std::span<const std::uint32_t> corners = thing.faces();
  for (const Shape& shape : thing.obstacles.shapes()) {
    if (!meets_faces(thing, shape)) continue;
    const Vec3d middle = shape.middle();
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
      if (!thing.folded.empty() && thing.folded[k / 3] != 0) continue;
      SoftPlane plane;
      Vec3f share{};
      if (!meet_face(thing, shape, middle, &corners[k], h, plane, share)) continue;
      for (int c = 0; c < 3; ++c) {
        const std::size_t i = corners[k + std::size_t(c)];
        if (share[c] < least_share || thing.pin_of[i] >= 0) continue;
        SoftTouch& touch = thing.touches[i];
        if (touch.near && touch.plane.separation <= plane.separation) continue;
        touch.near = true;
        touch.plane = plane;
      }
    }
  }
}

double stride(const SoftThing& thing, double h, double least) {
  if (!thing.obstacles.fast) return h;
  const std::span<const std::uint32_t> corners = thing.faces();
  double out = h;
  for (const Shape& shape : thing.obstacles.shapes()) {
    if (shape.speed == 0) continue;
    const SoftObstacles::Body& body = thing.obstacles.bodies[std::size_t(shape.body)];
    const Vec3f velocity(body.velocity);
    const double turning = shape.speed - length(body.velocity);
    double way = meeting_way * (shape.half + thing.apart);
    // What is round cannot turn a corner into what it touches.
    const bool round = shape.shape.type == geometry::ShapeType3::sphere;
    if (body.touched && round) way = math::max(way, stretching_way * double(thing.mean_edge));
    if (body.touched && !round) out = math::min(out, math::max(meeting_turn / length(body.spin), least));
    const Vec3d middle = shape.middle();
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
      float fastest = 0;
      for (std::size_t c = 0; c < 3; ++c)
        fastest = math::max(fastest, length_squared(thing.velocity[corners[k + c]] - velocity));
      const double closing = double(math::sqrt(fastest)) + turning;
      if (closing * out <= way) continue;
      const Vec3d a = thing.position[corners[k]];
      const Vec3f u(thing.position[corners[k + 1]] - a), v(thing.position[corners[k + 2]] - a), seen(middle - a);
      const Vec3f share = nearest_share(u, v, seen);
      const double gap = double(length(seen - share.y * u - share.z * v)) - shape.outer - thing.apart;
      out = math::min(out, math::max(math::max(gap, way) / closing, least));
    }
  }
  return out;
}

}  // namespace carom::particles::detail
