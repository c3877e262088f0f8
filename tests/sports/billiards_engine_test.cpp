// The engine: shots from event to event.
#include "tests/sports/billiards_support.h"

namespace billiards_engine_test {
using namespace billiards_test;
using Kind = BilliardEvent::Kind;

/// At every event: no overlap, nothing in rubber, no more energy than before.
void check_all_the_way(Billiards& game, double slack = 1e-12) {
  const double r = game.physics().ball.radius, up = game.table().nose_height() - r, reach = math::sqrt(r * r - up * up);
  double before = game.energy();
  while (game.next_event_time() < never) {
    ASSERT_TRUE(game.run(game.next_event_time()).ok());
    for (int i = 0; i < game.balls(); ++i) {
      const BilliardState s = game.state(i);
      if (!in_play(s.phase)) continue;
      ASSERT_TRUE(is_finite(s.position) && is_finite(s.velocity) && is_finite(s.angular_velocity));
      if (s.phase != BallPhase::airborne) {
        ASSERT_GT(game.table().clearance({s.position.x, s.position.z}), reach - slack) << i << " at " << game.time();
        ASSERT_EQ(s.position.y, r);
      }
      for (int k = i + 1; k < game.balls(); ++k)
        if (in_play(game.state(k).phase)) {
          ASSERT_GT(distance(s.position, game.state(k).position), 2 * r - slack)
              << i << " " << k << " at " << game.time();
        }
    }
    // Pairs that keep touching are parted with a millimetre per second: 1e-7 J.
    ASSERT_LE(game.energy(), before + 2e-7) << game.time();
    before = game.energy();
  }
}

TEST(BilliardsEngine, BreaksAreCleanAndPartTheBalls) {
  for (const double gap : {0., 1e-5, 2e-4, 1e-3})
    for (const double speed : {2., 6., 10.}) {
      Billiards game = make_game(nine_foot_pool(), pool_physics());
      std::vector<Vec2d> balls = break_set(gap);
      balls[0].y = .04;
      ASSERT_TRUE(game.place(balls).ok());
      ASSERT_TRUE(game.strike(0, {aim_direction(balls[1] - balls[0]), speed}).ok());
      check_all_the_way(game);
      int moved = 0;
      for (int i = 1; i < 16; ++i) moved += game.path(i).size() > 1;
      EXPECT_EQ(moved, 15) << "gap " << gap << " speed " << speed;
    }
}

// A symmetric rack struck in the middle parts symmetrically.
TEST(BilliardsEngine, AStraightBreakIsSymmetric) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  ASSERT_TRUE(game.place(break_set()).ok());
  ASSERT_TRUE(game.strike(0, {.speed = 6}).ok());
  while (game.events().size() < 5) ASSERT_TRUE(game.run(game.next_event_time()).ok());
  int first = 1;
  for (int row = 0; row < 5; ++row) {
    for (int i = 0; i <= row; ++i) {
      const BilliardState a = game.state(first + i), b = game.state(first + row - i);
      EXPECT_NEAR(a.velocity.x, b.velocity.x, 1e-9);
      EXPECT_NEAR(a.velocity.z, -b.velocity.z, 1e-9);
      EXPECT_NEAR(a.angular_velocity.y, -b.angular_velocity.y, 1e-7);
    }
    first += row + 1;
  }
}

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

// The same bits when run at once, in pieces, again, and when read back from the record.
TEST(BilliardsEngine, ExactReplay) {
  Billiards whole = make_game(nine_foot_pool(), pool_physics());
  ASSERT_TRUE(whole.place(break_set()).ok());
  ASSERT_TRUE(whole.strike(0, {.speed = 6, .side = .1, .height = .2}).ok());
  Billiards pieces = whole, again = whole;
  ASSERT_TRUE(whole.run().ok());
  std::vector<std::vector<BilliardState>> seen;
  for (double t = 0; t < whole.time(); t += 1. / 60) {
    ASSERT_TRUE(pieces.run(t).ok());
    for (int i = 0; i < 16; ++i) {
      const BilliardState live = pieces.state(i), kept = whole.state(i, t);
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(bits(live.position[k]), bits(kept.position[k])) << i << " " << t;
        ASSERT_EQ(bits(live.velocity[k]), bits(kept.velocity[k]));
        ASSERT_EQ(bits(live.angular_velocity[k]), bits(kept.angular_velocity[k]));
      }
    }
  }
  ASSERT_TRUE(again.run().ok());
  ASSERT_EQ(again.events().size(), whole.events().size());
  for (std::size_t i = 0; i < again.events().size(); ++i)
    ASSERT_EQ(bits(again.events()[i].time), bits(whole.events()[i].time));
  EXPECT_EQ(whole.next_event_time(), never);
}

