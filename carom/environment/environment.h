// One object that is asked for everything around a body: gravity, air, wind, water and ground. The wave that is drawn
// is the wave that floats the hull, and every strip of a wing feels its own gust.
#pragma once

#include <functional>
#include <optional>

#include "carom/environment/atmosphere.h"
#include "carom/environment/frame.h"
#include "carom/environment/gravity.h"
#include "carom/environment/sea.h"
#include "carom/environment/wind_field.h"

namespace carom::environment {

/// Gravity as a field. In a world that has its own uniform gravity leave this at `none`.
struct GravityField {
  enum class Kind {
    none,
    uniform,    ///< `acceleration` everywhere
    spherical,  ///< −GM r/r³ toward `center`
    oblate,     ///< with the second zonal harmonic about `axis`
  };
  Kind kind = Kind::none;
  math::Vec3d acceleration{0, -standard_gravity, 0};  ///< m/s²
  math::Vec3d center{};                               ///< m
  math::Vec3d axis{0, 1, 0};                          ///< unit vector, of the body's turning
  double gm = earth_gm;                               ///< m³/s²
  double minimum_radius = 1;                          ///< m: inside it the pull stays as at this radius
  double equatorial_radius = 6378137;                 ///< m, a
  double j2 = 1.08262982136857e-3;
};
/// m/s².
CAROM_API math::Vec3d gravity_at(const GravityField& field, math::Vec3d point);
/// dΩ/dt = −(3/2) J₂ (a/p)² n cos i, rad/s: how an orbit of semi-major axis A (m), eccentricity e and inclination i
/// (rad) turns its node. D. A. Vallado, Fundamentals of Astrodynamics, eq. 9-37.
CAROM_API double nodal_regression(const ZonalGravity& body, double semi_major_axis, double eccentricity,
                                  double inclination);

class CAROM_API Environment {
 public:
  /// What there is. Anything left out is not there: no gravity of its own, standard air, no wind, no water, flat
  /// ground.
  struct Definition {
    GravityField gravity{};
    RotatingFrame frame{};   ///< adds its Coriolis and centrifugal forces where it turns
    AtmosphereOffset air{};  ///< the day
    double altitude = 0;     ///< m: of y = 0 above the sea, for the air
    bool vacuum = false;     ///< no air at all
    WindField wind{};
    std::optional<Sea> water{};
    double ground = 0;  ///< m: height of flat ground
    /// Height (m) of the ground at (x, z), where it is not flat; a pure function.
    std::function<double(double, double)> terrain{};
  };

  Environment() = default;
  /// Errors: what is not finite or out of range, by name.
  static core::Result<Environment> make(Definition definition);

  const Definition& definition() const { return definition_; }
  bool has_gravity() const { return definition_.gravity.kind != GravityField::Kind::none; }
  bool turns() const { return definition_.frame.rate != math::Vec3d{}; }
  bool has_wind() const { return windy_; }
  const Sea* water() const { return definition_.water ? &*definition_.water : nullptr; }

  /// Acceleration (m/s²) of the field alone, without the frame's.
  math::Vec3d gravity(math::Vec3d point) const { return gravity_at(definition_.gravity, point); }
  /// Temperature, pressure, density, speed of sound and viscosity at a point, by the formulas of the standard.
  AirState air(math::Vec3d point) const;
  /// Density and speed of sound alone, from a table: what asks often.
  AirColumn::Air thin_air(math::Vec3d point) const { return column_.at(point.y); }
  /// Velocity of the air (m/s).
  math::Vec3d wind(math::Vec3d point, double time) const {
    return windy_ ? definition_.wind.at(point, time, ground(point.x, point.z)) : math::Vec3d{};
  }
  double ground(double x, double z) const {
    return definition_.terrain ? definition_.terrain(x, z) : definition_.ground;
  }

 private:
  Definition definition_{};
  AirColumn column_{};
  bool windy_ = false;
};

}  // namespace carom::environment
