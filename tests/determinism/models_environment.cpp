#include "carom/environment/environment.h"
#include "carom/environment/sea_patch.h"
#include "carom/forces/added_mass.h"
#include "carom/forces/drag_law.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

void environment_models(int width) {
  using math::Vec3d;
  core::StateHash hash;
  const auto hash_vector = [&](Vec3d v) { hash.add(v.x).add(v.y).add(v.z); };

  environment::SeaDef def{.spectrum = environment::fetch_limited_sea(15, 80e3), .direction = 0.4, .seed = 9};
  const environment::Sea sea = environment::Sea::make({.depth = 25, .current = {0.5, 0, -0.2}}, def).value();
  for (int i = 0; i < 100; ++i) {
    const environment::SeaPoint p =
        sea.sample({3.1 * i, -0.1 * i, 70.0 - i}, 0.37 * i, environment::disc_footprint(0.02 * i));
    hash.add(p.height).add(p.pressure);
    hash_vector(p.normal), hash_vector(p.velocity), hash_vector(p.acceleration);
  }
  std::vector<double> grid(40 * 30);
  sea.grid(-50, 20, 2.5, 40, 30, 123.4, grid);
  for (const double y : grid) hash.add(y);
  std::vector<float> x, z;
  for (int i = 0; i < 101; ++i) x.push_back(1.7f * float(i) - 80), z.push_back(40 - 0.9f * float(i));
  std::vector<float> height(x.size()), slope_x(x.size()), slope_z(x.size());
  environment::SeaPatch(sea, {1e5, -2e5}, 7000, width).heights(x, z, height, slope_x, slope_z);
  for (std::size_t i = 0; i < x.size(); ++i) hash.add(height[i]).add(slope_x[i]).add(slope_z[i]);
  print_model("sea", hash);

  hash = {};
  environment::Environment::Definition d;
  d.wind.mean = {.velocity = {9, 0, 3}, .profile = environment::WindProfile::logarithmic};
  for (const auto kind : {environment::TurbulenceSpectrum::dryden, environment::TurbulenceSpectrum::von_karman}) {
    d.wind.turbulence = environment::Turbulence::make({.spectrum = kind,
                                                       .scales = environment::low_altitude_turbulence(80, 15),
                                                       .mean_wind = {9, 0, 3},
                                                       .seed = 21})
                            .value();
    d.wind.gusts = {{.velocity = {0, 6, 0}, .front = 20, .speed = 9}};
    d.wind.thermals = {environment::thermal_of_day({100, 0, 50}, 2, 1200)};
    d.wind.obstacles = {{.center = {-30, 10, 0}, .area = 150}};
    d.wind.wakes = {{.point = {0, 120, 40}}};
    d.gravity.kind = environment::GravityField::Kind::oblate;
    d.gravity.center = {0, -6378137, 0};
    d.air = {.temperature = 12, .relative_humidity = 0.6};
    const environment::Environment here = environment::Environment::make(d).value();
    for (int i = 0; i < 60; ++i) {
      const Vec3d p{5.0 * i - 100, 3.0 * i + 1, 40.0 - i};
      hash_vector(here.wind(p, 0.21 * i)), hash_vector(here.gravity(p));
      const environment::AirState air = here.air(p);
      hash.add(air.density).add(air.speed_of_sound).add(air.viscosity);
    }
  }
  print_model("wind_field", hash);

  hash = {};
  for (double re = 0.01; re < 1e8; re *= 1.7) {
    hash.add(forces::sphere_drag(re, 1e-6 * re)).add(forces::cylinder_drag(re)).add(forces::disc_drag(re));
    hash.add(forces::plate_friction(re));
  }
  const forces::AddedShares shares = forces::ellipsoid_added_mass({3, 1.5, 0.7});
  hash_vector(shares.linear), hash_vector(shares.angular);
  print_model("drag_and_added_mass", hash);
}

}  // namespace carom::determinism
