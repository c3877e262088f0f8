// Small bodies that come at a taut rope at 20 to 400 m/s, from any side: the rope meets every one of them within the
// step, goes through none, and takes what it gives.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/particles/rope.h"
#include "tests/particles/flung.h"

namespace rope_fast_test {
using namespace carom;
using math::Vec3d;
using math::Vec3f;
using namespace carom::particles;
using rigid::BodyId;
using rigid::Dim3;
using rigid::World3;

constexpr double half_length = 1, segment = 0.05, radius = 0.005;

/// A rope along x of 2 m, held at its ends.
RopeSet taut_rope(const World3& world, double pull, double stiffness, int substeps = 8) {
  RopeSet ropes;
  const Vec3d points[] = {{-half_length, 0, 0}, {half_length, 0, 0}};
  ropes.set_substeps(substeps).value();
  ropes
      .add({.material = {.mass_per_length = 0.05,
                         .radius = radius,
                         .axial_stiffness = stiffness,
                         .drag_coefficient = 0,
                         .skin_coefficient = 0},
            .points = points,
            .segments = int(2 * half_length / segment + 0.5),
            .length = 2 * half_length / (1 + pull / stiffness),
            .touch = RopeTouch::none})
      .value();
  for (const int end : {0, -1}) ropes.attach(0, {.node = end, .point = points[end == 0 ? 0 : 1]}, world).value();
  return ropes;
}

/// A body whose middle flies through the rope's line at a distance `off` from it.
struct Shot {
  geometry::Shape3 shape{};
  double size = 0.1;  ///< m, to its nearest side
  double mass = 1, speed = 100, off = 0;
  Vec3d perpendicular{}, aside{};  ///< to the rope
  BodyId body{};
};

Shot fling(World3& world, math::Random& random, int kind, double mass, double most_off, double dt) {
  Shot shot;
  shot.size = 0.01 * math::exp(random.uniform(0.0, math::log(10.0)));
  shot.speed = 20 * math::exp(random.uniform(0.0, math::log(20.0)));
  shot.mass = mass > 0 ? mass : 300 * 8 * shot.size * shot.size * shot.size;
  shot.off = random.uniform(-most_off, most_off) * shot.size;
  shot.shape = flung_shape(kind, shot.size);
  const double roll = random.uniform(0.0, 2 * math::pi), slant = random.uniform(-0.8, 0.8);
  shot.perpendicular = {0, math::cos(roll), math::sin(roll)};
  const Vec3d way = math::cos(slant) * shot.perpendicular + Vec3d{math::sin(slant), 0, 0};
  shot.aside = normalize(cross(way, Vec3d{1, 0, 0}));
  const Vec3d position = Vec3d{random.uniform(-0.4, 0.4), 0, 0} -
                         (0.3 + random.uniform(0.0, 1.0) * shot.speed * dt) * way + shot.off * shot.aside;
  shot.body = fling_body(world, random, kind, shot.shape, shot.mass, position, shot.speed * way);
  return shot;
}

struct Told {
  double loss = 0;        ///< m/s along the way, of the body where it was beyond the rope or at the end
  bool beyond = false;    ///< the rope was behind it at the end of a step
  double side = 0;        ///< m, then: how far aside of the rope
  double nearest = 1e30;  ///< m, at the end of any step: from the body's middle to the rope's line
};

Told follow(World3& world, RopeSet& ropes, const Shot& shot, double dt, double seconds) {
  Told told;
  for (double t = 0; t < seconds && !told.beyond; t += dt) {
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
    const auto state = world.state(shot.body).value();
    const Vec3d c = state.center_of_mass;
    if (math::abs(c.x) > 0.9 * half_length) break;  // off along the rope
    const auto points = ropes.positions(0);
    double nearest = 1e30;
    Vec3d at{};
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Vec3d d = points[i + 1] - points[i];
      const double share = math::clamp(dot(c - points[i], d) / length_squared(d), 0.0, 1.0);
      const Vec3d p = lerp(points[i], points[i + 1], share);
      if (distance(p, c) < nearest) nearest = distance(p, c), at = p;
    }
    told.nearest = math::min(told.nearest, nearest);
    told.beyond = dot(c, shot.perpendicular) > 0 && dot(c - at, shot.perpendicular) > 0.3 * shot.size;
    told.side = dot(c - at, shot.aside);
    told.loss = shot.speed - dot(Vec3d(state.linear_velocity), shot.perpendicular) /
                                 math::max(1e-9, dot(shot.perpendicular, shot.perpendicular));
  }
  return told;
}

// What is light and comes at its middle is thrown back or caught, whatever its shape and however its step begins.
TEST(RopeFast, LightBodiesAreThrownBack) {
  constexpr double dt = 1.0 / 60;
  math::Random random(41);
  int shots = 0, beyond = 0;
  for (int kind = 0; kind < 2; ++kind)
    for (int i = 0; i < shots_of(150); ++i) {
      World3 world({.gravity = {0, 0, 0}});
      const Shot shot = fling(world, random, kind, 0.002, 0, dt);
      RopeSet ropes = taut_rope(world, 1e4, 1e6);
      const Told told = follow(world, ropes, shot, dt, (0.3 + shot.speed * dt) / shot.speed + 6 * dt);
      ++shots;
      // A box that turns may slip off with an edge: then it is far beside the rope.
      if (!told.beyond) continue;
      ++beyond;
      EXPECT_GT(math::abs(told.side), shot.size)
          << kind << ' ' << i << ": " << shot.size << " m, " << shot.speed << " m/s";
    }
  EXPECT_LT(beyond, shots / 40);
  RecordProperty("beyond", beyond);
}

