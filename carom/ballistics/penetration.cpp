#include "carom/ballistics/penetration.h"

#include "carom/ballistics/detail/number_checks.h"

namespace carom::ballistics {

double poncelet_depth(const Penetrator& bullet, const Medium& medium) {
  const double v2 = bullet.speed * bullet.speed;
  if (!(medium.inertia > 0)) return bullet.mass * v2 / (2 * bullet.area * medium.strength);
  return bullet.mass / (2 * bullet.area * medium.inertia) * math::log1p(medium.inertia * v2 / medium.strength);
}

double poncelet_residual(const Penetrator& bullet, const Medium& medium, double thickness) {
  const double v2 = bullet.speed * bullet.speed, k = 2 * bullet.area * thickness / bullet.mass;
  const double worn = k * medium.inertia;
  if (!(worn > 1e-12)) return math::sqrt(math::max(v2 - k * medium.strength, 0.0));
  // v² + a/b falls as e^{−2Abx/m}; apart, so that a great a/b gives no speed by rounding.
  return math::sqrt(math::max(v2 * math::exp(-worn) + medium.strength / medium.inertia * math::expm1(-worn), 0.0));
}

double recht_ipson_residual(double speed, double limit_speed, double mass, double plug_mass) {
  const double v2 = speed * speed - limit_speed * limit_speed;
  return v2 > 0 ? math::sqrt(v2) * mass / (mass + plug_mass) : 0;
}

double lambert_jonas_residual(double speed, double limit_speed, double a, double p) {
  if (!(speed > limit_speed)) return 0;
  return a * math::pow(math::pow(speed, p) - math::pow(limit_speed, p), 1 / p);
}

core::Status check_layers(std::span<const Layer> layers) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    const core::Status numbers = detail::check_numbers({{"thickness", layer.thickness},
                                                        {"strength", layer.medium.strength},
                                                        {"inertia", layer.medium.inertia, true},
                                                        {"limit_speed", layer.limit_speed, true},
                                                        {"density", layer.density, true},
                                                        {"ricochet_angle", layer.ricochet_angle, true}});
    if (!numbers) return core::Error{core::text("layer ", i + 1, ": ", numbers.error().message)};
    if (!(layer.ricochet_restitution >= 0 && layer.ricochet_restitution <= 1))
      return core::Error{core::text("layer ", i + 1, ": ",
                                    core::refused("ricochet_restitution", layer.ricochet_restitution, "0 to 1"))};
  }
  return {};
}

LayerPassage pass_layer(const Penetrator& bullet, const Layer& layer, double angle) {
  LayerPassage passage{.speed_in = bullet.speed};
  if (angle < layer.ricochet_angle) {
    passage.outcome = LayerOutcome::ricochet;
    passage.speed_out = layer.ricochet_restitution * bullet.speed;
  } else {
    passage.path = layer.thickness / math::sin(angle);
    if (layer.limit_speed > 0) {
      // A plate met aslant is thicker by 1/sin: its limit grows alike.
      const double plug = layer.density * bullet.area * passage.path;
      passage.speed_out = recht_ipson_residual(bullet.speed, layer.limit_speed / math::sin(angle), bullet.mass, plug);
    } else {
      passage.speed_out = poncelet_residual(bullet, layer.medium, passage.path);
      if (passage.speed_out == 0) passage.path = poncelet_depth(bullet, layer.medium);
    }
    passage.outcome = passage.speed_out > 0 ? LayerOutcome::passed : LayerOutcome::stopped;
  }
  passage.energy = 0.5 * bullet.mass * (bullet.speed * bullet.speed - passage.speed_out * passage.speed_out);
  return passage;
}

core::Result<std::vector<LayerPassage>> penetrate(const Penetrator& bullet, std::span<const Layer> layers,
                                                  double angle) {
  const core::Status numbers = detail::check_numbers({{"mass of the bullet", bullet.mass},
                                                      {"area of the bullet", bullet.area},
                                                      {"speed of the bullet", bullet.speed, true}});
  if (!numbers) return numbers.error();
  if (!(angle > 0) || angle > math::pi / 2 + 1e-9)
    return core::Error{core::refused("angle to the surface", angle, "more than 0 and at most pi/2 rad")};
  if (const core::Status checked = check_layers(layers); !checked.ok()) return checked.error();
  std::vector<LayerPassage> passages;
  Penetrator here = bullet;
  for (const Layer& layer : layers) {
    if (!(here.speed > 0)) break;
    passages.push_back(pass_layer(here, layer, angle));
    here.speed = passages.back().speed_out;
    if (passages.back().outcome != LayerOutcome::passed) break;
  }
  return passages;
}

}  // namespace carom::ballistics
