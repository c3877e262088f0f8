// Impacts that run through rows and racks (rigid-body.md 6.1, 13; mechanics.md 14).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Cradle : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Cradle, Dimensions);

constexpr float strike_speed = 5;

/// As many leave as came, the others rest: within 2 % of the speed.
template <class D>
void expect_textbook(const World<D>& world, const std::vector<BodyId>& balls, int moving) {
  const int count = int(balls.size());
  for (int i = 0; i < count; ++i) {
    const float expected = i < count - moving ? 0 : strike_speed;
    EXPECT_NEAR(world.state(balls[std::size_t(i)]).value().linear_velocity.x, expected, 0.02f * strike_speed)
        << "ball " << i << ", " << moving << " moving";
  }
}

// `moving` balls come in together and strike the ones at rest: all five touch when it happens.
TYPED_TEST(Cradle, FreeBallsLeaveAsTheyCame) {
  using D = TypeParam;
  for (int moving = 1; moving <= 3; ++moving)
    for (const double distance : {0.013, 0.5, 1.7}) {
      World<D> world(world_with<D>(0));
      std::vector<BodyId> balls;
      for (int i = 0; i < 5; ++i)
        balls.push_back(add_ball<D>(world, at<D>(i < moving ? i - distance : i, 0), 0.5f, {0, 1, 1000, 0},
                                    along<D>(i < moving ? strike_speed : 0, 0)));
      const Totals<D> before = world.totals();
      const int steps = 60;
      run(world, steps);
      expect_textbook(world, balls, moving);
      const Totals<D> after = world.totals();
      EXPECT_NEAR(after.momentum.x, before.momentum.x, 1e-6 * before.momentum.x);
      EXPECT_LE(after.kinetic_energy, before.kinetic_energy * (1 + 1e-6));
      EXPECT_GT(after.kinetic_energy, before.kinetic_energy * 0.999);
      // Nobody stood still or ran on while the blow went through: the last ball is where its time of flight puts it.
      EXPECT_NEAR(world.state(balls.back()).value().pose.position.x,
                  4 + double(strike_speed) * (steps / 60.0 - distance / double(strike_speed)), 0.01);
    }
}

// Hanging side by side from rods of 2 m, drawn up to strike at 5 m/s.
TYPED_TEST(Cradle, HangingBallsLeaveAsTheyCame) {
  using D = TypeParam;
  const double length = 4, radius = 0.1;
  const double rise = std::acos(1 - double(strike_speed) * double(strike_speed) / (2 * 9.81 * length));
  for (int moving = 1; moving <= 3; ++moving) {
    World<D> world(world_with<D>());
    const BodyId frame_body = add_fixed(world);
    std::vector<BodyId> balls;
    for (int i = 0; i < 5; ++i) {
      const double pivot = 2 * radius * i, angle = i < moving ? rise : 0;
      balls.push_back(add_ball<D>(world, at<D>(pivot - length * std::sin(angle), -length * std::cos(angle)),
                                  float(radius), {0, 1, 1000, 0}));
      DistanceJointDef<D> rod;
      rod.body_a = frame_body;
      rod.body_b = balls.back();
      rod.frame_a.p = along<D>(float(pivot), 0);
      rod.length = float(length);
      world.create_joint(rod).value();
    }
    // Until the last ball is as high as it gets: m g L (1 − cos) of it is the energy of the blow.
    double highest[5] = {};
    for (int i = 0; i < 150; ++i) {
      world.step(frame).value();
      if (i < 70) continue;
      for (std::size_t k = 0; k < 5; ++k)
        highest[k] = std::max(highest[k], world.state(balls[k]).value().pose.position.y + length);
    }
    const double height = double(strike_speed) * double(strike_speed) / (2 * 9.81);
    for (int k = 0; k < 5; ++k) {
      if (k < 5 - moving)
        EXPECT_LT(highest[k], 4e-4 * height) << "ball " << k << ", " << moving << " moving";  // 2 % of the speed
      else
        EXPECT_NEAR(highest[k], height, 0.01 * height) << "ball " << k << ", " << moving << " moving";
    }
  }
}

