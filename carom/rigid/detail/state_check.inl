// Is what stands in the stores the state of a world? Asked of snapshots that came as bytes before they are let in:
// every index, link, list, count and switch, in time proportional to the size. What a step or a call trusts is checked
// here; numbers that only make motion strange are not, apart from those that creation would refuse.
#pragma once

#include <cstring>

#include "carom/rigid/detail/stages.h"
#include "carom/rigid/detail/world_effectors.inl"
#include "carom/rigid/detail/world_joints.inl"
#include "carom/rigid/detail/world_shapes.inl"

namespace carom::rigid::detail {

/// Handles inside the state name the world that they were made by.
template <class D>
void adopt_handles(WorldImplementation<D>& world) {
  const std::uint16_t number = world.world_number;
  const auto adopt = [number](auto& handle) {
    if (!handle.is_null()) handle.world = number;
  };
  for (int slot = 0; slot < world.joints.slots.capacity(); ++slot)
    if (world.joints.slots.in_use(slot)) {
      JointFrames<D>& frames = world.joints.at(slot).frames();
      adopt(frames.body_a), adopt(frames.body_b);
    }
  for (EffectorData<D>& effector : world.effectors.data)
    std::visit(
        [&](auto& d) {
          if constexpr (requires { d.body_a; })
            adopt(d.body_a), adopt(d.body_b);
          else if constexpr (requires { d.body; })
            adopt(d.body);
        },
        effector.definition);
  for (ContactEndEvent& e : world.scratch.pending_contact_end) adopt(e.shape_a), adopt(e.shape_b);
  for (SensorEvent& e : world.scratch.pending_sensor_end) adopt(e.sensor), adopt(e.visitor);
}

/// The first fault found: which thing, and what is wrong with it. Bytes of a bool are read as bytes.
class StateFault {
 public:
  bool none_yet() const { return message_.empty(); }
  const std::string& message() const { return message_; }
  /// `kind` #index: …; numbers of things are told from 1, as everywhere. Without a number: index < 0.
  template <class... Parts>
  void say(std::string_view kind, std::ptrdiff_t index, const Parts&... parts) {
    if (!none_yet()) return;
    message_ = index < 0 ? core::text(kind, ": ", parts...) : core::text(kind, " #", index + 1, ": ", parts...);
  }
  /// Says so where it does not hold.
  template <class... Parts>
  bool holds(bool true_of_it, std::string_view kind, std::ptrdiff_t index, const Parts&... parts) {
    if (!true_of_it) say(kind, index, parts...);
    return true_of_it;
  }
  bool is_bool(const bool& x) {
    std::uint8_t byte;
    std::memcpy(&byte, &x, 1);
    return byte <= 1;
  }

 private:
  std::string message_;
};

template <class D>
class StateCheck {
 public:
  /// Joints and handles of the world must be its own to change: their parts are found anew, their handles adopted.
  explicit StateCheck(WorldImplementation<D>& world) : w_(world) {}
  Status run() {
    definition();
    if (f_.none_yet()) bodies();
    if (f_.none_yet()) shapes();
    if (f_.none_yet()) joints();
    if (f_.none_yet()) contacts();
    if (f_.none_yet()) graph();
    if (f_.none_yet()) sleepers();
    if (f_.none_yet()) adopt_handles(w_), effectors();
    if (f_.none_yet()) return {};
    return core::Error{core::text("World::restore: the snapshot is corrupt: ", f_.message())};
  }

 private:
  using Marks = std::vector<std::uint8_t>;
  static bool within(std::int32_t i, std::size_t count) { return i >= 0 && std::size_t(i) < count; }
  static bool finite_inertia(float x) { return is_finite(x); }
  static bool finite_inertia(const Mat3f& m) {
    return math::is_finite(m.cx) && math::is_finite(m.cy) && math::is_finite(m.cz);
  }
  bool used_body(std::int32_t i) const { return within(i, w_.bodies.record.size()) && w_.bodies.slots.in_use(i); }
  bool used_shape(std::int32_t i) const { return within(i, w_.shapes.record.size()) && w_.shapes.slots.in_use(i); }
  bool moves(std::int32_t body) const {
    return body != none && w_.bodies.record[std::size_t(body)].awake_index != none;
  }
  bool rests(std::int32_t body) const { return body != none && w_.bodies.is_dynamic(body) && !moves(body); }
  /// Entries of a list of what is free: places below `count`, each once, of which `is_free(place)`.
  template <class F>
  bool is_free_list(const std::vector<std::int32_t>& list, std::size_t count, F&& is_free) const {
    Marks seen(count, 0);
    for (const std::int32_t i : list)
      if (!within(i, count) || seen[std::size_t(i)]++ != 0 || !is_free(std::size_t(i))) return false;
    return true;
  }

