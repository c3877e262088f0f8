// Restitution and momentum (mechanics.md 5; rigid-body.md 6.1, 12, 21).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Impact : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Impact, Dimensions);

// The apex after a bounce is e² of the height, and never above it.
TYPED_TEST(Impact, BallReboundsToESquaredOfItsHeight) {
  using D = TypeParam;
  for (const float e : {0.2f, 0.5f, 0.8f, 1.0f})
    for (const double height : {0.7, 1.0, 2.0, 5.0, 13.0}) {
      World<D> world(world_with<D>());
      add_ground(world, {0, e, 1000, 0});
      const BodyId ball = add_ball<D>(world, at<D>(0, 0.5 + height), 0.5f, {0, e, 1000, 0});
      double apex = 0, fall = std::sqrt(2 * 9.81 * height);
      if (fall * e < 0.3) continue;
      bool bounced = false;
      for (int i = 0; i < 600; ++i) {
        world.step(frame).value();
        const BodyState<D> s = world.state(ball).value();
        if (s.linear_velocity.y > 0) bounced = true;
        if (bounced) apex = std::max(apex, s.pose.position.y - 0.5);
        if (bounced && s.linear_velocity.y < 0) break;
      }
      const double expected = e * e * height;
      EXPECT_NEAR(apex, expected, 0.01 * expected + 0.004) << "e " << e << " height " << height;
      EXPECT_LE(apex, height + 1e-3) << "e " << e << " height " << height;
    }
}

// How fast a ball spins does not matter to where it will meet another, whichever was made first: without friction the
// blow is along the line between them.
TYPED_TEST(Impact, ABallThatSpinsStrikesStraight) {
  using D = TypeParam;
  for (const bool first : {true, false})
    for (const float rate : {60.0f, 240.0f}) {
      WorldDef<D> definition = world_with<D>();
      definition.gravity = {};
      World<D> world(definition);
      BodyId ball[2];
      for (const int k : {first ? 0 : 1, first ? 1 : 0})
        ball[k] = add_ball<D>(world, at<D>(0.2 * k, 0), 0.02619f, {0, 0.95f, 1860, 0});
      typename D::Angular spin{};
      if constexpr (D::dimension == 2)
        spin = -73;
      else
        spin = {0, 0, -73};
      typename D::Vector along{};
      along.x = 1.926f;
      world.set_velocity(ball[0], along, spin).value();
      for (int i = 0; i < int(0.15f * rate); ++i) world.step(1 / rate).value();
      const BodyState<D> one = world.state(ball[0]).value(), other = world.state(ball[1]).value();
      EXPECT_NEAR(one.linear_velocity.x, 0.5 * (1 - 0.95) * 1.926, 2e-3) << first << ' ' << rate;
      EXPECT_NEAR(other.linear_velocity.x, 0.5 * (1 + 0.95) * 1.926, 2e-3) << first << ' ' << rate;
      EXPECT_NEAR(one.linear_velocity.y, 0, 1e-3) << first << ' ' << rate;
      EXPECT_NEAR(other.linear_velocity.y, 0, 1e-3) << first << ' ' << rate;
    }
}

TYPED_TEST(Impact, BallWithoutRestitutionDoesNotRebound) {
  using D = TypeParam;
  for (const float v : {5.0f, 50.0f, 200.0f}) {
    World<D> world(world_with<D>(0));
    add_ground(world);
    const BodyId ball = add_ball<D>(world, at<D>(0, 20), 0.25f, {}, along<D>(0, -v));
    run(world, 360);
    const BodyState<D> s = world.state(ball).value();
    EXPECT_LT(s.linear_velocity.y, 0.01f) << "v " << v;
    EXPECT_NEAR(s.pose.position.y, 0.25, 0.02) << "v " << v;
  }
}

// Equal masses, e = 1, head on: the velocities change owners.
TYPED_TEST(Impact, EqualBallsSwapVelocities) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const Surface hard{0, 1, 1000, 0};
  const BodyId a = add_ball<D>(world, at<D>(-2, 0), 0.5f, hard, along<D>(3, 0));
  const BodyId b = add_ball<D>(world, at<D>(2, 0), 0.5f, hard, along<D>(-1, 0));
  run(world, 120);
  EXPECT_NEAR(world.state(a).value().linear_velocity.x, -1, 1e-4);
  EXPECT_NEAR(world.state(b).value().linear_velocity.x, 3, 1e-4);
}

