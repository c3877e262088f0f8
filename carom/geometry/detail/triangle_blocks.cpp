#include "carom/geometry/detail/triangle_blocks.h"

#include "carom/geometry/detail/contact_points.h"

namespace carom::geometry::detail {
namespace {

using Four = math::WideFloat<4>;
using Mask = math::WideMask<4>;

struct Wide3 {
  Four x, y, z;
  static Wide3 load(const float (&p)[3][4]) { return {Four::load(p[0]), Four::load(p[1]), Four::load(p[2])}; }
  static Wide3 splat(Vec3f v) { return {Four::splat(v.x), Four::splat(v.y), Four::splat(v.z)}; }
  friend Wide3 operator+(const Wide3& a, const Wide3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Wide3 operator-(const Wide3& a, const Wide3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Wide3 operator*(const Wide3& a, Four s) { return {a.x * s, a.y * s, a.z * s}; }
  Vec3f operator[](int lane) const { return {x[lane], y[lane], z[lane]}; }
};
Four dot(const Wide3& a, const Wide3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Wide3 cross(const Wide3& a, const Wide3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Wide3 select(Mask m, const Wide3& a, const Wide3& b) {
  return {math::select(m, a.x, b.x), math::select(m, a.y, b.y), math::select(m, a.z, b.z)};
}

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

void TriangleBlocks::gather(const Shape3& surface, const Bounds3f& box) {
  clear();
  origin_ = box.center();
  solid_ = surface.type == ShapeType3::height_field;
  visit_triangles(surface, box, true, [&](const SurfaceTriangle& t) {
    const int lane = count_++ % 4;
    if (lane == 0) {
      // Lanes without a triangle are too far away for anything.
      blocks_.emplace_back();
      for (auto& corner : blocks_.back().corner)
        for (float& x : corner[0]) x = 3e30f;
    }
    Block& b = blocks_.back();
    const Vec3f normal = normalize(math::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
    for (int k = 0; k < 3; ++k) {
      for (int c = 0; c < 3; ++c) b.corner[c][k][lane] = t.corner[c][k] - origin_[k];
      b.normal[k][lane] = normal[k];
    }
    b.edges[lane] = t.edges;
    return true;
  });
}

int TriangleBlocks::planes(const NearbyLine& line, std::span<SurfacePlane> out) const {
  const float r = line.radius, cutoff = r + line.margin, border = border_tolerance(r),
              size2 = 4 * length_squared(line.end);
  const Wide3 low = Wide3::splat(line.box.low - origin_), high = Wide3::splat(line.box.high - origin_);
  const Vec3f middle = line.center - origin_;
  const Wide3 center = Wide3::splat(middle), end = Wide3::splat(line.end), first = center - end, whole = end + end;
  const Four zero = Four::zero(), one = Four::splat(1), radius = Four::splat(r);
  const Four behind = Four::splat(solid_ ? -2 * (math::length(line.end) + 2 * r) : 0.0f);
  const Four inverse = Four::splat(size2 > 0 ? 1 / size2 : 0.0f), length2 = Four::splat(size2);
  Planes found{out};
  for (const Block& block : blocks_) {
    const Wide3 corner[3] = {Wide3::load(block.corner[0]), Wide3::load(block.corner[1]), Wide3::load(block.corner[2])};
    const auto meets = [&](Four a, Four b, Four c, Four least, Four most) {
      return (min(a, min(b, c)) <= most) & (max(a, max(b, c)) >= least);
    };
    Mask live = meets(corner[0].x, corner[1].x, corner[2].x, low.x, high.x) &
                meets(corner[0].y, corner[1].y, corner[2].y, low.y, high.y) &
                meets(corner[0].z, corner[1].z, corner[2].z, low.z, high.z);
    if (none(live)) continue;
    const Wide3 normal = Wide3::load(block.normal);
    const Four above = dot(normal, center - corner[0]), lean = dot(normal, end), nearest = above - abs(lean);
    live = live & (above >= behind) & (nearest <= Four::splat(cutoff));
    if (none(live)) continue;
    const math::WideInt<4> edges = math::WideInt<4>::load(block.edges);
    const auto has = [&](int bits) { return (edges & math::WideInt<4>::splat(bits)) != math::WideInt<4>::zero(); };
    const Mask flat[3] = {has(edge0_flat), has(edge1_flat), has(edge2_flat)};
    const Four widen = select(flat[0] | flat[1] | flat[2], Four::splat(0.0175f * r), zero);

    // The part of the line over the triangle, and the edges that its foot (the end near the plane) is beyond.
    Four enter = zero, leave = one, size[3];
    Mask beside = Mask::none(), beyond = Mask::none(), beyond_sharp = Mask::none();
    Wide3 outward[3];
    const Mask far_end = lean < zero;  // the foot is the line's second end
    for (int e = 0; e < 3; ++e) {
      const Wide3 side = corner[e == 2 ? 0 : e + 1] - corner[e];
      outward[e] = cross(side, normal);
      const Four square = dot(outward[e], outward[e]);
      size[e] = sqrt(square);
      const Four tolerance = max(Four::splat(1e-5f) * square, widen * size[e]);
      const Four from = dot(outward[e], first - corner[e]), to = from + dot(outward[e], whole);
      const Mask out_from = from > tolerance, out_to = to > tolerance;
      beside = beside | (out_from & out_to);
      live = live & (min(from, to) <= Four::splat(cutoff) * size[e]);
      const Four in_to = min(to, zero), in_from = min(from, zero);
      enter = select(out_from & (!out_to), max(enter, from / (from - in_to)), enter);
      leave = select(out_to & (!out_from), min(leave, in_from / (in_from - to)), leave);
      const Mask past = select(far_end, to, from) > zero;
      beyond = beyond | past;
      beyond_sharp = beyond_sharp | (past & (!flat[e]));
    }
    if (none(live)) continue;
    const Mask over = (!beside) & (enter <= leave);
    const Four height_enter = above - lean + (lean + lean) * enter, height_leave = above - lean + (lean + lean) * leave;
    const Mask by_leave = height_leave < height_enter;
    const Four height = select(by_leave, height_leave, height_enter);
    const Mask in_front = nearest > zero;
    // Nothing but the face may push, or the line touches it, or an edge that it is beyond is the neighbour's.
    const Mask by_face = (flat[0] & flat[1] & flat[2]) | (in_front & (!beyond_sharp)) |
                         ((!in_front) & over & ((height <= zero) | (nearest > Four::splat(-0.02f * r))));
    Mask face = live & by_face & over, edge = live & (!by_face);
    Wide3 pushed = normal, touched{};
    Four separation = height - radius;
    if (any(edge)) {
      Four least = Four::splat(3e38f);
      Wide3 apart{};
      for (int e = 0; e < 3; ++e) {
        // The closest points of two segments (Ericson 2005, §5.1.9).
        const Wide3 side = corner[e == 2 ? 0 : e + 1] - corner[e], between = first - corner[e];
        const Four d = dot(side, side), b = dot(whole, side), c = dot(whole, between), f = dot(side, between);
        const Four slant = length2 * d - b * b;
        const Four guess = select(slant > Four::splat(1e-6f) * length2 * d, clamp((b * f - c * d) / slant, zero, one),
                                  Four::splat(0.5f));
        const Four t = clamp((b * guess + f) / d, zero, one), s = clamp((b * t - c) * inverse, zero, one);
        const Wide3 on_edge = side * t, way = between + whole * s - on_edge;
        const Four square = dot(way, way);
        const Mask nearer = square < least;
        least = select(nearer, square, least);
        apart = select(nearer, way, apart);
        touched = select(nearer, corner[e] + on_edge, touched);
      }
      const Four distance = sqrt(least);
      edge = edge & (distance <= Four::splat(cutoff));
      const Wide3 toward = apart * (one / max(distance, Four::splat(1e-20f)));
      const Four upright = dot(toward, normal);
      // The Gauss map of the surface: a direction that leans over a flat or concave edge is not on it.
      Mask wrong = !(upright > Four::splat(-1e-3f)), lost = Mask::none();
      const Mask grazes = nearest > Four::splat(r - min(0.02f * r, 0.005f));
      constexpr int open_bits[3] = {edge0_open, edge1_open, edge2_open};
      for (int e = 0; e < 3; ++e) {
        const Mask open = grazes & has(open_bits[e]);
        const Mask leans = (dot(outward[e], touched - corner[e]) >= Four::splat(-1e-3f) * size[e] * size[e]) &
                           (dot(toward, outward[e]) > Four::splat(1e-3f) * size[e]);
        wrong = wrong | ((flat[e] | open) & leans);
        lost = lost | (open & leans);
      }
      // Over the border of a face: see border_tolerance.
      const Mask apart_still = distance > radius;
      const Mask at_border = (distance > Four::splat(r - border)) & (nearest > Four::splat(r - border));
      const Mask level = upright > Four::splat(border_cosine);
      face = face | (edge & wrong & (!lost) & over);
      edge = edge & (!wrong) & (!(at_border & (!level) & apart_still));
      pushed = select(edge & (!(at_border & level)), toward, normal);
      separation = select(edge, distance - radius, separation);
    }
    const Mask met = (face | edge) & (separation <= Four::splat(line.margin));
    if (none(met)) continue;
    const Wide3 under = first + whole * select(by_leave, leave, enter) - normal * height;
    const Wide3 point = select(edge, touched, under);
    for (std::uint32_t lanes = bitmask(met); lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      found.offer({pushed[lane], separation[lane], point[lane] + origin_});
    }
  }
  found.sort();
  return found.count;
}

}  // namespace carom::geometry::detail
