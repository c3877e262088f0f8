// A break on a nine-foot pool table, and then the easiest next shot: what an hour with carom/sports looks like.
#include <cstdio>

#include "carom/sports/billiards_engine.h"
#include "carom/sports/billiards_rack.h"
#include "carom/sports/billiards_solver.h"

int main() {
  using namespace carom::sports;
  using carom::math::degrees;

  const RectangularTable shape = nine_foot_pool();
  Billiards game = Billiards::create(BilliardTable::create(shape).value(), pool_physics()).value();
  game.place(eight_ball_rack(shape, game.physics().ball.radius, {.gap = 2e-5, .jitter = 1, .seed = 7})).value();

  // Straight at the rack, a little above the middle. Nothing is stepped: the engine goes from event to event.
  const CueImpact hit = game.strike(0, {.direction = 0.01, .speed = 6.5, .height = 0.1}).value();
  game.run().value();
  std::printf("cue ball %.2f m/s; %d events; at rest after %.2f s\n", length(hit.velocity), int(game.event_count()),
              game.rest_time());
  for (const BilliardEvent& event : game.events())
    if (event.kind == BilliardEvent::Kind::pocket)
      std::printf("  ball %d falls into pocket %d after %.2f s\n", event.ball, event.other, event.time);

  // Any moment of the shot, exactly.
  const BilliardState then = game.state(0, 0.5);
  std::printf("half a second after the stroke the cue ball was at (%.3f, %.3f) m with %.2f m/s\n", then.position.x,
              then.position.z, length(then.velocity));

  // Which stroke pots a ball now? Throw and squirt are compensated, because the solver plays the shots.
  for (int ball = 1; ball < game.balls(); ++ball) {
    if (!in_play(game.state(ball).phase) || !in_play(game.state(0).phase)) continue;
    for (int pocket = 0; pocket < 6; ++pocket) {
      const auto shot = solve_shot(game, {.object = ball, .pocket = pocket}).value();
      if (!shot) continue;
      std::printf("ball %d into pocket %d: aim %.2f deg with %.2f m/s; the aim may be off by %.2f deg\n", ball, pocket,
                  degrees(shot->stroke.direction), shot->stroke.speed, degrees(shot->window));
      return 0;
    }
  }
  std::printf("no direct shot is left\n");
  return 0;
}
