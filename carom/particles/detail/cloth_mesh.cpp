// From points and triangles to elements, and tears.
#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {

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
      return core::Error{
          core::text("triangle ", t, " of ClothDef has an area of ", area, " m², expected three corners apart")};
    const Vec3d n = normal / (2 * area);
    Vec3d u = warp - dot(warp, n) * n;
    u = length(u) > 1e-9 * length(warp) ? normalize(u) : normalize(b - a);
    const Vec3d v = cross(n, u);
    ClothTriangle& triangle = triangles[t];
    triangle.area = float(area);
    // Gradient of a corner's share: the opposite edge, turned by a right angle, over twice the area.
    const Vec3d opposite[3] = {c - b, a - c, b - a};
    const Vec3d at[3] = {a, b, c};
    for (int k = 0; k < 3; ++k) {
      triangle.x[k] = float(dot(at[k] - a, u));
      triangle.y[k] = float(dot(at[k] - a, v));
      const Vec3d gradient = cross(n, opposite[k]) / (2 * area);
      triangle.u[k] = float(dot(gradient, u));
      triangle.v[k] = float(dot(gradient, v));
      smallest_edge = math::min(smallest_edge, float(length(opposite[k])));
      sum += length(opposite[k]);
    }
  }
  mean_edge = float(sum / double(corners.size()));
  find_patches();
  mass.assign(rest.size(), 0.0f);
  connect();
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (mass[i] == 0) return core::Error{core::text("point ", i, " of ClothDef is in no triangle")};
  return {};
}

void ClothState::find_patches() {
  patches.clear();
  if (!(fabric.bending_stiffness > 0)) return;
  // Edges with their triangle and the place of the corner across, sorted: equal edges are neighbours.
  struct Edge {
    std::uint32_t a, b;
    int place;
  };
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[3 * t + (k + 1) % 3], b = corners[3 * t + (k + 2) % 3];
      edges.push_back({math::min(a, b), math::max(a, b), int(3 * t + k)});
    }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& x, const Edge& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
  std::vector<int> mate(corners.size(), -1);
  for (std::size_t k = 0; k + 1 < edges.size(); ++k)
    if (edges[k].a == edges[k + 1].a && edges[k].b == edges[k + 1].b) {
      mate[std::size_t(edges[k].place)] = edges[k + 1].place;
      mate[std::size_t(edges[k + 1].place)] = edges[k].place;
      ++k;
    }
  const double warp = math::sqrt(fabric.bending_stiffness), weft = warp;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const ClothTriangle& triangle = triangles[t];
    ClothPatch patch;
    double x[6], y[6];
    int count = 3;
    const double scale = math::sqrt(2 * double(triangle.area));
    for (std::size_t k = 0; k < 3; ++k) {
      patch.corner[k] = corners[3 * t + k];
      x[k] = double(triangle.x[k]);
      y[k] = double(triangle.y[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const int other = mate[3 * t + k];
      if (other < 0) continue;
      // Unfolded into this triangle's plane: by its heights over the shared edge and along it.
      const ClothTriangle& next = triangles[std::size_t(other) / 3];
      const std::size_t o = std::size_t(other) % 3, a = (k + 1) % 3, b = (k + 2) % 3;
      std::size_t na = (o + 1) % 3;
      if (corners[std::size_t(other) / 3 * 3 + na] != patch.corner[a]) na = (o + 2) % 3;
      const std::size_t nb = 3 - o - na;
      const double ex = double(next.x[nb] - next.x[na]), ey = double(next.y[nb] - next.y[na]);
      const double px = double(next.x[o] - next.x[na]), py = double(next.y[o] - next.y[na]);
      const double square = ex * ex + ey * ey, along = (px * ex + py * ey) / square;
      const double height = math::abs(px * ey - py * ex) / math::sqrt(square);
      const double fx = x[b] - x[a], fy = y[b] - y[a], fl = math::sqrt(fx * fx + fy * fy);
      double nx = fy / fl, ny = -fx / fl;  // away from this triangle's own corner
      if (nx * (x[k] - x[a]) + ny * (y[k] - y[a]) > 0) nx = -nx, ny = -ny;
      patch.corner[count] = corners[std::size_t(other)];
      x[count] = x[a] + along * fx + height * nx;
      y[count] = y[a] + along * fy + height * ny;
      ++count;
    }
    // Least squares for 1, x, y, ½x², xy, ½y², with the least curvature where corners are missing.
    double m[6][12] = {};
    double row[6][6];
    for (int p = 0; p < count; ++p) {
      const double u = (x[p] - x[0]) / scale, v = (y[p] - y[0]) / scale;
      const double terms[6] = {1, u, v, 0.5 * u * u, u * v, 0.5 * v * v};
      for (int i = 0; i < 6; ++i) row[p][i] = terms[i];
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) m[i][j] += terms[i] * terms[j];
    }
    for (int i = 0; i < 6; ++i) {
      m[i][6 + i] = 1;
      if (i >= 3) m[i][i] += 1e-7;
    }
    for (int k = 0; k < 6; ++k) {  // positive definite: no pivots
      const double inverse = 1 / m[k][k];
      for (int j = 0; j < 12; ++j) m[k][j] *= inverse;
      for (int i = 0; i < 6; ++i) {
        if (i == k) continue;
        const double f = m[i][k];
        for (int j = 0; j < 12; ++j) m[i][j] -= f * m[k][j];
      }
    }
    const double root = math::sqrt(double(triangle.area)) / (scale * scale);
    // A plate without Poisson's ratio: ½ B (κ_uu² + κ_vv² + 2 κ_uv²) an area.
    const double stiff[3] = {warp * root, weft * root, math::sqrt(2 * warp * weft) * root};
    const int term[3] = {3, 5, 4};
    for (int c = 0; c < 3; ++c)
      for (int p = 0; p < count; ++p) {
        double sum = 0;
        for (int j = 0; j < 6; ++j) sum += m[term[c]][6 + j] * row[p][j];
        patch.weight[c][p] = float(stiff[c] * sum);
      }
    for (int p = count; p < 6; ++p) patch.corner[p] = patch.corner[0];
    patches.push_back(patch);
  }
}

