// The manifolds of pairs of which one has many parts: chains, meshes, height fields, compounds.
#pragma once

#include "carom/geometry/detail/chain_tree.h"
#include "carom/geometry/detail/contact_points.h"
#include "carom/rigid/detail/contact_store.h"

namespace carom::rigid::detail {

inline constexpr int max_manifolds = 8;  ///< of one pair

template <class D>
struct Found {
  geometry::detail::RawArray<typename D::Manifold, max_manifolds> manifold;
  std::uint32_t child[max_manifolds];
  int count = 0;
  float apart = 0;  ///< m: where nothing is found, the shapes are known to be that far from each other
  float near = 0;   ///< m: what keeps farther off than so in this step may be left out; 0: all is there
};

/// Segments of a chain are children, like the triangles of a mesh. Those that b met before, in manifolds that are still
/// known, hold it.
inline void collide_all(const geometry::Shape2& a, const geometry::Shape2& b, const ContactStore<Dim2>& store,
                        const ContactRecord<Dim2>& c, bool known, float margin, Found<Dim2>& found) {
  const geometry::Bounds2f tight = geometry::bounds(b, c.base), box = geometry::grow(tight, margin);
  const auto has_met = [&](int segment) {
    std::int32_t m = known ? c.first_manifold : none;
    while (m != none && store.manifold(m).manifold.child != std::uint32_t(segment)) m = store.manifold(m).next;
    return m != none;
  };
  const bool round = b.type == geometry::ShapeType2::circle;
  const Vec2f middle = tight.center();
  const float reach = 1.0001f * ((round ? b.circle.radius : math::length(tight.extents())) + margin);
  struct Candidate {
    float depth;
    int segment;
  } best[max_manifolds];
  geometry::Manifold2 manifolds[max_manifolds];
  int count = 0;
  const geometry::Chain& chain = *a.chain;
  geometry::detail::visit_segments(chain, box, [&](int i) {
    if (geometry::detail::segment_far(chain, i, middle, reach)) return true;
    geometry::PairCache cache;
    if (has_met(i)) cache.kind = geometry::met_front;
    geometry::Manifold2 m;
    geometry::collide(geometry::Shape2(chain.segment(i)), b, c.base, margin, cache, m);
    if (m.count == 0) return true;
    float depth = m.points[0].separation;
    for (int k = 1; k < m.count; ++k) depth = min(depth, m.points[k].separation);
    int place = count < max_manifolds ? count++ : max_manifolds;
    while (place > 0 && depth < best[place - 1].depth) {
      if (place < max_manifolds) {
        best[place] = best[place - 1];
        manifolds[place] = manifolds[place - 1];
      }
      --place;
    }
    if (place < max_manifolds) {
      best[place] = {depth, i};
      manifolds[place] = m;
    }
    return true;
  });
  if (count == 0) found.apart = margin + geometry::detail::clearance(chain, box, 100.0f);
  for (int i = 0; i < count; ++i) {
    found.manifold[i] = manifolds[i];
    found.child[i] = found.manifold[i].child = std::uint32_t(best[i].segment);
    if (!chain.materials.empty()) found.manifold[i].material = chain.materials[std::size_t(best[i].segment)];
  }
  found.count = count;
}
inline void collide_all(const geometry::Shape3& a, const geometry::Shape3& b, const Transform3f& b_in_a, float margin,
                        const geometry::detail::ShapeWay& approach, geometry::PairCache& cache, Found<Dim3>& found) {
  const bool some = is_surface(a) && is_convex(b);
  found.near = some ? approach.margin : 0;
  found.manifold[0] = {};
  if (some)
    found.count = geometry::detail::collide_approaching(a, b, b_in_a, margin, approach, cache, found.manifold.items);
  else
    found.count = geometry::collide_many(a, b, b_in_a, margin, found.manifold.items);
  if (found.count == 0)
    found.apart = math::max(found.manifold[0].points[0].separation, some ? approach.margin : margin);
  for (int i = 0; i < found.count; ++i) found.child[i] = found.manifold[i].child;
}

}  // namespace carom::rigid::detail
