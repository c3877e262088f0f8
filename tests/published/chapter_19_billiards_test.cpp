// Chapter 19.3–19.8, billiards: published and exact numbers (shared reference "ballistics-sports", 2.13).
#include <gtest/gtest.h>

#include "carom/scene/billiards.h"
#include "carom/sports/billiards_engine.h"
#include "carom/sports/billiards_rack.h"
#include "tests/scene/source_file.h"

namespace chapter_19_billiards_test {
using namespace carom;
using namespace carom::sports;
using math::Vec2d;
using math::Vec3d;

constexpr double degree = math::pi / 180;

/// A bare bed, too large for anything to reach its cushions.
Billiards bed(const BilliardPhysics& physics, std::vector<Vec2d> balls) {
  TableDef def{.outline = {{{-60, -60}}, {{60, -60}}, {{60, 60}}, {{-60, 60}}},
               .nose_height = 1.28 * physics.ball.radius};
  auto table = BilliardTable::create(def);
  EXPECT_TRUE(table.ok()) << table.error().message;
  auto game = Billiards::create(*table, physics);
  EXPECT_TRUE(game.ok()) << game.error().message;
  EXPECT_TRUE(game->place(balls).ok());
  return std::move(*game);
}

BilliardState moving(const BilliardPhysics& p, Vec2d at, Vec3d v, Vec3d w) {
  return {{at.x, p.ball.radius, at.y}, v, w, BallPhase::sliding};
}

BilliardPhysics frictionless() {
  BilliardPhysics p;
  p.balls = {.restitution = 1, .friction_floor = 0, .friction_range = 0};
  return p;
}

// Parameters of section 2.13: pooltool's sets of pool, snooker and carom, the sizes of play, the fit of TP A.14.
TEST(Chapter19Billiards, PublishedParameters) {
  const BilliardPhysics pool = pool_physics(), snooker = snooker_physics(), carom_game = carom_physics();
  EXPECT_EQ(pool.ball.mass, .170097);
  EXPECT_EQ(pool.ball.radius, .028575);
  EXPECT_EQ(pool.cloth.sliding_friction, .2);
  EXPECT_EQ(pool.cloth.rolling_friction, .01);
  EXPECT_NEAR(pool.cloth.spinning_friction, .444 * .028575, 1e-15);
  EXPECT_EQ(pool.cloth.restitution, .5);
  EXPECT_EQ(pool.balls.restitution, .95);
  EXPECT_EQ(pool.balls.friction_floor, .009951);
  EXPECT_EQ(pool.balls.friction_range, .108);
  EXPECT_EQ(pool.balls.friction_rate, 1.088);
  EXPECT_EQ(pool.cushion.restitution, .85);
  EXPECT_EQ(pool.cushion.friction, .2);
  EXPECT_EQ(pool.cushion.model, CushionModel::stronge);
  EXPECT_EQ(pool.cushion.frequency_ratio, 1.8);
  EXPECT_EQ(snooker.ball.mass, .140);
  EXPECT_EQ(snooker.ball.radius, .02619375);
  EXPECT_EQ(snooker.cloth.sliding_friction, .5);
  EXPECT_EQ(snooker.cushion.friction, .5);
  EXPECT_EQ(carom_game.ball.mass, .210);
  EXPECT_EQ(carom_game.ball.radius, .03075);
  EXPECT_EQ(carom_game.cushion.friction, .15);
  EXPECT_EQ(seven_foot_pool().length, 1.9812);
  EXPECT_EQ(carom_table().length, 2.84);
  EXPECT_EQ(carom_table().width, 1.42);
  EXPECT_EQ(carom_table().nose_height, .037);
  EXPECT_EQ(snooker_table().length, 3.5445);
  EXPECT_EQ(snooker_table().width, 1.7465);
  EXPECT_NEAR(seven_foot_pool().nose_height, .64 * 2 * pool.ball.radius, 1e-12);
  EXPECT_NEAR(snooker_table().nose_height, .64 * 2 * snooker.ball.radius, 1e-12);
}

// Of section 2.13 too, as files: what FastFiz, tailuge/billiards and Mathavan's snooker tests play with.
TEST(Chapter19Billiards, PublishedPresets) {
  const auto text = [](const char* file) { return scene::test::read_source(file).value(); };
  const auto fastfiz = scene::read_billiard_table(text("presets/table/fastfiz.json"), "fastfiz");
  ASSERT_TRUE(fastfiz.ok()) << fastfiz.error().message;
  EXPECT_NEAR(fastfiz->physics.ball.mass, .16301, 1e-12);
  EXPECT_EQ(fastfiz->physics.balls.friction_floor, .01) << "the same at every speed";
  EXPECT_EQ(fastfiz->physics.balls.friction_range, 0);
  EXPECT_EQ(scene::read_cue(text("presets/cue/fastfiz.json"), "fastfiz")->tip_friction, .7);
  const auto heated = scene::read_billiard_table(text("presets/table/heated_carom.json"), "heated");
  ASSERT_TRUE(heated.ok()) << heated.error().message;
  EXPECT_NEAR(heated->physics.ball.radius, .03275, 1e-12);
  EXPECT_NEAR(heated->physics.ball.mass, .23, 1e-12);
  const auto cloth = scene::read_cloth(text("presets/cloth/heated_carom.json"), "heated");
  for (const Cloth& c : {*cloth, heated->physics.cloth}) {
    EXPECT_EQ(c.sliding_friction, .126);
    EXPECT_EQ(c.rolling_friction, .0055);
  }
  EXPECT_EQ(scene::read_cloth(text("presets/cloth/mathavan_snooker.json"), "mathavan")->sliding_friction, .212);
}

// Exact: t = 2 v₀/(7 μ g), x = 12 v₀²/(49 μ g), v = 5/7 v₀. The reference prints g 9.80665 beside its second case, but
// its numbers are those of 9.81 (with 9.80665: .291347 s, .499453 m).
TEST(Chapter19Billiards, AStunnedBallSlidesThenRolls) {
  struct Case {
    double v, g, time, distance;
  };
  for (const Case c : {Case{1, 9.81, .145623999, .124820570}, Case{2, 9.81, .29125, .49928}}) {
    BilliardPhysics p;
    p.gravity = c.g;
    Billiards game = bed(p, {{0, 0}});
    ASSERT_TRUE(game.set_state(0, moving(p, {0, 0}, {c.v, 0, 0}, {})).ok());
    ASSERT_TRUE(game.run().ok());
    const BilliardMotion& slide = game.path(0)[0];
    const double precise = c.v == 1 ? 1e-9 : 5e-6;  // as printed
    EXPECT_NEAR(slide.end, c.time, precise);
    EXPECT_NEAR(slide.position_at(slide.end).x, c.distance, precise);
    EXPECT_NEAR(game.path(0)[1].velocity.x, 5 * c.v / 7, 1e-14);
    if (c.v == 2) EXPECT_NEAR(game.path(0)[1].velocity.x, 1.42857, 5e-6);
    // Roll-out v²/(2 μ_r g).
    EXPECT_NEAR(game.state(0).position.x - slide.position_at(slide.end).x, math::square(5 * c.v / 7) / (2 * .01 * c.g),
                1e-12);
    EXPECT_EQ(game.state(0).phase, BallPhase::resting);
  }
}

// v_f = 5/7 v₀ + 2/7 R ω₀ for any spin, draw included.
TEST(Chapter19Billiards, FinalSpeedFromSpeedAndSpin) {
  const BilliardPhysics p;
  for (const double spin : {-2.0, -1.0, -.5, .3, 1.0, 1.6}) {
    const double v = 1.3, w = spin * v / p.ball.radius;
    Billiards game = bed(p, {{0, 0}});
    ASSERT_TRUE(game.set_state(0, moving(p, {0, 0}, {v, 0, 0}, {0, 3, -w})).ok());
    const double slip_ends = game.next_event_time();
    ASSERT_TRUE(game.run(spin == 1 ? 0 : slip_ends).ok());
    EXPECT_EQ(game.path(0).back().phase, BallPhase::rolling);
    EXPECT_NEAR(game.path(0).back().velocity.x, 5 * v / 7 + 2 * p.ball.radius * w / 7, 1e-12) << spin;
  }
}

// v = 2V₀/(1 + m/M + 2.5 b²): m .170097, M .567.
TEST(Chapter19Billiards, CueSpeedAndOffset) {
  const BilliardBall ball;
  EXPECT_NEAR(strike_cue({.speed = 1}, {}, ball)->velocity.x, 1.538468, 1e-6);
  const auto rolls = strike_cue({.speed = 1, .height = .4}, {}, ball);
  EXPECT_NEAR(rolls->velocity.x, 1.176474, 1e-6);
  EXPECT_NEAR(-rolls->angular_velocity.z * ball.radius, rolls->velocity.x, 1e-14) << "rolls when struck at 7R/5";
}

TEST(Chapter19Billiards, Squirt) {
  EXPECT_NEAR(squirt_angle(.2, 20) / degree, 1.19936, 1e-5);  // a test value of pooltool's
  EXPECT_NEAR(squirt_angle(.5, 30) / degree, 1.88600, 1e-5);
  const auto hit = strike_cue({.speed = 1, .side = .5}, {.mass = .567, .end_mass = .170097 / 30}, BilliardBall{});
  EXPECT_NEAR(math::atan2(-hit->velocity.z, hit->velocity.x) / degree, 1.88600, 1e-5) << "away from the tip's side";
}

// Head-on, rolling, e 1: the cue ball follows with 2/7 v, the object ball goes on with 5/7 v.
TEST(Chapter19Billiards, HeadOnFullRoll) {
  const BilliardPhysics p = frictionless();
  Billiards game = bed(p, {{0, 0}, {.3, 0}});
  const double v = 1.2;
  ASSERT_TRUE(game.set_state(0, moving(p, {0, 0}, {v, 0, 0}, {0, 0, -v / p.ball.radius})).ok());
  ASSERT_TRUE(game.run(game.next_event_time()).ok());
  const double at_impact = game.path(1).back().velocity.x;
  ASSERT_TRUE(game.run().ok());
  double cue = 0, object = 0;
  for (const BilliardMotion& m : game.path(0))
    if (m.phase == BallPhase::rolling) cue = m.velocity.x;
  for (const BilliardMotion& m : game.path(1))
    if (m.phase == BallPhase::rolling) object = m.velocity.x;
  EXPECT_NEAR(cue, at_impact * 2 / 7, 1e-12);
  EXPECT_NEAR(object, at_impact * 5 / 7, 1e-12);
}

/// Final deflection of the cue ball (rad) from its line, by the engine, for a cut with slip decided by `roll` (1: it
/// rolls, 0: stun).
double deflection(const BilliardPhysics& p, double cut, double roll, double v = 1) {
  // Just before contact.
  const double gap = 2 * p.ball.radius * (1 + 1e-9);
  Billiards game = bed(p, {{0, 0}, {gap * math::cos(cut), gap * math::sin(cut)}});
  EXPECT_TRUE(game.set_state(0, moving(p, {0, 0}, {v, 0, 0}, {0, 0, -roll * v / p.ball.radius})).ok());
  EXPECT_TRUE(game.run().ok());
  for (const BilliardMotion& m : game.path(0))
    if (m.start > 1e-6 && m.phase == BallPhase::rolling) return math::atan2(-m.velocity.z, m.velocity.x);
  return 0;
}

TEST(Chapter19Billiards, DeflectionOfARollingBall) {
  const BilliardPhysics p = frictionless();
  EXPECT_NEAR(deflection(p, 15 * degree, 1) / degree, 28.1622, 1e-4);
  EXPECT_NEAR(deflection(p, 30 * degree, 1) / degree, 33.6705, 1e-4);
  // Its maximum: 33.748989° at 28.125505°.
  const double top = deflection(p, 28.125505 * degree, 1) / degree;
  EXPECT_NEAR(top, 33.748989, 1e-5);
  EXPECT_GT(top, deflection(p, 28.0 * degree, 1) / degree);
  EXPECT_GT(top, deflection(p, 28.25 * degree, 1) / degree);
  // Stun: the right angle.
  for (const double cut : {15., 45., 70.}) EXPECT_NEAR(deflection(p, cut * degree, 0), (90 - cut) * degree, 1e-7);
}

/// Angle (rad) by which the object ball leaves the line of centres, toward the cue ball's line of motion.
double throw_angle(const BilliardPhysics& p, double v, double cut, Vec3d spin) {
  BilliardState cue{{0, p.ball.radius, 0}, {v, 0, 0}, spin, BallPhase::sliding};
  const Vec3d n{math::cos(cut), 0, -math::sin(cut)};
  BilliardState object{2 * p.ball.radius * n + Vec3d{0, p.ball.radius, 0}};
  strike_balls(cue, object, n, true, p);
  const Vec3d across{n.z, 0, -n.x};  // of the cue ball's motion: (sin-ward) to the side it slips to
  return math::atan2(-dot(object.velocity, across), dot(object.velocity, n));
}

// Alciatore TP A.14, e 1.
TEST(Chapter19Billiards, Throw) {
  BilliardPhysics p;
  p.balls.restitution = 1;
  const double stun[4] = {2.1921, 3.5491, 2.7734, 2.3179};
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(math::abs(throw_angle(p, 1.341, 15 * (i + 1) * degree, {})) / degree, stun[i], 1e-4);
  const Vec3d roll{0, 0, -1.341 / p.ball.radius};
  EXPECT_NEAR(math::abs(throw_angle(p, 1.341, 15 * degree, roll)) / degree, .5199, 1e-4);
  EXPECT_NEAR(math::abs(throw_angle(p, 1.341, 30 * degree, roll)) / degree, 1.0042, 1e-4);
  EXPECT_NEAR(math::abs(throw_angle(p, 1, 0, {0, .5 / p.ball.radius, 0})) / degree, 4.0856, 1e-4);
  // Gearing english, Rω/v = sin φ, on the one side only.
  for (const double cut : {10., 30., 60.}) {
    const double w = math::sin(cut * degree) / p.ball.radius;
    const double one = math::abs(throw_angle(p, 1, cut * degree, {0, w, 0})),
                 other = math::abs(throw_angle(p, 1, cut * degree, {0, -w, 0}));
    EXPECT_LT(math::min(one, other), 1e-12) << cut;
    EXPECT_GT(math::max(one, other), 1e-3) << cut;
  }
}

// Mathavan, Jackson, Parkin 2014, tables 1 and 2, as in pooltool's tests; 1 %.
TEST(Chapter19Billiards, BallOnBallByMathavan) {
  struct Case {
    double v, topspin, cut, v_cue, v_object, angle_cue, angle_object;
  };
  for (const Case c :
       {Case{1.539, 58.63, 33.83, .914, .831, 31.93, 32.20}, Case{1.032, 39.31, 26.36, .520, .599, 32.45, 25.07}}) {
    BilliardPhysics p;
    p.ball = {.mass = .1406, .radius = .02625};
    p.cloth.sliding_friction = .21;
    p.balls = {.model = BallContact::Model::mathavan, .restitution = .89, .friction_floor = .05, .friction_range = 0};
    const double gap = 2 * p.ball.radius * (1 + 1e-9), cut = c.cut * degree;
    Billiards game = bed(p, {{0, 0}, {gap * math::cos(cut), -gap * math::sin(cut)}});
    ASSERT_TRUE(game.set_state(0, moving(p, {0, 0}, {c.v, 0, 0}, {0, 0, -c.topspin})).ok());
    ASSERT_TRUE(game.run().ok());
    const double expected[2] = {c.v_cue, c.v_object}, angles[2] = {c.angle_cue, c.angle_object};
    for (int ball = 0; ball < 2; ++ball) {
      Vec3d v{};
      for (const BilliardMotion& m : game.path(ball))
        if (m.start > 1e-6 && m.phase == BallPhase::rolling) v = m.velocity;
      EXPECT_NEAR(length(v), expected[ball], .01 * expected[ball]) << c.v << " ball " << ball;
      EXPECT_NEAR(math::abs(math::atan2(v.z, v.x)) / degree, angles[ball], .01 * angles[ball])
          << c.v << " ball " << ball;
    }
  }
}

// Mathavan, Jackson, Parkin 2010 with its snooker constants: 1 m/s rolling straight in.
TEST(Chapter19Billiards, CushionByMathavan) {
  BilliardPhysics p;
  p.ball = {.mass = .1406, .radius = .02625};
  p.cloth.sliding_friction = .212;
  p.cushion = {.model = CushionModel::mathavan, .restitution = .98, .friction = .14, .steps = 100'000};
  const Vec3d toward{math::sqrt(1 - .16), .4, 0};
  BilliardState s{{0, p.ball.radius, 0}, {1, 0, 0}, {0, 0, -1 / p.ball.radius}, BallPhase::rolling};
  strike_cushion(s, toward, true, p);
  // Ours converges to .9106578 (1e6 and 5e6 steps): 1.2e-5 from the reference's number.
  EXPECT_NEAR(s.velocity.x, -.91067, 2e-5);
  // The default number of steps.
  p.cushion.steps = CushionContact{}.steps;
  s = {{0, p.ball.radius, 0}, {1, 0, 0}, {0, 0, -1 / p.ball.radius}, BallPhase::rolling};
  strike_cushion(s, toward, true, p);
  EXPECT_NEAR(s.velocity.x, -.91067, 1e-3);
}

// Han 2005 with the pool preset (nose at .64 of the diameter: sin θ = .28). The reference's z is up: its y is −z here.
TEST(Chapter19Billiards, CushionByHan) {
  BilliardPhysics p = pool_physics();
  p.cushion.model = CushionModel::han;
  const Vec3d toward{math::sqrt(1 - .28 * .28), .28, 0};
  const double r = p.ball.radius;
  BilliardState s{{0, r, 0}, {1, 0, 0}, {0, 0, -1 / r}, BallPhase::rolling};
  strike_cushion(s, toward, true, p);
  EXPECT_NEAR(s.velocity.x, -.80442, 1e-5);
  EXPECT_NEAR(-s.angular_velocity.z, 3.91951, 1e-4);
  s = {{0, r, 0}, {1, 0, -1}, {-1 / r, 0, -1 / r}, BallPhase::rolling};
  strike_cushion(s, toward, true, p);
  EXPECT_NEAR(s.velocity.x, -.77529, 1e-5);
  EXPECT_NEAR(-s.velocity.z, .74884, 1e-5);
  EXPECT_NEAR(s.angular_velocity.y, -21.09517, 1e-4);
}

// Stronge's compliant impact, scalars as in tailuge/billiards' tests.
TEST(Chapter19Billiards, CushionByStronge) {
  CompliantImpact after = stronge_impact(0, -1, .7, .2, 1.7, 3.5, 1);
  EXPECT_NEAR(after.tangential, 0, 1e-12);
  EXPECT_NEAR(after.normal, .7, 1e-12);
  after = stronge_impact(-3, -1, .7, .2, 1.7, 3.5, 1);
  EXPECT_NEAR(after.tangential, -1.81, 1e-12);
  EXPECT_NEAR(after.normal, .7, 1e-12);
}

// 19.3: the rack's balls touch exactly, on every table that has a triangle.
TEST(Chapter19Billiards, Rack) {
  const double pool = pool_physics().ball.radius, snooker = snooker_physics().ball.radius;
  const struct {
    std::vector<Vec2d> balls;
    double radius;
    std::size_t first;  // of the triangle
  } racks[] = {{eight_ball_rack(seven_foot_pool(), pool), pool, 1},
               {eight_ball_rack(eight_foot_pool(), pool), pool, 1},
               {eight_ball_rack(nine_foot_pool(), pool), pool, 1},
               {eight_ball_rack(russian_table(), russian_physics().ball.radius), russian_physics().ball.radius, 1},
               {snooker_rack(snooker_table(), snooker), snooker, 7}};
  for (const auto& rack : racks) {
    ASSERT_EQ(rack.balls.size(), rack.first + 15);
    int contacts = 0;
    for (std::size_t i = rack.first; i < rack.balls.size(); ++i)
      for (std::size_t k = i + 1; k < rack.balls.size(); ++k) {
        const double gap = distance(rack.balls[i], rack.balls[k]) - 2 * rack.radius;
        EXPECT_GT(gap, -1e-15);
        contacts += gap < 1e-15;
      }
    EXPECT_EQ(contacts, 30) << "of a triangle of 15";
  }
}

}  // namespace chapter_19_billiards_test
