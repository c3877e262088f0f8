#include "carom/environment/earth.h"

#include "carom/math/elementary.h"

namespace carom::environment {
using math::Mat3d;
using math::Vec3d;

Vec3d to_cartesian(const Geodetic& place, const Ellipsoid& earth) {
  const double f = earth.flattening, e2 = f * (2 - f);
  const math::SinCos<double> latitude = math::sincos(place.latitude), longitude = math::sincos(place.longitude);
  const double n = earth.equatorial_radius / math::sqrt(1 - e2 * latitude.sin * latitude.sin);
  const double p = (n + place.altitude) * latitude.cos;
  return {p * longitude.cos, p * longitude.sin, (n * (1 - e2) + place.altitude) * latitude.sin};
}

Geodetic to_geodetic(Vec3d r, const Ellipsoid& earth) {
  const double a = earth.equatorial_radius, f = earth.flattening, b = a * (1 - f), e2 = f * (2 - f);
  const double second = e2 / ((1 - f) * (1 - f));  // e'²
  const double p = math::hypot(r.x, r.y);
  Geodetic place;
  place.longitude = p > 0 ? math::atan2(r.y, r.x) : 0;
  if (!(p > 0) && r.z == 0) {
    place.altitude = -a;
    return place;
  }
  double reduced = math::atan2(r.z, (1 - f) * p);
  double latitude = 0;
  for (int i = 0; i < 12; ++i) {
    const math::SinCos<double> beta = math::sincos(reduced);
    const double next =
        math::atan2(r.z + second * b * beta.sin * beta.sin * beta.sin, p - e2 * a * beta.cos * beta.cos * beta.cos);
    const math::SinCos<double> phi = math::sincos(next);
    const bool settled = i > 0 && math::abs(next - latitude) < 1e-16;
    latitude = next;
    if (settled) break;
    reduced = math::atan2((1 - f) * phi.sin, phi.cos);
  }
  const math::SinCos<double> phi = math::sincos(latitude);
  place.latitude = latitude;
  place.altitude = p * phi.cos + r.z * phi.sin - a * math::sqrt(1 - e2 * phi.sin * phi.sin);
  return place;
}

Mat3d north_east_down(double latitude, double longitude) {
  const math::SinCos<double> phi = math::sincos(latitude), lambda = math::sincos(longitude);
  return {{-phi.sin * lambda.cos, -phi.sin * lambda.sin, phi.cos},
          {-lambda.sin, lambda.cos, 0},
          {-phi.cos * lambda.cos, -phi.cos * lambda.sin, -phi.sin}};
}

Mat3d earth_rotation(double angle) {
  const math::SinCos<double> turn = math::sincos(angle);
  return {{turn.cos, turn.sin, 0}, {-turn.sin, turn.cos, 0}, {0, 0, 1}};
}

}  // namespace carom::environment
