#include "apps/command/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carom/math/elementary.h"

namespace carom::command {

using namespace math;

namespace {

constexpr int samples = 2;  // a side of each pixel
constexpr int shadow_size = 2048;
const Vec3d sun = normalize(Vec3d{0.45, 0.9, 0.35});

struct View {
  Vec3d eye, right, up, forward;
  double scale = 1;  ///< pixels at distance 1
  int width, height;

  View(const host::Camera& camera, int w, int h) : eye(camera.position), width(w), height(h) {
    forward = normalize(camera.target - camera.position);
    if (length_squared(forward) == 0) forward = {0, 0, -1};
    right = normalize(cross(forward, Vec3d{0, 1, 0}));
    if (length_squared(right) == 0) right = {1, 0, 0};
    up = cross(right, forward);
    scale = 0.5 * h / std::tan(0.5 * std::clamp(camera.field_of_view, 0.05, 3.0));
  }
  Vec3d local(Vec3d p) const {
    const Vec3d d = p - eye;
    return {dot(d, right), dot(d, up), dot(d, forward)};
  }
  Vec2d screen(Vec3d local_point) const {
    return {0.5 * width + scale * local_point.x / local_point.z, 0.5 * height - scale * local_point.y / local_point.z};
  }
  Vec3d ray(double x, double y) const {
    return forward + right * ((x - 0.5 * width) / scale) + up * ((0.5 * height - y) / scale);
  }
};

/// Calls pixel(x, y, weights) for every sample in the triangle; weights are those of the corners on the screen.
template <class F>
void fill(const Vec2d p[3], int width, int height, F&& pixel) {
  const double area = cross(p[1] - p[0], p[2] - p[0]);
  if (!(std::fabs(area) > 1e-9)) return;
  const int x0 = std::max(0, int(std::floor(std::min({p[0].x, p[1].x, p[2].x}))));
  const int x1 = std::min(width - 1, int(std::ceil(std::max({p[0].x, p[1].x, p[2].x}))));
  const int y0 = std::max(0, int(std::floor(std::min({p[0].y, p[1].y, p[2].y}))));
  const int y1 = std::min(height - 1, int(std::ceil(std::max({p[0].y, p[1].y, p[2].y}))));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Vec2d q{x + 0.5, y + 0.5};
      const double a = cross(p[1] - q, p[2] - q) / area, b = cross(p[2] - q, p[0] - q) / area, c = 1 - a - b;
      if (a >= 0 && b >= 0 && c >= 0) pixel(x, y, a, b, c);
    }
  }
}

class ShadowMap {
 public:
  explicit ShadowMap(const RasterScene& scene) : depth_(std::size_t(shadow_size) * shadow_size, -1e30f) {
    u_ = normalize(cross(Vec3d{0, 1, 0}, sun));
    v_ = cross(sun, u_);
    Vec3d low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
    for (const Triangle& t : scene.triangles) {
      if (t.opacity < 1) continue;
      for (const Vec3d& corner : t.corner) {
        // What is far from the eye would only blur the shadows that one sees.
        if (distance(corner, scene.camera.target) > 6 * distance(scene.camera.position, scene.camera.target)) continue;
        const Vec3d p = coordinates(corner);
        low = min(low, p);
        high = max(high, p);
      }
    }
    if (!(low.x < high.x)) return;
    origin_ = low - Vec3d{0.01, 0.01, 0};
    texel_ = std::max({high.x - low.x, high.y - low.y, 1e-6}) * 1.02 / shadow_size;
    for (const Triangle& t : scene.triangles) {
      if (t.opacity < 1) continue;
      Vec2d p[3];
      double z[3];
      for (int i = 0; i < 3; ++i) {
        const Vec3d q = coordinates(t.corner[i]);
        p[i] = {(q.x - origin_.x) / texel_, (q.y - origin_.y) / texel_};
        z[i] = q.z;
      }
      fill(p, shadow_size, shadow_size, [&](int x, int y, double a, double b, double c) {
        float& d = depth_[std::size_t(y) * shadow_size + x];
        d = std::max(d, float(a * z[0] + b * z[1] + c * z[2]));
      });
    }
    ready_ = true;
  }

