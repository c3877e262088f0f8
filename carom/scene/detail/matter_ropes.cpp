// Ropes, cloth and soft bodies of a scene file.
#include "carom/scene/detail/matter.h"
#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {
namespace {
using math::Vec3d;
using rigid::BodyId;
using rigid::Dim3;
using Place = MatterPlace<Dim3>;

int nearest(std::span<const Vec3d> points, Vec3d to) {
  int best = 0;
  for (int i = 1; i < int(points.size()); ++i)
    if (math::distance(points[std::size_t(i)], to) < math::distance(points[std::size_t(best)], to)) best = i;
  return best;
}

/// The body of the key "body"; null for the world.
BodyId body_of(Place& place, const Object& o) {
  const std::string name = place.reader.text(o, "body");
  if (name.empty() || name == "world" || place.reader.failed()) return {};
  return place.names.find_body(*o.find("body"), o.path_of("body"), name);
}
/// A place of the world as a point of the body's frame.
Vec3d in_body(const Place& place, BodyId body, Vec3d point) {
  if (body.is_null()) return point;
  const auto state = place.world.state(body);
  if (!state) return point;
  return math::inverse_rotate(math::Quatd(state->pose.rotation), point - state->pose.position);
}
bool accept(Place& place, const core::Status& status, const Object& o) {
  return !place.reader.failed() && place.reader.accept(status, *o.node, o.path);
}

particles::RopeMaterial read_rope_material(Reader& r, const Object& o) {
  particles::RopeMaterial m;
  m.mass_per_length = r.number(o, "mass_per_length", m.mass_per_length);
  m.radius = read_radius(r, o, m.radius);
  m.axial_stiffness = r.number(o, "axial_stiffness", m.axial_stiffness);
  m.axial_damping = r.number(o, "axial_damping", m.axial_damping);
  m.bending_stiffness = r.number(o, "bending_stiffness", m.bending_stiffness);
  m.bending_damping = r.number(o, "bending_damping", m.bending_damping);
  m.torsional_stiffness = r.number(o, "torsional_stiffness", m.torsional_stiffness);
  m.friction = r.number(o, "friction", m.friction);
  m.drag_coefficient = r.number(o, "drag_coefficient", m.drag_coefficient);
  m.skin_coefficient = r.number(o, "skin_coefficient", m.skin_coefficient);
  m.break_tension = r.number(o, "break_tension", m.break_tension);
  return m;
}

particles::Fabric read_fabric(Reader& r, const Object& o) {
  particles::Fabric f;
  f.mass_per_area = r.number(o, "mass_per_area", f.mass_per_area);
  f.warp_stiffness = r.number(o, "warp_stiffness", f.warp_stiffness);
  f.weft_stiffness = r.number(o, "weft_stiffness", f.weft_stiffness);
  f.poisson_ratio = r.number(o, "poisson_ratio", f.poisson_ratio);
  f.shear_stiffness = r.number(o, "shear_stiffness", f.shear_stiffness);
  f.bending_stiffness = r.number(o, "bending_stiffness", f.bending_stiffness);
  f.damping = r.number(o, "damping", f.damping);
  f.thickness = r.number(o, "thickness", f.thickness);
  f.friction = r.number(o, "friction", f.friction);
  f.normal_coefficient = r.number(o, "normal_coefficient", f.normal_coefficient);
  f.tangential_coefficient = r.number(o, "tangential_coefficient", f.tangential_coefficient);
  f.tear_tension = r.number(o, "tear_tension", f.tear_tension);
  return f;
}

/// The vertices that a pin names.
std::vector<int> pinned(Reader& r, const Object& o, std::span<const Vec3d> points, int columns) {
  std::vector<int> out;
  const int n = int(points.size());
  const int ways = o.has("vertex") + o.has("near") + o.has("edge") + o.has("lower");
  if (ways != 1 || o.has("lower") != o.has("upper")) {
    r.fail(*o.node, o.path, "a pin has one of \"vertex\", \"near\", \"edge\", or \"lower\" and \"upper\"");
    return out;
  }
  if (o.has("vertex")) out.push_back(r.integer(o, "vertex", 0, 0, n - 1));
  if (o.has("near")) out.push_back(nearest(points, r.vector(o, "near")));
  if (o.has("edge")) {
    const int edge = r.choice(o, "edge", 0);
    if (columns == 0) r.fail(*o.find("edge"), o.path_of("edge"), "only a sheet of columns and rows has edges");
    if (r.failed()) return {};
    const int rows = n / columns;
    if (edge < 2)
      for (int i = 0; i < rows; ++i) out.push_back(i * columns + (edge == 0 ? 0 : columns - 1));
    else
      for (int i = 0; i < columns; ++i) out.push_back((edge == 2 ? 0 : rows - 1) * columns + i);
  }
  if (o.has("lower")) {
    const Vec3d low = r.vector(o, "lower"), high = r.vector(o, "upper");
    for (int i = 0; i < n; ++i) {
      const Vec3d p = points[std::size_t(i)];
      if (p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z)
        out.push_back(i);
    }
    if (out.empty()) r.fail(*o.node, o.path, "found no vertex within the box");
  }
  return out;
}
template <class Body>
void read_pins(Place& place, const Object& o, Body& body, int columns) {
  each_entry(place.reader, o, "pins", pin_kind, [&](const Object& p) {
    const BodyId held_by = body_of(place, p);
    for (const int v : pinned(place.reader, p, body.positions(), columns)) {
      const Vec3d at = body.positions()[std::size_t(v)];
      if (!accept(place, body.pin(v, held_by, in_body(place, held_by, at), place.world), p)) return;
    }
  });
}

}  // namespace

