// Things that stand: columns and pyramids of boxes.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Stack : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Stack, Dimensions);

TYPED_TEST(Stack, ColumnOfTenStandsAndSleeps) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  std::vector<BodyId> boxes;
  for (int i = 0; i < 10; ++i) boxes.push_back(add_box<D>(world, at<D>(0, 0.5 + i)));
  run(world, 600);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const BodyState<D> s = world.state(boxes[i]).value();
    EXPECT_NEAR(s.pose.position.x, 0, 1e-2);
    EXPECT_NEAR(s.pose.position.y, 0.5 + double(i), 0.04);
    EXPECT_FALSE(s.awake);
  }
  EXPECT_EQ(world.counters().awake_bodies, 0);
}

// The sag law (docs/computation.md, §3): under k bodies a soft contact of frequency f closes by 2 k g/ω², the lowest by
// k g/(2ω)²; but a body that bears more than two of its own weights counts for so much more that it bears two.
TYPED_TEST(Stack, SinksAsTheSagLawSays) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.allow_sleep = false;
  World<D> world(d);
  add_ground(world);
  const int n = 12;
  BodyId top{};
  for (int i = 0; i < n; ++i) top = add_box<D>(world, at<D>(0, 0.5 + i));
  run(world, 1200);
  const double omega = 2 * pi * 36, g = 9.81;
  const auto factor = [](int bodies_above) { return std::max(1.0, bodies_above / 2.0); };
  double sag = n * g / (4 * omega * omega * factor(n - 1));
  for (int above = 1; above < n; ++above)  // the contact under so many: the reduced mass of the two beside it
    sag += above * g / (omega * omega) * (1 / factor(above) + 1 / factor(above - 1));
  // The law takes half the mass as a contact's effective one. The two points of a square have 2·m/5, the four of a cube
  // 4·m/8.
  const double expected = D::dimension == 2 ? 1.25 * sag : sag;
  EXPECT_NEAR(n - 0.5 - world.state(top).value().pose.position.y, expected, 0.1 * expected);
}

TYPED_TEST(Stack, PyramidOfTwelveIsStill) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.allow_sleep = false;
  World<D> world(d);
  add_ground(world);
  const std::vector<BodyId> boxes = add_pyramid(world, 12);
  run(world, 600);
  float fastest = 0;
  for (const BodyId box : boxes) fastest = max(fastest, speed(world, box));
  EXPECT_LT(fastest, 1e-4f);  // rigid-body.md 6.1, 17
  EXPECT_LT(world.worst_penetration(), 0.01f);
}

TYPED_TEST(Stack, PyramidSleepsAndWakesAsOne) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const std::vector<BodyId> boxes = add_pyramid(world, 5);
  run(world, 300);
  EXPECT_EQ(world.counters().awake_bodies, 0);
  EXPECT_EQ(world.counters().islands, 1);
  const std::uint64_t asleep = world.state_hash();
  run(world, 60);
  EXPECT_EQ(world.state_hash(), asleep);
  ASSERT_TRUE(world.add_impulse(boxes.back(), along<D>(500, 0)).ok());
  EXPECT_EQ(world.counters().awake_bodies, 15);
}

TYPED_TEST(Stack, HeavyBoxOnALightOneStays) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  add_box<D>(world, at<D>(0, 0.5), 0.5f, {0.6f, 0, 100, 0});
  const BodyId heavy = add_box<D>(world, at<D>(0, 1.5), 0.5f, {0.6f, 0, 3000, 0});
  run(world, 600);
  EXPECT_NEAR(world.state(heavy).value().pose.position.y, 1.5, 0.05);
}

// First loads (docs/computation.md) are handed down as far as masses can follow them, and no farther.
TYPED_TEST(Stack, WhatIsFarTooHeavySinksWithoutAShot) {
  using D = TypeParam;
  for (const float ratio : {1e6f, 1e9f}) {
    World<D> world(world_with<D>());
    add_ground(world);
    const BodyId light = add_box<D>(world, at<D>(0, 0.5), 0.5f, {0.6f, 0, 1, 0});
    const BodyId heavy = add_box<D>(world, at<D>(0, 1.5), 0.5f, {0.6f, 0, ratio, 0});
    double fastest = 0;
    for (int i = 0; i < 120; ++i) {
      run(world, 1);
      fastest = std::max(fastest, double(math::length(world.state(light).value().linear_velocity)));
    }
    EXPECT_LT(fastest, ratio > 1e6f ? 200 : 1) << ratio;
    if (ratio == 1e6f) EXPECT_NEAR(world.state(heavy).value().pose.position.y, 1.5, 0.05);
  }
}

TYPED_TEST(Stack, OverlappingBodiesSeparateGently) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  World<D> world(d);
  add_ground(world);
  const BodyId a = add_box<D>(world, at<D>(0, 0.5)), b = add_box<D>(world, at<D>(0.5, 0.5));
  float fastest = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(frame).value();
    fastest = max(fastest, max(speed(world, a), speed(world, b)));
  }
  EXPECT_LT(fastest, d.contact_push_speed);
  EXPECT_GT(world.state(b).value().pose.position.x - world.state(a).value().pose.position.x, 0.99);
}

TYPED_TEST(Stack, StandsFarFromTheOriginAsAtIt) {
  using D = TypeParam;
  double heights[2];
  const double places[2] = {0, 1e7};
  for (int k = 0; k < 2; ++k) {
    World<D> world(world_with<D>());
    add_body<D>(world, BodyType::fixed, box_shape<D>(50, 1, 50), at<D>(places[k], -1));
    BodyId top{};
    for (int i = 0; i < 5; ++i) top = add_box<D>(world, at<D>(places[k], 0.5 + i));
    run(world, 240);
    const BodyState<D> s = world.state(top).value();
    heights[k] = s.pose.position.y;
    EXPECT_NEAR(s.pose.position.x, places[k], 1e-3);
    EXPECT_FALSE(s.awake);
  }
  EXPECT_NEAR(heights[0], heights[1], 1e-4);
}

}  // namespace
}  // namespace carom::rigid::test
