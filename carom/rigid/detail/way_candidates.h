// Whom a body may meet on its way in a step, for continuous collision.
#pragma once

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/chain_tree.h"
#include "carom/rigid/detail/body_way.h"

namespace carom::rigid::detail {

/// A body with more contacts than so finds whom it may meet in the trees; what does not move is found there sooner than
/// among contacts with all that does.
inline constexpr int most_listed = 48, most_listed_for_still = 3;

enum Kinds : unsigned { with_fixed = 1, with_kinematic = 2, with_dynamic = 4 };  ///< bits by TreeIndex

/// May these two meet, as the broad phase would say?
template <class D>
bool may_meet(const WorldImplementation<D>& world, std::int32_t s, std::int32_t o) {
  const ShapeRecord<D>&shape = world.shapes.at(s), &other = world.shapes.at(o);
  if (other.body == shape.body || !may_collide(world, shape, other)) return false;
  if (joints_forbid_collision(world, shape.body, other.body)) return false;
  // Who has no contact may be one that the caller's filter refused.
  return !world.contact_filter || world.pairs.contains(PairSet::key(s, o)) ||
         world.contact_filter(world.shapes.slots.handle_at(s), world.shapes.slots.handle_at(o));
}

/// Calls visit(other shape) for what a shape may meet whose places of this step all lie in `box`. Where its fat bounds
/// foresaw them, the pairs that the broad phase made of these are all there are, but for what is driven out of its own.
template <class D, class Visit>
void for_candidates(const WorldImplementation<D>& world, std::int32_t s, const typename D::Bounds& box, bool foreseen,
                    unsigned kinds, Visit&& visit) {
  const ShapeRecord<D>& shape = world.shapes.at(s);
  const BodyRecord& record = world.bodies.record[std::size_t(shape.body)];
  if ((kinds & with_kinematic) != 0)
    for (const StrayShape<D>& other : world.scratch.driven)
      if (overlaps(other.box, box) && may_meet(world, s, other.shape)) visit(other.shape);
  // A filter or a one-way surface has left its answer with the contact.
  const bool plain = !world.contact_filter && world.shapes.extras.empty();
  const int most = plain && (kinds & with_dynamic) == 0 ? most_listed_for_still : most_listed;
  if (record.contact_count <= most && foreseen) {
    for (std::int32_t key = record.first_contact; key != none;) {
      const ContactRecord<D>& c = world.contacts.at(key >> 1);
      const int side = key & 1;
      key = c.next[side];
      if (key != none) __builtin_prefetch(&world.contacts.at(key >> 1));
      if (c.shape[side] != s || (c.flags & contact_passing) != 0) continue;
      const ShapeRecord<D>& other = world.shapes.at(c.shape[1 - side]);
      if ((kinds >> other.tree & 1u) != 0 && overlaps(world.shapes.trees[other.tree].bounds(other.leaf), box))
        visit(c.shape[1 - side]);
    }
    return;
  }
  for (int tree = 0; tree < 3; ++tree) {
    if ((kinds >> tree & 1u) == 0) continue;
    if constexpr (D::dimension == 3)
      if (tree == tree_dynamic && world.scratch.sweep.holds(world.shapes.trees[tree])) {
        world.scratch.sweep.query(box, [&](std::uint32_t item) {
          const std::int32_t o = std::int32_t(item);
          if (overlaps(world.shapes.trees[tree].bounds(world.shapes.at(o).leaf), box) && may_meet(world, s, o))
            visit(o);
        });
        continue;
      }
    world.shapes.trees[tree].query(box, [&](std::uint32_t item) {
      if (may_meet(world, s, std::int32_t(item))) visit(std::int32_t(item));
      return true;
    });
  }
}

template <class D>
typename D::Bounds way_bounds(const ShapeRecord<D>& shape, const Sweep<D>& own, const typename D::Position& base) {
  using P = typename D::Position;
  if constexpr (D::dimension == 3) {
    if (!is_convex(shape.geometry)) {  // a compound
      geometry::Bounds3f all{Vec3f{1e30f, 1e30f, 1e30f}, Vec3f{-1e30f, -1e30f, -1e30f}};
      for_parts(shape, own, [&](const geometry::Shape3& part, const geometry::Sweep3& way, float) {
        all = merge(all, geometry::detail::swept_bounds(part, way));
      });
      return {base + P(all.low), base + P(all.high)};
    }
  }
  const auto box = geometry::detail::swept_bounds(shape.geometry, own);
  return {base + P(box.low), base + P(box.high)};
}

/// The same of what may turn far: then anywhere about the centre of its body.
template <class D>
typename D::Bounds bounds_of_way(const WorldImplementation<D>& world, const ShapeRecord<D>& shape, const Sweep<D>& own,
                                 const SweepStart<D>& start) {
  if (start.turn == typename D::Angular{}) return way_bounds(shape, own, start.center);
  const typename D::Position end = world.bodies.motion[std::size_t(shape.body)].center;
  const double reach = double(math::length(own.local_center) + shape.outer_extent);
  return geometry::grow(typename D::Bounds{math::min(start.center, end), math::max(start.center, end)}, reach);
}

inline float turned_by(const Rot2f& a, const Rot2f& b) { return math::sqrt(square(b.c - a.c) + square(b.s - a.s)); }
inline float turned_by(const Quatf& a, const Quatf& b) { return 2 * min(length(b - a), length(b + a)); }
/// The way of a shape's middle; the shape turns about it as far (rad) as its body.
template <class D>
struct MiddleWay {
  typename D::Vector from, begin, end;
  float radius, turn;