// v₁' = ((m₁ − e m₂) v₁ + (1 + e) m₂ v₂)/(m₁ + m₂), and v₂' with the indices exchanged.
TYPED_TEST(Impact, UnequalMassesFollowTheLawOfImpact) {
  using D = TypeParam;
  const float e = 0.6f;
  World<D> world(world_with<D>(0));
  const BodyId a = add_ball<D>(world, at<D>(-2, 0), 0.5f, {0, e, 1000, 0}, along<D>(4, 0));
  const BodyId b = add_ball<D>(world, at<D>(2, 0), 0.5f, {0, e, 3000, 0}, along<D>(-2, 0));
  run(world, 120);
  EXPECT_NEAR(world.state(a).value().linear_velocity.x, ((1 - e * 3) * 4 + (1 + e) * 3 * -2) / 4, 1e-3);
  EXPECT_NEAR(world.state(b).value().linear_velocity.x, ((3 - e * 1) * -2 + (1 + e) * 1 * 4) / 4, 1e-3);
}

// Inner forces move no centre of mass: a cloud of bodies that collide keeps its momentum, whatever their masses.
TYPED_TEST(Impact, MomentumOfACloudIsConstant) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  std::uint32_t r = 7;
  const auto draw = [&] {
    r = 1664525u * r + 1013904223u;
    return float(r >> 8) / 16777216.0f - 0.5f;
  };
  double scale = 0;
  for (int i = 0; i < 60; ++i) {
    const float x = draw(), y = draw(), z = draw(), density = 10.0f + 2000.0f * (draw() + 0.5f);
    const auto position = at<D>(8 * double(x), 8 * double(y), 8 * double(z));
    const auto velocity = along<D>(-6 * x, -6 * y, -6 * z);
    const Surface s{0.5f, 0.3f, density, 0};
    const BodyId body =
        i % 2 == 0 ? add_ball<D>(world, position, 0.4f, s, velocity)
                   : add_body<D>(world, BodyType::dynamic, box_shape<D>(0.4f, 0.3f, 0.5f), position, s, velocity);
    const BodyState<D> state = world.state(body).value();
    scale += double(state.mass) * double(math::length(state.linear_velocity));
  }
  const Totals<D> before = world.totals();
  run(world, 240);
  const Totals<D> after = world.totals();
  EXPECT_LT(math::length(after.momentum - before.momentum), 2e-6 * scale);
  EXPECT_LE(after.kinetic_energy, before.kinetic_energy * (1 + 1e-3));
}

// A ball thrown at a floor at a slant (mechanics.md 5.4): friction is an impulse of at most μ times the normal one,
// both of the blow and of the rebound, and stops the slip if it can. J_t = min(μ (1 + e) m v_n, m v_t/(1 + 1/β)) with
// I = β m r², whatever part of a step is left when they touch. Steps are short, because a contact that is foreseen acts
// between the surfaces: its lever is longer than the radius by half the gap.
TYPED_TEST(Impact, FrictionOfABounceFollowsTheWholeBlow) {
  using D = TypeParam;
  constexpr double beta = D::dimension == 2 ? 0.5 : 0.4, radius = 0.2, along_speed = 10, fall = 5;
  for (const float e : {0.3f, 0.8f, 1.0f})
    for (const float mu : {0.1f, 0.3f, 0.9f})
      for (const double gap : {0.30, 0.32, 0.345, 0.37}) {
        World<D> world(world_with<D>(0));
        add_ground(world, {mu, e, 1000, 0});
        const BodyId ball = add_ball<D>(world, at<D>(0, radius + gap), float(radius), {mu, e, 1000, 0},
                                        along<D>(float(along_speed), -float(fall)));
        for (int i = 0; i < 96; ++i) world.step(frame / 8).value();
        const BodyState<D> s = world.state(ball).value();
        double spin = 0;
        if constexpr (D::dimension == 2)
          spin = s.angular_velocity;
        else
          spin = s.angular_velocity.z;
        const double lost = std::min(double(mu) * (1 + double(e)) * fall, along_speed / (1 + 1 / beta));
        EXPECT_NEAR(s.linear_velocity.y, double(e) * fall, 0.01 * fall) << "e " << e << " μ " << mu << " gap " << gap;
        EXPECT_NEAR(s.linear_velocity.x, along_speed - lost, 0.01 * along_speed)
            << "e " << e << " μ " << mu << " gap " << gap;
        EXPECT_NEAR(-spin * radius, lost / beta, 0.02 * along_speed) << "e " << e << " μ " << mu << " gap " << gap;
      }
}

TYPED_TEST(Impact, EnergyOfAHeapNeverRises) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world, {0.5f, 0, 1000, 0});
  add_heap(world, 4);
  Totals<D> t = world.totals();
  const double start = t.kinetic_energy + t.potential_energy;
  double lowest = start;
  for (int i = 0; i < 400; ++i) {
    world.step(frame).value();
    t = world.totals();
    const double now = t.kinetic_energy + t.potential_energy;
    // Soft contacts store and give back a little.
    EXPECT_LE(now, lowest + 2e-3 * start) << "step " << i;
    lowest = std::min(lowest, now);
  }
}

}  // namespace
}  // namespace carom::rigid::test
