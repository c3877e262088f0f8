#include "carom/scene/detail/text.h"

#include <charconv>
#include <cstdio>

#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/geometry/voxels.h"

namespace carom::scene::detail {
using namespace rigid;

std::string bits_text(std::uint64_t bits) {
  char buffer[24] = "0x";
  const std::to_chars_result end = std::to_chars(buffer + 2, buffer + sizeof buffer, bits, 16);
  return quote(std::string_view(buffer, std::size_t(end.ptr - buffer)));
}
std::string color_text(std::uint32_t argb) {
  char text[16];
  const unsigned opacity = argb >> 24;
  if (opacity == 255)
    std::snprintf(text, sizeof text, "#%06x", unsigned(argb & 0xFFFFFF));
  else
    std::snprintf(text, sizeof text, "#%06x%02x", unsigned(argb & 0xFFFFFF), opacity);
  return text;
}

namespace {

template <class V>
std::string points_text(std::span<const V> points) {
  std::string out = "[";
  for (const V& p : points) out += (out.size() > 1 ? ", " : "") + vector_text(p);
  return out + "]";
}

/// The half extents where the polygon is what make_box2 makes of them; zero where it is not. A box may be thinner than
/// a polygon of the same points, which make_polygon would take for a line.
math::Vec2f box_extents(const geometry::Polygon& p) {
  math::Vec2f half;
  for (int i = 0; i < p.count; ++i) half = math::max(half, p.vertices[i]);
  if (p.count != 4 || !(half.x > 0 && half.y > 0)) return {};
  const geometry::Polygon box = geometry::make_box2(half, p.radius);
  for (int i = 0; i < 4; ++i)
    if (!(box.vertices[i] == p.vertices[i])) return {};
  return half;
}

template <class T>
std::string numbers_text(const std::vector<T>& values) {
  std::string out = "[";
  for (const T v : values) {
    if (out.size() > 1) out += ", ";
    if constexpr (std::is_floating_point_v<T>)
      out += digits(v);
    else
      out += std::to_string(v);
  }
  return out + "]";
}

void put_geometry(const geometry::Shape2& s, Fields& f) {
  switch (s.type) {
    case geometry::ShapeType2::circle:
      f.put("type", quote("circle")).put("radius", s.circle.radius);
      return;
    case geometry::ShapeType2::capsule:
      f.put("type", quote("capsule")).put("half_length", s.capsule.half_length).put("radius", s.capsule.radius);
      return;
    case geometry::ShapeType2::polygon:
      if (const math::Vec2f half = box_extents(s.polygon); half.x > 0) {
        f.put("type", quote("box")).put("half_extents", vector_text(half)).unless("radius", s.polygon.radius, 0.0f);
        return;
      }
      f.put("type", quote("polygon"))
          .put("points", points_text(std::span<const math::Vec2f>(s.polygon.vertices, std::size_t(s.polygon.count))))
          .unless("radius", s.polygon.radius, 0.0f);
      return;
    case geometry::ShapeType2::segment: {
      const math::Vec2f ends[] = {s.segment.a, s.segment.b};
      f.put("type", quote("segment")).put("points", points_text(std::span<const math::Vec2f>(ends)));
      return;
    }
    case geometry::ShapeType2::chain_segment: {
      const math::Vec2f ends[] = {s.chain_segment.a, s.chain_segment.b};
      f.put("type", quote("segment")).put("points", points_text(std::span<const math::Vec2f>(ends)));
      return;
    }
    case geometry::ShapeType2::chain:
      f.put("type", quote("chain")).put("points", points_text(std::span<const math::Vec2f>(s.chain->points)));
      f.flag("loop", s.chain->loop, false);
      if (!s.chain->materials.empty()) f.put("materials", numbers_text(s.chain->materials));
      return;
  }
}

void put_geometry(const geometry::Shape3& s, Fields& f) {
  switch (s.type) {
    case geometry::ShapeType3::sphere:
      f.put("type", quote("sphere")).put("radius", s.sphere.radius);
      return;
    case geometry::ShapeType3::capsule:
      f.put("type", quote("capsule")).put("half_length", s.capsule.half_length).put("radius", s.capsule.radius);
      return;
    case geometry::ShapeType3::box:
      f.put("type", quote("box"))
          .put("half_extents", vector_text(s.box.half_extents))
          .unless("radius", s.box.radius, 0.0f);
      return;
    case geometry::ShapeType3::cylinder:
      f.put("type", quote("cylinder"))
          .put("half_height", s.cylinder.half_height)
          .put("radius", s.cylinder.radius)
          .unless("rounding", s.cylinder.rounding, 0.0f);
      return;
    case geometry::ShapeType3::cone:
      f.put("type", quote("cone"))
          .put("half_height", s.cone.half_height)
          .put("radius", s.cone.radius)
          .unless("rounding", s.cone.rounding, 0.0f);
      return;
    case geometry::ShapeType3::ellipsoid:
      f.put("type", quote("ellipsoid")).put("radii", vector_text(s.ellipsoid.radii));
      return;
    case geometry::ShapeType3::plane:
      f.put("type", quote("plane")).put("normal", vector_text(s.plane.normal));
      return;
    case geometry::ShapeType3::hull:
      f.put("type", quote("hull")).put("points", points_text(std::span<const math::Vec3f>(s.hull->vertices)));
      f.unless("radius", s.hull->radius, 0.0f);
      if (const std::size_t corners = s.hull->vertices.size(); corners > 128)
        f.put("max_corners", std::to_string(corners));
      return;
    case geometry::ShapeType3::mesh:
      f.put("type", quote("mesh")).put("vertices", points_text(std::span<const math::Vec3f>(s.mesh->vertices)));
      f.put("indices", numbers_text(s.mesh->indices));
      if (!s.mesh->materials.empty()) f.put("materials", numbers_text(s.mesh->materials));
      return;
    case geometry::ShapeType3::height_field: {
      const geometry::HeightField& h = *s.height_field;
      f.put("type", quote("height_field"))
          .put("columns", std::to_string(h.columns))
          .put("rows", std::to_string(h.rows));
      f.put("cell", vector_text(h.cell)).put("heights", numbers_text(h.heights));
      if (!h.holes.empty()) f.put("holes", numbers_text(h.holes));
      if (!h.materials.empty()) f.put("materials", numbers_text(h.materials));
      return;
    }
    case geometry::ShapeType3::voxels: {
      const geometry::VoxelGrid& g = *s.voxels;
      f.put("type", quote("voxels")).put("columns", std::to_string(g.columns)).put("layers", std::to_string(g.layers));
      f.put("rows", std::to_string(g.rows)).put("cell_size", g.cell);
      std::vector<std::uint32_t> runs;
      for (const std::uint8_t cell : g.cells) {
        if (runs.empty() || runs.back() != cell) runs.insert(runs.end(), {0u, std::uint32_t(cell)});
        ++runs[runs.size() - 2];
      }
      f.put("runs", numbers_text(runs));
      return;
    }
    case geometry::ShapeType3::compound: {
      std::string children = "[";
      for (const geometry::CompoundChild& child : s.compound->children) {
        Fields c;
        put_geometry(child.shape, c);
        c.put("position", vector_text(child.local.p)).put("rotation", rotation_text(child.local.q));
        children += (children.size() > 1 ? ", " : "") + c.object();
      }
      f.put("type", quote("compound")).put("children", children + "]");
      return;
    }
  }
}

std::string material_text(const Material& m) {
  Fields f;
  f.put("friction", m.friction)
      .put("restitution", m.restitution)
      .unless("rolling_resistance", m.rolling_resistance, 0.0f)
      .unless("spinning_resistance", m.spinning_resistance, 0.0f);
  f.unless("tangent_speed", m.tangent_speed, 0.0f);
  if (m.user_id != 0) f.put("user_id", std::to_string(m.user_id));
  return f.object();
}

}  // namespace

template <class D>
std::string shape_text(const typename D::Shape& shape, const ShapeDef<D>& d) {
  Fields f;
  put_geometry(shape, f);
  if (!(d.local == typename D::Transform{}))
    f.put("position", vector_text(d.local.p)).put("rotation", rotation_text(d.local.q));
  f.put("density", d.density).put("material", material_text(d.material));
  if (!(d.filter == Filter{})) {
    Fields filter;
    filter.put("category", bits_text(d.filter.category))
        .put("mask", bits_text(d.filter.mask))
        .put("group", std::to_string(d.filter.group));
    f.put("filter", filter.object());
  }
  f.flag("sensor", d.sensor, false)
      .flag("contact_events", d.contact_events, true)
      .flag("hit_events", d.hit_events, false)
      .flag("modify_contacts", d.modify_contacts, false);
  if (!(d.surface_velocity == typename D::Vector{})) f.put("surface_velocity", vector_text(d.surface_velocity));
  if (!d.surfaces.empty()) {
    std::string surfaces;
    for (const SurfaceMaterial<D>& s : d.surfaces)
      surfaces += (surfaces.empty() ? "" : ", ") + Fields()
                                                       .put("material", material_text(s.material))
                                                       .put("surface_velocity", vector_text(s.surface_velocity))
                                                       .object();
    f.put("surfaces", "[" + surfaces + "]");
  }
  if (!(d.one_way == typename D::Vector{})) f.put("one_way", vector_text(d.one_way));
  if (d.user_data != 0) f.put("user_data", bits_text(d.user_data));
  return f.object();
}

template std::string shape_text<Dim2>(const geometry::Shape2&, const ShapeDef<Dim2>&);
template std::string shape_text<Dim3>(const geometry::Shape3&, const ShapeDef<Dim3>&);

}  // namespace carom::scene::detail
