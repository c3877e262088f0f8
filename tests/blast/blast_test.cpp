// Laws of blast waves and fragments. Published numbers are in tests/published/chapter_18_wave_test.cpp.
#include <gtest/gtest.h>

#include "carom/blast/fragments.h"
#include "carom/blast/wave.h"
#include "carom/math/elementary.h"

namespace blast_test {
using namespace carom;
using namespace carom::blast;

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
