// What a bullet does to what it hits: thick media, plates, layers of them, and ricochets (chapter 18.5).
//
// No measured table with a source is known for the coefficients: they are designer's data. The formulas are the
// published ones; energy never grows.
#pragma once

#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::ballistics {

struct Penetrator {
  double mass = 0.0095;   ///< kg
  double area = 4.56e-5;  ///< m², frontal
  double speed = 800;     ///< m/s
};

/// Resistance F = A (a + b v²) of a thick medium. J. V. Poncelet, 1829.
struct Medium {
  double strength = 5e6;  ///< a, Pa
  double inertia = 1000;  ///< b, kg/m³: about the density times half a drag coefficient
};
/// Depth (m) at which the bullet stops: m/(2 A b) ln(1 + b v²/a); m v²/(2 A a) for b = 0.
CAROM_API double poncelet_depth(const Penetrator& bullet, const Medium& medium);
/// Speed (m/s) after `thickness` m; 0 where it stops within.
CAROM_API double poncelet_residual(const Penetrator& bullet, const Medium& medium, double thickness);

/// Speed behind a thin plate whose limit is v₅₀: √(v² − v₅₀²) m/(m + m_plug). R. F. Recht & T. W. Ipson, J. Appl. Mech.
/// 30 (1963) 384. The plug is what of the plate goes along (kg).
CAROM_API double recht_ipson_residual(double speed, double limit_speed, double mass, double plug_mass);
/// a (v^p − v₅₀^p)^{1/p}. J. P. Lambert & G. H. Jonas, BRL R-1852 (1976).
CAROM_API double lambert_jonas_residual(double speed, double limit_speed, double a, double p);

/// Angle (rad) between path and surface below which a sphere skips off water: 18°/√(specific gravity), the classic rule
/// of naval gunnery.
inline double water_ricochet_angle(double specific_gravity) {
  return 18 * math::pi / 180 / math::sqrt(specific_gravity);
}

/// A wall is layers one behind the other.
struct Layer {
  double thickness = 0.01;  ///< m, along the normal
  Medium medium{};
  double limit_speed = 0;             ///< m/s; > 0: a plate, by Recht and Ipson, instead of a medium
  double density = 7850;              ///< kg/m³, of a plate: the plug is the frontal area through it
  double ricochet_angle = 0;          ///< rad: flatter than this to the surface, it skips off
  double ricochet_restitution = 0.7;  ///< share of the speed that is left then
};
enum class LayerOutcome { passed, stopped, ricochet };
struct LayerPassage {
  LayerOutcome outcome = LayerOutcome::passed;
  double speed_in = 0, speed_out = 0;  ///< m/s
  double path = 0;                     ///< m, in the layer
  double energy = 0;                   ///< J, left in it
};
/// The first layer or field that cannot be, by name.
CAROM_API core::Status check_layers(std::span<const Layer> layers);
/// One layer alone, of what `check_layers` lets through: as `penetrate`.
CAROM_API LayerPassage pass_layer(const Penetrator& bullet, const Layer& layer, double angle = math::pi / 2);

/// Layer by layer until the bullet stops or skips off; `angle` (rad) between path and surface, 0 < angle ≤ π/2; the
/// bullet goes straight on. Errors name the layer and the field.
CAROM_API core::Result<std::vector<LayerPassage>> penetrate(const Penetrator& bullet, std::span<const Layer> layers,
                                                            double angle = math::pi / 2);

}  // namespace carom::ballistics
