#include "carom/blast/fracture2.h"

#include <algorithm>

#include "carom/blast/detail/outline_cut.h"
#include "carom/core/string.h"
#include "carom/geometry/decomposition.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using detail::Corner2;
using detail::cut;
using detail::Outline2;
using math::Vec2d;
using math::Vec2f;

namespace {

geometry::MassProperties2 mass_of(const std::vector<Vec2d>& outline) {
  geometry::MassProperties2 m;
  const Vec2d o = outline[0];
  Vec2d first{};
  double second = 0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    const Vec2d a = outline[i] - o, b = outline[i + 1] - o;
    const double part = 0.5 * cross(a, b);
    m.mass += part;
    first += (part / 3) * (a + b);
    second += part / 6 * (dot(a, a) + dot(a, b) + dot(b, b));
  }
  if (!(m.mass > 0)) return {};
  const Vec2d c = first / m.mass;
  m.center = o + c;
  m.inertia = second - m.mass * length_squared(c);
  return m;
}

/// About the centre, without corners that stand out by less than a millionth of the extent: of a cut that all but ran
/// along a side they would make two triangles of a brick.
std::vector<Vec2f> distinct_corners(const Piece2& piece) {
  std::vector<Vec2d> p;
  double extent = 0;
  for (const Vec2d& v : piece.outline) {
    p.push_back(v - piece.mass.center);
    extent = math::max(extent, length(p.back()));
  }
  const double least = 1e-6 * extent;
  const auto stands_out = [&](std::size_t i) {
    const Vec2d before = p[(i + p.size() - 1) % p.size()], after = p[(i + 1) % p.size()];
    const double base = distance(before, after);
    return distance(before, p[i]) > least && math::abs(cross(after - before, p[i] - before)) > least * base;
  };
  for (std::size_t i = 0, kept = 0; p.size() > 3 && kept < p.size();) {
    if (stands_out(i)) {
      i = (i + 1) % p.size(), ++kept;
      continue;
    }
    p.erase(p.begin() + std::ptrdiff_t(i));
    // Its neighbours are looked at anew.
    i = (i + p.size() - 1) % p.size(), kept = 0;
  }
  return {p.begin(), p.end()};
}

void add_polygons(Piece2& piece, double skin, detail::CutScratch2& scratch) {
  const std::vector<Vec2f> corners = distinct_corners(piece);
  const auto parts = geometry::decompose_convex(corners);
  if (!parts) return;
  std::vector<Vec2d> part;
  for (const geometry::Polygon& polygon : *parts) {
    part.clear();
    for (int i = 0; i < polygon.count; ++i) part.push_back(Vec2d(polygon.vertices[i]));
    const geometry::MassProperties2 mass = mass_of(part);
    if (!(mass.mass > 0)) continue;
    double inner = 1e300;
    const auto normal = [&](std::size_t i) {
      const Vec2d side = part[(i + 1) % part.size()] - part[i];
      return normalize(Vec2d{side.y, -side.x});
    };
    for (std::size_t i = 0; i < part.size(); ++i) inner = math::min(inner, dot(normal(i), part[i] - mass.center));
    if (!(inner > 1e-5)) continue;
    std::vector<Outline2> shrunk(1);
    for (const Vec2d& p : part) shrunk[0].push_back({p, 0});
    const double back = math::min(skin, 0.1 * inner);
    for (std::size_t i = 0; i < part.size() && !shrunk.empty(); ++i)
      cut(shrunk, {normal(i), dot(normal(i), part[i]) - back, 0}, scratch);
    if (shrunk.empty()) continue;
    std::vector<Vec2f> points;
    for (const Corner2& c : shrunk[0]) points.push_back(Vec2f(c.p));
    const auto made = geometry::make_polygon(points);
    if (made.ok()) piece.polygons.push_back(*made);
  }
}

