#include "carom/blast/loading.h"

#include <array>

#include "carom/math/elementary.h"

namespace carom::blast {

namespace {

/// ∫₀^S sᵏ e^{−βs} ds for k = 0 … 3.
struct Moments {
  double beta = -1, end = -1;
  double of[4] = {};

  Moments() = default;
  Moments(double b, double s) : beta(b), end(s) {
    const double x = beta * end, last = math::exp(-x);
    if (x < 0.5) {
      // The last by its series Σ (−x)ⁿ/(n! (n + 4)), the others from it.
      constexpr int terms = 14;
      static constexpr auto series = [] {
        std::array<double, terms> c{};
        double factorial = 1;
        for (int n = 0; n < terms; factorial *= ++n) c[std::size_t(n)] = 1 / (factorial * (n + 4));
        return c;
      }();
      double sum = 0;
      for (int n = terms - 1; n >= 0; --n) sum = series[std::size_t(n)] - x * sum;
      const double end2 = end * end;
      of[3] = end2 * end2 * sum;
      of[2] = (beta * of[3] + end2 * end * last) / 3;
      of[1] = (beta * of[2] + end2 * last) / 2;
      of[0] = beta * of[1] + end * last;
      return;
    }
    const double inverse = 1 / beta;
    of[0] = (1 - last) * inverse;
    double power = last;
    for (int k = 1; k < 4; ++k) {
      power *= end;
      of[k] = (k * of[k - 1] - power) * inverse;
    }
  }
};

}  // namespace

void SurfaceLoad::add(double amplitude, double duration, double decay, int power, bool clears) {
  if (amplitude == 0 || !(duration > 0)) return;
  terms_[count_++] = {amplitude, duration, decay, power, clears};
  end_ = math::max(end_, arrival_ + (clears ? math::min(duration, clearing_) : duration));
}

SurfaceLoad::SurfaceLoad(const Wave& w, double cosine, double clearing_length, double share)
    : arrival_(w.arrival), end_(w.arrival) {
  const double c = math::clamp(cosine, -1.0, 1.0);
  // Where the fits give more impulse than a triangle of P and t_d has, the phase is longer, not the impulse less.
  const auto phase = [&](double pressure, double impulse, double decay) {
    return decay > 0 || impulse <= 0.5 * pressure * w.duration ? w.duration : 2 * impulse / pressure;
  };
  const double side = phase(w.pressure, w.impulse, w.decay);
  const double reflected = phase(w.reflected_pressure, w.reflected_impulse, w.reflected_decay);
  if (share < 1) {
    add(share * w.pressure, side, w.decay, 1, false);
    return;
  }
  const double wind = dynamic_pressure(w.pressure);
  if (c <= 0) {
    add(w.pressure, side, w.decay, 1, false);
    add(-0.4 * c * c * wind, side, 2 * w.decay, 2, false);
    return;
  }
  const bool clears = clearing_length > 0;
  clearing_ = clears ? 3 * clearing_length / w.front_speed : 1e30;
  if (clears) {
    add(w.pressure, side, w.decay, 1, false);
    add(c * c * wind, side, 2 * w.decay, 2, false);
    add(-c * c * wind, side, 2 * w.decay, 2, true);
  }
  add((clears ? c * c - 2 * c : 1 + c * c - 2 * c) * w.pressure, side, w.decay, 1, clears);
  add(c * c * w.reflected_pressure, reflected, w.reflected_decay, 1, clears);
}

double SurfaceLoad::pressure(double time) const {
  const double t = time - arrival_;
  double sum = 0;
  for (int i = 0; i < count_ && t >= 0; ++i) {
    const Term& term = terms_[i];
    if (t > term.duration || (term.clears && t > clearing_)) continue;
    const double s = t / term.duration;
    double p = term.amplitude * (1 - s) * math::exp(-term.decay * s);
    if (term.power == 2) p *= 1 - s;
    sum += term.clears ? p * (1 - t / clearing_) : p;
  }
  return sum;
}

double wind_impulse(const Wave& w, double time) {
  const double s = math::clamp((time - w.arrival) / w.duration, 0.0, 1.0);
  if (!(s > 0)) return 0;
  const Moments moments(2 * w.decay, s);
  const auto& m = moments.of;
  return dynamic_pressure(w.pressure) * w.duration * (m[0] - 2 * m[1] + m[2]);
}

double sheet_impulse(double load, double mass, double speed, double wind) {
  if (!(load > 0) || !(wind > speed)) return 0;
  return -mass * (wind - speed) * math::expm1(-load / (mass * wind));
}
double drag_impulse(double load, double mass, double speed, double wind) {
  if (!(load > 0) || !(wind > speed)) return 0;
  const double past = wind - speed, lost = load * past / (mass * wind * wind);
  return mass * past * lost / (1 + lost);
}

double SurfaceLoad::impulse(double time) const {
  double sum = 0;
  Moments known[2];
  for (int i = 0; i < count_ && time > arrival_; ++i) {
    const Term& term = terms_[i];
    double t = math::min(time - arrival_, term.duration);
    if (term.clears) t = math::min(t, clearing_);
    const double s = t / term.duration;
    Moments& moments = known[term.power - 1];
    if (moments.beta != term.decay || moments.end != s) moments = Moments(term.decay, s);
    const auto& m = moments.of;
    // (1 − s)^power (1 − κ s) by powers of s.
    const double k = term.clears ? term.duration / clearing_ : 0;
    const double part =
        term.power == 1 ? m[0] - (1 + k) * m[1] + k * m[2] : m[0] - (2 + k) * m[1] + (1 + 2 * k) * m[2] - k * m[3];
    sum += term.amplitude * term.duration * part;
  }
  return sum;
}

}  // namespace carom::blast
