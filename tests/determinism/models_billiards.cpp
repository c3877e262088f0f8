#include "carom/sports/billiards_engine.h"
#include "carom/sports/billiards_rack.h"
#include "carom/sports/billiards_solver.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

void billiards_models(int) {
  using math::Vec2d;
  using math::Vec3d;
  core::StateHash hash;
  const auto hash_vector = [&](Vec3d v) { hash.add(v.x).add(v.y).add(v.z); };
  const auto hash_game = [&](const sports::Billiards& game) {
    for (const sports::BilliardEvent& e : game.events()) hash.add(e.time).add(e.speed);
    for (int i = 0; i < game.balls(); ++i) {
      const sports::BilliardState s = game.state(i);
      hash_vector(s.position), hash_vector(s.velocity), hash_vector(s.angular_velocity);
    }
  };
  // Breaks with every model of the cushion, a jump and a massé, on three tables.
  for (const sports::CushionModel model :
       {sports::CushionModel::stronge, sports::CushionModel::mathavan, sports::CushionModel::han})
    for (const sports::RectangularTable& shape : {sports::nine_foot_pool(), sports::seven_foot_pool()}) {
      sports::BilliardPhysics physics = sports::pool_physics();
      physics.cushion.model = model;
      if (model == sports::CushionModel::mathavan) physics.balls.model = sports::BallContact::Model::mathavan;
      auto game = sports::Billiards::create(*sports::BilliardTable::create(shape), physics);
      auto balls = sports::eight_ball_rack(shape, physics.ball.radius, {1e-4, 1, 3});
      balls[0].y = 0.07;
      game->place(balls).value();
      game->strike(0, {sports::aim_direction(balls[1] - balls[0]), 6.5, 0.1, 0.2}).value();
      game->run().value();
      hash_game(*game);
    }
  auto carom =
      sports::Billiards::create(*sports::BilliardTable::create(sports::carom_table()), sports::carom_physics());
  for (const bool hold : {false, true}) {
    carom->place(sports::carom_opening(sports::carom_table(), carom->physics().ball.radius)).value();
    carom->strike(0, {0.3, 3, 0.3, -0.2, 0.9, hold}).value();
    carom->run().value();
    hash_game(*carom);
  }
  print_model("billiards", hash);

  hash = {};
  auto pool = sports::Billiards::create(*sports::BilliardTable::create(sports::nine_foot_pool()));
  pool->place(std::vector<Vec2d>{{-.2, .1}, {.5, .2}, {.1, -.3}}).value();
  for (const int cushions : {0, 1})
    if (const auto shot =
            sports::solve_shot(*pool, {.object = 1, .pocket = 3, .object_cushions = cushions}, {.side = .2});
        shot && *shot)
      hash.add((*shot)->stroke.direction).add((*shot)->stroke.speed).add((*shot)->miss);
  print_model("billiards_solver", hash);
}

}  // namespace carom::determinism