// The break: a cue ball into a rack of fifteen that touch. Inner forces move no centre of mass, and no impact gains.
TYPED_TEST(Cradle, BreakKeepsMomentumAndGainsNoEnergy) {
  using D = TypeParam;
  for (const float e : {1.0f, 0.95f, 0.7f}) {
    WorldDef<D> d = world_with<D>(0);
    d.restitution_threshold = 0.01f;
    d.allow_sleep = false;  // what falls asleep gives up its momentum
    World<D> world(d);
    const double r = 0.028575;  // pool balls of 57.15 mm
    const Surface ivory{e == 1 ? 0 : 0.05f, e, 1700, 0};
    for (int row = 0; row < 5; ++row)
      for (int k = 0; k <= row; ++k)
        add_ball<D>(world, at<D>(std::sqrt(3.0) * r * row, (2 * k - row) * r), float(r), ivory);
    const BodyId cue = add_ball<D>(world, at<D>(-0.5, 0.003), float(r), ivory, along<D>(10, 0));
    const Totals<D> before = world.totals();
    double last = before.kinetic_energy;
    for (int i = 0; i < 60; ++i) {
      world.step(frame).value();
      const double now = world.totals().kinetic_energy;
      EXPECT_LE(now, last * (1 + 1e-6)) << "e " << e << " step " << i;
      last = now;
    }
    const Totals<D> after = world.totals();
    EXPECT_LT(math::length(after.momentum - before.momentum), 1e-6 * math::length(before.momentum));
    EXPECT_LT(speed(world, cue), 6);
    // Balls that bounce wholly and do not rub keep all but what impacts below the threshold take.
    if (e == 1) EXPECT_GT(last, 0.999 * before.kinetic_energy);
  }
}

// The light ball on the heavy one: dropped together, it leaves at up to (3M − m)/(M + m) of the speed of fall.
TYPED_TEST(Cradle, LightBallOnAHeavyOneLeavesFaster) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world, {0, 1, 1000, 0});
  const float heavy = 4000, light = 400;  // of equal size
  add_ball<D>(world, at<D>(0, 1.5), 0.5f, {0, 1, heavy, 0});
  const BodyId top = add_ball<D>(world, at<D>(0, 2.5), 0.5f, {0, 1, light, 0});
  const double fall = std::sqrt(2 * 9.81 * 1.0), expected = fall * (3 * heavy - light) / (heavy + light);
  double fastest = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame).value();
    fastest = std::max(fastest, double(world.state(top).value().linear_velocity.y));
  }
  EXPECT_NEAR(fastest, expected, 0.03 * expected);
}

// e < 1 in a pile: infinitely many impacts in theory, and rest in the end.
TYPED_TEST(Cradle, PileOfBouncingBallsComesToRest) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const Surface rubber{0.5f, 0.6f, 1000, 0.01f};
  add_ground(world, rubber);
  for (const double x : {-1.6, 1.6}) add_body<D>(world, BodyType::fixed, box_shape<D>(0.1f, 9, 3), at<D>(x, 9), rubber);
  if constexpr (D::dimension == 3)
    for (const double z : {-0.6, 0.6})
      add_body<D>(world, BodyType::fixed, box_shape<D>(3, 9, 0.1f), at<D>(0, 9, z), rubber);
  for (int row = 0; row < 8; ++row)
    for (int k = 0; k < 3; ++k) add_ball<D>(world, at<D>(-1 + k + 0.02 * row, 0.6 + row), 0.45f, rubber);
  double lowest = 1e30, start = 0;
  for (int i = 0; i < 900; ++i) {
    world.step(frame).value();
    const Totals<D> t = world.totals();
    const double now = t.kinetic_energy + t.potential_energy;
    if (i == 0) start = now;
    EXPECT_LE(now, lowest + 1e-3 * start) << "step " << i;
    lowest = std::min(lowest, now);
  }
  EXPECT_EQ(world.counters().awake_bodies, 0);
  EXPECT_LT(world.worst_penetration(), 0.01f);
}

}  // namespace
}  // namespace carom::rigid::test