void read_rope(Place& place, const Object& o) {
  Reader& r = place.reader;
  particles::RopeDef def;
  def.material = read_rope_material(r, o);
  const std::vector<Vec3d> points = r.points(o, "points");
  def.points = points;
  def.segments = r.integer(o, "segments", def.segments, 1, 10000);
  def.length = r.number(o, "length", 0);
  def.collide = r.flag(o, "collide", true);
  def.touch = particles::RopeTouch(r.choice(o, "touch", int(def.touch)));
  def.filter = read_matter_filter(r, o);
  Named<int> named{.name = {}, .color = 0xb08d57, .thing = 0};
  if (!name_thing(r, o, "rope", place.out.ropes, named.name, named.color)) return;
  if (!spend(r, place.budget, def.segments + 1.0, o)) return;
  particles::RopeSet& set = place.out.rope_set;
  const auto made = set.add(def);
  if (!accept(place, made.ok() ? core::Status{} : core::Status{made.error()}, o)) return;
  const int rope = named.thing = *made;
  const int last = int(set.positions(rope).size()) - 1;
  each_entry(r, o, "attachments", rope_attachment_kind, [&](const Object& a) {
    particles::RopeAttachment attachment;
    if (!a.has("node") && !a.has("anchor"))
      return r.fail(*a.node, a.path, "an attachment has a \"node\", an \"anchor\", or both");
    Vec3d anchor = r.vector(a, "anchor");
    attachment.node = a.has("node") ? r.integer(a, "node", -1, -1, last) : nearest(set.positions(rope), anchor);
    if (r.failed()) return;
    const int node = attachment.node < 0 ? last : attachment.node;
    if (!a.has("anchor")) anchor = set.positions(rope)[std::size_t(node)];
    attachment.body = body_of(place, a);
    attachment.point = in_body(place, attachment.body, anchor);
    attachment.clamped = r.flag(a, "clamped", false);
    attachment.collide = r.flag(a, "collide", false);
    accept(place, set.attach(rope, attachment, place.world), a);
  });
  each_entry(r, o, "winches", rope_winch_kind, [&](const Object& w) {
    accept(place, set.set_winch(rope, r.integer(w, "end", 1, 0, 1), r.number(w, "speed", 0)), w);
  });
  each_entry(r, o, "masses", rope_lump_kind, [&](const Object& m) {
    const int node = r.integer(m, "node", -1, -1, last);
    accept(place, set.add_mass(rope, node < 0 ? last : node, r.number(m, "mass", 0)), m);
  });
  if (o.has("twist")) accept(place, set.set_twist(rope, r.number(o, "twist", 0)), o);
  if (o.has("substeps")) {
    place.out.rope_substeps = math::max(place.out.rope_substeps, r.integer(o, "substeps", 8, 1, 256));
    if (!accept(place, set.set_substeps(place.out.rope_substeps), o)) return;
  }
  place.out.ropes.push_back(std::move(named));
}

