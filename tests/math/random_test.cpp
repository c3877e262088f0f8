// The generator gives the published words, and its distributions the moments they must have.
#include "carom/math/random.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "carom/math/calculus.h"
#include "carom/math/elementary.h"
#include "carom/math/statistics.h"

namespace carom::test::random_tests {
namespace {

using namespace carom::math;
constexpr int draws = 200000;

// Known answers of Philox4x32-10 that its authors publish with the Random123 library.
TEST(Random, PhiloxKnownAnswers) {
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, PositionsStreamsAndCopies) {
  Random a(5), b(5), other_stream(5, 1), other_seed(6);
  std::vector<std::uint32_t> words;
  for (int i = 0; i < 100; ++i) words.push_back(a.bits32());
  int equal_stream = 0, equal_seed = 0;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(b.bits32(), words[static_cast<std::size_t>(i)]);
    equal_stream += other_stream.bits32() == words[static_cast<std::size_t>(i)];
    equal_seed += other_seed.bits32() == words[static_cast<std::size_t>(i)];
  }
  EXPECT_EQ(equal_stream, 0);
  EXPECT_EQ(equal_seed, 0);
  for (const std::uint64_t place : {0u, 1u, 17u, 42u, 99u}) {
    b.set_position(place);
    EXPECT_EQ(b.bits32(), words[place]);
  }
  Random copy = a;
  EXPECT_TRUE(copy == a);
  EXPECT_EQ(copy.bits64(), a.bits64());
}

// Five standard errors: a wrong distribution fails, and the seed is fixed.
TEST(Random, UniformMoments) {
  Random random(1);
  RunningStatistics s, f;
  for (int i = 0; i < draws; ++i) {
    s.add(random.uniform());
    f.add(static_cast<double>(random.uniform_float()));
  }
  for (const RunningStatistics& r : {s, f}) {
    EXPECT_NEAR(r.mean(), 0.5, 5 * 0.2887 / sqrt(static_cast<double>(draws)));
    EXPECT_NEAR(r.variance(), 1.0 / 12, 5 * 0.0745 / sqrt(static_cast<double>(draws)));
    EXPECT_GE(r.minimum(), 0);
    EXPECT_LT(r.maximum(), 1);
  }
}

TEST(Random, NormalMomentsAndTails) {
  Random random(2);
  RunningStatistics s;
  double fourth = 0;
  int beyond_two = 0;
  for (int i = 0; i < draws; ++i) {
    const double x = random.normal();
    s.add(x);
    fourth += x * x * x * x;
    beyond_two += x > 2 || x < -2;
  }
  const double error = 1 / sqrt(static_cast<double>(draws));
  EXPECT_NEAR(s.mean(), 0, 5 * error);
  EXPECT_NEAR(s.variance(), 1, 5 * 1.4142 * error);
  EXPECT_NEAR(fourth / draws, 3, 5 * 9.8 * error);
  EXPECT_NEAR(beyond_two / static_cast<double>(draws), 0.0455003, 5 * 0.2084 * error);
  RunningStatistics e;
  for (int i = 0; i < draws; ++i) e.add(random.exponential());
  EXPECT_NEAR(e.mean(), 1, 5 * error);
}

TEST(Random, IntegersAreEquallyLikely) {
  Random random(3);
  int count[7] = {};
  for (int i = 0; i < 70000; ++i) ++count[random.below(7)];
  double chi_square = 0;
  for (const int c : count) chi_square += (c - 10000.0) * (c - 10000.0) / 10000.0;
  EXPECT_LT(chi_square, 22.46);  // 0.1 % point of χ² with six degrees of freedom
  EXPECT_EQ(random.below(0), 0u);
  EXPECT_EQ(random.below(1), 0u);
  EXPECT_EQ(random.integer(5, 3), 5);
  for (int i = 0; i < 1000; ++i) {
    const int n = random.integer(-2, 2);
    EXPECT_TRUE(n >= -2 && n <= 2);
    random.integer(INT32_MIN, INT32_MAX);
  }
  std::vector<int> items(52);
  std::iota(items.begin(), items.end(), 0);
  random.shuffle(items.data(), 52);
  EXPECT_EQ(std::accumulate(items.begin(), items.end(), 0), 51 * 52 / 2);
  EXPECT_NE(items[0] * 52 + items[1], 1);
}

// Archimedes: each coordinate of a point on the sphere is uniform; in the ball E r² = 3/5; in the disc E r² = 1/2.
TEST(Random, SpheresDiscsAndAttitudes) {
  Random random(4);
  RunningStatistics x, y, z, ball, disc, turn;
  for (int i = 0; i < draws / 4; ++i) {
    const Vec3d p = random.on_sphere();
    EXPECT_NEAR(length(p), 1, 1e-15 * 2);
    x.add(p.x);
    y.add(p.y);
    z.add(p.z);
    ball.add(length_squared(random.in_sphere()));
    disc.add(length_squared(random.in_disc()));
    const Quatd q = random.rotation();
    EXPECT_NEAR(length(q), 1, 1e-15 * 2);
    turn.add(q.w * q.w);
  }
  const double error = 5 / sqrt(draws / 4.0);
  for (const RunningStatistics& c : {x, y, z}) {
    EXPECT_NEAR(c.mean(), 0, 0.5774 * error);
    EXPECT_NEAR(c.variance(), 1.0 / 3, 0.2981 * error);
  }
  EXPECT_NEAR(ball.mean(), 0.6, 0.2619 * error);
  EXPECT_NEAR(disc.mean(), 0.5, 0.2887 * error);
  EXPECT_NEAR(turn.mean(), 0.25, 0.25 * error);  // a uniform point of S³
}

TEST(Statistics, MergedEqualsWhole) {
  Random random(5);
  RunningStatistics whole, first, second;
  std::vector<double> samples;
  for (int i = 0; i < 1000; ++i) {
    const double v = 1e9 + random.normal();
    samples.push_back(v);
    whole.add(v);
    (i < 300 ? first : second).add(v);
  }
  first.merge(second);
  EXPECT_EQ(first.count(), 1000u);
  EXPECT_NEAR(first.mean(), whole.mean(), 1e-14 * 1e9);
  EXPECT_NEAR(first.variance(), whole.variance(), 1e-6);
  EXPECT_NEAR(whole.variance(), 1, 0.25);  // no cancellation at 1e9
  EXPECT_EQ(first.minimum(), whole.minimum());
  EXPECT_EQ(first.maximum(), whole.maximum());
}

TEST(Statistics, PercentilesOfType7) {
  const double v[] = {15, 20, 35, 40, 50};
  EXPECT_EQ(percentile(v, 0), 15);
  EXPECT_EQ(percentile(v, 40), 29);  // 20 + 0.6 · 15
  EXPECT_EQ(median(v), 35);
  EXPECT_EQ(percentile(v, 100), 50);
  EXPECT_EQ(percentile(v, 400), 50);
  EXPECT_NE(percentile({}, 50), percentile({}, 50));
}

}  // namespace
}  // namespace carom::test::random_tests
