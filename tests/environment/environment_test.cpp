// Atmosphere, gravity, the Earth's shape, wind and water.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/environment/atmosphere.h"
#include "carom/environment/earth.h"
#include "carom/environment/gravity.h"
#include "carom/environment/water.h"
#include "carom/environment/wind.h"

namespace environment_test {
using namespace carom;
using environment::Geodetic;
using math::Vec3d;

constexpr double degree = math::pi / 180;

// U.S. Standard Atmosphere 1976, table of the shared reference "vehicles" 2A; tolerance 1e-4.
TEST(Atmosphere, StandardTable) {
  const struct {
    double h, t, p, rho, a, mu;
  } table[] = {{0, 288.150, 101325.00, 1.225000, 340.294, 1.7894e-5},
               {1000, 281.650, 89874.56, 1.111643, 336.434, 1.7578e-5},
               {2000, 275.150, 79495.20, 1.006490, 332.529, 1.7260e-5},
               {11000, 216.650, 22632.04, 0.363918, 295.069, 1.4216e-5},
               {20000, 216.650, 5474.88, 0.088035, 295.069, 1.4216e-5}};
  for (const auto& row : table) {
    const environment::AirState air = environment::standard_atmosphere_geopotential(row.h);
    EXPECT_NEAR(air.temperature, row.t, 1e-9);
    EXPECT_NEAR(air.pressure / row.p, 1, 2e-6) << row.h;
    EXPECT_NEAR(air.density / row.rho, 1, 1e-5) << row.h;
    EXPECT_NEAR(air.speed_of_sound / row.a, 1, 3e-6) << row.h;
    EXPECT_NEAR(air.viscosity / row.mu, 1, 4e-5) << row.h;
  }
}

// Bases of the layers in the standard's own table 4 (geopotential height, temperature) and pressures of its tables.
TEST(Atmosphere, LayersUpToTheTop) {
  const struct {
    double h, t, p;
  } table[] = {{32000, 228.65, 868.02}, {47000, 270.65, 110.91}, {51000, 270.65, 66.939}, {71000, 214.65, 3.9564}};
  for (const auto& row : table) {
    const environment::AirState air = environment::standard_atmosphere_geopotential(row.h);
    EXPECT_NEAR(air.temperature, row.t, 1e-9);
    EXPECT_NEAR(air.pressure / row.p, 1, 1e-4) << row.h;
  }
  EXPECT_NEAR(environment::standard_atmosphere(86000).temperature, 186.946, 1e-3);
  EXPECT_NEAR(environment::standard_atmosphere(86000).pressure / 0.37338, 1, 2e-4);
}

TEST(Atmosphere, IsContinuousAndMonotone) {
  double previous = environment::standard_atmosphere(-6000).pressure;
  for (double z = -5000; z < 200000; z += 37) {
    const double p = environment::standard_atmosphere(z).pressure;
    EXPECT_LE(p, previous);
    if (z > -4000) {
      EXPECT_NEAR(p / previous, 1, 0.01) << z;
    }
    previous = p;
  }
  for (const double h : {0.0, 11000.0, 50000.0, 84000.0})
    EXPECT_NEAR(environment::geopotential_altitude(environment::geometric_altitude(h)), h, 1e-9);
  // Hydrostatic balance dp/dz = −ρ g(z), the law behind the table.
  for (const double z : {500.0, 9000.0, 15000.0, 26000.0, 40000.0, 49000.0, 60000.0, 80000.0}) {
    const double slope =
        (environment::standard_atmosphere(z + 1).pressure - environment::standard_atmosphere(z - 1).pressure) / 2;
    const double weight =
        environment::standard_atmosphere(z).density * environment::gravity_at_height(z, 9.80665, 6356766);
    EXPECT_NEAR(slope / -weight, 1, 1e-6) << z;
  }
}

TEST(Atmosphere, OtherDays) {
  const environment::AirState hot =
      environment::standard_atmosphere(0, {.temperature = 15, .sea_level_pressure = 100000});
  EXPECT_NEAR(hot.temperature, 303.15, 1e-12);
  EXPECT_NEAR(hot.density, 100000 / (287.05287 * 303.15), 1e-12);
}

// Damp air beside the formula of metrologists, CIPM-2007 (A. Picard et al., Metrologia 45 (2008) 149), 400 ppm CO₂:
// within 4e-4, most of it that real air is not quite ideal.
TEST(Atmosphere, DampAirBesideCipm2007) {
  const auto cipm = [](double kelvin, double p, double humidity) {
    const double t = kelvin - 273.15;
    const double saturation =
        std::exp(1.2378847e-5 * kelvin * kelvin - 1.9121316e-2 * kelvin + 33.93711047 - 6.3431645e3 / kelvin);
    const double x = humidity * (1.00062 + 3.14e-8 * p + 5.6e-7 * t * t) * saturation / p;
    const double z = 1 -
                     p / kelvin *
                         (1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t * t + (5.707e-6 - 2.051e-8 * t) * x +
                          (1.9898e-4 - 2.376e-6 * t) * x * x) +
                     p * p / (kelvin * kelvin) * (1.83e-11 - 0.765e-8 * x * x);
    return p * 28.96546e-3 / (z * 8.314472 * kelvin) * (1 - x * (1 - 18.01528e-3 / 28.96546e-3));
  };
  for (const double celsius : {0.0, 15.0, 25.0, 35.0})
    for (const double humidity : {0.0, 0.5, 1.0}) {
      const environment::AirState air =
          environment::standard_atmosphere(0, {.temperature = celsius - 15, .relative_humidity = humidity});
      EXPECT_NEAR(air.density / cipm(celsius + 273.15, 101325, humidity), 1, 7e-4) << celsius << " " << humidity;
    }
  // Damp air carries sound faster: 20 °C, dry 343.2 m/s (Cramer 1993: 343.37 dry, 344.5 saturated).
  EXPECT_NEAR(environment::standard_atmosphere(0, {.temperature = 5}).speed_of_sound, 343.2, 0.05);
  EXPECT_NEAR(environment::standard_atmosphere(0, {.temperature = 5, .relative_humidity = 1}).speed_of_sound, 344.6,
              0.3);
}

TEST(Gravity, ZonalFieldIsTheGradientOfItsPotential) {
  const environment::ZonalGravity body;
  const auto potential = [&](Vec3d r) {
    const double d = math::length(r), s = r.z / d;
    return body.gm / d * (1 - body.j2 * math::square(body.radius / d) * (3 * s * s - 1) / 2);
  };
  for (const Vec3d r : {Vec3d{7e6, 0, 0}, Vec3d{0, 0, 6.5e6}, Vec3d{3e6, -4e6, 5e6}}) {
    const Vec3d g = environment::zonal_gravity(r, body);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d step{};
      step[axis] = 100;
      EXPECT_NEAR(g[axis], (potential(r + step) - potential(r - step)) / 200, 1e-8);
    }
  }
  EXPECT_TRUE(math::is_finite(environment::zonal_gravity({})));
  const Vec3d inside = environment::spherical_gravity(Vec3d{0.5, 0, 0}, 9.0, 3.0);
  EXPECT_NEAR(inside.x, -1, 1e-15) << "held at the minimum radius";
}

