// Folds of a cloth that cross: edges that go through triangles, and the shortest way out.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

namespace {

constexpr float fastest_out = 0.5f;  // m/s
constexpr float most_push = 0.2f;    // m/s a sweep: what presses folds into each other harder than that is not held off
constexpr float most_stretch = 1.1f;  // what is drawn out farther is let go: a gale would draw it through itself
constexpr float graze = 1e-4f;        // of an edge's length: an end that lies on a triangle, as the lips of a tear do

/// A triangle's plane, and what goes through it.
struct FoldFace {
  Vec3f origin, u, v, normal;

  FoldFace(Vec3f a, Vec3f b, Vec3f c) : origin(a), u(b - a), v(c - a), normal(cross(u, v)) {}
  float height(Vec3f p) const { return dot(p - origin, normal); }  ///< times twice the area
  /// Whether p q goes through the triangle. `hp`, `hq`: heights of p and q.
  bool pierced(Vec3f p, float hp, Vec3f q, float hq) const {
    if ((hp > 0) == (hq > 0)) return false;
    const Vec3f x = p + (hp / (hp - hq)) * (q - p) - origin;
    const float beta = dot(x, cross(v, normal)), gamma = dot(x, cross(normal, u));
    return beta >= 0 && gamma >= 0 && beta + gamma <= dot(normal, normal);
  }
};

bool before(const ClothCrossing& a, const ClothCrossing& b) {
  if (a.triangle != b.triangle) return a.triangle < b.triangle;
  return a.end[0] != b.end[0] ? a.end[0] < b.end[0] : a.end[1] < b.end[1];
}

}  // namespace

bool ClothState::tangle(std::uint32_t vertex, std::uint32_t triangle) {
  const std::uint32_t* t = &corners[3 * std::size_t(triangle)];
  const auto mark = [&](std::uint32_t p, std::uint32_t q, const std::uint32_t* through) {
    for (const std::uint32_t i : {p, q, through[0], through[1], through[2]}) tangled[i] = 1;
    crossings.push_back({{math::min(p, q), math::max(p, q)}, std::uint32_t(through - corners.data()) / 3});
  };
  const Vec3f at = fold_place(vertex), corner[3] = {fold_place(t[0]), fold_place(t[1]), fold_place(t[2])};
  const FoldFace face(corner[0], corner[1], corner[2]);
  const float height = face.height(at);
  // Nearly always all that the vertex hangs on stands on the same side of the triangle: then nothing crosses.
  bool beside_it = true;
  for (int k = triangle_first[vertex]; beside_it && k < triangle_first[vertex + 1]; ++k) {
    const std::uint32_t own = std::uint32_t(triangle_list[std::size_t(k)]), first = own / 3 * 3;
    for (const std::uint32_t end : {corners[first + (own + 1 - first) % 3], corners[first + (own + 2 - first) % 3]})
      beside_it = beside_it && end != t[0] && end != t[1] && end != t[2] && face.height(fold_place(end)) * height > 0;
  }
  if (beside_it) return false;
  bool any = false;
  for (int k = triangle_first[vertex]; k < triangle_first[vertex + 1]; ++k) {
    const std::uint32_t own = std::uint32_t(triangle_list[std::size_t(k)]), first = own / 3 * 3;
    const std::uint32_t ends[2] = {corners[first + (own + 1 - first) % 3], corners[first + (own + 2 - first) % 3]};
    for (const std::uint32_t end : ends) {
      if (end == t[0] || end == t[1] || end == t[2]) continue;
      if (!face.pierced(at, height, fold_place(end), face.height(fold_place(end)))) continue;
      mark(vertex, end, t);
      any = true;
    }
    const FoldFace beside(at, fold_place(ends[0]), fold_place(ends[1]));
    const float heights[3] = {beside.height(corner[0]), beside.height(corner[1]), beside.height(corner[2])};
    for (int e = 0; e < 3; ++e) {
      const int f = (e + 1) % 3;
      if (t[e] == ends[0] || t[e] == ends[1] || t[f] == ends[0] || t[f] == ends[1]) continue;
      if (!beside.pierced(corner[e], heights[e], corner[f], heights[f])) continue;
      mark(t[e], t[f], &corners[first]);
      any = true;
    }
  }
  return any;
}

