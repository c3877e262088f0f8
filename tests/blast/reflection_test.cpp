// Shocks on the ground: the limits of theory, the change from regular to Mach reflection.
#include "carom/blast/reflection.h"

#include <gtest/gtest.h>

#include "carom/blast/explosion.h"
#include "carom/math/elementary.h"

namespace blast_reflection_test {
using namespace carom;

constexpr double atmosphere = 101325, degree = math::pi / 180;
blast::ShockReflection at(double excess, double degrees) {
  return blast::reflect(excess * atmosphere, degrees * degree).value();
}

// Square on: 2 in the acoustic limit, (3γ − 1)/(γ − 1) = 8 of a strong shock, and between them the closed form.
TEST(Reflection, SquareOn) {
  EXPECT_NEAR(at(2e-3, 0).factor, 2, 2e-3);
  EXPECT_NEAR(at(1e7, 0).factor, 8, 1e-5);
  for (const double excess : {0.1, 1.0, 10.0, 100.0}) {
    const double expected = blast::ideal_reflected_pressure(excess * atmosphere) / (excess * atmosphere);
    EXPECT_NEAR(at(excess, 0).factor, expected, 1e-9);
    EXPECT_NEAR(at(excess, 1).factor, expected, 2e-3 * expected) << "and the oblique theory goes on from there";
  }
}

// Sound reflects twofold at any angle but the last.
TEST(Reflection, Sound) {
  for (const double angle : {10.0, 30.0, 50.0}) {
    const auto r = at(1e-3, angle);
    EXPECT_FALSE(r.mach);
    EXPECT_NEAR(r.factor, 2, 0.01);
  }
}

// Detachment in air: 39.97° of strong shocks (J. von Neumann, Oblique reflection of shocks, 1943; 39.23° is its least,
// near P_s/P₀ of 6), more than 45° only below Mach 1.3, toward 90° for sound.
TEST(Reflection, TheGreatestAngleOfRegularReflection) {
  const auto angle = [](double excess) { return blast::greatest_regular_incidence(excess * atmosphere) / degree; };
  EXPECT_NEAR(angle(1e7), 39.97, 0.01);
  EXPECT_GT(angle(6), 39.1);
  EXPECT_LT(angle(6), 39.4);
  EXPECT_NEAR(angle(1), 42, 1);
  EXPECT_GT(angle(0.05), 65);
  EXPECT_GT(angle(1e-3), 80);
  for (const double excess : {0.05, 0.7, 6.0, 1e3}) {
    const double limit = angle(excess);
    EXPECT_FALSE(at(excess, limit - 0.01).mach);
    EXPECT_TRUE(at(excess, limit + 0.01).mach);
    EXPECT_LE(at(excess, limit + 0.01).factor, at(excess, limit - 0.01).factor * 1.03);
  }
}

// A strong shock's stem, by three-shock theory with a straight stem: the triple point's path rises, and the
// overpressure falls from 2.32 at 45° toward that of the incident shock along the ground.
TEST(Reflection, TheStem) {
  EXPECT_NEAR(at(1e6, 45).factor, 2.325, 2e-3);
  EXPECT_NEAR(at(1e6, 45).stem_angle / degree, 4.15, 0.01);
  EXPECT_NEAR(at(1e6, 60).factor, 1.568, 2e-3);
  // The same conditions by hand: the stem runs along the ground by cos χ/sin(α − χ) faster than the incident shock.
  const auto s = at(1e6, 60);
  EXPECT_NEAR(math::sqrt(s.factor), math::cos(s.stem_angle) / math::sin(60 * degree - s.stem_angle), 1e-4);
  for (const double excess : {0.01, 0.1, 0.7, 3.5, 100.0}) {
    double before = 100, bend = 0;
    for (double angle = blast::greatest_regular_incidence(excess * atmosphere) / degree + 0.1; angle < 90;
         angle += 0.5) {
      const auto r = at(excess, angle);
      EXPECT_LE(r.factor, before * 1.1) << excess << " " << angle;  // theories meet to 10 %
      EXPECT_GE(r.factor, 1);
      EXPECT_GE(r.stem_angle, 0);
      bend = math::max(bend, math::abs(r.factor - before));
      before = r.factor;
    }
    EXPECT_NEAR(before, 1, 0.06);
    EXPECT_EQ(at(excess, 90).factor, 1);
  }
}

TEST(Reflection, Refusals) {
  EXPECT_FALSE(blast::reflect(0, 1).ok());
  EXPECT_FALSE(blast::reflect(1e5, 2).ok());
  EXPECT_FALSE(blast::reflect(1e5, 1, 0).ok());
}

blast::Explosion3 over_ground(double height, double mass = 10) {
  return blast::Explosion3::make({.position = {0, height, 0}, .mass = mass, .burst = blast::Burst::air}).value();
}
/// The greatest pressure at a place.
double peak(const blast::Explosion3& e, math::Vec3d place) {
  double most = 0;
  const auto waves = e.waves_at(place);
  for (int k = 0; k < waves.count; ++k) most = math::max(most, e.pressure_at(place, waves.wave[k].arrival + 1e-9));
  return most;
}

TEST(AirBurst, ThePeakOnTheGround) {
  const double height = 5;
  const blast::Explosion3 e = over_ground(height);
  for (const double along : {0.0, 2.0, 4.0}) {  // regular: both waves together, as theory has it
    const double slant = math::hypot(height, along), incident = e.wave_at(slant).pressure;
    const auto r = blast::reflect(incident, math::atan2(along, height)).value();
    ASSERT_FALSE(r.mach) << along;
    EXPECT_NEAR(peak(e, {along, 0, 0}), r.factor * incident, 5e-3 * r.factor * incident) << along;
    EXPECT_EQ(e.stem_height(along), 0);
  }
  EXPECT_NEAR(peak(e, {}), blast::ideal_reflected_pressure(e.wave_at(height).pressure), 1e-3 * peak(e, {}));
  double before = 0;
  for (const double along : {7.0, 10.0, 15.0, 25.0, 40.0}) {  // the stem: one wave along the ground
    const double slant = math::hypot(height, along), incident = e.wave_at(slant).pressure;
    const auto r = blast::reflect(incident, math::atan2(along, height)).value();
    ASSERT_TRUE(r.mach) << along;
    const double on_ground = blast::blast_wave(10, slant).value().pressure;
    const double expected = math::max(r.factor * incident, on_ground);
    EXPECT_NEAR(peak(e, {along, 0, 0}), expected, 0.02 * expected) << along;
    EXPECT_GT(e.stem_height(along), before);
    before = e.stem_height(along);
    const auto waves = e.waves_at({along, 0.5 * before, 0});
    EXPECT_EQ(waves.count, 1);
    EXPECT_NEAR(waves.toward[0].x, -1, 1e-12) << "it stands upright";
  }
  // The wave of the ground comes as much later as its way is longer: between two of the wave's arrivals.
  const math::Vec3d high{4, 3, 0};
  const auto waves = e.waves_at(high);
  ASSERT_EQ(waves.count, 2);
  EXPECT_NEAR(waves.wave[1].arrival, e.wave_at(math::hypot(4.0, 8.0)).arrival, 1e-12);
  EXPECT_NEAR(waves.toward[1].y, -8 / math::hypot(4.0, 8.0), 1e-12) << "from below";
}

TEST(AirBurst, NearTheGroundItIsAChargeOnIt) {
  const blast::Explosion3 low = over_ground(0.02);
  for (const double along : {4.0, 10.0, 30.0}) {
    const double expected = blast::blast_wave(10, along).value().pressure;
    EXPECT_NEAR(peak(low, {along, 0, 0}), expected, 0.01 * expected);
  }
}

// Hopkinson and Cranz: eight times the charge at twice the height and distance.
TEST(AirBurst, Scales) {
  const blast::Explosion3 e = over_ground(4, 1), twice = over_ground(8, 8);
  for (const double along : {1.0, 3.0, 8.0, 20.0}) {
    EXPECT_NEAR(peak(twice, {2 * along, 0, 0}), peak(e, {along, 0, 0}), 1e-6 * peak(e, {along, 0, 0}));
    EXPECT_NEAR(twice.stem_height(2 * along), 2 * e.stem_height(along), 1e-6 * (1 + e.stem_height(along)));
  }
}

// A box under it is pressed down by the ground's reflection on its top, and pushed away by the stem farther out.
TEST(AirBurst, PushesWhatStandsOnTheGround) {
  for (const double along : {0.0, 12.0}) {
    const auto push = [along](blast::Burst burst) {
      rigid::World3 world({.gravity = {}});
      rigid::BodyDef<rigid::Dim3> box;
      box.position = {along, 0.5, 0};
      const rigid::BodyId body = world.create_body(box).value();
      EXPECT_TRUE(world.add_shape(body, geometry::Box{{0.5f, 0.5f, 0.5f}}, {.density = 500}).ok());
      blast::Explosion3 e = blast::Explosion3::make({.position = {0, 5, 0}, .mass = 10, .burst = burst}).value();
      while (!e.finished(world.time())) {
        EXPECT_TRUE(e.apply(world, 1.0 / 240).ok());
        EXPECT_TRUE(world.step(1.0f / 240).ok());
      }
      return e.impulse_given();
    };
    const math::Vec3d with = push(blast::Burst::air), without = push(blast::Burst::free_air);
    if (along == 0) {
      EXPECT_LT(without.y, 0);
      EXPECT_LT(math::abs(with.x), 1e-3 * math::abs(without.y));
    } else {
      EXPECT_GT(with.x, 1.2 * without.x);
    }
  }
}

TEST(AirBurst, Refusals) {
  EXPECT_FALSE(blast::Explosion3::make({.position = {0, 1, 0}, .burst = blast::Burst::air, .ground = 1}).ok());
}

}  // namespace blast_reflection_test
