#include "carom/geometry/detail/passage.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carom/math/random.h"

namespace carom::geometry {
namespace {

// A ball flies through the middle of a cube that spins: seen from the cube its way is bent, and a plane of the cube
// that it stands over at both ends of its way may have let it through.
TEST(Passage, WhatSpinsLetsNothingThrough) {
  constexpr float radius = 0.05f, half = 0.25f;
  const Shape3 ball = Sphere{radius}, cube = Box{{half, half, half}};
  Random random(5);
  for (const double turn : {0.0, 0.2, 0.5, 1.0, 1.5})
    for (const double way : {1.6, 2.0, 4.0})
      for (int i = 0; i < 2000; ++i) {
        const Vec3d direction = random.on_sphere(), middle = 0.1 * random.on_sphere();
        Sweep3 flight{}, spin{};
        flight.c0 = Vec3f(middle - direction * (0.5 * way)), flight.c1 = Vec3f(middle + direction * (0.5 * way));
        spin.q0 = Quatf(random.rotation());
        spin.q1 = Quatf(Quatd{std::cos(turn / 2), std::sin(turn / 2) * random.on_sphere()}) * spin.q0;
        const float free = detail::free_fraction({ball, flight, radius, true}, cube, spin, 1.0f);
        ASSERT_LT(free, 1.0f) << "turn " << turn << ", way " << way << ", flight " << i;
        // It stops before the cube, wherever that has turned to by then.
        const Vec3f at = flight.c0 + (flight.c1 - flight.c0) * free;
        ASSERT_GT(length(at), half + radius - 1e-4f) << "turn " << turn << ", way " << way << ", flight " << i;
      }
}

// What flies by at a distance goes on, whatever spins beside its way.
TEST(Passage, WhatSpinsBesideTheWayStopsNothing) {
  const Shape3 ball = Sphere{0.05f}, cube = Box{{0.25f, 0.25f, 0.25f}};
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d direction = random.on_sphere(), beside = normalize(cross(direction, random.on_sphere()));
    Sweep3 flight{}, spin{};
    flight.c0 = Vec3f(0.5 * beside - 2.0 * direction), flight.c1 = Vec3f(0.5 * beside + 2.0 * direction);
    spin.q0 = Quatf(random.rotation());
    spin.q1 = Quatf(Quatd{std::cos(0.75), std::sin(0.75) * random.on_sphere()}) * spin.q0;
    ASSERT_EQ(detail::free_fraction({ball, flight, 0.05f, true}, cube, spin, 1.0f), 1.0f) << "flight " << i;
  }
}

}  // namespace
}  // namespace carom::geometry