// NIMA TR8350.2: polar radius 6356752.3142 m; a known point of the ellipsoid at 45°.
TEST(Earth, GeodeticCoordinates) {
  EXPECT_NEAR(environment::to_cartesian({90 * degree, 0, 0}).z, 6356752.3142, 1e-4);
  EXPECT_NEAR(environment::to_cartesian({0, 0, 0}).x, 6378137, 1e-9);
  for (int i = -18; i <= 18; ++i)
    for (const double h : {-1e5, -4000.0, 0.0, 400.0, 35786e3, 4e8})
      for (const double lambda : {-3.1, 0.0, 1.2}) {
        const Geodetic place{5 * i * degree, lambda, h};
        const Geodetic back = environment::to_geodetic(environment::to_cartesian(place));
        EXPECT_NEAR(back.latitude, place.latitude, 1e-14 + (h > 1e8 ? 1e-15 : 0)) << 5 * i << " " << h;
        if (i > -18 && i < 18) {
          EXPECT_NEAR(back.longitude, lambda, 1e-14);
        }
        EXPECT_NEAR(back.altitude, h, 3e-9 + 1e-15 * std::abs(h)) << 5 * i << " " << h;
      }
  EXPECT_TRUE(math::is_finite(environment::to_geodetic({}).altitude));
}

