// What liquids and grains cost: a step of 1/60 s, all substeps, while a column collapses and once it is calm.
#include <benchmark/benchmark.h>

#include "carom/math/elementary.h"
#include "carom/particles/fluid.h"
#include "carom/particles/granular.h"

namespace {

using namespace carom;
using namespace carom::particles;

/// From the state.range(1)-th step on; after every `again` of them it starts there anew.
template <class Matter>
void time_steps(benchmark::State& state, Matter& matter, int again) {
  for (int i = 0; i < int(state.range(1)); ++i) matter.step(1.0f / 60).value();
  const Matter start = matter;
  int steps = 0;
  for (auto _ : state) {
    if (++steps % again == 0) {
      state.PauseTiming();
      matter = start;
      state.ResumeTiming();
    }
    matter.step(1.0f / 60).value();
  }
}

/// A third of a tank of 2 m × 1 m (× 1 m), full of about `range` particles, after `range(1)` steps.
template <class D>
void fluid_step(benchmark::State& state) {
  const double count = double(state.range(0));
  typename D::Position tank = FluidDef<D>::unit_position(), column = tank;
  tank[0] = 2;
  column[0] = 0.7;
  column[1] = 0.71;
  const float spacing = D::dimension == 2 ? math::sqrt(float(0.497 / count)) : float(math::pow(0.497 / count, 1.0 / 3));
  auto fluid = Fluid<D>::create({.upper = tank, .spacing = spacing, .max_particles = 1 << 18}).value();
  fluid.add_box({}, column).value();
  time_steps(state, fluid, 30);
  state.counters["particles"] = fluid.size();
  state.counters["iterations"] = fluid.statistics().iterations;
}

template <class D>
void grain_step(benchmark::State& state) {
  typename D::Position column = GranularDef<D>::unit_position();
  column[0] = 0.5;
  const float radius = D::dimension == 2 ? 0.5f * math::sqrt(float(0.5 / double(state.range(0))))
                                         : 0.5f * float(math::pow(0.5 / double(state.range(0)), 1.0 / 3));
  auto grains = Granular<D>::create({.radius = radius, .max_grains = 1 << 17, .threads = int(state.range(2))}).value();
  grains.add_box({}, column).value();
  time_steps(state, grains, 20);
  state.counters["grains"] = grains.size();
  state.counters["contacts"] = grains.statistics().contacts;
}

BENCHMARK(fluid_step<rigid::Dim2>)
    ->Args({10'000, 10})
    ->Args({30'000, 10})
    ->Args({30'000, 400})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(fluid_step<rigid::Dim3>)
    ->Args({10'000, 10})
    ->Args({30'000, 10})
    ->Args({100'000, 10})
    ->Unit(benchmark::kMillisecond);
// Half a box of grains, after `range(1)` steps: 10, it falls; 150, it is at rest; on `range(2)` threads.
BENCHMARK(grain_step<rigid::Dim2>)
    ->Args({10'000, 10, 1})
    ->Args({10'000, 150, 1})
    ->Args({20'000, 10, 1})
    ->Args({20'000, 10, 2})
    ->Args({20'000, 150, 1})
    ->Args({20'000, 150, 2})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(grain_step<rigid::Dim3>)
    ->Args({10'000, 10, 1})
    ->Args({10'000, 150, 1})
    ->Args({20'000, 10, 1})
    ->Args({20'000, 10, 2})
    ->Args({20'000, 150, 1})
    ->Args({20'000, 150, 2})
    ->Args({100'000, 100, 1})
    ->Args({100'000, 100, 2})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
