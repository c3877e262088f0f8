// Chapter 19.3–19.8, billiards: the properties that tests of a published simulator ask for (shared reference
// "ballistics-sports", 2.13: pooltool's tests), with ours of them.
#include "tests/sports/billiards_support.h"

namespace chapter_19_billiards_laws_test {
using namespace billiards_test;
using Kind = BilliardEvent::Kind;

// Cuts of 1° to 89°, to rounding: 1e-12 of the energy; momentum in the closed form to 1e-13.
TEST(Chapter19BilliardsLaws, EnergyNeverRisesInBallImpacts) {
  for (const BallContact::Model model : {BallContact::Model::closed_form, BallContact::Model::mathavan})
    for (const double e : {1.0, .95, .5, 0.0})
      for (int cut = 1; cut < 90; ++cut)
        for (const Vec3d spin : {Vec3d{}, Vec3d{0, 0, -35}, Vec3d{0, 60, 70}, Vec3d{-30, -80, -90}}) {
          BilliardPhysics p;
          p.balls.model = model;
          p.balls.restitution = e;
          const double c = math::radians(double(cut)), r = p.ball.radius;
          BilliardState a{{0, r, 0}, {1.5, 0, 0}, spin, BallPhase::sliding};
          BilliardState b{{2 * r * math::cos(c), r, 2 * r * math::sin(c)}};
          const double before = energy(a, p) + energy(b, p);
          const Vec3d momentum = a.velocity + b.velocity;
          strike_balls(a, b, {math::cos(c), 0, math::sin(c)}, true, p);
          ASSERT_LE(energy(a, p) + energy(b, p), before * (1 + 1e-12)) << cut << " e " << e;
          if (model == BallContact::Model::closed_form) {  // the bed's friction takes part in the other
            ASSERT_LT(length(a.velocity + b.velocity - momentum), 1e-13);
          }
          const Vec3d n{math::cos(c), 0, math::sin(c)};
          ASSERT_NEAR(dot(b.velocity - a.velocity, n), e * 1.5 * math::cos(c),
                      model == BallContact::Model::closed_form ? 1e-13 : 5e-3);
        }
}

// Nothing passes a cushion, and nobody passes through anybody, also between the events.
TEST(Chapter19BilliardsLaws, NoTunnellingAtBreakSpeed) {
  Billiards game = make_game(seven_foot_pool(), pool_physics());
  const double r = game.physics().ball.radius;
  const std::vector<Vec2d> balls = eight_ball_rack(seven_foot_pool(), r);
  ASSERT_TRUE(game.place(balls).ok());
  ASSERT_TRUE(game.strike(0, {.speed = 12}).ok());
  ASSERT_TRUE(game.run().ok());
  const double end = game.time();
  for (double t = 0; t < math::min(end, 3.); t += 1e-3)
    for (int i = 0; i < 16; ++i) {
      const BilliardState s = game.state(i, t);
      if (!in_play(s.phase) || s.phase == BallPhase::airborne) continue;
      ASSERT_TRUE(game.table().inside({s.position.x, s.position.z}));
      for (int k = 0; k < i; ++k) {
        const BilliardState o = game.state(k, t);
        if (in_play(o.phase)) {
          ASSERT_GT(distance(s.position, o.position), 2 * r - 1e-11) << t;
        }
      }
    }
}

// Balls that meet are two radii apart: 1e-12 m.
TEST(Chapter19BilliardsLaws, MakeKissSpacing) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  ASSERT_TRUE(game.place(break_set(3e-3)).ok());
  ASSERT_TRUE(game.strike(0, {.speed = 5}).ok());
  int kisses = 0;
  while (game.next_event_time() < never) {
    const std::size_t n = game.events().size();
    ASSERT_TRUE(game.run(game.next_event_time()).ok());
    for (std::size_t i = n; i < game.events().size(); ++i) {
      const BilliardEvent& e = game.events()[i];
      if (e.kind != Kind::ball) continue;
      ++kisses;
      EXPECT_NEAR(distance(game.state(e.ball).position, game.state(e.other).position), 2 * game.physics().ball.radius,
                  1e-12);
    }
  }
  EXPECT_GT(kisses, 10);
}

