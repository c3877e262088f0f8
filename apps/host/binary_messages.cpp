// Motion, meshes and what is drawn, as docs/protocol.md lays it out in bytes.
#include <bit>
#include <cstring>

#include "apps/host/messages.h"

namespace carom::host {

namespace {

/// Little-endian numbers one after another.
class Writer {
 public:
  explicit Writer(std::size_t size) { bytes_.reserve(size); }
  template <class T>
  void put(T value) {
    static_assert(std::endian::native == std::endian::little, "Carom runs on little-endian machines");
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes_.append(raw, sizeof value);
  }
  void put(math::Vec3f v) {
    put(v.x);
    put(v.y);
    put(v.z);
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

std::int16_t quantised(float x) {
  const float scaled = math::clamp(x, -1.0f, 1.0f) * 32767.0f;
  return std::int16_t(scaled < 0 ? scaled - 0.5f : scaled + 0.5f);
}

}  // namespace

std::string frame_message(const FrameFields& f) {
  Writer out(56 + 24 * f.bodies.size() + 20 * f.samples.size() + 28 * f.lines.size() + 64);
  out.put(std::uint8_t{2});
  out.put(std::uint8_t((f.key ? 1 : 0) | (f.stats ? 2 : 0)));
  out.put(std::uint16_t(f.dimension));
  out.put(f.sequence);
  out.put(f.step);
  out.put(std::uint32_t(f.bodies.size()));
  out.put(std::uint32_t(f.samples.size()));
  out.put(std::uint32_t(f.lines.size()));
  out.put(f.time);
  out.put(f.origin.x);
  out.put(f.origin.y);
  out.put(f.origin.z);
  for (const BodyPlace& body : f.bodies) {
    out.put(body.id | (body.awake ? 0u : 0x80000000u));
    out.put(math::Vec3f(body.position - f.origin));
    out.put(quantised(body.rotation.x));
    out.put(quantised(body.rotation.y));
    out.put(quantised(body.rotation.z));
    out.put(quantised(body.rotation.w));
  }
  for (const Sample& sample : f.samples) {
    out.put(std::uint16_t(sample.plot));
    out.put(std::uint16_t(sample.series));
    out.put(sample.x);
    out.put(sample.y);
  }
  for (const Line& line : f.lines) {
    out.put(math::Vec3f(line.a - f.origin));
    out.put(math::Vec3f(line.b - f.origin));
    out.put(line.rgba);
  }
  if (f.stats) {
    const FrameStats& s = *f.stats;
    for (const std::uint32_t n : {s.bodies, s.awake, s.contacts, s.joints, s.islands, s.threads}) out.put(n);
    out.put(s.step_ms);
    out.put(s.real_time_factor);
    out.put(s.kinetic);
    out.put(s.potential);
    out.put(s.hash);
    out.put(s.worst_penetration);
  }
  return out.take();
}

std::string mesh_message(std::uint32_t id, const Mesh& mesh) {
  Writer out(16 + 12 * mesh.vertices.size() + 4 * mesh.indices.size());
  out.put(std::uint8_t{1});
  out.put(std::uint8_t{0});
  out.put(std::uint16_t{0});
  out.put(id);
  out.put(std::uint32_t(mesh.vertices.size()));
  out.put(std::uint32_t(mesh.indices.size()));
  for (const math::Vec3f v : mesh.vertices) out.put(v);
  for (const std::uint32_t i : mesh.indices) out.put(i);
  return out.take();
}

std::string points_message(const Points& points) {
  math::Vec3f low{}, high{};
  float largest = 0;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const math::Vec3f p = points.positions[i];
    low = i == 0 ? p : math::min(low, p);
    high = i == 0 ? p : math::max(high, p);
    largest = math::max(largest, points.radii[i]);
  }
  const math::Vec3f size = high - low;
  const auto part = [](float x, float whole) {
    return whole > 0 ? std::uint16_t(math::clamp(x / whole, 0.0f, 1.0f) * 65535.0f + 0.5f) : std::uint16_t{0};
  };
  Writer out(36 + 12 * points.positions.size());
  out.put(std::uint8_t{4});
  out.put(std::uint8_t{0});
  out.put(std::uint16_t{0});
  out.put(std::uint32_t(points.positions.size()));
  out.put(low);
  out.put(size);
  out.put(largest);
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const math::Vec3f p = points.positions[i] - low;
    out.put(part(p.x, size.x));
    out.put(part(p.y, size.y));
    out.put(part(p.z, size.z));
    out.put(part(points.radii[i], largest));
    out.put(points.rgbas[i]);
  }
  return out.take();
}

std::string surface_message(std::uint32_t id, const Surface& surface, bool with_triangles) {
  const std::size_t indices = with_triangles ? surface.triangles.size() : 0;
  Writer out(20 + 12 * surface.corners.size() + 4 * indices);
  out.put(std::uint8_t{5});
  out.put(std::uint8_t(with_triangles ? 1 : 0));
  out.put(std::uint16_t{0});
  out.put(id);
  out.put(std::uint32_t(surface.corners.size()));
  out.put(std::uint32_t(indices));
  out.put(surface.rgba);
  for (const math::Vec3f p : surface.corners) out.put(p);
  if (with_triangles)
    for (const std::uint32_t corner : surface.triangles) out.put(corner);
  return out.take();
}

}  // namespace carom::host
