// Colliders, as the kernels want them, and those shapes that are cast one by one.
#include <string>

#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/query.h"
#include "carom/math/rotation.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/system.h"

namespace carom::particles {
using math::Vec3d;
using math::Vec3f;

namespace {

void put(float* to, Vec3f v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}
void put_rows(float* to, const math::Mat3f& m) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) to[3 * row + column] = m(row, column);
}
/// Radius of a sphere about the shape's origin that holds it.
float reach_of(const geometry::Shape3& shape) {
  if (shape.type == geometry::ShapeType3::plane) return detail::far_gap;
  const geometry::Bounds3f b = geometry::bounds(shape, {});
  Vec3f far{};
  for (int k = 0; k < 3; ++k) far[k] = math::max(math::abs(b.low[k]), math::abs(b.high[k]));
  return math::length(far);
}

}  // namespace

core::Status check(const Collider& c) {
  if (const core::Status status = geometry::validate(c.shape); !status) return status;
  if (!detail::finite_vector(c.pose.position) || !math::is_finite(c.pose.rotation))
    return core::Error{"collider: pose is not finite"};
  if (!detail::finite_vector(Vec3d(c.velocity)) || !detail::finite_vector(Vec3d(c.angular_velocity)) ||
      !detail::finite_vector(c.center_of_mass))
    return core::Error{"collider: velocity, angular_velocity or center_of_mass is not finite"};
  if (!(c.restitution >= 0 && c.restitution <= 1))
    return core::Error{"collider: restitution is " + std::to_string(c.restitution) + ", expected 0 to 1"};
  if (!(c.friction >= 0 && math::is_finite(c.friction)))
    return core::Error{"collider: friction is " + std::to_string(c.friction) +
                       ", expected a finite number of at least 0"};
  if (!(c.inverse_mass >= 0 && math::is_finite(c.inverse_mass)))
    return core::Error{"collider: inverse_mass is " + std::to_string(c.inverse_mass) + ", expected at least 0 1/kg"};
  for (int column = 0; column < 3; ++column)
    if (!detail::finite_vector(Vec3d(c.inverse_inertia.column(column))))
      return core::Error{"collider: inverse_inertia is not finite"};
  return {};
}