TEST(Earth, LocalAxes) {
  const math::Mat3d ned = environment::north_east_down(40 * degree, -70 * degree);
  EXPECT_NEAR(math::determinant(ned), 1, 1e-15);
  const Vec3d at = environment::to_cartesian({40 * degree, -70 * degree, 0}),
              higher = environment::to_cartesian({40 * degree, -70 * degree, 1000}),
              north = environment::to_cartesian({40.0001 * degree, -70 * degree, 0});
  EXPECT_LT(math::distance((higher - at) / 1000.0, -ned.cz), 1e-9);
  EXPECT_LT(math::distance(math::normalize(north - at), ned.cx), 1e-6);
  const Vec3d turned = environment::earth_rotation(math::pi / 2) * Vec3d{1, 0, 0};
  EXPECT_LT(math::distance(turned, Vec3d{0, 1, 0}), 1e-15);
}

TEST(Wind, Profiles) {
  environment::Wind wind{.velocity = {10, 0, 2}};
  EXPECT_EQ(environment::wind_at(wind, 500).x, 10);
  wind.profile = environment::WindProfile::power;
  EXPECT_NEAR(environment::wind_at(wind, 80).x, 10 * std::pow(8, 1.0 / 7), 1e-12);
  EXPECT_EQ(environment::wind_at(wind, 0).x, 0);
  wind.profile = environment::WindProfile::logarithmic;
  EXPECT_NEAR(environment::wind_at(wind, 10).x, 10, 1e-13);
  EXPECT_NEAR(environment::wind_at(wind, 100).z, 2 * std::log(100 / 0.03) / std::log(10 / 0.03), 1e-13);
  EXPECT_EQ(environment::wind_at(wind, -3).x, 0);
}

TEST(Water, FlatWater) {
  const environment::Water water{.level = 2, .current = {1, 0, 0}};
  const environment::WaterPoint at = environment::sample(water, {5, -3, 1}, 7);
  EXPECT_EQ(at.height, 2);
  EXPECT_EQ(at.normal, (Vec3d{0, 1, 0}));
  EXPECT_EQ(at.velocity, (Vec3d{1, 0, 0}));
}

// Airy's deep-water wave: it travels at √(g/k); normal, velocity and acceleration are the derivatives of height and of
// each other; the flow has neither divergence nor rotation.
TEST(Water, WavesObeyTheirEquations) {
  const double s = std::sqrt(0.5);
  const environment::Wave waves[2] = {{0.5, 40, 0.3, 1, 0}, {0.2, 15, 1.1, s, s}};
  environment::Water water{.level = 1, .waves = waves};
  const double h = 1e-4, t = 3.3;
  const Vec3d p{7, -2, 4};
  const environment::WaterPoint at = environment::sample(water, p, t);
  EXPECT_NEAR(at.height, environment::surface_height(water, p.x, p.z, t), 1e-15);
  const double dx =
      (environment::surface_height(water, p.x + h, p.z, t) - environment::surface_height(water, p.x - h, p.z, t)) /
      (2 * h);
  EXPECT_NEAR(-at.normal.x / at.normal.y, dx, 1e-8);
  const auto velocity = [&](Vec3d q, double time) { return environment::sample(water, q, time).velocity; };
  const Vec3d ddx = (velocity(p + Vec3d{h, 0, 0}, t) - velocity(p - Vec3d{h, 0, 0}, t)) / (2 * h);
  const Vec3d ddy = (velocity(p + Vec3d{0, h, 0}, t) - velocity(p - Vec3d{0, h, 0}, t)) / (2 * h);
  const Vec3d ddz = (velocity(p + Vec3d{0, 0, h}, t) - velocity(p - Vec3d{0, 0, h}, t)) / (2 * h);
  EXPECT_NEAR(ddx.x + ddy.y + ddz.z, 0, 1e-8);
  EXPECT_NEAR(ddx.y - ddy.x, 0, 1e-8);
  EXPECT_NEAR(ddz.y - ddy.z, 0, 1e-8);
  EXPECT_LT(math::distance((velocity(p, t + h) - velocity(p, t - h)) / (2 * h), at.acceleration), 1e-8);
  // At the mean level the water rises as the surface does.
  const double rise =
      (environment::surface_height(water, p.x, p.z, t + h) - environment::surface_height(water, p.x, p.z, t - h)) /
      (2 * h);
  EXPECT_NEAR(velocity({p.x, water.level, p.z}, t).y, rise, 1e-8);
  // One wave alone comes back to itself after a wavelength of travel.
  water.waves = std::span(waves, 1);
  const double period = 2 * math::pi / environment::wave_frequency(40);
  EXPECT_NEAR(environment::wave_speed(40) * period, 40, 1e-12);
  EXPECT_NEAR(environment::surface_height(water, 3 + environment::wave_speed(40) * 2, 0, 2),
              environment::surface_height(water, 3, 0, 0), 1e-13);
}

}  // namespace environment_test
