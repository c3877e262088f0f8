#include "carom/ballistics/recoil.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::ballistics {

namespace detail {

/// x(t) of ẍ + 2ζω ẋ + ω² x = 0 with x(0) = 0, ẋ(0) = 1.
double impulse_response(double frequency, double damping, double time) {
  if (!(time > 0)) return 0;
  const double omega = 2 * math::pi * frequency;
  if (!(omega > 0)) return time;
  const double s = 1 - damping * damping, fade = math::exp(-damping * omega * time);
  if (s > 1e-9) return fade * math::sin(omega * math::sqrt(s) * time) / (omega * math::sqrt(s));
  if (s < -1e-9) {
    const double r = omega * math::sqrt(-s), slow = math::exp((r - damping * omega) * time);
    return (slow - math::exp((-r - damping * omega) * time)) / (2 * r);
  }
  return time * math::exp(-omega * time);
}

}  // namespace detail

RecoilMotion recoil_at(const GunMount& mount, double impulse, std::span<const double> shot_times, double time) {
  RecoilMotion motion;
  for (const double shot : shot_times) {
    const double since = time - shot;
    const double turned =
        detail::impulse_response(mount.rise_frequency, mount.rise_damping, since) * impulse / mount.inertia;
    motion.back += detail::impulse_response(mount.push_frequency, mount.push_damping, since) * impulse / mount.mass;
    motion.rise += turned * mount.bore_above_shoulder;
    motion.swing -= turned * mount.bore_beside_shoulder;
  }
  return motion;
}

core::Result<std::vector<math::Vec2d>> recoil_pattern(const GunMount& mount, double impulse,
                                                      const RecoilPattern& pattern) {
  const struct {
    const char* name;
    double value;
    bool zero;
  } fields[] = {{"mass", mount.mass, false},
                {"inertia", mount.inertia, false},
                {"push_frequency", mount.push_frequency, true},
                {"push_damping", mount.push_damping, true},
                {"rise_frequency", mount.rise_frequency, true},
                {"rise_damping", mount.rise_damping, true},
                {"impulse", impulse, true},
                {"rounds_per_minute", pattern.rounds_per_minute, false},
                {"wander", pattern.wander, true}};
  for (const auto& field : fields)
    if (!math::is_finite(field.value) || field.value < 0 || (field.value == 0 && !field.zero))
      return core::Error{core::text(
          "recoil: ",
          core::refused(field.name, field.value, field.zero ? "a finite number >= 0" : "a finite number > 0"))};
  if (pattern.shots < 0 || pattern.shots > 100000)
    return core::Error{core::text("recoil: ", core::refused("shots", pattern.shots, "0 to 100000"))};
  math::Random random(pattern.seed);
  std::vector<double> times;
  std::vector<math::Vec2d> offsets;
  math::Vec2d wandered{};
  const double between = 60 / pattern.rounds_per_minute;
  for (int i = 0; i < pattern.shots; ++i) {
    const double time = i * between;
    const RecoilMotion motion = recoil_at(mount, impulse, times, time);
    const math::Vec2d held{motion.swing, motion.rise};
    offsets.push_back(held + wandered);
    wandered += (pattern.wander * impulse * mount.bore_above_shoulder * between / mount.inertia) * random.in_disc();
    times.push_back(time);
  }
  return offsets;
}

}  // namespace carom::ballistics
