// A leader's fall, and ropes that are longer than their way.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/particles/rope.h"
#include "tests/particles/weightless.h"

namespace carom::particles {
namespace lead_fall_test {

using namespace math;
using rigid::BodyId;
using rigid::Dim3;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

// A leader falls past the last anchor into a rope of length L: without damping the greatest force is
// F = m g + √((m g)² + 2 m g EA f), f the height of the fall over L (Wexler, Am. Alpine Journal 7 (1950) 379).
TEST(LeadFall, PeakIsThatOfTheFallFactor) {
  const double mass = 80, stiffness = 9.8e3, rope_length = 3;
  for (const double factor : {0.4, 1.0, 1.5, 1.8}) {
    World3 world;
    RopeSet ropes;
    const double above = factor * rope_length - rope_length;
    const Vec3d start{0, above, 0}, aside{0.5 * sqrt(rope_length * rope_length - above * above), 0.5 * above, 0};
    rigid::BodyDef<Dim3> def;
    def.position = start;
    const BodyId climber = world.create_body(def).value();
    world.set_mass_properties(climber, {mass, {}, Mat3d::diagonal({5, 5, 5})}).value();
    const Vec3d way[] = {{0, 0, 0}, aside, start};
    RopeMaterial rope{.mass_per_length = 0.064,
                      .radius = 0.005,
                      .axial_stiffness = stiffness,
                      .bending_stiffness = 0.002,
                      .drag_coefficient = 0,
                      .skin_coefficient = 0};
    ropes.add({.material = rope, .points = way, .segments = 24, .length = rope_length, .collide = false}).value();
    ropes.attach(0, {.node = 0}, world).value();
    ropes.attach(0, {.node = -1, .body = climber}, world).value();
    double peak = 0, anchor = 0;
    for (int i = 0; i < 180; ++i) {
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
      peak = max(peak, ropes.peak_tension(0));
      anchor = max(anchor, length(ropes.attachment_force(0, 0)));
    }
    const double weight = mass * g, expected = weight + sqrt(weight * weight + 2 * weight * stiffness * factor);
    RecordProperty("peak_over_expected_" + std::to_string(int(10 * factor)), std::to_string(peak / expected));
    RecordProperty("anchor_over_expected_" + std::to_string(int(10 * factor)), std::to_string(anchor / expected));
    EXPECT_NEAR(peak, expected, 0.05 * expected) << factor;
    EXPECT_NEAR(anchor, expected, 0.05 * expected) << factor;
  }
}

TEST(LeadFall, RopeThatIsLongerThanItsWayLiesInFolds) {
  // Laid a quarter shorter than it is: as a strut it would hold ½ EA ε² L = 920 J and fly apart.
  World3 world = weightless();
  const Vec3d way[] = {{0, 0, 0}, {0.4, 0, 0}, {0.4, 1.5, 0}, {0, 1.5, 0}};
  for (const int segments : {24, 25}) {
    RopeSet ropes;
    ropes
        .add({.material =
                  {.mass_per_length = 0.064, .radius = 0.005, .axial_stiffness = 9.8e3, .bending_stiffness = 0.002},
              .points = way,
              .segments = segments,
              .length = 3})
        .value();
    EXPECT_NEAR(ropes.length(0), 3, 0.06);
    EXPECT_LT(ropes.elastic_energy(), 25);
    for (int i = 0; i < 60; ++i) {
      ropes.step(world, dt).value();
      EXPECT_LT(ropes.peak_tension(0), 1000);
    }
  }
}

}  // namespace lead_fall_test
}  // namespace carom::particles
