// The part of StateCheck that is about joints, contacts, the graph, sleeping islands and effectors.
#pragma once

#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/state_check.inl"

namespace carom::rigid::detail {

/// Are all switches of a definition on or off?
template <class Def>
bool switches_are_bools(StateFault& f, const Def& d) {
  bool right = true;
  const auto is = [&](const bool& x) { right = right && f.is_bool(x); };
  if constexpr (requires { d.collide_connected; }) is(d.collide_connected);
  if constexpr (requires { d.rope; }) is(d.rope);
  if constexpr (requires { d.limit.enabled; }) is(d.limit.enabled);
  if constexpr (requires { d.motor.enabled; }) is(d.motor.enabled);
  if constexpr (requires { d.twist.enabled; }) is(d.twist.enabled);
  if constexpr (requires { d.hold_position; }) is(d.hold_position), is(d.hold_rotation);
  if constexpr (requires { d.closed; }) is(d.straight), is(d.closed), is(d.follow);
  if constexpr (requires { d.centrifugal; }) is(d.centrifugal);
  if constexpr (requires { d.linear[0].free; }) {
    for (const JointAxis& a : d.linear) is(a.free), is(a.limit.enabled), is(a.motor.enabled);
    for (const JointAxis& a : d.angular) is(a.free), is(a.limit.enabled), is(a.motor.enabled);
  }
  return right;
}

template <class D>
void StateCheck<D>::joints() {
  JointStore<D>& s = w_.joints;
  const std::size_t n = std::size_t(s.slots.capacity());
  if (!f_.holds(s.slots.sound() && s.headers.size() == n && s.room.size() == n, "joints", -1,
                "the list of free slots is broken, or arrays are not of ", n, " slots"))
    return;
  const std::size_t knot_count = s.knot_points.size();
  if (!f_.holds(s.knot_tangents.size() == knot_count && s.knot_arcs.size() == knot_count, "joints", -1,
                "points, tangents and lengths of paths are not as many"))
    return;
  Marks small(s.small.size(), 0), large(s.large.size(), 0), knots(knot_count, 0);
  std::size_t ends = 0;
  int internal = 0, breakable = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!s.slots.in_use(int(i))) continue;
    Marks& rooms = (s.room[i] & 1) != 0 ? large : small;
    if (!f_.holds(within(s.room[i] >> 1, rooms.size()) && rooms[std::size_t(s.room[i] >> 1)]++ == 0, "joint",
                  std::ptrdiff_t(i), "room is ", s.room[i], ", which is none, or another's"))
      return;
    joint(std::int32_t(i), knots);
    if (!f_.none_yet()) return;
    ends += s.headers[i].body[0] == none ? 1 : 2;
    internal += s.at(std::int32_t(i)).internal != 0 ? 1 : 0;
    breakable += may_break(s.at(std::int32_t(i)).frames()) ? 1 : 0;
  }
  const auto all_free = [&](const std::vector<std::int32_t>& list, const Marks& rooms) {
    return is_free_list(list, rooms.size(), [&](std::size_t room) { return rooms[room] == 0; }) &&
           list.size() == std::size_t(std::count(rooms.begin(), rooms.end(), 0));
  };
  f_.holds(all_free(s.free_small, small) && all_free(s.free_large, large), "joints", -1,
           "the lists of free rooms are not those that are free");
  f_.holds(std::find(knots.begin(), knots.end(), 0) == knots.end(), "joints", -1, "some knots are of no path");
  f_.holds(internal == s.internal_count && breakable == s.breakable_count, "joints", -1,
           "of effectors or breakable there are ", internal, " and ", breakable, ", expected ", s.internal_count,
           " and ", s.breakable_count);
  if (!f_.none_yet()) return;
  edges(
      "joints", ends, n, [](const BodyRecord& r) { return r.first_joint; },
      [](const BodyRecord& r) { return r.joint_count; },
      [&](std::int32_t i) { return s.slots.in_use(i) ? &s.headers[std::size_t(i)] : nullptr; });
}