  void definition() {
    const WorldDef<D>& d = w_.definition;
    f_.holds(f_.is_bool(d.allow_sleep) && f_.is_bool(d.continuous) && f_.is_bool(d.move_events) &&
                 d.joint_solver <= JointSolver::direct,
             "world definition", -1, "a switch is neither on nor off");
    if (!f_.none_yet()) return;
    if (const Status s = check_definition<D>("world definition", d); !s.ok()) f_.say("world", -1, s.error().message);
    f_.holds(is_finite(w_.time) && w_.last_dt > 0 && w_.last_dt <= 1, "world", -1, "time is ", w_.time,
             " s and the last step ", w_.last_dt, " s, expected finite times and a step of at most 1 s");
    for (std::size_t i = 0; i < w_.pair_rules.size(); ++i) {
      const PairRule& r = w_.pair_rules[i].rule;
      f_.holds(i == 0 || w_.pair_rules[i - 1].key < w_.pair_rules[i].key, "pair rule", std::ptrdiff_t(i),
               "its materials are not behind those of the one before");
      Complaint c("rule");
      check_material(c, "rule", {r.friction, r.restitution, r.rolling_resistance, r.spinning_resistance});
      check_range(c, "static_friction", r.static_friction, 0, 1e6);
      if (!c.none_yet()) f_.say("pair rule", std::ptrdiff_t(i), c.error().message);
    }
  }

  void bodies() {
    BodyStore<D>& b = w_.bodies;
    if (!f_.holds(b.slots.sound(), "bodies", -1, "the list of free slots is broken")) return;
    const std::size_t n = std::size_t(b.slots.capacity());
    if (!f_.holds(b.solver.size() == n && b.pose.size() == n && b.motion.size() == n && b.record.size() == n &&
                      b.birth.size() == n && b.names.size() <= n && b.user_data.size() <= n && b.time_scale.size() <= n,
                  "bodies", -1, "their arrays are not of ", n, " slots each"))
      return;
    for (std::size_t i = 0; i < b.time_scale.size(); ++i)
      f_.holds(b.time_scale[i] >= 1e-3f && b.time_scale[i] <= 1e3f, "body", std::ptrdiff_t(i), "time_scale is ",
               b.time_scale[i], ", expected .001 … 1000");
    std::size_t awake = 0;
    int wishes = 0;
    for (std::size_t i = 0; i < n && f_.none_yet(); ++i) {
      const BodyRecord& r = b.record[i];
      const BodyMotion<D>& m = b.motion[i];
      const auto tell = [&](bool right, const auto&... parts) { f_.holds(right, "body", std::ptrdiff_t(i), parts...); };
      tell(f_.is_bool(m.gyroscopic), "gyroscopic is neither yes nor no");
      tell(m.load_level < LoadShares::count, "load_level is ", m.load_level, ", expected below ", LoadShares::count);
      tell(m.load_limit < LoadShares::count, "load_limit is ", m.load_limit, ", expected below ", LoadShares::count);
      tell(m.slender == 0 || D::dimension == 2 || (m.slender & 3) != 0, "slender names no axis");
      if (!b.slots.in_use(int(i))) continue;
      tell(r.type <= BodyType::dynamic, "type is ", int(r.type), ", expected fixed, kinematic or dynamic");
      tell(r.locks < 64 && r.substeps <= 64, "locks or substeps are out of range");
      const SolverBody<D>& s = b.solver[i];
      tell(math::is_finite(s.linear_velocity) && math::is_finite(s.angular_velocity), "its velocity is not finite");
      tell(math::is_finite(b.pose[i].position) && math::is_finite(m.center) && math::is_finite(m.local_center),
           "its position is not finite");
      Complaint turn("pose");
      turn.rotation("rotation", b.pose[i].rotation);
      tell(turn.none_yet(), "its rotation has not norm 1");
      tell(math::is_finite(m.inverse_mass) && math::is_finite(m.mass) && finite_inertia(m.inertia) &&
               finite_inertia(m.world_inverse_inertia),
           "its mass or inertia is not finite");
      wishes += r.substeps > 0 ? 1 : 0;
      if (r.awake_index == none) continue;
      ++awake;
      tell(r.type != BodyType::fixed && r.enabled() && r.awake() && r.sleeping_island == none,
           "it is among those that move, expected it enabled, awake and not fixed");
      tell(within(r.awake_index, b.awake.size()) && b.awake[std::size_t(r.awake_index)] == std::int32_t(i),
           "awake_index is ", r.awake_index, ", where the list of awake bodies has another");
    }
    f_.holds(awake == b.awake.size(), "bodies", -1, "the list of awake bodies has ", b.awake.size(), ", expected ",
             awake);
    f_.holds(wishes == b.substep_wishes, "bodies", -1, "substep_wishes is ", b.substep_wishes, ", expected ", wishes);
  }

