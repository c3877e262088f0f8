#include "carom/ode/clock.h"

#include <gtest/gtest.h>

#include <cmath>

namespace clock_test {
using carom::ode::FixedClock;
using carom::ode::Frame;

TEST(FixedClock, TakesAsManyStepsAsTimeWentBy) {
  FixedClock clock(0.01, 100);
  int steps = 0;
  for (int i = 0; i < 1000; ++i) steps += clock.advance(0.0137).steps;
  EXPECT_NEAR(steps, 1370, 1);
  EXPECT_NEAR(clock.time(), 13.7, 0.0101);
  EXPECT_EQ(clock.dropped(), 0);
}

TEST(FixedClock, EqualStepsAndFramesMakeOneStepEach) {
  FixedClock clock(1.0 / 60, 8);
  for (int i = 0; i < 100000; ++i) ASSERT_EQ(clock.advance(1.0 / 60).steps, 1) << i;
}

TEST(FixedClock, InterpolatesBetweenTheLastTwoStates) {
  FixedClock clock(0.1, 8);
  const Frame frame = clock.advance(0.25);
  EXPECT_EQ(frame.steps, 2);
  EXPECT_NEAR(frame.alpha, 0.5, 1e-12);
  EXPECT_NEAR(clock.show_time(), 0.15, 1e-12);
  for (int i = 0; i < 1000; ++i) {
    const Frame f = clock.advance(0.001 * (i % 37));
    EXPECT_GE(f.alpha, 0);
    EXPECT_LE(f.alpha, 1);
  }
}

TEST(FixedClock, DropsTimeBeyondTheLimitAndSaysSo) {
  FixedClock clock(0.01, 5);
  const Frame frame = clock.advance(1.0);
  EXPECT_EQ(frame.steps, 5);
  EXPECT_NEAR(frame.dropped, 0.95, 1e-12);
  EXPECT_EQ(clock.advance(0.0).steps, 0);
  EXPECT_EQ(clock.advance(1e300).steps, 5);
}

TEST(FixedClock, RefusesTimesThatAreNone) {
  FixedClock clock(0.01, 5);
  for (const double bad : {-1.0, double(NAN), double(INFINITY)}) {
    const Frame frame = clock.advance(bad);
    EXPECT_TRUE(frame.refused);
    EXPECT_EQ(frame.steps, 0);
  }
  EXPECT_FALSE(clock.advance(0.01).refused);
  EXPECT_EQ(clock.steps(), 1u);
  EXPECT_EQ(FixedClock(-3).step(), 1.0 / 60);
}

TEST(FixedClock, SlowMotion) {
  FixedClock clock(0.01, 5);
  clock.set_rate(0.5);
  EXPECT_EQ(clock.advance(0.04).steps, 2);
  clock.set_rate(NAN);
  EXPECT_EQ(clock.rate(), 0.5);
}

}  // namespace clock_test