template <class D>
void StateCheck<D>::joint(std::int32_t slot, Marks& knots) {
  const JointHeader& h = w_.joints.headers[std::size_t(slot)];
  JointData<D>& data = w_.joints.at(slot);
  const auto tell = [&](bool right, const auto&... parts) { return f_.holds(right, "joint", slot, parts...); };
  if (!tell(data.type <= JointType::path && (data.large != 0) == ((w_.joints.room[std::size_t(slot)] & 1) != 0),
            "type is ", int(data.type), ", expected one of the types in a room of its size"))
    return;
  const bool is_small = data.visit([](const auto& d) {
    using Def = std::remove_cvref_t<decltype(d)>;
    return sizeof(Def) <= SmallJoint<D>::room && alignof(Def) <= 4;
  });
  if (!tell((data.large != 0) == (!is_small || data.internal != 0), "its room is not of its type's size") ||
      !tell(data.internal == 0 || data.type == JointType::distance, "it is an effector's, expected a distance joint"))
    return;
  if (!tell(used_body(h.body[1]) && (h.body[0] == none || used_body(h.body[0])) && h.body[0] != h.body[1],
            "bodies are ", h.body[0], " and ", h.body[1], ", expected two in use"))
    return;
  JointFrames<D>& frames = data.frames();
  const BodyId named[2] = {frames.body_a, frames.body_b};
  for (int side = 0; side < 2; ++side) {
    BodyId body = h.body[side] == none ? BodyId{} : w_.bodies.slots.handle_at(h.body[side]);
    body.world = named[side].world;
    tell(named[side].is_null() ? h.body[side] == none : named[side] == body, side == 0 ? "body_a" : "body_b",
         " of its definition is another than the one that it is listed with");
  }
  tell(f_.is_bool(h.collide_connected), "collide_connected is neither yes nor no");
  const bool in_graph = h.place.color >= 0;
  tell(h.place.color <= overflow_color, "its colour is ", h.place.color, ", expected at most ", overflow_color);
  tell(!in_graph || ((moves(h.body[0]) || moves(h.body[1])) && !rests(h.body[0]) && !rests(h.body[1])),
       "it is in the graph, expected bodies that move or stand for good");
  data.visit([&](const auto& d) { joint_definition(slot, d, knots); });
  if (!f_.none_yet()) return;
  const std::uint32_t parts = data.parts;
  find_parts(data);
  tell(data.parts == parts, "parts are not those of its definition");
}

template <class D>
template <class Def>
void StateCheck<D>::joint_definition(std::int32_t slot, const Def& d, Marks& knots) {
  const auto tell = [&](bool right, const auto&... parts) { return f_.holds(right, "joint", slot, parts...); };
  if (!tell(switches_are_bools(f_, d), "a switch of its definition is neither on nor off")) return;
  Complaint c("definition");
  c.vector("frame_a.p", d.frame_a.p);
  c.rotation("frame_a.q", d.frame_a.q);
  c.vector("frame_b.p", d.frame_b.p);
  c.rotation("frame_b.q", d.frame_b.q);
  c.not_negative("break_force", d.break_force);
  c.not_negative("break_torque", d.break_torque);
  if constexpr (std::is_same_v<Def, PathJointDef<D>>) {
    const JointMore<D>& more = w_.joints.at(slot).more();
    const JointStore<D>& s = w_.joints;
    std::uint64_t pointers[4] = {};  // of its spans, which point into the process that wrote them
    static_assert(sizeof d.points + sizeof d.tangents <= sizeof pointers);
    std::memcpy(pointers, &d.points, sizeof d.points);
    std::memcpy(pointers + 2, &d.tangents, sizeof d.tangents);
    const std::int32_t least = d.closed ? 4 : 2;
    if (!tell(std::all_of(pointers, pointers + 4, [](std::uint64_t p) { return p == 0; }) &&
                  f_.is_bool(more.own_tangents) && more.first_knot >= 0 && more.knot_count >= least &&
                  std::size_t(more.first_knot) + std::size_t(more.knot_count) <= knots.size() &&
                  within(more.path_place.segment, std::size_t(more.knot_count) - 1),
              "its path is not of the knots that there are, or it is at none of them"))
      return;
    for (std::size_t k = std::size_t(more.first_knot), end = k + std::size_t(more.knot_count); k < end; ++k)
      tell(knots[k]++ == 0 && math::is_finite(s.knot_points[k]) && math::is_finite(s.knot_tangents[k]) &&
               is_finite(s.knot_arcs[k]),
           "knot ", k, " is another's, or not finite");
    c.spring("spring", d.spring);
    c.motor("motor", d.motor);
    c.limit("limit", d.limit);
    c.finite("target_distance", d.target_distance);
    c.not_negative("max_spring_force", d.max_spring_force);
    c.not_negative("friction", d.friction);
  } else if (w_.joints.at(slot).internal == 0) {
    check_joint<D>(c, d);
  }
  if (!c.none_yet()) tell(false, c.error().message);
}

