// The flight of a ball from the tee to the ground: one golf drive, and ten thousand that all differ.
#include <benchmark/benchmark.h>

#include "carom/math/random.h"
#include "carom/sports/flight.h"
#include "carom/sports/presets.h"

namespace {

using namespace carom;
using namespace carom::sports;

constexpr double mph = 0.44704, rpm = 2 * math::pi / 60, degree = math::pi / 180;

/// The tour's driver, 167 mph at 10.9° with 2686 rpm; more than one: by as much as its shots differ.
void golf_drives(benchmark::State& state) {
  const Ball golf = *ball_preset("golf");
  math::Random random(1);
  std::vector<BallState> starts;
  for (int i = 0; i < state.range(0); ++i) {
    const double off = i > 0 ? 1 : 0;
    starts.push_back(launch_state({.speed = (167 + off * random.uniform(-8.0, 8.0)) * mph,
                                   .elevation = (10.9 + off * random.uniform(-3.0, 3.0)) * degree,
                                   .azimuth = off * random.uniform(-2.0, 2.0) * degree,
                                   .spin = (2686 + off * random.uniform(-600.0, 600.0)) * rpm,
                                   .tilt = off * random.uniform(-8.0, 8.0) * degree}));
  }
  double carry = 0;
  for (auto _ : state)
    for (const BallState& start : starts) carry = landing(*fly(golf, {}, start)).carry;
  benchmark::DoNotOptimize(carry);
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(golf_drives)->Arg(1)->Arg(10'000)->Unit(benchmark::kMicrosecond);

}  // namespace
