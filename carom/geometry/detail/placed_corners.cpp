#include "carom/geometry/detail/placed_corners.h"

#include <utility>

namespace carom::geometry::detail {

// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): what the shape has not is not read
PlacedCorners::PlacedCorners(const Convex& core, const Transform3f& x)
    : origin_(x.p), hull_(core.hull), turn_(to_matrix(x.q)) {
  middle_ = turn_ * inner_point(core);
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
int PlacedCorners::face_toward(Vec3f d) const {
  if (!planes_placed_) place_planes();
  const Four x = Four::splat(d.x), y = Four::splat(d.y), z = Four::splat(d.z);
  Four most = Four::splat(-3.4e38f);
  math::WideInt<4> where = math::WideInt<4>::zero();
  for (int i = 0; i < face_blocks_; ++i) {
    const float* lane = planes_ + 16 * i;
    const Four along = x * Four::load(lane) + y * Four::load(lane + 4) + z * Four::load(lane + 8);
    const math::WideMask<4> more = along > most;
    most = select(more, along, most);
    where = select(more, math::WideInt<4>::splat(i), where);
  }
  int best = 0;
  for (int lane = 1; lane < 4; ++lane)
    if (most[lane] > most[best] || (most[lane] == most[best] && where[lane] < where[best])) best = lane;
  return 4 * where[best] + best;
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

/// Which corners the face has that looks most along `toward`, in the order of face_feature.
int PlacedCorners::face_corners(Vec3f toward, std::uint8_t (&corners)[Feature::capacity]) const {
  const Vec3f d{dot(turn_.cx, toward), dot(turn_.cy, toward), dot(turn_.cz, toward)};
  if (hull_ == nullptr) {
    const Vec3f a = abs(d);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    if (d[axis] < 0)
      corners[0] = std::uint8_t(u), corners[1] = 0, corners[2] = std::uint8_t(v), corners[3] = std::uint8_t(u | v);
    else
      for (int k = 0; k < 4; ++k) corners[k] = std::uint8_t(1 << axis | (k == 0 || k == 3 ? u : 0) | (k < 2 ? v : 0));
    return 4;
  }
  const HullFace& face = hull_->faces[std::size_t(detail::farthest(hull_->normal_lanes, d))];
  const int n = face.edge_count, step = (n + 19) / 20;
  std::uint16_t e = face.first_edge;
  int count = 0;
  for (int i = 0; i < n; ++i, e = hull_->edges[e].next)
    if (i % step == 0) corners[count++] = std::uint8_t(hull_->edges[e].origin);
  return count;
}

void PlacedCorners::clip_face(const Vec3f (&triangle)[3], Vec3f normal, float radius, float margin, float widen,
                              ContactPoints& out) const {
  // How far a corner is beyond each side and above the plane, all at once: where an edge is cut, they are what they are
  // there too.
  struct alignas(16) Corner {
    float beyond[4], at[4];
    std::uint32_t id;
  };
  float rows[3][4], levels[4], tolerance[3];
  for (int e = 0; e < 4; ++e) {
    const Vec3f from = triangle[e % 3] - origin_;
    const Vec3f out_of = e == 3 ? normal : cross(triangle[e == 2 ? 0 : e + 1] - triangle[e], normal);
    for (int k = 0; k < 3; ++k) rows[k][e] = out_of[k];
    levels[e] = dot(out_of, from);
    if (e == 3) break;
    const float square = dot(out_of, out_of);
    tolerance[e] = widen > 0 ? max(1e-5f * square, widen * math::sqrt(square)) : 1e-5f * square;
  }
  const Four x = Four::load(rows[0]), y = Four::load(rows[1]), z = Four::load(rows[2]), level = Four::load(levels);
  RawArray<Corner, 28> room[2];
  Corner *in = room[0].items, *next = room[1].items;
  std::uint8_t names[Feature::capacity];
  int count = face_corners(-normal, names);
  for (int i = 0; i < count; ++i) {
    const Vec3f p = corner(names[i]);
    (x * Four::splat(p.x) + y * Four::splat(p.y) + z * Four::splat(p.z) - level).store(in[i].beyond);
    in[i].at[0] = p.x, in[i].at[1] = p.y, in[i].at[2] = p.z, in[i].at[3] = 0;
    in[i].id = names[i];
  }
  for (int e = 0; e < 3 && count > 0; ++e) {
    float off[28];
    bool all = true;
    for (int i = 0; i < count; ++i) {
      off[i] = in[i].beyond[e];
      if (off[i] <= tolerance[e]) off[i] = min(off[i], 0.0f);
      all = all && off[i] <= 0;
    }
    if (all) continue;
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const int j = i + 1 < count ? i + 1 : 0;
      const Corner &p = in[i], &q = in[j];
      if (off[i] <= 0) next[kept++] = p;
      if ((off[i] <= 0) == (off[j] <= 0)) continue;
      const Four t = Four::splat(off[i] / (off[i] - off[j]));
      const Four p_beyond = Four::load(p.beyond), p_at = Four::load(p.at);
      Corner& cut = next[kept++];
      (p_beyond + (Four::load(q.beyond) - p_beyond) * t).store(cut.beyond);
      (p_at + (Four::load(q.at) - p_at) * t).store(cut.at);
      // The two corners in a fixed order: the name is that of the edge, whichever end is inside.
      const std::uint32_t low = min(p.id, q.id), high = max(p.id, q.id);
      cut.id = std::uint32_t(e + 1) << 8 | ((low * 31 + high * 7) & 0xffff) << 14 | (low & 0xff);
    }
    std::swap(in, next);
    count = kept;
  }
  for (int i = 0; i < count; ++i) {
    const float height = in[i].beyond[3], s = height - radius;
    if (s > margin) continue;
    const Vec3f p = Vec3f{in[i].at[0], in[i].at[1], in[i].at[2]} + origin_;
    out.add(p - normal * (0.5f * (radius + height)), s, in[i].id);
  }
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
Bounds3f PlacedCorners::bounds_of(const float* lanes) const {
  Bounds3f b;
  for (int k = 0; k < 3; ++k) {
    Four low = Four::load(lanes + 4 * k), high = low;
    for (int i = 1; i < blocks_; ++i) {
      const Four at = Four::load(lanes + 12 * i + 4 * k);
      low = min(low, at), high = max(high, at);
    }
    b.low[k] = min(min(low[0], low[1]), min(low[2], low[3]));
    b.high[k] = max(max(high[0], high[1]), max(high[2], high[3]));
  }
  return b;
}

}  // namespace carom::geometry::detail