template <class D>
void StateCheck<D>::contacts() {
  ContactStore<D>& s = w_.contacts;
  const std::size_t n = s.contacts.size();
  Marks seen(s.manifolds.size(), 0);
  std::size_t used = 0, awake = 0;
  for (std::size_t i = 0; i < n && f_.none_yet(); ++i) {
    if ((s.contacts[i].flags & contact_in_use) == 0) continue;
    ++used;
    awake += s.contacts[i].awake_index != none ? 1 : 0;
    contact(std::int32_t(i), seen);
  }
  if (!f_.none_yet()) return;
  f_.holds(
      is_free_list(s.free_contacts, n, [&](std::size_t i) { return (s.contacts[i].flags & contact_in_use) == 0; }) &&
          used + s.free_contacts.size() == n && s.count >= 0 && used == std::size_t(s.count),
      "contacts", -1, "there are ", used, ", expected ", s.count, " and all others in the list of free ones");
  f_.holds(is_free_list(s.free_manifolds, seen.size(),
                        [&](std::size_t i) { return seen[i] == 0 && s.manifolds[i].contact == none; }) &&
               s.free_manifolds.size() == std::size_t(std::count(seen.begin(), seen.end(), 0)),
           "manifolds", -1, "the list of free ones is not of those that no contact has");
  f_.holds(awake == s.awake.size(), "contacts", -1, "the list of awake ones has ", s.awake.size(), ", expected ",
           awake);
  f_.holds(w_.pairs.sound() && w_.pairs.size() == used, "pairs", -1,
           "the table is broken or has not one for each of the ", used, " contacts");
  for (std::size_t i = 0; i < n && f_.none_yet(); ++i)
    if (const ContactRecord<D>& c = s.contacts[i]; (c.flags & contact_in_use) != 0)
      f_.holds(w_.pairs.contains(PairSet::key(c.shape[0], c.shape[1])), "contact", std::ptrdiff_t(i),
               "its pair of shapes is not in the table of pairs");
  if (!f_.none_yet()) return;
  edges(
      "contacts", 2 * used, n, [](const BodyRecord& r) { return r.first_contact; },
      [](const BodyRecord& r) { return r.contact_count; },
      [&](std::int32_t i) { return (s.at(i).flags & contact_in_use) != 0 ? &s.at(i) : nullptr; });
}

