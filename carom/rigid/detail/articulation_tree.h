// The mechanics of a tree of rigid links, in double and in world axes: recursive Newton and Euler.
#pragma once

#include <span>
#include <vector>

#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

/// A link and the joint that carries it. Links come after their parents; the first is the root.
struct TreeLink {
  int parent = -1;
  double mass = 0;
  Mat3d inertia = Mat3d::zero();  ///< kg·m², about the centre of mass
  Vec3d center{};                 ///< m, of mass
  Vec3d anchor{};                 ///< m, of the joint to the parent
  Mat3d axes = Mat3d::zero();     ///< columns: how the link moves against its parent for each unit of speed
  int first = 0, degrees = 0;     ///< of its coordinates
  bool slides = false;            ///< along axes.cx instead of about them
};
/// A force with a moment about a link's centre of mass.
struct TreeForce {
  Vec3d force{}, moment{};
};
/// How the root moves.
struct TreeRoot {
  Vec3d spin{};                  ///< rad/s
  Vec3d acceleration{};          ///< m/s², of its centre of mass
  Vec3d angular_acceleration{};  ///< rad/s²
};
/// Scratch and results of `tree_forces`.
struct TreeMotion {
  std::vector<Vec3d> spin, acceleration, angular_acceleration;
  std::vector<TreeForce> load;  ///< what each link's joint carries: force, and moment about its anchor
  TreeForce root{};             ///< what must act on the root from outside, about its centre of mass
};

/// The forces in the joints (N, N·m along their axes) for which the tree accelerates so (Luh, Walker & Paul 1980;
/// Featherstone, "Rigid Body Dynamics Algorithms", 2008, §5.3). `outside`: none, or one a link.
void tree_forces(std::span<const TreeLink> links, const TreeRoot& root, std::span<const double> speeds,
                 std::span<const double> accelerations, const Vec3d& gravity, std::span<const TreeForce> outside,
                 TreeMotion& motion, std::span<double> torques);

/// Mass, centre and inertia about it of the whole tree as one body.
struct TreeWhole {
  double mass = 0;
  Vec3d center{};
  Mat3d inertia = Mat3d::zero();
};
TreeWhole whole_of(std::span<const TreeLink> links);

/// How the root accelerates besides where `force` (about the root's centre of mass) acts on it and no joint does.
void free_root(const TreeWhole& whole, const Vec3d& root_center, const TreeForce& force, TreeRoot& root);

/// The acceleration that takes an error x and its speed v within dt to the speed that an oscillator of natural
/// frequency ω (rad/s) and damping ratio ζ would have then. Stable for any ω dt.
double settling_acceleration(double x, double v, double omega, double zeta, double dt);

}  // namespace carom::rigid::detail