  MiddleWay(const ShapeRecord<D>& shape, const Sweep<D>& own, float turn_of_body) : turn(turn_of_body) {
    const ShapeBall<D> ball = ball_about(shape);
    from = ball.middle - own.local_center, radius = ball.radius;
    begin = own.c0 + rotate(own.q0, from), end = own.c1 + rotate(own.q1, from);
  }
  /// Did no point of the shape come as far as a part of its thickness? Then it passed nothing.
  bool is_slow(const ShapeRecord<D>& shape, float part) const {
    const float left = part * shape.inner_extent - turn * radius;
    return left >= 0 && math::length_squared(end - begin) <= left * left;
  }
  /// A box that all of the shape stays in on its way, found sooner than way_bounds and larger.
  typename D::Bounds box(const typename D::Position& base) const {
    using P = typename D::Position;
    // The arc of a point strays from its chord by less than its turn times the arm.
    const float arm = math::length(from);
    const double reach = double(radius) + double(turn) * double(arm) + 1e-5 * double(arm + radius);
    return geometry::grow(typename D::Bounds{base + P(math::min(begin, end)), base + P(math::max(begin, end))}, reach);
  }
};

/// The same as seen from what turns or slides along with it.
template <class D>
bool is_slow(const ShapeRecord<D>& shape, const Sweep<D>& own, const Sweep<D>& other, float part) {
  using V = typename D::Vector;
  const ShapeBall<D> ball = ball_about(shape);
  const V arm = ball.middle - own.local_center;
  const V begin = inverse_rotate(other.q0, own.c0 + rotate(own.q0, arm) - other.c0),
          end = inverse_rotate(other.q1, own.c1 + rotate(own.q1, arm) - other.c1);
  return math::length(end - begin) +
             turned_by(conjugate(other.q0) * own.q0, conjugate(other.q1) * own.q1) * ball.radius <=
         part * shape.inner_extent;
}

/// Does a fixed shape, whose bounds meet the box, come as near as its parts tell? The bounds of a chain may hold all
/// that there is.
inline bool comes_near(const WorldImplementation<Dim3>&, const ShapeRecord<Dim3>&, const Dim3::Bounds&) { return true; }
inline bool comes_near(const WorldImplementation<Dim2>& world, const ShapeRecord<Dim2>& shape,
                       const Dim2::Bounds& box) {
  if (shape.geometry.type != geometry::ShapeType2::chain) return true;
  const Dim2::Pose pose = shape_pose(world, shape);
  const Vec2f middle = inverse_rotate(pose.rotation, Vec2f(box.center() - pose.position));
  const Vec2f half(box.extents()), c = math::abs(Vec2f{pose.rotation.c, pose.rotation.s});
  const Vec2f reach = Vec2f{c.x * half.x + c.y * half.y, c.y * half.x + c.x * half.y} +
                      1e-5f * (math::abs(middle) + half) + Vec2f{1e-3f, 1e-3f};
  bool any = false;
  geometry::detail::visit_segments(*shape.geometry.chain, {middle - reach, middle + reach}, [&](int) {
    any = true;
    return false;
  });
  return any;
}

/// What forces do not move and a body may meet on its way.
template <class D>
struct StillNear {
  static constexpr int capacity = 8;
  int most = 0;   ///< that are listed
  int count = 0;  ///< above that: there are more
  std::int32_t shape[capacity];
  const typename D::Bounds* bounds[capacity];  ///< as they are in the tree

