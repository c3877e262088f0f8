// World's members that look without touching. Everything near a shape is computed in the shape's own frame, in float,
// from differences taken in double.
#pragma once

#include <algorithm>

#include "carom/geometry/query.h"
#include "carom/rigid/detail/contacts.h"
#include "carom/rigid/detail/joint_check.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid {
namespace detail {

template <class D>
bool query_sees(const ShapeRecord<D>& shape, const QueryFilter& filter) {
  return (shape.flags & shape_sensor) == 0 && (shape.filter.category & filter.mask) != 0 &&
         (filter.category & shape.filter.mask) != 0;
}
template <class D>
typename D::Bounds world_bounds(const typename D::Shape& shape, const typename D::Pose& pose) {
  using Position = typename D::Position;
  const auto local = geometry::bounds(shape, typename D::Transform{{}, pose.rotation});
  return {pose.position + Position(local.low), pose.position + Position(local.high)};
}
template <class D>
RayHit<D> world_hit(const WorldImplementation<D>& world, std::int32_t slot, const typename D::Pose& pose,
                    const geometry::CastHit<typename D::Vector>& hit) {
  return {world.shapes.slots.handle_at(slot), world_point(pose, hit.point), rotate(pose.rotation, hit.normal),
          hit.fraction, hit.child};
}
/// Nearer, or equally near and older in its slot: one answer, whatever the tree looks like.
inline bool is_nearer(float fraction, std::int32_t slot, float best, std::int32_t best_slot) {
  return fraction < best || (fraction == best && (best_slot == none || slot < best_slot));
}

template <class D>
Status check_query(std::string_view call, const typename D::Position& origin, const typename D::Vector& translation) {
  Complaint complaint(call);
  complaint.vector("origin", origin);
  complaint.vector("translation", translation);
  if (!complaint.none_yet()) return complaint.error();
  return {};
}
inline bool can_be_cast(const geometry::Shape2& shape) {
  return shape.type != geometry::ShapeType2::chain && shape.type != geometry::ShapeType2::chain_segment;
}
inline bool can_be_cast(const geometry::Shape3& shape) { return geometry::is_convex(shape); }

template <class D>
Status check_query_shape(std::string_view call, const typename D::Shape& shape, const typename D::Pose& pose) {
  Complaint complaint(call);
  complaint.status(geometry::validate(shape));
  if (!can_be_cast(shape)) complaint.say("shape is not convex, expected a convex shape");
  complaint.vector("pose.position", pose.position);
  complaint.rotation("pose.rotation", pose.rotation);
  if (!complaint.none_yet()) return complaint.error();
  return {};
}

}  // namespace detail

template <class D>
Result<RayHit<D>> World<D>::ray_cast(Position origin, Vector translation, QueryFilter filter) const {
  if (const Status s = detail::check_query<D>("World::ray_cast", origin, translation); !s.ok()) return s.error();
  RayHit<D> best;
  std::int32_t best_slot = detail::none;
  for (const auto& tree : self_->shapes.trees) {
    tree.cast(origin, Position(translation), Position{}, [&](std::uint32_t item, auto limit) {
      const auto& shape = self_->shapes.at(std::int32_t(item));
      if (!detail::query_sees<D>(shape, filter)) return limit;
      const Pose pose = detail::shape_pose<D>(*self_, shape);
      const auto hit =
          geometry::ray_cast(shape.geometry, local_point(pose, origin), inverse_rotate(pose.rotation, translation));
      if (hit.hit && detail::is_nearer(hit.fraction, std::int32_t(item), best.fraction, best_slot)) {
        best = detail::world_hit<D>(*self_, std::int32_t(item), pose, hit);
        best_slot = std::int32_t(item);
      }
      return decltype(limit)(min(double(best.fraction), double(limit)));
    });
  }
  return best;
}

