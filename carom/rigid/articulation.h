// A tree of bodies and joints as a mechanism: the torques that a motion takes (inverse dynamics), and muscles, which
// drive every joint toward a target by frequency and damping ratio with those torques as feed-forward. A ragdoll that
// holds its pose, a robot arm that follows a path.
//
//   auto arm = Articulation3::create(world, hand).value();
//   arm.set_muscles({.hertz = 5, .max_torque = 200});
//   each step:  arm.set_target(elbow, angle, speed);  arm.drive(world, dt);  world.step(dt);
#pragma once

#include <span>
#include <vector>

#include "carom/rigid/detail/articulation_tree.h"
#include "carom/rigid/world.h"

namespace carom::rigid {

/// How strongly a joint is driven to its target.
struct Muscle {
  double hertz = 4;          ///< 0 … 1000, natural frequency of the joint, whatever hangs on it; 0: limp
  double damping_ratio = 1;  ///< ≥ 0
  double max_torque = 0;     ///< N·m (slider: N); 0: as much as it takes
};

/// A joint of the tree. Its coordinates: the angle of a hinge, the translation of a slider, of a ball joint in space
/// the rotation vector of frame B in A, and its speeds along the axes of frame A.
struct ArticulationJoint {
  JointId joint{};
  int parent = -1, link = -1;  ///< the links it joins
  int first = 0, degrees = 0;  ///< of its coordinates among all
};

/// The bodies that hinges, balls, sliders and rigid welds join to one another and to at most one body that no force
/// moves (or the world); what else holds them, a rope, a hand, a contact, acts on the mechanism from outside. Copyable;
/// every call takes the world in which it was created. Deterministic.
template <class D>
class CAROM_API Articulation {
 public:
  using Vector = typename D::Vector;
  using Position = typename D::Position;
  using Rotation = typename D::Rotation;
  using Angular = typename D::Angular;

  /// The mechanism to which a dynamic body belongs, with the masses and joints that it has now. Errors: not a dynamic
  /// body, joints that close a loop, more than 256 links.
  static Result<Articulation> create(const World<D>& world, BodyId body);
  Articulation() = default;  ///< of nothing

  bool floating() const { return floating_; }  ///< no body that stays holds it: links()[0] is one of its own
  int degrees() const { return degrees_; }     ///< of freedom of its joints
  std::span<const BodyId> links() const { return bodies_; }  ///< the root first; null: the world
  std::span<const ArticulationJoint> joints() const { return joints_; }
  /// The place of a joint among joints(); −1: not of this tree.
  int find(JointId joint) const;

  /// Takes poses and velocities from the world. Errors: a body or joint that no longer exists.
  Status read(const World<D>& world);
  std::span<const double> coordinates() const { return coordinates_; }  ///< m, rad
  std::span<const double> speeds() const { return speeds_; }            ///< m/s, rad/s
  Position center_of_mass() const;                                      ///< m, of the links that move, at the last read
  Vector center_velocity() const;                                       ///< m/s

  /// The torques (N·m, sliders: N) for which the joints accelerate so (m/s², rad/s²), as everything stood at the last
  /// read and without what the world's contacts and other joints do. A free root accelerates as it must, a planted one
  /// does not. Errors: other sizes than degrees(), a number that is not finite.
  Status inverse_dynamics(std::span<const double> accelerations, std::span<double> torques);

  // Muscles.
  Status set_muscles(const Muscle& muscle);  ///< of all joints
  Status set_muscle(int joint, const Muscle& muscle);
  /// Where a hinge or slider is to be at the end of the next step; how fast then and with which acceleration until
  /// then, where that is known.
  Status set_target(int joint, double coordinate, double speed = 0, double acceleration = 0);
  /// Of a ball joint in space: frame B in frame A.
  Status set_target(int joint, const Quatf& rotation, const Vec3f& speed = {}, const Vec3f& acceleration = {});
  Status hold();  ///< the coordinates of the last read become the targets
  /// Of a free tree: the body that it was created with stands on something that carries it, a foot on the ground.
  /// Muscles then push against that, as strongly as everything above needs; what touches this body is the answer, and
  /// no load. Say no when it lifts off.
  void plant(bool planted) { planted_ = planted; }

  /// Reads, and lets the muscles work for the next step of dt. What touched the tree in the last step counts as a load.
  /// Until the next read, speeds() are those of the step's middle. Errors: those of `read`, dt out of range.
  Status drive(World<D>& world, float dt);
  std::span<const double> torques() const { return torques_; }  ///< of the last drive, after the limits

 private:
  struct Frames {
    Vec3d a{}, b{};  ///< anchors, in the bodies
    Quatd rotation_a{}, rotation_b{};
    int body_a = -1, body_b = -1;  ///< links
    JointType type{};
  };
  struct Target {
    double coordinate[3]{}, speed[3]{}, acceleration[3]{};
    Quatd rotation{};
  };
  struct LinkBody {
    Vec3d center{};  ///< in the body
    Mat3d inertia = Mat3d::zero();
  };
  Status add_link(const World<D>& world, BodyId body, int parent);
  Status add_joint(const AnyJointDef<D>& definition, JointId id, int parent, int link);
  Status check_joint(const char* function, int joint, bool ball) const;
  void find_touches(const World<D>& world, float dt);
  void move_ahead(double time);
  Status apply(World<D>& world);

  std::vector<BodyId> bodies_;
  std::vector<LinkBody> own_;
  std::vector<ArticulationJoint> joints_;
  std::vector<Frames> frames_;
  std::vector<Muscle> muscles_;
  std::vector<Target> targets_;
  bool floating_ = false, planted_ = false;
  int degrees_ = 0;
  Vec3d gravity_{}, origin_{};  ///< `origin_`: of the links' positions
  std::vector<detail::TreeLink> links_;
  std::vector<Vec3d> loads_;     ///< of the joints, world
  std::vector<Vec3d> velocity_;  ///< m/s, of the links' centres
  std::vector<Vec3d> spins_;     ///< rad/s, of the links
  std::vector<Quatd> rotation_;
  detail::TreeRoot root_{};
  std::vector<double> coordinates_, speeds_, accelerations_, torques_;
  detail::TreeMotion motion_;
  std::vector<detail::TreeForce> outside_;
  std::vector<ContactView<D>> contacts_;
};

extern template class CAROM_API Articulation<Dim2>;
extern template class CAROM_API Articulation<Dim3>;
using Articulation2 = Articulation<Dim2>;
using Articulation3 = Articulation<Dim3>;

}  // namespace carom::rigid
