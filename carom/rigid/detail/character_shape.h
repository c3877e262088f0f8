// What both kinds of characters are made of.
#pragma once

#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

inline Rot2f upright(Vec2f up) { return {up.y, -up.x}; }
inline Quatf upright(Vec3f up) {
  if (up.y < -0.9999f) return {0, 1, 0, 0};
  return normalize(Quatf{1 + up.y, up.z, 0, -up.x});
}
inline geometry::Shape2 make_capsule(Dim2, float half_length, float radius) {
  return geometry::Capsule2{half_length, radius};
}
inline geometry::Shape3 make_capsule(Dim3, float half_length, float radius) {
  return geometry::Capsule3{half_length, radius};
}

}  // namespace carom::rigid::detail
