// Where vertices of a cloth or a soft body stand before the faces of another.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/detail/nearest_share.h"
#include "carom/particles/detail/soft_meeting.h"

namespace carom::particles::detail {

namespace {

constexpr float meeting_recovery = 0.5f;  // m/s, at which an overlap is undone at most
constexpr float meeting_stiffness = 12;   // times what the nodes weigh with what hangs on them
constexpr float meeting_fall = 20;        // m/s²: what a velocity may change by beside the present one
constexpr int most_cells = 24;            // along an axis

/// Whether what moves from one place to another, as seen from a triangle's first corner, comes by its rim without
/// touching it. The plane across the shortest way to a rim would stop that.
bool passes_by(Vec3f u, Vec3f v, Vec3f normal, Vec3f from, Vec3f to, float apart) {
  const Vec3f share = nearest_share(u, v, to);
  if (length(to - share.y * u - share.z * v) < 0.98f * apart) return false;
  const float before = dot(normal, from), after = dot(normal, to);
  if ((before > 0) == (after > 0)) return true;
  const Vec3f through = from + (before / (before - after)) * (to - from), foot = nearest_share(u, v, through);
  return length(through - foot.y * u - foot.z * v) > 1e-3f * apart;
}

}  // namespace

/// The faces within a box, and the cells of it that they reach.
void SoftMeeting::lay_faces(const SoftThing& b, Vec3d origin, Vec3f low, Vec3f high, float reach) {
  faces_.clear();
  const std::span<const std::uint32_t> corners = b.faces();
  const Vec3f margin{reach, reach, reach};
  const auto bounds_of = [&](const Face& face, Vec3f& from, Vec3f& to) {
    const Vec3f p = face.a + face.u, q = face.a + face.v;
    from = min(face.a, min(p, q)) - margin;
    to = max(face.a, max(p, q)) + margin;
  };
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    if (!b.folded.empty() && b.folded[k / 3] != 0) continue;  // nothing tells its side
    Face face;
    Vec3f at[3];
    for (std::size_t c = 0; c < 3; ++c) {
      face.corner[c] = corners[k + c];
      at[c] = Vec3f(b.position[corners[k + c]] - origin);
    }
    face.a = at[0];
    face.u = at[1] - at[0];
    face.v = at[2] - at[0];
    Vec3f from, to;
    bounds_of(face, from, to);
    if (from.x > high.x || from.y > high.y || from.z > high.z || to.x < low.x || to.y < low.y || to.z < low.z) continue;
    const Vec3f n = cross(face.u, face.v);
    const float twice = length(n);
    if (!(twice > 1e-12f)) continue;
    face.normal = n / twice;
    faces_.push_back(face);
  }
  const Vec3f extent = high - low;
  const float cell =
      math::max(math::max(b.mean_edge, reach), math::max(extent.x, math::max(extent.y, extent.z)) / float(most_cells));
  grid_.low = low;
  grid_.inverse = 1 / cell;
  for (int k = 0; k < 3; ++k) grid_.count[k] = math::clamp(int(extent[k] * grid_.inverse) + 1, 1, most_cells + 1);
  const std::size_t cells = std::size_t(grid_.count[0]) * std::size_t(grid_.count[1]) * std::size_t(grid_.count[2]);
  first_.assign(cells + 1, 0);
  const auto each_cell = [&](const Face& face, const auto& see) {
    Vec3f from, to;
    bounds_of(face, from, to);
    int begin[3], end[3];
    for (int k = 0; k < 3; ++k) {
      const float top = float(grid_.count[k] - 1);
      begin[k] = int(math::clamp((from[k] - low[k]) * grid_.inverse, 0.0f, top));
      end[k] = int(math::clamp((to[k] - low[k]) * grid_.inverse, 0.0f, top));
    }
    for (int z = begin[2]; z <= end[2]; ++z)
      for (int y = begin[1]; y <= end[1]; ++y)
        for (int x = begin[0]; x <= end[0]; ++x) {
          const int cell = (z * grid_.count[1] + y) * grid_.count[0] + x;
          see(std::size_t(cell));
        }
  };
  for (const Face& face : faces_) each_cell(face, [&](std::size_t c) { ++first_[c + 1]; });
  for (std::size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
  list_.resize(std::size_t(first_[cells]));
  for (std::size_t f = faces_.size(); f-- > 0;)
    each_cell(faces_[f], [&](std::size_t c) { list_[std::size_t(--first_[c + 1])] = int(f); });
  // Each cell's end has moved to its beginning.
  for (std::size_t c = 0; c < cells; ++c) first_[c] = first_[c + 1];
  first_[cells] = int(list_.size());
}

/// The nearest face. Of those that are equally near, at an edge or a corner, the one that the point stands out from
/// most tells the side.
void SoftMeeting::find_near(Vec3f at, float reach, Near& near) const {
  near.face = -1;
  std::size_t cell = 0;
  for (int k = 3; k-- > 0;) {
    const float place = (at[k] - grid_.low[k]) * grid_.inverse;
    if (!(place >= 0) || place >= float(grid_.count[k])) return;
    cell = cell * std::size_t(grid_.count[k]) + std::size_t(place);
  }
  for (int k = first_[cell]; k < first_[cell + 1]; ++k) {
    const Face& face = faces_[std::size_t(list_[std::size_t(k)])];
    const Vec3f from = at - face.a;
    const float height = dot(face.normal, from);
    if (math::abs(height) > reach) continue;
    const Vec3f share = nearest_share(face.u, face.v, from), way = from - share.y * face.u - share.z * face.v;
    const float distance = length(way);
    if (distance > reach) continue;
    if (near.face >= 0) {
      const float same = 1e-5f * (distance + near.distance);
      if (distance > near.distance + same) continue;
      if (distance > near.distance - same && math::abs(height) <= math::abs(near.height)) continue;
    }
    near = {distance, height, list_[std::size_t(k)], share, way};
  }
}

void SoftMeeting::find_normals(std::size_t thing) {
  std::vector<Vec3f>& normals = normals_[thing];
  if (!normals.empty()) return;
  const SoftThing& t = *things_[thing];
  normals.assign(t.position.size(), Vec3f{});
  const std::span<const std::uint32_t> c = t.faces();
  for (std::size_t k = 0; k + 2 < c.size(); k += 3) {
    const Vec3f n =
        cross(Vec3f(t.position[c[k + 1]] - t.position[c[k]]), Vec3f(t.position[c[k + 2]] - t.position[c[k]]));
    for (std::size_t j = 0; j < 3; ++j) normals[c[k + j]] += n;
  }
}

/// Vertices of a before faces of b.
void SoftMeeting::find_pair(std::size_t a, std::size_t b, float h) {
  SoftThing &one = *things_[a], &other = *things_[b];
  const float apart = float(math::max(one.apart, other.apart));
  // So deep a vertex may be in a solid; through a sheet only by its thickness, for beyond that nothing tells the side.
  const float deep = other.closed ? other.mean_edge : 2 * apart;
  const Vec3f mean = mean_[b];
  const float spread = spread_[b] + meeting_fall * h;
  const float fastest = length(mean_[a] - mean) + spread_[a] + spread;
  const float reach = math::max(deep, apart + 2 * h * fastest);
  const Vec3d origin = other.position[0];
  const geometry::Bounds3d both{max(bounds_[a].low, bounds_[b].low), min(bounds_[a].high, bounds_[b].high)};
  const Vec3d margin{double(reach), double(reach), double(reach)};
  const Vec3d from = both.low - margin, to = both.high + margin;
  if (!(from.x <= to.x && from.y <= to.y && from.z <= to.z)) return;
  lay_faces(other, origin, Vec3f(from - origin), Vec3f(to - origin), reach);
  if (faces_.empty()) return;
  if (one.closed) find_normals(a);

  const double friction = math::sqrt(one.friction * other.friction);
  const int number = numbers_[b];
  auto old = one.met.begin();
  for (std::size_t i = 0; i < one.position.size(); ++i) {
    if (!one.outside.empty() && one.outside[i] == 0) continue;
    const Vec3d p = one.position[i];
    if (p.x < from.x || p.y < from.y || p.z < from.z || p.x > to.x || p.y > to.y || p.z > to.z) continue;
    const float margin_of = apart + 2 * h * (length(one.velocity[i] - mean) + spread);
    Near near;
    find_near(Vec3f(p - origin), math::max(deep, margin_of), near);
    if (near.face < 0) continue;
    const Face& face = faces_[std::size_t(near.face)];
    while (old != one.met.end() && (old->other < number || (old->other == number && old->vertex < i))) ++old;
    const SoftMeetingMemory* before =
        old != one.met.end() && old->other == number && old->vertex == i ? &*old : nullptr;
    // Which side it belongs on: outside of what is closed; of a sheet, where its own outside looks, or where it was.
    float side = near.height >= 0 ? 1.0f : -1.0f;
    bool through = other.closed && side < 0;
    // Into a thin place of a solid it came through the face that it looks at, which need not be the nearest.
    if (through && one.closed && dot(normals_[a][i], face.normal) > 0) continue;
    if (!other.closed) {
      const float looks = one.closed ? -dot(normals_[a][i], face.normal)
                                     : (before != nullptr ? dot(before->normal, face.normal) : side);
      through = looks * side < 0;
    }
    if (near.distance > (through ? deep : margin_of)) continue;
    SoftMeet meet;
    meet.thing[0] = int(a);
    meet.thing[1] = int(b);
    meet.vertex = std::uint32_t(i);
    std::copy(face.corner, face.corner + 3, meet.corner);
    meet.share = near.share;
    const Vec3f out = near.distance > 0.01f * apart ? near.way / near.distance : side * face.normal;
    meet.normal = through ? -out : out;
    meet.apart = apart;
    meet.gap = (through ? -near.distance : near.distance) - apart;
    const Vec3f against = one.velocity[i] - near.share.x * other.velocity[face.corner[0]] -
                          near.share.y * other.velocity[face.corner[1]] - near.share.z * other.velocity[face.corner[2]];
    const bool rim = math::min(near.share.x, math::min(near.share.y, near.share.z)) < 1e-4f;
    const Vec3f seen = Vec3f(p - origin) - face.a;
    if (rim && meet.gap > 0 && passes_by(face.u, face.v, face.normal, seen, seen + h * against, apart)) continue;
    meet.before = dot(meet.normal, against);
    meet.wanted = meet.gap >= 0 ? -meet.gap / h : math::min(-0.2f * meet.gap / h, meeting_recovery);
    const auto weigh = [&](const SoftThing& thing, std::uint32_t k) {
      const SoftBlock& block = thing.matrix.blocks[std::size_t(thing.matrix.diagonal(int(k)))];
      const Mat3f own = thing.solver.diagonal[k] + block.matrix();
      return 1 / dot(meet.normal, own * meet.normal);
    };
    float lightness = weigh(one, meet.vertex);
    for (int k = 0; k < 3; ++k) lightness += math::square(meet.share[k]) * weigh(other, meet.corner[k]);
    meet.stiff = meeting_stiffness / lightness;
    meet.active = meet.gap < 0 || meet.gap + h * meet.before < 0 || (before != nullptr && before->active);
    if (before != nullptr && before->push > 0) {
      meet.slip = against - meet.before * meet.normal;
      meet.rub = h * float(friction) * before->push;
      meet.grip = meet.rub / math::max(length(meet.slip), soft_slip);
    }
    meets_.push_back(meet);
  }
}

void SoftMeeting::find(std::span<SoftThing* const> things, float h) {
  things_ = things;
  meets_.clear();
  bounds_.resize(things.size());
  mean_.resize(things.size());
  spread_.resize(things.size());
  if (normals_.size() < things.size()) normals_.resize(things.size());
  for (std::size_t k = 0; k < things.size(); ++k) {
    const SoftThing& thing = *things[k];
    geometry::Bounds3d box{thing.position[0], thing.position[0]};
    for (const Vec3d& p : thing.position) box = {min(box.low, p), max(box.high, p)};
    bounds_[k] = box;
    Vec3f mean{};
    for (const Vec3f v : thing.velocity) mean += v;
    mean *= 1 / float(thing.velocity.size());
    float most = 0;
    for (const Vec3f v : thing.velocity) most = math::max(most, length_squared(v - mean));
    mean_[k] = mean;
    spread_[k] = math::sqrt(most);
    normals_[k].clear();
  }
  for (std::size_t a = 0; a < things.size(); ++a)
    for (std::size_t b = 0; b < things.size(); ++b)
      if (a != b && filters_meet(things[a]->filter, things[b]->filter)) find_pair(a, b, h);
}

}  // namespace carom::particles::detail
