// Joints by slot: what the user asked for, what they exerted last (to start from in the next step), and the records
// that the solver streams through.
#pragma once

#include <algorithm>
#include <new>
#include <utility>
#include <vector>

#include "carom/core/pool.h"
#include "carom/rigid/detail/joint_header.h"
#include "carom/rigid/detail/joint_tree.h"
#include "carom/rigid/state.h"

namespace carom::rigid::detail {

/// A place on a path: fraction t of the way from knot `segment` to the next. Beyond the ends of an open path it runs
/// straight on, with t below 0 or above 1.
struct PathPlace {
  std::int32_t segment = 0;
  float t = 0;
};

/// Impulses of the last substep, N·s and N·m·s: where the next one starts.
template <class D>
struct JointMemory {
  struct Axis {
    float spring = 0, motor = 0, lower = 0, upper = 0;
  };
  typename D::Vector point{};
  typename D::Angular angular{}, friction{};
  Vec2f hinge{}, slide{};
  Axis linear{};                           ///< of a generic joint along x of frame A
  Axis turn[D::dimension == 2 ? 1 : 2]{};  ///< the cone, of a generic joint about x; twist, of a generic one about z
  float coupling = 0;
  /// Of a gear, rack or screw: what its coordinates have come apart so far, m or rad. Of the first joint of a free
  /// tree: J, what the tree's joints have lost so far and may give back, ≤ 0.
  float drift = 0;
};

/// What only generic and path joints and the springs of effectors have.
template <class D>
struct JointMore {
  typename JointMemory<D>::Axis linear[D::dimension - 1]{}, turn{};  ///< generic: along y and z, about y
  PathPlace path_place{};                                            ///< of a path: where B's anchor is
  typename D::Vector path_normal{};
  float path[2 * (D::dimension - 1)]{};
  std::int32_t first_knot = 0, knot_count = 0;  ///< in the store; a closed path repeats its first point at the end
  bool own_tangents = false;                    ///< they were given
  double stiffness = 0, damping = 0;            ///< N/m, N·s/m, of an effector's spring
  typename D::Position world_anchor{};          ///< of A where A is the world, likewise
  bool fresh_path() const { return path_normal == typename D::Vector{}; }
};

template <class D, class Def>
inline constexpr JointType joint_type_of = [] {
  return []<class... Defs>(std::type_identity<std::variant<Defs...>>) {
    int type = 0;
    (void)((std::is_same_v<Def, Defs> || (++type, false)) || ...);
    return JointType(type);
  }(std::type_identity<AnyJointDef<D>>{});
}();

/// A joint, at the start of a room that has place for its definition too: most are small.
template <class D>
struct JointData {
  JointMemory<D> memory{};
  typename D::Vector force{};    ///< N, on B, in the last substep
  typename D::Angular torque{};  ///< N·m, on B
  std::uint32_t parts : 24 = 0;  ///< blocks that it needs (find_parts, joint_part.h)
  JointType type : 6 = {};
  std::uint32_t large : 1 = 0;     ///< its room is a LargeJoint
  std::uint32_t internal : 1 = 0;  ///< a spring–damper effector lives as a distance joint; users do not see it
  std::uint64_t birth = 0;

  const void* definition() const;
  void* definition() { return const_cast<void*>(std::as_const(*this).definition()); }
  const JointMore<D>& more() const;  ///< of a large one
  JointMore<D>& more() { return const_cast<JointMore<D>&>(std::as_const(*this).more()); }
  const JointFrames<D>& frames() const { return *std::launder(static_cast<const JointFrames<D>*>(definition())); }
  JointFrames<D>& frames() { return const_cast<JointFrames<D>&>(std::as_const(*this).frames()); }
  /// body_a and body_b as the user gave them. Null where it is of another type.
  template <template <class> class Def>
  const Def<D>* get() const {
    if (type != joint_type_of<D, Def<D>>) return nullptr;
    return std::launder(static_cast<const Def<D>*>(definition()));
  }
  template <template <class> class Def>
  Def<D>* get() {
    return const_cast<Def<D>*>(std::as_const(*this).template get<Def>());
  }
  /// f(definition).
  template <class F, std::size_t I = 0>
  decltype(auto) visit(F&& f) const {
    using Def = std::variant_alternative_t<I, AnyJointDef<D>>;
    if constexpr (I + 1 < std::variant_size_v<AnyJointDef<D>>)
      if (std::size_t(type) != I) return visit<F, I + 1>(std::forward<F>(f));
    return f(*std::launder(static_cast<const Def*>(definition())));
  }
  /// Of A, where A is the world; the target of a mouse joint.
  typename D::Position world_anchor() const {
    if (const auto* mouse = get<MouseJointDef>()) return mouse->target;
    return internal ? more().world_anchor : typename D::Position(frames().frame_a.p);
  }
};
template <class D>
struct SmallJoint {
  static constexpr std::size_t room =
      std::max({sizeof(DistanceJointDef<D>), sizeof(HingeJointDef<D>), sizeof(BallJointDef<D>)});
  JointData<D> data{};
  alignas(4) unsigned char definition[room]{};
};
template <class D>
struct LargeJoint {
  static constexpr std::size_t room = sizeof(AnyJointDef<D>);
  JointData<D> data{};
  JointMore<D> more{};
  alignas(8) unsigned char definition[room]{};
};
template <class D>
const void* JointData<D>::definition() const {
  return large ? reinterpret_cast<const LargeJoint<D>*>(this)->definition
               : reinterpret_cast<const SmallJoint<D>*>(this)->definition;
}
template <class D>
const JointMore<D>& JointData<D>::more() const {
  return reinterpret_cast<const LargeJoint<D>*>(this)->more;
}

template <class D>
struct JointStore {
  core::SlotPool<JointTag> slots;
  std::vector<JointHeader> headers;  ///< by slot
  std::vector<std::int32_t> room;    ///< by slot: 2·index in `small`, or in `large` and 1
  std::vector<SmallJoint<D>> small;
  std::vector<LargeJoint<D>> large;
  std::vector<std::int32_t> free_small, free_large;
  std::uint64_t births = 0;
  int internal_count = 0;  ///< joints in `slots` that belong to effectors
  int breakable_count = 0;
  // Knots of all path joints, each one's together: points and tangents in frame A, m along the path from its first.
  std::vector<typename D::Vector> knot_points, knot_tangents;
  std::vector<float> knot_arcs;

