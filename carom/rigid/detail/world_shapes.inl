// World's members about shapes.
#pragma once

#include "carom/geometry/hull.h"
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
  if (s.type == geometry::ShapeType3::hull) e.inner = s.hull->inner_radius + s.hull->radius;
  if (s.type == geometry::ShapeType3::cone) e.inner = 0.4f * min(s.cone.radius, s.cone.half_height);
  if (s.type == geometry::ShapeType3::mesh || s.type == geometry::ShapeType3::height_field) e.inner = e.outer;
  return e;
}
inline bool is_round(const geometry::Shape2& s) { return s.type == geometry::ShapeType2::circle; }
inline bool is_round(const geometry::Shape3& s) { return s.type == geometry::ShapeType3::sphere; }
inline bool is_many(const geometry::Shape2& s) { return s.type == geometry::ShapeType2::chain; }
inline bool is_many(const geometry::Shape3& s) { return s.type >= geometry::ShapeType3::mesh; }
/// Planes, meshes, height fields and chains have no inside that could move.
inline bool surface_only(const geometry::Shape2& s) { return s.type >= geometry::ShapeType2::chain_segment; }
inline bool surface_only(const geometry::Shape3& s) {
  return s.type == geometry::ShapeType3::plane || s.type == geometry::ShapeType3::mesh ||
         s.type == geometry::ShapeType3::height_field;
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
  if (!complaint.none_yet()) return complaint.error();
  const BodyType type = self_->bodies.record[std::size_t(*slot)].type;
  if (type == BodyType::dynamic && surface_only(shape))
    complaint.say("the shape is a surface without inside, expected one that a dynamic body can have");
  const Extents extents = extents_of(shape);
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
    grow_by_a_quarter(self_->shapes.record);
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
  s.density = d.density;
  s.material = d.material;
  s.filter = d.filter;
  s.user_data = d.user_data;
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
  self_->shapes.set_extra({index, d.modify_contacts, d.surface_velocity, one_way_direction<D>(d.one_way)});
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
  self_->shapes.set_extra({*slot});
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
  d.density = s.density;
  d.material = s.material;
  d.filter = s.filter;
  d.sensor = (s.flags & shape_sensor) != 0;
  d.contact_events = (s.flags & shape_contact_events) != 0;
  d.hit_events = (s.flags & shape_hit_events) != 0;
  d.user_data = s.user_data;
  if (const ShapeExtra<D>* extra = self_->shapes.extra(*slot)) {
    d.surface_velocity = extra->surface_velocity;
    d.one_way = extra->one_way;
    d.modify_contacts = extra->modify;
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
  s.material = material;
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
  self_->shapes.at(*slot).density = density;
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
  self_->shapes.at(*slot).filter = filter;
  wake_body(*self_, self_->shapes.at(*slot).body);
  renew_contacts(*self_, *slot);
  return {};
}

}  // namespace carom::rigid
