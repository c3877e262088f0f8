// What the demos of both characters share: how one steers them, and what they tell.
#pragma once

#include "apps/host/demos/demos.h"
#include "carom/rigid/dynamic_character.h"

namespace carom::host::demo {

inline std::vector<Input> walking_inputs() {
  return {{"right", "Right", {"ArrowRight", "KeyD"}, false, 1},
          {"left", "Left", {"ArrowLeft", "KeyA"}, false, 1},
          {"away", "Away", {"ArrowUp", "KeyW"}, false, 1},
          {"near", "Near", {"ArrowDown", "KeyS"}, false, 1},
          {"jump", "Jump", {"Space"}, true, 1}};
}

/// The wanted velocity: along x until a key is pressed for the first time, then as the keys say.
inline Vec3f wanted_walk(Stage3& stage, bool& driven) {
  const double x = stage.input("right") - stage.input("left"), z = stage.input("near") - stage.input("away");
  const bool jump = stage.presses("jump") > 0;
  driven = driven || x != 0 || z != 0 || jump;
  const Vec3d way = driven ? Vec3d{x, 0, z} : Vec3d{1, 0, 0};
  Vec3f velocity(way * (stage.value("speed") / max(1.0, length(way))));
  if (jump) velocity.y = stage.valuef("jump");
  return velocity;
}

/// Shows both, and follows the first.
inline void show_walkers(Stage3& stage, rigid::BodyId first, rigid::BodyId second) {
  stage.adopt_all();
  stage.set_color(first, orange);
  stage.set_color(second, violet);
  for (const auto& actor : stage.actors())
    if (actor.body == first) stage.follow(int(actor.id));
}

inline void say_ground(Stage3& stage, rigid::GroundState state) {
  constexpr const char* states[] = {"on the ground", "on a slope too steep", "in the air"};
  stage.say(states[int(state)]);
}

}  // namespace carom::host::demo
