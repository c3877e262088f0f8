// Rain on a table that feels it: particles with drag and wind, bodies that get every drop's momentum, drops that
// splash.
#include <cstdio>

#include "carom/particles/coupling.h"

using namespace carom;

int main() {
  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> ground;
  ground.type = rigid::BodyType::fixed;
  world.add_shape(world.create_body(ground).value(), geometry::Plane{}).value();
  rigid::BodyDef<rigid::Dim3> table;
  table.position = {0, 1, 0};
  table.locks = {.x = true, .z = true, .rotation_x = true, .rotation_y = true, .rotation_z = true};
  const rigid::BodyId top = world.create_body(table).value();
  world.add_shape(top, geometry::Box{{1, 0.02f, 1}}, {.density = 100}).value();

  // Drops of 4 mm that end where they strike.
  particles::SystemDef def;
  def.capacity = 40'000;
  def.radius = 0.002f;
  def.mass = 3.35e-5f;
  def.drag = {.law = particles::DragLaw::schiller_naumann};
  def.report_hits = true;
  auto rain = particles::ParticleSystem::create(def).value();
  (void)rain.set_air({.wind = {.velocity = {2, 0, 0}}, .turbulence = {.speed = 1}});
  (void)rain.add_emitter({.form = particles::EmitterForm::box,
                          .size = {3, 0, 3},
                          .position = {0, 8, 0},
                          .rate = 20'000,
                          .direction = {0, -1, 0},
                          .speed = {8, 8},
                          .lifetime = {3, 3}});

  // Each bears three small ones.
  def.radius = 0.0006f;
  def.mass = 9e-7f;
  def.report_hits = false;
  auto splashes = particles::ParticleSystem::create(def).value();
  particles::SubEmission splash{.count = 3};
  splash.emitter.spread = 1;
  splash.emitter.speed = {0.5f, 2};
  splash.emitter.lifetime = {0.2f, 0.4f};

  particles::Coupling3 coupling({.answer = particles::CollisionAnswer::kill, .two_way = true});
  const float dt = 1.0f / 60;
  double pushed = 0;
  for (int i = 0; i < 180; ++i) {
    // The table is held up by a spring, and sinks under the rain.
    const auto state = world.state(top).value();
    (void)world.add_force(
        top, {0, float(state.mass * 9.80665 + 200 * (1 - state.pose.position.y)) - 30 * state.linear_velocity.y, 0});
    (void)world.step(dt);
    (void)coupling.step(world, rain, double(dt));
    (void)splashes.step(double(dt));
    (void)splashes.emit_at(rain.hits(), splash);
    for (std::size_t k = 0; k < rain.exchanges().size(); ++k)
      if (coupling.body_of(int(k)) == top && i >= 120) pushed -= rain.exchanges()[k].impulse.y;
  }
  const auto state = world.state(top).value();
  std::printf("%d drops in the air, %d splashes; the rain presses with %.2f N and the table stands %.1f mm lower\n",
              rain.size(), splashes.size(), pushed / 1.0, 1e3 * (1 - state.pose.position.y));
  return pushed > 0 ? 0 : 1;
}
