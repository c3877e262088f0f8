#include "tests/quality/ragdoll.h"

#include <cstring>

#include "carom/math/elementary.h"

namespace carom::quality {
namespace {

using namespace rigid;

/// Lengths in mm, quaternions x y z w × 100. Bodies of the left side; the right one is their mirror image.
struct Bone {
  const char* name;
  float position[3], rotation[4], end_a[3], end_b[3], radius;
};
constexpr Bone bones[] = {{"pelvis", {0, 932, -52}, {74, 0, 0, 67}, {70, 0, -80}, {-70, 0, -80}, 130},
                          {"spine_01", {0, 1114, -35}, {74, 0, 0, 67}, {60, 0, -52}, {-60, 0, -52}, 120},
                          {"spine_02", {0, 1194, -27}, {70, 0, 0, 71}, {80, -15, -92}, {-80, -15, -92}, 100},
                          {"spine_03", {0, 1310, -28}, {67, 0, 0, 74}, {110, -40, -130}, {-110, -40, -130}, 145},
                          {"neck", {0, 1576, -56}, {88, 0, 0, 48}, {0, 0, -20}, {0, -5, -80}, 70},
                          {"head", {0, 1653, -3}, {75, 0, 0, 66}, {0, 17, -59}, {0, -4, -115}, 98},
                          {"thigh", {90, 986, -35}, {-70, -7, 5, 70}, {24, 6, -39}, {-64, -5, -425}, 90},
                          {"calf", {101, 527, -37}, {-65, -7, 6, 75}, {2, 0, 10}, {-79, 15, -418}, 75},
                          {"upper_arm", {204, 1484, -116}, {14, 70, -69, 14}, {0, 0, 0}, {-91, 38, 230}, 75},
                          {"lower_arm", {306, 1243, -118}, {16, 56, -80, 11}, {0, 0, 0}, {-142, 39, 261}, 50}};
struct Link {
  int child, parent;
  bool hinge;
  float position_a[3], rotation_a[4], position_b[3], rotation_b[4], cone, lower, upper, torque;
};
constexpr Link links[] = {
    {1, 0, false, {0, 0, -182}, {-100, 0, 0, 0}, {0, 0, -8}, {-100, 0, 0, 0}, 25, -15, 15, 5},
    {2, 1, false, {0, 0, -89}, {-100, 0, 0, -5}, {0, 0, -8}, {-100, 0, 0, 0}, 25, -15, 15, 5},
    {3, 2, false, {0, 0, -124}, {-100, 0, 0, -5}, {0, 0, 0}, {-100, 0, 0, 0}, 15, -10, 10, 5},
    {4, 3, false, {0, 0, -267}, {-94, 0, 0, 34}, {0, 0, 0}, {-100, 0, 0, 0}, 45, -15, 15, 4},
    {5, 4, false, {0, 1, -94}, {-97, 0, 0, -22}, {0, 1, -5}, {-100, 0, 0, 0}, 15, -15, 15, 2},
    {6, 0, false, {50, 12, -55}, {-72, -2, -70, -3}, {0, 0, 0}, {0, 76, 2, 65}, 10, -60, 40, 5},
    {7, 6, true, {-70, 0, -454}, {0, 76, 11, 64}, {0, 0, 0}, {-4, 77, 5, 64}, 0, -5, 45, 5},
    {8, 3, false, {204, -69, -182}, {-28, 45, -10, 84}, {0, 0, 0}, {-20, 0, 90, 38}, 60, -5, 5, 5},
    {9, 8, true, {-95, 40, 241}, {51, -18, 84, 0}, {0, 0, 0}, {50, -3, 86, 9}, 0, -5, 60, 5}};
constexpr int center_bones = 6;

Vec3f point(const float (&p)[3], bool mirror) { return {(mirror ? -p[0] : p[0]) / 1000, p[1] / 1000, p[2] / 1000}; }
Quatf turn(const float (&q)[4], bool mirror) {
  const float sign = mirror ? -1.0f : 1.0f;
  return normalize(Quatf{q[3], q[0], sign * q[1], sign * q[2]});
}

BodyId add_bone(World3& world, const Bone& bone, Vec3d origin, bool mirror, int group) {
  BodyDef<Dim3> body;
  const Vec3f p = point(bone.position, mirror);
  body.position = origin + Vec3d{double(p.x), double(p.y), double(p.z)};
  body.rotation = turn(bone.rotation, mirror);
  const BodyId id = world.create_body(body).value();
  const Vec3f a = point(bone.end_a, mirror), b = point(bone.end_b, mirror), way = b - a;
  ShapeDef<Dim3> def;
  const float half = 0.5f * length(way);
  // The capsule's axis is local y: the shortest turn from y to the way between its ends.
  const Vec3f u = way / (2 * half);
  const Quatf shortest = u.y < -0.999f ? Quatf{0, 1, 0, 0} : normalize(Quatf{1 + u.y, u.z, 0, -u.x});
  def.local = {0.5f * (a + b), shortest};
  def.material.rolling_resistance = 0.2f;
  def.filter.group = group;
  world.add_shape(id, geometry::Capsule3{half, bone.radius / 1000}, def).value();
  return id;
}

void add_link(World3& world, const Link& link, BodyId parent, BodyId child, bool mirror) {
  const float lower = math::radians(mirror ? -link.upper : link.lower),
              upper = math::radians(mirror ? -link.lower : link.upper);
  const auto common = [&](auto& def) {
    def.body_a = parent;
    def.body_b = child;
    def.frame_a = {point(link.position_a, mirror), turn(link.rotation_a, mirror)};
    def.frame_b = {point(link.position_b, mirror), turn(link.rotation_b, mirror)};
    def.spring = {1, 0.7f};
  };
  if (link.hinge) {
    HingeJointDef<Dim3> def;
    common(def);
    def.limit = {true, lower, upper};
    def.motor = {true, 0, link.torque};
    world.create_joint(def).value();
  } else {
    BallJointDef<Dim3> def;
    common(def);
    def.cone_angle = math::radians(link.cone);
    def.twist = {true, lower, upper};
    def.friction_torque = link.torque;
    world.create_joint(def).value();
  }
}

}  // namespace

void add_ragdoll(World3& world, Vec3d origin, int group) {
  BodyId left[std::size(bones)], right[std::size(bones)];
  for (int i = 0; i < int(std::size(bones)); ++i) {
    left[i] = add_bone(world, bones[i], origin, false, group);
    right[i] = i < center_bones ? left[i] : add_bone(world, bones[i], origin, true, group);
  }
  for (const Link& link : links) {
    add_link(world, link, left[link.parent], left[link.child], false);
    if (link.child >= center_bones) add_link(world, link, right[link.parent], right[link.child], true);
  }
}

}  // namespace carom::quality
