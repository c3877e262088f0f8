// The kernels of triangle_groups.h for one instruction set: CAROM_GROUPS_NAMESPACE.

namespace carom::geometry::detail::CAROM_GROUPS_NAMESPACE {

constexpr int lanes_of_group = TriangleGroup::lanes;
using F = math::WideFloat<lanes_of_group>;
using Int = math::WideInt<lanes_of_group>;
using Mask = math::WideMask<lanes_of_group>;
using V = Wide3<lanes_of_group>;

CAROM_SIMD_INLINE static F least_of(F a, F b, F c) { return min(a, min(b, c)); }
CAROM_SIMD_INLINE static F most_of(F a, F b, F c) { return max(a, max(b, c)); }
CAROM_SIMD_INLINE static Mask mask_of(std::uint32_t lanes) {
  const Int bit = {{1, 2, 4, 8, 16, 32, 64, 128}};
  return (Int::splat(std::int32_t(lanes)) & bit) != Int::zero();
}

/// As seen from the shape's origin.
struct Seen {
  V corner[3];
  CAROM_SIMD_INLINE Seen(const TriangleGroup& group, const PlacedShape& shape) {
    const V origin = V::splat(shape.origin);
    for (int c = 0; c < 3; ++c) corner[c] = V::load(group.corner[c]) - origin;
  }
  CAROM_SIMD_INLINE F farthest(const V& d) const {
    return most_of(dot(d, corner[0]), dot(d, corner[1]), dot(d, corner[2]));
  }
  CAROM_SIMD_INLINE F nearest(const V& d) const {
    return least_of(dot(d, corner[0]), dot(d, corner[1]), dot(d, corner[2]));
  }
};

/// The least that any corner of the shape lies along each of N directions (m, times their lengths).
template <int N>
CAROM_SIMD_INLINE static void least_along(const float* corners, int blocks, const V (&d)[N], F (&low)[N]) {
  for (int k = 0; k < N; ++k) low[k] = F::splat(3.4e38f);
  for (int i = 0; i < 4 * blocks; ++i) {
    const V at = V::splat_of(corners, i);
    for (int k = 0; k < N; ++k) low[k] = min(low[k], dot(at, d[k]));
  }
}

static std::uint32_t load(const float* vertices, const std::uint32_t* indices, const std::uint32_t* triangles,
                          int count, const Vec3f& low, const Vec3f& high, TriangleGroup& group) {
  const std::uint32_t* of[lanes_of_group];
  for (int lane = 0; lane < lanes_of_group; ++lane) {
    group.index[lane] = triangles[lane < count ? lane : count - 1];
    of[lane] = indices + 3 * std::size_t(group.index[lane]);
  }
  F least[3], most[3];
#pragma GCC unroll 3
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](int lane) __attribute__((always_inline)) { return vertices + 3 * std::size_t(of[lane][c]); };
    const float *p0 = at(0), *p1 = at(1), *p2 = at(2), *p3 = at(3), *p4 = at(4), *p5 = at(5), *p6 = at(6), *p7 = at(7);
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      const F x = {F::Vector{p0[k], p1[k], p2[k], p3[k], p4[k], p5[k], p6[k], p7[k]}};
      x.store(group.corner[c][k]);
      least[k] = c == 0 ? x : min(least[k], x);
      most[k] = c == 0 ? x : max(most[k], x);
    }
  }
  Mask meets = mask_of((1u << count) - 1);
  const V from = V::splat(low), to = V::splat(high);
  meets = meets & (least[0] <= to.x) & (least[1] <= to.y) & (least[2] <= to.z);
  return bitmask(meets & (most[0] >= from.x) & (most[1] >= from.y) & (most[2] >= from.z));
}

