#include "apps/command/tessellate.h"

#include <cmath>

namespace carom::command {

using namespace math;
using host::ShapeKind;

namespace {

struct Builder {
  Vec3d position;
  Quatd rotation, local_rotation;
  Vec3d local_position;
  std::uint32_t color;
  double opacity;
  std::vector<Triangle>& out;

  Vec3d place(Vec3d p) const { return position + rotate(rotation, local_position + rotate(local_rotation, p)); }
  Vec3d turn(Vec3d n) const { return rotate(rotation, rotate(local_rotation, n)); }
  void triangle(Vec3d a, Vec3d b, Vec3d c, Vec3d na, Vec3d nb, Vec3d nc) {
    out.push_back({{place(a), place(b), place(c)}, {turn(na), turn(nb), turn(nc)}, color, opacity});
  }
  void flat(Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d n = normalize(cross(b - a, c - a));
    triangle(a, b, c, n, n, n);
  }
  void quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
    flat(a, b, c);
    flat(a, c, d);
  }

  /// A surface of revolution about y from rings (radius, height, normal's radial and axial part).
  struct Ring {
    double radius, height, radial, axial;
  };
  void revolve(const std::vector<Ring>& rings, int segments) {
    for (int i = 0; i < segments; ++i) {
      const double a = 2 * pi * i / segments, b = 2 * pi * (i + 1) / segments;
      const Vec3d u{std::cos(a), 0, std::sin(a)}, v{std::cos(b), 0, std::sin(b)};
      for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
        const Ring &low = rings[k], &high = rings[k + 1];
        const auto point = [](const Ring& r, Vec3d d) { return d * r.radius + Vec3d{0, r.height, 0}; };
        const auto normal = [](const Ring& r, Vec3d d) { return d * r.radial + Vec3d{0, r.axial, 0}; };
        if (low.radius > 0)
          triangle(point(low, u), point(high, u), point(low, v), normal(low, u), normal(high, u), normal(low, v));
        if (high.radius > 0)
          triangle(point(low, v), point(high, u), point(high, v), normal(low, v), normal(high, u), normal(high, v));
      }
    }
  }
};

void box(Builder& b, Vec3d h) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3d n{}, u{}, v{};
      n[axis] = side * h[axis];
      u[(axis + 1) % 3] = h[(axis + 1) % 3];
      v[(axis + 2) % 3] = side * h[(axis + 2) % 3];
      b.quad(n - u - v, n + u - v, n + u + v, n - u + v);
    }
  }
}

}  // namespace