// The line in which two surfaces cross begins and ends where an edge goes through a triangle, and becomes shorter where
// that point goes along it. It does so as its edge and its triangle pass each other: the point stays on both of them.
// The passing that shortens it most is the way out, whichever side a fold came from; lines that are closed shrink to
// nothing (Volino and Magnenat-Thalmann, Resolving surface collisions through intersection contour minimization, 2006).
void ClothState::find_ways_out() {
  std::sort(crossings.begin(), crossings.end(), before);
  const auto same = [](const ClothCrossing& a, const ClothCrossing& b) { return !before(a, b) && !before(b, a); };
  crossings.erase(std::unique(crossings.begin(), crossings.end(), same), crossings.end());
  std::erase_if(crossings, [&](ClothCrossing& x) { return !find_way_out(x); });
}

bool ClothState::find_way_out(ClothCrossing& x) const {
  const std::uint32_t *t = &corners[3 * std::size_t(x.triangle)], p = x.end[0], q = x.end[1];
  const FoldFace face(fold_place(t[0]), fold_place(t[1]), fold_place(t[2]));
  const Vec3f edge = fold_place(q) - fold_place(p), normal = face.normal;
  const float from = face.height(fold_place(p)), to = face.height(fold_place(q)), steep = dot(edge, normal);
  x.along = from / (from - to);
  if (!(x.along > graze && x.along < 1 - graze) || drawn_out(x.triangle)) return false;
  const Vec3f at = fold_place(p) + x.along * edge - face.origin;
  const float inverse = 1 / dot(normal, normal), beta = inverse * dot(at, cross(face.v, normal)),
              gamma = inverse * dot(at, cross(normal, face.u));
  x.share = {1 - beta - gamma, beta, gamma};
  Vec3f out{};
  for (int k = triangle_first[p]; k < triangle_first[p + 1]; ++k) {
    const std::uint32_t own = std::uint32_t(triangle_list[std::size_t(k)]), first = own / 3 * 3;
    const std::uint32_t one = corners[first + (own + 1 - first) % 3], two = corners[first + (own + 2 - first) % 3];
    if (one != q && two != q) continue;
    if (drawn_out(own / 3)) return false;
    // Of each face of the edge: the line goes into it from here.
    const Vec3f beside = cross(edge, fold_place(one == q ? two : one) - fold_place(p)), line = cross(normal, beside);
    const float size = dot(line, cross(beside, edge)) > 0 ? length(line) : -length(line);
    if (size == 0) continue;
    const Vec3f into = (1 / size) * line;
    out += math::abs(steep) * into - (steep > 0 ? dot(into, edge) : -dot(into, edge)) * normal;
  }
  const float weight = math::square(1 - x.along) * lightness(p) + math::square(x.along) * lightness(q) +
                       math::square(x.share.x) * lightness(t[0]) + math::square(x.share.y) * lightness(t[1]) +
                       math::square(x.share.z) * lightness(t[2]);
  x.out = (1 / length(out)) * out;
  x.mass = 1 / weight;
  return math::is_finite(x.mass) && math::is_finite(dot(x.out, x.share));
}

bool ClothState::drawn_out(std::uint32_t triangle) const {
  const ClothTriangle& shape = triangles[triangle];
  Vec3f warp{}, weft{};
  for (int k = 0; k < 3; ++k) {
    const Vec3f at = fold_place(corners[3 * std::size_t(triangle) + std::size_t(k)]);
    warp += shape.u[k] * at;
    weft += shape.v[k] * at;
  }
  return !(math::max(length(warp), length(weft)) < most_stretch);
}

void ClothState::push_out(float h, float apart) {
  const float wanted = math::min(apart / h, fastest_out);
  for (const ClothCrossing& x : crossings) {
    const std::uint32_t *t = &corners[3 * std::size_t(x.triangle)], p = x.end[0], q = x.end[1];
    const Vec3f relative = (1 - x.along) * velocity[p] + x.along * velocity[q] - x.share.x * velocity[t[0]] -
                           x.share.y * velocity[t[1]] - x.share.z * velocity[t[2]];
    const float opening = dot(x.out, relative);
    if (opening >= wanted) continue;
    const Vec3f impulse = (math::min(wanted - opening, most_push) * x.mass) * x.out;
    velocity[p] += ((1 - x.along) * lightness(p)) * impulse;
    velocity[q] += (x.along * lightness(q)) * impulse;
    for (int k = 0; k < 3; ++k) velocity[t[k]] -= (x.share[k] * lightness(t[k])) * impulse;
  }
}

}  // namespace carom::particles::detail
