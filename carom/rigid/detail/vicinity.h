// What is near a character in one move, asked of the world once and looked at from every place that it tries.
#pragma once

#include "carom/geometry/detail/triangle_blocks.h"
#include "carom/math/mat.h"
#include "carom/rigid/detail/shape_manifolds.h"
#include "carom/rigid/world.h"

namespace carom::rigid::detail {

template <class D>
struct Neighbour {
  ShapeId id{};
  BodyId body_id{};
  typename D::Shape geometry{};
  typename D::Pose pose{};
  BodyState<D> body{};
  float approach = 0;                          ///< m that it may come nearer in this move by itself
  geometry::Bounds<typename D::Vector> box{};  ///< seen from `Vicinity::base`
  float clear = 0;                             ///< m: so far it was from the capsule when that stood
  typename D::Position clear_at{};             ///< here
};

/// The triangles that were gathered of one neighbour; those of a mesh, which never changes, stay from move to move.
struct GatheredTriangles {
  geometry::detail::TriangleBlocks blocks;
  geometry::Bounds3f box{};  ///< in the surface's frame, of all that was gathered
  std::shared_ptr<const void> mesh;
  bool known = false, of_this_move = false, kept = false;
};

/// A shape that may come near, and by how much (m) in this move by itself.
struct Approaching {
  std::int32_t slot;
  float way;
};

template <class D>
struct Vicinity {
  typename D::Position base{};
  geometry::Bounds<typename D::Vector> whole{};  ///< seen from there: what lies outside was not asked about
  std::vector<Neighbour<D>> near;
  std::vector<GatheredTriangles> triangles;  ///< of the neighbour of the same number; more are room for later
  std::vector<Approaching> found;

  /// After `near` was found: who was there before keeps its triangles.
  void keep_triangles() {
    if (triangles.size() < near.size()) triangles.resize(near.size());
    for (GatheredTriangles& t : triangles) t.of_this_move = t.kept = false;
    if constexpr (D::dimension == 3)
      for (std::size_t i = 0; i < near.size(); ++i) {
        if (near[i].geometry.type != geometry::ShapeType3::mesh) continue;
        for (GatheredTriangles& old : triangles) {
          if (old.kept || old.mesh != near[i].geometry.data) continue;
          std::swap(triangles[i], old);
          triangles[i].kept = true;
          break;
        }
      }
    for (GatheredTriangles& t : triangles)
      if (!t.kept) t.known = false, t.mesh = nullptr;
  }
  /// After one of `near` went: those behind it have other numbers now.
  void forget_triangles() {
    for (GatheredTriangles& t : triangles) t.known = t.of_this_move = false;
  }
};

/// The deepest point of every manifold, as for_planes tells it.
template <class Shape, class Place, class Vector, class F>
float for_deepest(const Shape& shape, const Shape& capsule, const Place& place, float reach, const Around<Vector>& near,
                  F&& f) {
  return for_manifolds(shape, capsule, place, reach, near, [&](const auto& m) {
    const auto& p = m.points[deepest_point(m)];
    // The manifold's point lies midway; the obstacle's own is half the separation back.
    f(m.normal, p.separation, p.point - m.normal * (0.5f * p.separation));
  });
}

/// Calls f(normal, separation, point of the neighbour, all in its frame) for what a capsule at `place` (in that frame)
/// may meet within `reach`, and that comes near its way. Returns how far they are known to be from each other, or 0.
template <class F>
float for_planes(Vicinity<Dim2>& all, std::size_t i, const geometry::Shape2& capsule, const Transform2f& place,
                 float reach, const Around<Vec2f>& near, F&& f) {
  return for_deepest(all.near[i].geometry, capsule, place, reach, near, f);
}
template <class F>
float for_planes(Vicinity<Dim3>& all, std::size_t i, const geometry::Shape3& capsule, const Transform3f& place,
                 float reach, const Around<Vec3f>& near, F&& f) {
  const Neighbour<Dim3>& n = all.near[i];
  const bool solid = n.geometry.type == geometry::ShapeType3::height_field;
  if (n.geometry.type != geometry::ShapeType3::mesh && !solid)
    return for_deepest(n.geometry, capsule, place, reach, near, f);
  const geometry::Capsule3& c = capsule.capsule;
  const Vec3f end = rotate(place.q, Vec3f{0, c.half_length, 0}), size = abs(end) + c.radius * Vec3f{1, 1, 1};
  geometry::Bounds3f box = near.along(geometry::Bounds3f{place.p - size, place.p + size});
  if (solid) box.high.y += 2 * (c.half_length + 2 * c.radius);
  GatheredTriangles& g = all.triangles[i];
  if (!g.known || !contains(g.box, box)) {
    const Vec3f middle = local_point(n.pose, all.base + Vec3d(all.whole.center())), half = all.whole.extents();
    const Mat3f turn = to_matrix(conjugate(n.pose.rotation));
    Vec3f local = abs(turn.cx) * half.x + abs(turn.cy) * half.y + abs(turn.cz) * half.z;
    // Where triangles are few, those around too: for the moves to come.
    constexpr int few = 96;
    if (!solid && g.blocks.count() <= few) local += c.radius * Vec3f{1, 1, 1};
    g.box = merge(g.of_this_move ? merge(g.box, box) : box, {middle - local, middle + local});
    g.known = g.of_this_move = true;
    g.mesh = solid ? nullptr : n.geometry.data;
    g.blocks.gather(n.geometry, g.box);
  }
  geometry::detail::SurfacePlane planes[16];
  const int count = g.blocks.planes({place.p, end, c.radius, reach, box}, planes);
  for (int k = 0; k < count; ++k) f(planes[k].normal, planes[k].separation, planes[k].point);
  // Sunk below all triangles of a height field.
  if (solid && count == 0) for_deepest(n.geometry, capsule, place, reach, near, f);
  return 0;
}

}  // namespace carom::rigid::detail
