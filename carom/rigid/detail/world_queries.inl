// World's members that look without touching. Everything near a shape is computed in the shape's own frame, in float,
// from differences taken in double.
#pragma once

#include <algorithm>

#include "carom/geometry/detail/queries.h"
#include "carom/geometry/query.h"
#include "carom/geometry/tree_walk.h"
#include "carom/rigid/detail/contacts.h"
#include "carom/rigid/detail/joint_check.h"
#include "carom/rigid/detail/seen_shapes.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid {
namespace detail {

template <class D>
RayHit<D> world_hit(const WorldImplementation<D>& world, std::int32_t slot, const typename D::Pose& pose,
                    const geometry::CastHit<typename D::Vector>& hit) {
  return {world.shapes.slots.handle_at(slot),
          world_point(pose, hit.point),
          rotate(pose.rotation, hit.normal),
          hit.fraction,
          hit.child,
          material_at(world, slot, geometry::material_of_part(world.shapes.at(slot).geometry, hit.child)).user_id};
}
/// Nearer, or equally near and older in its slot: one answer, whatever the tree looks like.
inline bool is_nearer(float fraction, std::int32_t slot, float best, std::int32_t best_slot) {
  return fraction < best || (fraction == best && (best_slot == none || slot < best_slot));
}

template <class T>
bool all_finite(Vec2<T> v) {
  return (v.x - v.x) + (v.y - v.y) == 0;  // infinity less itself is no number
}
template <class T>
bool all_finite(Vec3<T> v) {
  return (v.x - v.x) + (v.y - v.y) + (v.z - v.z) == 0;
}
template <class D>
Status check_query(std::string_view call, const typename D::Position& origin, const typename D::Vector& translation) {
  if (all_finite(origin) && all_finite(translation)) return {};
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
Status check_query_shape(std::string_view call, const typename D::Shape& shape) {
  Complaint complaint(call);
  complaint.status(geometry::validate(shape));
  if (!can_be_cast(shape)) complaint.say("shape is not convex, expected a convex shape");
  if (!complaint.none_yet()) return complaint.error();
  return {};
}
template <class D>
Status check_cast(std::string_view call, const typename D::Pose& pose, const typename D::Vector& translation) {
  if (all_finite(pose.position) && all_finite(translation) && pose.rotation == typename D::Rotation{}) return {};
  Complaint complaint(call);
  complaint.vector("pose.position", pose.position);
  complaint.rotation("pose.rotation", pose.rotation);
  complaint.vector("translation", translation);
  if (!complaint.none_yet()) return complaint.error();
  return {};
}
inline constexpr int queries_a_chunk = 32;
inline Status check_batch(std::string_view call, std::size_t queries, std::string_view what, std::size_t room) {
  constexpr std::size_t most = std::size_t(1) << 30;
  if (queries == room && queries <= most) return {};
  Complaint complaint(call);
  complaint.say(core::text(what, " has room for ", room, " results of ", queries,
                           " queries, expected the same number, at most 2^30"));
  return complaint.error();
}
inline void sort_by_slot(std::vector<ShapeId>& found, std::size_t from) {
  if (found.size() - from < 2) return;
  std::sort(found.begin() + std::ptrdiff_t(from), found.end(), [](ShapeId a, ShapeId b) { return a.index < b.index; });
}

/// What of a world is seen: all of it.
struct Everything {
  constexpr bool tree(int) const { return true; }
  constexpr bool body(std::int32_t) const { return true; }
};
/// Every shape that the moving box may meet before `limit`, of the trees that are seen: visit(slot, limit) → new limit.
template <class D, class Seen, class Visit>
void cast_in_trees(const WorldImplementation<D>& world, const Seen& seen, const typename D::Position& origin,
                   const typename D::Position& translation, typename D::Position extents, Visit&& visit) {
  // What is touched within rounding is asked too, whichever tree is walked.
  const double slack = 2e-5 + 4e-6 * math::length(translation);
  for (int k = 0; k < D::dimension; ++k) extents[k] += slack;
  float limit = 1;
  for (int t = 0; t < 3; ++t) {
    const auto& tree = world.shapes.trees[t];
    if (tree.empty() || !seen.tree(t)) continue;
    if (const auto* made = query_tree<D>(world, t)) {
      if (made->wide.nodes.empty())
        for (const std::int32_t slot : made->slots) limit = visit(slot, limit);
      else
        cast(
            made->wide, origin, translation, extents, limit,
            [&](std::uint32_t place, float) { return limit = visit(made->slots[place], limit); },
            [&](std::uint32_t place) __attribute__((always_inline)) {
              prefetch_lines(&world.shapes.at(made->slots[place]), sizeof(ShapeRecord<D>));
            });
    } else {
      tree.cast(origin, translation, extents,
                [&](std::uint32_t item, auto) { return limit = visit(std::int32_t(item), limit); });
    }
  }
}
/// Every shape whose tight box meets `box`: visit(slot).
template <class D, class Visit>
void query_trees(const WorldImplementation<D>& world, const typename D::Bounds& box, Visit&& visit) {
  visit_seen_boxes<D>(world, box, [&](std::int32_t slot, const typename D::Bounds&, bool tight) {
    const auto& shape = world.shapes.at(slot);
    if (tight || overlaps(world_bounds<D>(shape.geometry, shape_pose<D>(world, shape)), box)) visit(slot);
  });
}

inline constexpr int rays_a_group = 16, rays_a_chunk = 8 * rays_a_group;
/// False: the ray goes by `box`, on one side of it. Sides are told one after the other, mostly by the height.
template <class D>
bool reaches(const RayQuery<D>& ray, const typename D::Bounds& box) {
  const auto passes = [](double from, float way, double low, double high) {
    const double to = from + double(way);
    return (from > high && to > high) || (from < low && to < low);
  };
  if (passes(ray.origin.y, ray.translation.y, box.low.y, box.high.y)) return false;
  if (passes(ray.origin.x, ray.translation.x, box.low.x, box.high.x)) return false;
  if constexpr (D::dimension == 3) return !passes(ray.origin.z, ray.translation.z, box.low.z, box.high.z);
  return true;
}
/// Of those whose indices are given, with the slack of cast_in_trees.
template <class D>
typename D::Bounds bounds_of_rays(std::span<const RayQuery<D>> rays, std::span<const int> chosen) {
  using Position = typename D::Position;
  Position low = rays[std::size_t(chosen.front())].origin, high = low, longest{};
  for (const int i : chosen) {
    const RayQuery<D>& ray = rays[std::size_t(i)];
    const Position way(ray.translation), end = ray.origin + way;
    low = min(low, min(ray.origin, end));
    high = max(high, max(ray.origin, end));
    longest = max(longest, max(way, -way));
  }
  const double slack = 2e-5 + 4e-6 * math::length(longest);
  for (int k = 0; k < D::dimension; ++k) {
    low[k] -= slack;
    high[k] += slack;
  }
  return {low, high};
}
/// Around all shapes that are seen; upside down where there is none.
template <class D, class Seen>
typename D::Bounds bounds_of_shapes(const WorldImplementation<D>& world, const Seen& seen) {
  typename D::Bounds all;
  for (int k = 0; k < D::dimension; ++k) all.low[k] = 1e300, all.high[k] = -1e300;
  for (int t = 0; t < 3; ++t)
    if (const auto& tree = world.shapes.trees[t]; !tree.empty() && seen.tree(t)) all = merge(all, tree.root_bounds());
  return all;
}
/// False: no box of a shape that is seen meets `box`. True where one may.
template <class D, class Seen>
bool anything_near(const WorldImplementation<D>& world, const Seen& seen, const typename D::Bounds& box) {
  bool any = false;
  for (int t = 0; t < 3 && !any; ++t) {
    const auto& tree = world.shapes.trees[t];
    if (tree.empty() || !seen.tree(t)) continue;
    const auto found = [&](std::int32_t slot) {
      any = seen.body(world.shapes.at(slot).body);
      return !any;
    };
    const auto* made = query_tree<D>(world, t);
    if (made == nullptr)
      tree.query(box, [&](std::uint32_t item) { return found(std::int32_t(item)); });
    else if (made->wide.nodes.empty())
      for (std::size_t i = 0; i < made->slots.size() && !any; ++i) found(made->slots[i]);
    else
      query(made->wide, box, [&](std::size_t place) { return found(made->slots[place]); });
  }
  return any;
}

/// `seen` adds to the filter of the ray.
template <class D, class Seen>
RayHit<D> closest_on_ray(const WorldImplementation<D>& world, const RayQuery<D>& ray, const Seen& seen) {
  const SeenFilter filter(world, ray.filter);
  RayHit<D> best;
  std::int32_t best_slot = none;
  geometry::CastHit<typename D::Vector> best_hit;
  const auto visit = [&](std::int32_t slot, float limit) {
    const auto& shape = world.shapes.at(slot);
    if (!query_sees<D>(shape, filter) || !seen.body(shape.body)) return limit;
    if (limit == 0 && best_slot != none && slot > best_slot) return limit;  // at best as near
    const typename D::Pose pose = shape_pose<D>(world, shape);
    const auto hit = geometry::ray_cast(shape.geometry, local_point(pose, ray.origin),
                                        inverse_rotate(pose.rotation, ray.translation));
    if (!hit.hit || !is_nearer(hit.fraction, slot, best_hit.fraction, best_slot)) return limit;
    best_hit = hit;
    best_slot = slot;
    return hit.fraction;
  };
  cast_in_trees(world, seen, ray.origin, typename D::Position(ray.translation), {}, visit);
  if (best_slot != none)
    best = world_hit<D>(world, best_slot, shape_pose<D>(world, world.shapes.at(best_slot)), best_hit);
  return best;
}

template <class D>
RayHit<D> first_on_way(const WorldImplementation<D>& world, const typename D::Shape& moving,
                       const ShapeCastQuery<D>& query) {
  const typename D::Bounds box = world_bounds<D>(moving, query.pose);
  const SeenFilter filter(world, query.filter);
  RayHit<D> best;
  std::int32_t best_slot = none;
  geometry::CastHit<typename D::Vector> best_hit;
  cast_in_trees(world, Everything{}, box.center(), typename D::Position(query.translation), box.extents(),
                [&](std::int32_t slot, float limit) {
                  const auto& shape = world.shapes.at(slot);
                  if (!query_sees<D>(shape, filter)) return limit;
                  if (limit == 0 && best_slot != none && slot > best_slot) return limit;  // at best as near
                  const typename D::Pose placed = shape_pose<D>(world, shape);
                  const auto hit = geometry::detail::shape_cast_within(
                      shape.geometry, moving, relative(placed, query.pose),
                      inverse_rotate(placed.rotation, query.translation), min(1.0f, 1.000001f * limit));
                  if (!hit.hit || !is_nearer(hit.fraction, slot, best_hit.fraction, best_slot)) return limit;
                  best_hit = hit;
                  best_slot = slot;
                  return hit.fraction;
                });
  if (best_slot != none)
    best = world_hit<D>(world, best_slot, shape_pose<D>(world, world.shapes.at(best_slot)), best_hit);
  return best;
}

/// Appends, in the order of their slots.
template <class D>
void touching(const WorldImplementation<D>& world, const typename D::Shape& probe, const OverlapQuery<D>& query,
              std::vector<ShapeId>& found) {
  const SeenFilter filter(world, query.filter);
  const std::size_t before = found.size();
  query_trees(world, world_bounds<D>(probe, query.pose), [&](std::int32_t slot) {
    const auto& shape = world.shapes.at(slot);
    if (query_sees<D>(shape, filter) &&
        geometry::overlap(shape.geometry, probe, relative(shape_pose<D>(world, shape), query.pose)))
      found.push_back(world.shapes.slots.handle_at(slot));
  });
  sort_by_slot(found, before);
}

/// Runs body(i) for every query on the world's threads, a few at a time.
template <class D, class Body>
void for_queries(const WorldImplementation<D>& world, std::size_t count, Body&& body) {
  world.scheduler->parallel_for(int(count), queries_a_chunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) body(std::size_t(i));
  });
}

