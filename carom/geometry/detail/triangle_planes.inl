// The planes of triangles, compiled once for each instruction set: CAROM_PLANES_NAMESPACE, CAROM_PLANES_WIDTH.

namespace carom::geometry::detail::CAROM_PLANES_NAMESPACE {

constexpr int width = CAROM_PLANES_WIDTH;
using F = math::WideFloat<width>;
using Int = math::WideInt<width>;
using Mask = math::WideMask<width>;

using V = Wide3<width>;
CAROM_SIMD_INLINE F select(Mask m, F a, F b) { return math::select(m, a, b); }

/// As normalize of the cross product of two sides.
void set_normals(TriangleBlock* blocks, int count) {
  for (int k = 0; k < count; ++k)
    for (int lane = 0; lane < TriangleBlock::lanes; lane += width) {
      TriangleBlock& block = blocks[k];
      const V first = V::load(block.corner[0], lane);
      const V n = cross(V::load(block.corner[1], lane) - first, V::load(block.corner[2], lane) - first);
      const F length = sqrt(dot(n, n)), inverse = F::splat(1) / length;
      const Mask has = length > F::splat(1e-18f);
      select(has, n.x * inverse, F::zero()).store(block.normal[0] + lane);
      select(has, n.y * inverse, F::zero()).store(block.normal[1] + lane);
      select(has, n.z * inverse, F::zero()).store(block.normal[2] + lane);
    }
}

/// Of a block whose triangles may meet the line; lanes without one have negative edges.
int planes_of_block(const TriangleBlock& block, const TriangleQuestion& q, MetPlane* out) {
  const float r = q.radius, cutoff = r + q.margin, graze = 0.02f * r < 0.005f ? 0.02f * r : 0.005f;
  const float size2 = 4 * (q.end.x * q.end.x + q.end.y * q.end.y + q.end.z * q.end.z);
  const V center = V::splat(q.center), end = V::splat(q.end);
  const F zero = F::zero(), one = F::splat(1), radius = F::splat(r);
  const V first = V{zero, zero, zero} - end, whole = end + end;
  const F inverse = F::splat(size2 > 0 ? 1 / size2 : 0.0f), length2 = F::splat(size2);
  int number = 0;
  for (int lane = 0; lane < TriangleBlock::lanes; lane += width) {
    const Int edges = Int::load(block.edges + lane);
    Mask live = edges > Int::splat(-1);
    if (none(live)) continue;
    const V corner[3] = {V::load(block.corner[0], lane) - center, V::load(block.corner[1], lane) - center,
                         V::load(block.corner[2], lane) - center};
    const V normal = V::load(block.normal, lane);
    const F above = zero - dot(normal, corner[0]), lean = dot(normal, end), nearest = above - abs(lean);
    const auto has = [&](int bits) { return (edges & Int::splat(bits)) != Int::zero(); };
    const Mask flat[3] = {has(edge0_flat), has(edge1_flat), has(edge2_flat)};
    const F widen = select(flat[0] | flat[1] | flat[2], F::splat(0.0175f * r), zero);

    // The part of the line over the triangle, and whether its foot (the end near the plane) is beyond a sharp edge.
    F enter = zero, leave = one, size[3];
    Mask beside = Mask::none(), beyond_sharp = Mask::none();
    V outward[3];
    const Mask far_end = lean < zero;  // the foot is the line's second end
    for (int e = 0; e < 3; ++e) {
      const V side = corner[e == 2 ? 0 : e + 1] - corner[e];
      outward[e] = cross(side, normal);
      const F square = dot(outward[e], outward[e]);
      size[e] = sqrt(square);
      const F tolerance = max(F::splat(1e-5f) * square, widen * size[e]);
      const F from = dot(outward[e], first - corner[e]), to = from + dot(outward[e], whole);
      const Mask out_from = from > tolerance, out_to = to > tolerance;
      beside = beside | (out_from & out_to);
      live = live & (min(from, to) <= F::splat(cutoff) * size[e]);
      const F in_to = min(to, zero), in_from = min(from, zero);
      enter = select(out_from & (!out_to), max(enter, from / (from - in_to)), enter);
      leave = select(out_to & (!out_from), min(leave, in_from / (in_from - to)), leave);
      const Mask past = select(far_end, to, from) > zero;
      beyond_sharp = beyond_sharp | (past & (!flat[e]));
    }
    if (none(live)) continue;
    const Mask over = (!beside) & (enter <= leave);
    const F height_enter = above - lean + (lean + lean) * enter, height_leave = above - lean + (lean + lean) * leave;
    const Mask by_leave = height_leave < height_enter;
    const F height = select(by_leave, height_leave, height_enter);
    const Mask in_front = nearest > zero;
    // Nothing but the face may push, or the line touches it, or an edge that it is beyond is the neighbour's.
    const Mask by_face = (flat[0] & flat[1] & flat[2]) | (in_front & (!beyond_sharp)) |
                         ((!in_front) & over & ((height <= zero) | (nearest > F::splat(-0.02f * r))));
    Mask face = live & by_face & over, edge = live & (!by_face);
    V pushed = normal, touched{};
    F separation = height - radius;
    if (any(edge)) {
      F least = F::splat(3e38f);
      V apart{};
      for (int e = 0; e < 3; ++e) {
        // The closest points of two segments (Ericson 2005, §5.1.9).
        const V side = corner[e == 2 ? 0 : e + 1] - corner[e], between = first - corner[e];
        const F d = dot(side, side), b = dot(whole, side), c = dot(whole, between), f = dot(side, between);
        const F slant = length2 * d - b * b;
        const F guess =
            select(slant > F::splat(1e-6f) * length2 * d, clamp((b * f - c * d) / slant, zero, one), F::splat(0.5f));
        const F t = clamp((b * guess + f) / d, zero, one), s = clamp((b * t - c) * inverse, zero, one);
        const V on_edge = side * t, way = between + whole * s - on_edge;
        const F square = dot(way, way);
        const Mask nearer = square < least;
        least = select(nearer, square, least);
        apart = select(nearer, way, apart);
        touched = select(nearer, corner[e] + on_edge, touched);
      }
      const F distance = sqrt(least);
      edge = edge & (distance <= F::splat(cutoff));
      const V toward = apart * (one / max(distance, F::splat(1e-20f)));
      const F upright = dot(toward, normal);
      // The Gauss map of the surface: a direction that leans over a flat or concave edge is not on it.
      Mask wrong = !(upright > F::splat(-1e-3f)), lost = Mask::none();
      const Mask grazes = nearest > F::splat(r - graze);
      constexpr int open_bits[3] = {edge0_open, edge1_open, edge2_open};
      for (int e = 0; e < 3; ++e) {
        const Mask open = grazes & has(open_bits[e]);
        const Mask leans = (dot(outward[e], touched - corner[e]) >= F::splat(-1e-3f) * size[e] * size[e]) &
                           (dot(toward, outward[e]) > F::splat(1e-3f) * size[e]);
        wrong = wrong | ((flat[e] | open) & leans);
        lost = lost | (open & leans);
      }
      // Over the border of a face: see border_tolerance.
      const Mask apart_still = distance > radius;
      const Mask at_border = (distance > F::splat(r - q.border)) & (nearest > F::splat(r - q.border));
      const Mask level = upright > F::splat(q.border_level);
      face = face | (edge & wrong & (!lost) & over);
      edge = edge & (!wrong) & (!(at_border & (!level) & apart_still));
      pushed = select(edge & (!(at_border & level)), toward, normal);
      separation = select(edge, distance - radius, separation);
    }
    const Mask met = (face | edge) & (separation <= F::splat(q.margin));
    if (none(met)) continue;
    const V under = first + whole * select(by_leave, leave, enter) - normal * height;
    const V point = select(edge, touched, under);
    for (std::uint32_t lanes = bitmask(met); lanes != 0; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      out[number++] = {{pushed.x[i], pushed.y[i], pushed.z[i]}, separation[i], {point.x[i], point.y[i], point.z[i]}};
    }
  }
  return number;
}

int find_planes(const TriangleBlock* blocks, int count, const TriangleQuestion& q, MetPlane* out) {
  const V low = V::splat(q.low), high = V::splat(q.high), center = V::splat(q.center), end = V::splat(q.end);
  const F behind = F::splat(q.behind), cutoff = F::splat(q.radius + q.margin);
  // Few of them come near: these move together, so that their lanes are filled.
  TriangleBlock near{};
  int held = 0, number = 0;
  const auto look_at_near = [&] {
    for (int lane = held; lane < TriangleBlock::lanes; ++lane) near.edges[lane] = -1;
    number += planes_of_block(near, q, out + number);
    held = 0;
  };
  for (int k = 0; k < count * (TriangleBlock::lanes / width); ++k) {
    const TriangleBlock& block = blocks[k / (TriangleBlock::lanes / width)];
    const int lane = k % (TriangleBlock::lanes / width) * width;
    const V corner[3] = {V::load(block.corner[0], lane), V::load(block.corner[1], lane),
                         V::load(block.corner[2], lane)};
    const auto meets = [&](F a, F b, F c, F least, F most) {
      return (min(a, min(b, c)) <= most) & (max(a, max(b, c)) >= least);
    };
    Mask live = meets(corner[0].x, corner[1].x, corner[2].x, low.x, high.x) &
                meets(corner[0].y, corner[1].y, corner[2].y, low.y, high.y) &
                meets(corner[0].z, corner[1].z, corner[2].z, low.z, high.z);
    if (none(live)) continue;
    const V normal = V::load(block.normal, lane);
    const F above = F::zero() - dot(normal, corner[0] - center), nearest = above - abs(dot(normal, end));
    live = live & (above >= behind) & (nearest <= cutoff);
    for (std::uint32_t lanes = bitmask(live); lanes != 0; lanes &= lanes - 1) {
      const int from = lane + __builtin_ctz(lanes);
      for (int i = 0; i < 3; ++i) {
        for (int c = 0; c < 3; ++c) near.corner[c][i][held] = block.corner[c][i][from];
        near.normal[i][held] = block.normal[i][from];
      }
      near.edges[held] = block.edges[from];
      if (++held == TriangleBlock::lanes) look_at_near();
    }
  }
  if (held > 0) look_at_near();
  return number;
}

}  // namespace carom::geometry::detail::CAROM_PLANES_NAMESPACE
