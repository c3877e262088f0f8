// Surface tension and viscosity against closed forms.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/particles/fluid.h"

namespace fluid_surface_test {
using namespace carom;
using math::pi;
using namespace carom::particles;
using rigid::Dim2;
using rigid::Dim3;

constexpr double radius = 0.01, sigma = 0.0728, rho = 1000;

/// A drop in free space, its radius drawn out by `stretch` along x and drawn in across it; ten cells to a radius in the
/// plane, six in space.
template <class D>
Fluid<D> make_drop(double stretch, float viscosity) {
  const double spacing = radius / (D::dimension == 2 ? 20 : 12);
  FluidDef<D> def;
  for (int a = 0; a < D::dimension; ++a) {
    def.lower[a] = -2 * radius;
    def.upper[a] = 2 * radius;
    def.gravity[a] = 0;
  }
  def.spacing = float(spacing);
  def.viscosity = viscosity;
  def.surface_tension = float(sigma);
  auto fluid = Fluid<D>::create(def).value();
  const double across = D::dimension == 2 ? 1 / stretch : 1 / math::sqrt(stretch);
  const int n = int(1.6 * radius / spacing);
  for (int k = D::dimension == 2 ? 0 : -n; k <= (D::dimension == 2 ? 0 : n); ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        typename D::Position p{};
        const double at[3] = {(i + .5) * spacing, (j + .5) * spacing, (k + .5) * spacing};
        double square = 0;
        for (int a = 0; a < D::dimension; ++a) {
          p[a] = at[a];
          const double scaled = at[a] / (radius * (a == 0 ? stretch : across));
          square += scaled * scaled;
        }
        if (square < 1) fluid.add_particle(p).value();
      }
  return fluid;
}
template <class D>
double second_moment(const Fluid<D>& fluid) {
  double sum = 0;
  typename D::Position middle{};
  for (int i = 0; i < fluid.size(); ++i) middle += fluid.position(i) / double(fluid.size());
  for (int i = 0; i < fluid.size(); ++i) {
    const auto p = fluid.position(i) - middle;
    sum += p.x * p.x - p.y * p.y;
  }
  return sum / fluid.size();
}
/// Of the oscillation of a drop that is let go drawn out; s, from the crossings of zero.
template <class D>
double period() {
  Fluid<D> drop = make_drop<D>(1.15, 1e-6f);
  const float dt = 1.0f / 480;
  double before = second_moment(drop), first = 0, last = 0;
  int crossings = 0;
  for (int i = 1; i < 480 && crossings < 5; ++i) {
    drop.step(dt).value();
    const double now = second_moment(drop);
    if ((now > 0) != (before > 0)) {
      last = double(dt) * (i - now / (now - before));
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  return crossings > 1 ? 2 * (last - first) / (crossings - 1) : 0;
}

TEST(FluidSurface, ADropInThePlaneOscillatesAsRayleighFound) {
  // ω² = n (n² − 1) σ/(ρ R³), n = 2 (Rayleigh 1879, the column of liquid).
  const double expected = 2 * pi / math::sqrt(6 * sigma / (rho * radius * radius * radius)), found = period<Dim2>();
  RecordProperty("share", std::to_string(found / expected));
  EXPECT_NEAR(found, expected, 0.08 * expected);
}

TEST(FluidSurface, ADropInSpaceOscillatesAsLambFound) {
  // ω² = n (n − 1)(n + 2) σ/(ρ R³), n = 2 (Lamb, Hydrodynamics, art. 275).
  const double expected = 2 * pi / math::sqrt(8 * sigma / (rho * radius * radius * radius)), found = period<Dim3>();
  RecordProperty("share", std::to_string(found / expected));
  EXPECT_NEAR(found, expected, 0.12 * expected);
}

TEST(FluidSurface, PressureWithinADropIsLaplaces) {
  Fluid2 drop = make_drop<Dim2>(1, 1e-4f);
  double sum = 0;
  int count = 0;
  for (int i = 0; i < 240; ++i) {
    drop.step(1.0f / 240).value();
    if (i < 120) continue;
    sum += double(drop.pressure({}));
    ++count;
  }
  RecordProperty("share", std::to_string(sum / count / (sigma / radius)));
  EXPECT_NEAR(sum / count, sigma / radius, 0.08 * sigma / radius);
  const double mass = double(drop.particle_mass()) * drop.size();
  EXPECT_LT(math::sqrt(2 * drop.kinetic_energy() / mass), 0.1 * math::sqrt(sigma / (rho * radius)))
      << "what stirs it by itself";
  EXPECT_LT(math::length(drop.momentum()) / mass, 1e-4);
}

TEST(FluidSurface, ASquareBecomesRound) {
  FluidDef<Dim2> def;
  def.lower = {-.02, -.02};
  def.upper = {.02, .02};
  def.gravity = {};
  def.spacing = 5e-4f;
  def.viscosity = 1e-3f;
  def.surface_tension = float(sigma);
  Fluid2 drop = Fluid2::create(def).value();
  drop.add_box({-.009, -.009}, {.009, .009}).value();
  const auto roundness = [&] {  // farthest over the radius of the same area
    double far = 0;
    for (int i = 0; i < drop.size(); ++i) far = math::max(far, math::length(drop.position(i)));
    return far / math::sqrt(drop.volume() / pi);
  };
  EXPECT_GT(roundness(), 1.2);
  for (int i = 0; i < 240; ++i) drop.step(1.0f / 240).value();
  RecordProperty("roundness", std::to_string(roundness()));
  EXPECT_LT(roundness(), 1.06);
}

TEST(FluidSurface, WithoutItNothingChangesAndTooMuchIsRefused) {
  FluidDef<Dim2> def;
  def.surface_tension = -1;
  EXPECT_FALSE(Fluid2::create(def).ok());
  def.surface_tension = 10;
  def.spacing = 1e-3f;
  def.upper = {.1, .1};
  auto fluid = Fluid2::create(def).value();
  fluid.add_box({}, {.05, .05}).value();
  const auto refused = fluid.step(1.0f / 60);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("substeps"), std::string::npos);
}

/// Rate (1/s) at which the energy of Taylor and Green's vortex in a closed box of 1 m falls.
double vortex_decay(float viscosity) {
  FluidDef<Dim2> def;
  def.gravity = {};
  def.spacing = 1.0f / 64;
  def.viscosity = viscosity;
  Fluid2 fluid = Fluid2::create(def).value();
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const double x = (i + .5) / 64, y = (j + .5) / 64;
      fluid
          .add_particle({x, y}, {float(.3 * math::sin(pi * x) * math::cos(pi * y)),
                                 float(-.3 * math::cos(pi * x) * math::sin(pi * y))})
          .value();
    }
  for (int i = 0; i < 6; ++i) fluid.step(1.0f / 60).value();
  const double before = fluid.kinetic_energy();
  for (int i = 0; i < 60; ++i) fluid.step(1.0f / 60).value();
  return math::log(before / fluid.kinetic_energy());
}
TEST(FluidSurface, ViscosityTakesFromAVortexWhatTaylorAndGreenSay) {
  // Free-slip walls: u = U sin kx cos ky stays itself, its energy falls as e^{−4νk²t} (Taylor & Green 1937), k = π/L.
  const double own = vortex_decay(0), found = vortex_decay(0.02f) - own, expected = 4 * 0.02 * pi * pi;
  RecordProperty("own", std::to_string(own));
  RecordProperty("share", std::to_string(found / expected));
  EXPECT_NEAR(found, expected, 0.1 * expected);
  EXPECT_LT(own, 0.15) << "what the scheme itself takes";
}

}  // namespace fluid_surface_test
