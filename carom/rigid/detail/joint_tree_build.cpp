// Which joints are solved directly: the trees of joint_tree.h.
#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {
namespace {

/// Iteration gives way by (load over mass)·g/ω²; from here on that is more than the direct solver costs. A ragdoll's
/// worst joint has about 8, a chain of ten links 20.
constexpr double direct_mass_ratio = 16;
/// The same for what holds against turning: moments of inertia about the joint over those of its bodies. One beam on a
/// wall has 4, three have 109.
constexpr double direct_inertia_ratio = 64;

/// m r²/I of a body that hangs at r from its centre. Above it the body swings about its centre faster than soft joints
/// can follow: the bob of a pendulum. A rod held at its end has 3.
constexpr double direct_arm_ratio = 16;

template <class D>
bool has_rigid_rows(const JointData<D>& data) {
  const std::uint32_t parts = data.parts;
  if ((parts & (part_pin | part_hinge | part_slide | part_path)) != 0) return true;
  return is_rod(data) || holds_axes(data) || ((parts & part_angular) != 0 && turns_rigidly(data));
}

/// Of a slender body iteration makes energy there: a little of what pushes it across its length spins it fast about it.
template <class D>
bool holds_more_than_a_point(const JointData<D>& data) {
  return (data.parts & (part_hinge | part_slide)) != 0 || is_rod(data) || holds_axes(data) || turns_rigidly(data);
}

template <class D>
class Builder {
 public:
  explicit Builder(WorldImplementation<D>& world) : world_(world), joints_(world.joints), trees_(world.joints.trees) {}

  void build() {
    trees_.trees.clear();
    trees_.bodies.clear();
    trees_.joints.clear();
    trees_.of_joint.assign(joints_.headers.size(), none);
    if (world_.definition.joint_solver == JointSolver::iterative || joints_.slots.size() == 0) return;
    trees_.visited.assign(joints_.headers.size(), 0);
    trees_.place.assign(world_.bodies.record.size(), none);
    for (std::size_t slot = 0; slot < joints_.headers.size(); ++slot)
      if (trees_.visited[slot] == 0 && takes_part(std::int32_t(slot))) component(std::int32_t(slot));
  }

 private:
  bool takes_part(std::int32_t joint) const {
    return joints_.headers[std::size_t(joint)].place.color >= 0 && has_rigid_rows(joints_.at(joint));
  }
  bool is_node(std::int32_t body) const {
    return body != none && world_.bodies.is_dynamic(body) && world_.bodies.motion[std::size_t(body)].inverse_mass > 0;
  }
  /// Calls f(joint, other body, is the body B?) for the rigid joints of a body.
  template <class F>
  void for_joints(std::int32_t body, F&& f) const {
    for_each_joint(world_, body, [&](std::int32_t joint, int side, std::int32_t other) {
      if (takes_part(joint)) f(joint, other, side == 1);
    });
  }

