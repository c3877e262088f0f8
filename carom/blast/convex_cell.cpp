#include "carom/blast/convex_cell.h"

#include "carom/blast/detail/cell_cutter.h"
#include "carom/blast/detail/solid_sum.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using math::Vec3d;
using math::Vec3f;

namespace {
constexpr std::uint16_t no_vertex = 0xffff;
}  // namespace

ConvexCell::ConvexCell(const geometry::Bounds3d& box) {
  const Vec3d l = box.low, h = box.high;
  vertices_ = {{l.x, l.y, l.z}, {h.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z},
               {l.x, l.y, h.z}, {h.x, l.y, h.z}, {l.x, h.y, h.z}, {h.x, h.y, h.z}};
  loops_ = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
  faces_ = {{{-1, 0, 0}, -l.x, -1, 0, 4}, {{1, 0, 0}, h.x, -2, 4, 4},    {{0, -1, 0}, -l.y, -3, 8, 4},
            {{0, 1, 0}, h.y, -4, 12, 4},  {{0, 0, -1}, -l.z, -5, 16, 4}, {{0, 0, 1}, h.z, -6, 20, 4}};
  set_tolerance();
}

ConvexCell::ConvexCell(const geometry::Hull& hull) {
  for (const Vec3f& v : hull.vertices) vertices_.push_back(Vec3d(v));
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    Face face;
    face.tag = -1 - int(f);
    face.first = std::uint32_t(loops_.size());
    face.count = hull.faces[f].edge_count;
    std::uint16_t e = hull.faces[f].first_edge;
    for (std::uint32_t k = 0; k < face.count; ++k) {
      loops_.push_back(hull.edges[e].origin);
      e = hull.edges[e].next;
    }
    // Newell's normal in double: what the float plane lost would show in sums of volumes.
    const Vec3d o = vertices_[loops_[face.first]];
    Vec3d normal{};
    double mean = 0;
    for (std::uint32_t k = 1; k + 1 < face.count; ++k)
      normal += cross(vertices_[loops_[face.first + k]] - o, vertices_[loops_[face.first + k + 1]] - o);
    face.normal = normalize(normal);
    for (std::uint32_t k = 0; k < face.count; ++k) mean += dot(face.normal, vertices_[loops_[face.first + k]]);
    face.offset = mean / face.count;
    faces_.push_back(face);
  }
  set_tolerance();
}

ConvexCell::ConvexCell(std::span<const HalfSpace> half_spaces, const geometry::Bounds3d& bounds) : ConvexCell(bounds) {
  Scratch scratch;
  for (const HalfSpace& h : half_spaces)
    if (clip(h, scratch) == Cut::all) return;
}

void ConvexCell::set_tolerance() {
  double size = 0;
  for (const Vec3d& v : vertices_)
    size = math::max(size, math::max(math::abs(v.x), math::max(math::abs(v.y), math::abs(v.z))));
  tolerance_ = 1e-13 * size;
}