template <class D>
void StateCheck<D>::contact(std::int32_t index, Marks& seen) {
  ContactStore<D>& s = w_.contacts;
  const ContactRecord<D>& c = s.at(index);
  const auto tell = [&](bool right, const auto&... parts) { return f_.holds(right, "contact", index, parts...); };
  for (int side = 0; side < 2; ++side)
    if (!tell(used_shape(c.shape[side]) && w_.shapes.at(c.shape[side]).body == c.body[side], "shape[", side, "] is ",
              c.shape[side], " of body ", c.body[side], ", expected a shape in use and its body"))
      return;
  tell(c.body[0] != c.body[1], "both shapes are of one body");
  ContactRecord<D> same = c;
  describe_contact(w_, same);
  const auto& [a, b] = c.shape;
  constexpr std::uint16_t fixed = contact_in_use | contact_sensor | contact_many | contact_events | contact_hit_events |
                                  contact_round | contact_on_disc | contact_at_origin | contact_dynamic;
  tell(((c.flags ^ same.flags) & fixed) == 0 && c.rolls == same.rolls && c.small == same.small &&
           ((c.flags & contact_special) != 0) ==
               (((w_.shapes.at(a).flags | w_.shapes.at(b).flags) & shape_special) != 0),
       "flags are not those of its shapes");
  const bool awake = c.awake_index != none;
  const auto is_awake = [&](std::int32_t body) { return moves(body) && !w_.bodies.is_fixed(body); };
  tell(awake == (is_awake(c.body[0]) || is_awake(c.body[1])), "it is ", awake ? "awake" : "asleep",
       " other than its bodies");
  tell(!awake || (within(c.awake_index, s.awake.size()) && s.awake[std::size_t(c.awake_index)] == index),
       "awake_index is ", c.awake_index, ", where the list of awake contacts has another");
  int count = 0;
  for (std::int32_t m = c.first_manifold; m != none && f_.none_yet(); m = s.manifold(m).next, ++count) {
    if (!tell(within(m, seen.size()) && seen[std::size_t(m)]++ == 0 && s.manifold(m).contact == index,
              "it has manifold ", m, ", which is none, or another's"))
      return;
    const ManifoldRecord<D>& r = s.manifold(m);
    tell(r.anchor <= Anchor::settles && f_.is_bool(r.disabled) && f_.is_bool(r.waits) && r.manifold.count >= 0 &&
             r.manifold.count <= D::max_points,
         "manifold ", m, " has a switch that is neither on nor off, or ", r.manifold.count, " points, expected 0 … ",
         D::max_points);
    tell((r.place.color >= 0) == awake && r.place.color <= overflow_color, "manifold ", m, " is of colour ",
         r.place.color, ", expected ", awake ? "one" : "none");
  }
  tell(count == int(c.manifold_count), "it counts ", int(c.manifold_count), " manifolds, expected ", count);
}

/// Every constraint that says so is in the list of its colour, and no dynamic body is twice in one.
template <class D>
void StateCheck<D>::graph() {
  std::vector<std::uint32_t> masks(w_.bodies.record.size(), 0);
  std::vector<std::int32_t> counts(masks.size(), 0);
  std::size_t manifolds = 0, joints = 0;
  for (int color = 0; color <= color_count && f_.none_yet(); ++color) {
    const auto enter = [&](std::string_view kind, std::int32_t item, std::size_t position, const GraphPlace& place,
                           const std::int32_t(&bodies)[2]) {
      bool once = place.color == color && place.position == std::int32_t(position);
      for (const std::int32_t body : bodies) {
        if (body == none) continue;
        ++counts[std::size_t(body)];
        if (color == overflow_color || !w_.bodies.is_dynamic(body)) continue;
        once = once && (masks[std::size_t(body)] >> color & 1) == 0;
        masks[std::size_t(body)] |= std::uint32_t{1} << color;
      }
      return f_.holds(once, kind, item, "it is in the list of colour ", color,
                      ", expected where it says it is, and each dynamic body once in a colour");
    };
    const GraphColor& c = w_.graph.colors[color];
    int extra = 0;
    for (std::size_t k = 0; k < c.manifolds.size(); ++k, ++manifolds) {
      const std::int32_t m = c.manifolds[k];
      if (!f_.holds(within(m, w_.contacts.manifolds.size()) && w_.contacts.manifold(m).contact != none, "colour", color,
                    "it lists manifold ", m, ", which is none"))
        return;
      const ManifoldRecord<D>& r = w_.contacts.manifold(m);
      if (!enter("manifold", m, k, r.place, w_.contacts.at(r.contact).body)) return;
      extra += needs_extra(r) ? 1 : 0;
    }
    f_.holds(extra == c.extra, "colour", color, "extra is ", c.extra, ", expected ", extra);
    for (std::size_t k = 0; k < c.joints.size(); ++k, ++joints) {
      const std::int32_t j = c.joints[k];
      if (!f_.holds(within(j, w_.joints.headers.size()) && w_.joints.slots.in_use(j), "colour", color,
                    "it lists joint ", j, ", which is none"))
        return;
      if (const JointHeader& h = w_.joints.headers[std::size_t(j)]; !enter("joint", j, k, h.place, h.body)) return;
    }
  }
  for (const ManifoldRecord<D>& m : w_.contacts.manifolds)
    if (m.contact != none && m.place.color >= 0) --manifolds;
  for (std::int32_t j = 0; j < w_.joints.slots.capacity(); ++j)
    if (w_.joints.slots.in_use(j) && w_.joints.headers[std::size_t(j)].place.color >= 0) --joints;
  f_.holds(manifolds == 0 && joints == 0, "graph", -1, "it lists not what says that it is in it");
  for (std::size_t i = 0; i < masks.size() && f_.none_yet(); ++i) {
    if (!w_.bodies.slots.in_use(int(i))) continue;
    const BodyRecord& r = w_.bodies.record[i];
    f_.holds(r.constraint_count == counts[i] && (r.type != BodyType::dynamic || r.color_mask == masks[i]), "body",
             std::ptrdiff_t(i), "it counts ", r.constraint_count, " constraints, expected ", counts[i],
             ", and the colours of these");
  }
}

