#include "carom/blast/wave.h"

#include <algorithm>
#include <span>

#include "carom/blast/detail/wave_table.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast {

namespace detail {

/// exp(Σ aᵢ (ln Z)ⁱ) up to the scaled distance `until`.
struct Fit {
  double until;
  double a[7];
};
constexpr Fit side_on_pressure[] = {{2.9, {7.2106, -2.1069, -.3229, .1117, .0685}},
                                    {23.8, {7.5938, -3.0523, .40977, .0261, -.01267}},
                                    {198.5, {6.0536, -1.4066}}};
constexpr Fit reflected_pressure[] = {{2, {9.006, -2.6893, -.6295, .1011, .29255, .13505, .019736}},
                                      {40, {8.8396, -1.733, -2.64, 2.293, -.8232, .14247, -.0099}}};
constexpr Fit arrival[] = {{1.5, {-.7604, 1.8058, .1257, -.0437, -.0310, -.00669}},
                           {40, {-.7137, 1.5732, .5561, -.4213, .1054, -.00929}}};
constexpr Fit duration[] = {{1.02, {.5426, 3.2299, -1.5931, -5.9667, -4.0815, -.9149}},
                            {2.8, {.5440, 2.7082, -9.7354, 14.3425, -9.7791, 2.8535}},
                            {40, {-2.4608, 7.1639, -5.6215, 2.2711, -.44994, .03486}}};
constexpr Fit impulse[] = {{.96, {5.522, 1.117, .6, -.292, -.087}},
                           {2.38, {5.465, -.308, -1.464, 1.362, -.432}},
                           {33.7, {5.2749, -.4677, -.2499, .0588, -.00554}},
                           {158.7, {5.9825, -1.062}}};
constexpr Fit reflected_impulse[] = {{40, {6.7853, -1.3466, .101, -.01123}}};
constexpr Fit front_speed[] = {{1.5, {.1794, -.956, -.0866, .109, .0699, .01218}},
                               {40, {.2597, -1.326, .3767, .0396, -.0351, .00432}}};

double evaluate(std::span<const Fit> fits, double z) {
  std::size_t i = 0;
  while (i + 1 < fits.size() && z > fits[i].until) ++i;
  const double x = math::log(z);
  double sum = 0;
  for (int k = 6; k >= 0; --k) sum = sum * x + fits[i].a[k];
  return math::exp(sum);
}

/// One fit of the table above: its name, from where it holds, its pieces, its unit in SI, whether it grows with
/// W^{1/3}.
struct Fitted {
  const char* name;
  double least;
  std::span<const Fit> fits;
  double unit;
  bool scales;
};
const Fitted& fitted(WaveQuantity quantity) {
  static constexpr Fitted all[] = {
      {"side-on pressure", .2, side_on_pressure, 1e3, false},
      {"reflected pressure", .06, reflected_pressure, 1e3, false},
      {"arrival", .06, arrival, 1e-3, true},
      {"duration", .2, duration, 1e-3, true},
      {"side-on impulse", .2, impulse, 1, true},
      {"reflected impulse", .06, reflected_impulse, 1, true},
      {"front speed", .06, front_speed, 1e3, false},
  };
  return all[int(quantity)];
}

std::vector<double> ends_of_fits() {
  std::vector<double> ends;
  for (int i = 0; i <= int(WaveQuantity::front_speed); ++i)
    for (const Fit& fit : fitted(WaveQuantity(i)).fits)
      if (fit.until < greatest_scaled_distance) ends.push_back(fit.until);
  std::sort(ends.begin(), ends.end());
  return ends;
}

core::Status check(double charge, double distance) {
  if (!(charge > 0) || !math::is_finite(charge))
    return core::Error{core::refused("charge", charge, "a finite mass of TNT > 0 kg")};
  if (!(distance > 0) || !math::is_finite(distance))
    return core::Error{core::refused("distance", distance, "a finite number of metres > 0")};
  return {};
}

}  // namespace detail

const char* to_string(WaveQuantity quantity) { return detail::fitted(quantity).name; }

ScaledRange fitted_range(WaveQuantity quantity) {
  const detail::Fitted& f = detail::fitted(quantity);
  return {f.least, f.fits.back().until};
}

