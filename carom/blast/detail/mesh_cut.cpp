#include "carom/blast/detail/mesh_cut.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast::detail {

using math::Vec3d;

namespace {
constexpr std::uint32_t nowhere = 0xffffffff;

bool before(const Vec3d& a, const Vec3d& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}
}  // namespace

core::Result<CutMesh> closed_mesh(std::span<const Vec3d> vertices, std::span<const std::uint32_t> indices) {
  const auto mass = geometry::mesh_mass_properties(vertices, indices, 1);
  if (!mass.ok()) return core::Error{core::text("fracture_mesh: ", mass.error().message)};
  std::vector<std::uint32_t> order(vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return before(vertices[a], vertices[b]) || (!before(vertices[b], vertices[a]) && a < b);
  });
  CutMesh mesh;
  std::vector<std::uint32_t> one(vertices.size());
  for (const std::uint32_t i : order) {
    if (mesh.vertices.empty() || !(mesh.vertices.back() == vertices[i])) mesh.vertices.push_back(vertices[i]);
    one[i] = std::uint32_t(mesh.vertices.size() - 1);
  }
  std::vector<std::uint64_t> sides;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    const std::uint32_t a = one[indices[t]], b = one[indices[t + 1]], c = one[indices[t + 2]];
    if (a == b || b == c || c == a) continue;
    mesh.triangles.push_back({{a, b, c}, std::int32_t(t / 3)});
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      sides.push_back(std::uint64_t(from) << 32 | to);
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const std::uint64_t twin = sides[i] << 32 | sides[i] >> 32;
    if ((i > 0 && sides[i] == sides[i - 1]) || !std::binary_search(sides.begin(), sides.end(), twin)) {
      const Vec3d p = mesh.vertices[sides[i] >> 32];
      return core::Error{core::text("fracture_mesh: the edge at (", p.x, ", ", p.y, ", ", p.z,
                                    ") does not have exactly one triangle on each side, expected a closed manifold "
                                    "surface")};
    }
  }
  return mesh;
}

double volume_of(const CutMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  const Vec3d o = mesh.vertices[0];
  double six = 0;
  for (const CutMesh::Triangle& t : mesh.triangles)
    six += triple(mesh.vertices[t.corner[0]] - o, mesh.vertices[t.corner[1]] - o, mesh.vertices[t.corner[2]] - o);
  return six / 6;
}

void cut_mesh(CutMesh& mesh, const HalfSpace& h, CutScratch& s) {
  const std::size_t n = mesh.vertices.size();
  s.distances.resize(n);
  bool any_in = false, any_out = false;
  for (std::size_t i = 0; i < n; ++i) {
    s.distances[i] = dot(h.normal, mesh.vertices[i]) - h.offset;
    (s.distances[i] > 0 ? any_out : any_in) = true;
  }
  if (!any_out) return;
  if (!any_in) {
    mesh.vertices.clear(), mesh.triangles.clear();
    return;
  }
  const auto out = [&](std::uint32_t v) { return s.distances[v] > 0; };
  s.crossings.clear();
  for (const CutMesh::Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t.corner[k], b = t.corner[(k + 1) % 3];
      if (!out(a) && out(b)) s.crossings.push_back({a, b, 0});  // its twin runs the other way
    }
  std::sort(s.crossings.begin(), s.crossings.end(), [](const auto& a, const auto& b) {
    return a.inside != b.inside ? a.inside < b.inside : a.outside < b.outside;
  });
  for (CutScratch::Crossing& c : s.crossings) {
    const double a = s.distances[c.inside], b = s.distances[c.outside];
    c.vertex = std::uint32_t(mesh.vertices.size());
    const Vec3d from = mesh.vertices[c.inside];
    mesh.vertices.push_back(from + (a / (a - b)) * (mesh.vertices[c.outside] - from));
  }
  const auto crossing = [&](std::uint32_t inside, std::uint32_t outside) {
    return std::lower_bound(s.crossings.begin(), s.crossings.end(), CutScratch::Crossing{inside, outside, 0},
                            [](const auto& a, const auto& b) {
                              return a.inside != b.inside ? a.inside < b.inside : a.outside < b.outside;
                            })
        ->vertex;
  };
  s.next.assign(s.crossings.size(), nowhere);
  s.triangles.clear();
  for (const CutMesh::Triangle& t : mesh.triangles) {
    const int outside = int(out(t.corner[0])) + int(out(t.corner[1])) + int(out(t.corner[2]));
    if (outside == 3) continue;
    if (outside == 0) {
      s.triangles.push_back(t);
      continue;
    }
    // Turned so that corner a is alone on its side.
    int k = 0;
    while (out(t.corner[k]) != (outside == 1)) ++k;
    const std::uint32_t a = t.corner[k], b = t.corner[(k + 1) % 3], c = t.corner[(k + 2) % 3];
    if (outside == 1) {
      const std::uint32_t exit = crossing(c, a), entry = crossing(b, a);
      s.triangles.push_back({{b, c, exit}, t.source});
      s.triangles.push_back({{b, exit, entry}, t.source});
      // On the triangle the cut runs from exit to entry, on its cap back.
      s.next[entry - n] = exit;
    } else {
      const std::uint32_t exit = crossing(a, b), entry = crossing(a, c);
      s.triangles.push_back({{a, exit, entry}, t.source});
      s.next[entry - n] = exit;
    }
  }
  std::vector<std::vector<std::uint32_t>> loops;
  for (std::size_t start = 0; start < s.next.size(); ++start) {
    if (s.next[start] == nowhere) continue;
    std::vector<std::uint32_t> loop;
    for (std::size_t at = start; s.next[at] != nowhere;) {
      loop.push_back(std::uint32_t(n + at));
      const std::size_t next = s.next[at] - n;
      s.next[at] = nowhere;
      at = next;
    }
    loops.push_back(std::move(loop));
  }
  triangulate_loops(mesh.vertices, loops, h.normal, -1 - h.tag, s.triangles);
  s.remap.assign(mesh.vertices.size(), nowhere);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    if (i < n && s.distances[i] > 0) continue;
    s.remap[i] = count;
    mesh.vertices[count++] = mesh.vertices[i];
  }
  mesh.vertices.resize(count);
  for (CutMesh::Triangle& t : s.triangles)
    for (std::uint32_t& v : t.corner) v = s.remap[v];
  mesh.triangles.swap(s.triangles);
}

