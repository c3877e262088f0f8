// Aiming at targets that move as they like.
#include <gtest/gtest.h>

#include "tests/ballistics/aim_cases.h"

namespace ballistics_aim_test {

// A target on a circle is met where it will be.
TEST(Aim, AnyMotion) {
  const Projectile shot = projectile_from_coefficient(DragFunction::g7, .3);
  const Shooter shooter{.muzzle_speed = 300, .muzzle = {0, 2, 0}, .velocity = {10, 0, -5}};
  const auto place = [](double t) { return Vec3d{400 + 50 * math::cos(.7 * t), 20, 50 * math::sin(.7 * t)}; };
  const auto aims = aim(shot, {}, shooter, place);
  ASSERT_TRUE(aims && *aims);
  for (const auto& way : {aims->low, aims->high}) {
    const auto flight = fly(shot, {}, {shooter.muzzle, shooter.velocity + 300.0 * way->direction}, {.time = way->time});
    EXPECT_LT(math::length(flight->end().position - place(way->time)), .01);
  }
}

// Where targets of any motion are slow enough to be aimed at by guesses, no root of the walks is earlier, later or
// missed, and shots hit.
TEST(Aim, SlowTargetsOfAnyMotionAgreeWithTheScan) {
  math::Random random = random_asked(311);
  const int cases = cases_asked(300);
  int guessed = 0, hits = 0;
  for (int i = 0; i < cases; ++i) {
    Case c = draw(random);
    c.target.velocity *= 0.5;
    const Motion place(random, c.target, 40, 4);
    Aims aims;
    const AimOptions options{.longest_time = 60};
    if (!detail::AimSolver(c.projectile, c.conditions, c.shooter, place, options).two_arcs(aims)) continue;
    ++guessed;
    const Aims scan = by_scan(c, place);
    ASSERT_EQ(aims.low.has_value(), scan.low.has_value()) << i;
    if (!aims.low) continue;
    ++hits;
    EXPECT_NEAR(aims.low->time, scan.low->time, 1e-3 * scan.low->time + 1e-4) << i;
    EXPECT_NEAR(aims.high->time, scan.high->time, 1e-3 * scan.high->time + 1e-4) << i;
    EXPECT_LT(miss(c, *aims.low, place), .01) << i;
  }
  EXPECT_GT(guessed, 7 * cases / 10);
  EXPECT_GT(hits, 6 * cases / 10);
}

// Fast ones (up to eight tenths of the muzzle speed): within reach at t is what lies at rest where the target is then
// and is hit sooner by the low arc and later by the high one. Where that begins first and where it ends last, to the
// time between two looks, are the arcs. (Of 5 554 such cases all agreed.)
TEST(Aim, FastTargetsOfAnyMotionAreMetWhereTheyComeWithinReach) {
  math::Random random = random_asked(21);
  const int cases = cases_asked(80);
  constexpr int looks = 1500;
  const AimOptions options{.longest_time = 60};
  int fast = 0, hits = 0, late = 0;
  for (int i = 0; i < cases; ++i) {
    const Case c = draw(random);
    const Motion place(random, c.target, .4 * c.shooter.muzzle_speed, 2);
    Aims guessed;
    if (detail::AimSolver(c.projectile, c.conditions, c.shooter, place, options).two_arcs(guessed)) continue;
    ++fast;
    const Aims aims = *aim(c.projectile, c.conditions, c.shooter, place, options);
    double first = -1, last = -1;
    bool before = false;
    for (int k = 1; k <= looks; ++k) {
      const double t = options.longest_time * math::square(double(k) / looks);
      const Aims at = *aim(c.projectile, c.conditions, c.shooter, Target{place(t)}, {.longest_time = 400});
      const bool within = at && at.low->time <= t && at.high->time >= t;
      if (within != before && k > 1) last = t;
      if (within != before && first < 0) first = t;
      before = within;
    }
    ASSERT_EQ(bool(aims), first > 0) << i;
    if (!aims) continue;
    ++hits;
    late += last > first;
    const double apart = 2 * options.longest_time / looks;
    EXPECT_NEAR(aims.low->time, first, .01 * first + apart) << i;
    EXPECT_NEAR(aims.high->time, last, .01 * last + apart) << i;
    EXPECT_LT(miss(c, *aims.low, place), .01) << i;
    EXPECT_LT(miss(c, *aims.high, place), .01) << i;
  }
  EXPECT_GT(fast, cases / 3);
  EXPECT_GT(hits, fast / 2);
  EXPECT_GT(late, fast / 3);
}

}  // namespace ballistics_aim_test
