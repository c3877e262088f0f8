// Joints by slot: what the user asked for, what they exerted last (to start from in the next step), and the records
// that the solver streams through.
#pragma once

#include <vector>

#include "carom/core/pool.h"
#include "carom/rigid/detail/joint_header.h"
#include "carom/rigid/detail/joint_lanes.h"
#include "carom/rigid/detail/joint_limb_lanes.h"
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
  Axis linear[D::dimension]{};             ///< along x, y, z of frame A; of others than generic joints the first
  Axis turn[D::dimension == 2 ? 1 : 3]{};  ///< about them; twist: the last, cone: the first
  float coupling = 0;
  PathPlace path_place{};  ///< of a path: where B's anchor is
  typename D::Vector path_normal{};
  float path[2 * (D::dimension - 1)]{};
  bool fresh_path() const { return path_normal == typename D::Vector{}; }
  /// Of a gear, rack or screw: what its coordinates have come apart so far, m or rad. Of the first joint of a free
  /// tree: J, what the tree's joints have lost so far and may give back, ≤ 0.
  float drift = 0;
};

template <class D>
struct JointData {
  AnyJointDef<D> definition{};  ///< body_a and body_b as the user gave them
  JointMemory<D> memory{};
  typename D::Vector force{};           ///< N, on B, in the last substep
  typename D::Angular torque{};         ///< N·m, on B
  typename D::Position world_anchor{};  ///< of A where A is the world; the target of a mouse joint
  std::uint64_t birth = 0;
  /// A spring–damper effector lives as a distance joint with these instead of a frequency; users do not see it.
  bool internal = false;
  double stiffness = 0, damping = 0;  ///< N/m, N·s/m
  /// Of a path: its knots in the store; a closed one repeats its first point at the end.
  std::int32_t first_knot = 0, knot_count = 0;
  bool own_tangents = false;  ///< they were given
};

template <class D>
struct JointStore {
  core::SlotPool<JointTag> slots;
  std::vector<JointHeader> headers;  ///< by slot
  std::vector<JointData<D>> data;    ///< by slot
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
  PinKernels<D> pin_kernels{};
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
  LimbKernels<D> limb_kernels{};

  explicit JointStore(std::uint16_t world) : slots(world) {}
  int count() const { return slots.size() - internal_count; }
  /// Place in JointTrees::joints, or `none`: solved by iteration.
  std::int32_t tree_of(std::int32_t joint) const {
    return std::size_t(joint) < trees.of_joint.size() ? trees.of_joint[std::size_t(joint)] : none;
  }
};

}  // namespace carom::rigid::detail