  /// The lit share of a point, softened over a few texels.
  double lit(Vec3d point, Vec3d normal) const {
    if (!ready_) return 1;
    const Vec3d p = coordinates(point + normal * (3.0 * texel_));
    const double x = (p.x - origin_.x) / texel_, y = (p.y - origin_.y) / texel_;
    double sum = 0;
    for (int j = -2; j <= 2; ++j) {
      for (int i = -2; i <= 2; ++i) {
        const int u = int(std::floor(x)) + i, v = int(std::floor(y)) + j;
        const bool inside = u >= 0 && v >= 0 && u < shadow_size && v < shadow_size;
        if (!inside || depth_[std::size_t(v) * shadow_size + u] <= p.z + 3.0 * texel_) sum += 1;
      }
    }
    return sum / 25;
  }

 private:
  Vec3d coordinates(Vec3d p) const { return {dot(p, u_), dot(p, v_), dot(p, sun)}; }
  std::vector<float> depth_;
  Vec3d u_, v_, origin_{};
  double texel_ = 1;
  bool ready_ = false;
};

/// Linear light from an sRGB colour and back, roughly by a square.
Vec3d linear(std::uint32_t c) {
  const Vec3d s{((c >> 16) & 255) / 255.0, ((c >> 8) & 255) / 255.0, (c & 255) / 255.0};
  return scale(s, s);
}

Vec3d sky(Vec3d direction) {
  const double t = std::clamp(0.5 + 1.4 * normalize(direction).y, 0.0, 1.0);
  return lerp(Vec3d{0.80, 0.83, 0.86}, Vec3d{0.46, 0.60, 0.78}, std::max(0.0, 2 * t - 1));
}

Vec3d shade(Vec3d albedo, Vec3d normal, Vec3d to_eye, double lit) {
  if (dot(normal, to_eye) < 0) normal = -normal;
  const double diffuse = std::max(0.0, dot(normal, sun)) * lit;
  const Vec3d ambient = lerp(Vec3d{0.20, 0.19, 0.18}, Vec3d{0.40, 0.44, 0.50}, 0.5 + 0.5 * normal.y);
  const Vec3d half = normalize(sun + to_eye);
  const double shine = std::max(0.0, dot(normal, half)), shine_2 = shine * shine,
               shine_8 = shine_2 * shine_2 * shine_2 * shine_2;
  const double gloss = shine_8 * shine_8 * shine_8 * shine_8 * shine_8 * 0.18 * lit;
  return scale(albedo, ambient + Vec3d{0.95, 0.91, 0.84} * diffuse) + Vec3d{gloss, gloss, gloss};
}

struct Buffer {
  int width, height;
  std::vector<Vec3f> color;
  std::vector<float> depth;
};

double grid_line(double coordinate, double spacing, double width, double footprint) {
  const double f = std::fabs(coordinate / spacing - std::round(coordinate / spacing)) * spacing;
  const double half = std::max(width, 0.7 * footprint);
  const double cover = std::clamp((half - f) / std::max(footprint, 1e-9) + 0.5, 0.0, 1.0);
  return cover * std::min(1.0, width / half + 0.45) * std::clamp(spacing / (6 * footprint), 0.0, 1.0);
}