// The points of a way lie on it, and its straight parts have no more than their ends.
TEST(BilliardsEngine, TracesForDrawing) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{0, 0}}).ok());
  ASSERT_TRUE(game.strike(0, {.direction = .6, .speed = 2, .side = .3}).ok());
  ASSERT_TRUE(game.run().ok());
  std::vector<Vec3d> points;
  game.trace(0, 0, game.time(), .01, points);
  ASSERT_GT(points.size(), game.path(0).size());
  EXPECT_LT(points.size(), 200u);
  EXPECT_EQ(points.front(), (Vec3d{0, game.physics().ball.radius, 0}));
  EXPECT_LT(length(points.back() - game.state(0).position), 1e-12);
  double way = 0, fine = 0;
  for (std::size_t i = 1; i < points.size(); ++i) way += length(points[i] - points[i - 1]);
  for (double t = 0; t < game.time(); t += 1e-3)
    fine += length(game.state(0, t + 1e-3).position - game.state(0, t).position);
  EXPECT_NEAR(way, fine, 2e-3);
  points.clear();
  game.trace(0, .1, .3, .01, points);
  EXPECT_LT(length(points.front() - game.state(0, .1).position), 1e-12);
  EXPECT_LT(length(points.back() - game.state(0, .3).position), 1e-12);
}

// Thousands of random shots on every table, jumps and massés among them: all come to rest.
TEST(BilliardsEngine, RandomShotsComeToRest) {
  struct Setting {
    RectangularTable shape;
    BilliardPhysics physics;
  };
  const Setting settings[] = {{seven_foot_pool(), pool_physics()},
                              {nine_foot_pool(), pool_physics()},
                              {snooker_table(), snooker_physics()},
                              {carom_table(), carom_physics()},
                              {russian_table(), russian_physics()}};
  math::Random random(12);
  int pocketed = 0, gone = 0, flights = 0;
  std::int64_t most = 0;
  for (const Setting& setting : settings) {
    Billiards game = make_game(setting.shape, setting.physics);
    const Vec2d half{setting.shape.length / 2, setting.shape.width / 2};
    for (int shot = 0; shot < 800; ++shot) {
      const int count = 1 + int(random.below(10));
      const std::vector<Vec2d> balls = scatter(random, game.table(), half, count, setting.physics.ball.radius);
      ASSERT_TRUE(game.place(balls).ok());
      const Vec2d tip = .5 * random.in_disc();
      Stroke stroke{random.uniform(-3.2, 3.2), random.uniform(.05, 9.), tip.x, tip.y};
      if (random.chance(.4)) stroke.elevation = random.uniform(0., 1.5);
      stroke.hold_down = random.chance(.3);
      ASSERT_TRUE(game.strike(0, stroke).ok());
      const core::Status done = game.run();
      ASSERT_TRUE(done.ok()) << done.error().message << " shot " << shot;
      most = math::max(most, game.event_count());
      EXPECT_LT(game.time(), 60);
      for (int i = 0; i < count; ++i) {
        const BilliardState s = game.state(i);
        pocketed += s.phase == BallPhase::pocketed;
        gone += s.phase == BallPhase::off_table;
        if (in_play(s.phase)) {
          ASSERT_EQ(s.phase, BallPhase::resting);
          ASSERT_EQ(length(s.velocity) + length(s.angular_velocity), 0);
          ASSERT_TRUE(game.table().inside({s.position.x, s.position.z}));
        }
      }
      for (const BilliardEvent& e : game.events()) flights += e.kind == Kind::lands;
    }
  }
  EXPECT_GT(pocketed, 200);
  EXPECT_GT(gone, 10);
  EXPECT_GT(flights, 500);
  EXPECT_LT(most, 5000);
}

