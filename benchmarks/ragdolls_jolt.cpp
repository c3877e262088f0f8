// Piles of humanoids of 23 parts held in a pose by motors: a stand-in for the ragdoll scenes of Jolt's performance test
// with our own figure (15 capsules where Jolt's has 15 and 8 tapered ones, and boxes for hands) on a wavy terrain.
#include <array>

#include "benchmarks/scene_pieces.h"

namespace carom::bench {
namespace {
using math::Quatf;
using math::Vec3d;
using math::Vec3f;

/// Standing with arms spread, y up, z forward; the left side is +x. Metres.
struct Part {
  int parent;
  Vec3f center;
  char axis;  ///< of the capsule; 'b': a box
  float half_length, radius;
  Vec3f pivot;  ///< of the joint to the parent
  float bend;   ///< rad about x that the motor holds
};
constexpr int part_count = 23;
constexpr Part parts[part_count] = {
    {-1, {0, 0.98f, 0}, 'x', 0.10f, 0.12f, {}, 0},                                  // pelvis
    {0, {0, 1.12f, 0}, 'x', 0.09f, 0.10f, {0, 1.05f, 0}, 0.05f},                    // spine
    {1, {0, 1.24f, 0}, 'x', 0.09f, 0.10f, {0, 1.18f, 0}, 0.05f},                    //
    {2, {0, 1.36f, 0}, 'x', 0.09f, 0.10f, {0, 1.30f, 0}, 0.05f},                    //
    {3, {0, 1.48f, 0}, 'x', 0.10f, 0.12f, {0, 1.42f, 0}, 0.05f},                    // chest
    {4, {0, 1.66f, 0}, 'y', 0.02f, 0.05f, {0, 1.60f, 0}, 0.2f},                     // neck
    {5, {0, 1.80f, 0}, 'y', 0.04f, 0.09f, {0, 1.70f, 0}, 0.2f},                     // head
    {4, {0.17f, 1.52f, 0}, 'x', 0.05f, 0.05f, {0.10f, 1.52f, 0}, 0},                // collar bones
    {4, {-0.17f, 1.52f, 0}, 'x', 0.05f, 0.05f, {-0.10f, 1.52f, 0}, 0},              //
    {7, {0.39f, 1.52f, 0}, 'x', 0.11f, 0.05f, {0.25f, 1.52f, 0}, 0.3f},             // upper arms
    {8, {-0.39f, 1.52f, 0}, 'x', 0.11f, 0.05f, {-0.25f, 1.52f, 0}, 0.3f},           //
    {9, {0.65f, 1.52f, 0}, 'x', 0.10f, 0.045f, {0.52f, 1.52f, 0}, 0.4f},            // forearms
    {10, {-0.65f, 1.52f, 0}, 'x', 0.10f, 0.045f, {-0.52f, 1.52f, 0}, 0.4f},         //
    {11, {0.86f, 1.52f, 0}, 'b', 0.08f, 0.03f, {0.78f, 1.52f, 0}, 0.1f},            // hands
    {12, {-0.86f, 1.52f, 0}, 'b', 0.08f, 0.03f, {-0.78f, 1.52f, 0}, 0.1f},          //
    {0, {0.10f, 0.71f, 0}, 'y', 0.14f, 0.08f, {0.10f, 0.92f, 0}, -0.3f},            // thighs
    {0, {-0.10f, 0.71f, 0}, 'y', 0.14f, 0.08f, {-0.10f, 0.92f, 0}, -0.2f},          //
    {15, {0.10f, 0.32f, 0}, 'y', 0.15f, 0.06f, {0.10f, 0.50f, 0}, 0.4f},            // calves
    {16, {-0.10f, 0.32f, 0}, 'y', 0.15f, 0.06f, {-0.10f, 0.50f, 0}, 0.3f},          //
    {17, {0.10f, 0.07f, 0.05f}, 'z', 0.06f, 0.045f, {0.10f, 0.10f, 0}, 0.5f},       // feet
    {18, {-0.10f, 0.07f, 0.05f}, 'z', 0.06f, 0.045f, {-0.10f, 0.10f, 0}, 0.5f},     //
    {19, {0.10f, 0.06f, 0.19f}, 'z', 0.03f, 0.04f, {0.10f, 0.06f, 0.14f}, 0.1f},    // toes
    {20, {-0.10f, 0.06f, 0.19f}, 'z', 0.03f, 0.04f, {-0.10f, 0.06f, 0.14f}, 0.1f},  //
};

double height_at(double x, double z) { return 0.5 * math::sin(0.5 * x) * math::cos(0.5 * z); }

template <int piles, int pile_height>
class Ragdolls final : public Scene<Dim3> {
 public:
  explicit Ragdolls(double gap) : gap_(gap) {}

