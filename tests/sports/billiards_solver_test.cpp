// The shot solver: what it says comes true on the table, and it says so where nothing does.
#include "carom/sports/billiards_solver.h"

#include "tests/sports/billiards_support.h"

namespace billiards_solver_test {
using namespace billiards_test;

bool pots(Billiards game, const Stroke& stroke, int ball, int pocket) {
  EXPECT_TRUE(game.strike(0, stroke).ok());
  EXPECT_TRUE(game.run().ok());
  return game.pocket_of(ball) == pocket;
}

TEST(BilliardsSolver, PotsWithThrowAndSquirtCompensated) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  // A cut of some 40° to the corner pocket 3 at (+x, +z).
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{-.2, .1}, {.5, .2}}).ok());
  double aims[5];
  int i = 0;
  for (const double side : {-.4, -.2, 0., .2, .4}) {
    const auto solved = solve_shot(game, {.object = 1, .pocket = 3}, {.side = side});
    ASSERT_TRUE(solved.ok()) << solved.error().message;
    ASSERT_TRUE(solved->has_value()) << side;
    EXPECT_TRUE(pots(game, (*solved)->stroke, 1, 3)) << side;
    EXPECT_LT((*solved)->miss, 1e-6);
    EXPECT_GT((*solved)->window, math::radians(.1));
    for (const double off : {-.95, .95}) {
      Stroke stroke = (*solved)->stroke;
      stroke.direction += off * (*solved)->window;
      EXPECT_TRUE(pots(game, stroke, 1, 3)) << side << " off by " << off;
    }
    aims[i++] = (*solved)->stroke.direction;
  }
  // Aiming as without english misses the aim by the squirt, some degrees from end to end.
  EXPECT_GT(math::abs(aims[0] - aims[4]), math::radians(2.));
  const Vec2d goal = game.table().pockets()[3].center;
  const double straight = aim_direction(ghost_ball({.5, .2}, goal, .028575) - Vec2d{-.2, .1});
  EXPECT_NEAR(aims[2], straight, math::radians(4.)) << "the ghost ball, but for the throw";
  EXPECT_GT(math::abs(aims[2] - straight), math::radians(.01));
}

TEST(BilliardsSolver, RandomPots) {
  math::Random random(21);
  Billiards game = make_game(eight_foot_pool(), pool_physics());
  int solved = 0, cuts = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<Vec2d> balls = scatter(random, game.table(), {1.1, .55}, 2, .028575);
    ASSERT_TRUE(game.place(balls).ok());
    const int pocket = int(random.below(6));
    const Vec2d to = normalize(game.table().pockets()[std::size_t(pocket)].center - balls[1]);
    const double cut = math::acos(math::clamp(dot(to, normalize(balls[1] - balls[0])), -1., 1.));
    const auto shot = solve_shot(game, {.object = 1, .pocket = pocket});
    ASSERT_TRUE(shot.ok()) << shot.error().message;
    if (cut > math::radians(100.)) {
      EXPECT_FALSE(shot->has_value()) << "cut " << cut;
    }
    // Corner pockets take a ball from anywhere that is not hidden by the rail.
    if (cut < math::radians(50.) && pocket != 1 && pocket != 4) {
      ++cuts;
      solved += shot->has_value();
    }
    if (*shot) {
      EXPECT_TRUE(pots(game, (*shot)->stroke, 1, pocket));
    }
  }
  EXPECT_GE(solved, cuts * 9 / 10) << cuts;
  EXPECT_GT(cuts, 5);
}

TEST(BilliardsSolver, BanksAndKicks) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{-.5, .1}, {-.1, -.2}}).ok());
  const auto bank = solve_shot(game, {.object = 1, .pocket = 3, .object_cushions = 1});
  ASSERT_TRUE(bank.ok()) << bank.error().message;
  ASSERT_TRUE(bank->has_value());
  EXPECT_TRUE(pots(game, (*bank)->stroke, 1, 3));
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{-.5, .1}, {.95, .45}}).ok());
  const auto kick = solve_shot(game, {.object = 1, .pocket = 3, .cue_cushions = 1}, {.keep_cue_ball = false});
  ASSERT_TRUE(kick.ok()) << kick.error().message;
  ASSERT_TRUE(kick->has_value());
  Billiards played = game;
  ASSERT_TRUE(played.strike(0, (*kick)->stroke).ok());
  ASSERT_TRUE(played.run().ok());
  EXPECT_EQ(played.pocket_of(1), 3);
  bool cushion = false;
  for (const BilliardEvent& e : played.events()) {
    cushion = cushion || (e.kind == BilliardEvent::Kind::cushion && e.ball == 0);
    if (e.kind == BilliardEvent::Kind::ball) break;
  }
  EXPECT_TRUE(cushion);
}

TEST(BilliardsSolver, ToAPlace) {
  Billiards game = make_game(carom_table(), carom_physics());
  for (const Vec2d place : {Vec2d{.8, .3}, {.6, -.4}, {1.2, .1}}) {
    ASSERT_TRUE(game.place(std::vector<Vec2d>{{-.6, 0}, {.1, .05}}).ok());
    const auto shot = solve_shot(game, {.object = 1, .place = place, .tolerance = .005});
    ASSERT_TRUE(shot.ok()) << shot.error().message;
    ASSERT_TRUE(shot->has_value()) << place.x;
    ASSERT_TRUE(game.strike(0, (*shot)->stroke).ok());
    ASSERT_TRUE(game.run().ok());
    const Vec3d p = game.state(1).position;
    EXPECT_LT(distance({p.x, p.z}, place), .005);
  }
}

TEST(BilliardsSolver, SaysWhereThereIsNone) {
  Billiards game = make_game(nine_foot_pool(), pool_physics());
  // Behind the object ball, and behind a wall of others.
  ASSERT_TRUE(game.place(std::vector<Vec2d>{{.9, .4}, {.3, .1}}).ok());
  auto shot = solve_shot(game, {.object = 1, .pocket = 3});
  ASSERT_TRUE(shot.ok());
  EXPECT_FALSE(shot->has_value());
  ASSERT_TRUE(
      game.place(std::vector<Vec2d>{{-.5, 0}, {.6, .1}, {0, 0}, {0, .06}, {0, -.06}, {0, .12}, {0, -.12}}).ok());
  shot = solve_shot(game, {.object = 1, .pocket = 3});
  ASSERT_TRUE(shot.ok());
  EXPECT_FALSE(shot->has_value());
  for (const ShotGoal& bad : {ShotGoal{.object = 0, .pocket = 1},
                              {.object = 9, .pocket = 1},
                              {.object = 1, .pocket = 6},
                              {.object = 1, .pocket = -1, .place = {9, 9}},
                              {.object = 1, .pocket = 1, .object_cushions = 2}})
    EXPECT_FALSE(solve_shot(game, bad).ok());
  EXPECT_FALSE(solve_shot(game, {.pocket = 1}, {.slowest = 0}).ok());
  EXPECT_FALSE(solve_shot(game, {.pocket = 1}, {.side = 2}).ok());
}

}  // namespace billiards_solver_test