/// Answers every ray by what is `seen` of the world's shapes, and then by meet(i, best): what is met beside these,
/// before `best`.
template <class D, class Seen, class Meet>
Status cast_in_groups(const WorldImplementation<D>& world, std::span<const RayQuery<D>> rays, std::span<RayHit<D>> hits,
                      const Seen& seen, const Meet& meet) {
  constexpr std::string_view call = "World::cast_rays";
  if (const Status s = check_batch(call, rays.size(), "hits", hits.size()); !s.ok()) return s;
  double nothing = 0, longest = 0;  // nothing: NaN as soon as one number is not finite
  for (const RayQuery<D>& ray : rays) {
    const auto way = typename D::Position(ray.translation);
    if constexpr (D::dimension == 3) {
      nothing += 0 * ((ray.origin.x + way.x) + (ray.origin.y + way.y) + (ray.origin.z + way.z));
      longest = math::max(longest, way.x * way.x + way.y * way.y + way.z * way.z);
    } else {
      nothing += 0 * ((ray.origin.x + way.x) + (ray.origin.y + way.y));
      longest = math::max(longest, way.x * way.x + way.y * way.y);
    }
  }
  if (nothing != 0)
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (!check_query<D>(call, rays[i].origin, rays[i].translation).ok())
        return check_query<D>(core::text(call, ": ray ", i), rays[i].origin, rays[i].translation);
  // Each is asked first whether it comes where anything is. What does asks with its neighbours whether there is
  // anything at all where they go: one walk for a group.
  typename D::Bounds all = bounds_of_shapes<D>(world, seen);
  const double slack = 2e-5 + 4e-6 * math::sqrt(longest);
  for (int k = 0; k < D::dimension; ++k) all.low[k] -= slack, all.high[k] += slack;
  world.scheduler->parallel_for(int(rays.size()), rays_a_chunk, [&](int begin, int end, int) {
    int chosen[rays_a_group];
    for (int next = begin; next < end;) {
      const int first = next;
      int count = 0;
      for (; next < end && count < rays_a_group; ++next) {
        hits[std::size_t(next)] = {};
        chosen[count] = next;
        count += reaches<D>(rays[std::size_t(next)], all);
      }
      const std::span<const int> group(chosen, std::size_t(count));
      if (count < 3 || anything_near<D>(world, seen, bounds_of_rays<D>(rays, group)))
        for (const int i : group) hits[std::size_t(i)] = closest_on_ray(world, rays[std::size_t(i)], seen);
      for (int i = first; i < next; ++i) meet(std::size_t(i), hits[std::size_t(i)]);
    }
  });
  return {};
}

}  // namespace detail

