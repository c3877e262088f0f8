// What a page needs to draw a scene: the messages of docs/protocol.md, and frames for recordings.
#include "carom/core/string.h"
#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/scene/detail/bytes.h"
#include "carom/scene/detail/document.h"
#include "carom/scene/detail/text.h"
#include "carom/scene/recording.h"
#include "carom/scene/scene_world.h"

namespace carom::scene {
namespace {
using namespace rigid;
using detail::quote;
using detail::shortest;

std::string list(std::initializer_list<double> values) {
  std::string out = "[";
  for (const double v : values) out += (out.size() > 1 ? "," : "") + shortest(v);
  return out + "]";
}
std::string points_of(std::span<const math::Vec2f> points) {
  std::string out = "[";
  for (const math::Vec2f& p : points) out += (out.size() > 1 ? "," : "") + list({double(p.x), double(p.y)});
  return out + "]";
}

struct Triangles {
  std::vector<math::Vec3f> vertices;
  std::vector<std::uint32_t> indices;
};

/// Makes the shapes of a body and the meshes they need. Shared geometry becomes one mesh.
class ShapeWriter {
 public:
  explicit ShapeWriter(std::vector<std::string>& meshes) : meshes_(meshes) {}

  void add(const geometry::Shape2& s, const math::Transform2f& local, std::string& out) {
    std::string body;
    switch (s.type) {
      case geometry::ShapeType2::circle:
        body = "\"kind\":\"circle\",\"radius\":" + shortest(s.circle.radius);
        break;
      case geometry::ShapeType2::capsule:
        body = "\"kind\":\"capsule\",\"half_length\":" + shortest(s.capsule.half_length) +
               ",\"radius\":" + shortest(s.capsule.radius);
        break;
      case geometry::ShapeType2::polygon:
        body = "\"kind\":\"polygon\",\"points\":" + points_of({s.polygon.vertices, std::size_t(s.polygon.count)}) +
               ",\"radius\":" + shortest(s.polygon.radius);
        break;
      case geometry::ShapeType2::segment: {
        const math::Vec2f ends[] = {s.segment.a, s.segment.b};
        body = "\"kind\":\"segment\",\"points\":" + points_of(ends);
        break;
      }
      case geometry::ShapeType2::chain_segment: {
        const math::Vec2f ends[] = {s.chain_segment.a, s.chain_segment.b};
        body = "\"kind\":\"segment\",\"points\":" + points_of(ends);
        break;
      }
      case geometry::ShapeType2::chain:
        body = "\"kind\":\"chain\",\"points\":" + points_of(s.chain->points) +
               ",\"loop\":" + (s.chain->loop ? "true" : "false");
        break;
    }
    // A turn in the plane by φ is the quaternion (cos φ/2, 0, 0, sin φ/2).
    const double c = double(local.q.c), half = math::sqrt(math::max(0.0, (1 + c) / 2));
    const double other = math::sqrt(math::max(0.0, (1 - c) / 2));
    put(body, list({double(local.p.x), double(local.p.y), 0, half, 0, 0, local.q.s < 0 ? -other : other}), out);
  }

