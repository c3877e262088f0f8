// What the billiards tests share.
#pragma once

#include <gtest/gtest.h>

#include "carom/math/random.h"
#include "carom/sports/billiards_engine.h"
#include "carom/sports/billiards_rack.h"

namespace billiards_test {
using namespace carom;
using namespace carom::sports;
using math::Vec2d;
using math::Vec3d;

inline Billiards make_game(const RectangularTable& shape, const BilliardPhysics& physics,
                           const BilliardOptions& options = {}) {
  auto table = BilliardTable::create(shape);
  EXPECT_TRUE(table.ok()) << table.error().message;
  auto game = Billiards::create(*table, physics, options);
  EXPECT_TRUE(game.ok()) << game.error().message;
  return std::move(*game);
}

/// A square bed of cushions without pockets, `half` m from the middle to a nose, turned by an angle.
inline BilliardTable plain_table(double half, double radius, double turn = 0) {
  TableDef def;
  const math::SinCos<double> s = math::sincos(turn);
  for (const Vec2d p : {Vec2d{-half, -half}, Vec2d{half, -half}, Vec2d{half, half}, Vec2d{-half, half}})
    def.outline.push_back({{s.cos * p.x - s.sin * p.y, s.sin * p.x + s.cos * p.y}});
  def.nose_height = 1.28 * radius;
  auto table = BilliardTable::create(def);
  EXPECT_TRUE(table.ok()) << table.error().message;
  return *table;
}

inline Billiards on_plain(const std::vector<Vec2d>& balls, const BilliardPhysics& physics = {}, double half = 40) {
  auto game = Billiards::create(plain_table(half, physics.ball.radius), physics);
  EXPECT_TRUE(game.ok()) << game.error().message;
  EXPECT_TRUE(game->place(balls).ok());
  return std::move(*game);
}

/// A rack of eight-ball on the nine-foot table and its cue ball.
inline std::vector<Vec2d> break_set(double gap = 0, std::uint64_t seed = 1) {
  std::vector<Vec2d> balls = eight_ball_rack(nine_foot_pool(), BilliardBall{}.radius, {gap, 1, seed});
  return balls;
}

/// Random places on the table, not touching.
inline std::vector<Vec2d> scatter(math::Random& random, const BilliardTable& table, Vec2d half, int count,
                                  double radius) {
  std::vector<Vec2d> balls;
  while (int(balls.size()) < count) {
    const Vec2d p{random.uniform(-half.x, half.x), random.uniform(-half.y, half.y)};
    bool free = table.inside(p) && table.pocket_at(p) < 0 && table.clearance(p) > radius * 1.01;
    for (const Vec2d q : balls) free = free && distance(p, q) > 2.001 * radius;
    if (free) balls.push_back(p);
  }
  return balls;
}

}  // namespace billiards_test
