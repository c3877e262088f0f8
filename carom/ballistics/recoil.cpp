#include "carom/ballistics/recoil.h"

#include <array>

#include "carom/ballistics/detail/number_checks.h"
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

/// Six ways to move: forward, up, right, and the turns about them.
using Six = std::array<double, 6>;
using Square6 = std::array<Six, 6>;
/// Ways and their rates.
using State = std::array<double, 12>;
using Matrix = std::array<State, 12>;

Six frequencies(const GunMount& m) {
  return {m.push_frequency, m.lift_frequency, m.slide_frequency, m.roll_frequency, m.swing_frequency, m.rise_frequency};
}
Six dampings(const GunMount& m) {
  return {m.push_damping, m.lift_damping, m.slide_damping, m.roll_damping, m.swing_damping, m.rise_damping};
}

/// The mass matrix about the shoulder: v = u̇ + θ̇ × c of the centre of mass makes the couplings.
Square6 mass_matrix(const GunMount& g) {
  const double m = g.mass, x = g.centre_of_mass.x, y = g.centre_of_mass.y, z = g.centre_of_mass.z;
  return {{{m, 0, 0, 0, m * z, -m * y},
           {0, m, 0, -m * z, 0, m * x},
           {0, 0, m, m * y, -m * x, 0},
           {0, -m * z, m * y, g.roll_inertia, -m * x * y, -m * x * z},
           {m * z, 0, -m * x, -m * x * y, g.inertia, -m * y * z},
           {-m * y, m * x, 0, -m * x * z, -m * y * z, g.inertia}}};
}

/// M⁻¹ by Gauss and Jordan, without pivots: M is positive definite.
Square6 inverse(Square6 a) {
  Square6 out{};
  for (int i = 0; i < 6; ++i) out[i][i] = 1;
  for (int i = 0; i < 6; ++i) {
    const double by = 1 / a[i][i];
    for (int k = 0; k < 6; ++k) a[i][k] *= by, out[i][k] *= by;
    for (int r = 0; r < 6; ++r) {
      const double times = a[r][i];
      if (r == i || times == 0) continue;
      for (int k = 0; k < 6; ++k) a[r][k] -= times * a[i][k], out[r][k] -= times * out[i][k];
    }
  }
  return out;
}

State operator*(const Matrix& a, const State& x) {
  State out{};
  for (int i = 0; i < 12; ++i)
    for (int k = 0; k < 12; ++k) out[i] += a[i][k] * x[k];
  return out;
}
Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (int i = 0; i < 12; ++i)
    for (int k = 0; k < 12; ++k)
      for (int j = 0; j < 12; ++j) out[i][j] += a[i][k] * b[k][j];
  return out;
}

/// e^{At} x of the coupled mount for any t. A time is so many steps of 2⁻ᵏ s, the powers of whose exponential are kept,
/// and a rest for Taylor's series, which a step of norm ≤ ½ makes exact to rounding.
struct Coupled {
  explicit Coupled(const GunMount& g, double longest) {
    const Square6 mass = mass_matrix(g), inverted = inverse(mass);
    const Six f = frequencies(g), zeta = dampings(g);
    // Rates are kept by this unit, so that both halves of A are of one size.
    unit = 1;
    for (const double one : f) unit = math::max(unit, 2 * math::pi * one);
    for (int i = 0; i < 6; ++i) {
      a[i][i + 6] = unit;
      for (int k = 0; k < 6; ++k) {
        const double omega = 2 * math::pi * f[k], own = inverted[i][k] * mass[k][k];
        a[i + 6][k] = -own * omega * omega / unit;
        a[i + 6][k + 6] = -own * 2 * zeta[k] * omega;
      }
    }
    double norm = 0;
    for (const State& row : a) {
      double sum = 0;
      for (const double x : row) sum += math::abs(x);
      norm = math::max(norm, sum);
    }
    while (norm * step > 0.5) step *= 0.5;
    Matrix power{};
    for (int i = 0; i < 12; ++i) {
      State e{};
      e[i] = 1;
      e = taylor(e, step);
      for (int r = 0; r < 12; ++r) power[r][i] = e[r];
    }
    for (double reach = step; reach <= longest; reach *= 2) {
      powers.push_back(power);
      power = power * power;
    }
    // The impulse at the bore, backward: (−1, 0, 0) and its moment.
    const Six p{-1, 0, 0, 0, -g.bore_beside_shoulder, g.bore_above_shoulder};
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < 6; ++k) start[i + 6] += inverted[i][k] * p[k] / unit;
  }
  State taylor(const State& x, double t) const {
    State sum = x, term = x;
    for (int n = 1; n <= 14; ++n) {
      term = a * term;
      for (int i = 0; i < 12; ++i) sum[i] += term[i] *= t / n;
    }
    return sum;
  }
  State after(double t) const {
    State x = start;
    for (std::size_t k = powers.size(); k-- > 0;) {
      const double length = step * double(1ull << k);
      if (t >= length) {
        x = powers[k] * x;
        t -= length;
      }
    }
    return taylor(x, t);
  }
  Matrix a{};
  std::vector<Matrix> powers;
  State start{};  // of a shot of 1 N·s
  double step = 1, unit = 1;
};