core::Status ParticleSystem::set_colliders(std::span<const Collider> colliders) {
  if (colliders.size() > 65'536)
    return core::Error{"particle system: " + std::to_string(colliders.size()) + " colliders, expected at most 65536"};
  for (const Collider& collider : colliders)
    if (const core::Status status = particles::check(collider); !status) return status;
  colliders_.assign(colliders.begin(), colliders.end());
  for (const Collider& collider : colliders_) sticky_ = sticky_ || collider.answer == CollisionAnswer::stick;
  prepare_chunks();
  return {};
}

void ParticleSystem::prepare_surfaces(double dt) {
  surfaces_.resize(colliders_.size());
  hull_planes_.clear();
  for (std::size_t i = 0; i < colliders_.size(); ++i) {
    const Collider& c = colliders_[i];
    detail::SurfaceData& s = surfaces_[i];
    s = {};
    math::Pose3 end = c.pose;
    s.answer = detail::Answer(int(c.answer));
    s.restitution = c.restitution;
    s.friction = c.friction;
    s.two_way = c.two_way;
    s.moves = !(c.velocity == Vec3f{} && c.angular_velocity == Vec3f{});
    if (c.two_way) {
      s.inverse_mass = c.inverse_mass;
      put_rows(s.inverse_inertia, c.inverse_inertia);
    }
    s.reach = reach_of(c.shape);
    using enum geometry::ShapeType3;
    switch (c.shape.type) {
      case plane: {
        s.form = detail::Form::plane;
        // The kernel's plane is y = 0.
        const Vec3f n = math::rotate(end.rotation, c.shape.plane.normal);
        const math::Quatf turn = n.y > -0.999f ? math::Quatf{1 + n.y, n.z, 0, -n.x} : math::Quatf{0, 1, 0, 0};
        end.rotation = math::normalize(turn);
        break;
      }
      case sphere:
        s.form = detail::Form::sphere;
        s.radius = c.shape.sphere.radius;
        break;
      case capsule:
        s.form = detail::Form::capsule;
        s.radius = c.shape.capsule.radius;
        s.half[1] = c.shape.capsule.half_length;
        break;
      case box:
        s.form = detail::Form::box;
        s.radius = c.shape.box.radius;
        put(s.half, c.shape.box.half_extents);
        break;
      case cylinder:
        s.form = detail::Form::cylinder;
        s.radius = c.shape.cylinder.rounding;
        s.half[0] = c.shape.cylinder.radius;
        s.half[1] = c.shape.cylinder.half_height;
        break;
      case hull:
        s.form = detail::Form::hull;
        s.radius = c.shape.hull->radius;
        s.plane_count = int(c.shape.hull->planes.size());
        for (const geometry::HullPlane& p : c.shape.hull->planes)
          hull_planes_.insert(hull_planes_.end(), {p.normal.x, p.normal.y, p.normal.z, p.offset});
        break;
      case height_field: {
        const geometry::HeightField& field = *c.shape.height_field;
        s.form = detail::Form::height_field;
        s.heights = field.heights.data();
        s.holes = field.holes.empty() ? nullptr : field.holes.data();
        s.columns = field.columns;
        s.rows = field.rows;
        s.cell[0] = field.cell.x;
        s.cell[1] = field.cell.y;
        s.reach = detail::far_gap;
        break;
      }
      default:
        s.form = detail::Form::given;
        break;
    }
    // Where it was at the start of the step, by its velocities.
    math::Pose3 start = end;
    const Vec3f arm(end.position - c.center_of_mass);
    if (s.moves) {
      const math::Quatf back = math::from_rotation_vector(c.angular_velocity * float(-dt));
      start.rotation = math::normalize(back * end.rotation);
      start.position = c.center_of_mass - Vec3d(c.velocity) * dt + Vec3d(math::rotate(back, arm));
      if (s.reach < detail::far_gap) s.reach += float(math::length(end.position - start.position));
    }
    put_rows(s.turn0, math::to_matrix(start.rotation));
    put_rows(s.turn1, math::to_matrix(end.rotation));
    put(s.place0, Vec3f(start.position - definition_.anchor));
    put(s.place1, Vec3f(end.position - definition_.anchor));
    put(s.velocity, c.velocity);
    put(s.spin, c.angular_velocity);
    put(s.center, Vec3f(c.center_of_mass - definition_.anchor));
  }
  // The list of planes has grown to its size: now its addresses hold.
  const float* planes = hull_planes_.data();
  for (detail::SurfaceData& s : surfaces_)
    if (s.form == detail::Form::hull) {
      s.planes = planes;
      planes += 4 * s.plane_count;
    }
}

void ParticleSystem::cast_block(const detail::SurfaceData& s, const geometry::Shape3& shape, int from, int to,
                                detail::Path& path) const {
  const auto local = [](const float* turn, const float* place, Vec3f p) {
    const Vec3f r{p.x - place[0], p.y - place[1], p.z - place[2]};
    return Vec3f{turn[0] * r.x + turn[3] * r.y + turn[6] * r.z, turn[1] * r.x + turn[4] * r.y + turn[7] * r.z,
                 turn[2] * r.x + turn[5] * r.y + turn[8] * r.z};
  };
  for (int i = from; i < to; ++i) {
    const std::size_t k = std::size_t(i - from), index = std::size_t(i);
    path.gap[k] = detail::far_gap;
    for (int c = 0; c < 3; ++c) path.normal[c][k] = 0;
    if (i >= count_ || !(path.left[k] > 0)) continue;
    const Vec3f p0{path.start[0][k], path.start[1][k], path.start[2][k]};
    const Vec3f p1{arrays_[0][index], arrays_[1][index], arrays_[2][index]};
    const float radius = definition_.radius * arrays_[8][index];
    const Vec3f off = p1 - Vec3f{s.place1[0], s.place1[1], s.place1[2]};
    if (!(math::length(off) < s.reach + radius + math::length(p1 - p0))) continue;
    const Vec3f q0 = local(s.turn0, s.place0, p0), way = local(s.turn1, s.place1, p1) - q0;
    const geometry::Shape3 ball = geometry::Sphere{radius};
    const geometry::CastHit3 hit = geometry::shape_cast(shape, ball, {q0, {}}, way);
    Vec3f normal = hit.normal;
    float gap = -hit.fraction * math::dot(normal, way);
    if (!hit.hit) continue;
    if (!(math::length(normal) > 0.5f)) {
      // It touches or overlaps at the start. From a point within it the surface is still apart.
      const geometry::Shape3 core = geometry::Sphere{0.01f * radius};
      const geometry::Distance3 near = geometry::distance(shape, core, {q0, {}});
      if (!(math::length(near.normal) > 0.5f)) continue;
      normal = near.normal;
      gap = near.distance - 0.99f * radius;
      if (math::dot(normal, way) >= 0 && gap >= 0) continue;
    }
    path.gap[k] = gap;
    for (int c = 0; c < 3; ++c) path.normal[c][k] = normal[c];
  }
}

}  // namespace carom::particles
