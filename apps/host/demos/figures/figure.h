// A figure of a person's size and mass, of thirteen bodies and twelve joints.
#pragma once

#include "apps/host/demos/demos.h"
#include "carom/rigid/articulation.h"

namespace carom::host::demo {

/// Turns of a figure's joints against standing upright with hanging arms, as rotation vectors in the axes of the body
/// (x forward, y up, z to its right), rad.
struct Pose {
  Vec3d waist{}, neck{};
  Vec3d shoulder[2]{}, hip[2]{}, ankle[2]{};  ///< left, right
  double elbow[2]{}, knee[2]{};               ///< bent forward, backward
};

struct Figure {
  enum Part { pelvis, chest, head, upper_arm, forearm = 5, thigh = 7, shin = 9, foot = 11, parts = 13 };
  rigid::BodyId body[parts];
  rigid::JointId waist, neck, shoulder[2], elbow[2], hip[2], knee[2], ankle[2];
  rigid::Articulation3 mechanism;

  /// Upright with its soles at `place`, held at the pelvis by `holder`. Its limbs collide with one
  /// another and with its trunk; what a joint joins does not.
  static Figure create(Stage3& stage, Vec3d place, std::uint32_t shirt, std::uint32_t trousers, rigid::BodyId holder);
  void set_pose(Stage3& stage, const Pose& pose);
  /// rad: the farthest that a joint is from a pose, at the mechanism's last read.
  double farthest_from(const Pose& pose) const;
};

}  // namespace carom::host::demo
