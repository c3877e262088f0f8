#include "carom/forces/buoyancy.h"

#include "carom/math/elementary.h"

namespace carom::forces {
using math::Vec2d;
using math::Vec3d;

namespace detail {

/// Boundary integrals about a point of the water line: what closes the wet part runs along the line and adds nothing.
struct OutlineSum {
  double area = 0;
  Vec2d moment{};

  void add_edge(Vec2d a, Vec2d b) {
    const double twice = math::cross(a, b);
    area += 0.5 * twice;
    moment += (a + b) * (twice / 6);
  }
  /// The arc about u of radius r from angle t0 to t1; with e = (cos θ, sin θ), x × dx = (r u·e + r²) dθ.
  void add_arc(Vec2d u, double r, double t0, double t1) {
    const math::SinCos<double> e0 = math::sincos(t0), e1 = math::sincos(t1);
    const double turn = t1 - t0;
    const Vec2d sum_e{e1.sin - e0.sin, e0.cos - e1.cos};
    const double sin_cos = e1.sin * e1.cos - e0.sin * e0.cos, sin_2 = e1.sin * e1.sin - e0.sin * e0.sin;
    const Vec2d product{0.5 * ((turn + sin_cos) * u.x + sin_2 * u.y), 0.5 * (sin_2 * u.x + (turn - sin_cos) * u.y)};
    area += 0.5 * (r * math::dot(u, sum_e) + r * r * turn);
    moment += (r * math::dot(u, sum_e) * u + r * r * turn * u + r * r * product + r * r * r * sum_e) / 3.0;
  }
};

void add_wet_edge(OutlineSum& sum, Vec2d a, Vec2d b, double depth_a, double depth_b) {
  if (depth_a <= 0 && depth_b <= 0) return;
  if (depth_a < 0)
    a = a + (b - a) * (depth_a / (depth_a - depth_b));
  else if (depth_b < 0)
    b = b + (a - b) * (depth_b / (depth_b - depth_a));
  sum.add_edge(a, b);
}

/// Wet is where cos(θ − θ_normal) < depth/r.
void add_wet_arc(OutlineSum& sum, Vec2d u, double r, double start, double turn, double normal_angle, double depth) {
  if (depth <= -r) return;
  if (depth >= r) return sum.add_arc(u, r, start, start + turn);
  const double dry = math::acos(depth / r), full = 2 * math::pi;
  double phi = start - normal_angle;
  phi -= full * math::floor(phi / full);
  const double shift = start - phi;
  for (int lap = 0; lap < 2; ++lap) {
    const double from = math::max(phi, lap * full + dry), to = math::min(phi + turn, (lap + 1) * full - dry);
    if (to > from) sum.add_arc(u, r, from + shift, to + shift);
  }
}

}  // namespace detail

Submerged2 submerged(std::span<const Vec2d> polygon, double radius, const WaterLine& water) {
  const std::size_t n = polygon.size();
  if (n == 0) return {};
  double shallowest = 1e300, deepest = -1e300;
  for (const Vec2d p : polygon) {
    const double depth = water.offset - math::dot(water.normal, p);
    shallowest = math::min(shallowest, depth);
    deepest = math::max(deepest, depth);
  }
  if (deepest <= -radius) return {};
  // All under water: no closing edge, so that the reference may stay close to the body.
  const bool whole = shallowest >= radius;
  const Vec2d first = polygon[0];
  const double first_depth = water.offset - math::dot(water.normal, first);
  const Vec2d reference = whole ? first : first + water.normal * first_depth;
  const double normal_angle = math::atan2(water.normal.y, water.normal.x);

  detail::OutlineSum sum;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2d here = polygon[i], next = polygon[(i + 1) % n], before = polygon[(i + n - 1) % n];
    const Vec2d edge = next - here, incoming = here - before;
    if (radius > 0) {
      const double depth = water.offset - math::dot(water.normal, here);
      const double start = n == 1 ? 0 : math::atan2(-incoming.x, incoming.y);  // of the incoming edge's normal
      const double turn =
          n == 1 ? 2 * math::pi
                 : (n == 2 ? math::pi : math::atan2(math::cross(incoming, edge), math::dot(incoming, edge)));
      if (turn > 0) detail::add_wet_arc(sum, here - reference, radius, start, turn, normal_angle, depth);
    }
    if (n == 1) break;
    const Vec2d out = math::normalize(Vec2d{edge.y, -edge.x}) * radius;
    const Vec2d a = here + out, b = next + out;
    detail::add_wet_edge(sum, a - reference, b - reference, water.offset - math::dot(water.normal, a),
                         water.offset - math::dot(water.normal, b));
  }
  if (!(sum.area > 0)) return {};
  return {sum.area, reference + sum.moment / sum.area};
}

