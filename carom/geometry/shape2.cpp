#include "carom/geometry/shape2.h"

#include <algorithm>

#include "carom/geometry/detail/chain_tree.h"
#include "carom/geometry/detail/polygon_lanes.h"
#include "carom/geometry/detail/text.h"

namespace carom::geometry {

namespace {

namespace polygon_detail {

// Corners closer to each other, or to the line through their neighbours, than this part of the polygon's size are not
// corners: their edges would have no reliable normal in float.
constexpr double relative_tolerance = 1e-5;

double tolerance_of(std::span<const Vec2d> points) {
  Vec2d low = points[0], high = points[0];
  double largest = 0;
  for (const Vec2d& p : points) {
    low = min(low, p), high = max(high, p);
    largest = max(largest, max(abs(p.x), abs(p.y)));
  }
  const double size = max(high.x - low.x, high.y - low.y);
  return max(relative_tolerance * size, 4 * 1.1920929e-7 * largest);
}

// Andrew's monotone chain over points sorted by x, then y; counterclockwise, without collinear points.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
  std::sort(points.begin(), points.end(), [](Vec2d a, Vec2d b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2d> hull;
  const auto push = [&hull](Vec2d p, std::size_t keep) {
    while (hull.size() >= keep + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2d& p : points) push(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) push(points[i], lower);
  hull.pop_back();
  return hull;
}

// How far vertex i stands out from the line through its neighbours, or from the nearer neighbour.
double prominence(const std::vector<Vec2d>& hull, std::size_t i) {
  const std::size_t n = hull.size();
  const Vec2d a = hull[(i + n - 1) % n], b = hull[i], c = hull[(i + 1) % n];
  const double base = length(c - a);
  const double height = base > 0 ? abs(cross(b - a, c - a)) / base : 0;
  return min(height, min(length(b - a), length(c - b)));
}

void drop_blunt_corners(std::vector<Vec2d>& hull, double tolerance) {
  while (hull.size() > 2) {
    std::size_t bluntest = 0;
    double least = prominence(hull, 0);
    for (std::size_t i = 1; i < hull.size(); ++i) {
      const double p = prominence(hull, i);
      if (p < least) least = p, bluntest = i;
    }
    if (least > tolerance) return;
    hull.erase(hull.begin() + std::ptrdiff_t(bluntest));
  }
}

void finish(Polygon& polygon) {
  const Vec2d origin(polygon.vertices[0]);
  double area = 0;
  Vec2d first{};
  for (int i = 0; i < polygon.count; ++i) {
    const Vec2d a = Vec2d(polygon.vertices[i]) - origin;
    const Vec2d b = Vec2d(polygon.vertices[(i + 1) % polygon.count]) - origin;
    const double twice = cross(a, b);
    area += twice / 2;
    first += (a + b) * (twice / 6);
    polygon.normals[i] = Vec2f(normalize(cross(b - a, 1.0)));
  }
  polygon.centroid = Vec2f(origin + (area > 0 ? first / area : Vec2d{}));
}

}  // namespace polygon_detail

core::Status validate_polygon(const Polygon& p) {
  if (p.count < 3 || p.count > max_polygon_vertices)
    return detail::error("polygon.count is %d: expected 3 to %d", p.count, max_polygon_vertices);
  if (auto s = detail::check_range("polygon.radius", p.radius, 0, max_shape_size); !s) return s;
  for (int i = 0; i < p.count; ++i) {
    if (auto s = detail::check_point("polygon.vertices", p.vertices[i], max_shape_size); !s) return s;
    const float n = length(p.normals[i]);
    if (!(abs(n - 1) < 1e-3f))
      return detail::error("polygon.normals[%d] has length %g: expected 1 (use make_polygon)", i, double(n));
  }
  for (int i = 0; i < p.count; ++i) {
    const Vec2d a(p.vertices[i]), b(p.vertices[(i + 1) % p.count]), c(p.vertices[(i + 2) % p.count]);
    if (!(cross(b - a, c - b) > 0))
      return detail::error("polygon is not convex and counterclockwise at vertex %d", (i + 1) % p.count);
    if (!(dot(normalize(cross(b - a, 1.0)), Vec2d(p.normals[i])) > 0.999))
      return detail::error("polygon.normals[%d] does not point outward from its edge", i);
  }
  return {};
}

core::Status validate_segment(const char* name, Vec2f a, Vec2f b) {
  if (auto s = detail::check_point(name, a, max_shape_size); !s) return s;
  if (auto s = detail::check_point(name, b, max_shape_size); !s) return s;
  if (!(length(Vec2d(b) - Vec2d(a)) >= min_shape_size))
    return detail::error("%s: its ends are closer than %g m", name, min_shape_size);
  return {};
}

Bounds2f bounds_of_points(std::span<const Vec2f> points, const Transform2f& t, float radius) {
  Bounds2f b{transform_point(t, points[0]), transform_point(t, points[0])};
  for (const Vec2f& local : points.subspan(1)) {
    const Vec2f p = transform_point(t, local);
    b = {min(b.low, p), max(b.high, p)};
  }
  return grow(b, radius);
}
/// The same, with the corners side by side in lanes.
template <int N>
Bounds2f bounds_of_polygon(const Polygon& polygon, const Transform2f& t) {
  using namespace detail::polygon_pair;
  Vectors<N> v;
  v.load(polygon.vertices, polygon.count);
  v.turn(t.q), v.move(t.p);
  Lanes low_x = v.x[0], low_y = v.y[0], high_x = v.x[0], high_y = v.y[0];
  for (int k = 1; k < N; ++k) {
    low_x = min(low_x, v.x[k]), low_y = min(low_y, v.y[k]);
    high_x = max(high_x, v.x[k]), high_y = max(high_y, v.y[k]);
  }
  return grow(Bounds2f{{least_of(low_x), least_of(low_y)}, {greatest_of(high_x), greatest_of(high_y)}}, polygon.radius);
}

}  // namespace

ChainSegment Chain::segment(int i) const {
  const int n = int(points.size());
  const auto at = [&](int k) { return points[std::size_t((k % n + n) % n)]; };
  const Vec2f a = at(i), b = at(i + 1);
  // At the free ends of an open chain the line simply runs on.
  const Vec2f before = loop || i > 0 ? at(i - 1) : a + (a - b);
  const Vec2f after = loop || i + 2 < n ? at(i + 2) : b + (b - a);
  return {before, a, b, after};
}

core::Result<Polygon> make_polygon(std::span<const Vec2f> points, float radius) {
  if (points.size() < 3) return detail::error("make_polygon: %zu points, expected at least 3", points.size());
  if (auto s = detail::check_range("make_polygon: radius", radius, 0, max_shape_size); !s) return s.error();
  std::vector<Vec2d> copy;
  copy.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (auto s = detail::check_point("make_polygon: a point", points[i], max_shape_size); !s) return s.error();
    copy.push_back(Vec2d(points[i]));
  }
  const double tolerance = polygon_detail::tolerance_of(copy);
  std::vector<Vec2d> hull = polygon_detail::convex_hull(std::move(copy));
  polygon_detail::drop_blunt_corners(hull, tolerance);
  if (hull.size() < 3)
    return detail::error("make_polygon: the %zu points lie on one line or coincide (tolerance %g m)", points.size(),
                         tolerance);
  if (hull.size() > max_polygon_vertices)
    return detail::error("make_polygon: the hull has %zu corners, expected at most %d", hull.size(),
                         max_polygon_vertices);
  Polygon polygon;
  polygon.radius = radius;
  polygon.count = int(hull.size());
  for (int i = 0; i < polygon.count; ++i) polygon.vertices[i] = Vec2f(hull[std::size_t(i)]);
  polygon_detail::finish(polygon);
  return polygon;
}

Polygon make_box2(Vec2f half_extents, float radius, const Transform2f& local) {
  const Vec2f h = half_extents;
  const Vec2f corners[4] = {{-h.x, -h.y}, {h.x, -h.y}, {h.x, h.y}, {-h.x, h.y}};
  const Vec2f normals[4] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  Polygon polygon;
  polygon.count = 4;
  polygon.radius = radius;
  polygon.centroid = local.p;
  for (int i = 0; i < 4; ++i) {
    polygon.vertices[i] = transform_point(local, corners[i]);
    polygon.normals[i] = rotate(local.q, normals[i]);
  }
  return polygon;
}

core::Result<std::shared_ptr<const Chain>> make_chain(std::vector<Vec2f> points, bool loop,
                                                      std::vector<std::uint8_t> materials) {
  const std::size_t needed = loop ? 3 : 2;
  if (points.size() < needed)
    return detail::error("make_chain: %zu points, expected at least %zu for %s chain", points.size(), needed,
                         loop ? "a closed" : "an open");
  constexpr double min_length = 1e-3;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (auto s = detail::check_point("make_chain: a point", points[i], max_shape_size); !s) return s.error();
    const std::size_t next = (i + 1) % points.size();
    if (next == 0 && !loop) break;
    if (auto s = detail::check_point("make_chain: a point", points[next], max_shape_size); !s) return s.error();
    if (!(length(Vec2d(points[next]) - Vec2d(points[i])) >= min_length))
      return detail::error("make_chain: points %zu and %zu are closer than %g m", i, next, min_length);
  }
  Chain chain{std::move(points), loop};
  if (!materials.empty() && materials.size() != std::size_t(chain.segment_count()))
    return detail::error("make_chain: %zu materials, expected none or one a segment, %d", materials.size(),
                         chain.segment_count());
  chain.materials = std::move(materials);
  chain.tree = detail::build_chain_tree(chain);
  return std::shared_ptr<const Chain>(std::make_shared<Chain>(std::move(chain)));
}

int material_count(const Shape2& shape) {
  if (shape.type != ShapeType2::chain || shape.chain->materials.empty()) return 0;
  return 1 + *std::max_element(shape.chain->materials.begin(), shape.chain->materials.end());
}
std::uint8_t material_of_part(const Shape2& shape, std::uint32_t child) {
  if (shape.type != ShapeType2::chain || child >= shape.chain->materials.size()) return 0;
  return shape.chain->materials[child];
}

core::Status validate(const Shape2& shape) {
  switch (shape.type) {
    case ShapeType2::circle:
      return detail::check_range("circle.radius", shape.circle.radius, min_shape_size, max_shape_size);
    case ShapeType2::capsule:
      if (auto s = detail::check_range("capsule.half_length", shape.capsule.half_length, 0, max_shape_size); !s)
        return s;
      return detail::check_range("capsule.radius", shape.capsule.radius, min_shape_size, max_shape_size);
    case ShapeType2::polygon:
      return validate_polygon(shape.polygon);
    case ShapeType2::segment:
      return validate_segment("segment", shape.segment.a, shape.segment.b);
    case ShapeType2::chain_segment:
      if (auto s = detail::check_point("chain_segment.ghost_before", shape.chain_segment.ghost_before, max_shape_size);
          !s)
        return s;
      if (auto s = detail::check_point("chain_segment.ghost_after", shape.chain_segment.ghost_after, max_shape_size);
          !s)
        return s;
      return validate_segment("chain_segment", shape.chain_segment.a, shape.chain_segment.b);
    case ShapeType2::chain:
      if (!shape.chain) return detail::error("chain is null: expected one from make_chain");
      return {};
  }
  return detail::error("shape type is %d: expected one of ShapeType2", int(shape.type));
}

Bounds2f bounds(const Shape2& shape, const Transform2f& t) {
  switch (shape.type) {
    case ShapeType2::circle:
      return grow(Bounds2f{t.p, t.p}, shape.circle.radius);
    case ShapeType2::capsule: {
      const Vec2f axis = rotate(t.q, Vec2f{0, shape.capsule.half_length});
      const Vec2f e = abs(axis) + Vec2f{shape.capsule.radius, shape.capsule.radius};
      return {t.p - e, t.p + e};
    }
    case ShapeType2::polygon:
      return shape.polygon.count <= 4 ? bounds_of_polygon<1>(shape.polygon, t) : bounds_of_polygon<2>(shape.polygon, t);
    case ShapeType2::segment: {
      const Vec2f ends[2] = {shape.segment.a, shape.segment.b};
      return bounds_of_points(ends, t, 0);
    }
    case ShapeType2::chain_segment: {
      const Vec2f ends[2] = {shape.chain_segment.a, shape.chain_segment.b};
      return bounds_of_points(ends, t, 0);
    }
    case ShapeType2::chain:
      return bounds_of_points(shape.chain->points, t, 0);
  }
  return {t.p, t.p};
}

Vec2f support(const Shape2& shape, Vec2f direction) {
  switch (shape.type) {
    case ShapeType2::circle:
      return normalize(direction) * shape.circle.radius;
    case ShapeType2::capsule: {
      const float y = direction.y < 0 ? -shape.capsule.half_length : shape.capsule.half_length;
      return Vec2f{0, y} + normalize(direction) * shape.capsule.radius;
    }
    case ShapeType2::polygon: {
      const Polygon& p = shape.polygon;
      int best = 0;
      float farthest = dot(p.vertices[0], direction);
      for (int i = 1; i < p.count; ++i) {
        const float along = dot(p.vertices[i], direction);
        if (along > farthest) farthest = along, best = i;
      }
      return p.vertices[best] + normalize(direction) * p.radius;
    }
    case ShapeType2::segment:
      return dot(shape.segment.b - shape.segment.a, direction) > 0 ? shape.segment.b : shape.segment.a;
    case ShapeType2::chain_segment:
      return dot(shape.chain_segment.b - shape.chain_segment.a, direction) > 0 ? shape.chain_segment.b
                                                                               : shape.chain_segment.a;
    case ShapeType2::chain:
      break;  // not convex
  }
  return {};
}

}  // namespace carom::geometry