void background(const RasterScene& scene, const View& view, const ShadowMap& shadows, Buffer& out) {
  const double reach = distance(scene.camera.position, scene.camera.target);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const Vec3d ray = view.ray(x + 0.5, y + 0.5);
      const std::size_t at = std::size_t(y) * out.width + x;
      Vec3d color = sky(ray);
      float depth = std::numeric_limits<float>::infinity();
      if (scene.ground && ray.y < -1e-6 && view.eye.y > *scene.ground) {
        const double t = (*scene.ground - view.eye.y) / ray.y;
        const Vec3d p = view.eye + ray * t;
        depth = float(t);  // ray·forward is 1
        const double footprint = t / view.scale * std::max(1.0, 0.5 * length(ray) / -ray.y);
        const double fine = scene.grid, coarse = 5 * scene.grid;
        const auto line_of = [&](double spacing, double width) {
          return std::max(grid_line(p.x, spacing, width, footprint), grid_line(p.z, spacing, width, footprint));
        };
        const double line = std::max(0.5 * line_of(fine, 0.010 * fine), line_of(coarse, 0.018 * fine));
        Vec3d albedo = lerp(Vec3d{0.56, 0.57, 0.57}, Vec3d{0.34, 0.36, 0.38}, line);
        const Vec3d lit = shade(albedo, {0, 1, 0}, normalize(-ray), shadows.lit(p, {0, 1, 0}));
        const double haze = 1 - std::exp(-std::max(0.0, t * length(ray) / reach - 1.5) / 7);
        color = lerp(lit, color, haze);
      }
      out.color[at] = Vec3f(color);
      out.depth[at] = depth;
    }
  }
}

/// Draws one triangle, cut at the near plane.
void paint(const Triangle& t, const View& view, const ShadowMap& shadows, Buffer& out) {
  constexpr double near = 1e-3;
  Vec3d local[3];
  int behind = 0;
  for (int i = 0; i < 3; ++i) {
    local[i] = view.local(t.corner[i]);
    behind += local[i].z < near;
  }
  if (behind == 3) return;
  if (behind > 0) {
    // The part in front as one or two triangles.
    Triangle parts[2] = {t, t};
    Vec3d corner[4], normal[4];
    int n = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (local[i].z >= near) {
        corner[n] = t.corner[i];
        normal[n++] = t.normal[i];
      }
      if ((local[i].z >= near) != (local[j].z >= near)) {
        const double s = (1.01 * near - local[i].z) / (local[j].z - local[i].z);
        corner[n] = lerp(t.corner[i], t.corner[j], s);
        normal[n++] = lerp(t.normal[i], t.normal[j], s);
      }
    }
    for (int k = 0; k + 2 < n; ++k) {
      const int pick[3] = {0, k + 1, k + 2};
      for (int i = 0; i < 3; ++i) {
        parts[k].corner[i] = corner[pick[i]];
        parts[k].normal[i] = normal[pick[i]];
        local[i] = view.local(corner[pick[i]]);
      }
      if (local[0].z >= near && local[1].z >= near && local[2].z >= near) paint(parts[k], view, shadows, out);
    }
    return;
  }
  const Vec2d p[3] = {view.screen(local[0]), view.screen(local[1]), view.screen(local[2])};
  const double w[3] = {1 / local[0].z, 1 / local[1].z, 1 / local[2].z};
  const Vec3d albedo = linear(t.color);
  fill(p, out.width, out.height, [&](int x, int y, double a, double b, double c) {
    const double inverse = a * w[0] + b * w[1] + c * w[2];
    const float depth = float(1 / inverse);
    const std::size_t at = std::size_t(y) * out.width + x;
    if (depth >= out.depth[at]) return;
    const double u = a * w[0] / inverse, v = b * w[1] / inverse, s = 1 - u - v;
    const Vec3d point = t.corner[0] * u + t.corner[1] * v + t.corner[2] * s;
    Vec3d normal = normalize(t.normal[0] * u + t.normal[1] * v + t.normal[2] * s);
    if (t.two_sided && dot(normal, view.eye - point) < 0) normal = -normal;
    const Vec3d color = shade(albedo, normal, normalize(view.eye - point), shadows.lit(point, normal));
    if (t.opacity < 1) {
      out.color[at] = lerp(out.color[at], Vec3f(color), float(t.opacity));
      return;
    }
    out.color[at] = Vec3f(color);
    out.depth[at] = depth;
  });
}

