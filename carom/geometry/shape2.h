// The shapes of the plane. A shape is a value in its own frame; whoever uses it brings the transform.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/bounds.h"

namespace carom::geometry {

inline constexpr int max_polygon_vertices = 8;

struct Circle {
  float radius = 0.5f;  ///< m, > 0
};
/// A segment along local y from −half_length to +half_length, swept by a circle.
struct Capsule2 {
  float half_length = 0.5f;  ///< m, ≥ 0
  float radius = 0.25f;      ///< m, > 0
};
/// A convex polygon, counterclockwise, swept by a circle of `radius` (0: sharp). Made by make_polygon or make_box2.
struct Polygon {
  Vec2f vertices[max_polygon_vertices];
  Vec2f normals[max_polygon_vertices];  ///< outward; normals[i] belongs to the edge from vertex i to vertex i + 1
  Vec2f centroid;
  float radius = 0;
  int count = 0;  ///< 3 … max_polygon_vertices
};
/// Both sides collide.
struct Segment {
  Vec2f a, b;
};
/// One segment of a chain: collides on its right side, and knows the neighbours' far ends so that nothing catches on
/// the joints.
struct ChainSegment {
  Vec2f ghost_before, a, b, ghost_after;
};
/// A line of at least two points, one-sided: solid lies to the left of the direction of travel, free space to the
/// right. A loop that runs counterclockwise is a solid island; one that runs clockwise is a wall round the space inside
/// it.
struct Chain {
  std::vector<Vec2f> points;
  bool loop = false;
  /// A heap of bounds over runs of segments (detail/chain_tree.h), made by make_chain; without it searches are linear.
  std::vector<Bounds2f> tree{};
  std::vector<std::uint8_t> materials{};  ///< one a segment, as the user numbers them; empty: all 0
  int segment_count() const { return loop ? int(points.size()) : int(points.size()) - 1; }
  CAROM_API ChainSegment segment(int i) const;
};

enum class ShapeType2 : std::uint8_t { circle, capsule, polygon, segment, chain_segment, chain };

/// Any shape of the plane.
struct Shape2 {
  ShapeType2 type = ShapeType2::circle;
  union {
    Circle circle;
    Capsule2 capsule;
    Polygon polygon;
    Segment segment;
    ChainSegment chain_segment;
  };
  std::shared_ptr<const Chain> chain;  ///< for ShapeType2::chain

  Shape2() : circle{} {}
  Shape2(const Circle& s) : type(ShapeType2::circle), circle(s) {}
  Shape2(const Capsule2& s) : type(ShapeType2::capsule), capsule(s) {}
  Shape2(const Polygon& s) : type(ShapeType2::polygon), polygon(s) {}
  Shape2(const Segment& s) : type(ShapeType2::segment), segment(s) {}
  Shape2(const ChainSegment& s) : type(ShapeType2::chain_segment), chain_segment(s) {}
  Shape2(std::shared_ptr<const Chain> s) : type(ShapeType2::chain), circle{}, chain(std::move(s)) {}
};

/// The convex hull of 3 or more points, swept by `radius`. Errors: not finite, fewer than three distinct points,
/// collinear, more than max_polygon_vertices corners on the hull.
CAROM_API core::Result<Polygon> make_polygon(std::span<const Vec2f> points, float radius = 0);
/// A rectangle of the given half extents (m, > 0), centred, or placed by `local`.
CAROM_API Polygon make_box2(Vec2f half_extents, float radius = 0, const Transform2f& local = {});
/// A chain. `materials`: none, or one a segment. Errors: not finite, too few points, neighbours closer than 1 mm,
/// another number of materials.
CAROM_API core::Result<std::shared_ptr<const Chain>> make_chain(std::vector<Vec2f> points, bool loop,
                                                                std::vector<std::uint8_t> materials = {});

/// How many materials the parts of the shape name: the greatest number and one; 0 where it has none.
CAROM_API int material_count(const Shape2& shape);
/// The material of a segment of a chain; 0 for all else.
CAROM_API std::uint8_t material_of_part(const Shape2& shape, std::uint32_t child);

/// Says what is wrong with a shape that a user filled in by hand (a radius that is not positive and finite, …).
CAROM_API core::Status validate(const Shape2& shape);
/// The tight bounds of the shape placed by t.
CAROM_API Bounds2f bounds(const Shape2& shape, const Transform2f& t);
/// The point farthest along `direction`, in the shape's frame, including its radius. Convex shapes only.
CAROM_API Vec2f support(const Shape2& shape, Vec2f direction);

}  // namespace carom::geometry
