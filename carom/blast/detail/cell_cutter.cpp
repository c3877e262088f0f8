#include "carom/blast/detail/cell_cutter.h"

#include "carom/math/elementary.h"

namespace carom::blast::detail {

using math::Vec3d;

bool CellCutter::load(const ConvexCell& cell, const Vec3d& middle) {
  constexpr std::uint8_t none = 255;
  const auto points = cell.vertices();
  const auto faces = cell.faces();
  const std::size_t count = 2 * std::size_t(cell.edge_count());
  // A corner of k edges becomes k − 2 of three, so that there are 2 F − 4.
  if (faces.size() < 4 || 2 * faces.size() - 4 > most_corners || points.size() > most_corners || count > most_edges)
    return false;
  std::array<std::uint8_t, most_edges> from, to, before, left, twin, next_from, name;
  std::array<std::uint8_t, most_corners> first_from;
  first_from.fill(none);
  std::size_t e = 0;
  plane_count_ = unsigned(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const ConvexCell::Face& face = faces[f];
    planes_[f] = {face.normal, face.offset, face.tag};
    const std::size_t first = e;
    for (const std::uint16_t v : cell.loop(face)) {
      from[e] = std::uint8_t(v), left[e] = std::uint8_t(f), twin[e] = none;
      before[e] = std::uint8_t(e - 1);
      if (e > first) to[e - 1] = std::uint8_t(v);
      next_from[e] = first_from[v], first_from[v] = std::uint8_t(e);
      ++e;
    }
    before[first] = std::uint8_t(e - 1), to[e - 1] = from[first];
  }
  for (e = 0; e < count; ++e) {
    if (twin[e] != none) continue;
    std::uint8_t t = first_from[to[e]];
    while (t != none && to[t] != from[e]) t = next_from[t];
    if (t == none) return false;
    twin[e] = t, twin[t] = std::uint8_t(e);
  }
  tolerance_ = cell.tolerance(), middle_ = middle, fits_ = true, made_ = 0, copies_ = 0;
  std::size_t corners = points.size(), edges = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    // The edges round the corner, counterclockwise.
    std::array<std::uint8_t, most_edges> ring;
    std::size_t degree = 0;
    std::uint8_t at = first_from[v];
    if (at == none) return false;
    do ring[degree++] = at, at = twin[before[at]];
    while (at != first_from[v] && degree < count);
    if (degree < 3 || corners + degree - 3 > most_corners) return false;
    edges += degree;
    for (std::size_t k = 0; k + 2 < degree; ++k) {
      const std::size_t here = k == 0 ? v : corners++, h = 4 * here;
      grow(here), put(here, points[v]);
      original_[here] = std::uint8_t(v);
      if (k > 0) copies_ |= std::uint64_t{1} << here;
      face_[h] = left[ring[k]], face_[h + 1] = left[ring[k + 1]], face_[h + 2] = left[ring[degree - 1]];
      name[ring[k + 1]] = std::uint8_t(h + 1);
      if (k == 0) name[ring[0]] = std::uint8_t(h);
      if (k + 3 == degree) {
        name[ring[degree - 1]] = std::uint8_t(h + 2);
      } else {  // an edge of no length to the next of them
        twin_[h + 2] = std::uint8_t(4 * corners), twin_[4 * corners] = std::uint8_t(h + 2);
      }
    }
  }
  if (edges != count) return false;
  for (e = 0; e < count; ++e) twin_[name[e]] = name[twin[e]];
  alive_ = corners == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << corners) - 1;
  return true;
}

bool CellCutter::store(std::vector<Vec3d>& vertices, std::vector<ConvexCell::Face>& faces,
                       std::vector<std::uint16_t>& loops, std::vector<std::uint16_t>& twins) const {
  std::array<std::uint16_t, most_corners> place;
  std::array<std::uint8_t, most_faces> start;  // half-edge of a face
  std::uint64_t used = 0;
  std::size_t count = 0;
  vertices.resize(std::size_t(std::popcount(alive_ & ~copies_)));
  for (std::uint64_t left = alive_; left != 0; left &= left - 1) {
    const std::size_t v = std::size_t(std::countr_zero(left));
    for (std::size_t h = 4 * v; h < 4 * v + 3; ++h)
      used |= std::uint64_t{1} << face_[h], start[face_[h]] = std::uint8_t(h);
    if ((copies_ >> v & 1) != 0) {
      place[v] = place[original_[v]];
      continue;
    }
    place[v] = std::uint16_t(count);
    vertices[count++] = corner(v);
  }
  faces.resize(std::size_t(std::popcount(used)));
  const std::size_t edges = 3 * std::size_t(std::popcount(alive_));
  loops.resize(edges), twins.resize(edges);
  std::array<std::uint16_t, 4 * most_corners> name;  // of half-edges, in the loops
  count = 0;
  for (ConvexCell::Face& face : faces) {
    const std::uint8_t f = std::uint8_t(std::countr_zero(used));
    used &= used - 1;
    const std::size_t first = count;
    std::uint8_t h = start[f];
    do {
      name[h] = std::uint16_t(count);
      twins[count] = twin_[h];
      loops[count++] = place[h >> 2];
      h = next(h);
    } while (h != start[f] && count < edges);
    face = {planes_[f].normal, planes_[f].offset, planes_[f].tag, std::uint32_t(first), std::uint32_t(count - first)};
  }
  if (count != edges) return false;  // rounding made a cut of two loops
  for (std::uint16_t& t : twins) t = name[t];
  if (copies_ == 0) return true;
  // Copies of a corner are one again.
  twins.clear();
  count = 0;
  for (ConvexCell::Face& face : faces) {
    const std::size_t first = count;
    for (std::size_t k = face.first; k < std::size_t(face.first) + face.count; ++k)
      if (count == first || loops[count - 1] != loops[k]) loops[count++] = loops[k];
    while (loops[count - 1] == loops[first]) --count;
    face.first = std::uint32_t(first), face.count = std::uint32_t(count - first);
  }
  loops.resize(count);
  return true;
}

}  // namespace carom::blast::detail
