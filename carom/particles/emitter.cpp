#include "carom/particles/emitter.h"

#include <string>

#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"

namespace carom::particles {
using math::Vec3d;
using math::Vec3f;

namespace {

core::Error bad_field(const char* field, const std::string& found, const char* expected) {
  return detail::bad("emitter", field, found, expected);
}
core::Status check_range(const char* field, Range r, float least, bool may_be_infinite, const char* expected) {
  const bool low = r.low >= least && r.low == r.low, high = r.high >= r.low;
  if (!low || !high || (!may_be_infinite && !(math::is_finite(r.low) && math::is_finite(r.high))))
    return bad_field(field, std::to_string(r.low) + " … " + std::to_string(r.high), expected);
  return {};
}
double draw_range(Range r, math::Random& random) {
  return r.low == r.high ? double(r.low) : random.uniform(double(r.low), double(r.high));
}
Vec3d any_normal(Vec3d d) { return math::abs(d.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}; }

}  // namespace

core::Status check(const EmitterDef& d) {
  if (!detail::finite_vector(d.position)) return bad_field("position", "not finite", "metres");
  if (!detail::finite_vector(d.velocity)) return bad_field("velocity", "not finite", "metres a second");
  if (!math::is_finite(d.rotation) || !(math::abs(math::length(d.rotation) - 1) < 1e-3))
    return bad_field("rotation", "not of length 1", "a unit quaternion");
  for (int k = 0; k < 3; ++k)
    if (!(d.size[k] >= 0 && math::is_finite(d.size[k])))
      return bad_field("size", std::to_string(d.size[k]), "at least 0 m");
  if (!(math::abs(math::length(d.direction) - 1) < 1e-3f))
    return bad_field("direction", "not of length 1", "a unit vector");
  if (!(d.rate >= 0 && d.rate <= 1e9f)) return bad_field("rate", std::to_string(d.rate), "0 to 10^9 a second");
  if (!(d.start >= 0 && math::is_finite(d.start))) return bad_field("start", std::to_string(d.start), "at least 0 s");
  if (!(d.duration >= 0)) return bad_field("duration", std::to_string(d.duration), "at least 0 s");
  if (d.burst < 0) return bad_field("burst", std::to_string(d.burst), "at least 0");
  if (!math::is_finite(d.inherited)) return bad_field("inherited", "not finite", "a number");
  if (!(d.spread >= 0 && d.spread <= 3.1415927f)) return bad_field("spread", std::to_string(d.spread), "0 to π rad");
  if (d.form == EmitterForm::mesh && d.mesh == nullptr)
    return bad_field("mesh", "none", "a triangle mesh, as form says");
  if (auto s = check_range("speed", d.speed, 0, false, "two finite numbers, rising, at least 0 m/s"); !s) return s;
  if (auto s = check_range("lifetime", d.lifetime, 1e-6f, true, "two numbers, rising, above 0 s"); !s) return s;
  if (d.lifetime.low != d.lifetime.high && !math::is_finite(d.lifetime.high))
    return bad_field("lifetime", "from a finite number to infinity", "both finite or both infinite");
  return check_range("scale", d.scale, 1e-3f, false, "two finite numbers, rising, at least 0.001");
}

MeshAreas::MeshAreas(const geometry::TriangleMesh& mesh) {
  double sum = 0;
  sums_.reserve(std::size_t(mesh.triangle_count()));
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const Vec3d a(mesh.vertices[mesh.indices[t]]), b(mesh.vertices[mesh.indices[t + 1]]),
        c(mesh.vertices[mesh.indices[t + 2]]);
    sum += 0.5 * math::length(math::cross(b - a, c - a));
    sums_.push_back(sum);
  }
}

std::size_t MeshAreas::triangle(double part) const {
  std::size_t low = 0, high = sums_.size() - 1;
  const double wanted = part * sums_.back();
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (sums_[middle] > wanted)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

Emission draw(const EmitterDef& d, const MeshAreas& areas, bool planar, math::Random& random) {
  Emission out;
  Vec3d normal(d.direction);
  const Vec3d size(d.size);
  switch (d.form) {
    case EmitterForm::point:
      break;
    case EmitterForm::segment:
      out.place = {random.uniform(-size.x, size.x), 0, 0};
      break;
    case EmitterForm::disc: {
      const math::Vec2d c = d.surface_only ? random.on_circle() : random.in_disc();
      out.place = planar ? Vec3d{random.uniform(-size.x, size.x), 0, 0} : Vec3d{c.x * size.x, 0, c.y * size.x};
      if (d.surface_only && !planar) normal = {c.x, 0, c.y};
      break;
    }
    case EmitterForm::sphere: {
      if (planar) {
        const math::Vec2d c = d.surface_only ? random.on_circle() : random.in_disc();
        out.place = {c.x * size.x, c.y * size.x, 0};
      } else {
        out.place = (d.surface_only ? random.on_sphere() : random.in_sphere()) * size.x;
      }
      const double length = math::length(out.place);
      if (length > 0) normal = out.place / length;
      break;
    }
    case EmitterForm::box: {
      out.place = {random.uniform(-size.x, size.x), random.uniform(-size.y, size.y), random.uniform(-size.z, size.z)};
      if (!d.surface_only) break;
      // A face by its area, one side of it or the other.
      const double ax = size.y * size.z, ay = size.x * size.z, az = planar ? 0 : size.x * size.y;
      const double part = random.uniform() * (ax + ay + az);
      const int axis = part < ax ? 0 : (part < ax + ay ? 1 : 2);
      const double side = random.chance(0.5) ? 1 : -1;
      out.place[axis] = side * size[axis];
      normal = {};
      normal[axis] = side;
      break;
    }
    case EmitterForm::mesh: {
      if (areas.area() <= 0) break;
      const std::size_t t = 3 * areas.triangle(random.uniform());
      const geometry::TriangleMesh& mesh = *d.mesh;
      const Vec3d a(mesh.vertices[mesh.indices[t]]), b(mesh.vertices[mesh.indices[t + 1]]),
          c(mesh.vertices[mesh.indices[t + 2]]);
      const double root = math::sqrt(random.uniform()), v = random.uniform();
      out.place = a * (1 - root) + b * (root * (1 - v)) + c * (root * v);
      const Vec3d n = math::cross(b - a, c - a);
      if (math::length(n) > 0) normal = math::normalize(n);
      break;
    }
  }
  Vec3d direction = d.along_normal ? normal : Vec3d(d.direction);
  if (d.spread > 0) {
    if (planar) {
      const math::SinCos<double> turn = math::sincos(random.uniform(-double(d.spread), double(d.spread)));
      direction = {direction.x * turn.cos - direction.y * turn.sin, direction.x * turn.sin + direction.y * turn.cos, 0};
    } else {
      const double c = random.uniform(math::cos(double(d.spread)), 1.0), s = math::sqrt(math::max(1 - c * c, 0.0));
      const math::Vec2d round = random.on_circle();
      const Vec3d u = math::normalize(math::cross(direction, any_normal(direction))), v = math::cross(direction, u);
      direction = direction * c + (u * round.x + v * round.y) * s;
    }
  }
  out.velocity = direction * draw_range(d.speed, random);
  out.lifetime = float(draw_range(d.lifetime, random));
  out.scale = float(draw_range(d.scale, random));
  if (planar) out.place.z = out.velocity.z = 0;
  return out;
}

}  // namespace carom::particles
