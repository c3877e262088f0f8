// A game with its own loop and its own drawing, and the playground's page as a debugger of its world: run it, open the
// address that it prints, pull at the balls, pause it, step it, ask a ball why it moves.
//   example_debugged_game [SECONDS]     (2; 0: until it is ended)
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "apps/debugger/debugger.h"
#include "carom/carom.h"

using namespace carom;

namespace {

/// The game's own drawing: a side view in letters.
void draw(const rigid::World3& world, const std::vector<rigid::BodyId>& balls) {
  std::vector<std::string> rows(8, std::string(48, ' '));
  for (const rigid::BodyId ball : balls) {
    const math::Vec3d p = world.state(ball)->pose.position;
    const int x = int(std::lround(24 + 4 * p.x)), y = 7 - int(p.y);
    if (x >= 0 && x < 48 && y >= 0 && y < 8) rows[std::size_t(y)][std::size_t(x)] = 'o';
  }
  std::printf("t = %.2f s\n", world.time());
  for (const std::string& row : rows) std::printf("|%s|\n", row.c_str());
}

}  // namespace

int main(int count, char** arguments) {
  const double seconds = count > 1 ? std::atof(arguments[1]) : 2;

  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> floor{.type = rigid::BodyType::fixed};
  (void)world.add_shape(*world.create_body(floor), geometry::Plane{});
  std::vector<rigid::BodyId> balls;
  for (int i = 0; i < 8; ++i) {
    balls.push_back(*world.create_body({.position = {0.9 * i - 3.2, 3.0 + 0.5 * i, 0.1 * i}}));
    rigid::ShapeDef<rigid::Dim3> rubber;
    rubber.material.restitution = 0.8f;
    (void)world.add_shape(balls.back(), geometry::Sphere{0.5f}, rubber);
  }

  core::Result<debugger::Debugger> attached = debugger::attach(world, {.title = "Eight balls", .port = 0});
  if (!attached.ok()) {
    std::fprintf(stderr, "%s\n", attached.error().message.c_str());
    return 1;
  }

  const auto started = std::chrono::steady_clock::now();
  for (int turn = 0;; ++turn) {
    const std::chrono::duration<double> played = std::chrono::steady_clock::now() - started;
    if (seconds > 0 && played.count() > seconds) break;
    if (attached->update()) (void)world.step(1.0f / 60);
    if (turn % 30 == 0) draw(world, balls);
    std::this_thread::sleep_for(std::chrono::milliseconds(16));
  }
}
