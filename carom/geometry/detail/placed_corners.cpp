#include "carom/geometry/detail/placed_corners.h"

namespace carom::geometry::detail {

// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): what the shape has not is not read
PlacedCorners::PlacedCorners(const Convex& core, const Transform3f& x)
    : origin_(x.p), hull_(core.hull), turn_(to_matrix(x.q)) {
  if (core.kind == CoreKind::hull) {
    if (core.hull->vertices.size() > capacity) return;
    blocks_ = int(core.hull->vertex_lanes.size() / 12);
    for (int i = 0; i < blocks_; ++i) {
      const float* p = core.hull->vertex_lanes.data() + 12 * i;
      const Four u = Four::load(p), v = Four::load(p + 4), w = Four::load(p + 8);
      for (int k = 0; k < 3; ++k) {
        const Four at = u * Four::splat(turn_.cx[k]) + v * Four::splat(turn_.cy[k]) + w * Four::splat(turn_.cz[k]);
        at.store(lanes_ + 12 * i + 4 * k);
      }
    }
    if (core.hull->planes.size() <= capacity) face_blocks_ = int(core.hull->planes.size() + 3) / 4;
  } else if (core.kind == CoreKind::box) {
    blocks_ = 2;
    for (int i = 0; i < 8; ++i) {
      const Vec3f p = turn_ * Vec3f{i & 1 ? core.half.x : -core.half.x, i & 2 ? core.half.y : -core.half.y,
                                    i & 4 ? core.half.z : -core.half.z};
      for (int k = 0; k < 3; ++k) lanes_[12 * (i / 4) + 4 * k + i % 4] = p[k];
    }
    face_blocks_ = 2;
    half_ = core.half;
  }
}

void PlacedCorners::place_planes() const {
  planes_placed_ = true;
  const int count = hull_ != nullptr ? int(hull_->planes.size()) : 6;
  for (int i = 0; i < 4 * face_blocks_; ++i) {
    const int face = min(i, count - 1), axis = face >> 1;
    float* lane = planes_ + 16 * (i / 4) + i % 4;
    Vec3f n;
    if (hull_ != nullptr) {
      const HullPlane& plane = hull_->planes[std::size_t(face)];
      n = turn_ * plane.normal, lane[12] = plane.offset;
    } else {
      n = (i & 1 ? -1.0f : 1.0f) * (axis == 0 ? turn_.cx : axis == 1 ? turn_.cy : turn_.cz), lane[12] = half_[axis];
    }
    lane[0] = n.x, lane[4] = n.y, lane[8] = n.z;
  }
}

PlacedCorners::Before PlacedCorners::face_before(Vec3f p, Vec3f q, Vec3f r) const {
  if (!planes_placed_) place_planes();
  Four most = Four::splat(-3.4e38f);
  math::WideInt<4> where = math::WideInt<4>::zero();
  for (int i = 0; i < face_blocks_; ++i) {
    const float* lane = planes_ + 16 * i;
    const Four x = Four::load(lane), y = Four::load(lane + 4), z = Four::load(lane + 8);
    const Four a = x * Four::splat(p.x) + y * Four::splat(p.y) + z * Four::splat(p.z),
               b = x * Four::splat(q.x) + y * Four::splat(q.y) + z * Four::splat(q.z),
               c = x * Four::splat(r.x) + y * Four::splat(r.y) + z * Four::splat(r.z);
    const Four s = min(a, min(b, c)) - Four::load(lane + 12);
    const math::WideMask<4> more = s > most;
    most = select(more, s, most);
    where = select(more, math::WideInt<4>::splat(i), where);
  }
  int best = 0;
  for (int lane = 1; lane < 4; ++lane)
    if (most[lane] > most[best]) best = lane;
  const float* lane = planes_ + 16 * where[best] + best;
  return {most[best], {lane[0], lane[4], lane[8]}};
}
bool PlacedCorners::meets_segment(Vec3f start, Vec3f way) const {
  if (!planes_placed_) place_planes();
  const Four zero = Four::zero(), one = Four::splat(1);
  Four enter = zero, leave = one;
  for (int i = 0; i < face_blocks_; ++i) {
    const float* lane = planes_ + 16 * i;
    const Four x = Four::load(lane), y = Four::load(lane + 4), z = Four::load(lane + 8);
    const Four above = x * Four::splat(start.x) + y * Four::splat(start.y) + z * Four::splat(start.z) -
                       Four::load(lane + 12),
               climb = x * Four::splat(way.x) + y * Four::splat(way.y) + z * Four::splat(way.z);
    const math::WideMask<4> level = climb == zero;
    const Four at = select(level, select(above > zero, Four::splat(2), zero), -above / select(level, one, climb));
    enter = max(enter, select(climb > zero, zero, at));
    leave = min(leave, select(climb > zero, at, one));
  }
  return max(max(enter[0], enter[1]), max(enter[2], enter[3])) <= min(min(leave[0], leave[1]), min(leave[2], leave[3]));
}

void PlacedCorners::place_edges() const {
  const int count = hull_ == nullptr ? 12 : int(hull_->edges.size() / 2);
  edge_blocks_ = count <= most_edges && has_faces() ? (count + 3) / 4 : 0;
  for (int i = 0; i < 4 * edge_blocks_; ++i) {
    const int edge = min(i, count - 1);
    int from, to;
    if (hull_ == nullptr) {  // of a box, four along each axis
      const int axis = edge / 4, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
      from = (edge & 1 ? u : 0) | (edge & 2 ? v : 0), to = from | 1 << axis;
    } else {
      const auto* half_edge = &hull_->edges[2 * std::size_t(edge)];
      from = half_edge[0].origin, to = half_edge[1].origin;
    }
    const Vec3f start = corner(from), way = corner(to) - start;
    float* lane = edges_ + 24 * (i / 4) + i % 4;
    for (int k = 0; k < 3; ++k) lane[4 * k] = start[k], lane[12 + 4 * k] = way[k];
  }
}
bool PlacedCorners::nearest_edge(Vec3f start, Vec3f way, Edge& nearest) const {
  if (edge_blocks_ < 0) place_edges();
  if (edge_blocks_ == 0) return false;
  const Four zero = Four::zero(), one = Four::splat(1), uu = Four::splat(length_squared(way));
  const Four a[3] = {Four::splat(start.x), Four::splat(start.y), Four::splat(start.z)},
             u[3] = {Four::splat(way.x), Four::splat(way.y), Four::splat(way.z)};
  const auto dot = [](const Four(&p)[3], const Four(&q)[3]) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; };
  const auto part = [&](Four x, Four y) { return min(max(x / y, zero), one); };
  Four least = Four::splat(3.4e38f);
  math::WideInt<4> where = math::WideInt<4>::zero();
  for (int i = 0; i < edge_blocks_; ++i) {
    // Where the lines are nearest, kept to the segment; from there to the edge, and back (Ericson 2005, §5.1.9).
    const float* lane = edges_ + 24 * i;
    Four v[3], r[3], n[3], rv[3], d[3];
    for (int k = 0; k < 3; ++k) r[k] = Four::load(lane + 4 * k) - a[k], v[k] = Four::load(lane + 12 + 4 * k);
    for (int k = 0; k < 3; ++k) {
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      n[k] = u[p] * v[q] - u[q] * v[p], rv[k] = r[p] * v[q] - r[q] * v[p];
    }
    const Four vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r), nn = dot(n, n);
    const math::WideMask<4> skew = nn > Four::splat(1e-8f) * uu * vv;
    Four s = select(skew, part(dot(rv, n), select(skew, nn, one)), zero);
    const Four t = part(uv * s - vr, vv);
    s = part(uv * t + ur, uu);
    for (int k = 0; k < 3; ++k) d[k] = r[k] + v[k] * t - u[k] * s;
    const Four size = dot(d, d);
    const math::WideMask<4> less = size < least;
    least = select(less, size, least);
    where = select(less, math::WideInt<4>::splat(i), where);
  }
  int best = 0;
  for (int lane = 1; lane < 4; ++lane)
    if (least[lane] < least[best]) best = lane;
  const float* lane = edges_ + 24 * where[best] + best;
  nearest = {{lane[0], lane[4], lane[8]}, {lane[12], lane[16], lane[20]}, least[best]};
  return true;
}