void read_cloth(Place& place, const Object& o) {
  Reader& r = place.reader;
  particles::ClothDef def;
  def.fabric = read_fabric(r, o);
  particles::ClothSheet sheet;
  int columns = 0;
  if (o.has("points") == o.has("corner"))
    return r.fail(*o.node, o.path, "a cloth has \"points\" and \"triangles\", or \"corner\", \"along\" and \"across\"");
  def.warp = o.has("warp") ? r.vector(o, "warp") : r.vector(o, "along", def.warp);
  if (o.has("points")) {
    sheet.points = r.points(o, "points");
    sheet.triangles = read_indices(r, o, "triangles");
  } else {
    columns = r.integer(o, "columns", 21, 2, 2000);
    const int rows = r.integer(o, "rows", 21, 2, 2000);
    if (!o.has("along") || !o.has("across")) r.fail(*o.node, o.path, "a sheet has \"along\" and \"across\"");
    if (!spend(r, place.budget, double(columns) * rows, o)) return;
    sheet =
        particles::make_cloth_sheet(r.vector(o, "corner"), r.vector(o, "along"), r.vector(o, "across"), columns, rows);
  }
  def.points = sheet.points;
  def.triangles = sheet.triangles;
  def.velocity = r.vector(o, "velocity");
  def.collide = r.flag(o, "collide", true);
  def.self_collide = r.flag(o, "self_collide", true);
  def.self_collide_edges = r.flag(o, "self_collide_edges", false);
  def.filter = read_matter_filter(r, o);
  std::string name;
  std::uint32_t color = 0xd1495b;
  if (!name_thing(r, o, "cloth", place.out.cloths, name, color)) return;
  auto cloth = particles::Cloth::make(def);
  if (!accept(place, cloth.ok() ? core::Status{} : core::Status{cloth.error()}, o)) return;
  read_pins(place, o, *cloth, columns);
  if (o.has("substeps")) accept(place, cloth->set_substeps(r.integer(o, "substeps", 1, 1, 64)), o);
  if (!r.failed()) place.out.cloths.push_back({std::move(name), color, std::move(*cloth)});
}

void read_soft_body(Place& place, const Object& o) {
  Reader& r = place.reader;
  particles::SoftBodyDef def;
  particles::SoftMaterial& m = def.material;
  m.density = r.number(o, "density", m.density);
  m.youngs_modulus = r.number(o, "youngs_modulus", m.youngs_modulus);
  m.poisson_ratio = r.number(o, "poisson_ratio", m.poisson_ratio);
  m.damping = r.number(o, "damping", m.damping);
  m.friction = r.number(o, "friction", m.friction);
  m.skin = r.number(o, "skin", m.skin);
  if (o.has("points") + o.has("corner") + o.has("center") != 1)
    return r.fail(
        *o.node, o.path,
        "a soft body has \"points\" and \"tetrahedra\", \"corner\" and \"size\", or \"center\" and \"radius\"");
  particles::SoftMesh mesh;
  int cells[3] = {8, 8, 8};
  if (const Node* node = o.find("cells")) {
    const bool three = node->is_array() && node->children.size() == 3;
    if (three != o.has("corner"))
      return r.expected(*node, o.path_of("cells"), "three numbers for a box, one for a ball");
    for (std::size_t k = 0; k < (three ? 3u : 1u); ++k) {
      const double n = r.value(three ? node->children[k] : *node, o.path_of("cells"), Measure::plain);
      if (!(n >= 1 && n <= 1000 && n == __builtin_floor(n)))
        return r.expected(*node, o.path_of("cells"), "whole numbers from 1 to 1000");
      cells[k] = int(n);
    }
    if (!three) cells[1] = cells[2] = cells[0];
  }
  if (o.has("points")) {
    mesh.points = r.points(o, "points");
    mesh.tetrahedra = read_indices(r, o, "tetrahedra");
  } else {
    if (!spend(r, place.budget, (cells[0] + 1.0) * (cells[1] + 1.0) * (cells[2] + 1.0), o)) return;
    mesh = o.has("corner") ? particles::make_soft_box(r.vector(o, "corner"), r.vector(o, "size", {1, 1, 1}), cells[0],
                                                      cells[1], cells[2])
                           : particles::make_soft_ball(r.vector(o, "center"), r.number(o, "radius", 0.5), cells[0]);
  }
  def.points = mesh.points;
  def.tetrahedra = mesh.tetrahedra;
  def.velocity = r.vector(o, "velocity");
  def.collide = r.flag(o, "collide", true);
  def.filter = read_matter_filter(r, o);
  std::string name;
  std::uint32_t color = 0x6aa84f;
  if (!name_thing(r, o, "soft_body", place.out.soft_bodies, name, color)) return;
  auto body = particles::SoftBody::make(def);
  if (!accept(place, body.ok() ? core::Status{} : core::Status{body.error()}, o)) return;
  read_pins(place, o, *body, 0);
  if (o.has("substeps")) accept(place, body->set_substeps(r.integer(o, "substeps", 1, 1, 64)), o);
  if (o.has("pressure")) accept(place, body->set_pressure(r.number(o, "pressure", 0)), o);
  if (!r.failed()) place.out.soft_bodies.push_back({std::move(name), color, std::move(*body)});
}

}  // namespace carom::scene::detail
