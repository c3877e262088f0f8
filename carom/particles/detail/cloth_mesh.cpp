// From points and triangles to elements, and tears.
#include <algorithm>
#include <array>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {

double cotangent(Vec3d a, Vec3d b) { return dot(a, b) / math::max(length(cross(a, b)), 1e-30); }

void list_incidences(int vertices, std::span<const std::uint32_t> corners, std::vector<int>& first,
                     std::vector<int>& list) {
  first.assign(std::size_t(vertices) + 1, 0);
  for (const std::uint32_t c : corners) ++first[c + 1];
  for (int i = 0; i < vertices; ++i) first[std::size_t(i) + 1] += first[std::size_t(i)];
  list.resize(corners.size());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (std::size_t k = 0; k < corners.size(); ++k) list[std::size_t(next[corners[k]]++)] = int(k);
}

}  // namespace

core::Status ClothState::set_mesh(std::span<const Vec3d> rest, Vec3d warp) {
  triangles.assign(corners.size() / 3, ClothTriangle{});
  double sum = 0;
  smallest_edge = 1e30f;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3d a = rest[corners[3 * t]], b = rest[corners[3 * t + 1]], c = rest[corners[3 * t + 2]];
    const Vec3d normal = cross(b - a, c - a);
    const double area = 0.5 * length(normal);
    const double longest = math::max(length(b - a), math::max(length(c - b), length(a - c)));
    if (!(area > 1e-6 * longest * longest))
      return core::Error{core::text("triangle ", t, " of ClothDef has an area of ", area, " m², expected three corners apart")};
    const Vec3d n = normal / (2 * area);
    Vec3d u = warp - dot(warp, n) * n;
    u = length(u) > 1e-9 * length(warp) ? normalize(u) : normalize(b - a);
    const Vec3d v = cross(n, u);
    ClothTriangle& triangle = triangles[t];
    triangle.area = float(area);
    // Gradient of a corner's share: the opposite edge, turned by a right angle, over twice the area.
    const Vec3d opposite[3] = {c - b, a - c, b - a};
    for (int k = 0; k < 3; ++k) {
      const Vec3d gradient = cross(n, opposite[k]) / (2 * area);
      triangle.u[k] = float(dot(gradient, u));
      triangle.v[k] = float(dot(gradient, v));
      smallest_edge = math::min(smallest_edge, float(length(opposite[k])));
      sum += length(opposite[k]);
    }
  }
  mean_edge = float(sum / double(corners.size()));
  find_hinges(rest);
  mass.assign(rest.size(), 0.0f);
  connect();
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (mass[i] == 0) return core::Error{core::text("point ", i, " of ClothDef is in no triangle")};
  return {};
}

void ClothState::find_hinges(std::span<const Vec3d> rest) {
  // Edges with the corner across, sorted: equal edges are neighbours.
  struct Edge {
    std::uint32_t a, b, across;
  };
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[3 * t + std::size_t(k)], b = corners[3 * t + std::size_t((k + 1) % 3)];
      edges.push_back({math::min(a, b), math::max(a, b), corners[3 * t + std::size_t((k + 2) % 3)]});
    }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& x, const Edge& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
  hinges.clear();
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    if (edges[k].a != edges[k + 1].a || edges[k].b != edges[k + 1].b) continue;
    ClothHinge hinge;
    const std::uint32_t corner[4] = {edges[k].a, edges[k].b, edges[k].across, edges[k + 1].across};
    const Vec3d x0 = rest[corner[0]], x1 = rest[corner[1]], x2 = rest[corner[2]], x3 = rest[corner[3]];
    const Vec3d e0 = x1 - x0;
    const double c01 = cotangent(e0, x2 - x0), c02 = cotangent(e0, x3 - x0);
    const double c03 = cotangent(-e0, x2 - x1), c04 = cotangent(-e0, x3 - x1);
    const double area = 0.5 * (length(cross(e0, x2 - x0)) + length(cross(e0, x3 - x0)));
    const double scale = math::sqrt(3 / area);
    const double weight[4] = {c03 + c04, c01 + c02, -c01 - c03, -c02 - c04};
    for (int a = 0; a < 4; ++a) {
      hinge.corner[a] = corner[a];
      hinge.weight[a] = float(scale * weight[a]);
    }
    hinges.push_back(hinge);
  }
}

void ClothState::connect() {
  const int n = int(position.size());
  std::vector<std::uint32_t> stencils;
  for (const ClothHinge& hinge : hinges)
    for (const std::uint32_t c : hinge.corner) stencils.push_back(c);
  matrix.build(n, {{corners, 3}, {stencils, 4}});
  list_incidences(n, corners, triangle_first, triangle_list);
  list_incidences(n, stencils, hinge_first, hinge_list);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        triangles[t].slots[3 * a + b] = matrix.slot(corners[3 * t + std::size_t(a)], corners[3 * t + std::size_t(b)]);
  for (ClothHinge& hinge : hinges)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) hinge.slots[4 * a + b] = matrix.slot(hinge.corner[a], hinge.corner[b]);
  mass.assign(std::size_t(n), 0.0f);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int a = 0; a < 3; ++a)
      mass[corners[3 * t + std::size_t(a)]] += float(fabric.mass_per_area / 3) * triangles[t].area;
  velocity.resize(std::size_t(n));
  touches.resize(std::size_t(n));
  pin_of.resize(std::size_t(n), -1);
  solver.resize(std::size_t(n));
}

