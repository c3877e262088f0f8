// Mass properties of the shapes of the plane.
#include "carom/geometry/mass_properties.h"
#include "carom/math/elementary.h"

namespace carom::geometry {

namespace {

struct AreaIntegrals {
  double area = 0;
  Vec2d first{};
  double second = 0;  // ∫|x|² dA

  void add(double a, Vec2d f, double s) { area += a, first += f, second += s; }
};

// The polygon itself, then Steiner's decomposition of its rounded border: a rectangle on every edge and a sector of a
// circle at every corner. Exact.
AreaIntegrals integrate_polygon(const Polygon& polygon, Vec2d origin) {
  AreaIntegrals sum;
  const double r = polygon.radius;
  const auto vertex = [&](int i) { return Vec2d(polygon.vertices[i % polygon.count]) - origin; };
  const auto normal = [&](int i) { return normalize(cross(vertex(i + 1) - vertex(i), 1.0)); };
  for (int i = 0; i < polygon.count; ++i) {
    const Vec2d a = vertex(i), b = vertex(i + 1);
    const double twice = cross(a, b);
    sum.add(twice / 2, (a + b) * (twice / 6), (twice / 12) * (dot(a, a) + dot(a, b) + dot(b, b)));
    if (r == 0) continue;

    const Vec2d n = normal(i), next = normal(i + 1);
    const double edge = length(b - a), rectangle = edge * r;
    const Vec2d middle = (a + b) * 0.5 + n * (r / 2);
    sum.add(rectangle, rectangle * middle, rectangle * (dot(middle, middle) + (edge * edge + r * r) / 12));

    const double theta = math::atan2(max(0.0, cross(n, next)), dot(n, next));
    const double sector = theta * r * r / 2;
    const Vec2d moment = (r * r * r / 3) * (perpendicular(n) - perpendicular(next));
    sum.add(sector, sector * b + moment, sector * dot(b, b) + 2 * dot(b, moment) + theta * r * r * r * r / 4);
  }
  return sum;
}

MassProperties2 mass_of_polygon(const Polygon& polygon, double density) {
  const Vec2d origin(polygon.centroid);
  const AreaIntegrals sum = integrate_polygon(polygon, origin);
  MassProperties2 m;
  if (!(sum.area > 0)) return m;
  const Vec2d c = sum.first / sum.area;
  m.mass = density * sum.area;
  m.center = origin + c;
  m.inertia = density * (sum.second - sum.area * dot(c, c));
  return m;
}

MassProperties2 mass_of_capsule2(const Capsule2& capsule, double density) {
  const double h = capsule.half_length, r = capsule.radius;
  const double box = density * 4 * h * r, disc = density * pi * r * r;
  MassProperties2 m;
  m.mass = box + disc;
  // Two half discs whose own centres stand 4r/3π beyond the ends of the segment.
  m.inertia = box * (h * h + r * r) / 3 + disc * (r * r / 2 + h * h + 8 * h * r / (3 * pi));
  return m;
}

}  // namespace

MassProperties2 mass_properties(const Shape2& shape, double density) {
  switch (shape.type) {
    case ShapeType2::circle: {
      const double r = shape.circle.radius, mass = density * pi * r * r;
      return {mass, {}, mass * r * r / 2};
    }
    case ShapeType2::capsule:
      return mass_of_capsule2(shape.capsule, density);
    case ShapeType2::polygon:
      return mass_of_polygon(shape.polygon, density);
    case ShapeType2::segment:
    case ShapeType2::chain_segment:
    case ShapeType2::chain:
      break;
  }
  return {};
}

MassProperties2 combine(const MassProperties2& a, const MassProperties2& b) {
  const double mass = a.mass + b.mass;
  if (!(mass > 0)) return {};
  const Vec2d apart = b.center - a.center;
  return {mass, a.center + apart * (b.mass / mass),
          a.inertia + b.inertia + (a.mass * b.mass / mass) * dot(apart, apart)};
}

MassProperties2 transform(const MassProperties2& m, const Transform2d& t) {
  return {m.mass, transform_point(t, m.center), m.inertia};
}

}  // namespace carom::geometry