  void shapes() {
    ShapeStore<D>& s = w_.shapes;
    const std::size_t n = std::size_t(s.slots.capacity());
    if (!f_.holds(s.slots.sound() && s.record.size() == n && s.user_data.size() <= n, "shapes", -1,
                  "the list of free slots is broken, or arrays are not of ", n, " slots"))
      return;
    for (int t = 0; t < 3; ++t)
      if (!f_.holds(s.trees[t].valid(), "tree", t, "its nodes do not form a tree of boxes within boxes")) return;
    std::vector<std::int32_t> users(s.terms.count(), 0);
    int leaves[3] = {}, special = 0, surfaces = 0, hits = 0;
    for (std::size_t i = 0; i < n && f_.none_yet(); ++i) {
      const ShapeRecord<D>& r = s.record[i];
      const auto tell = [&](bool right, const auto&... parts) {
        f_.holds(right, "shape", std::ptrdiff_t(i), parts...);
      };
      tell(f_.is_bool(r.at_origin), "at_origin is neither yes nor no");
      if (!s.slots.in_use(int(i)) || !f_.none_yet()) continue;
      if (tell(used_body(r.body), "body is ", r.body, ", expected one in use"); !f_.none_yet()) return;
      const BodyRecord& body = w_.bodies.record[std::size_t(r.body)];
      Complaint c("local");
      check_size(c, "local.p", r.local.p, max_size);
      c.rotation("local.q", r.local.q);
      tell(c.none_yet() && (!r.at_origin || r.local == typename D::Transform{}),
           "its place in the body is out of range, or not where at_origin says");
      tell(((r.flags & shape_many) != 0) == is_many(r.geometry) &&
               ((r.flags & shape_round) != 0) == is_round(r.geometry),
           "flags are not those of its geometry");
      tell(r.outer_extent >= 0 && r.inner_extent >= 0 && r.margin >= 0 && is_finite(r.margin),
           "extents or margin are negative or no numbers");
      tell(body.type != BodyType::dynamic || check_dynamic(r.geometry, 0).ok(),
           "its geometry has no inside, expected one that a dynamic body can have");
      if (tell(within(r.terms, users.size()), "terms is ", r.terms, ", expected below ", users.size()); !f_.none_yet())
        return;
      ++users[std::size_t(r.terms)];
      special += (r.flags & shape_special) != 0 ? 1 : 0;
      hits += (r.flags & shape_hit_events) != 0 ? 1 : 0;
      surfaces += is_moving_surface(w_, std::int32_t(i)) ? 1 : 0;
      if (r.leaf == none) continue;
      const int tree = body.type == BodyType::fixed
                           ? tree_fixed
                           : (body.type == BodyType::kinematic ? tree_kinematic : tree_dynamic);
      tell(r.tree == tree && s.trees[tree].has_leaf(r.leaf, std::uint32_t(i)), "leaf is ", r.leaf,
           ", which is not of this shape in the tree of its body's type");
      ++leaves[tree];
    }
    for (int t = 0; t < 3; ++t)
      f_.holds(leaves[t] == s.trees[t].size(), "tree", t, "it has ", s.trees[t].size(), " leaves, expected ",
               leaves[t]);
    for (std::size_t i = 0; i < users.size() && f_.none_yet(); ++i) {
      const ShapeTerms& terms = s.terms[std::int32_t(i)];
      if (users[i] == 0) continue;
      Complaint c("shape");
      check_range(c, "density", terms.density, 0, max_density);
      check_material(c, "material", terms.material);
      if (!c.none_yet()) f_.say("shape terms", std::ptrdiff_t(i), c.error().message);
    }
    f_.holds(s.terms.sound(users), "shapes", -1, "their terms are not counted as they are used");
    f_.holds(hits == w_.hit_event_shapes, "shapes", -1, "hit_event_shapes is ", w_.hit_event_shapes, ", expected ",
             hits);
    f_.holds(surfaces == s.moving_surfaces, "shapes", -1, "moving_surfaces is ", s.moving_surfaces, ", expected ",
             surfaces);
    extras(special);
    shapes_of_bodies();
    Marks moved(n, 0);
    for (const std::int32_t shape : w_.scratch.moved)
      f_.holds(within(shape, n) && moved[std::size_t(shape)]++ == 0 && (s.at(shape).flags & shape_moved) != 0,
               "list of moved shapes", -1, "it names ", shape, ", which is none, or twice in it");
  }