  void component(std::int32_t seed) {
    const JointHeader& header = joints_.headers[std::size_t(seed)];
    const std::int32_t start = is_node(header.body[0]) ? header.body[0] : header.body[1];
    trees_.visited[std::size_t(seed)] = 1;
    if (!is_node(start)) return;
    const std::size_t first_body = trees_.bodies.size(), first_joint = first_joint_ = trees_.joints.size();
    // Who belongs to it, and where it hangs.
    std::int32_t ground = none;
    int joint_ends = 0, ground_joints = 0;
    add_body(start);
    for (std::size_t i = first_body; i < trees_.bodies.size(); ++i)
      for_joints(trees_.bodies[i].body, [&](std::int32_t joint, std::int32_t other, bool) {
        trees_.visited[std::size_t(joint)] = 1;
        if (is_node(other)) {
          ++joint_ends;
          if (trees_.place[std::size_t(other)] == none) add_body(other);
        } else {
          ++ground_joints;
          if (ground == none || joint < ground) ground = joint;
        }
      });
    const int bodies = int(trees_.bodies.size() - first_body), loops = joint_ends / 2 - (bodies - 1);
    // From the root outward.
    const std::int32_t root = ground == none ? trees_.bodies[first_body].body : body_of(ground);
    for (std::size_t i = first_body; i < trees_.bodies.size(); ++i)
      trees_.place[std::size_t(trees_.bodies[i].body)] = none;
    trees_.bodies.resize(first_body);
    if (4 * loops > bodies) return;  // a net: what a tree could hold of it is not worth it
    add_body(root);
    if (ground != none) add_joint(ground, std::int32_t(first_body), none);
    for (std::size_t i = first_body; i < trees_.bodies.size(); ++i)
      for_joints(trees_.bodies[i].body, [&](std::int32_t joint, std::int32_t other, bool) {
        if (!is_node(other) || trees_.place[std::size_t(other)] != none) return;
        const std::int32_t child = std::int32_t(trees_.bodies.size());
        add_body(other);
        add_joint(joint, child, std::int32_t(i));
      });
    const std::size_t closing = trees_.joints.size();
    for (std::size_t i = first_body; i < trees_.bodies.size(); ++i)
      for_joints(trees_.bodies[i].body, [&](std::int32_t joint, std::int32_t other, bool) {
        if (is_node(other) || joint == ground) return;
        add_joint(joint, std::int32_t(i), none);
      });
    const bool wanted = world_.definition.joint_solver == JointSolver::direct || is_hard(first_body, ground != none);
    if (!wanted) {
      for (std::size_t j = first_joint; j < trees_.joints.size(); ++j)
        trees_.of_joint[std::size_t(trees_.joints[j].joint)] = none;
      trees_.bodies.resize(first_body);
      trees_.joints.resize(first_joint);
      return;
    }
    TreeRange& tree = trees_.trees.emplace_back();
    tree.first_body = std::int32_t(first_body);
    tree.body_end = std::int32_t(trees_.bodies.size());
    tree.first_joint = std::int32_t(first_joint);
    tree.closing = std::int32_t(closing);
    tree.joint_end = std::int32_t(trees_.joints.size());
    tree.free = ground == none;
    for (std::size_t i = first_body; i < trees_.bodies.size(); ++i)
      tree.slender = tree.slender || is_slender(world_.bodies.motion[std::size_t(trees_.bodies[i].body)]);
    for (std::size_t j = first_joint; j < trees_.joints.size(); ++j) {
      const JointHeader& on = joints_.headers[std::size_t(trees_.joints[j].joint)];
      for (const std::int32_t body : on.body)
        if (body != none && world_.bodies.record[std::size_t(body)].type == BodyType::kinematic)
          tree.moving_ground = true;
    }
  }

  std::int32_t body_of(std::int32_t joint) const {
    const JointHeader& header = joints_.headers[std::size_t(joint)];
    return is_node(header.body[0]) ? header.body[0] : header.body[1];
  }
  void add_body(std::int32_t body) {
    trees_.place[std::size_t(body)] = std::int32_t(trees_.bodies.size());
    trees_.bodies.emplace_back().body = body;
  }
  void add_joint(std::int32_t joint, std::int32_t child, std::int32_t parent) {
    const std::int32_t place = std::int32_t(trees_.joints.size());
    TreeJoint<D>& added = trees_.joints.emplace_back();
    added.joint = joint;
    added.child = child;
    added.parent = parent;
    const JointHeader& header = joints_.headers[std::size_t(joint)];
    added.child_is_b = header.body[1] == trees_.bodies[std::size_t(child)].body;
    trees_.of_joint[std::size_t(joint)] = place;
    if (parent != none || std::size_t(place) == first_joint_) trees_.bodies[std::size_t(child)].joint = place;
  }

