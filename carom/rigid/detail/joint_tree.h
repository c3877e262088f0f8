// Trees of joints that are solved directly. Iteration shares an impulse with the next joint only, so that a chain of n
// links, or one with a heavy end, gives way by its load over the mass of the lightest link. The rigid rows of a tree
// are therefore solved at once by a block-sparse LDLᵀ without fill (Baraff, "Linear-time dynamics using Lagrange
// multipliers", 1996), in double:
//
//   [ M  −Jᵀ ] [Δv]   [ 0 ]      M: mass, J: rows of the joints, E: a trace of compliance that keeps redundant
//   [ J   E  ] [Δλ] = [−r ]      rows solvable, r: what the rows' velocity should change by
//
// Bodies are eliminated before the joint to their parent, from the leaves on; each leaves its inertia as seen through
// the joint on the parent's block. Before positions move, r asks that the *positions at the end of the substep* meet
// the joint; after it, that the velocities do: the constrained symplectic scheme of Andersen ("Rattle", 1983), which
// keeps energy. Limits, motors and springs are solved one after the other, each with the
// mass that moves with it through the tree, and what each gives goes to all bodies at once. Contacts and whatever else
// pushes the bodies stay with the iterative solver; the tree has the last word in each pass. Where a component has
// loops, the joints that close them stay with the iterative solver too.
#pragma once

#include <vector>

#include "carom/rigid/detail/body_store.h"

namespace carom::rigid::detail {

template <class D>
struct WorldImplementation;
template <class D>
struct StepContext;
enum class SolverPass : std::uint8_t;

template <class D>
struct TreeBody {
  static constexpr int dofs = D::dimension == 2 ? 3 : 6;
  std::int32_t body = none;   ///< slot
  std::int32_t joint = none;  ///< to the parent, place in JointTrees::joints; `none` at the root of a free tree
  // Of a step:
  SolverBody<D> ahead{};                  ///< where the body will be at the end of the substep
  double mass[dofs][dofs];                ///< its own, then with what hangs on it; then factorised
  double inverse[dofs];                   ///< 1/D of the factor
  double load[dofs];                      ///< right-hand side, then the change of velocity
  double own_mass = 0, inverse_mass = 0;  ///< kg, 1/kg
  double inverse_inertia[dofs - D::dimension][dofs - D::dimension];
  double inertia[dofs - D::dimension][dofs - D::dimension];    ///< kg·m², world axes
  double stiffness[dofs - D::dimension][dofs - D::dimension];  ///< N·m/rad against turning, from the joints' forces
};

template <class D>
struct TreeJoint {
  static constexpr int dofs = D::dimension == 2 ? 3 : 6;
  std::int32_t joint = none;   ///< slot
  std::int32_t child = none;   ///< place in JointTrees::bodies
  std::int32_t parent = none;  ///< likewise; `none`: the world, a fixed or a kinematic body
  bool child_is_b = true;
  // Of a step:
  std::uint32_t record = 0;                              ///< in units of JointStore::records
  int rigid_rows = 0, rows = 0;                          ///< what holds; with what only resists
  double child_row[dofs][dofs], parent_row[dofs][dofs];  ///< J: linear, then angular
  double reach[dofs][dofs];                              ///< M̂⁻¹ Jᵀ of the child, one row each
  double share[dofs][dofs];                              ///< S⁻¹ J of the parent, S = J M̂⁻¹ Jᵀ + E
  double pivot[dofs][dofs], inverse[dofs];               ///< factor of S
  double compliance[dofs], error[dofs], residual[dofs];
  double impulse[dofs];        ///< of this substep so far
  double settled[dofs];        ///< of the last one
  double tension = 0;          ///< N·s a substep
  double damping = 0;          ///< share of their speed that the rows that only resist take
  double axis_mobility[dofs];  ///< of its driven axes in their order, with all that hangs on them: 1/kg or 1/(kg·m²)
  typename D::Inertia turn_mobility;  ///< likewise about all axes, 1/(kg·m²)
};

/// Bodies from the root outward; joints: those to the parents in the order of the bodies, then further ones to the
/// ground from `closing` on, which are leaves of the elimination.
struct TreeRange {
  std::int32_t first_body = 0, body_end = 0, first_joint = 0, closing = 0, joint_end = 0;
  bool free = false;           ///< no joint to the ground
  bool moving_ground = false;  ///< hangs on a kinematic body
  bool drives = false;         ///< solves the motors, springs and stops of its joints
  bool slender = false;        ///< some body's inertia turns so much with it that drives are measured in each substep
  double work = 0;             ///< J, of the joints in this substep
};

template <class D>
struct JointTrees {
  bool stale = true;  ///< joints, masses or who is awake changed. Trees are a function of those and of nothing else.
  std::vector<TreeRange> trees;
  std::vector<TreeBody<D>> bodies;
  std::vector<TreeJoint<D>> joints;
  std::vector<std::int32_t> of_joint;  ///< by joint slot: place in `joints` or `none`
  std::vector<std::int32_t> visited;   ///< scratch by joint slot
  std::vector<std::int32_t> place;     ///< scratch by body slot: in the tree that is being built
};

/// Finds the trees that are worth it, if anything changed, and notes who is in one (JointTrees::of_joint).
template <class D>
void build_trees(WorldImplementation<D>& world);
/// Loads impulses and factorises, once the records of the step are there.
template <class D>
void prepare_trees(StepContext<D>& context);
/// What trees do in a pass of a substep, for trees [begin, end).
template <class D>
void run_trees(StepContext<D>& context, SolverPass pass, int begin, int end);
/// The impulses go back to the records.
template <class D>
void store_trees(StepContext<D>& context);
/// Trees in a chunk.
template <class D>
int tree_grain(const JointTrees<D>& trees) {
  return max(1, 24 * int(trees.trees.size()) / (int(trees.joints.size()) + 1));
}

}  // namespace carom::rigid::detail