// The vertex of a triangle above the strength is split along the line across the greatest tension, where that leaves
// triangles on both sides. The new vertex takes over position and velocity; masses follow the triangles, so that mass
// and momentum stay.
void ClothState::tear() {
  torn = false;
  const float strength = float(fabric.tear_tension);
  if (!(strength > 0)) return;
  for (int round = 0; round < 4; ++round) {
    int worst = -1;
    float most = strength;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const float* s = triangles[t].stress;
      const float mean = 0.5f * (s[0] + s[1]), spread = math::sqrt(0.25f * (s[0] - s[1]) * (s[0] - s[1]) + s[2] * s[2]);
      if (mean + spread > most) most = mean + spread, worst = int(t);
    }
    if (worst < 0) return;
    const ClothTriangle& triangle = triangles[std::size_t(worst)];
    const float* s = triangle.stress;
    // Direction of the greatest tension in warp and weft, and as it lies in space.
    const float spread = math::sqrt(0.25f * (s[0] - s[1]) * (s[0] - s[1]) + s[2] * s[2]);
    const float lambda = 0.5f * (s[0] + s[1]) + spread;
    float du = s[2], dv = lambda - s[0];
    if (du * du + dv * dv < 1e-20f) du = s[0] >= s[1] ? 1.0f : 0.0f, dv = 1 - du;
    const Vec3f way = normalize(du * triangle.along + dv * triangle.across);
    bool split = false;
    for (int a = 0; a < 3 && !split; ++a) {
      const std::uint32_t vertex = corners[3 * std::size_t(worst) + std::size_t(a)];
      if (pin_of[vertex] >= 0) continue;
      std::vector<int> beyond;
      const int first = triangle_first[vertex], last = triangle_first[vertex + 1];
      for (int k = first; k < last; ++k) {
        const std::size_t t = std::size_t(triangle_list[std::size_t(k)]) / 3;
        Vec3d middle{};
        for (int c = 0; c < 3; ++c) middle += position[corners[3 * t + std::size_t(c)]] / 3.0;
        if (dot(Vec3f(middle - position[vertex]), way) > 0) beyond.push_back(triangle_list[std::size_t(k)]);
      }
      if (beyond.empty() || int(beyond.size()) == last - first) continue;
      const std::uint32_t fresh = std::uint32_t(position.size());
      for (const int k : beyond) corners[std::size_t(k)] = fresh;
      position.push_back(position[vertex]);
      velocity.push_back(velocity[vertex]);
      touches.push_back(touches[vertex]);
      pin_of.push_back(-1);
      // Hinges stay where both triangles still share the edge.
      const auto side = [&](const ClothHinge& hinge, int across) {
        for (int k = first; k < last; ++k) {
          const std::size_t t = std::size_t(triangle_list[std::size_t(k)]) / 3;
          bool has[3] = {};
          for (int c = 0; c < 3; ++c) {
            std::uint32_t corner = corners[3 * t + std::size_t(c)];
            const bool moved = corner == fresh;
            if (moved) corner = vertex;
            has[0] |= corner == hinge.corner[0];
            has[1] |= corner == hinge.corner[1];
            has[2] |= corner == hinge.corner[across];
          }
          if (!has[0] || !has[1] || !has[2]) continue;
          for (int c = 0; c < 3; ++c)
            if (corners[3 * t + std::size_t(c)] == fresh) return 1;
          return 0;
        }
        return -1;
      };
      std::erase_if(hinges, [&](ClothHinge& hinge) {
        int place = -1;
        for (int c = 0; c < 4; ++c)
          if (hinge.corner[c] == vertex) place = c;
        if (place < 0) return false;
        const int one = side(hinge, 2), other = side(hinge, 3);
        if (place >= 2) {  // the vertex is across the edge: its own triangle says which it is now
          if ((place == 2 ? one : other) == 1) hinge.corner[place] = fresh;
          return false;
        }
        if (one != other) return true;
        if (one == 1) hinge.corner[place] = fresh;
        return false;
      });
      connect();
      torn = split = true;
    }
    if (!split) return;
    // It does not tear on within the step: its stress is told anew by the next.
    triangles[std::size_t(worst)].stress[0] = triangles[std::size_t(worst)].stress[1] =
        triangles[std::size_t(worst)].stress[2] = 0;
  }
}

}  // namespace carom::particles::detail
