// World's members about shapes.
#pragma once

#include "carom/geometry/hull.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/check.h"

namespace carom::rigid {
namespace detail {

template <class D>
Result<std::int32_t> slot_of(const WorldImplementation<D>& world, std::string_view call, ShapeId shape) {
  const Status status = world.shapes.slots.check(shape, "shape");
  if (!status.ok()) return core::Error{core::text("World::", call, ": ", status.error().message)};
  return std::int32_t(world.shapes.slots.slot(shape));
}

/// The half thickness and the farthest point from the shape's origin.
struct Extents {
  float inner = 0, outer = 0;
};
template <class V>
float farthest(const geometry::Bounds<V>& b) {
  return math::length(math::max(math::abs(b.low), math::abs(b.high)));
}
inline Extents extents_of(const geometry::Shape2& s) {
  Extents e;
  const geometry::Bounds2f b = geometry::bounds(s, {});
  e.outer = farthest(b);
  switch (s.type) {
    case geometry::ShapeType2::circle:
      e.inner = s.circle.radius;
      break;
    case geometry::ShapeType2::capsule:
      e.inner = s.capsule.radius;
      break;
    case geometry::ShapeType2::polygon: {
      e.inner = 1e30f;
      for (int i = 0; i < s.polygon.count; ++i)
        e.inner = min(e.inner, dot(s.polygon.normals[i], s.polygon.vertices[i] - s.polygon.centroid));
      e.inner += s.polygon.radius;
      break;
    }
    default:
      e.inner = e.outer;
      break;
  }
  return e;
}
inline Extents extents_of(const geometry::Shape3& s) {
  Extents e;
  switch (s.type) {
    case geometry::ShapeType3::plane:
      return {1e6f, 1e6f};
    case geometry::ShapeType3::sphere:
      return {s.sphere.radius, s.sphere.radius};
    case geometry::ShapeType3::capsule:
      return {s.capsule.radius, s.capsule.radius + s.capsule.half_length};
    default:
      break;
  }
  const geometry::Bounds3f b = geometry::bounds(s, {});
  e.outer = farthest(b);
  const Vec3f half = b.extents();
  e.inner = min(half.x, min(half.y, half.z));
  if (s.type == geometry::ShapeType3::ellipsoid) e.outer = max(half.x, max(half.y, half.z));
  if (s.type == geometry::ShapeType3::hull) e.inner = s.hull->inner_radius + s.hull->radius;
  if (s.type == geometry::ShapeType3::cone) e.inner = 0.4f * min(s.cone.radius, s.cone.half_height) + s.cone.rounding;
  if (geometry::is_surface(s)) e.inner = e.outer;
  return e;
}
inline bool is_round(const geometry::Shape2& s) { return s.type == geometry::ShapeType2::circle; }
inline bool is_round(const geometry::Shape3& s) {
  return s.type == geometry::ShapeType3::sphere || s.type == geometry::ShapeType3::ellipsoid;
}
inline bool is_many(const geometry::Shape2& s) { return s.type == geometry::ShapeType2::chain; }
inline bool is_many(const geometry::Shape3& s) { return s.type >= geometry::ShapeType3::mesh; }
/// What is wrong with the shape on a body that forces move: planes, height fields and chains have no inside, and a mesh
/// with a density must be closed, so that it has a mass.
inline Status check_dynamic(const geometry::Shape2& s, float) {
  if (s.type < geometry::ShapeType2::chain_segment) return {};
  return core::Error{"the shape is a surface without inside, expected one that a dynamic body can have"};
}
inline Status check_dynamic(const geometry::Shape3& s, float density) {
  if (s.type == geometry::ShapeType3::plane || (geometry::is_surface(s) && s.type != geometry::ShapeType3::mesh))
    return core::Error{"the shape is a surface without inside, expected one that a dynamic body can have"};
  if (s.type != geometry::ShapeType3::mesh || !(density > 0)) return {};
  const std::vector<Vec3d> vertices(s.mesh->vertices.begin(), s.mesh->vertices.end());
  const auto mass = geometry::mesh_mass_properties(vertices, s.mesh->indices, double(density));
  if (mass.ok()) return {};
  return core::Error{
      core::text("a mesh on a dynamic body must be closed, or of density 0 on a body whose mass is "
                 "given: ",
                 mass.error().message)};
}
/// Half the mean thickness of a moving mesh: a plate of thickness t has V/A = t/2.
inline bool is_mesh(const geometry::Shape2&) { return false; }
inline bool is_mesh(const geometry::Shape3& s) { return s.type == geometry::ShapeType3::mesh; }
inline float mesh_thickness(const geometry::Shape2&) { return 0; }
inline float mesh_thickness(const geometry::Shape3& s) {
  double volume = 0, area = 0;
  for (std::size_t i = 0; i + 2 < s.mesh->indices.size(); i += 3) {
    const Vec3d a(s.mesh->vertices[s.mesh->indices[i]]), b(s.mesh->vertices[s.mesh->indices[i + 1]]),
        c(s.mesh->vertices[s.mesh->indices[i + 2]]);
    volume += dot(a, cross(b, c)) / 6;
    area += math::length(cross(b - a, c - a)) / 2;
  }
  const Vec3f half = s.mesh->bounds.extents();
  const float least = min(half.x, min(half.y, half.z));
  return volume > 0 && area > 0 ? min(least, float(volume / area)) : least;
}
/// Surfaces do not collide with each other, and it would go unnoticed: a shape of another body that this one, on a body
/// of this type, would have to meet and cannot. `none` where there is no such shape.
template <class D>
std::int32_t clashing_surface(const WorldImplementation<D>& world, std::int32_t body, BodyType type,
                              const typename D::Shape& geometry, const Filter& filter) {
  if (!is_surface(geometry) || (type != BodyType::dynamic && world.shapes.moving_surfaces == 0)) return none;
  for (std::size_t i = 0; i < world.shapes.record.size(); ++i) {
    const ShapeRecord<D>& other = world.shapes.record[i];
    if (other.body == none || other.body == body || !is_surface(other.geometry) || (other.flags & shape_sensor) != 0)
      continue;
    if (type != BodyType::dynamic && !world.bodies.is_dynamic(other.body)) continue;
    const Filter& its = world.shapes.terms_of(other).filter;
    const bool grouped = filter.group != 0 && filter.group == its.group;
    if (grouped ? filter.group > 0 : (filter.category & its.mask) != 0 && (its.category & filter.mask) != 0)
      return std::int32_t(i);
  }
  return none;
}
inline std::string clash_message(std::int32_t other) {
  return core::text("the shape and shape #", other + 1,
                    " are meshes or terrain, which do not collide with each other, expected filters that keep "
                    "them apart, or convex parts (geometry/decomposition.h) on the one that moves");
}

/// Contacts hold a copy of what they need of the shape: make them anew.
template <class D>
void renew_contacts(WorldImplementation<D>& world, std::int32_t shape) {
  destroy_contacts_of_shape(world, shape);
  ShapeRecord<D>& s = world.shapes.at(shape);
  if (s.leaf != none && (s.flags & shape_moved) == 0) {
    s.flags |= shape_moved;
    world.scratch.moved.push_back(shape);
  }
}

/// Unit, or zero for solid.
template <class D>
typename D::Vector one_way_direction(const typename D::Vector& v) {
  const float length = math::length(v);
  return length > 0 ? v * (1 / length) : v;
}
/// Gives the shape what few have, and tells its contacts.
template <class D>
void change_extra(WorldImplementation<D>& world, const ShapeExtra<D>& extra) {
  world.shapes.set_extra(extra);
  const std::int32_t body = world.shapes.at(extra.shape).body;
  wake_body(world, body);
  wake_touching(world, body);
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;
       key = world.contacts.at(key >> 1).next[key & 1]) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    if (c.shape[key & 1] != extra.shape) continue;
    update_contact_flags(world, key >> 1);
    for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
      world.contacts.manifold(m).disabled = false;
      mix_materials(world, m);
    }
  }
}
template <class D>
ShapeExtra<D> extra_of(const WorldImplementation<D>& world, std::int32_t shape) {
  const ShapeExtra<D>* known = world.shapes.extra(shape);
  return known != nullptr ? *known : ShapeExtra<D>{shape};
}
template <class D>
void check_surface(Complaint& complaint, std::size_t index, const SurfaceMaterial<D>& surface) {
  const std::string name = "surfaces[" + std::to_string(index) + "]";
  check_material(complaint, name + ".material", surface.material);
  check_size(complaint, name + ".surface_velocity", surface.surface_velocity, max_velocity);
}
template <class D>
void update_collider_flag(WorldImplementation<D>& world, std::int32_t body) {
  BodyRecord& r = world.bodies.record[std::size_t(body)];
  r.flags &= std::uint16_t(~body_has_collider);
  for (std::int32_t s = r.first_shape; s != none; s = world.shapes.at(s).next)
    if ((world.shapes.at(s).flags & shape_sensor) == 0) r.flags |= body_has_collider;
}

}  // namespace detail

