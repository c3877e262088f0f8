// When a pair touches, watches on pairs that have been looked at, and whether all that is known of one is still true
// (part of stage_narrow_phase.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

constexpr float touch_distance = 0.005f;  ///< m: surfaces nearer than this touch, for events

enum ContactChange : std::uint8_t {
  change_apart = 1,      ///< fat bounds no longer overlap
  change_manifolds = 2,  ///< new manifolds wait in the found list; the old ones go
  change_empty = 4,      ///< manifolds go, none come
  change_begin = 8,
  change_end = 16,
};

/// The touch flag, with hysteresis: begins within the touch distance, ends when the manifolds are gone or beyond twice
/// it.
template <class D>
std::uint8_t touch_change(ContactRecord<D>& c, float separation, bool pressed) {
  const bool was = (c.flags & contact_touching) != 0;
  const bool is = separation < (was ? 2 * touch_distance : touch_distance) || pressed;
  if (is == was) return 0;
  c.flags ^= contact_touching;
  return is ? change_begin : change_end;
}

template <class D>
bool pressed(const ManifoldRecord<D>& m) {
  for (int i = 0; i < D::max_points; ++i)
    if (m.impulses.normal[i] > 0) return true;
  return false;
}

template <class D>
bool pressed_any(const ContactStore<D>& store, const ContactRecord<D>& c) {
  int left = c.manifold_count;  // the links lie farther back than what a step reads
  for (std::int32_t m = c.first_manifold; left > 0; m = store.manifold(m).next) {
    if (pressed(store.manifold(m))) return true;
    if (--left == 0) break;
  }
  return false;
}

/// The watch on a pair that has just been looked at, when B's shape stood there seen from A's; the caller says what it
/// watches for.
template <class D>
ContactWatch<D>& watch_contact(WorldImplementation<D>& world, const ContactRecord<D>& c,
                               const typename D::Transform& now, const typename D::Vector& normal, float extent) {
  const std::int32_t a = c.body[0], b = c.body[1];
  ContactWatch<D>& w = world.scratch.watches[std::size_t(c.awake_index)];
  w.body[0] = a, w.body[1] = b;
  const bool at_origin = (c.flags & contact_at_origin) != 0;
  w.base = at_origin ? now : relative(world.bodies.pose[std::size_t(a)], world.bodies.pose[std::size_t(b)]);
  w.normal = at_origin ? normal : rotate(world.shapes.at(c.shape[0]).local.q, normal);
  const ShapeRecord<D>& shape = world.shapes.at(c.shape[1]);
  w.middle = ball_about(shape).middle;
  if (!at_origin) w.middle = transform_point(shape.local, w.middle);
  w.extent = extent;
  return w;
}
/// Rounding must not let a watch hold a moment longer than the exact test.
template <class D>
float rounding_of(const ContactWatch<D>& w) {
  return 1e-5f + 1e-6f * (math::length(w.base.p) + math::length(w.middle));
}
template <class D>
void watch_apart(WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Transform& now,
                 const Moved<D>& moved) {
  ContactWatch<D>& w = watch_contact(world, c, now, c.axis, moved.extent);
  w.gap = slack_of(c, moved) - rounding_of(w);
  w.cap = (c.flags & contact_bouncy) != 0 ? 3.4e38f : 0.5f * c.inner;
  w.most_way = 0;
  if (c.axis == typename D::Vector{}) return;
  w.most_way = longest_slide<D> * c.inner - moved.most() - rounding_of(w);
  if (!(w.most_way > 0)) w.body[0] = none;
}
/// What touches is watched until it parts; in the plane, what does not until it comes near or bears a load
/// (store_contacts).
template <class D>
void watch_recycled(WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Transform& now,
                    float slack, float separation, const typename D::Vector& normal, float extent) {
  const bool touching = (c.flags & contact_touching) != 0;
  if (c.first_manifold != none) world.contacts.manifold(c.first_manifold).waits = !touching;
  if (!touching && (D::dimension == 3 || c.manifold_count != 1)) return;
  ContactWatch<D>& w = watch_contact(world, c, now, normal, extent);
  const float most = touching ? min(c.margin(), 2 * touch_distance) : c.margin(), rounding = rounding_of(w);
  w.most_way = slack - rounding;
  w.gap = separation - most + rounding;
  w.cap = touching ? -3.4e38f : touch_distance - most + 2 * rounding;
  if (!(w.most_way > 0 && w.cap < 0)) w.body[0] = none;
}

/// Two that slid past each other, with an axis still between them: where their bounds still meet they go on from here,
/// `gap` apart along it, without being asked how far they are.
template <class D>
bool slide_on(WorldImplementation<D>& world, ContactRecord<D>& c, const Moved<D>& moved,
              const typename D::Transform& now) {
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf))) return false;
  c.gap = coarse(gap_along(c, moved));
  c.base = now;
  watch_apart(world, c, now, Moved<D>{.extent = extent_of(c, b)});
  return true;
}
/// Contact recycling, after Box2D 3.1 and Box3D: while a pair hardly moves, its manifolds are kept and only their
/// separations follow. What moves along the normal changes nothing else; the bound is on sliding and turning, and far
/// below the size of features, so that nothing sticks to a stale edge.
template <class D>
bool recycle(WorldImplementation<D>& world, ContactRecord<D>& c, const Moved<D>& moved,
             const typename D::Transform& now, std::uint8_t& change) {
  const typename D::Manifold& m = world.contacts.manifold(c.first_manifold).manifold;
  const typename D::Vector normal = m.normal;
  const float separation = c.gap + dot(normal, moved.way), far = moved.across(normal);
  const float most = longest_way(world, c);
  if (!(separation < c.margin() && far < most)) return false;
  c.flags |= contact_recycled;
  change = touch_change(c, separation, pressed_any(world.contacts, c));
  watch_recycled(world, c, now, most - far, separation, normal, moved.extent);
  return true;
}

/// Has it manifolds that may be kept?
template <class D>
bool may_recycle(const ContactRecord<D>& c) {
  return c.first_manifold != none && (c.flags & (contact_known | contact_round)) == contact_known;
}

/// A contact whose shapes were found to be `c.gap` apart.
template <class D>
std::uint8_t part(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                  const ShapeRecord<D>& b) {
  std::uint8_t change = 0;
  c.gap = coarse(c.gap);
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
    change = change_apart;
  else if (c.first_manifold != none)
    change = change_empty;
  else
    watch_apart(world, c, c.base, Moved<D>{.extent = extent_of(c, b)});
  return std::uint8_t(change | touch_change(c, c.gap, false));
}

}  // namespace
}  // namespace carom::rigid::detail
