// Joints and effectors of a scene file.
#pragma once

#include "carom/rigid/world.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// Bodies by name, as joints and effectors refer to them.
class BodyNames {
 public:
  virtual ~BodyNames() = default;
  /// Null and an error in the reader where there is no such body. "world" may make one.
  virtual rigid::BodyId find_body(const Node& at, const std::string& path, const std::string& name) = 0;
};

template <class D>
struct ReadJoint {
  rigid::AnyJointDef<D> definition;
  std::vector<typename D::Vector> points{}, tangents{};  ///< of a path: what the definition shows
  rigid::JointSpring spring{};
  rigid::JointLimit limit{};
  rigid::JointMotor motor{};
  bool has_spring = false, has_limit = false, has_motor = false;
};
template <class D>
bool read_joint(Reader& reader, BodyNames& names, const rigid::World<D>& world, const Object& o, ReadJoint<D>& out);
/// `world`: where it begins, so that what it sets at the start is set; null when it is read again.
template <class D>
bool read_effector(Reader& reader, BodyNames& names, const Object& o, rigid::World<D>* world,
                   rigid::EffectorDef<D>& out);

/// From what files write (always three components) to the vectors of each dimension.
inline math::Vec2d position_of(math::Vec3d v, rigid::Dim2*) { return {v.x, v.y}; }
inline math::Vec3d position_of(math::Vec3d v, rigid::Dim3*) { return v; }
inline math::Vec2f vector_for(math::Vec3d v, rigid::Dim2*) { return {float(v.x), float(v.y)}; }
inline math::Vec3f vector_for(math::Vec3d v, rigid::Dim3*) { return math::Vec3f(v); }
inline float angular_for(math::Vec3d v, rigid::Dim2*) { return float(v.z); }
inline math::Vec3f angular_for(math::Vec3d v, rigid::Dim3*) { return math::Vec3f(v); }
inline math::Rot2f rotation_for(Reader& reader, const Object& o, std::string_view key, rigid::Dim2*) {
  return reader.rotation2(o, key);
}
inline math::Quatf rotation_for(Reader& reader, const Object& o, std::string_view key, rigid::Dim3*) {
  return reader.rotation3(o, key);
}

}  // namespace carom::scene::detail