void stroke(const host::Line& line, const View& view, Buffer& out) {
  Vec3d a = view.local(line.a), b = view.local(line.b);
  constexpr double near = 1e-3;
  if (a.z < near && b.z < near) return;
  if (a.z < near) a = lerp(a, b, (1.01 * near - a.z) / (b.z - a.z));
  if (b.z < near) b = lerp(b, a, (1.01 * near - b.z) / (a.z - b.z));
  const Vec2d p = view.screen(a), q = view.screen(b);
  const Vec2d along = q - p;
  const double size = length(along);
  if (!(size > 1e-6) || size > 1e5) return;
  const Vec2d side = perpendicular(along) * (1.1 * samples / size);
  const Vec3d color = linear(line.rgba >> 8);
  const float alpha = float(line.rgba & 255) / 255;
  const auto put = [&](const Vec2d t[3], const double z[3]) {
    fill(t, out.width, out.height, [&](int x, int y, double i, double j, double k) {
      const double depth = 1 / (i / z[0] + j / z[1] + k / z[2]);
      const std::size_t at = std::size_t(y) * out.width + x;
      const bool hidden = depth * 0.999 > double(out.depth[at]);
      // A line behind something still shows faintly: forces and axes sit inside bodies.
      out.color[at] = lerp(out.color[at], Vec3f(color), hidden ? 0.25f * alpha : alpha);
    });
  };
  const Vec2d first[3] = {p - side, p + side, q + side}, second[3] = {p - side, q + side, q - side};
  const double z1[3] = {a.z, a.z, b.z}, z2[3] = {a.z, b.z, b.z};
  put(first, z1);
  put(second, z2);
}

}  // namespace

std::optional<Vec2d> project(const host::Camera& camera, Vec3d p, int width, int height) {
  const View view(camera, width, height);
  const Vec3d local = view.local(p);
  if (local.z < 1e-3) return {};
  return view.screen(local);
}

Image render(const RasterScene& scene, int width, int height) {
  Buffer buffer{width * samples, height * samples, {}, {}};
  buffer.color.resize(std::size_t(buffer.width) * buffer.height);
  buffer.depth.resize(buffer.color.size());
  const View view(scene.camera, buffer.width, buffer.height);
  const ShadowMap shadows(scene);
  background(scene, view, shadows, buffer);
  std::vector<std::pair<double, const Triangle*>> glass;
  for (const Triangle& t : scene.triangles) {
    if (t.opacity >= 1)
      paint(t, view, shadows, buffer);
    else
      glass.push_back({view.local((t.corner[0] + t.corner[1] + t.corner[2]) / 3.0).z, &t});
  }
  std::sort(glass.begin(), glass.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;  // of the same depth: as they came
  });
  for (const auto& [depth, t] : glass) paint(*t, view, shadows, buffer);
  for (const host::Line& line : scene.lines) stroke(line, view, buffer);

  Image image{width, height, {}};
  image.pixels.resize(std::size_t(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Vec3d sum{};
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
          const Vec3f c = buffer.color[std::size_t(y * samples + j) * buffer.width + x * samples + i];
          sum += Vec3d{std::sqrt(std::clamp(double(c.x), 0.0, 1.0)), std::sqrt(std::clamp(double(c.y), 0.0, 1.0)),
                       std::sqrt(std::clamp(double(c.z), 0.0, 1.0))};
        }
      sum = sum * (255.0 / (samples * samples));
      image.pixels[std::size_t(y) * width + x] = std::uint32_t(math::round(sum.x)) << 16 |
                                                 std::uint32_t(math::round(sum.y)) << 8 |
                                                 std::uint32_t(math::round(sum.z));
    }
  }
  return image;
}

}  // namespace carom::command
