// What differs between the plane and space; everything else in this room is written once.
#pragma once

#include "carom/geometry/manifold.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/query.h"

namespace carom::rigid {
using namespace math;

struct Dim2 {
  static constexpr int dimension = 2;
  using Vector = Vec2f;    ///< local: m, m/s, N
  using Position = Vec2d;  ///< world: m
  using Rotation = Rot2f;
  using Angular = float;  ///< rad/s, N·m, about z
  using Inertia = float;  ///< kg·m²
  using Pose = Pose2;
  using Transform = Transform2f;
  using Bounds = geometry::Bounds2d;
  using Shape = geometry::Shape2;
  using Manifold = geometry::Manifold2;
  using MassProperties = geometry::MassProperties2;
  static constexpr int max_points = 2;
};
struct Dim3 {
  static constexpr int dimension = 3;
  using Vector = Vec3f;
  using Position = Vec3d;
  using Rotation = Quatf;
  using Angular = Vec3f;
  using Inertia = Mat3f;
  using Pose = Pose3;
  using Transform = Transform3f;
  using Bounds = geometry::Bounds3d;
  using Shape = geometry::Shape3;
  using Manifold = geometry::Manifold3;
  using MassProperties = geometry::MassProperties3;
  static constexpr int max_points = 4;
};

}  // namespace carom::rigid