template <class D>
Result<ShapeId> World<D>::add_shape(BodyId body, const Shape& shape, const ShapeDef<D>& d) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "add_shape", body);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::add_shape");
  complaint.status(geometry::validate(shape));
  check_size(complaint, "local.p", d.local.p, max_size);
  complaint.rotation("local.q", d.local.q);
  check_range(complaint, "density", d.density, 0, max_density);
  check_material(complaint, "material", d.material);
  check_size(complaint, "surface_velocity", d.surface_velocity, max_velocity);
  check_size(complaint, "one_way", d.one_way, max_size);
  for (std::size_t i = 0; i < d.surfaces.size(); ++i) check_surface<D>(complaint, i, d.surfaces[i]);
  if (!complaint.none_yet()) return complaint.error();
  if (const int parts = geometry::material_count(shape); !d.surfaces.empty() && parts == 0)
    complaint.say(core::text("surfaces has ", d.surfaces.size(),
                             " entries, expected none: the parts of this geometry are not numbered by material"));
  else if (!d.surfaces.empty() && (std::size_t(parts) > d.surfaces.size() || d.surfaces.size() > 256))
    complaint.say(core::text("surfaces has ", d.surfaces.size(), " entries, expected ", parts,
                             " to 256: the parts of the geometry are numbered up to ", parts - 1));
  const BodyType type = self_->bodies.record[std::size_t(*slot)].type;
  if (type == BodyType::dynamic) complaint.status(check_dynamic(shape, d.density));
  if (const std::int32_t other = clashing_surface(*self_, *slot, type, shape, d.filter); !d.sensor && other != none)
    complaint.say(clash_message(other));
  Extents extents = extents_of(shape);
  if (type != BodyType::fixed && is_mesh(shape)) extents.inner = mesh_thickness(shape);
  if (type == BodyType::dynamic && !(extents.outer <= max_size))
    complaint.say(
        core::refused("size of the shape", extents.outer, core::text("at most ", max_size, " m on a dynamic body")));
  if (complaint.none_yet() && type == BodyType::dynamic && d.density > 0) {
    const double mass = geometry::mass_properties(shape, double(d.density)).mass;
    if (!(mass <= max_body_mass))
      complaint.say(core::refused("mass of the shape", mass, core::text("at most ", max_body_mass, " kg")));
  }
  if (!complaint.none_yet()) return complaint.error();

  const ShapeId id = self_->shapes.slots.allocate();
  const std::int32_t index = self_->shapes.slots.slot(id);
  if (std::size_t(index) == self_->shapes.record.size()) {
    core::grow_a_little(self_->shapes.record);
    self_->shapes.record.emplace_back();
  }
  ShapeRecord<D>& s = self_->shapes.at(index);
  const std::uint8_t moved = s.flags & shape_moved;  // of a former owner of the slot, still in the list
  s = {};
  s.flags = moved;
  s.geometry = shape;
  self_->shapes.geometry_copy.reset();
  s.local = d.local;
  s.local.q = unit_rotation(d.local.q);
  s.at_origin = s.local == typename D::Transform{};
  s.body = *slot;
  self_->shapes.set_terms(index, {d.density, d.material, d.filter});
  give_word(self_->shapes.user_data, index, d.user_data);
  if (d.material.restitution >= least_bounce && self_->shapes.bounce == Bounce::none)
    self_->shapes.bounce = Bounce::unknown;
  s.inner_extent = extents.inner;
  s.outer_extent = extents.outer;
  s.margin = clamp(0.125f * extents.outer, 0.02f, 0.1f);
  if (d.sensor) s.flags |= shape_sensor;
  if (d.contact_events) s.flags |= shape_contact_events;
  if (d.hit_events) {
    s.flags |= shape_hit_events;
    ++self_->hit_event_shapes;
  }
  if (is_many(shape)) s.flags |= shape_many;
  if (is_moving_surface(*self_, index)) ++self_->shapes.moving_surfaces;
  if (is_round(shape)) s.flags |= shape_round;
  // At the end of the body's list: shapes are told in the order in which they were made.
  std::int32_t* link = &self_->bodies.record[std::size_t(*slot)].first_shape;
  while (*link != none) link = &self_->shapes.at(*link).next;
  *link = index;
  // One that was made asleep stays so until something touches it.
  if (self_->bodies.record[std::size_t(*slot)].sleeping_island != none) wake_body(*self_, *slot);
  update_mass(*self_, *slot);
  update_collider_flag(*self_, *slot);
  insert_into_tree(*self_, index);
  std::vector<PartSurface<D>>& surfaces = self_->shapes.surfaces;
  const auto place = std::lower_bound(surfaces.begin(), surfaces.end(), index,
                                      [](const PartSurface<D>& p, std::int32_t i) { return p.shape < i; });
  std::vector<PartSurface<D>> parts;
  for (const SurfaceMaterial<D>& part : d.surfaces) parts.push_back({index, std::int32_t(parts.size()), part});
  surfaces.insert(place, parts.begin(), parts.end());
  self_->shapes.set_extra(
      {index, d.modify_contacts, d.surface_velocity, one_way_direction<D>(d.one_way), std::int32_t(parts.size())});
  return id;
}

