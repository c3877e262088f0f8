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

inline void add_patches(const geometry::Shape2& shape, float size, std::vector<SurfacePatch<rigid::Dim2>>& out) {
  const geometry::Outline outline = geometry::to_outline(shape, 16);
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const math::Vec2f a = outline.points[i], side = outline.points[(i + 1) % outline.points.size()] - a;
    const float length = math::length(side);
    if (!(length > 0)) continue;
    const int parts = math::clamp(int(length / size) + 1, 1, 64);
    for (int k = 0; k < parts; ++k)
      out.push_back({a + ((float(k) + 0.5f) / float(parts)) * side, math::Vec2f{side.y, -side.x} / length,
                     length / float(parts)});
  }
}

inline void split_patch(math::Vec3f a, math::Vec3f b, math::Vec3f c, float size,
                        std::vector<SurfacePatch<rigid::Dim3>>& out) {
  const float ab = distance_squared(a, b), bc = distance_squared(b, c), ca = distance_squared(c, a);
  const float longest = math::max(ab, math::max(bc, ca));
  if (longest > size * size && out.size() < most_patches) {
    // Across the longest side, turned so that it is ab; of equal ones the first, or it would turn for ever.
    if (ab != longest) return bc == longest ? split_patch(b, c, a, size, out) : split_patch(c, a, b, size, out);
    const math::Vec3f m = 0.5f * (a + b);
    split_patch(a, m, c, size, out);
    split_patch(m, b, c, size, out);
    return;
  }
  const math::Vec3f n = cross(b - a, c - a);
  const float twice = length(n);
  if (twice > 0) out.push_back({(a + b + c) / 3.0f, n / twice, 0.5f * twice});
}

inline void add_patches(const geometry::Shape3& shape, float size, std::vector<SurfacePatch<rigid::Dim3>>& out) {
  const geometry::Triangles t = geometry::to_triangles(shape, 12);
  for (std::size_t i = 0; i + 2 < t.indices.size(); i += 3)
    split_patch(t.positions[t.indices[i]], t.positions[t.indices[i + 1]], t.positions[t.indices[i + 2]], size, out);
}

}  // namespace carom::blast::detail