  /// Where the joint sits on one of its bodies, from that body's centre of mass.
  typename D::Vector arm(std::int32_t joint, bool on_b) const {
    const JointFrames<D>& frames = joints_.at(joint).frames();
    const std::int32_t body = joints_.headers[std::size_t(joint)].body[on_b ? 1 : 0];
    const auto center = world_.bodies.motion[std::size_t(body)].local_center;
    return (on_b ? frames.frame_b.p : frames.frame_a.p) - center;
  }
  double inverse_inertia(std::int32_t body) const {
    const BodyMotion<D>& m = world_.bodies.motion[std::size_t(body)];
    double mean;
    if constexpr (D::dimension == 2)
      mean = double(m.inertia);
    else
      mean = (double(m.inertia.cx.x) + double(m.inertia.cy.y) + double(m.inertia.cz.z)) / 3;
    return mean > 0 ? 1 / mean : 0;
  }

  /// Does some joint carry much more than its own bodies? Stretched out as far as it may, because the answer must not
  /// depend on where the bodies happen to be.
  bool is_hard(std::size_t first_body, bool grounded) {
    struct Load {
      double mass, moment, inertia;  ///< Σ m, Σ m d, Σ m d² from the joint to the parent
    };
    const std::size_t count = trees_.bodies.size() - first_body;
    const std::span<Load> loads = world_.arena.template allocate_zeroed<Load>(count);
    double total = 0;
    for (std::size_t i = 0; i < count; ++i)
      total += double(world_.bodies.motion[std::size_t(trees_.bodies[first_body + i].body)].mass);
    for (std::size_t i = count; i-- > 0;) {
      const TreeBody<D>& body = trees_.bodies[first_body + i];
      if (body.joint == none) continue;
      const TreeJoint<D>& joint = trees_.joints[std::size_t(body.joint)];
      const BodyMotion<D>& motion = world_.bodies.motion[std::size_t(body.body)];
      const auto own_arm = arm(joint.joint, joint.child_is_b);
      const double d = double(math::length(own_arm)), m = double(motion.mass);
      Load& load = loads[i];
      load.mass += m;
      load.moment += m * d;
      load.inertia += m * d * d;
      double inverse_mass = double(motion.inverse_mass), inverse_turn = inverse_inertia(body.body);
      if (joint.parent != none) {
        const TreeBody<D>& parent = trees_.bodies[std::size_t(joint.parent)];
        inverse_mass += double(world_.bodies.motion[std::size_t(parent.body)].inverse_mass);
        inverse_turn += inverse_inertia(parent.body);
      }
      const double carried = grounded ? load.mass : min(load.mass, total - load.mass);
      const JointData<D>& data = joints_.at(joint.joint);
      const bool turns = (data.parts & (part_hinge | part_angular | part_turn_x | part_turn_y | part_turn_z)) != 0 &&
                         (grounded || turns_rigidly(data));  // the hinges of a free figure bear little
      if ((data.parts & part_path) != 0) return true;        // a bead lives by its energy
      if (is_slender(motion) && holds_more_than_a_point(data)) return true;
      if (carried * inverse_mass > direct_mass_ratio) return true;
      if (m * d * d * inverse_inertia(body.body) > direct_arm_ratio) return true;
      if (turns && load.inertia * (carried / load.mass) * inverse_turn > direct_inertia_ratio) return true;
      if (joint.parent == none) continue;
      const TreeBody<D>& parent = trees_.bodies[std::size_t(joint.parent)];
      double l = 0;
      if (parent.joint != none) {
        const TreeJoint<D>& next = trees_.joints[std::size_t(parent.joint)];
        l = double(math::length(arm(joint.joint, !joint.child_is_b) - arm(next.joint, next.child_is_b)));
      }
      Load& up = loads[std::size_t(joint.parent) - first_body];
      up.mass += load.mass;
      up.moment += load.moment + l * load.mass;
      up.inertia += load.inertia + l * (2 * load.moment + l * load.mass);
    }
    return false;
  }

  WorldImplementation<D>& world_;
  JointStore<D>& joints_;
  JointTrees<D>& trees_;
  std::size_t first_joint_ = 0;  ///< of the tree being built
};

}  // namespace

template <class D>
void build_trees(WorldImplementation<D>& world) {
  if (!world.joints.trees.stale) return;
  world.joints.trees.stale = false;
  Builder<D>(world).build();
}
template void build_trees(WorldImplementation<Dim2>&);
template void build_trees(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