 private:
  void build(World3& world) override {
    const auto wave = [](int i, int j) { return height_at(i - 50, j - 50); };
    add_fixed(world, {}, terrain(100, 100, 1, {-50, 0, -50}, wave));
    for (int row = 0; row < piles; ++row)
      for (int column = 0; column < piles; ++column) {
        const double x = 4 * (column - 0.5 * (piles - 1)), z = 4 * (row - 0.5 * (piles - 1));
        for (int i = 0; i < pile_height; ++i)
          add_ragdoll(world, {x, height_at(x, z) + gap_ * (i + 1), z}, 2 * pi * i / pile_height);
      }
  }

  /// Lying on its back with the pelvis at `place`.
  static void add_ragdoll(World3& world, Vec3d place, double turn) {
    const Quatf lying =
        math::from_axis_angle(Vec3f{0, 1, 0}, float(turn)) * math::from_axis_angle(Vec3f{1, 0, 0}, float(-90 * degree));
    std::array<BodyId, part_count> bodies;
    ShapeDef<Dim3> flesh;
    flesh.material.friction = 1;
    flesh.material.restitution = 0.15f;
    for (int i = 0; i < part_count; ++i) {
      const Part& part = parts[i];
      BodyDef<Dim3> body;
      body.position = place + Vec3d(math::rotate(lying, part.center - parts[0].center));
      body.rotation = lying;
      body.linear_damping = body.angular_damping = 0.05f;
      ShapeDef<Dim3> s = flesh;
      if (part.axis == 'x') s.local.q = math::from_axis_angle(Vec3f{0, 0, 1}, float(90 * degree));
      if (part.axis == 'z') s.local.q = math::from_axis_angle(Vec3f{1, 0, 0}, float(90 * degree));
      bodies[std::size_t(i)] =
          part.axis == 'b'
              ? add_body<Dim3>(world, body, geometry::Box{{part.half_length, 0.5f * part.radius, part.radius}}, s)
              : add_body<Dim3>(world, body, geometry::Capsule3{part.half_length, part.radius}, s);
    }
    for (int i = 1; i < part_count; ++i) {
      const Part& part = parts[i];
      rigid::BallJointDef<Dim3> joint;
      joint.body_a = bodies[std::size_t(part.parent)];
      joint.body_b = bodies[std::size_t(i)];
      joint.frame_a.p = part.pivot - parts[part.parent].center;
      joint.frame_b.p = part.pivot - part.center;
      // The cone is about frame z: along the bone where it is long, so that twist is a turn about it. The spring pulls
      // the frames together, which is the pose.
      const Quatf bone = math::from_to(Vec3f{0, 0, 1}, math::normalize(part.center - part.pivot));
      joint.frame_a.q = math::from_axis_angle(Vec3f{1, 0, 0}, part.bend) * bone;
      joint.frame_b.q = bone;
      joint.cone_angle = float(45 * degree);
      joint.twist = {true, float(-45 * degree), float(45 * degree)};
      joint.spring = {2.0f, 1.0f};
      world.create_joint(joint).value();
    }
  }
  double gap_;
};

}  // namespace

std::unique_ptr<Scene<Dim3>> make_ragdolls() { return std::make_unique<Ragdolls<4, 10>>(0.6); }
std::unique_ptr<Scene<Dim3>> make_ragdoll_single_pile() { return std::make_unique<Ragdolls<1, 160>>(0.4); }

}  // namespace carom::bench
