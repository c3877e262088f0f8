// Shots on a pool table from the stroke to the last ball at rest, and the solver of shots.
#include <benchmark/benchmark.h>

#include "carom/sports/billiards_rack.h"
#include "carom/sports/billiards_solver.h"

namespace {

using namespace carom::sports;
using carom::math::Vec2d;

/// 0: a frozen rack, 1: gaps of .05 mm, 2: a frozen rack without the record.
void break_of_fifteen(benchmark::State& state) {
  const RectangularTable shape = nine_foot_pool();
  Billiards game =
      Billiards::create(BilliardTable::create(shape).value(), pool_physics(), {.record = state.range(0) != 2}).value();
  std::vector<Vec2d> balls =
      eight_ball_rack(shape, game.physics().ball.radius, {.gap = state.range(0) == 1 ? 5e-5 : 0, .jitter = 1});
  balls[0].y = 0.05;
  const Stroke stroke{.direction = aim_direction(balls[1] - balls[0]), .speed = 6};
  for (auto _ : state) {
    game.place(balls).value();
    game.strike(0, stroke).value();
    game.run().value();
  }
  state.counters["events"] = double(game.event_count());
  state.counters["breaks/s"] = benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(break_of_fifteen)->DenseRange(0, 2)->Unit(benchmark::kMicrosecond);

void solve_a_pot(benchmark::State& state) {
  Billiards game = Billiards::create(BilliardTable::create(nine_foot_pool()).value()).value();
  game.place(std::vector<Vec2d>{{-.2, .1}, {.5, .2}, {0, -.4}, {.9, -.3}}).value();
  for (auto _ : state) benchmark::DoNotOptimize(solve_shot(game, {.object = 1, .pocket = 3}));
}
BENCHMARK(solve_a_pot)->Unit(benchmark::kMicrosecond);

}  // namespace