  void add(const geometry::Shape3& s, const math::Transform3f& local, std::string& out) {
    std::string body;
    switch (s.type) {
      case geometry::ShapeType3::sphere:
        body = "\"kind\":\"sphere\",\"radius\":" + shortest(s.sphere.radius);
        break;
      case geometry::ShapeType3::capsule:
        body = "\"kind\":\"capsule\",\"half_length\":" + shortest(s.capsule.half_length) +
               ",\"radius\":" + shortest(s.capsule.radius);
        break;
      case geometry::ShapeType3::box:
        body = "\"kind\":\"box\",\"half_extents\":" +
               list({double(s.box.half_extents.x), double(s.box.half_extents.y), double(s.box.half_extents.z)}) +
               ",\"radius\":" + shortest(s.box.radius);
        break;
      case geometry::ShapeType3::cylinder:
        body = "\"kind\":\"cylinder\",\"half_height\":" + shortest(s.cylinder.half_height) +
               ",\"radius\":" + shortest(s.cylinder.radius);
        if (s.cylinder.rounding > 0) body += ",\"rounding\":" + shortest(s.cylinder.rounding);
        break;
      case geometry::ShapeType3::cone:
        body = "\"kind\":\"cone\",\"half_height\":" + shortest(s.cone.half_height) +
               ",\"radius\":" + shortest(s.cone.radius);
        if (s.cone.rounding > 0) body += ",\"rounding\":" + shortest(s.cone.rounding);
        break;
      case geometry::ShapeType3::ellipsoid:
        body = "\"kind\":\"ellipsoid\",\"radii\":" +
               list({double(s.ellipsoid.radii.x), double(s.ellipsoid.radii.y), double(s.ellipsoid.radii.z)});
        break;
      case geometry::ShapeType3::plane:
        body = "\"kind\":\"plane\",\"normal\":" +
               list({double(s.plane.normal.x), double(s.plane.normal.y), double(s.plane.normal.z)});
        break;
      case geometry::ShapeType3::compound:
        for (const geometry::CompoundChild& child : s.compound->children) add(child.shape, local * child.local, out);
        return;
      default:
        body = "\"kind\":\"mesh\",\"mesh\":" + std::to_string(mesh(s));
        break;
    }
    put(body,
        list({double(local.p.x), double(local.p.y), double(local.p.z), double(local.q.w), double(local.q.x),
              double(local.q.y), double(local.q.z)}),
        out);
  }

 private:
  static void put(const std::string& body, const std::string& local, std::string& out) {
    if (!out.empty()) out += ",";
    out += "{" + body + ",\"local\":" + local + "}";
  }
  std::uint32_t mesh(const geometry::Shape3& s) {
    for (std::size_t i = 0; i < known_.size(); ++i)
      if (known_[i] == s.data.get()) return std::uint32_t(i);
    Triangles t;
    if (s.type == geometry::ShapeType3::hull)
      hull_triangles(*s.hull, t);
    else if (s.type == geometry::ShapeType3::mesh)
      t = {s.mesh->vertices, s.mesh->indices};
    else if (s.type == geometry::ShapeType3::height_field)
      field_triangles(*s.height_field, t);
    else {
      geometry::Triangles faces = geometry::to_triangles(s);
      t = {std::move(faces.positions), std::move(faces.indices)};
    }
    const std::uint32_t id = std::uint32_t(known_.size());
    known_.push_back(s.data.get());
    detail::ByteWriter out;
    out.fixed(std::uint32_t{1});
    out.fixed(id);
    out.fixed(std::uint32_t(t.vertices.size()));
    out.fixed(std::uint32_t(t.indices.size()));
    for (const math::Vec3f& v : t.vertices) out.number(v.x), out.number(v.y), out.number(v.z);
    for (const std::uint32_t i : t.indices) out.fixed(i);
    meshes_.emplace_back(out.bytes.begin(), out.bytes.end());
    return id;
  }
  static void hull_triangles(const geometry::Hull& hull, Triangles& t) {
    t.vertices = hull.vertices;
    for (const geometry::HullFace& face : hull.faces) {
      const geometry::HullEdge& first = hull.edges[face.first_edge];
      std::uint16_t edge = first.next;
      for (int i = 2; i < int(face.edge_count); ++i) {
        const std::uint16_t next = hull.edges[edge].next;
        t.indices.insert(t.indices.end(), {first.origin, hull.edges[edge].origin, hull.edges[next].origin});
        edge = next;
      }
    }
  }
  static void field_triangles(const geometry::HeightField& f, Triangles& t) {
    for (int j = 0; j < f.rows; ++j)
      for (int i = 0; i < f.columns; ++i)
        t.vertices.emplace_back(float(i) * f.cell.x,
                                f.heights[std::size_t(j) * std::size_t(f.columns) + std::size_t(i)],
                                float(j) * f.cell.y);
    for (int j = 0; j + 1 < f.rows; ++j) {
      for (int i = 0; i + 1 < f.columns; ++i) {
        if (!f.holes.empty() && f.holes[std::size_t(j) * std::size_t(f.columns - 1) + std::size_t(i)] != 0) continue;
        const std::uint32_t a = std::uint32_t(j * f.columns + i), b = a + 1, c = a + std::uint32_t(f.columns),
                            d = c + 1;
        t.indices.insert(t.indices.end(), {a, c, d, a, d, b});
      }
    }
  }