// A row of touching balls: they leave in order, the last with nearly all of it, and what they have is what came in.
TEST(Chapter19BilliardsLaws, CradleOrder) {
  for (const double gap : {0., 1e-3}) {
    BilliardPhysics p;
    p.balls = {.restitution = 1, .friction_floor = 0, .friction_range = 0};
    const double pitch = 2 * p.ball.radius + gap;
    Billiards game = on_plain({{-.2, 0}, {0, 0}, {pitch, 0}, {2 * pitch, 0}, {3 * pitch, 0}}, p);
    ASSERT_TRUE(game.set_state(0, {{-.2, p.ball.radius, 0}, {2, 0, 0}, {}, BallPhase::sliding}).ok());
    double came = 0, first_leaves = 0;
    while (game.next_event_time() < never && game.event_count() == 0) {
      came = game.motion(0).velocity_at(game.next_event_time()).x;
      ASSERT_TRUE(game.run(game.next_event_time()).ok());
    }
    if (gap > 0) {
      ASSERT_TRUE(game.run(game.time() + 4 * gap / came).ok());
    }
    double sum = 0, squares = 0;
    for (int i = 0; i < 5; ++i) {
      const double v = game.state(i).velocity.x;
      if (i > 0) {
        EXPECT_GE(v, game.state(i - 1).velocity.x - (gap == 0 ? 1e-9 : .01)) << i;
      }
      sum += v, squares += v * v;
    }
    first_leaves = game.state(4).velocity.x;
    if (gap == 0) {
      EXPECT_NEAR(sum, came, 1e-12);
      EXPECT_NEAR(squares, came * came, 1e-12 * came * came);
      // Hertz contacts do not pass on all of it (Hinch and Saint-Jean 1999): the last ball leaves with .98 to .99.
      EXPECT_NEAR(first_leaves / came, .985, .01);
    } else {
      EXPECT_NEAR(first_leaves / came, 1, .02) << "one after the other; the cloth brakes a little in between";
    }
  }
}

// Symmetry: the shot in the mirror, and on a table turned by any angle.
TEST(Chapter19BilliardsLaws, MirrorAndRotation) {
  math::Random random(11);
  for (int shot = 0; shot < 60; ++shot) {
    const BilliardPhysics p = pool_physics();
    const double r = p.ball.radius, turn = random.uniform(-3., 3.);
    const math::SinCos<double> t = math::sincos(turn);
    const auto turned = [&](Vec2d v) { return Vec2d{t.cos * v.x - t.sin * v.y, t.sin * v.x + t.cos * v.y}; };
    const BilliardTable straight = plain_table(.6, r), rotated = plain_table(.6, r, turn);
    const std::vector<Vec2d> balls = scatter(random, straight, {.55, .55}, 4, r);
    std::vector<Vec2d> mirrored, spun;
    for (const Vec2d b : balls) mirrored.push_back({b.x, -b.y}), spun.push_back(turned(b));
    const Stroke stroke{random.uniform(-3., 3.), random.uniform(1., 4.), random.uniform(-.4, .4),
                        random.uniform(-.3, .3)};
    Stroke other = stroke, third = stroke;
    other.direction = -stroke.direction, other.side = -stroke.side;
    third.direction = aim_direction(turned(aim_vector(stroke.direction)));
    Billiards a = *Billiards::create(straight, p), b = a, c = *Billiards::create(rotated, p);
    ASSERT_TRUE(a.place(balls).ok() && b.place(mirrored).ok() && c.place(spun).ok());
    ASSERT_TRUE(a.strike(0, stroke).ok() && b.strike(0, other).ok() && c.strike(0, third).ok());
    // Impacts of balls multiply rounding by 2·(way/R) each: compared up to the third.
    int kisses = 0;
    double until = 0;
    while (a.next_event_time() < never && kisses < 3) {
      until = a.next_event_time() + 1e-9;
      const std::size_t n = a.events().size();
      ASSERT_TRUE(a.run(until).ok());
      for (std::size_t i = n; i < a.events().size(); ++i) kisses += a.events()[i].kind == Kind::ball;
    }
    ASSERT_TRUE(b.run(until).ok() && c.run(until).ok());
    for (int i = 0; i < 4; ++i) {
      const BilliardState s = a.state(i), m = b.state(i), q = c.state(i);
      EXPECT_LT(length(s.position - Vec3d{m.position.x, m.position.y, -m.position.z}), 1e-9) << shot;
      const Vec2d there = turned({s.position.x, s.position.z});
      EXPECT_LT(distance(there, {q.position.x, q.position.z}), 1e-9) << shot;
      EXPECT_NEAR(s.angular_velocity.y, -m.angular_velocity.y, 1e-5);
      EXPECT_NEAR(s.angular_velocity.y, q.angular_velocity.y, 1e-5);
    }
  }
}

}  // namespace chapter_19_billiards_laws_test