TEST(BilliardsEngine, RandomShotsKeepTheirLaws) {
  math::Random random(13);
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  for (int shot = 0; shot < 150; ++shot) {
    ASSERT_TRUE(game.place(scatter(random, game.table(), {1.2, .6}, 8, .028575)).ok());
    Stroke stroke{random.uniform(-3.2, 3.2), random.uniform(.5, 7.), random.uniform(-.35, .35),
                  random.uniform(-.35, .35)};
    if (shot % 3 == 0) stroke.elevation = random.uniform(0., 1.3);
    ASSERT_TRUE(game.strike(0, stroke).ok());
    check_all_the_way(game);
    if (HasFatalFailure()) {
      ADD_FAILURE() << "shot " << shot;
      return;
    }
  }
}

// Two frozen balls against a cushion, pressed on with follow: touching again and again, but not for ever.
TEST(BilliardsEngine, PressedBallsComeToRest) {
  const BilliardPhysics p = pool_physics();
  const double r = p.ball.radius, reach = r * .96;
  for (const double v : {.2, 1., 4.}) {
    auto made = Billiards::create(plain_table(.5, r), p);
    ASSERT_TRUE(
        made->place(std::vector<Vec2d>{{.5 - reach - 4 * r - .1, 0}, {.5 - reach - 2 * r, 0}, {.5 - reach, 0}}).ok());
    ASSERT_TRUE(
        made->set_state(0, {{.5 - reach - 4 * r - .1, r, 0}, {v, 0, 0}, {0, 0, -4 * v / r}, BallPhase::sliding}).ok());
    const core::Status done = made->run();
    EXPECT_TRUE(done.ok()) << done.error().message;
    EXPECT_LT(made->event_count(), 4000) << v;
  }
}

// A jump shot clears a ball that blocks the way, lands, and goes on.
TEST(BilliardsEngine, JumpShot) {
  Billiards game = on_plain({{0, 0}, {.25, 0}});
  ASSERT_TRUE(game.strike(0, {.speed = 5, .elevation = math::radians(50.)}).ok());
  ASSERT_EQ(game.state(0).phase, BallPhase::airborne);
  const double rise = game.state(0).velocity.y;
  ASSERT_TRUE(game.run().ok());
  bool met = false;
  int landings = 0;
  double first = 0;
  for (const BilliardEvent& e : game.events()) {
    met = met || e.kind == Kind::ball;
    if (e.kind == Kind::lands && landings++ == 0) first = e.time;
  }
  EXPECT_FALSE(met);
  EXPECT_NEAR(first, 2 * rise / 9.81, 1e-12) << "a parabola";
  EXPECT_GE(landings, 3) << "it bounces";
  EXPECT_GT(game.state(0).position.x, .5);
  EXPECT_EQ(game.path(1).size(), 1u);
}

TEST(BilliardsEngine, FastHighBallsLeaveTheTable) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{0, 0}}).ok());
  ASSERT_TRUE(game.set_state(0, {{0, .1, 0}, {6, 1.5, 1}, {}, BallPhase::airborne}).ok());
  ASSERT_TRUE(game.run().ok());
  EXPECT_EQ(game.state(0).phase, BallPhase::off_table);
  EXPECT_EQ(game.events().back().kind, Kind::leaves);
}

TEST(BilliardsEngine, StraightIntoEveryPocket) {
  for (const RectangularTable& shape : {seven_foot_pool(), nine_foot_pool(), snooker_table(), russian_table()}) {
    const BilliardPhysics p = shape.corner_mouth < .08 ? russian_physics()
                              : shape.length > 3       ? snooker_physics()
                                                       : pool_physics();
    Billiards game = make_game(shape, p);
    for (int pocket = 0; pocket < 6; ++pocket) {
      const Vec2d goal = game.table().pockets()[std::size_t(pocket)].center;
      const Vec2d from =
          goal - .3 * normalize(Vec2d{goal.x == 0 ? 0 : math::copysign(1, goal.x), math::copysign(1, goal.y)});
      ASSERT_TRUE(game.place(std::vector<Vec2d>{from}).ok()) << pocket;
      ASSERT_TRUE(game.strike(0, {aim_direction(goal - from), .8}).ok());
      ASSERT_TRUE(game.run().ok());
      EXPECT_EQ(game.pocket_of(0), pocket) << shape.length;
      EXPECT_EQ(game.state(0).phase, BallPhase::pocketed);
    }
  }
}