  StillNear(const WorldImplementation<D>& world, const typename D::Bounds& box, int list = 0) : most(list) {
    for (const int tree : {tree_fixed, tree_kinematic})
      if (world.shapes.trees[tree].size() > 0)
        world.shapes.trees[tree].query_boxes(box, [&](std::uint32_t item, const typename D::Bounds& other) {
          if (tree == tree_fixed && !comes_near(world, world.shapes.at(std::int32_t(item)), box)) return true;
          if (const std::size_t place = std::size_t(count); place < std::size_t(most))
            shape[place] = std::int32_t(item), bounds[place] = &other;
          return ++count <= most;
        });
    for (const StrayShape<D>& other : world.scratch.driven) {
      if (count > most || !overlaps(other.box, box)) continue;
      if (const std::size_t place = std::size_t(count); place < std::size_t(most))
        shape[place] = other.shape, bounds[place] = &other.box;
      ++count;
    }
  }
  /// Does a box reach the bounds of none of them?
  bool is_far(const typename D::Bounds& box) const {
    bool far = count <= most;
    for (int i = 0; far && i < count; ++i) far = !overlaps(*bounds[i], box);
    return far;
  }
  bool is_free(const WorldImplementation<D>& world, const typename D::Bounds& box) const {
    if (count > most) return StillNear(world, box).count == 0;
    for (int i = 0; i < count; ++i)
      if (overlaps(*bounds[i], box) &&
          (world.shapes.at(shape[i]).tree != tree_fixed || comes_near(world, world.shapes.at(shape[i]), box)))
        return false;
    return true;
  }
};

/// Lists the shapes that no force moves and that go a good part of their thickness in this step, as a thin wall that is
/// driven fast. Their fat bounds do not foresee that, so that nobody finds them there; and who stands in their way is
/// passed as surely as who flies at them.
template <class D>
void find_driven(WorldImplementation<D>& world) {
  std::vector<StrayShape<D>>& driven = world.scratch.driven;
  driven.clear();
  if (world.shapes.trees[tree_kinematic].size() == 0) return;
  for (std::size_t place = 0; place < world.bodies.awake.size(); ++place) {
    const std::int32_t body = world.bodies.awake[place];
    const BodyRecord& record = world.bodies.record[std::size_t(body)];
    if (record.type != BodyType::kinematic) continue;
    const SweepStart<D>& start = world.scratch.swept[place];
    const bool turns_far = start.turn != typename D::Angular{};
    const Sweep<D> sweep = way_of_body(world, body, start.center);
    const float turn = turned_by(sweep.q0, sweep.q1);
    for (std::int32_t s = record.first_shape; s != none; s = world.shapes.at(s).next) {
      const ShapeRecord<D>& shape = world.shapes.at(s);
      if (shape.leaf == none) continue;
      const Sweep<D> own = way_of_shape(shape, sweep);
      if (turns_far || !MiddleWay<D>(shape, own, turn).is_slow(shape, 0.5f))
        driven.push_back({bounds_of_way(world, shape, own, start), s});
    }
  }
}

}  // namespace carom::rigid::detail