core::Result<double> wave_quantity(WaveQuantity quantity, double charge, double distance) {
  if (const core::Status good = detail::check(charge, distance); !good) return good.error();
  const detail::Fitted& f = detail::fitted(quantity);
  const ScaledRange range = fitted_range(quantity);
  const double scale = math::cbrt(charge), z = distance / scale;
  if (z < range.least || z > range.greatest)
    return core::Error{core::text(distance, " m from ", charge, " kg: ",
                                  core::refused(core::text("scaled distance for the ", f.name), z,
                                                core::text(range.least, " to ", range.greatest, " m/kg^(1/3)")))};
  return (f.scales ? f.unit * scale : f.unit) * detail::evaluate(f.fits, z);
}

core::Result<Wave> blast_wave(double charge, double distance, Burst burst) {
  if (const core::Status good = detail::check(charge, distance); !good) return good.error();
  const double mass = burst == Burst::ground ? charge : charge / 1.8;
  const double scale = math::cbrt(mass), z = distance / scale;
  if (z < least_scaled_distance || z > greatest_scaled_distance)
    return core::Error{
        core::text(distance, " m from ", charge, " kg: ", core::refused("scaled distance", z, "0.2 to 40 m/kg^(1/3)"))};
  constexpr double kilo = 1e3, milli = 1e-3;
  Wave wave;
  wave.pressure = kilo * detail::evaluate(detail::side_on_pressure, z);
  wave.reflected_pressure = kilo * detail::evaluate(detail::reflected_pressure, z);
  wave.arrival = milli * scale * detail::evaluate(detail::arrival, z);
  wave.duration = milli * scale * detail::evaluate(detail::duration, z);
  wave.impulse = scale * detail::evaluate(detail::impulse, z);  // kPa·ms
  wave.reflected_impulse = scale * detail::evaluate(detail::reflected_impulse, z);
  wave.front_speed = kilo * detail::evaluate(detail::front_speed, z);
  if (burst != Burst::ground) wave = strengthened(wave, kinney_graham_pressure(charge, distance) / wave.pressure);
  wave.decay = friedlander_decay(wave.pressure, wave.duration, wave.impulse);
  wave.reflected_decay = friedlander_decay(wave.reflected_pressure, wave.duration, wave.reflected_impulse);
  return wave;
}

Wave strengthened(const Wave& wave, double by) {
  Wave out = wave;
  for (double* value : {&out.pressure, &out.reflected_pressure, &out.impulse, &out.reflected_impulse}) *value *= by;
  out.front_speed *= shock_speed(out.pressure) / shock_speed(wave.pressure);
  return out;
}

double kinney_graham_pressure(double charge, double distance, double ambient) {
  const double z = distance / math::cbrt(charge);
  const auto root = [&](double scale) { return math::sqrt(1 + math::square(z / scale)); };
  return ambient * 808 * (1 + math::square(z / 4.5)) / (root(.048) * root(.32) * root(1.35));
}

double friedlander(double peak, double duration, double decay, double time) {
  if (time < 0 || time > duration || !(duration > 0)) return 0;
  const double s = time / duration;
  return peak * (1 - s) * math::exp(-decay * s);
}

double friedlander_decay(double peak, double duration, double impulse) {
  const double wanted = impulse / (peak * duration);
  if (!(wanted < 0.5)) return 0;
  const auto share = [](double b) {
    if (b < 1e-2) return 0.5 - b / 6 + b * b / 24 - b * b * b / 120;
    return 1 / b + math::expm1(-b) / (b * b);
  };
  constexpr double most = 200;
  if (share(most) > wanted) return most;
  // The share falls and is convex, so that Newton's method from the left never passes the root. On its left are the
  // roots of ½ − b/6 and of 1/b − 1/b², which are both below it.
  double b = 3 - 6 * wanted;
  if (wanted < 0.25) b = math::max(b, (1 + math::sqrt(1 - 4 * wanted)) / (2 * wanted));
  for (int i = 0; i < 40; ++i) {
    const double slope =
        b < 1e-2 ? -1.0 / 6 + b / 12 - b * b / 40 : (-1 - math::exp(-b)) / (b * b) - 2 * math::expm1(-b) / (b * b * b);
    const double step = (share(b) - wanted) / slope;
    b -= step;
    if (math::abs(step) <= 1e-14 * b) break;
  }
  return b;
}

Damage damage_of(double side_on_pressure) {
  constexpr double from[] = {0, 1e3, 14e3, 34e3, 70e3, 240e3};
  int damage = 5;
  while (damage > 0 && !(side_on_pressure >= from[damage])) --damage;
  return Damage(damage);
}

const char* to_string(Damage damage) {
  constexpr const char* names[] = {"none", "windows_break", "light_structures", "eardrums", "walls_collapse", "lethal"};
  return names[int(damage)];
}

}  // namespace carom::blast