Submerged3 submerged_sphere(Vec3d center, double radius, const WaterPlane& water) {
  const double depth = water.offset - math::dot(water.normal, center);
  const double h = math::clamp(radius + depth, 0.0, 2 * radius);
  const double volume = spherical_cap_volume(radius, h);
  if (!(volume > 0)) return {};
  const double below = 3 * math::square(2 * radius - h) / (4 * (3 * radius - h));
  return {volume, center - water.normal * below};
}

namespace detail {

/// Vertical columns between the wetted surface and the water's surface: ∫ d (−n·up) dA, with its first moments.
struct ColumnSum {
  Vec3d up;
  double volume = 0;
  Vec3d moment{};

  void add(Vec3d a, Vec3d b, Vec3d c, double da, double db, double dc) {
    const double area = -0.5 * math::dot(math::cross(b - a, c - a), up);  // seen along up, positive from below
    const double d = da + db + dc;
    volume += area * d / 3;
    const Vec3d positions = (a + b + c) * d + a * da + b * db + c * dc;
    moment += area / 12 * (positions + 0.5 * (d * d + da * da + db * db + dc * dc) * up);
  }

  void add_clipped(const Vec3d* p, const double* d) {
    const int wet = (d[0] > 0) + (d[1] > 0) + (d[2] > 0);
    if (wet == 0) return;
    if (wet == 3) return add(p[0], p[1], p[2], d[0], d[1], d[2]);
    // Turn the odd corner to the front: the wet one of one, or the dry one of two.
    int i = 0;
    while ((d[i] > 0) != (wet == 1)) ++i;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Vec3d ij = p[i] + (p[j] - p[i]) * (d[i] / (d[i] - d[j]));
    const Vec3d ik = p[i] + (p[k] - p[i]) * (d[i] / (d[i] - d[k]));
    if (wet == 1) return add(p[i], ij, ik, d[i], 0, 0);
    add(ij, p[j], p[k], 0, d[j], d[k]);
    add(ij, p[k], ik, 0, d[k], 0);
  }
};

template <class DepthOf>
Submerged3 sum_mesh(std::span<const Vec3d> vertices, std::span<const std::uint32_t> indices, Vec3d up,
                    const DepthOf& depth_of) {
  if (vertices.empty()) return {};
  double shallowest = 1e300, deepest = -1e300;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double depth = depth_of(i);
    shallowest = math::min(shallowest, depth);
    deepest = math::max(deepest, depth);
  }
  if (deepest <= 0) return {};
  const double shift = shallowest > 0 ? shallowest : 0;
  const Vec3d origin = vertices[0];
  detail::ColumnSum sum{up};
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Vec3d corners[3] = {vertices[indices[i]] - origin, vertices[indices[i + 1]] - origin,
                              vertices[indices[i + 2]] - origin};
    const double depths[3] = {depth_of(indices[i]) - shift, depth_of(indices[i + 1]) - shift,
                              depth_of(indices[i + 2]) - shift};
    sum.add_clipped(corners, depths);
  }
  if (!(sum.volume > 0)) return {};
  return {sum.volume, origin + sum.moment / sum.volume};
}

}  // namespace detail

Submerged3 submerged_mesh(std::span<const Vec3d> vertices, std::span<const std::uint32_t> indices,
                          const WaterPlane& water) {
  // Of a body wholly under water the depth does not matter: leaving it out keeps the digits.
  double highest = -1e300;
  for (const Vec3d v : vertices) highest = math::max(highest, math::dot(water.normal, v));
  const double level = math::min(water.offset, highest);
  return detail::sum_mesh(vertices, indices, water.normal,
                          [&](std::size_t i) { return level - math::dot(water.normal, vertices[i]); });
}

Submerged3 submerged_mesh(std::span<const Vec3d> vertices, std::span<const std::uint32_t> indices,
                          std::span<const double> depths, Vec3d up) {
  if (depths.size() != vertices.size()) return {};
  return detail::sum_mesh(vertices, indices, up, [&](std::size_t i) { return depths[i]; });
}

