// The surface of a shape as small flat patches.
#pragma once

#include <vector>

#include "carom/geometry/mesh_builders.h"
#include "carom/rigid/dimension.h"

namespace carom::blast::detail {

template <class D>
struct SurfacePatch {
  typename D::Vector center{}, normal{};  ///< shape's frame; outward
  float area = 0;                         ///< m² (plane: m, a metre deep)
};

inline bool has_patches(const geometry::Shape2& s) { return s.type <= geometry::ShapeType2::polygon; }
inline bool has_patches(const geometry::Shape3& s) {
  return s.type != geometry::ShapeType3::plane && s.type != geometry::ShapeType3::height_field &&
         s.type != geometry::ShapeType3::voxels;
}

constexpr std::size_t most_patches = 4096;

/// How large patches may be: a share of how far they are from the charge.
template <class D>
struct PatchSize {
  typename D::Vector charge{};  ///< shape's frame
  float least = 0;              ///< m

  float at(typename D::Vector place) const { return math::max(least, 0.15f * distance(charge, place)); }
};

inline void split_side(math::Vec2f a, math::Vec2f b, math::Vec2f normal, const PatchSize<rigid::Dim2>& size,
                       std::vector<SurfacePatch<rigid::Dim2>>& out) {
  const math::Vec2f middle = 0.5f * (a + b);
  const float length = distance(a, b);
  if (length > size.at(middle) && out.size() < most_patches) {
    split_side(a, middle, normal, size, out);
    split_side(middle, b, normal, size, out);
    return;
  }
  out.push_back({middle, normal, length});
}

inline void add_patches(const geometry::Shape2& shape, const PatchSize<rigid::Dim2>& size,
                        std::vector<SurfacePatch<rigid::Dim2>>& out) {
  const geometry::Outline outline = geometry::to_outline(shape, 16);
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const math::Vec2f a = outline.points[i], side = outline.points[(i + 1) % outline.points.size()] - a;
    const float length = math::length(side);
    if (!(length > 0)) continue;
    split_side(a, a + side, math::Vec2f{side.y, -side.x} / length, size, out);
  }
}

inline void split_patch(math::Vec3f a, math::Vec3f b, math::Vec3f c, math::Vec3f normal,
                        const PatchSize<rigid::Dim3>& size, std::vector<SurfacePatch<rigid::Dim3>>& out) {
  const float ab = distance_squared(a, b), bc = distance_squared(b, c), ca = distance_squared(c, a);
  const float longest = math::max(ab, math::max(bc, ca));
  const math::Vec3f middle = (a + b + c) / 3.0f;
  if (longest > math::square(size.at(middle)) && out.size() < most_patches) {
    // Across the longest side, turned so that it is ab; of equal ones the first, or it would turn for ever.
    if (ab != longest)
      return bc == longest ? split_patch(b, c, a, normal, size, out) : split_patch(c, a, b, normal, size, out);
    const math::Vec3f m = 0.5f * (a + b);
    split_patch(a, m, c, normal, size, out);
    split_patch(m, b, c, normal, size, out);
    return;
  }
  out.push_back({middle, normal, 0.5f * length(cross(b - a, c - a))});
}

inline void add_patches(const geometry::Shape3& shape, const PatchSize<rigid::Dim3>& size,
                        std::vector<SurfacePatch<rigid::Dim3>>& out) {
  const geometry::Triangles t = geometry::to_triangles(shape, 12);
  for (std::size_t i = 0; i + 2 < t.indices.size(); i += 3) {
    const math::Vec3f a = t.positions[t.indices[i]], b = t.positions[t.indices[i + 1]],
                      c = t.positions[t.indices[i + 2]], normal = cross(b - a, c - a);
    const float twice = length(normal);
    if (twice > 0) split_patch(a, b, c, normal / twice, size, out);
  }
}

}  // namespace carom::blast::detail
