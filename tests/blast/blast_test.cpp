// Blast waves and fragments (shared reference "ballistics", 2.9). Table: Swisdak's fits, last printed digit.
#include <gtest/gtest.h>

#include "carom/blast/fragments.h"
#include "carom/blast/wave.h"
#include "carom/math/elementary.h"

namespace blast_test {
using namespace carom;
using namespace carom::blast;

TEST(Wave, SurfaceBurstTable) {
  const struct {
    double z, arrival, pressure, reflected, duration, impulse, reflected_impulse, speed, decay;
  } table[] = {{.2, .037, 17310, 185301, .243, 369.5, 10520, 3.962, 10.2951},
               {.5, .143, 4888, 39422, .281, 166.2, 2371, 2.178, 7.0932},
               {.8, .315, 2129, 14390, .818, 201.5, 1201, 1.473, 0},
               {1, .467, 1354, 8152, 1.72, 236.3, 884.7, 1.196, 8.7280},
               {1.5, .989, 551.4, 2511, 2.148, 177.4, 520.7, .808, 0},
               {2, 1.693, 283.7, 1058, 2.053, 134.6, 363.8, .623, 2.9314},
               {2.5, 2.557, 171.3, 547.3, 2.305, 107.5, 278, .532, 0},
               {3, 3.546, 115.7, 330.7, 2.819, 92.7, 224.3, .480, 1.9956},
               {4, 5.785, 64.89, 162.6, 3.436, 72.42, 161.2, .425, 0},
               {5, 8.242, 43.23, 100.9, 3.793, 59.31, 125.6, .398, 1.0606}};
  for (const auto& row : table) {
    const auto wave = blast_wave(1, row.z);
    ASSERT_TRUE(wave) << wave.error().message;
    const auto near = [&](double found, double printed, const char* what) {
      EXPECT_NEAR(found / printed, 1, 1.5e-3 + (printed < 1 ? .6e-3 / printed : 0)) << what << " at " << row.z;
    };
    near(wave->arrival * 1e3, row.arrival, "arrival");
    near(wave->pressure / 1e3, row.pressure, "pressure");
    near(wave->reflected_pressure / 1e3, row.reflected, "reflected pressure");
    near(wave->duration * 1e3, row.duration, "duration");
    near(wave->impulse, row.impulse, "impulse");
    near(wave->reflected_impulse, row.reflected_impulse, "reflected impulse");
    near(wave->front_speed / 1e3, row.speed, "speed");
    if (row.decay > 0) EXPECT_NEAR(wave->decay, row.decay, 2e-3 * row.decay);
  }
}

TEST(Wave, ScalingAndAnExample) {
  // Cube-root scaling, and 100 kg at 15 m.
  const Wave one = blast_wave(1, 1).value(), eight = blast_wave(8, 2).value();
  EXPECT_NEAR(one.pressure / 1e3, 1353.704, .001);
  EXPECT_NEAR(eight.pressure, one.pressure, 1e-9 * one.pressure);
  EXPECT_NEAR(eight.arrival / one.arrival, 2, 1e-12);
  EXPECT_NEAR(eight.reflected_impulse / one.reflected_impulse, 2, 1e-12);
  const Wave w = blast_wave(100, 15).value();
  EXPECT_NEAR(w.pressure / 1e3, 99.0295, 1e-3);
  EXPECT_NEAR(w.reflected_pressure / 1e3, 272.409, 1e-2);
  EXPECT_NEAR(w.impulse, 404.203, 1e-2);
  EXPECT_NEAR(w.reflected_impulse, 954.938, 1e-2);
  EXPECT_NEAR(w.duration * 1e3, 13.9265, 1e-3);
  EXPECT_NEAR(w.arrival * 1e3, 18.7428, 1e-3);
  // Rankine and Hugoniot agree with the fitted speed within 1 % from Z = 1 on.
  for (double z = 1; z < 10; z += .5) {
    const Wave at = blast_wave(1, z).value();
    EXPECT_NEAR(shock_speed(at.pressure) / at.front_speed, 1, .012) << z;
  }
  EXPECT_LT(blast_wave(1, 3, Burst::free_air)->pressure, blast_wave(1, 3)->pressure);
}

TEST(Wave, Friedlander) {
  EXPECT_NEAR(friedlander_decay(1, 1, .36787944), 1, 1e-6) << "b = 1: 1/e";
  const Wave w = blast_wave(10, 6).value();
  double sum = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i)
    sum += friedlander(w.pressure, w.duration, w.decay, w.duration * (i + .5) / n) * w.duration / n;
  EXPECT_NEAR(sum, w.impulse, 1e-6 * w.impulse);
  EXPECT_EQ(friedlander(1, 1, 1, -.1), 0);
  EXPECT_EQ(friedlander(1, 1, 1, 1.1), 0);
  EXPECT_EQ(friedlander_decay(1, 1, .7), 0);
}

