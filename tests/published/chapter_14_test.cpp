// Chapter 14, physics engines: what a world must do as a whole. Source: mechanics.md chapter 14 and rigid-body.md 6.1.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "carom/math/elementary.h"
#include "carom/rigid/world.h"

namespace carom::published {
namespace chapter_14_test {

using namespace carom::rigid;
constexpr float frame = 1.0f / 60;

BodyId ground3(World3& world, float friction = 0.6f, Quatf rotation = {}) {
  BodyDef<Dim3> def;
  def.type = BodyType::fixed;
  def.rotation = rotation;
  def.position = -Vec3d(rotate(rotation, Vec3f{0, 1, 0}));
  const BodyId body = world.create_body(def).value();
  world.add_shape(body, geometry::Box{{50, 1, 50}}, {.material = {.friction = friction}}).value();
  return body;
}

TEST(Chapter14, StackOfTenBoxesStandsAMinuteAndSleeps) {
  // Drift < 1 cm in 60 s at 60 Hz, asleep at the end.
  World3 world;
  ground3(world);
  std::vector<BodyId> boxes;
  for (int i = 0; i < 10; ++i) {
    boxes.push_back(world.create_body({.position = {0, 0.5 + i, 0}}).value());
    world.add_shape(boxes.back(), geometry::Box{{0.5f, 0.5f, 0.5f}}).value();
  }
  for (int i = 0; i < 3600; ++i) world.step(frame).value();
  double drift = 0;
  for (int i = 0; i < 10; ++i) {
    const BodyState<Dim3> state = world.state(boxes[std::size_t(i)]).value();
    const Vec3d d = state.pose.position - Vec3d{0, 0.5 + i, 0};
    drift = math::max(drift, math::sqrt(d.x * d.x + d.z * d.z));
    EXPECT_FALSE(state.awake) << i;
  }
  RecordProperty("drift", std::to_string(drift));
  EXPECT_LT(drift, 0.01);
}

/// How far a cube slides down a slope of `angle` in two seconds.
double slide(double angle, double friction) {
  World3 world;
  const auto [s, c] = math::sincos(angle / 2);
  const Quatf tilt{float(c), 0, 0, float(s)};
  ground3(world, float(friction), tilt);
  BodyDef<Dim3> def;
  def.rotation = tilt;
  def.position = Vec3d(rotate(tilt, Vec3f{0, 0.25f, 0}));
  const BodyId cube = world.create_body(def).value();
  world.add_shape(cube, geometry::Box{{0.5f, 0.25f, 0.5f}}, {.material = {.friction = float(friction)}}).value();
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  return math::length(world.state(cube).value().pose.position - def.position);
}

TEST(Chapter14, SlipsIffTheTangentExceedsFriction) {
  // Within half a degree.
  for (const double friction : {0.3, 0.5}) {
    const double critical = math::atan(friction);
    EXPECT_LT(slide(critical - radians(0.5), friction), 0.005) << friction;
    // Half a degree above, a = g (sin α − μ cos α); two seconds.
    const double a = critical + radians(0.5), pull = 9.80665 * (math::sin(a) - friction * math::cos(a));
    EXPECT_NEAR(slide(a, friction), 2 * pull, 0.1 * 2 * pull) << friction;
  }
}

TEST(Chapter14, ReplayIsBitIdentical) {
  const auto run = [](int threads) {
    WorldDef<Dim3> def;
    def.threads = threads;
    World3 world(def);
    ground3(world);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 60; ++i) {
      bodies.push_back(world.create_body({.position = {0.3 * (i % 5), 1 + 0.7 * i, 0.2 * (i % 3)}}).value());
      if (i % 3 == 0)
        world.add_shape(bodies.back(), geometry::Sphere{0.4f}).value();
      else if (i % 3 == 1)
        world.add_shape(bodies.back(), geometry::Box{{0.4f, 0.3f, 0.35f}}).value();
      else
        world.add_shape(bodies.back(), geometry::Capsule3{0.3f, 0.25f}).value();
      if (i > 0 && i % 4 == 0) {
        BallJointDef<Dim3> joint;
        joint.body_a = bodies[std::size_t(i) - 1];
        joint.body_b = bodies[std::size_t(i)];
        joint.frame_a.p = {0, 0.35f, 0};
        joint.frame_b.p = {0, -0.35f, 0};
        joint.friction_torque = 0.1f;
        world.create_joint(joint).value();
      }
    }
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 240; ++i) {
      world.step(frame).value();
      hashes.push_back(world.state_hash());
    }
    return hashes;
  };
  const auto first = run(1);
  EXPECT_EQ(run(1), first);
  EXPECT_EQ(run(2), first) << "and on two threads";
}