ConvexCell::Cut ConvexCell::clip(const HalfSpace& h, Scratch& s) {
  const std::size_t n = vertices_.size();
  s.distances.resize(n);
  s.outside.resize(n);
  double* const distance = s.distances.data();
  std::uint8_t* const outside = s.outside.data();
  std::size_t outsiders = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = dot(h.normal, vertices_[i]) - h.offset;
    distance[i] = d;
    outside[i] = d > tolerance_;
    outsiders += outside[i];
  }
  if (outsiders == 0) return Cut::none;
  if (outsiders == n) {
    vertices_.clear(), faces_.clear(), loops_.clear(), twins_.clear();
    return Cut::all;
  }
  s.crossings.clear();
  const auto crossing = [&](std::uint16_t in, std::uint16_t out) {
    for (std::size_t k = s.crossings.size(); k-- > 0;)
      if (s.crossings[k].inside == in && s.crossings[k].outside == out) return k;
    s.crossings.push_back({in, out, no_vertex});
    return s.crossings.size() - 1;
  };
  // A face gains at most one corner a crossing of it, and the caps have one a crossing.
  s.loops.resize(2 * loops_.size());
  s.faces.resize(faces_.size() + loops_.size());
  std::uint16_t* write = s.loops.data();
  Face* face_out = s.faces.data();
  for (const Face& face : faces_) {
    const std::uint16_t* const loop = loops_.data() + face.first;
    const std::uint32_t first = std::uint32_t(write - s.loops.data());
    std::uint32_t out_here = 0;
    for (std::uint32_t k = 0; k < face.count; ++k) out_here += outside[loop[k]];
    if (out_here == face.count) continue;
    if (out_here == 0) {
      for (std::uint32_t k = 0; k < face.count; ++k) *write++ = loop[k];
    } else {
      std::uint16_t before = loop[face.count - 1], exit = no_vertex, first_entry = no_vertex;
      for (std::uint32_t k = 0; k < face.count; ++k) {
        const std::uint16_t here = loop[k];
        if (outside[before] != outside[here]) {
          const std::size_t x = outside[here] ? crossing(before, here) : crossing(here, before);
          *write++ = std::uint16_t(n + x);
          // The edge of the cut runs from exit to entry on this face, and back on the cap.
          if (outside[here]) {
            exit = std::uint16_t(x);
          } else if (exit == no_vertex) {
            first_entry = std::uint16_t(x);
          } else {
            s.crossings[x].next = exit;
            exit = no_vertex;
          }
        }
        if (!outside[here]) *write++ = here;
        before = here;
      }
      if (first_entry != no_vertex) s.crossings[first_entry].next = exit;
    }
    *face_out = face;
    face_out->first = first;
    face_out->count = std::uint32_t(write - s.loops.data()) - first;
    ++face_out;
  }
  // One loop, or (where rounding leaves islands outside) a face for each.
  for (std::size_t start = 0; start < s.crossings.size(); ++start) {
    if (s.crossings[start].next == no_vertex) continue;
    const std::uint32_t first = std::uint32_t(write - s.loops.data());
    for (std::size_t at = start; s.crossings[at].next != no_vertex;) {
      *write++ = std::uint16_t(n + at);
      const std::size_t next = s.crossings[at].next;
      s.crossings[at].next = no_vertex;
      at = next;
    }
    *face_out++ = {h.normal, h.offset, h.tag, first, std::uint32_t(write - s.loops.data()) - first};
  }
  // New corners first, then the others close up.
  const std::size_t made = s.crossings.size();
  vertices_.resize(n + made);
  for (std::size_t k = 0; k < made; ++k) {
    const auto& x = s.crossings[k];
    const double a = distance[x.inside], b = distance[x.outside];
    const Vec3d from = vertices_[x.inside];
    vertices_[n + k] = from + math::clamp(a / (a - b), 0.0, 1.0) * (vertices_[x.outside] - from);
  }
  s.remap.resize(n + made);
  std::uint16_t count = 0;
  for (std::size_t i = 0; i < n + made; ++i) {
    s.remap[i] = count;
    vertices_[count] = vertices_[i];
    count = std::uint16_t(count + (i >= n || !outside[i]));
  }
  vertices_.resize(count);
  s.loops.resize(std::size_t(write - s.loops.data()));
  s.faces.resize(std::size_t(face_out - s.faces.data()));
  for (std::uint16_t& v : s.loops) v = s.remap[v];
  loops_.swap(s.loops);
  twins_.clear();
  faces_.swap(s.faces);
  return Cut::part;
}

double ConvexCell::area(const Face& face) const {
  const auto corners = loop(face);
  Vec3d sum{};
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    sum += cross(vertices_[corners[k]] - vertices_[corners[0]], vertices_[corners[k + 1]] - vertices_[corners[0]]);
  return 0.5 * dot(sum, face.normal);
}

Vec3d ConvexCell::centroid(const Face& face) const {
  const auto corners = loop(face);
  const Vec3d o = vertices_[corners[0]];
  Vec3d sum{};
  double area = 0;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec3d a = vertices_[corners[k]] - o, b = vertices_[corners[k + 1]] - o;
    const double part = dot(cross(a, b), face.normal);
    area += part;
    sum += (part / 3) * (a + b);
  }
  return area > 0 ? o + sum / area : o;
}

geometry::MassProperties3 ConvexCell::mass_properties(double density) const {
  if (empty()) return {};
  detail::FanSum sum(vertices_[0]);
  for (const Face& face : faces_)
    sum.add(face.count, [&, corners = loops_.data() + face.first](std::size_t k) { return vertices_[corners[k]]; });
  return sum.properties(density);
}

double ConvexCell::volume() const {
  if (empty()) return 0;
  detail::FanSum sum(vertices_[0]);
  for (const Face& face : faces_)
    sum.add(face.count, [&, corners = loops_.data() + face.first](std::size_t k) { return vertices_[corners[k]]; });
  return sum.volume();
}

bool ConvexCell::take(const detail::CellCutter& cutter) {
  tolerance_ = cutter.tolerance();
  return cutter.store(vertices_, faces_, loops_, twins_);
}

double ConvexCell::reach_squared(Vec3d p) const {
  double reach = 0;
  for (const Vec3d& v : vertices_) reach = math::max(reach, distance_squared(v, p));
  return reach;
}

}  // namespace carom::blast
