// The shape and the turning of the Earth: geodetic coordinates and local frames.
#pragma once

#include "carom/export.h"
#include "carom/math/mat.h"

namespace carom::environment {

/// An ellipsoid of revolution about z.
struct Ellipsoid {
  double equatorial_radius = 6378137.0;     ///< m
  double flattening = 1.0 / 298.257223563;  ///< 0: a sphere
  double rotation_rate = 7.292115e-5;       ///< rad/s, eastward about z
};
/// NIMA TR8350.2.
inline constexpr Ellipsoid wgs84{};

struct Geodetic {
  double latitude = 0;   ///< rad, north
  double longitude = 0;  ///< rad, east, in (−π, π]
  double altitude = 0;   ///< m above the ellipsoid
};

/// Cartesian coordinates fixed to the Earth (m): x through latitude 0, longitude 0, z through the north pole.
CAROM_API math::Vec3d to_cartesian(const Geodetic& place, const Ellipsoid& earth = wgs84);
/// The inverse; to 1e-9 m from −1000 km to 10⁷ km (Bowring's iteration to convergence). The centre has latitude 0.
CAROM_API Geodetic to_geodetic(math::Vec3d position, const Ellipsoid& earth = wgs84);

/// Axes north, east, down at a place, as the columns of a matrix: local → Earth-fixed.
CAROM_API math::Mat3d north_east_down(double latitude, double longitude);

/// Rotation about z by the angle (rad): Earth-fixed → inertial after the Earth has turned by it.
CAROM_API math::Mat3d earth_rotation(double angle);

}  // namespace carom::environment
