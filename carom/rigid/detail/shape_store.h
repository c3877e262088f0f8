// Shapes by slot.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "carom/core/hash.h"
#include "carom/core/pool.h"
#include "carom/geometry/dynamic_tree.h"
#include "carom/geometry/hull.h"
#include "carom/rigid/detail/body_store.h"
#include "carom/rigid/detail/shared_values.h"

namespace carom::rigid::detail {

enum ShapeFlag : std::uint8_t {
  shape_sensor = 1,
  shape_contact_events = 2,
  shape_hit_events = 4,
  shape_many = 8,       ///< collides with several manifolds
  shape_moved = 16,     ///< its fat bounds changed: look for new pairs
  shape_round = 32,     ///< a sphere, ellipsoid or circle
  shape_outgrown = 64,  ///< left its fat bounds in this step
  shape_special = 128,  ///< has a ShapeExtra
};

/// The tree in which a shape is: after its body's type.
enum TreeIndex : std::int8_t { tree_fixed = 0, tree_kinematic = 1, tree_dynamic = 2, tree_none = -1 };

/// What shapes mostly have in common.
struct ShapeTerms {
  float density = 0;  ///< kg/m³ or kg/m²
  Material material{};
  Filter filter{};
  std::uint64_t hash() const {
    core::StateHash h;
    h.add(density).add(material.friction).add(material.restitution).add(material.rolling_resistance);
    h.add(material.spinning_resistance)
        .add(material.tangent_speed)
        .add(material.user_id)
        .add(filter.category)
        .add(filter.mask)
        .add(filter.group);
    return h.digest();
  }
  friend bool operator==(const ShapeTerms&, const ShapeTerms&) = default;
};

/// All of a shape but its geometry: plain bytes, which a snapshot copies.
template <class D>
struct ShapeTraits {
  typename D::Transform local{};  ///< shape → body
  std::int32_t body = none;
  std::int32_t next = none;      ///< of the same body, in order of creation
  std::int32_t leaf = none;      ///< in the tree
  std::int8_t tree = tree_none;  ///< TreeIndex
  std::uint8_t flags = 0;        ///< ShapeFlag
  bool at_origin = true;         ///< local is the identity
  float outer_extent = 0;        ///< m: farthest point from the origin of its own frame
  float inner_extent = 0;        ///< m: half its smallest thickness
  float margin = 0;              ///< m by which fat bounds exceed the tight ones
  std::int32_t terms = none;     ///< number in ShapeStore::terms
};

template <class D>
struct ShapeRecord : ShapeTraits<D> {
  typename D::Shape geometry{};  ///< never changes while the shape lives
};

/// A ball about a shape, in the shape's frame: how it moves is told by its middle and its turn about that. A hull or a
/// polygon may lie far from the origin of its frame (the logs of a trunk).
template <class D>
struct ShapeBall {
  typename D::Vector middle{};
  float radius = 0;
};
inline ShapeBall<Dim2> ball_about(const ShapeRecord<Dim2>& shape) {
  if (shape.geometry.type != geometry::ShapeType2::polygon) return {{}, shape.outer_extent};
  const geometry::Polygon& polygon = shape.geometry.polygon;
  float most = 0;
  for (int i = 0; i < polygon.count; ++i)
    most = max(most, math::distance_squared(polygon.vertices[i], polygon.centroid));
  return {polygon.centroid, math::sqrt(most) + polygon.radius};
}
inline ShapeBall<Dim3> ball_about(const ShapeRecord<Dim3>& shape) {
  if (shape.geometry.type != geometry::ShapeType3::hull) return {{}, shape.outer_extent};
  const geometry::Hull& hull = *shape.geometry.hull;
  return {hull.bounds.center(), math::length(hull.bounds.extents()) + hull.radius};
}

/// What few shapes have.
template <class D>
struct ShapeExtra {
  std::int32_t shape = none;
  bool modify = false;                    ///< the contact modifier is asked
  typename D::Vector surface_velocity{};  ///< m/s, shape frame
  typename D::Vector one_way{};           ///< unit or zero, shape frame
  std::int32_t surface_count = 0;         ///< entries in ShapeStore::surfaces