Submerged3 submerged_box(Vec3d h, const WaterPlane& water) {
  const Vec3d corners[8] = {{-h.x, -h.y, -h.z}, {h.x, -h.y, -h.z}, {-h.x, h.y, -h.z}, {h.x, h.y, -h.z},
                            {-h.x, -h.y, h.z},  {h.x, -h.y, h.z},  {-h.x, h.y, h.z},  {h.x, h.y, h.z}};
  static constexpr std::uint32_t triangles[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return submerged_mesh(corners, triangles, water);
}

namespace detail {

/// Gauss–Legendre nodes and weights of order 16 on [−1, 1], the positive half.
constexpr double gauss_nodes[8] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                                   0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
constexpr double gauss_weights[8] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                                     0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

/// One stretch of the axis with a squared radius that is quadratic in s: r² = c₀ + c₁ s + c₂ s².
struct AxisStretch {
  double from, to, c0, c1, c2;
  double radius_squared(double s) const { return math::max(0.0, c0 + s * (c1 + s * c2)); }
};

struct SectionSum {
  double volume = 0, along = 0, across = 0;

  /// Section at s, weighted; q is the height of the water above the section's centre.
  void add(double s, double r2, double q, double weight) {
    if (q * q >= r2) {
      if (q <= 0) return;
      volume += weight * math::pi * r2;
      along += weight * math::pi * r2 * s;
      return;
    }
    const double root = math::sqrt(r2 - q * q);
    const double area = r2 * (math::pi - math::atan2(root, q)) + q * root;
    volume += weight * area;
    along += weight * area * s;
    across -= weight * (2.0 / 3) * root * root * root;
  }
};

}  // namespace detail

Submerged3 submerged_revolution(const Revolution& solid, const WaterPlane& water) {
  const Vec3d axis = solid.top - solid.base;
  const double length = math::length(axis);
  const double r0 = solid.base_radius, r1 = solid.top_radius;
  if (!(length > 1e-9 * (r0 + r1))) return solid.round_ends ? submerged_sphere(solid.base, r0, water) : Submerged3{};
  const Vec3d u = axis / length;
  const double along_axis = math::dot(water.normal, u);
  const Vec3d sideways = water.normal - along_axis * u;
  const double tilt = math::max(math::length(sideways), 1e-9);
  const Vec3d w = math::normalize(sideways);
  const double base_depth = water.offset - math::dot(water.normal, solid.base);

  const double k = (r1 - r0) / length;
  detail::AxisStretch stretches[3] = {{0, length, r0 * r0, 2 * r0 * k, k * k}, {}, {}};
  int count = 1;
  if (solid.round_ends) {
    stretches[count++] = {-r0, 0, r0 * r0, 0, -1};
    stretches[count++] = {length, length + r0, r0 * r0 - length * length, 2 * length, -1};
  }
  detail::SectionSum sum;
  for (int i = 0; i < count; ++i) {
    const detail::AxisStretch& stretch = stretches[i];
    // The section turns from dry to partly to wholly wet where (base_depth − a s)² = tilt² r²(s).
    double cuts[4] = {stretch.from, stretch.to, 0, 0};
    int cut_count = 2;
    const double t2 = tilt * tilt;
    const double qa = along_axis * along_axis - t2 * stretch.c2, qb = -2 * base_depth * along_axis - t2 * stretch.c1,
                 qc = base_depth * base_depth - t2 * stretch.c0;
    const double discriminant = qb * qb - 4 * qa * qc;
    if (discriminant >= 0) {
      const double root = math::sqrt(discriminant), q = -0.5 * (qb + (qb < 0 ? -root : root));
      const double candidates[2] = {qa != 0 ? q / qa : stretch.from, q != 0 ? qc / q : stretch.from};
      for (const double s : candidates)
        if (s > stretch.from && s < stretch.to) cuts[cut_count++] = s;
    }
    for (int a = 1; a < cut_count; ++a)
      for (int b = a; b > 0 && cuts[b] < cuts[b - 1]; --b) {
        const double swapped = cuts[b];
        cuts[b] = cuts[b - 1];
        cuts[b - 1] = swapped;
      }
    for (int c = 0; c + 1 < cut_count; ++c) {
      const double middle = 0.5 * (cuts[c] + cuts[c + 1]), half = 0.5 * (cuts[c + 1] - cuts[c]);
      // s = middle + half·sin(π x/2) takes the square roots at both ends out of the integrand.
      for (int node = 0; node < 8; ++node) {
        const math::SinCos<double> x = math::sincos(0.5 * math::pi * detail::gauss_nodes[node]);
        const double weight = detail::gauss_weights[node] * half * 0.5 * math::pi * x.cos;
        for (const double sign : {-1.0, 1.0}) {
          const double s = middle + sign * half * x.sin;
          sum.add(s, stretch.radius_squared(s), (base_depth - along_axis * s) / tilt, weight);
        }
      }
    }
  }
  if (!(sum.volume > 0)) return {};
  return {sum.volume, solid.base + u * (sum.along / sum.volume) + w * (sum.across / sum.volume)};
}

}  // namespace carom::forces