template <class D>
Status World<D>::destroy_shape(ShapeId shape) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "destroy_shape", shape);
  if (!slot.ok()) return slot.error();
  ShapeRecord<D>& s = self_->shapes.at(*slot);
  const std::int32_t body = s.body;
  wake_body(*self_, body);
  destroy_contacts_of_shape(*self_, *slot);
  remove_from_tree(*self_, *slot);
  std::int32_t* link = &self_->bodies.record[std::size_t(body)].first_shape;
  while (*link != *slot) link = &self_->shapes.at(*link).next;
  *link = s.next;
  if (s.flags & shape_hit_events) --self_->hit_event_shapes;
  const std::uint8_t moved = s.flags & shape_moved;
  self_->shapes.forget_extra(*slot);
  if (is_moving_surface(*self_, *slot)) --self_->shapes.moving_surfaces;
  s = {};
  self_->shapes.geometry_copy.reset();
  s.flags = moved;
  self_->shapes.slots.release(shape);
  update_mass(*self_, body);
  update_collider_flag(*self_, body);
  return {};
}

template <class D>
bool World<D>::contains(ShapeId shape) const {
  return self_->shapes.slots.contains(shape);
}

template <class D>
Result<BodyId> World<D>::body_of(ShapeId shape) const {
  const Result<std::int32_t> slot = detail::slot_of(*self_, "body_of", shape);
  if (!slot.ok()) return slot.error();
  return self_->bodies.slots.handle_at(self_->shapes.at(*slot).body);
}
template <class D>
Result<typename D::Shape> World<D>::shape_geometry(ShapeId shape) const {
  const Result<std::int32_t> slot = detail::slot_of(*self_, "shape_geometry", shape);
  if (!slot.ok()) return slot.error();
  return self_->shapes.at(*slot).geometry;
}
template <class D>
Result<ShapeDef<D>> World<D>::shape_definition(ShapeId shape) const {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "shape_definition", shape);
  if (!slot.ok()) return slot.error();
  const ShapeRecord<D>& s = self_->shapes.at(*slot);
  ShapeDef<D> d;
  d.local = s.local;
  const ShapeTerms& terms = self_->shapes.terms_of(s);
  d.density = terms.density;
  d.material = terms.material;
  d.filter = terms.filter;
  d.sensor = (s.flags & shape_sensor) != 0;
  d.contact_events = (s.flags & shape_contact_events) != 0;
  d.hit_events = (s.flags & shape_hit_events) != 0;
  d.user_data = word_of(self_->shapes.user_data, *slot);
  if (const ShapeExtra<D>* extra = self_->shapes.extra(*slot)) {
    d.surface_velocity = extra->surface_velocity;
    d.one_way = extra->one_way;
    d.modify_contacts = extra->modify;
    for (int i = 0; i < extra->surface_count; ++i)
      d.surfaces.push_back(*self_->shapes.surface(*slot, std::uint32_t(i)));
  }
  return d;
}