void tessellate(const host::ShapeView& shape, const host::MeshLibrary& meshes, const Vec3d& position,
                const Quatf& rotation, std::uint32_t color, int detail, std::vector<Triangle>& out) {
  double opacity = shape.sensor ? 0.25 : 1;
  if (shape.look) {
    color = shape.look & 0xffffff;
    opacity = double(shape.look >> 24) / 255;
  }
  Builder b{position, Quatd(rotation), Quatd(shape.local.q), Vec3d(shape.local.p), color, opacity, out};
  const double r = shape.radius, h = shape.size.y;
  std::vector<Builder::Ring> rings;
  switch (shape.kind) {
    case ShapeKind::sphere:
    case ShapeKind::capsule: {
      const double half = shape.kind == ShapeKind::capsule ? h : 0;
      const int steps = detail / 2;
      for (int i = 0; i <= steps; ++i) {
        const double a = -pi / 2 + pi * i / steps;
        const double c = i == 0 || i == steps ? 0 : std::cos(a);
        const double shift = 2 * i < steps ? -half : half;
        if (2 * i == steps && half > 0) rings.push_back({r, -half, 1, 0});
        rings.push_back({r * c, shift + r * std::sin(a), c, std::sin(a)});
      }
      b.revolve(rings, detail);
      break;
    }
    case ShapeKind::ellipsoid: {
      const int stacks = detail / 2;
      const auto unit = [&](int i, int k) {
        const double a = 2 * pi * i / detail, b = -pi / 2 + pi * k / stacks, c = k % stacks == 0 ? 0 : std::cos(b);
        return Vec3d{c * std::cos(a), std::sin(b), c * std::sin(a)};
      };
      const Vec3d size(shape.size);
      const auto corner = [&](Vec3d u) { return scale(u, size); };
      const auto normal = [&](Vec3d u) { return normalize(Vec3d{u.x / size.x, u.y / size.y, u.z / size.z}); };
      for (int i = 0; i < detail; ++i)
        for (int k = 0; k < stacks; ++k) {
          const Vec3d p = unit(i, k), q = unit(i + 1, k), s = unit(i, k + 1), t = unit(i + 1, k + 1);
          if (k > 0) b.triangle(corner(p), corner(s), corner(q), normal(p), normal(s), normal(q));
          if (k + 1 < stacks) b.triangle(corner(q), corner(s), corner(t), normal(q), normal(s), normal(t));
        }
      break;
    }
    case ShapeKind::box:
      box(b, Vec3d(shape.size) + Vec3d{r, r, r});
      break;
    case ShapeKind::cylinder:
      if (const double e = double(shape.size.x); e > 0) {
        std::vector<Builder::Ring> rings{{0, -h - e, 0, -1}};
        const int steps = detail / 4;
        for (int i = 0; i <= 2 * steps + 1; ++i) {
          const double a = -pi / 2 + pi / 2 * (i <= steps ? i : i - 1) / steps, c = std::cos(a), up = std::sin(a);
          rings.push_back({r + e * c, (i <= steps ? -h : h) + e * up, c, up});
        }
        rings.push_back({0, h + e, 0, 1});
        b.revolve(rings, detail);
        break;
      }
      b.revolve({{r, -h, 1, 0}, {r, h, 1, 0}}, detail);
      b.revolve({{0, -h, 0, -1}, {r, -h, 0, -1}}, detail);
      b.revolve({{r, h, 0, 1}, {0, h, 0, 1}}, detail);
      break;
    case ShapeKind::cone: {
      if (const double e = double(shape.size.x); e > 0) {
        const int steps = detail / 4;
        const double side = std::atan2(r, 2 * h);  // where its normal points
        rings.push_back({0, -h - e, 0, -1});
        for (int i = 0; i <= 2 * steps; ++i) {
          const double a = -pi / 2 + (side + pi / 2) * i / (2 * steps), c = std::cos(a), up = std::sin(a);
          rings.push_back({r + e * c, -h + e * up, c, up});
        }
        for (int i = 0; i < steps; ++i) {
          const double a = side + (pi / 2 - side) * i / steps, c = std::cos(a), up = std::sin(a);
          rings.push_back({e * c, h + e * up, c, up});
        }
        rings.push_back({0, h + e, 0, 1});
        b.revolve(rings, detail);
        break;
      }
      const double slope = r / std::sqrt(r * r + 4 * h * h), across = 2 * h / std::sqrt(r * r + 4 * h * h);
      b.revolve({{r, -h, across, slope}, {0, h, across, slope}}, detail);
      b.revolve({{0, -h, 0, -1}, {r, -h, 0, -1}}, detail);
      break;
    }
    case ShapeKind::mesh: {
      if (shape.mesh >= meshes.meshes().size()) break;
      const host::Mesh& mesh = meshes.meshes()[shape.mesh];
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        b.flat(Vec3d(mesh.vertices[mesh.indices[i]]), Vec3d(mesh.vertices[mesh.indices[i + 1]]),
               Vec3d(mesh.vertices[mesh.indices[i + 2]]));
      break;
    }
    case ShapeKind::plane:  // drawn as the ground
    case ShapeKind::circle:
    case ShapeKind::polygon:
    case ShapeKind::segment:
    case ShapeKind::chain:
      break;
  }
}

void tessellate(const host::Points& points, std::vector<Triangle>& out) {
  constexpr Vec3d axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  constexpr int faces[8][3] = {{0, 2, 4}, {4, 2, 1}, {1, 2, 5}, {5, 2, 0}, {4, 3, 0}, {1, 3, 4}, {5, 3, 1}, {0, 3, 5}};
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3d center(points.positions[i]);
    for (const auto& face : faces) {
      Triangle t;
      for (int k = 0; k < 3; ++k) {
        t.normal[k] = axes[face[k]];
        t.corner[k] = center + double(points.radii[i]) * axes[face[k]];
      }
      t.color = points.rgbas[i] >> 8;
      t.opacity = double(points.rgbas[i] & 255) / 255;
      out.push_back(t);
    }
  }
}

void tessellate(const host::Surface& surface, std::vector<Triangle>& out) {
  std::vector<Vec3d> normals(surface.corners.size());
  const auto corner = [&](std::size_t i) { return Vec3d(surface.corners[surface.triangles[i]]); };
  for (std::size_t i = 0; i + 2 < surface.triangles.size(); i += 3) {
    const Vec3d n = cross(corner(i + 1) - corner(i), corner(i + 2) - corner(i));
    for (std::size_t k = 0; k < 3; ++k) normals[surface.triangles[i + k]] += n;
  }
  for (Vec3d& n : normals) n = length(n) > 0 ? n / length(n) : Vec3d{0, 1, 0};
  for (std::size_t i = 0; i + 2 < surface.triangles.size(); i += 3) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t.corner[k] = corner(i + k), t.normal[k] = normals[surface.triangles[i + k]];
    t.color = surface.rgba >> 8;
    t.opacity = double(surface.rgba & 255) / 255;
    t.two_sided = true;
    out.push_back(t);
  }
}

}  // namespace carom::command