template <class D>
Result<RayHit<D>> World<D>::ray_cast(Position origin, Vector translation, QueryFilter filter) const {
  if (const Status s = detail::check_query<D>("World::ray_cast", origin, translation); !s.ok()) return s.error();
  return detail::closest_on_ray<D>(*self_, {origin, translation, filter}, detail::Everything{});
}

template <class D>
Status World<D>::cast_rays(std::span<const RayQuery<D>> rays, std::span<RayHit<D>> hits) const {
  return detail::cast_in_groups<D>(*self_, rays, hits, detail::Everything{}, [](std::size_t, RayHit<D>&) {});
}

template <class D>
Status World<D>::ray_cast_all(Position origin, Vector translation, std::vector<RayHit<D>>& hits,
                              QueryFilter filter) const {
  if (const Status s = detail::check_query<D>("World::ray_cast_all", origin, translation); !s.ok()) return s;
  hits.clear();
  const detail::SeenFilter seen(*self_, filter);
  detail::cast_in_trees<D>(
      *self_, detail::Everything{}, origin, Position(translation), {}, [&](std::int32_t slot, float limit) {
        const auto& shape = self_->shapes.at(slot);
        if (!detail::query_sees<D>(shape, seen)) return limit;
        const Pose pose = detail::shape_pose<D>(*self_, shape);
        const auto hit =
            geometry::ray_cast(shape.geometry, local_point(pose, origin), inverse_rotate(pose.rotation, translation));
        if (hit.hit) hits.push_back(detail::world_hit<D>(*self_, slot, pose, hit));
        return limit;
      });
  std::sort(hits.begin(), hits.end(), [](const RayHit<D>& a, const RayHit<D>& b) {
    return a.fraction != b.fraction ? a.fraction < b.fraction : a.shape.index < b.shape.index;
  });
  return {};
}

