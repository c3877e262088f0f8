// What one step of each integrator costs on an orbit in space (six numbers, one square root a derivative).
#include <benchmark/benchmark.h>

#include "carom/ode/methods.h"

namespace {

using carom::math::Vec3d;
using Orbit = carom::ode::Motion<Vec3d>;

Orbit derivative(double, const Orbit& y) {
  const double r2 = dot(y.position, y.position);
  return {y.velocity, y.position * (-1.0 / (r2 * carom::math::sqrt(r2)))};
}

void step_of(benchmark::State& state) {
  const auto method = static_cast<carom::ode::Method>(state.range(0));
  Orbit y{{1, 0, 0}, {0, 1, 0}};
  double t = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(carom::ode::step(method, derivative, t, y, 1e-3));
    t += 1e-3;
  }
  state.SetLabel(std::string(carom::ode::to_string(method)));
}
BENCHMARK(step_of)->DenseRange(0, 7);

}  // namespace
