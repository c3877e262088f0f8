#include "carom/sports/baseball.h"
#include "carom/sports/bowling.h"
#include "carom/sports/golf.h"
#include "carom/sports/presets.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

void sports_models() {
  using math::Vec3d;
  core::StateHash hash;
  const auto add = [&](Vec3d v) { hash.add(v.x).add(v.y).add(v.z); };
  sports::Conditions windy;
  windy.wind = environment::WindColumn(
      environment::Wind{.velocity = {4, 0, 6}, .profile = environment::WindProfile::logarithmic});
  for (const sports::BallPreset& preset : sports::ball_presets()) {
    const auto flight = sports::fly(
        preset.ball, windy,
        sports::launch_state({.speed = 45, .elevation = 0.4, .spin = 220, .tilt = 0.6, .gyro = 30}, {0, 1, 0}));
    for (const sports::BallFlight::Node& node : flight->nodes()) {
      add(node.state.position);
      add(node.state.velocity);
      add(node.state.spin);
    }
  }
  print_model("ball_flights", hash);

  hash = {};
  for (const sports::ClubPreset& club : sports::club_presets()) {
    auto shot = sports::tour_shot(club.name);
    shot->face = 0.02;
    shot->toe = 0.006;
    shot->conditions = windy;
    const auto result = sports::play_golf(*shot, *sports::surface_preset("fairway"));
    add(result->impact.ball.spin);
    add(result->shot.rest().position);
    hash.add(result->swing.time).add(result->shot.duration());
  }
  const auto three = sports::swing(sports::three_link_swing());
  hash.add(three->speed).add(three->bend).add(three->attack);
  print_model("golf_shots", hash);

  hash = {};
  const auto sheet =
      sports::trajectory_calculator({.launch_angle = 31, .spray_angle = 12}, sports::CalculatorMode::sheet);
  const auto path = sports::bowl({}, {}, {.spin = 28, .axis_rotation = 0.9, .start = -0.3});
  hash.add(sheet->distance).add(path->end().y).add(path->entry_angle());
  const auto pitch = sports::pitch(*sports::ball_preset("knuckleball"), windy, {.spin = 6, .tilt = 1});
  const auto hit = sports::hit(*sports::ball_preset("baseball"), {}, {}, pitch->path.end());
  add(hit->velocity);
  add(hit->spin);
  print_model("baseball_and_bowling", hash);
}

}  // namespace carom::determinism
