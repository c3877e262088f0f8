// Elementary functions beside the C library's, rotations, and the record transpose of the SIMD layer.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "carom/math/random.h"
#include "carom/math/rotation.h"
#include "carom/math/simd.h"

namespace carom::benchmarks {
namespace {

constexpr std::size_t math_samples = 1024;

std::vector<double> math_arguments(double low, double high) {
  math::Random random(1);
  std::vector<double> v(math_samples);
  for (double& x : v) x = random.uniform(low, high);
  return v;
}

void elementary(benchmark::State& state, double (*function)(double), double low, double high) {
  const std::vector<double> x = math_arguments(low, high);
  for (auto _ : state) {
    double sum = 0;
    for (const double v : x) sum += function(v);
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(math_samples));
}

double ours_sin(double x) { return math::sin(x); }
double ours_exp(double x) { return math::exp(x); }
double ours_log(double x) { return math::log(x); }
double ours_atan(double x) { return math::atan(x); }
double ours_pow(double x) { return math::pow(x, 1.37); }
double libm_sin(double x) { return std::sin(x); }
double libm_exp(double x) { return std::exp(x); }
double libm_log(double x) { return std::log(x); }
double libm_atan(double x) { return std::atan(x); }
double libm_pow(double x) { return std::pow(x, 1.37); }

BENCHMARK_CAPTURE(elementary, sin_carom, ours_sin, -10.0, 10.0);
BENCHMARK_CAPTURE(elementary, sin_libm, libm_sin, -10.0, 10.0);
BENCHMARK_CAPTURE(elementary, exp_carom, ours_exp, -10.0, 10.0);
BENCHMARK_CAPTURE(elementary, exp_libm, libm_exp, -10.0, 10.0);
BENCHMARK_CAPTURE(elementary, log_carom, ours_log, 0.1, 10.0);
BENCHMARK_CAPTURE(elementary, log_libm, libm_log, 0.1, 10.0);
BENCHMARK_CAPTURE(elementary, atan_carom, ours_atan, -3.0, 3.0);
BENCHMARK_CAPTURE(elementary, atan_libm, libm_atan, -3.0, 3.0);
BENCHMARK_CAPTURE(elementary, pow_carom, ours_pow, 0.1, 10.0);
BENCHMARK_CAPTURE(elementary, pow_libm, libm_pow, 0.1, 10.0);

void quaternion_rotate(benchmark::State& state) {
  math::Random random(2);
  std::vector<math::Quatf> q(math_samples);
  std::vector<math::Vec3f> v(math_samples);
  for (std::size_t i = 0; i < math_samples; ++i) {
    q[i] = math::Quatf(random.rotation());
    v[i] = math::Vec3f(random.on_sphere());
  }
  for (auto _ : state) {
    for (std::size_t i = 0; i < math_samples; ++i) v[i] = math::rotate(q[i], v[i]);
    benchmark::DoNotOptimize(v.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(math_samples));
}
BENCHMARK(quaternion_rotate);

void quaternion_integrate_exact(benchmark::State& state) {
  math::Quatf q;
  const math::Vec3f w{0.3f, -1.0f, 2.0f};
  for (auto _ : state) {
    q = math::integrate_exact(q, w, 1e-2f);
    benchmark::DoNotOptimize(q);
  }
}
BENCHMARK(quaternion_integrate_exact);

/// Records of 16 floats to columns and back, as the contact solver does with bodies.
template <int W>
void gather_and_scatter(benchmark::State& state) {
  math::Random random(3);
  std::vector<float> records(16 * math_samples, 1.0f);
  std::vector<std::int32_t> index(math_samples);
  for (std::int32_t& i : index) i = static_cast<std::int32_t>(random.below(math_samples));
  for (auto _ : state) {
    for (std::size_t k = 0; k < math_samples; k += W) {
      math::WideFloat<W> columns[16];
      math::gather_rows<16, W>(records.data(), &index[k], columns);
      math::WideFloat<W> changed[8];
      for (int c = 0; c < 8; ++c) changed[c] = columns[c] * columns[c + 8];
      math::scatter_rows<16>(records.data(), &index[k], changed);
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(math_samples));
}
BENCHMARK(gather_and_scatter<4>);

}  // namespace
}  // namespace carom::benchmarks