// Heavy and light, up to a third of their size off the rope's line, of every kind of shape: each is met in the step in
// which it comes, and who slips off does so on the side on which it came.
TEST(RopeFast, NonePasses) {
  for (const auto& [dt, substeps] : {std::pair{1.0 / 60, 8}, {1.0 / 60, 1}, {1.0 / 30, 8}, {1.0 / 240, 8}}) {
    math::Random random(7);
    for (int kind = 0; kind < 5; ++kind)
      for (const double mass : {0.0, 0.01, 0.3})
        for (int i = 0; i < shots_of(kind < 2 ? 40 : 15); ++i) {
          World3 world({.gravity = {0, 0, 0}});
          const Shot shot = fling(world, random, kind, mass, 0.35, dt);
          RopeSet ropes = taut_rope(world, 1000, 1e5, substeps);
          const Vec3d before(world.state(shot.body)->linear_velocity);
          const Told told = follow(world, ropes, shot, dt, (0.3 + shot.speed * dt) / shot.speed + 4 * dt);
          const Vec3d change = Vec3d(world.state(shot.body)->linear_velocity) - before;
          const auto what = [&] {
            return testing::Message() << "kind " << kind << ", number " << i << ": " << shot.size << " m, " << shot.mass
                                      << " kg, " << shot.speed << " m/s, " << substeps << " substeps of 1/" << 1 / dt;
          };
          EXPECT_GT(length(change), 1e-4 * shot.speed) << what() << " is not met";
          if (kind == 0 && told.beyond) {
            EXPECT_GT(told.side * shot.off, 0) << what() << " goes through";
            EXPECT_GT(told.nearest, 0.1 * shot.size) << what();
          }
        }
  }
}

// What the body loses the rope has or what holds its ends has taken: of a rope that flies freely, all of it.
TEST(RopeFast, MomentumIsKept) {
  constexpr double dt = 1.0 / 60;
  math::Random random(23);
  for (int kind = 0; kind < 5; ++kind)
    for (int i = 0; i < shots_of(12); ++i) {
      World3 world({.gravity = {0, 0, 0}});
      const Shot shot = fling(world, random, kind, i % 2 == 0 ? 0.02 : 0.5, 0.3, dt);
      RopeSet ropes = taut_rope(world, 1000, 1e5);
      for (const int end : {0, -1}) ropes.detach(0, end).value();
      const Vec3d before = world.totals().momentum + ropes.momentum();
      const double energy = world.totals().kinetic_energy + ropes.elastic_energy();
      Vec3d taken{};
      const int steps = int((0.4 + shot.speed * dt) / shot.speed / dt) + 3;
      for (int s = 0; s < steps; ++s) {
        ropes.step(world, dt).value();
        world.step(float(dt)).value();
      }
      taken = ropes.momentum();
      const Vec3d after = world.totals().momentum + taken;
      EXPECT_GT(length(taken), 0) << kind << ' ' << i;
      EXPECT_LT(length(after - before), 2e-4 * length(before)) << kind << ' ' << i << ", " << shot.speed << " m/s";
      EXPECT_LT(world.totals().kinetic_energy + ropes.kinetic_energy() + ropes.elastic_energy(), 1.001 * energy)
          << kind << ' ' << i << ", " << shot.speed << " m/s";
    }
}

// The same bits twice, and in a copy that goes on.
TEST(RopeFast, SameBits) {
  constexpr double dt = 1.0 / 60;
  const auto run = [&](bool copied) {
    math::Random random(3);
    std::uint64_t hash = 0;
    for (int i = 0; i < 10; ++i) {
      World3 world({.gravity = {0, 0, 0}});
      (void)fling(world, random, i % 5, 0.05, 0.2, dt);
      RopeSet ropes = taut_rope(world, 1000, 1e5);
      for (int s = 0; s < 12; ++s) {
        if (copied) {
          RopeSet copy = ropes;
          ropes = copy;
        }
        ropes.step(world, dt).value();
        world.step(float(dt)).value();
      }
      hash = hash * 1099511628211u ^ ropes.state_hash() ^ world.state_hash();
    }
    return hash;
  };
  const std::uint64_t once = run(false);
  EXPECT_EQ(run(false), once);
  EXPECT_EQ(run(true), once);
}

// A ledge under the rope, a millimetre off it, which balls do not touch, is nearer to it than what comes.
TEST(RopeFast, WhatLiesNearerDoesNotHideIt) {
  constexpr double dt = 1.0 / 60;
  for (int phase = 0; phase < 20; ++phase) {
    World3 world({.gravity = {0, 0, 0}});
    rigid::BodyDef<Dim3> ledge;
    ledge.type = rigid::BodyType::fixed;
    ledge.position = {0, -0.5 - radius - 0.001, 0};
    rigid::ShapeDef<Dim3> below;
    below.filter = {.category = 2, .mask = 1};
    world.add_shape(world.create_body(ledge).value(), geometry::Box{{2, 0.5f, 0.5f}}, below).value();
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::dynamic;
    def.position = {0.1, 0, 0.3 + phase * 0.1};
    def.linear_velocity = {0, 0, -120};
    const BodyId body = world.create_body(def).value();
    rigid::ShapeDef<Dim3> ball;
    ball.density = 50;
    ball.filter = {.category = 4, .mask = 1};
    world.add_shape(body, geometry::Sphere{0.03f}, ball).value();
    RopeSet ropes = taut_rope(world, 1e4, 1e6);
    for (int s = 0; s < 3; ++s) {
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
    }
    EXPECT_GT(world.state(body)->linear_velocity.z, 0) << phase;
  }
}

}  // namespace rope_fast_test