template <class D>
Status World<D>::set_material(ShapeId shape, const Material& material) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_material", shape);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_material");
  check_material(complaint, "material", material);
  if (!complaint.none_yet()) return complaint.error();
  ShapeRecord<D>& s = self_->shapes.at(*slot);
  ShapeTerms terms = self_->shapes.terms_of(s);
  terms.material = material;
  self_->shapes.set_terms(*slot, terms);
  self_->shapes.bounce = Bounce::unknown;
  wake_body(*self_, s.body);
  wake_touching(*self_, s.body);
  for (std::int32_t key = self_->bodies.record[std::size_t(s.body)].first_contact; key != none;) {
    ContactRecord<D>& c = self_->contacts.at(key >> 1);
    if (c.shape[key & 1] == *slot) {
      update_contact_flags(*self_, key >> 1);
      for (std::int32_t m = c.first_manifold; m != none; m = self_->contacts.manifold(m).next) mix_materials(*self_, m);
    }
    key = c.next[key & 1];
  }
  return {};
}

template <class D>
Status World<D>::set_density(ShapeId shape, float density) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_density", shape);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_density");
  check_range(complaint, "density", density, 0, max_density);
  if (!complaint.none_yet()) return complaint.error();
  wake_body(*self_, self_->shapes.at(*slot).body);
  ShapeTerms terms = self_->shapes.terms_of(*slot);
  terms.density = density;
  self_->shapes.set_terms(*slot, terms);
  update_mass(*self_, self_->shapes.at(*slot).body);
  return {};
}
template <class D>
Status World<D>::set_surface_velocity(ShapeId shape, Vector velocity) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_surface_velocity", shape);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_surface_velocity");
  check_size(complaint, "velocity", velocity, max_velocity);
  if (!complaint.none_yet()) return complaint.error();
  ShapeExtra<D> extra = extra_of(*self_, *slot);
  extra.surface_velocity = velocity;
  change_extra(*self_, extra);
  return {};
}
template <class D>
Status World<D>::set_surface(ShapeId shape, int index, const SurfaceMaterial<D>& surface) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_surface", shape);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_surface");
  const ShapeExtra<D> extra = extra_of(*self_, *slot);
  if (index < 0 || index >= extra.surface_count)
    complaint.say(
        core::text("index is ", index, ", expected a surface of the shape, of which it has ", extra.surface_count));
  check_surface<D>(complaint, std::size_t(index), surface);
  if (!complaint.none_yet()) return complaint.error();
  self_->shapes.surfaces_of(*slot)[std::size_t(index)].surface = surface;
  change_extra(*self_, extra);
  return {};
}
template <class D>
Status World<D>::set_one_way(ShapeId shape, Vector direction) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_one_way", shape);
  if (!slot.ok()) return slot.error();
  Complaint complaint("World::set_one_way");
  check_size(complaint, "direction", direction, max_size);
  if (!complaint.none_yet()) return complaint.error();
  ShapeExtra<D> extra = extra_of(*self_, *slot);
  extra.one_way = one_way_direction<D>(direction);
  change_extra(*self_, extra);
  return {};
}
template <class D>
Status World<D>::set_modify_contacts(ShapeId shape, bool modify) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_modify_contacts", shape);
  if (!slot.ok()) return slot.error();
  ShapeExtra<D> extra = extra_of(*self_, *slot);
  extra.modify = modify;
  change_extra(*self_, extra);
  return {};
}

template <class D>
Status World<D>::set_filter(ShapeId shape, const Filter& filter) {
  using namespace detail;
  const Result<std::int32_t> slot = slot_of(*self_, "set_filter", shape);
  if (!slot.ok()) return slot.error();
  const ShapeRecord<D>& s = self_->shapes.at(*slot);
  const BodyType type = self_->bodies.record[std::size_t(s.body)].type;
  if (const std::int32_t other = clashing_surface(*self_, s.body, type, s.geometry, filter);
      (s.flags & shape_sensor) == 0 && other != none)
    return core::Error{core::text("World::set_filter: ", clash_message(other))};
  ShapeTerms terms = self_->shapes.terms_of(s);
  terms.filter = filter;
  self_->shapes.set_terms(*slot, terms);
  wake_body(*self_, self_->shapes.at(*slot).body);
  renew_contacts(*self_, *slot);
  return {};
}

}  // namespace carom::rigid