void PlacedCorners::go(const ShapeWay& approach) {
  const Four way[3] = {Four::splat(approach.way.x), Four::splat(approach.way.y), Four::splat(approach.way.z)},
             turn[3] = {Four::splat(approach.turn.x), Four::splat(approach.turn.y), Four::splat(approach.turn.z)};
  for (int i = 0; i < blocks_; ++i) {
    const float* p = lanes_ + 12 * i;
    const Four at[3] = {Four::load(p), Four::load(p + 4), Four::load(p + 8)};
    for (int k = 0; k < 3; ++k) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      (at[k] + way[k] + (turn[u] * at[v] - turn[v] * at[u])).store(then_ + 12 * i + 4 * k);
    }
  }
}
Bounds3f PlacedCorners::bounds() const {
  Bounds3f b;
  for (int k = 0; k < 3; ++k) {
    Four low = Four::load(lanes_ + 4 * k), high = low;
    for (int i = 0; i < blocks_; ++i)
      for (const float* p : {lanes_, then_}) {
        const Four at = Four::load(p + 12 * i + 4 * k);
        low = min(low, at), high = max(high, at);
      }
    b.low[k] = min(min(low[0], low[1]), min(low[2], low[3]));
    b.high[k] = max(max(high[0], high[1]), max(high[2], high[3]));
  }
  return b;
}

}  // namespace carom::geometry::detail
