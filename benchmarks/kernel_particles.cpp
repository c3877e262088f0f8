// Cost of a particle's step on one core: 10⁶ particles over the ground (issue: 60 Hz, 16.6 ms), by what acts on them.
#include <benchmark/benchmark.h>

#include "carom/particles/system.h"

namespace {
using namespace carom;
using namespace carom::particles;

enum class Weather { steady, turbulent, environment };

ParticleSystem rain(int count, DragLaw law, Weather weather, int lanes) {
  SystemDef d;
  d.capacity = count;
  d.lanes = lanes;
  d.drag.law = law;
  d.radius = 1e-3f;
  d.mass = 4.19e-6f;
  ParticleSystem system = ParticleSystem::create(d).value();
  Air air;
  air.wind.velocity = {8, 0, 0};
  if (weather == Weather::turbulent) {
    air.wind.profile = environment::WindProfile::logarithmic;
    air.turbulence = {.speed = 2, .length = 10, .waves = 12};
  }
  if (weather == Weather::environment) {  // gusts and eddies of von Kármán's spectrum, asked of the one environment
    air.field = environment::WindField{.mean = {.velocity = {8, 0, 0}, .profile = environment::WindProfile::power}};
    air.field->gusts = {{.velocity = {5, 0, 0}, .front = -100, .speed = 10}};
    air.field->turbulence = environment::Turbulence::make({.mean_wind = {8, 0, 0}}).value();
  }
  (void)system.set_air(air);
  Collider ground;
  ground.shape = geometry::Plane{};
  (void)system.set_colliders({&ground, 1});
  math::Random random(1);
  for (int i = 0; i < count; ++i)
    (void)system.add({.position = {random.uniform(-50.0, 50.0), random.uniform(0.0, 50.0), random.uniform(-50.0, 50.0)},
                      .lifetime = 1000});
  return system;
}

void run(benchmark::State& state, DragLaw law, Weather weather, int lanes) {
  const int count = int(state.range(0));
  ParticleSystem system = rain(count, law, weather, lanes);
  for (auto _ : state) (void)system.step(1.0 / 60);
  state.SetItemsProcessed(state.iterations() * count);
}

void particles_linear(benchmark::State& state) { run(state, DragLaw::stokes, Weather::steady, 0); }
void particles_quadratic(benchmark::State& state) { run(state, DragLaw::quadratic, Weather::steady, 0); }
void particles_quadratic_4(benchmark::State& state) { run(state, DragLaw::quadratic, Weather::steady, 4); }
void particles_quadratic_8(benchmark::State& state) { run(state, DragLaw::quadratic, Weather::steady, 8); }
void particles_schiller_naumann(benchmark::State& state) { run(state, DragLaw::schiller_naumann, Weather::steady, 0); }
void particles_turbulent(benchmark::State& state) { run(state, DragLaw::quadratic, Weather::turbulent, 0); }
void particles_environment(benchmark::State& state) { run(state, DragLaw::quadratic, Weather::environment, 0); }
BENCHMARK(particles_linear)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(particles_quadratic)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(particles_quadratic_4)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(particles_quadratic_8)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(particles_schiller_naumann)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(particles_turbulent)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(particles_environment)->Arg(10'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

}  // namespace