void ClothState::connect() {
  const int n = int(position.size());
  // Bending is quadratic in the positions with constant weights: a number for every pair of a patch's corners.
  std::vector<SoftMatrix::Link> links;
  links.reserve(36 * patches.size());
  for (const ClothPatch& patch : patches)
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b) {
        double value = 0;
        for (const auto& weight : patch.weight) value += double(weight[a]) * double(weight[b]);
        if (value != 0) links.push_back({patch.corner[a], patch.corner[b], float(value)});
      }
  matrix.build(n, corners, 3, links);
  list_incidences(n, corners, triangle_first, triangle_list);
  tile_triangles();
  tile_sides();
  mass.assign(std::size_t(n), 0.0f);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int a = 0; a < 3; ++a)
      mass[corners[3 * t + std::size_t(a)]] += float(fabric.mass_per_area / 3) * triangles[t].area;
  far_share = 0;
  for (int i = 0; i < n; ++i)
    if (mass[std::size_t(i)] > 0) far_share = math::max(far_share, matrix.far_size(i) / mass[std::size_t(i)]);
  velocity.resize(std::size_t(n));
  touches.resize(std::size_t(n));
  pin_of.resize(std::size_t(n), -1);
  solver.resize(matrix);
  if (self_collide) tile_folds();
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
      if (const float tension = strains[t].tension(); tension > most) most = tension, worst = int(t);
    }
    if (worst < 0) return;
    ClothStrain& strain = strains[std::size_t(worst)];
    // Direction of the greatest tension in warp and weft, and as it lies in space.
    float du = strain.shear, dv = strain.tension() - strain.warp;
    if (du * du + dv * dv < 1e-20f) du = strain.warp >= strain.weft ? 1.0f : 0.0f, dv = 1 - du;
    const Vec3f way = normalize(du * strain.image_of_warp() + dv * strain.image_of_weft());
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
      find_patches();
      connect();
      torn = split = true;
    }
    if (!split) return;
    // It does not tear on within the step: its stress is told anew by the next.
    strain.warp = strain.weft = strain.shear = 0;
  }
}

}  // namespace carom::particles::detail
