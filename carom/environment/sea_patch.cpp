#include "carom/environment/sea_patch.h"

#include "carom/environment/detail/sea_waves.h"
#include "carom/math/cpu.h"
#include "carom/math/elementary.h"

namespace carom::environment {
namespace {

constexpr std::size_t widest = 16;

void run_lanes(int lanes, const detail::SeaWaves& waves, std::size_t from, std::size_t to) {
#if CAROM_WIDE_UNITS
  if (lanes == 16) return detail::sea_avx512::heights(waves, from, to);
  if (lanes == 8) return detail::sea_avx2::heights(waves, from, to);
#endif
  (void)lanes;
  detail::sea_baseline::heights(waves, from, to);
}

}  // namespace

void SeaPatch::set(const Sea& sea, math::Vec2d origin, double time, int lanes) {
  const math::InstructionSet set =
      lanes == 0 ? math::detect_instruction_set() : math::choose_instruction_set(math::instruction_set_of_width(lanes));
  lanes_ = math::simd_width(set);
  const std::size_t n = sea.components().size();
  waves_.resize(4 * n);
  constexpr double per_turn = 1 / (2 * math::pi);
  const math::Vec3d current = sea.water().current;
  for (std::size_t i = 0; i < n; ++i) {
    const WaveComponent& w = sea.components()[i];
    const double k = w.wave_number * per_turn;
    const double turns =
        k * (w.direction_x * (origin.x - current.x * time) + w.direction_z * (origin.y - current.z * time)) +
        (w.phase - w.frequency * time) * per_turn;
    waves_[i] = float(k * w.direction_x);
    waves_[n + i] = float(k * w.direction_z);
    waves_[2 * n + i] = float(turns - math::floor(turns + 0.5));
    waves_[3 * n + i] = float(w.amplitude);
  }
}

void SeaPatch::run(std::span<const float> x, std::span<const float> z, float* out, float* slope_x,
                   float* slope_z) const {
  const std::size_t n = waves_.size() / 4, points = x.size(), lanes = std::size_t(lanes_);
  detail::SeaWaves waves{waves_.data(),
                         waves_.data() + n,
                         waves_.data() + 2 * n,
                         waves_.data() + 3 * n,
                         int(n),
                         x.data(),
                         z.data(),
                         out,
                         slope_x,
                         slope_z};
  const std::size_t whole = points / lanes * lanes;
  if (whole > 0) run_lanes(lanes_, waves, 0, whole);
  if (whole == points) return;
  // The rest in a block of its own.
  float last_x[widest] = {}, last_z[widest] = {}, height[widest], along[widest], across[widest];
  for (std::size_t i = whole; i < points; ++i) last_x[i - whole] = x[i], last_z[i - whole] = z[i];
  waves.x = last_x, waves.z = last_z, waves.height = height;
  if (slope_x != nullptr) waves.slope_x = along, waves.slope_z = across;
  run_lanes(lanes_, waves, 0, lanes);
  for (std::size_t i = whole; i < points; ++i) {
    out[i] = height[i - whole];
    if (slope_x != nullptr) slope_x[i] = along[i - whole], slope_z[i] = across[i - whole];
  }
}

void SeaPatch::heights(std::span<const float> x, std::span<const float> z, std::span<float> out) const {
  if (x.size() != out.size() || z.size() != out.size()) return;
  run(x, z, out.data(), nullptr, nullptr);
}

void SeaPatch::heights(std::span<const float> x, std::span<const float> z, std::span<float> out,
                       std::span<float> slope_x, std::span<float> slope_z) const {
  if (x.size() != out.size() || z.size() != out.size() || slope_x.size() != out.size() || slope_z.size() != out.size())
    return;
  run(x, z, out.data(), slope_x.data(), slope_z.data());
}

}  // namespace carom::environment