  std::vector<std::string>& meshes_;
  std::vector<const void*> known_;
};

math::Vec3d wide_position(math::Vec2d p) { return {p.x, p.y, 0}; }
math::Vec3d wide_position(math::Vec3d p) { return p; }
math::Quatf wide_rotation(math::Rot2f q) {
  const float c = math::sqrt(math::max(0.0f, (1 + q.c) / 2)), s = math::sqrt(math::max(0.0f, (1 - q.c) / 2));
  return {c, 0, 0, q.s < 0 ? -s : s};
}
math::Quatf wide_rotation(const math::Quatf& q) { return q; }

template <class D>
void describe_bodies(const World<D>& world, const SceneWorld& scene, SceneMessages& out) {
  ShapeWriter writer(out.meshes);
  constexpr const char* types[] = {"fixed", "kinematic", "dynamic"};
  std::vector<BodyId> ids;
  std::vector<ShapeId> shapes;
  world.bodies(ids);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Result<BodyState<D>> state = world.state(ids[i]);
    if (!state) continue;
    const SceneBody* named =
        i < scene.bodies.size() && scene.bodies[i].id == ids[i] ? &scene.bodies[i] : scene.find_body(ids[i]);
    std::string list_of_shapes;
    shapes.clear();
    world.shapes(ids[i], shapes);
    for (const ShapeId s : shapes) {
      const auto shape = world.shape_geometry(s);
      const auto definition = world.shape_definition(s);
      if (shape.ok() && definition.ok()) writer.add(*shape, definition->local, list_of_shapes);
    }
    const math::Vec3d p = wide_position(state->pose.position);
    const math::Quatf q = wide_rotation(state->pose.rotation);
    if (i > 0) out.scene += ",";
    out.scene += "{\"id\":" + std::to_string(i) +
                 ",\"name\":" + quote(named != nullptr ? named->name : "body_" + std::to_string(i)) + ",\"type\":\"" +
                 types[int(state->type)] + "\"";
    if (named != nullptr && named->colored) {
      out.scene += ",\"color\":" + quote(detail::color_text(named->color | 0xff000000u));
    }
    out.scene += ",\"position\":" + list({p.x, p.y, p.z}) +
                 ",\"rotation\":" + list({double(q.w), double(q.x), double(q.y), double(q.z)}) + ",\"shapes\":[" +
                 list_of_shapes + "]}";
  }
}

template <class D>
void capture(const World<D>& world, RecordedFrame& out) {
  std::vector<BodyId> ids;
  world.bodies(ids);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Result<BodyState<D>> state = world.state(ids[i]);
    if (state)
      out.bodies.push_back(
          {std::uint32_t(i), !state->awake, wide_position(state->pose.position), wide_rotation(state->pose.rotation)});
  }
}

}  // namespace

SceneMessages scene_messages(const SceneWorld& world, const double* ground) {
  SceneMessages out;
  out.scene = "{\"type\":\"scene\",\"bodies\":[";
  if (world.world2) describe_bodies(*world.world2, world, out);
  if (world.world3) describe_bodies(*world.world3, world, out);
  if (world.flight) {
    const FlightPlace place = *world.flight_place();
    const math::Vec3d p = place.position, h = place.half_extents;
    const math::Quatf q = place.rotation;
    out.scene += "{\"id\":0,\"name\":\"vehicle\",\"type\":\"dynamic\",\"position\":" + list({p.x, p.y, p.z}) +
                 ",\"rotation\":" + list({double(q.w), double(q.x), double(q.y), double(q.z)}) +
                 ",\"shapes\":[{\"kind\":\"box\",\"half_extents\":" + list({h.x, h.y, h.z}) +
                 ",\"radius\":0,\"local\":[0,0,0,1,0,0,0]}]}";
  }
  out.scene += "]";
  if (ground != nullptr) out.scene += ",\"ground\":{\"level\":" + shortest(*ground) + "}";
  out.scene += "}";
  return out;
}

void capture_frame(const SceneWorld& world, RecordedFrame& out) {
  out.step = world.step_count();
  out.time = world.time();
  out.has_hash = true;
  out.state_hash = world.state_hash();
  out.bodies.clear();
  if (world.world2) capture(*world.world2, out);
  if (world.world3) capture(*world.world3, out);
  if (const std::optional<FlightPlace> place = world.flight_place())
    out.bodies.push_back({0, false, place->position, place->rotation});
}

}  // namespace carom::scene