template <class D>
Status World<D>::ray_cast_all(Position origin, Vector translation, std::vector<RayHit<D>>& hits,
                              QueryFilter filter) const {
  if (const Status s = detail::check_query<D>("World::ray_cast_all", origin, translation); !s.ok()) return s;
  hits.clear();
  for (const auto& tree : self_->shapes.trees) {
    tree.cast(origin, Position(translation), Position{}, [&](std::uint32_t item, auto limit) {
      const auto& shape = self_->shapes.at(std::int32_t(item));
      if (!detail::query_sees<D>(shape, filter)) return limit;
      const Pose pose = detail::shape_pose<D>(*self_, shape);
      const auto hit =
          geometry::ray_cast(shape.geometry, local_point(pose, origin), inverse_rotate(pose.rotation, translation));
      if (hit.hit) hits.push_back(detail::world_hit<D>(*self_, std::int32_t(item), pose, hit));
      return limit;
    });
  }
  std::sort(hits.begin(), hits.end(), [](const RayHit<D>& a, const RayHit<D>& b) {
    return a.fraction != b.fraction ? a.fraction < b.fraction : a.shape.index < b.shape.index;
  });
  return {};
}

template <class D>
Result<RayHit<D>> World<D>::shape_cast(const Shape& moving, const Pose& pose, Vector translation,
                                       QueryFilter filter) const {
  constexpr std::string_view call = "World::shape_cast";
  if (const Status s = detail::check_query_shape<D>(call, moving, pose); !s.ok()) return s.error();
  if (const Status s = detail::check_query<D>(call, pose.position, translation); !s.ok()) return s.error();
  const typename D::Bounds box = detail::world_bounds<D>(moving, pose);
  RayHit<D> best;
  std::int32_t best_slot = detail::none;
  for (const auto& tree : self_->shapes.trees) {
    tree.cast(box.center(), Position(translation), box.extents(), [&](std::uint32_t item, auto limit) {
      const auto& shape = self_->shapes.at(std::int32_t(item));
      if (!detail::query_sees<D>(shape, filter)) return limit;
      const Pose placed = detail::shape_pose<D>(*self_, shape);
      const auto hit = geometry::shape_cast(shape.geometry, moving, relative(placed, pose),
                                            inverse_rotate(placed.rotation, translation));
      if (hit.hit && detail::is_nearer(hit.fraction, std::int32_t(item), best.fraction, best_slot)) {
        best = detail::world_hit<D>(*self_, std::int32_t(item), placed, hit);
        best_slot = std::int32_t(item);
      }
      return decltype(limit)(min(double(best.fraction), double(limit)));
    });
  }
  return best;
}

template <class D>
Status World<D>::overlap(const Shape& probe, const Pose& pose, std::vector<ShapeId>& found, QueryFilter filter) const {
  if (const Status s = detail::check_query_shape<D>("World::overlap", probe, pose); !s.ok()) return s;
  found.clear();
  const typename D::Bounds box = detail::world_bounds<D>(probe, pose);
  for (const auto& tree : self_->shapes.trees) {
    tree.query(box, [&](std::uint32_t item) {
      const auto& shape = self_->shapes.at(std::int32_t(item));
      if (detail::query_sees<D>(shape, filter) &&
          geometry::overlap(shape.geometry, probe, relative(detail::shape_pose<D>(*self_, shape), pose)))
        found.push_back(self_->shapes.slots.handle_at(int(item)));
      return true;
    });
  }
  std::sort(found.begin(), found.end(), [](ShapeId a, ShapeId b) { return a.index < b.index; });
  return {};
}

template <class D>
Status World<D>::overlap_bounds(const typename D::Bounds& bounds, std::vector<ShapeId>& found,
                                QueryFilter filter) const {
  detail::Complaint complaint("World::overlap_bounds");
  complaint.vector("bounds.low", bounds.low);
  complaint.vector("bounds.high", bounds.high);
  if (complaint.none_yet() && !(min(bounds.low, bounds.high) == bounds.low))
    complaint.say("bounds.low is above bounds.high, expected low ≤ high in every component");
  if (!complaint.none_yet()) return complaint.error();
  found.clear();
  for (const auto& tree : self_->shapes.trees) {
    tree.query(bounds, [&](std::uint32_t item) {
      const auto& shape = self_->shapes.at(std::int32_t(item));
      if (detail::query_sees<D>(shape, filter) &&
          overlaps(detail::world_bounds<D>(shape.geometry, detail::shape_pose<D>(*self_, shape)), bounds))
        found.push_back(self_->shapes.slots.handle_at(int(item)));
      return true;
    });
  }
  std::sort(found.begin(), found.end(), [](ShapeId a, ShapeId b) { return a.index < b.index; });
  return {};
}

}  // namespace carom::rigid