template <class D>
Result<RayHit<D>> World<D>::shape_cast(const Shape& moving, const Pose& pose, Vector translation,
                                       QueryFilter filter) const {
  constexpr std::string_view call = "World::shape_cast";
  if (const Status s = detail::check_query_shape<D>(call, moving); !s.ok()) return s.error();
  if (const Status s = detail::check_cast<D>(call, pose, translation); !s.ok()) return s.error();
  return detail::first_on_way<D>(*self_, moving, {pose, translation, filter});
}

template <class D>
Status World<D>::cast_shapes(const Shape& moving, std::span<const ShapeCastQuery<D>> casts,
                             std::span<RayHit<D>> hits) const {
  constexpr std::string_view call = "World::cast_shapes";
  if (const Status s = detail::check_batch(call, casts.size(), "hits", hits.size()); !s.ok()) return s;
  if (const Status s = detail::check_query_shape<D>(call, moving); !s.ok()) return s;
  for (std::size_t i = 0; i < casts.size(); ++i)
    if (!detail::check_cast<D>(call, casts[i].pose, casts[i].translation).ok())
      return detail::check_cast<D>(core::text(call, ": cast ", i), casts[i].pose, casts[i].translation);
  detail::for_queries<D>(*self_, casts.size(),
                         [&](std::size_t i) { hits[i] = detail::first_on_way<D>(*self_, moving, casts[i]); });
  return {};
}