/// Sides on the same cut that lie over each other.
void bond(Fracture2& fracture, const Pattern2& pattern, std::span<const std::uint32_t> first,
          const Pattern2::Meeting& m) {
  const auto& cell = pattern.cells[m.cell_a];
  const auto found = std::find_if(cell.begin(), cell.end(), [&](const HalfPlane& h) { return h.tag == m.tag_a; });
  if (found == cell.end()) return;
  const HalfPlane& h = *found;
  const Vec2d t{-h.normal.y, h.normal.x};
  for (std::uint32_t a = first[m.cell_a]; a < first[m.cell_a + 1]; ++a)
    for (std::uint32_t b = first[m.cell_b]; b < first[m.cell_b + 1]; ++b) {
      Bond2 bond{a, b, 0, {}, h.normal};
      const Piece2 &pa = fracture.pieces[a], &pb = fracture.pieces[b];
      for (std::size_t i = 0; i < pa.outline.size(); ++i)
        for (std::size_t j = 0; j < pb.outline.size() && pa.sources[i] == -1 - m.tag_a; ++j) {
          if (pb.sources[j] != -1 - m.tag_b) continue;
          const Vec2d a0 = pa.outline[i], a1 = pa.outline[(i + 1) % pa.outline.size()];
          const Vec2d b0 = pb.outline[j], b1 = pb.outline[(j + 1) % pb.outline.size()];
          const double low = math::max(dot(t, a0), dot(t, b1)), high = math::min(dot(t, a1), dot(t, b0));
          if (!(high > low)) continue;
          bond.length += high - low;
          bond.center += (high - low) * (h.offset * h.normal + (0.5 * (low + high)) * t);
        }
      if (!(bond.length > 1e-9)) continue;
      bond.center = bond.center / bond.length;
      fracture.bonds.push_back(bond);
    }
}

bool sides_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

}  // namespace

core::Result<Fracture2> fracture_polygon(std::span<const Vec2d> outline, const Pattern2& pattern, double skin) {
  if (outline.size() < 3 || outline.size() > 4096)
    return core::Error{core::text("fracture_polygon: ", outline.size(), " corners, expected 3 to 4096")};
  if (!(skin >= 0 && skin <= 0.1)) return core::Error{core::refused("skin", skin, "0 to 0.1 m")};
  Outline2 whole;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (!is_finite(outline[i])) return core::Error{core::text("fracture_polygon: corner ", i, " is not finite")};
    whole.push_back({outline[i], std::int32_t(i)});
  }
  if (!(detail::area_of(whole) > 0))
    return core::Error{
        core::refused("fracture_polygon: area", detail::area_of(whole), "more than 0 (counterclockwise corners)")};
  for (std::size_t i = 0; i < outline.size(); ++i)
    for (std::size_t j = i + 2; j < outline.size(); ++j)
      if (sides_cross(outline[i], outline[(i + 1) % outline.size()], outline[j], outline[(j + 1) % outline.size()]))
        return core::Error{core::text("fracture_polygon: sides ", i, " and ", j, " cross, expected a simple polygon")};
  Fracture2 fracture;
  std::vector<std::uint32_t> first(pattern.cells.size() + 1, 0);
  detail::CutScratch2 scratch;
  std::vector<Outline2> outlines;
  for (std::uint32_t c = 0; c < pattern.cells.size(); ++c) {
    outlines.assign(1, whole);
    for (const HalfPlane& h : pattern.cells[c]) cut(outlines, h, scratch);
    for (const Outline2& o : outlines) {
      Piece2 piece;
      piece.cell = c;
      for (const Corner2& corner : o) piece.outline.push_back(corner.p), piece.sources.push_back(corner.source);
      piece.mass = mass_of(piece.outline);
      if (!(piece.mass.mass > 0)) continue;
      add_polygons(piece, skin, scratch);
      fracture.pieces.push_back(std::move(piece));
    }
    first[c + 1] = std::uint32_t(fracture.pieces.size());
  }
  for (const Pattern2::Meeting& meeting : pattern.meetings) bond(fracture, pattern, first, meeting);
  return fracture;
}

}  // namespace carom::blast