TEST(Wave, FreeAirByKinneyAndGraham) {
  const struct {
    double z, kilopascal;
  } table[] = {{1, 1008.8}, {2, 207.9}, {10, 9.985}, {40, 2.121}};
  for (const auto& row : table)
    EXPECT_NEAR(kinney_graham_pressure(1, row.z) / 1e3, row.kilopascal, 6e-4 * row.kilopascal);
  EXPECT_NEAR(ideal_reflected_pressure(1e-3), 2e-3, 1e-9) << "weak waves double";
  EXPECT_NEAR(dynamic_pressure(101325), 2.5 * 101325.0 / 8, 1e-9);
}

TEST(Wave, DamageRisesWithPressure) {
  int before = 0;
  for (double p = 100; p < 1e6; p *= 1.1) {
    EXPECT_GE(int(damage_of(p)), before);
    before = int(damage_of(p));
  }
  EXPECT_EQ(damage_of(2e3), Damage::windows_break);
  EXPECT_STREQ(to_string(damage_of(1e6)), "lethal");
}

TEST(Wave, BadInputIsNamed) {
  EXPECT_EQ(blast_wave(0, 1).error().message, "charge is 0, expected a finite mass of TNT > 0 kg");
  EXPECT_EQ(blast_wave(1, .1).error().message,
            "0.1 m from 1 kg: scaled distance is 0.1, expected 0.2 to 40 m/kg^(1/3)");
}

TEST(Fragments, GurneyAndMott) {
  EXPECT_NEAR(gurney_speed(CaseShape::cylinder, 1), 1992.3, .1);
  EXPECT_NEAR(gurney_speed(CaseShape::cylinder, 2), 1543.2, .1);
  EXPECT_LT(gurney_speed(CaseShape::sphere, 2), gurney_speed(CaseShape::cylinder, 2));
  const auto spray = fragment_spray(.5, 1500, 20001, 7);
  ASSERT_TRUE(spray);
  ASSERT_EQ(spray->size(), 20002u);
  double mass = 0;
  math::Vec3d momentum{};
  int heavy = 0;
  for (const Fragment& f : *spray) {
    mass += f.mass;
    momentum += f.mass * f.velocity;
    EXPECT_NEAR(math::length(f.velocity), 1500, 1e-9);
    heavy += f.mass > .5 / 20002;
  }
  EXPECT_NEAR(mass, .5, 1e-12);
  EXPECT_LT(math::length(momentum), 1e-9 * .5 * 1500);
  // Of n fragments with mean 2μ, n e^{−√2} are heavier than the mean.
  EXPECT_NEAR(heavy, 20002 * math::exp(-math::sqrt(2.0)), 4 * math::sqrt(2 * 20002 * .24));
  EXPECT_NEAR(mott_count(.5, .5 / 20002 / 2, .5 / 20002), 20002 * math::exp(-math::sqrt(2.0)), 1e-6);
  EXPECT_FALSE(fragment_spray(-1, 1, 1, 1));
}

}  // namespace blast_test