/// A chain of 20 links of 1 kg and 1 m with 1 000 kg at its end, let go where its joints just meet. The worst stretch
/// in 15 s, as a share of its length.
double heavy_chain_stretch(int substeps) {
  WorldDef<Dim3> world_def;
  world_def.allow_sleep = false;
  world_def.substeps = substeps;
  world_def.joint_hertz = 1000;  // as stiff as the substeps permit
  World3 world(world_def);
  BodyId above{};
  for (int i = 0; i <= 20; ++i) {
    BodyDef<Dim3> def;
    def.position = {0, i < 20 ? -(i + 0.5) : -21.0, 0};
    const BodyId link = world.create_body(def).value();
    if (i < 20) {
      world.set_mass_properties(link, {1, {}, Mat3d::diagonal({0.085, 0.01, 0.085})}).value();
    } else {
      world.set_mass_properties(link, {1000, {}, Mat3d::diagonal({400, 400, 400})}).value();
    }
    BallJointDef<Dim3> joint;
    joint.body_a = above;
    joint.body_b = link;
    joint.frame_a.p = i == 0 ? Vec3f{} : Vec3f{0, -0.5f, 0};
    joint.frame_b.p = i < 20 ? Vec3f{0, 0.5f, 0} : Vec3f{0, 1, 0};
    world.create_joint(joint).value();
    above = link;
  }
  double lowest = 0;
  for (int i = 0; i < 900; ++i) {
    world.step(frame).value();
    lowest = math::min(lowest, world.state(above).value().pose.position.y);
  }
  return (-lowest - 21) / 20;
}

TEST(Chapter14, HeavyChainStretchesLessThanOnePercent) {
  // The 1000:1 chain. Joints sag by (load/mass) g/ω² each, and ω is bounded by the substep rate: 24 substeps reach the
  // gate, the default 4 stretch 27 % (8: 7 %). A direct solver for chains is what would lift this.
  const double stretch = heavy_chain_stretch(24);
  RecordProperty("stretch_24_substeps", std::to_string(stretch));
  RecordProperty("stretch_8_substeps", std::to_string(heavy_chain_stretch(8)));
  RecordProperty("stretch_4_substeps", std::to_string(heavy_chain_stretch(4)));
  EXPECT_LT(stretch, 0.01);
}

/// Five touching balls; `moving` of them come in at 5 m/s. Returns the speeds at the end.
std::vector<float> cradle(int moving) {
  World3 world({.gravity = {}, .allow_sleep = false, .restitution_threshold = 0.01f});
  std::vector<BodyId> balls;
  for (int i = 0; i < 5 + moving; ++i) {
    BodyDef<Dim3> def;
    def.position = {i < moving ? -3.0 + i : double(i - moving), 0, 0};
    if (i < moving) def.linear_velocity = {5, 0, 0};
    balls.push_back(world.create_body(def).value());
    world.add_shape(balls.back(), geometry::Sphere{0.5f}, {.material = {.friction = 0, .restitution = 1}}).value();
  }
  for (int i = 0; i < 90; ++i) world.step(frame).value();
  std::vector<float> speeds;
  for (const BodyId ball : balls) speeds.push_back(world.state(ball).value().linear_velocity.x);
  return speeds;
}

TEST(Chapter14, NewtonsCradleOneInOneOut) {
  // More than 99 % of the energy in the last ball (mechanics.md, chapter 14).
  const std::vector<float> speeds = cradle(1);
  double momentum = 0, energy = 0;
  std::string text;
  for (const float v : speeds) {
    momentum += double(v);
    energy += double(v) * double(v);
    text += std::to_string(v) + " ";
  }
  RecordProperty("speeds", text);
  const double share = double(speeds.back()) * double(speeds.back()) / 25;
  RecordProperty("share_of_the_last", std::to_string(share));
  EXPECT_NEAR(momentum, 5, 1e-4);
  EXPECT_LE(energy, 25 * (1 + 1e-4));
  EXPECT_GT(share, 0.99);
}

}  // namespace chapter_14_test
}  // namespace carom::published
