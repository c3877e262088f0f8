#include "carom/geometry/detail/triangle_blocks.h"

#include "carom/geometry/detail/contact_points.h"
#include "carom/math/cpu.h"

namespace carom::geometry::detail {
namespace {

/// At most as many planes as there is room for, one for what is nearly coplanar.
struct Planes {
  std::span<SurfacePlane> out;
  int count = 0;

  void offer(const SurfacePlane& p) {
    int at = 0;
    while (at < count && !(math::dot(out[std::size_t(at)].normal, p.normal) > 0.998f)) ++at;
    if (at == count) {
      if (count < int(out.size())) {
        out[std::size_t(count++)] = p;
        return;
      }
      at = 0;
      for (int i = 1; i < count; ++i)
        if (out[std::size_t(i)].separation > out[std::size_t(at)].separation) at = i;
    }
    if (p.separation < out[std::size_t(at)].separation) out[std::size_t(at)] = p;
  }
  void sort() {
    for (int i = 1; i < count; ++i) {
      const SurfacePlane p = out[std::size_t(i)];
      int at = i;
      for (; at > 0 && p.separation < out[std::size_t(at - 1)].separation; --at)
        out[std::size_t(at)] = out[std::size_t(at - 1)];
      out[std::size_t(at)] = p;
    }
  }
};

}  // namespace

TriangleBlocks::TriangleBlocks(int lanes)
    : find_planes_(triangle_planes_baseline::find_planes), set_normals_(triangle_planes_baseline::set_normals) {
#if CAROM_WIDE_UNITS
  const math::InstructionSet wanted = lanes == 0 ? math::InstructionSet::avx512 : math::instruction_set_of_width(lanes);
  if (math::choose_instruction_set(wanted) >= math::InstructionSet::avx2)
    find_planes_ = triangle_planes_avx2::find_planes, set_normals_ = triangle_planes_avx2::set_normals;
#endif
  (void)lanes;
}

void TriangleBlocks::gather(const Shape3& surface, const Bounds3f& box) {
  clear();
  solid_ = surface.type == ShapeType3::height_field;
  visit_groups(surface, box, true, [&](const TriangleGroup& group, std::uint32_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const int from = __builtin_ctz(lanes), lane = count_++ % TriangleBlock::lanes;
      if (lane == 0) {
        // Lanes without a triangle are too far away for anything.
        blocks_.emplace_back();
        for (auto& corner : blocks_.back().corner)
          for (float& x : corner[0]) x = 3e30f;
      }
      TriangleBlock& b = blocks_.back();
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) b.corner[c][k][lane] = group.corner[c][k][from];
      b.edges[lane] = edges_of(surface, group, from);
    }
    return true;
  });
  set_normals_(blocks_.data(), int(blocks_.size()));
}

int TriangleBlocks::planes(const NearbyLine& line, std::span<SurfacePlane> out) const {
  constexpr std::size_t at_once = 8;
  MetPlane met[at_once * TriangleBlock::lanes];
  const TriangleQuestion question{line.box.low,
                                  line.box.high,
                                  line.center,
                                  line.end,
                                  line.radius,
                                  line.margin,
                                  border_tolerance(line.radius),
                                  border_cosine,
                                  solid_ ? -2 * (math::length(line.end) + 2 * line.radius) : 0.0f};
  Planes found{out};
  for (std::size_t k = 0; k < blocks_.size(); k += at_once) {
    const int count = find_planes_(&blocks_[k], int(min(at_once, blocks_.size() - k)), question, met);
    for (const MetPlane& p : std::span(met, std::size_t(count)))
      found.offer({{p.normal[0], p.normal[1], p.normal[2]},
                   p.separation,
                   Vec3f{p.point[0], p.point[1], p.point[2]} + line.center});
  }
  found.sort();
  return found.count;
}

}  // namespace carom::geometry::detail