static std::uint32_t near(const TriangleGroup& group, std::uint32_t lanes, const PlacedShape& shape,
                          const NearQuestion& question, NearAnswer& answer) {
  const F zero = F::zero();
  const Seen seen(group, shape);
  Mask live = mask_of(lanes);
  answer.learned = 0;
  for (int i = 0; i < shape.direction_count; ++i) {
    const F off = F::splat(shape.floor[i]) - seen.farthest(V::splat_of(shape.directions, i));
    const std::uint32_t kept = bitmask(live & (off > F::splat(question.keeps)));
    answer.uses[i] = __builtin_popcount(kept);
    live = live & mask_of(~kept);
  }
  if (none(live)) return 0;
  const auto part = [&](Mask gone, const V& direction) __attribute__((always_inline)) {
    const std::uint32_t bits = bitmask(live & gone);
    if (bits == 0) return;
    const int lane = __builtin_ctz(bits), i = answer.learned++;
    answer.lane[i] = lane;
    Vec3f& d = answer.direction[i];
    d.x = direction.x[lane], d.y = direction.y[lane], d.z = direction.z[lane];
    live = live & (!gone);
  };
  const F keeps = F::splat(question.keeps * question.keeps), around = F::splat(question.around * question.around);
  // Does all of the shape, which lies this far along a direction, stay out of reach as it goes on?
  const auto keeps_off = [&](F height, const V& direction, F size, F level) __attribute__((always_inline)) {
    const Mask off = live & (height > zero) & (height * height > keeps * size);
    if (none(off)) return off;
    F then[1];
    least_along<1>(shape.corners_then, shape.corner_blocks, {direction}, then);
    const F left = then[0] - level;
    return off & (left > zero) & (left * left > keeps * size);
  };

  const V edge[3] = {seen.corner[1] - seen.corner[0], seen.corner[2] - seen.corner[1], seen.corner[0] - seen.corner[2]};
  const V normal = cross(edge[0], edge[1]);
  const F level = dot(normal, seen.corner[0]), size = dot(normal, normal);
  if (!shape.solid) live = live & (!(dot(normal, V::splat(question.middle)) < level));
  F height[1];
  least_along<1>(shape.corners, shape.corner_blocks, {normal}, height);
  const F above = max(height[0] - level, zero);
  part((above * above > around * size) | keeps_off(above, normal, size, level), normal);
  if (none(live)) return 0;

  const V outward[3] = {cross(edge[0], normal), cross(edge[1], normal), cross(edge[2], normal)};
  F beside[3];
  least_along<3>(shape.corners, shape.corner_blocks, outward, beside);
  for (int e = 0; e < 3; ++e) {
    // Above the plane and beside an edge of it: both are parts of the distance.
    const F from = dot(outward[e], seen.corner[e]), b = beside[e] - from, length = dot(outward[e], outward[e]);
    const Mask far = b * b * size + above * above * length > around * size * length;
    part((b > zero) & (far | keeps_off(b, outward[e], length, from)), outward[e]);
  }
  return bitmask(live);
}

static void before_faces(const TriangleGroup& group, std::uint32_t lanes, const PlacedShape& shape,
                         const NearQuestion& question, FacesAnswer& answer) {
  const Seen seen(group, shape);
  F most = F::splat(-3.4e38f);
  Int face = Int::zero();
  for (int i = 0; i < 4 * shape.face_blocks; ++i) {
    const F before = seen.nearest(V::splat_of(shape.planes, i, 4)) - F::splat(shape.planes[16 * (i / 4) + 12 + i % 4]);
    const Mask more = before > most;
    most = math::select(more, before, most);
    face = math::select(more, Int::splat(i), face);
  }
  answer.apart = bitmask(most > F::splat(question.around)) & lanes;
  answer.ahead = bitmask(most > F::splat(question.keeps)) & lanes & ~answer.apart;
  face.store(answer.face);
}

static void clearance(const TriangleGroup& group, const PlacedShape& shape, const ClearanceQuestion& question,
                      float (&gap)[TriangleGroup::lanes]) {
  const Seen seen(group, shape);
  const F zero = F::zero(), radius = F::splat(shape.radius);
  F off = F::splat(-3.4e38f);
  for (int i = 0; i < shape.direction_count; ++i)
    off = max(off, F::splat(shape.now[i]) - seen.farthest(V::splat_of(shape.directions, i)));
  off = off - radius;
  const V corner[3] = {V::load(group.corner[0]), V::load(group.corner[1]), V::load(group.corner[2])};
  if (shape.solid) {  // what keeps the shape above or beside them
    const V low = V::splat(question.box_low), high = V::splat(question.box_high);
    const F x = max(least_of(corner[0].x, corner[1].x, corner[2].x) - high.x,
                    low.x - most_of(corner[0].x, corner[1].x, corner[2].x)),
            z = max(least_of(corner[0].z, corner[1].z, corner[2].z) - high.z,
                    low.z - most_of(corner[0].z, corner[1].z, corner[2].z));
    off = max(off, max(low.y - most_of(corner[0].y, corner[1].y, corner[2].y), max(x, z)));
  } else {
    const V low = V::splat(question.low), high = V::splat(question.high);
    const auto along = [&](const Vec3f& d, F least, F most) __attribute__((always_inline)) {
      const V axis = V::splat(d);
      return max(seen.nearest(axis) - most, least - seen.farthest(axis));
    };
    off = max(max(off, zero), max(along(question.axis[0], low.x, high.x),
                                  max(along(question.axis[1], low.y, high.y), along(question.axis[2], low.z, high.z))));
  }
  if (shape.corner_blocks > 0) {
    const V normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const F size = sqrt(dot(normal, normal));
    const Mask has = size > zero;
    const V n = normal * (F::splat(1) / math::select(has, size, F::splat(1))), down = n * F::splat(-1);
    F low[2];
    least_along<2>(shape.corners, shape.corner_blocks, {n, down}, low);
    const F level = dot(n, seen.corner[0]);
    F by_plane = low[0] - level - radius;
    if (!shape.solid) by_plane = max(by_plane, low[1] + level - radius);
    off = math::select(has, max(off, by_plane), off);
  }
  off.store(gap);
}

extern const TriangleKernels kernels = {load, near, before_faces, clearance};

}  // namespace carom::geometry::detail::CAROM_GROUPS_NAMESPACE