template <class D>
void StateCheck<D>::sleepers() {
  const SleepingIslands& s = w_.sleeping;
  int listed = 0, asleep = 0;
  for (std::size_t i = 0; i < s.first.size(); ++i)
    for (std::int32_t body = s.first[i]; body != none; body = w_.bodies.record[std::size_t(body)].next_asleep)
      if (!f_.holds(used_body(body) && w_.bodies.record[std::size_t(body)].sleeping_island == std::int32_t(i) &&
                        ++listed <= w_.bodies.slots.size(),
                    "sleeping island", std::ptrdiff_t(i), "it names body ", body,
                    ", which is not in it, or goes in a circle"))
        return;
  for (std::int32_t i = 0; i < w_.bodies.slots.capacity(); ++i)
    asleep += w_.bodies.slots.in_use(i) && w_.bodies.record[std::size_t(i)].sleeping_island != none ? 1 : 0;
  f_.holds(listed == asleep, "sleeping islands", -1, "they name ", listed, " bodies, expected ", asleep);
  f_.holds(is_free_list(s.free, s.first.size(), [&](std::size_t i) { return s.first[i] == none; }), "sleeping islands",
           -1, "the list of free ones is not of those that are free");
}

template <class D>
void StateCheck<D>::effectors() {
  EffectorStore<D>& s = w_.effectors;
  const std::size_t n = std::size_t(s.slots.capacity());
  if (!f_.holds(s.slots.sound() && s.data.size() == n, "effectors", -1,
                "the list of free slots is broken, or they are not of ", n, " slots"))
    return;
  Marks listed(n, 0), joints(w_.joints.headers.size(), 0);
  for (const std::int32_t slot : s.in_order)
    f_.holds(within(slot, n) && s.slots.in_use(slot) && listed[std::size_t(slot)]++ == 0, "effectors", -1,
             "in_order names ", slot, ", which is none, or twice in it");
  f_.holds(s.in_order.size() == std::size_t(s.slots.size()), "effectors", -1, "in_order has ", s.in_order.size(),
           ", expected ", s.slots.size());
  int springs = 0;
  for (std::size_t i = 0; i < n && f_.none_yet(); ++i) {
    if (!s.slots.in_use(int(i))) continue;
    const EffectorData<D>& e = s.data[i];
    const auto tell = [&](bool right, const auto&... parts) {
      return f_.holds(right, "effector", std::ptrdiff_t(i), parts...);
    };
    const bool spring = std::holds_alternative<SpringDamper<D>>(e.definition);
    springs += spring ? 1 : 0;
    tell(spring ? within(e.joint, joints.size()) && w_.joints.slots.in_use(e.joint) &&
                      w_.joints.at(e.joint).internal != 0 && joints[std::size_t(e.joint)]++ == 0
                : e.joint == none,
         "joint is ", e.joint, ", expected ", spring ? "one of its own" : "none");
    std::visit(
        [&](const auto& d) {
          if (!tell(switches_are_bools(f_, d), "a switch of its definition is neither on nor off")) return;
          Complaint c("definition");
          EffectorCheck<D> check{c, w_};
          using Def = std::remove_cvref_t<decltype(d)>;
          if constexpr (std::is_same_v<Def, CustomEffector<D>>)
            check.target(d);  // the caller's own function is not in the bytes
          else if constexpr (!std::is_same_v<Def, Surroundings<D>>)
            check(d);
          if (!c.none_yet()) tell(false, c.error().message);
        },
        e.definition);
  }
  f_.holds(springs == w_.joints.internal_count, "effectors", -1, springs, " are springs, expected ",
           w_.joints.internal_count);
}

}  // namespace carom::rigid::detail