template <class D>
Status World<D>::overlap(const Shape& probe, const Pose& pose, std::vector<ShapeId>& found, QueryFilter filter) const {
  constexpr std::string_view call = "World::overlap";
  if (const Status s = detail::check_query_shape<D>(call, probe); !s.ok()) return s;
  if (const Status s = detail::check_cast<D>(call, pose, {}); !s.ok()) return s;
  found.clear();
  detail::touching<D>(*self_, probe, {pose, filter}, found);
  return {};
}

template <class D>
Status World<D>::overlap_shapes(const Shape& probe, std::span<const OverlapQuery<D>> queries,
                                std::vector<ShapeId>& found, std::span<std::uint32_t> ends) const {
  constexpr std::string_view call = "World::overlap_shapes";
  if (const Status s = detail::check_batch(call, queries.size(), "ends", ends.size()); !s.ok()) return s;
  if (const Status s = detail::check_query_shape<D>(call, probe); !s.ok()) return s;
  for (std::size_t i = 0; i < queries.size(); ++i)
    if (!detail::check_cast<D>(call, queries[i].pose, {}).ok())
      return detail::check_cast<D>(core::text(call, ": query ", i), queries[i].pose, {});
  // Each chunk finds into a list of its own; they are joined in their order.
  std::vector<std::vector<ShapeId>> lists(queries.size() / detail::queries_a_chunk + 1);
  detail::for_queries<D>(*self_, queries.size(), [&](std::size_t i) {
    std::vector<ShapeId>& list = lists[i / detail::queries_a_chunk];
    detail::touching<D>(*self_, probe, queries[i], list);
    ends[i] = std::uint32_t(list.size());
  });
  found.clear();
  for (std::size_t i = 0, k = 0; k < lists.size(); ++k) {
    const std::uint32_t before = std::uint32_t(found.size());
    for (; i < queries.size() && i / detail::queries_a_chunk == k; ++i) ends[i] += before;
    found.insert(found.end(), lists[k].begin(), lists[k].end());
  }
  return {};
}

template <class D>
Status World<D>::overlap_bounds(const typename D::Bounds& bounds, std::vector<ShapeId>& found,
                                QueryFilter filter) const {
  if (!detail::all_finite(bounds.low) || !detail::all_finite(bounds.high) ||
      !(min(bounds.low, bounds.high) == bounds.low)) {
    detail::Complaint complaint("World::overlap_bounds");
    complaint.vector("bounds.low", bounds.low);
    complaint.vector("bounds.high", bounds.high);
    complaint.say("bounds.low is above bounds.high, expected low ≤ high in every component");
    return complaint.error();
  }
  found.clear();
  const detail::SeenFilter seen(*self_, filter);
  detail::query_trees<D>(*self_, bounds, [&](std::int32_t slot) {
    const auto& shape = self_->shapes.at(slot);
    if (!detail::query_sees<D>(shape, seen)) return;
    found.push_back(self_->shapes.slots.handle_at(slot));
  });
  detail::sort_by_slot(found, 0);
  return {};
}

template <class D>
void World<D>::fast_bodies(float speed, std::vector<BodyId>& found) const {
  found.clear();
  const auto& bodies = self_->bodies;
  for (const std::int32_t slot : bodies.awake) {
    const detail::SolverBody<D>& body = bodies.solver[std::size_t(slot)];
    float fastest = math::length(body.linear_velocity), turn = 0;
    if constexpr (D::dimension == 2)
      turn = math::abs(body.angular_velocity);
    else
      turn = math::length(body.angular_velocity);
    if (turn > 0) fastest += turn * bodies.motion[std::size_t(slot)].outer_extent;
    if (fastest > speed) found.push_back(bodies.slots.handle_at(slot));
  }
  std::sort(found.begin(), found.end(), [](BodyId a, BodyId b) { return a.index < b.index; });
}

}  // namespace carom::rigid