TEST(BilliardsEngine, BadInputIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BilliardPhysics p;
  p.cloth.rolling_friction = nan;
  const BilliardTable table = *BilliardTable::create(nine_foot_pool());
  auto bad = Billiards::create(table, p);
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().message.find("rolling_friction"), std::string::npos) << bad.error().message;
  p = {};
  p.ball.radius = .05;
  EXPECT_FALSE(Billiards::create(table, p).ok()) << "a nose below the equator";
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  EXPECT_FALSE(game.place({}).ok());
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{0, 0}}).ok());
  for (const std::vector<Vec2d>& wrong :
       {std::vector<Vec2d>{{nan, 0}}, {{5, 0}}, {{1.265, 0}}, {{0, 0}, {.05, 0}}, {{1.27, .635}}})
    EXPECT_FALSE(game.place(wrong).ok());
  EXPECT_EQ(game.balls(), 1) << "a refused set-up leaves the table as it was";
  EXPECT_FALSE(game.strike(1, {}).ok());
  EXPECT_FALSE(game.strike(0, {.direction = nan}).ok());
  EXPECT_FALSE(game.strike(0, {.speed = -1}).ok());
  EXPECT_FALSE(game.strike(0, {.side = .8, .height = .8}).ok());
  EXPECT_FALSE(game.strike(0, {.elevation = 2}).ok());
  EXPECT_FALSE(game.set_state(0, {{0, .028575, 0}, {nan, 0, 0}}).ok());
  EXPECT_FALSE(game.run(-1).ok());
  ASSERT_TRUE(game.strike(0, {.speed = 1}).ok());
  EXPECT_FALSE(game.strike(0, {.speed = 1}).ok()) << "it moves";
  Billiards small = make_game(nine_foot_pool(), pool_physics(), {.most_events = 3});
  ASSERT_TRUE(small.place(break_set()).ok());
  ASSERT_TRUE(small.strike(0, {.speed = 5}).ok());
  const core::Status stopped = small.run();
  ASSERT_FALSE(stopped.ok());
  EXPECT_NE(stopped.error().message.find("events"), std::string::npos);

  TableDef def{.outline = {{{-1, -1}}, {{1, 1}}, {{1, -1}}, {{-1, 1}}}};
  EXPECT_FALSE(BilliardTable::create(def).ok()) << "crosses itself";
  def.outline = {{{-1, -1}}, {{1, -1}, 0, true}, {{1, 1}}, {{-1, 1}}};
  EXPECT_FALSE(BilliardTable::create(def).ok()) << "an open edge without a pocket";
  RectangularTable shape;
  shape.corner_radius = .01;
  EXPECT_FALSE(make_table(shape).ok());
  shape = {};
  shape.width = nan;
  EXPECT_NE(make_table(shape).error().message.find("width"), std::string::npos);
}

// An L-shaped table, the outline given the other way round: the inner corner is rounded rubber.
TEST(BilliardsEngine, AnyPolygon) {
  TableDef def{.outline = {{{0, 0}}, {{0, 2}}, {{1, 2}}, {{1, 1}, .05}, {{2, 1}}, {{2, 0}}}};
  const auto table = BilliardTable::create(def);
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_EQ(table->jaws().size(), 1u);
  auto game = Billiards::create(*table);
  ASSERT_TRUE(game.ok());
  math::Random random(14);
  int jaws = 0;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(game->place(std::vector<Vec2d>{{.5, .5}}).ok());
    ASSERT_TRUE(game->strike(0, {i == 0 ? aim_direction({1, 1}) : random.uniform(-3., 3.), 4}).ok());
    while (i == 0 && (game->events().empty() || game->events().back().kind != Kind::jaw))
      ASSERT_TRUE(game->run(game->next_event_time()).ok());
    if (i == 0) {
      EXPECT_LT(game->state(0).velocity.x, -1);
      EXPECT_NEAR(game->state(0).velocity.x, game->state(0).velocity.z, 1e-12) << "straight back from the corner";
    }
    check_all_the_way(*game);
    for (const BilliardEvent& e : game->events()) jaws += e.kind == Kind::jaw;
  }
  EXPECT_GT(jaws, 5);
}

}  // namespace billiards_engine_test
