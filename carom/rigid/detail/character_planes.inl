// What a character finds around it: neighbours, once a move, and the planes that they leave (part of character.cpp).
#pragma once

namespace carom::rigid {

template <class D>
const detail::Neighbour<D>& Character<D>::of(const Plane& plane) const {
  return around_->near[plane.neighbour];
}

/// What is not too steep carries, and so does the top of an edge that the capsule's round end rests on: the surface a
/// little inward of the point.
template <class D>
bool Character<D>::carries(const Plane& plane) const {
  if (plane.walkable) return true;
  const Vector up = definition_.up;
  if (!plane.low || dot(plane.normal, up) < 0.05f) return false;
  if (plane.ground >= 0) return plane.ground != 0;
  const Vector level = plane.normal - up * dot(plane.normal, up);
  const Vector inward = level * (-0.1f * definition_.radius / math::length(level));
  const float down = 0.2f * definition_.radius;
  const detail::Neighbour<D>& n = of(plane);
  const Vector from = local_point(n.pose, plane.point + Position(inward + up * (0.5f * down)));
  const auto hit = detail::ray_into(n.geometry, from, inverse_rotate(n.pose.rotation, up * -down));
  plane.ground = hit.hit && hit.fraction > 0 && dot(rotate(n.pose.rotation, hit.normal), up) >= least_up_ ? 1 : 0;
  return plane.ground != 0;
}

template <class D>
void Character<D>::add_plane(std::size_t neighbour, const Vector& normal, float separation, const Vector& point) {
  const detail::Neighbour<D>& n = around_->near[neighbour];
  Plane p;
  p.neighbour = neighbour;
  p.normal = rotate(n.pose.rotation, normal);
  p.gap = separation - definition_.skin;
  p.point = world_point(n.pose, point);
  p.height = float(dot(p.point - feet(), Position(definition_.up)));
  p.walkable = dot(p.normal, definition_.up) >= least_up_;
  p.low = p.height < definition_.radius;
  p.dynamic = n.body.type == BodyType::dynamic && n.body.mass > 0;
  if (n.body.type != BodyType::fixed && n.body.awake) {
    const Vector arm(p.point - n.body.center_of_mass);
    const float closing = dot(way_of_point(n.body.linear_velocity, n.body.angular_velocity, arm, dt_), p.normal);
    // A dynamic body that comes nearer is stopped by the character's body, not the other way round.
    if (!p.dynamic || closing < 0 || n.body_id == ground_.body) p.closing = closing;
    p.gap -= p.closing;
  }
  planes_.push_back(p);
}

/// Notes what is near where this move may lead, how far anything comes in it by itself, and what `needed` (seen from
/// here) meets.
template <class D>
void Character<D>::look_around(const World<D>& world, const geometry::Bounds<Vector>& needed) {
  detail::Vicinity<D>& all = *around_;
  all.base = position_;
  all.near.clear();
  const Vector steps = definition_.up * definition_.step_height;
  const auto box = geometry::grow(box_, reach_);
  all.whole = merge(merge(needed, box), merge(geometry::Bounds<Vector>{box.low + steps, box.high + steps},
                                              geometry::Bounds<Vector>{box.low - steps, box.high - steps}));
  constexpr float most = 1;  // m that anything comes nearer
  const typename D::Bounds whole{position_ + Position(all.whole.low), position_ + Position(all.whole.high)};
  constexpr double rounding = 1e-3;
  const auto& store = *world.self_;
  const detail::SeenFilter filter(store, {definition_.filter.category, definition_.filter.mask, body_});
  all.found.clear();
  // Of most that could come near, the box in the tree tells that they do not.
  detail::visit_seen_boxes<D>(
      store, geometry::grow(whole, most + rounding), [&](std::int32_t slot, const typename D::Bounds& held, bool) {
        const auto& shape = store.shapes.at(slot);
        if (!detail::query_sees<D>(shape, filter)) return;
        const int group = store.shapes.terms_of(shape).filter.group;
        if (group < 0 && group == definition_.filter.group) return;
        const std::size_t body = std::size_t(shape.body);
        float way = 0;
        if (const auto& record = store.bodies.record[body]; record.type != BodyType::fixed && record.awake_index >= 0) {
          const float arm = float(math::length(position_ - store.bodies.motion[body].center)) +
                            definition_.half_length + definition_.radius;
          const auto& moves = store.bodies.solver[body];
          way = min((math::length(moves.linear_velocity) + spin_of(moves.angular_velocity) * arm) * dt_, most);
        }
        if (geometry::overlaps(held, geometry::grow(whole, double(way) + rounding))) all.found.push_back({slot, way});
      });
  std::sort(all.found.begin(), all.found.end(), [](const auto& a, const auto& b) { return a.slot < b.slot; });
  bool special = false;
  for (const auto& [slot, approach] : all.found) {
    const auto& shape = store.shapes.at(slot);
    const ShapeId id = store.shapes.slots.handle_at(slot);
    const typename D::Pose pose = detail::shape_pose(store, shape);
    const auto seen = geometry::bounds(shape.geometry, relative(typename D::Pose{position_, {}}, pose));
    if (!geometry::overlaps(geometry::grow(seen, approach), all.whole)) continue;
    if (store.contact_filter && !store.contact_filter(shape_, id)) continue;
    special = special || (shape.flags & detail::shape_special) != 0;
    const BodyId owner = store.bodies.slots.handle_at(shape.body);
    all.near.push_back({id, owner, shape.geometry, pose, detail::state_of(store, shape.body), approach, seen});
  }
  all.keep_triangles();
  for (std::size_t i = all.near.size(); special && i-- > 0;) {
    const auto* extra = store.shapes.extra(std::int32_t(store.shapes.slots.slot(all.near[i].id)));
    if (extra == nullptr || extra->one_way == Vector{} || !lets_through(i, extra->one_way)) continue;
    all.near.erase(all.near.begin() + std::ptrdiff_t(i));
    all.forget_triangles();
  }
}

/// Is the character within or behind a one-way surface, or lets itself fall through it? `front`: in the shape's frame.
template <class D>
bool Character<D>::lets_through(std::size_t neighbour, const Vector& front) {
  const detail::Neighbour<D>& n = around_->near[neighbour];
  const float close = reach_ + n.approach + definition_.skin, reach = close + definition_.step_height;
  float nearest = 1e30f;
  bool passes = false;
  detail::for_planes(*around_, neighbour, capsule_, relative(n.pose, pose()), reach, {Vector{}, reach},
                     [&](const Vector& normal, float separation, const Vector&) {
                       if (separation >= nearest) return;
                       nearest = separation;
                       passes = separation < -0.5f * definition_.skin || dot(normal, front) < detail::side_cosine;
                     });
  held_ = held_ || (nearest < close && !passes);
  return passes || dropping_;
}

/// m/s, world axes, by which the surface under a plane runs over its body.
template <class D>
typename D::Vector Character<D>::belt_of(const World<D>& world, const Plane& plane) const {
  const auto& store = *world.self_;
  const detail::Neighbour<D>& n = of(plane);
  const std::int32_t slot = std::int32_t(store.shapes.slots.slot(n.id));
  const auto* extra = store.shapes.extra(slot);
  std::uint32_t number = 0;
  if (extra != nullptr && extra->surface_count > 0) {
    const float r = definition_.radius;
    const Vector out = inverse_rotate(n.pose.rotation, plane.normal);
    const auto hit =
        detail::ray_into(n.geometry, local_point(n.pose, plane.point) + out * (0.1f * r), out * (-0.2f * r));
    if (hit.hit) number = geometry::material_of_part(n.geometry, hit.child);
  }
  const SurfaceMaterial<D>* part = store.shapes.surface(slot, number);
  const Vector runs =
      part != nullptr ? part->surface_velocity : (extra != nullptr ? extra->surface_velocity : Vector{});
  return detail::belt_velocity(rotate(n.pose.rotation, runs), detail::material_at(store, slot, number), plane.normal);
}

/// The planes of all that a straight `way` may meet, and of what is no farther than `around` from it. What lies beside
/// a long way is not looked at: on a mesh that is most of the triangles within its length.
template <class D>
void Character<D>::find_planes(const World<D>& world, const Vector& way, float around) {
  planes_.clear();
  detail::Vicinity<D>& all = *around_;
  const float near = around + definition_.skin, reach = math::length(way) + near;
  const Vector moved(position_ - all.base);
  auto grown = geometry::grow(merge(box_, {box_.low + way, box_.high + way}), near);
  const geometry::Bounds<Vector> seen{grown.low + moved, grown.high + moved};
  if (contains(all.whole, seen))
    grown = seen;
  else
    look_around(world, grown);
  for (std::size_t i = 0; i < all.near.size(); ++i) {
    detail::Neighbour<D>& n = all.near[i];
    if (!geometry::overlaps(geometry::grow(n.box, n.approach), grown)) continue;
    if (n.clear > 0 && n.clear - 1.001f * float(math::length(position_ - n.clear_at)) > reach + n.approach) continue;
    n.clear = detail::for_planes(
        all, i, capsule_, relative(n.pose, pose()), reach + n.approach,
        {inverse_rotate(n.pose.rotation, way), near + n.approach},
        [&](const Vector& normal, float separation, const Vector& point) { add_plane(i, normal, separation, point); });
    n.clear_at = position_;
  }
}

}  // namespace carom::rigid