std::vector<CutMesh> connected_parts(const CutMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const CutMesh::Triangle& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) {
      const std::uint32_t a = root(t.corner[0]), b = root(t.corner[k]);
      if (a != b) parent[math::max(a, b)] = math::min(a, b);
    }
  std::vector<std::uint32_t> part_of(mesh.vertices.size(), nowhere), local(mesh.vertices.size(), nowhere);
  std::vector<CutMesh> parts;
  for (const CutMesh::Triangle& t : mesh.triangles) {
    const std::uint32_t r = root(t.corner[0]);
    if (part_of[r] == nowhere) {
      part_of[r] = std::uint32_t(parts.size());
      parts.emplace_back();
    }
    CutMesh& part = parts[part_of[r]];
    CutMesh::Triangle copy = t;
    for (std::uint32_t& v : copy.corner) {
      if (local[v] == nowhere) {
        local[v] = std::uint32_t(part.vertices.size());
        part.vertices.push_back(mesh.vertices[v]);
      }
      v = local[v];
    }
    part.triangles.push_back(copy);
  }
  if (parts.size() < 2) return parts;
  // Cavities join the smallest part whose bounds hold them.
  struct Box {
    Vec3d low, high;
    double volume;
  };
  std::vector<Box> boxes;
  for (const CutMesh& part : parts) {
    Box b{part.vertices[0], part.vertices[0], volume_of(part)};
    for (const Vec3d& v : part.vertices) b.low = min(b.low, v), b.high = max(b.high, v);
    boxes.push_back(b);
  }
  std::vector<CutMesh> whole;
  std::vector<std::size_t> place(parts.size(), parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (boxes[i].volume >= 0) place[i] = whole.size(), whole.push_back(std::move(parts[i]));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (boxes[i].volume >= 0) continue;
    std::size_t best = parts.size();
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (place[j] == parts.size()) continue;
      const Vec3d below = boxes[i].low - boxes[j].low, above = boxes[j].high - boxes[i].high;
      const bool holds =
          math::min(math::min(below.x, below.y), below.z) >= 0 && math::min(math::min(above.x, above.y), above.z) >= 0;
      if (holds && (best == parts.size() || boxes[j].volume < boxes[best].volume)) best = j;
    }
    if (best == parts.size()) {  // rounding made it: nothing that could hold it
      whole.push_back(std::move(parts[i]));
      continue;
    }
    CutMesh& host = whole[place[best]];
    const std::uint32_t shift = std::uint32_t(host.vertices.size());
    host.vertices.insert(host.vertices.end(), parts[i].vertices.begin(), parts[i].vertices.end());
    for (CutMesh::Triangle t : parts[i].triangles) {
      for (std::uint32_t& v : t.corner) v += shift;
      host.triangles.push_back(t);
    }
  }
  return whole;
}

}  // namespace carom::blast::detail