  /// In the order of their slots; each shape's surfaces together, numbered from 0.
  void extras(int special) {
    const ShapeStore<D>& s = w_.shapes;
    std::size_t surface = 0;
    for (std::size_t i = 0; i < s.extras.size() && f_.none_yet(); ++i) {
      const ShapeExtra<D>& e = s.extras[i];
      f_.holds(used_shape(e.shape) && (i == 0 || s.extras[i - 1].shape < e.shape) &&
                   (s.at(e.shape).flags & shape_special) != 0 && f_.is_bool(e.modify) && e.surface_count >= 0,
               "shape extra", std::ptrdiff_t(i), "shape is ", e.shape,
               ", which is none, not special or not behind the one before");
      f_.holds(math::is_finite(e.surface_velocity) && math::is_finite(e.one_way), "shape extra", std::ptrdiff_t(i),
               "it is not finite");
      for (std::int32_t k = 0; k < e.surface_count && f_.none_yet(); ++k, ++surface) {
        if (!f_.holds(
                surface < s.surfaces.size() && s.surfaces[surface].shape == e.shape && s.surfaces[surface].number == k,
                "shape extra", std::ptrdiff_t(i), "it has not the ", e.surface_count, " surfaces that it says"))
          return;
        Complaint c("surface");
        check_surface<D>(c, std::size_t(k), s.surfaces[surface].surface);
        if (!c.none_yet()) f_.say("shape extra", std::ptrdiff_t(i), c.error().message);
      }
    }
    f_.holds(surface == s.surfaces.size() && std::size_t(special) == s.extras.size(), "shapes", -1,
             "special shapes and their entries are not as many");
  }

  /// Every shape is once in the list of its body.
  void shapes_of_bodies() {
    int listed = 0;
    for (std::int32_t i = 0; i < w_.bodies.slots.capacity() && f_.none_yet(); ++i) {
      if (!w_.bodies.slots.in_use(i)) continue;
      for (std::int32_t s = w_.bodies.record[std::size_t(i)].first_shape; s != none; s = w_.shapes.at(s).next)
        if (!f_.holds(used_shape(s) && w_.shapes.at(s).body == i && ++listed <= w_.shapes.slots.size(), "body", i,
                      "its list of shapes names ", s, ", which is not its own, or goes in a circle"))
          return;
    }
    f_.holds(listed == w_.shapes.slots.size(), "shapes", -1, "bodies have ", listed, " in their lists, expected ",
             w_.shapes.slots.size());
  }

  /// The doubly linked lists that lead from bodies to what they take part in, by keys 2·item + side.
  template <class First, class Count, class Item>
  void edges(std::string_view kind, std::size_t expected, std::size_t items, First&& first, Count&& count,
             Item&& item) {
    std::size_t listed = 0;
    for (std::int32_t i = 0; i < w_.bodies.slots.capacity(); ++i) {
      if (!w_.bodies.slots.in_use(i)) continue;
      std::int32_t previous = none, found = 0;
      for (std::int32_t key = first(w_.bodies.record[std::size_t(i)]); key != none;) {
        const auto* const e = within(key, 2 * items) ? item(key >> 1) : nullptr;
        if (!f_.holds(e != nullptr && e->body[key & 1] == i && e->previous[key & 1] == previous && ++listed <= expected,
                      "body", i, "its list of ", kind, " names ", key / 2,
                      ", which is not its own, or goes in a circle"))
          return;
        ++found;
        previous = key;
        key = e->next[key & 1];
      }
      if (!f_.holds(found == count(w_.bodies.record[std::size_t(i)]), "body", i, "it counts ",
                    count(w_.bodies.record[std::size_t(i)]), " ", kind, ", expected ", found))
        return;
    }
    f_.holds(listed == expected, kind, -1, "bodies have ", listed, " ends in their lists, expected ", expected);
  }
  // state_check_constraints.inl
  void joints();
  void joint(std::int32_t slot, Marks& knots);
  template <class Def>
  void joint_definition(std::int32_t slot, const Def& definition, Marks& knots);
  void contacts();
  void contact(std::int32_t index, Marks& seen);
  void graph();
  void sleepers();
  void effectors();

  WorldImplementation<D>& w_;
  StateFault f_;
};

}  // namespace carom::rigid::detail

#include "carom/rigid/detail/state_check_constraints.inl"
