// Box2D's rain: ragdolls of eleven bodies fall on five grounds of small boxes, forty columns in turn.
#include <array>

#include "benchmarks/scene_pieces.h"

namespace carom::bench {
namespace {
using math::Vec2d;
using math::Vec2f;

constexpr std::uint64_t ground_category = 1, body_category = 2;

struct Bone {
  int parent;
  double center;                    ///< m above the feet
  float lower, upper, radius;       ///< m, the capsule's axis about the centre
  double pivot;                     ///< m above the feet
  double limit_lower, limit_upper;  ///< in units of π
  float friction;                   ///< share of the ragdoll's friction torque
};
constexpr Bone bones[11] = {
    {-1, 0.95, -0.02f, 0.02f, 0.095f, 0, 0, 0, 0},                  // hip
    {0, 1.2, -0.135f, 0.135f, 0.09f, 1.0, -0.25, 0, 0.5f},          // torso
    {1, 1.475, -0.0385f, 0.0385f, 0.075f, 1.4, -0.3, 0.1, 0.25f},   // head
    {0, 0.775, -0.125f, 0.125f, 0.06f, 0.9, -0.05, 0.4, 1.0f},      // thighs and shins
    {3, 0.475, -0.155f, 0.125f, 0.045f, 0.625, -0.5, -0.02, 0.5f},  //
    {0, 0.775, -0.125f, 0.125f, 0.06f, 0.9, -0.05, 0.4, 1.0f},      //
    {5, 0.475, -0.155f, 0.125f, 0.045f, 0.625, -0.5, -0.02, 0.5f},  //
    {1, 1.225, -0.125f, 0.125f, 0.035f, 1.35, -0.1, 0.8, 0.5f},     // upper arms and forearms
    {7, 0.975, -0.125f, 0.125f, 0.03f, 1.1, -0.2, 0.3, 0.1f},       //
    {1, 1.225, -0.125f, 0.125f, 0.035f, 1.35, -0.1, 0.8, 0.5f},     //
    {9, 0.975, -0.125f, 0.125f, 0.03f, 1.1, -0.2, 0.3, 0.1f},       //
};
constexpr int first_shin = 4, second_shin = 6, first_forearm = 8, second_forearm = 10;

class Rain2 final : public Scene<Dim2> {
  static constexpr int rows = 5, columns = 40, group = 5;
  using Ragdoll = std::array<BodyId, 11>;

  void build(World2& world) override {
    const BodyId ground = add_body<Dim2>(world, {.type = BodyType::fixed});
    ShapeDef<Dim2> s;
    s.density = 1;
    s.filter.category = ground_category;
    for (int row = 0; row < rows; ++row)
      for (int i = 0; i < 501; ++i)
        add_box(world, ground, {-125 + 0.5f * float(i), 45.0f * float(row)}, {0.25f, 0.25f}, s);
    const Vec2f sole[] = {{-0.03f, -0.185f}, {0.11f, -0.185f}, {0.11f, -0.16f}, {-0.03f, -0.14f}};
    foot_ = geometry::make_polygon(sole, 0.015f).value();
  }

  void before_step(World2& world, int step) override {
    if (step % 8 != 0) return;
    std::vector<Ragdoll>& column = columns_[std::size_t(next_)];
    for (const Ragdoll& ragdoll : column)
      for (const BodyId bone : ragdoll) world.destroy_body(bone).value();
    column.clear();
    for (int row = 0; row < rows; ++row)
      for (int k = 0; k < group; ++k)
        column.push_back(make_ragdoll(world, {-125 + 6.25 * (next_ + 0.5) + 0.5 * k, 40 + 45.0 * row}));
    next_ = (next_ + 1) % columns;
  }

  Ragdoll make_ragdoll(World2& world, Vec2d feet) {
    Ragdoll ragdoll;
    const std::int32_t own_group = -++count_;
    for (int i = 0; i < 11; ++i) {
      const Bone& bone = bones[i];
      ragdoll[std::size_t(i)] = add_body<Dim2>(world, {.position = feet + Vec2d{0, bone.center}, .sleep_speed = 0.1f});
      const BodyId body = ragdoll[std::size_t(i)];
      ShapeDef<Dim2> s;
      s.density = 1;
      s.material.friction = 0.2f;
      s.filter = {body_category, ~std::uint64_t{0}, own_group};
      s.local.p = {0, 0.5f * (bone.lower + bone.upper)};
      world.add_shape(body, geometry::Capsule2{0.5f * (bone.upper - bone.lower), bone.radius}, s).value();
      if (i == first_shin || i == second_shin) {
        s.local = {};
        s.material.friction = 0.05f;
        s.filter.mask = ground_category;
        world.add_shape(body, foot_, s).value();
      }
      if (bone.parent < 0) continue;
      rigid::HingeJointDef<Dim2> joint;
      joint.body_a = ragdoll[std::size_t(bone.parent)];
      joint.body_b = body;
      joint.frame_a.p = {0, float(bone.pivot - bones[bone.parent].center)};
      joint.frame_b.p = {0, float(bone.pivot - bone.center)};
      if (i == first_forearm || i == second_forearm)
        joint.frame_a.q = {float(math::cos(pi / 4)), float(math::sin(pi / 4))};
      joint.limit = {true, float(bone.limit_lower * pi), float(bone.limit_upper * pi)};
      joint.spring = {5.0f, 0.5f};
      joint.motor = {true, 0, 0.05f * bone.friction};
      world.create_joint(joint).value();
    }
    return ragdoll;
  }

  geometry::Shape2 foot_;
  std::array<std::vector<Ragdoll>, columns> columns_;
  int next_ = 0;
  std::int32_t count_ = 0;
};

}  // namespace

std::unique_ptr<Scene<Dim2>> make_rain2() { return std::make_unique<Rain2>(); }

}  // namespace carom::bench
