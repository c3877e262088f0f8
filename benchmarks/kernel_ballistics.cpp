// What ballistics cost: a step of 100 000 projectiles, their hits in a world of 10 000 shapes, and taking aim.
#include <benchmark/benchmark.h>

#include "carom/ballistics/aim.h"
#include "carom/ballistics/hits.h"
#include "carom/ballistics/rocket.h"
#include "carom/ballistics/shell.h"
#include "carom/ballistics/sights.h"
#include "carom/math/random.h"

namespace {

using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;
using rigid::Dim3;

const Conditions windy{.wind = environment::WindColumn(
                           environment::Wind{.velocity = {6, 0, 3}, .profile = environment::WindProfile::power})};

/// Guns on a ring of 600 m fire over a town; those that are gone are fired anew.
void fire(ProjectileBatch& batch, math::Random& random, double lead) {
  const double around = random.uniform(-math::pi, math::pi);
  const Vec3d from{600 * math::cos(around), 2, 600 * math::sin(around)};
  const Vec3d to{random.uniform(-400.0, 400.0), random.uniform(10.0, 250.0), random.uniform(-400.0, 400.0)};
  const double speed = random.uniform(300.0, 850.0);
  batch.add({from + lead * (to - from), speed * math::normalize(to - from)},
            BatchRound{.area_per_mass = 5e-3, .mass = .01, .frontal_area = 4.8e-5});
}

void batch_step(benchmark::State& state) {
  ProjectileBatch batch(DragCurve(DragFunction::g7), windy, {}, int(state.range(0)));
  math::Random random(1);
  for (int i = 0; i < 100'000; ++i) fire(batch, random, random.uniform());
  for (auto _ : state) batch.step(1.0 / 600);
  state.SetItemsProcessed(state.iterations() * 100'000);
}
BENCHMARK(batch_step)->Arg(4)->Arg(8)->Arg(16)->Unit(benchmark::kMillisecond);

/// A town of 10 000 houses on a plain of ground, 100 000 bullets over and in it. `sorted`: with `sort` every 16 steps.
/// So many more, with blades that turn, fly through it.
void batch_hits(benchmark::State& state) {
  rigid::World3 world;
  math::Random random(2);
  const auto place = [&](const geometry::Shape3& shape, Vec3d position) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.position = position;
    (void)*world.add_shape(*world.create_body(body), shape);
  };
  place(geometry::Box{{700, 1, 700}}, {0, -1, 0});
  for (int i = 0; i < 9'999; ++i) {
    const float height = float(random.uniform(2.0, 12.0));
    place(geometry::Box{{float(random.uniform(1.0, 3.0)), height, float(random.uniform(1.0, 3.0))}},
          {random.uniform(-450.0, 450.0), height, random.uniform(-450.0, 450.0)});
  }
  for (int i = 0; i < state.range(2); ++i) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::kinematic;
    body.position = {random.uniform(-450.0, 450.0), random.uniform(5.0, 200.0), random.uniform(-450.0, 450.0)};
    body.linear_velocity = {float(random.uniform(-60.0, 60.0)), 0, float(random.uniform(-60.0, 60.0))};
    body.angular_velocity = {0, i % 2 == 0 ? 20.0f : 0.0f, 0};
    (void)*world.add_shape(*world.create_body(body), geometry::Box{{2, .1f, .3f}});
  }
  if (!world.step(1.0f / 60).ok()) return state.SkipWithError("the world");
  ProjectileBatch batch(DragCurve(DragFunction::g7), windy, {}, int(state.range(0)));
  for (int i = 0; i < 100'000; ++i) fire(batch, random, random.uniform());
  BatchHits<Dim3> hits;
  const double dt = 1.0 / 60;
  std::size_t met = 0, asked = 0;
  int steps = 0;
  for (auto _ : state) {
    if (steps++ % 16 == 0 && state.range(1) != 0) batch.sort();
    batch.step(dt);
    if (!hits.collect(batch, world, dt).ok()) return state.SkipWithError("the hits");
    met += hits.hits().size();
    asked += hits.rays();
    state.PauseTiming();
    while (batch.size() < 100'000) fire(batch, random, 0);
    for (std::size_t i = 0; i < batch.size(); ++i)  // far away: again
      if (const Vec3d p = batch.at(i).position; p.y > 400 || math::hypot(p.x, p.z) > 900) batch.remove(i--);
    while (batch.size() < 100'000) fire(batch, random, 0);
    if (state.range(2) > 0 && !world.step(float(dt)).ok()) return state.SkipWithError("the world");
    state.ResumeTiming();
  }
  state.counters["hits"] = double(met) / double(state.iterations());
  state.counters["rays"] = double(asked) / double(state.iterations());
}
BENCHMARK(batch_hits)
    ->Args({8, 0, 0})
    ->Args({8, 1, 0})
    ->Args({16, 1, 0})
    ->Args({8, 1, 1000})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(96);

/// The 168 SMK (G7 .218, 2650 ft/s, zero at 100 yd) to 1000 yd, as shooters' solvers fly it.
void rifle_flight(benchmark::State& state) {
  constexpr double foot = 0.3048, yard = 0.9144, inch = 0.0254;
  const Gun gun{.projectile = projectile_from_coefficient(DragFunction::g7, .218),
                .muzzle_speed = 2650 * foot,
                .sight_height = 1.5 * inch};
  const Conditions still{};
  const double elevation = *zero_elevation(gun, still, 100 * yard);
  double speed = 0, height = 0;
  for (auto _ : state) {
    const auto flight = SightedFlight::fire(gun, still, {.elevation = elevation}, 1000 * yard);
    const auto end = flight->at(1000 * yard);
    speed = end->speed / foot, height = end->height / inch;
  }
  state.SetLabel(std::to_string(speed) + " ft/s, " + std::to_string(height) + " in");
}
BENCHMARK(rifle_flight)->Unit(benchmark::kMicrosecond);

/// The M107 at 684 m/s and 45°, 17.8 km and 85 s: the modified point mass (0), six degrees of freedom (1).
void shell_flight(benchmark::State& state) {
  const Shell shell = m107();
  const auto model = state.range(0) == 0 ? ShellModel::modified_point_mass : ShellModel::six_degrees;
  const FlightPoint muzzle{{}, 684 * math::normalize(Vec3d{1, 1, 0})};
  double range = 0;
  for (auto _ : state) {
    const auto flight = fly_shell(shell, {}, muzzle, model, {.time = 200, .ground = 0});
    if (!flight.ok()) return state.SkipWithError("the shell");
    range = flight->path.end().position.x;
  }
  state.SetLabel(std::to_string(range) + " m");
}
BENCHMARK(shell_flight)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

/// A model rocket of two stages from the rail to the ground under its parachute: the axis in the wind (0), fins that
/// swing it (1).
void rocket_flight(benchmark::State& state) {
  const char* file = "C6 18 70 0 0.0108 0.0226 E\n 0.03 1\n 0.14 10\n 0.19 14\n 0.25 6\n 0.5 4.4\n 1.8 4.4\n 1.86 0\n";
  const auto motors = read_rasp(file, "C6");
  if (!motors.ok()) return state.SkipWithError("the motor");
  Rocket rocket;
  rocket.stages = {
      {.motor = (*motors)[0], .dry_mass = .025, .dry_centre = .72, .motor_centre = .74, .separation_delay = .1},
      {.motor = (*motors)[0], .dry_mass = .05, .dry_centre = .34, .motor_centre = .6}};
  rocket.diameter = .025;
  rocket.parachute = {.drag_area = .1};
  const auto model = state.range(0) == 0 ? RocketModel::point_mass : RocketModel::six_degrees;
  double apex = 0;
  for (auto _ : state) {
    const auto flight = fly_rocket(rocket, windy, {.rail_length = 1}, model);
    if (!flight.ok()) return state.SkipWithError(flight.error().message.c_str());
    const RocketMoment* top = flight->first(RocketEvent::apex);
    apex = top != nullptr ? top->position.y : 0;
  }
  state.SetLabel(std::to_string(apex) + " m");
}
BENCHMARK(rocket_flight)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

enum AimCase { low_arc, both_arcs, out_of_reach, moving, mortar, again, just_out, flees, flees_fast, edge };
void take_aim(benchmark::State& state) {
  const AimCase which = AimCase(state.range(0));
  Projectile shot = projectile_from_coefficient(DragFunction::g7, .3);
  Shooter shooter{.muzzle_speed = 400, .muzzle = {0, 2, 0}, .velocity = {5, 0, 3}};
  Target target{{900, 30, 200}, {0, 0, 0}};
  AimOptions options;
  options.high_arc = which != low_arc;
  if (which == out_of_reach) target.position = {5500, 200, 0};
  if (which == moving) target.velocity = {-20, 2, 30};
  if (which == just_out) target.position = {4800, 30, 200};
  if (which == edge) target.position = {4150, 100, 0};  // its two arcs are seconds apart
  if (which == flees) target = {{1900, 30, 200}, {150, 0, 20}};
  if (which == flees_fast) target = {{900, 200, 200}, {300, 10, 100}};
  if (which == mortar) {
    shot = projectile_from_size(DragCurve(.14), 13.585, .11956);
    shooter.muzzle_speed = 250;
    target.position = {3500, 50, 300};
  }
  static const char* names[] = {"low arc",           "both arcs",          "out of reach",
                                "moving, both",      "mortar, both",       "again, low",
                                "just out of reach", "flees beyond reach", "flees faster than the shot",
                                "edge of reach"};
  if (which == again) {  // a frame later
    const Shot last = *aim(shot, windy, shooter, target, options)->low;
    target.position += Vec3d{0.5, 0, 0.3};
    for (auto _ : state) benchmark::DoNotOptimize(aim_again(shot, windy, shooter, target, last, options));
    return state.SetLabel(names[which]);
  }
  for (auto _ : state) benchmark::DoNotOptimize(aim(shot, windy, shooter, target, options));
  state.SetLabel(names[which]);
}
BENCHMARK(take_aim)->DenseRange(low_arc, edge)->Unit(benchmark::kMicrosecond);

/// Both arcs of the ammunition of presets/ammunition, at a target 20 m up at about half of its reach, in the wind.
void take_aim_of_a_preset(benchmark::State& state) {
  struct Round {
    const char* name;
    Projectile projectile;
    double speed, range;  // m/s, m
  };
  const Round rounds[] = {
      {"12-pounder shot", projectile_from_size(DragCurve(DragFunction::gs), 5.579, .1148), 438.9, 900},
      {".22 long rifle", projectile_from_coefficient(DragFunction::ra4, .13), 329.2, 700},
      {".308 168 gr", projectile_from_coefficient(DragFunction::g7, .218), 807.7, 1800},
      {"5.56 M855", projectile_from_coefficient(DragFunction::g7, .151), 944.9, 1500},
      {"9 mm 115 gr", projectile_from_coefficient(DragFunction::g1, .145), 359.7, 800},
  };
  const Round& round = rounds[state.range(0)];
  const Shooter shooter{.muzzle_speed = round.speed, .muzzle = {0, 1.5, 0}};
  const Target target{{round.range, 20, 100}, {-2, 0, 4}};
  for (auto _ : state) benchmark::DoNotOptimize(aim(round.projectile, windy, shooter, target));
  state.SetLabel(round.name);
}
BENCHMARK(take_aim_of_a_preset)->DenseRange(0, 4)->Unit(benchmark::kMicrosecond);

/// The table of a weapon: made once, then asked.
void aim_table(benchmark::State& state) {
  const auto table = AimTable::make(projectile_from_coefficient(DragFunction::g7, .3), {},
                                    {.muzzle_speed = 400, .longest_range = 3000});
  if (!table.ok()) return state.SkipWithError("the table");
  double range = 100;
  for (auto _ : state) {
    benchmark::DoNotOptimize(table->at(range, 20));
    range = range > 2000 ? 100 : range + 7;
  }
}
BENCHMARK(aim_table);

}  // namespace
