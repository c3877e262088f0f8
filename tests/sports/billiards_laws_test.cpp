// Laws of impacts: energy, symmetry, limits.
#include "carom/sports/detail/billiards_root.h"
#include "tests/sports/billiards_support.h"

namespace billiards_laws_test {
using namespace billiards_test;

double total(const BilliardState& a, const BilliardPhysics& p) { return energy(a, p); }

TEST(BilliardsLaws, EnergyNeverRisesInCushionImpacts) {
  math::Random random(5);
  for (const CushionModel model : {CushionModel::stronge, CushionModel::mathavan, CushionModel::han})
    for (const bool on_bed : {true, false})
      for (int i = 0; i < 400; ++i) {
        BilliardPhysics p;
        p.cushion.model = model;
        p.cushion.restitution = random.uniform(0.0, 1.0);
        p.cushion.friction = random.uniform(0.0, .6);
        p.cushion.frequency_ratio = random.uniform(1.01, 3.0);
        p.cushion.steps = 200;
        const double r = p.ball.radius, sine = random.uniform(0.0, .6);
        BilliardState s{{0, r, 0},
                        random.uniform(.1, 6.0) * Vec3d{random.uniform(.02, 1.0), 0, random.uniform(-1.0, 1.0)},
                        random.uniform(0.0, 200.0) * random.in_sphere(),
                        BallPhase::sliding};
        if (!on_bed) s.phase = BallPhase::airborne, s.velocity.y = random.uniform(-1.0, 1.0);
        const Vec3d toward{math::sqrt(1 - sine * sine), sine, 0};
        const double before = total(s, p), approach = dot(s.velocity, toward);
        const double told = strike_cushion(s, toward, on_bed, p);
        ASSERT_LE(total(s, p), before * (1 + 1e-12)) << int(model) << " " << i;
        ASSERT_NEAR(told, math::max(0.0, approach), 1e-12);
        const double left = approach > 0 ? p.cushion.restitution * approach : -approach;
        if (!on_bed) {
          ASSERT_NEAR(-dot(s.velocity, toward), left, 1e-11);
        }
      }
}

TEST(BilliardsLaws, EnergyNeverRisesOnTheBed) {
  math::Random random(6);
  for (int i = 0; i < 2000; ++i) {
    BilliardPhysics p;
    BilliardState s{{0, p.ball.radius, 0}, 5 * random.in_sphere(), 200 * random.in_sphere(), BallPhase::airborne};
    const double before = total(s, p);
    drop_on_bed(s, p);
    ASSERT_LE(total(s, p), before * (1 + 1e-12));
    ASSERT_GE(s.velocity.y, 0);
  }
}

// Stronge's phases in closed form against his equations integrated in time.
TEST(BilliardsLaws, StrongeAgainstIntegration) {
  for (const double e : {.5, .7, .85, 1.0})
    for (const double ratio : {1.2, 1.7, 1.8, 2.5})
      for (double x = .02; x < 3; x *= 1.3) {
        const double mu = .2, q = 3.5, dt = 6e-5, half = math::pi / 2;
        double v = x, u = 0;
        for (double t = 0; t < half * (1 + e); t += dt) {
          const double normal = t < half ? math::sin(t) : math::sin(t / e + half * (1 - 1 / e));
          const double most = mu * q * normal / (ratio * ratio);
          u = math::clamp(u + dt * v, -most, most);
          v -= dt * ratio * ratio * u;
        }
        const CompliantImpact after = stronge_impact(-x, -1, e, mu, ratio, q, 1);
        EXPECT_NEAR(-after.tangential, v, 1e-3) << "e " << e << " ratio " << ratio << " slip " << x;
        EXPECT_EQ(after.normal, e);
      }
}

// Mathavan, Han and Stronge agree within what their authors differ by, and all mirror.
TEST(BilliardsLaws, CushionModelsAgreeRoughly) {
  for (const double angle : {0., 20., 45., 60.}) {
    double out[3], turn[3];
    for (int m = 0; m < 3; ++m) {
      BilliardPhysics p;
      p.cushion.model = CushionModel(m);
      const double r = p.ball.radius, a = math::radians(angle), c = math::cos(a), s = math::sin(a);
      const Vec3d toward{.96, .28, 0};
      BilliardState left{{0, r, 0}, {c, 0, s}, rolling_spin({c, 0, s}, r), BallPhase::rolling};
      BilliardState right{{0, r, 0}, {c, 0, -s}, rolling_spin({c, 0, -s}, r), BallPhase::rolling};
      strike_cushion(left, toward, true, p);
      strike_cushion(right, toward, true, p);
      EXPECT_NEAR(left.velocity.x, right.velocity.x, 1e-14);
      EXPECT_NEAR(left.velocity.z, -right.velocity.z, 1e-14);
      EXPECT_NEAR(left.angular_velocity.y, -right.angular_velocity.y, 1e-12);
      out[m] = length(left.velocity);
      turn[m] = math::atan2(left.velocity.z, -left.velocity.x);
    }
    for (int m = 1; m < 3; ++m) {
      EXPECT_NEAR(out[m], out[0], .12) << angle;
      EXPECT_NEAR(turn[m], turn[0], math::radians(9.)) << angle;
    }
  }
}

// The root finder against a fine walk along random parabolas.
TEST(BilliardsLaws, FirstContactIsTheFirst) {
  math::Random random(7);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const double scale = random.uniform(.1, 3.0), reach = .06;
    const Vec3d d = random.uniform(.0601, 1.5) * random.on_sphere(), h = random.uniform(0.0, 1.0) * random.in_sphere();
    const Vec3d v = -scale * normalize(d + .1 * random.in_sphere());
    const double limit = random.uniform(.05, 2.0);
    const double t = detail::first_contact(d, v, h, reach, limit);
    double walked = never;
    for (double s = 0; s < limit; s += 2e-4)
      if (length(d + s * (v + s * h)) < reach) {
        walked = s;
        break;
      }
    if (t < never) {
      ++hits;
      ASSERT_NEAR(length(d + t * (v + t * h)), reach, 1e-12);
      ASSERT_LE(t, walked);
      // Nothing earlier, at any resolution of the walk; a graze may slip through the walk itself.
      if (walked < never) {
        ASSERT_LE(walked - t, 2.1e-4);
      }
    } else {
      ASSERT_EQ(walked, never) << i;
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(BilliardsLaws, FirstContactWhenTouching) {
  const Vec2d d{.06, 0}, still{};
  EXPECT_EQ(detail::first_contact(d, Vec2d{-1, 0}, still, .06, 1.), 0);
  EXPECT_EQ(detail::first_contact(d, Vec2d{1, 0}, still, .06, 1.), never);
  // Thrown off and falling back: after 2 v/a.
  EXPECT_NEAR(detail::first_contact(d, Vec2d{.1, 0}, Vec2d{-1, 0}, .06, 1.), .1, 1e-12);
  // Passing exactly along the rim.
  EXPECT_EQ(detail::first_contact(Vec2d{.5, .0600001}, Vec2d{-1, 0}, still, .06, 10.), never);
  EXPECT_NEAR(detail::first_contact(Vec2d{.5, .0599999}, Vec2d{-1, 0}, still, .06, 10.), .5 - 1.0954e-4, 1e-7);
}

// The cue: faster with a heavier cue, never more energy than it had; miscues at the tip's cone.
TEST(BilliardsLaws, CueGivesNoMoreThanItHas) {
  math::Random random(8);
  const BilliardBall ball;
  const BilliardPhysics p;
  int slipped = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2d tip = .97 * random.in_disc();
    const Stroke stroke{random.uniform(-3., 3.), random.uniform(0., 8.), tip.x, tip.y, random.uniform(0., 1.5)};
    const Cue cue{.tip_friction = random.uniform(.3, 1.)};
    const auto hit = strike_cue(stroke, cue, ball);
    ASSERT_TRUE(hit.ok());
    const BilliardState s{{0, ball.radius, 0}, hit->velocity, hit->angular_velocity};
    ASSERT_LE(energy(s, p), .5 * cue.mass * math::square(stroke.speed) * (1 + 1e-12));
    ASSERT_EQ(hit->miscue, length(tip) > math::sin(math::atan(cue.tip_friction)));
    slipped += hit->miscue;
  }
  EXPECT_GT(slipped, 100);
  EXPECT_NEAR(strike_cue({.side = .2}, {}, ball)->squirt, -strike_cue({.side = -.2}, {}, ball)->squirt, 1e-16);
}

// Coriolis 1835: a massé's final line is parallel to the line from the ball's foot to where the cue points on the bed.
TEST(BilliardsLaws, MasseFollowsCoriolis) {
  for (const double elevation : {50., 65., 80.})
    for (const double side : {-.3, .25, .45})
      for (const double height : {-.3, 0., .2}) {
        Billiards game = on_plain({{0, 0}});
        const double up = math::radians(elevation), r = game.physics().ball.radius;
        const Cue cue{.end_mass = 0};
        const auto hit =
            game.strike(0, {.speed = 2, .side = side, .height = height, .elevation = up, .hold_down = true}, cue);
        ASSERT_TRUE(hit.ok());
        ASSERT_FALSE(hit->miscue);
        ASSERT_TRUE(game.run().ok());
        Vec3d last{};
        for (const BilliardMotion& m : game.path(0))
          if (m.phase == BallPhase::rolling) last = m.velocity;
        // The cue's line meets the bed at A, seen from the foot of the ball.
        const double c = math::cos(up), s = math::sin(up), depth = math::sqrt(1 - side * side - height * height);
        const Vec3d along{c, -s, 0}, right{0, 0, 1}, over{s, c, 0};
        const Vec3d q = r * (side * right + height * over - depth * along) + Vec3d{0, r, 0};
        const Vec3d a = q + (q.y / s) * along;
        EXPECT_NEAR(math::atan2(last.z, last.x), math::atan2(a.z, a.x), 1e-9)
            << elevation << " " << side << " " << height;
      }
}

}  // namespace billiards_laws_test