RecoilMotion coupled_recoil(const GunMount& mount, double impulse, std::span<const double> shot_times, double time) {
  double longest = 0;
  for (const double shot : shot_times) longest = math::max(longest, time - shot);
  if (!(longest > 0)) return {};
  const Coupled gun(mount, longest);
  State sum{};
  for (const double shot : shot_times) {
    if (!(time > shot)) continue;
    const State one = gun.after(time - shot);
    for (int i = 0; i < 6; ++i) sum[i] += impulse * one[i];
  }
  return {.back = -sum[0], .rise = sum[5], .swing = -sum[4], .lift = sum[1], .slide = sum[2], .roll = sum[3]};
}

}  // namespace detail

core::Status check(const GunMount& g) {
  const core::Status numbers = detail::check_numbers({{"mass", g.mass},
                                                      {"inertia", g.inertia},
                                                      {"roll_inertia", g.roll_inertia},
                                                      {"push_frequency", g.push_frequency, true},
                                                      {"push_damping", g.push_damping, true},
                                                      {"rise_frequency", g.rise_frequency, true},
                                                      {"rise_damping", g.rise_damping, true},
                                                      {"swing_frequency", g.swing_frequency, true},
                                                      {"swing_damping", g.swing_damping, true},
                                                      {"lift_frequency", g.lift_frequency, true},
                                                      {"lift_damping", g.lift_damping, true},
                                                      {"slide_frequency", g.slide_frequency, true},
                                                      {"slide_damping", g.slide_damping, true},
                                                      {"roll_frequency", g.roll_frequency, true},
                                                      {"roll_damping", g.roll_damping, true}},
                                                     1e9);
  if (!numbers) return numbers.error();
  const math::Vec3d c = g.centre_of_mass;
  if (!math::is_finite(c.x + c.y + c.z) || math::length(c) > 1e3)
    return core::Error{core::text("centre_of_mass is ", c.x, ", ", c.y, ", ", c.z, ", expected at most 1000 m")};
  const struct {
    const char* name;
    double value, square;
  } turns[] = {{"roll_inertia", g.roll_inertia, c.y * c.y + c.z * c.z},
               {"inertia", g.inertia, c.x * c.x + math::max(c.y * c.y, c.z * c.z)}};
  for (const auto& turn : turns)
    if (turn.square > 0 && !(turn.value > turn.square * g.mass * (1 + 1e-6)))
      return core::Error{core::refused(turn.name, turn.value,
                                       core::text("more than ", turn.square * g.mass,
                                                  " kg·m², which the mass in its centre has about the shoulder"))};
  return {};
}

RecoilMotion recoil_at(const GunMount& mount, double impulse, std::span<const double> shot_times, double time) {
  if (mount.centre_of_mass != math::Vec3d{}) return detail::coupled_recoil(mount, impulse, shot_times, time);
  RecoilMotion motion;
  for (const double shot : shot_times) {
    const double since = time - shot, turn = impulse / mount.inertia;
    motion.back += detail::impulse_response(mount.push_frequency, mount.push_damping, since) * impulse / mount.mass;
    motion.rise +=
        detail::impulse_response(mount.rise_frequency, mount.rise_damping, since) * turn * mount.bore_above_shoulder;
    if (mount.bore_beside_shoulder != 0)
      motion.swing += detail::impulse_response(mount.swing_frequency, mount.swing_damping, since) * turn *
                      mount.bore_beside_shoulder;
  }
  return motion;
}

core::Result<std::vector<math::Vec2d>> recoil_pattern(const GunMount& mount, double impulse,
                                                      const RecoilPattern& pattern) {
  if (const core::Status good = check(mount); !good) return core::Error{core::text("recoil: ", good.error().message)};
  const core::Status numbers = detail::check_numbers(
      {{"impulse", impulse, true}, {"rounds_per_minute", pattern.rounds_per_minute}, {"wander", pattern.wander, true}});
  if (!numbers) return core::Error{core::text("recoil: ", numbers.error().message)};
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