  // Of the step, in the order of the graph: records of joint_record.h, one after another.
  std::vector<std::int32_t> order;        ///< slots
  std::vector<std::uint32_t> offset;      ///< of each record in `records`, in units of 16 bytes, one more at the end
  std::vector<std::int32_t> color_begin;  ///< place in `order` at which each colour begins, one more at the end
  struct alignas(16) Unit {
    unsigned char bytes[16];
  };
  std::vector<Unit> records;
  JointTrees<D> trees;
  // Pins that are solved side by side, likewise of the step (joint_lanes.h).
  std::vector<std::int32_t> pins;       ///< slots, each colour filled up with `none` to whole blocks
  std::vector<std::int32_t> pin_begin;  ///< block at which each colour begins, one more at the end
  void* pin_blocks = nullptr;           ///< PinLanes, in the arena of the step
  // Limbs likewise (joint_limb_lanes.h), in each colour those with the same parts together.
  struct Limb {
    std::uint32_t parts = 0;
    std::int32_t joint = none;  ///< slot
    friend bool operator<(const Limb& l, const Limb& r) {
      return l.parts != r.parts ? l.parts < r.parts : l.joint < r.joint;
    }
  };
  std::vector<Limb> limbs;
  std::vector<std::int32_t> limb_begin;
  void* limb_blocks = nullptr;  ///< LimbLanes

  explicit JointStore(std::uint16_t world) : slots(world) {}
  int count() const { return slots.size() - internal_count; }
  JointData<D>& at(std::int32_t slot) { return const_cast<JointData<D>&>(std::as_const(*this).at(slot)); }
  const JointData<D>& at(std::int32_t slot) const {
    const std::int32_t at = room[std::size_t(slot)];
    return at & 1 ? large[std::size_t(at >> 1)].data : small[std::size_t(at >> 1)].data;
  }
  /// A room for the joint of a slot that has none.
  template <class Def>
  JointData<D>& make(std::int32_t slot, const Def& definition, bool internal = false) {
    static_assert(sizeof(Def) <= LargeJoint<D>::room && std::is_trivially_copyable_v<Def>);
    if (std::size_t(slot) >= room.size()) {
      core::grow_a_little(room);
      core::grow_a_little(headers);
      room.resize(std::size_t(slot) + 1, none);
      headers.resize(std::size_t(slot) + 1);
    }
    headers[std::size_t(slot)] = {};
    constexpr bool is_small = sizeof(Def) <= SmallJoint<D>::room && alignof(Def) <= 4;
    if (is_small && !internal) return settle<Def>(small[std::size_t(take(slot, small, free_small))], definition);
    JointData<D>& data = settle<Def>(large[std::size_t(take(slot, large, free_large))], definition);
    data.internal = internal ? 1 : 0;
    return data;
  }
  void drop(std::int32_t slot) {
    const std::int32_t at = room[std::size_t(slot)];
    if (at & 1)
      large[std::size_t(at >> 1)] = {};
    else
      small[std::size_t(at >> 1)] = {};
    (at & 1 ? free_large : free_small).push_back(at >> 1);
    room[std::size_t(slot)] = none;
    headers[std::size_t(slot)] = {};
  }
  /// Place in JointTrees::joints, or `none`: solved by iteration.
  std::int32_t tree_of(std::int32_t joint) const {
    return std::size_t(joint) < trees.of_joint.size() ? trees.of_joint[std::size_t(joint)] : none;
  }

 private:
  template <class T>
  std::int32_t take(std::int32_t slot, std::vector<T>& rooms, std::vector<std::int32_t>& free) {
    if (free.empty()) {
      core::grow_a_little(rooms);
      free.push_back(std::int32_t(rooms.size()));
      rooms.emplace_back();
    }
    const std::int32_t place = free.back();
    free.pop_back();
    room[std::size_t(slot)] = 2 * place + std::is_same_v<T, LargeJoint<D>>;
    return place;
  }
  template <class Def, class T>
  JointData<D>& settle(T& joint, const Def& definition) {
    joint.data.large = std::is_same_v<T, LargeJoint<D>> ? 1 : 0;
    joint.data.type = joint_type_of<D, Def>;
    joint.data.birth = ++births;
    if constexpr (sizeof(Def) <= T::room) ::new (static_cast<void*>(joint.definition)) Def(definition);
    return joint.data;
  }
};

}  // namespace carom::rigid::detail
