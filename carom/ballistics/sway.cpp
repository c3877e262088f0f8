#include "carom/ballistics/sway.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::ballistics {

Sway sway_of(Stance stance, double skill, double fatigue) {
  constexpr double of_stance[] = {2.0, 1.2, 0.8, 0.5, 0.18};  // mrad rms, altogether, of an average shooter
  const double tired = 1 + 1.5 * math::clamp(fatigue, 0.0, 1.0);
  const double scale = of_stance[int(stance)] * (1.6 - 1.2 * math::clamp(skill, 0.0, 1.0));
  Sway sway;
  sway.breath = 0.55e-3 * scale * tired;
  sway.heartbeat = 0.2e-3 * scale * tired;
  sway.tremor = 0.15e-3 * scale * tired;
  sway.drift = 0.78e-3 * scale;
  sway.breath_frequency = 0.22 + 0.2 * math::clamp(fatigue, 0.0, 1.0);
  sway.heartbeat_frequency = 1.1 + 1.2 * math::clamp(fatigue, 0.0, 1.0);
  return sway;
}

core::Status check(const Sway& s) {
  const struct {
    const char* name;
    double value, least, most;
    const char* expected;
  } fields[] = {
      {"breath", s.breath, 0, 1, "0 to 1 rad"},
      {"breath_frequency", s.breath_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"heartbeat", s.heartbeat, 0, 1, "0 to 1 rad"},
      {"heartbeat_frequency", s.heartbeat_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"tremor", s.tremor, 0, 1, "0 to 1 rad"},
      {"tremor_low", s.tremor_low, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"tremor_high", s.tremor_high, s.tremor_low, 1e3, "tremor_low to 1000 Hz"},
      {"drift", s.drift, 0, 1, "0 to 1 rad"},
      {"drift_low", s.drift_low, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"drift_high", s.drift_high, s.drift_low, 1e3, "drift_low to 1000 Hz"},
  };
  for (const auto& f : fields)
    if (!(f.value >= f.least && f.value <= f.most))
      return core::Error{core::text("sway: ", core::refused(f.name, f.value, f.expected))};
  return {};
}

SwayMotion::SwayMotion(const Sway& sway, std::uint64_t seed) {
  math::Random random(seed);
  const auto phase = [&] { return random.uniform(0.0, 2 * math::pi); };
  const auto band = [&](Part part, double rms, double low, double high, int count) {
    // Lines of equal power, one in each equal part of the band: a² n/2 = rms².
    const double amplitude = rms * math::sqrt(2.0 / count);
    for (int i = 0; i < count; ++i) {
      const double frequency = low + (high - low) * (i + random.uniform()) / count;
      waves_.push_back({part, 2 * math::pi * frequency, phase(), phase(), amplitude, amplitude});
    }
  };
  const double root2 = math::sqrt(2.0);
  waves_.push_back({Part::breath, 2 * math::pi * sway.breath_frequency, phase(), phase(), 0.25 * root2 * sway.breath,
                    root2 * sway.breath});
  // A pulse: the beat and its first overtones.
  const double beat = sway.heartbeat / math::sqrt(1 + 0.25 + 0.0625);
  for (int k = 1; k <= 3; ++k) {
    const double amplitude = root2 * beat * (k == 1 ? 1.0 : k == 2 ? 0.5 : 0.25);
    waves_.push_back(
        {Part::heartbeat, 2 * math::pi * k * sway.heartbeat_frequency, phase(), phase(), 0.5 * amplitude, amplitude});
  }
  band(Part::tremor, sway.tremor, sway.tremor_low, sway.tremor_high, 12);
  band(Part::drift, sway.drift, sway.drift_low, sway.drift_high, 12);
}

math::Vec2d SwayMotion::at(double time, double breath_held) const {
  const double held = math::clamp(breath_held, 0.0, 1.0);
  math::Vec2d sum{};
  for (const Wave& wave : waves_) {
    const double scale = wave.part == Part::breath ? 1 - held : (wave.part == Part::tremor ? 1 + 0.5 * held : 1.0);
    const double angle = wave.omega * time;
    sum.x += scale * wave.amplitude_x * math::sin(angle + wave.phase_x);
    sum.y += scale * wave.amplitude_y * math::sin(angle + wave.phase_y);
  }
  return sum;
}

}  // namespace carom::ballistics
