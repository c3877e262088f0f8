#include "carom/ballistics/dispersion.h"

#include "carom/core/string.h"

namespace carom::ballistics {

namespace detail {

/// Φ(x), the normal distribution: Taylor's series of erf near the middle, Lentz's continued fraction of erfc outside.
double normal_cdf(double x) {
  const double z = math::abs(x) / math::sqrt(2.0);
  double tail;  // erfc(z)/2
  if (z < 2.5) {
    double term = z, sum = z;
    for (int n = 1; n < 80 && math::abs(term) > 1e-18; ++n) {
      term *= -z * z / n;
      sum += term / (2 * n + 1);
    }
    tail = 0.5 - sum / math::sqrt(math::pi);
  } else {
    double fraction = z;
    for (int n = 60; n > 0; --n) fraction = z + 0.5 * n / fraction;
    tail = 0.5 * math::exp(-z * z) / (fraction * math::sqrt(math::pi));
  }
  return x < 0 ? tail : 1 - tail;
}

/// Probability of [−half, half] about the centre.
double inside(double mean, double sigma, double half) {
  if (!(sigma > 0)) return math::abs(mean) <= half ? 1 : 0;
  return normal_cdf((half - mean) / sigma) - normal_cdf((-half - mean) / sigma);
}

}  // namespace detail

double hit_probability(const Spread& spread, math::Vec2d half) {
  return detail::inside(spread.mean.x, spread.sigma.x, half.x) * detail::inside(spread.mean.y, spread.sigma.y, half.y);
}

double hit_probability(const Spread& spread, double radius) {
  if (!(spread.sigma.x > 0)) {
    const double rest = radius * radius - spread.mean.x * spread.mean.x;
    return rest < 0 ? 0 : detail::inside(spread.mean.y, spread.sigma.y, math::sqrt(rest));
  }
  // ∫ φ(x) P(|y| < √(r² − x²)) dx over the circle, with x = r sin u: smooth at its ends. Simpson's rule, fine enough
  // for circles of many σ.
  const double over = radius / spread.sigma.x;
  const int n = 2 * int(math::clamp(20 * over, 50.0, 4000.0));
  const double h = math::pi / n;
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const math::SinCos<double> u = math::sincos(-math::pi / 2 + h * i);
    const double x = radius * u.sin, t = (x - spread.mean.x) / spread.sigma.x;
    const double density = math::exp(-0.5 * t * t) / (spread.sigma.x * math::sqrt(2 * math::pi));
    const double value = density * radius * u.cos * detail::inside(spread.mean.y, spread.sigma.y, radius * u.cos);
    sum += (i == 0 || i == n ? 1 : (i % 2 == 1 ? 4 : 2)) * value;
  }
  return sum * h / 3;
}

core::Result<Spread> spread_at(const Gun& gun, const Conditions& conditions, const Aiming& aiming, double distance,
                               const ShotVariation& variation) {
  const auto place = [&](const Gun& g, const Conditions& c, double d) -> core::Result<math::Vec2d> {
    const core::Result<SightedFlight> flight = SightedFlight::fire(g, c, aiming, d);
    if (!flight) return flight.error();
    const std::optional<SightedPoint> point = flight->at(d);
    if (!point) return core::Error{core::text("the shot does not reach ", d, " m")};
    return math::Vec2d{point->side, point->height};
  };
  const core::Result<math::Vec2d> middle = place(gun, conditions, distance);
  if (!middle) return middle.error();
  Spread spread{.mean = middle.value()};
  math::Vec2d variance{math::square(variation.aim * distance), math::square(variation.aim * distance)};
  const auto add = [&](const core::Result<math::Vec2d>& changed, double change,
                       double deviation) -> core::Result<void> {
    if (!changed) return changed.error();
    const math::Vec2d slope = (changed.value() - middle.value()) / change;
    variance.x += math::square(slope.x * deviation);
    variance.y += math::square(slope.y * deviation);
    return {};
  };
  Gun faster = gun;
  faster.muzzle_speed += 1;
  if (const core::Result<void> r = add(place(faster, conditions, distance), 1, variation.muzzle_speed); !r.ok())
    return r.error();
  std::vector<environment::WindColumn::Level> levels(conditions.wind.levels().begin(), conditions.wind.levels().end());
  if (levels.empty()) levels.push_back({});
  for (environment::WindColumn::Level& level : levels) level.velocity.z += 1;
  Conditions windier = conditions;
  windier.wind = environment::WindColumn(levels);
  if (conditions.field)
    windier.field = [&](math::Vec3d point, double time) {
      return conditions.field(point, time) + math::Vec3d{0, 0, 1};
    };
  if (const core::Result<void> r = add(place(gun, windier, distance), 1, variation.wind); !r.ok()) return r.error();
  const double nearer = math::min(1.0, 0.01 * distance);
  if (const core::Result<void> r = add(place(gun, conditions, distance - nearer), nearer, variation.range); !r.ok())
    return r.error();
  spread.sigma = {math::sqrt(variance.x), math::sqrt(variance.y)};
  return spread;
}

}  // namespace carom::ballistics
