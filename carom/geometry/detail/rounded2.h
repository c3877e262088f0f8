// Convex shapes of the plane as one to eight corners swept by a circle; all pairs are pairs of these.
#pragma once

#include "carom/geometry/detail/raw_array.h"
#include "carom/geometry/manifold.h"

namespace carom::geometry::detail {

/// A line is a polygon of two corners with a normal to either side; a circle has one corner and no normal.
struct Rounded2 {
  RawArray<Vec2f, max_polygon_vertices> v;
  RawArray<Vec2f, max_polygon_vertices> n;  ///< n[i] of the edge from v[i] to v[i + 1]
  int count = 0;
  float radius = 0;
  int next(int i) const { return i + 1 < count ? i + 1 : 0; }
  int before(int i) const { return i > 0 ? i - 1 : count - 1; }
};
Rounded2 rounded_of(const Shape2& shape);  ///< convex shapes and chain segments (both sides)
Rounded2 placed(const Rounded2& shape, const Transform2f& t);
Rounded2 placed(const Shape2& shape, const Transform2f& t);
Vec2f center_of(const Rounded2& shape);
float size_of(const Rounded2& shape);  ///< half the smallest extent, roughly; 0 for a sharp line

/// Where along n[edge] of `a` the corners of `b` begin.
struct EdgeAxis {
  int edge = 0;
  float separation = -3.4e38f;
};
float separation_along(const Rounded2& a, int edge, const Rounded2& b);
EdgeAxis best_edge(const Rounded2& a, const Rounded2& b);

Vec2f closest_on_line(Vec2f a, Vec2f b, Vec2f p);
/// The closest points of two lines that do not cross.
void closest_of_lines(Vec2f a0, Vec2f a1, Vec2f b0, Vec2f b1, Vec2f& p, Vec2f& q);

/// Distance of the cores (both in one frame), exact where they are apart; where they overlap, minus the depth along the
/// best edge normal.
struct CoreDistance2 {
  float distance = 0;
  Vec2f point_a{}, point_b{}, normal{};
};
CoreDistance2 core_distance(const Rounded2& a, const Rounded2& b);
/// The same, where best_edge(a, b) and best_edge(b, a) are known.
CoreDistance2 core_distance(const Rounded2& a, const Rounded2& b, const EdgeAxis& of_a, const EdgeAxis& of_b);

/// An edge with its normal; it runs from `start` against the clock, `length` m.
struct ReferenceEdge {
  Vec2f normal, start;
  float length;
  int number;
  float radius;
};
/// The edge of the other shape that faces it, ends in the order along the reference edge.
struct IncidentEdge {
  Vec2f first, last;
  int number;
  float radius;
};
/// The part of the incident edge beside the reference edge, as contacts. `of_b`: the reference edge is of B.
void clip_edge(const ReferenceEdge& r, const IncidentEdge& s, bool of_b, float margin, Manifold2& out);

/// A contact of two corners a and b, d (m) apart along n.
void single_contact(Vec2f a, float ra, Vec2f b, float rb, Vec2f n, float d, std::uint32_t id, Manifold2& out);
/// The same, if their surfaces are no farther than the margin from each other.
void between_points(Vec2f a, float ra, Vec2f b, float rb, float margin, std::uint32_t id, Manifold2& out);
/// A round shape that passes over the end of an edge without dipping below it is pushed along the edge's normal, so
/// that it does not catch on the joint of two level edges (the same rule as in space, detail/contact_points.h).
/// Well beside the edge there is nothing to meet yet.
void over_border(Manifold2& m, Vec2f edge_normal, float above, float radius);

/// manifold2_round.cpp. Circles, capsules and polygons of which one is not a polygon. False, and nothing done, where
/// that takes more than a closed form.
bool collide_round(const Shape2& a, const Shape2& b, const Transform2f& b_in_a, float margin, PairCache& cache,
                   Manifold2& out);
/// manifold2_polygon.cpp. False, and nothing done, where the nearest features may be two corners.
bool collide_polygons(const Polygon& a, const Polygon& b, const Transform2f& b_in_a, float margin, PairCache& cache,
                      Manifold2& out);

}  // namespace carom::geometry::detail