  bool any() const {
    return modify || !(surface_velocity == typename D::Vector{}) || !(one_way == typename D::Vector{}) ||
           surface_count > 0;
  }
};

/// From this restitution on contacts are foreseen as far as their bodies go in a step, so that a blow falls at the
/// surface, with the energy a body has there. Of what keeps less than 4 % of that energy, none would be seen.
inline constexpr float least_bounce = 0.2f;
/// Whether anything in a world rebounds with it.
enum class Bounce : std::uint8_t { unknown, none, some };

/// What a material number of a shape's parts stands for.
template <class D>
struct PartSurface {
  std::int32_t shape = none, number = 0;
  SurfaceMaterial<D> surface{};
};

template <class D>
struct ShapeStore {
  core::SlotPool<ShapeTag> slots;
  std::vector<ShapeRecord<D>> record;                    ///< by slot
  SharedValues<ShapeTerms> terms;                        ///< density, material and filter of `record`
  std::vector<std::uint64_t> user_data;                  ///< by slot, as far as one was given
  std::vector<ShapeExtra<D>> extras;                     ///< in the order of their slots
  std::vector<PartSurface<D>> surfaces;                  ///< in the order of their slots and numbers
  std::int32_t moving_surfaces = 0;                      ///< meshes on bodies that are not fixed
  Bounce bounce = Bounce::unknown;                       ///< follows from materials, rules and modifiers: learn_bounce
  geometry::DynamicTree<typename D::Position> trees[3];  ///< items are slots of shapes
  std::vector<typename D::Shape> originals;              ///< geometries of which the world changed a copy
  /// Of all records, shared with the snapshots that were taken since a shape last came or went; else null.
  std::shared_ptr<const std::vector<typename D::Shape>> geometry_copy;

  explicit ShapeStore(std::uint16_t world) : slots(world) {}
  ShapeRecord<D>& at(std::int32_t slot) { return record[std::size_t(slot)]; }
  const ShapeRecord<D>& at(std::int32_t slot) const { return record[std::size_t(slot)]; }
  const ShapeTerms& terms_of(const ShapeRecord<D>& shape) const { return terms[shape.terms]; }
  const ShapeTerms& terms_of(std::int32_t slot) const { return terms[at(slot).terms]; }
  void set_terms(std::int32_t slot, const ShapeTerms& value) {
    const std::int32_t old = at(slot).terms;
    at(slot).terms = terms.take(value);
    if (old != none) terms.drop(old);
  }
  /// Null for ordinary shapes.
  const ShapeExtra<D>* extra(std::int32_t slot) const {
    if ((at(slot).flags & shape_special) == 0) return nullptr;
    const auto i = std::lower_bound(extras.begin(), extras.end(), slot,
                                    [](const ShapeExtra<D>& e, std::int32_t s) { return e.shape < s; });
    return i != extras.end() && i->shape == slot ? &*i : nullptr;
  }
  /// The entries of a shape.
  std::span<PartSurface<D>> surfaces_of(std::int32_t slot) {
    const auto first = std::lower_bound(surfaces.begin(), surfaces.end(), slot,
                                        [](const PartSurface<D>& p, std::int32_t s) { return p.shape < s; });
    auto last = first;
    while (last != surfaces.end() && last->shape == slot) ++last;
    return {first, last};
  }
  /// Null where all parts are of the shape's own material.
  const SurfaceMaterial<D>* surface(std::int32_t slot, std::uint32_t number) const {
    const ShapeExtra<D>* e = extra(slot);
    if (e == nullptr || number >= std::uint32_t(e->surface_count)) return nullptr;
    const auto first = std::lower_bound(surfaces.begin(), surfaces.end(), slot,
                                        [](const PartSurface<D>& p, std::int32_t s) { return p.shape < s; });
    return &(first + std::ptrdiff_t(number))->surface;
  }
  /// Before the slot is given to another.
  void forget_extra(std::int32_t slot) {
    if (terms_of(slot).material.restitution >= least_bounce) bounce = Bounce::unknown;
    terms.drop(at(slot).terms);
    at(slot).terms = none;
    give_word(user_data, slot, 0);
    if (const ShapeExtra<D>* e = extra(slot); e != nullptr && e->surface_count > 0)
      std::erase_if(surfaces, [&](const PartSurface<D>& p) { return p.shape == slot; });
    set_extra({slot});
  }
  void set_extra(const ShapeExtra<D>& extra) {
    const auto i = std::lower_bound(extras.begin(), extras.end(), extra.shape,
                                    [](const ShapeExtra<D>& e, std::int32_t s) { return e.shape < s; });
    const bool known = i != extras.end() && i->shape == extra.shape;
    ShapeRecord<D>& shape = at(extra.shape);
    if (extra.any() || known) bounce = Bounce::unknown;
    shape.flags = std::uint8_t(extra.any() ? shape.flags | shape_special : shape.flags & ~shape_special);
    if (extra.any() && known)
      *i = extra;
    else if (extra.any())
      extras.insert(i, extra);
    else if (known)
      extras.erase(i);
  }
};

}  // namespace carom::rigid::detail
