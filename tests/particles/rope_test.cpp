#include "carom/particles/rope.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"

namespace carom::particles {
namespace rope_test {

using namespace math;
using rigid::World3;
constexpr double dt = 1.0 / 60;

struct Hung {
  World3 world;
  RopeSet ropes;
  rigid::BodyId load;
  explicit Hung(double mass, RopeMaterial material, int segments = 20, double length = 2) {
    const Vec3d points[] = {{0, 0, 0}, {0, -length, 0}};
    EXPECT_EQ(ropes.add({.material = material, .points = points, .segments = segments}).value(), 0);
    ropes.attach(0, {.node = 0}, world).value();
    rigid::BodyDef<rigid::Dim3> def;
    def.position = {0, -length, 0};
    load = world.create_body(def).value();
    world.set_mass_properties(load, {mass, {}, Mat3d::diagonal({mass, mass, mass})}).value();
    ropes.attach(0, {.node = -1, .body = load}, world).value();
  }
  void step() {
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
  }
};

TEST(Rope, CarriesAThousandTimesItsWeightWithoutStretch) {
  // rigid-body.md: chain of 1 : 1000, stretch < 1 %, its peak too. Rope of .2 kg in 20 pieces of 10 g; load 10 kg a
  // thousand times a piece and again with 200 kg, a thousand times the rope.
  for (const double mass : {10.0, 200.0}) {
    Hung hung(mass, {.mass_per_length = 0.1, .axial_stiffness = 1e6});
    double worst = 0, gap = 0;
    for (int i = 0; i < 600; ++i) {
      hung.step();
      worst = max(worst, hung.ropes.length(0) / 2 - 1);
      gap = max(gap, distance(hung.world.state(hung.load)->center_of_mass, hung.ropes.positions(0).back()));
    }
    RecordProperty("stretch", std::to_string(worst));
    RecordProperty("gap", std::to_string(gap));
    EXPECT_LT(worst, 0.01) << mass;
    EXPECT_LT(gap, 0.001);
    // At rest: the load's weight, with the rope's above it, and EA's stretch of it.
    const double g = 9.80665;
    EXPECT_NEAR(hung.ropes.tensions(0).back(), mass * g, 0.01 * mass * g);
    EXPECT_NEAR(hung.ropes.tensions(0).front(), (mass + 0.2) * g, 0.01 * mass * g);
    EXPECT_NEAR(hung.ropes.length(0) / 2 - 1, (mass + 0.1) * g / 1e6, 1e-5);
  }
}

}  // namespace rope_test
}  // namespace carom::particles
