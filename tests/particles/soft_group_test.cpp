// Soft bodies and cloths that meet one another.
#include "carom/particles/soft_group.h"

#include <gtest/gtest.h>

#include "carom/core/scheduler.h"
#include "carom/math/elementary.h"
#include "tests/particles/soft_pieces.h"
#include "tests/particles/weightless.h"

namespace carom::particles {
namespace soft_group_test {

using namespace math;
using rigid::Dim3;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

SoftBody cube(Vec3d middle, double size, int cells, SoftMaterial material, Vec3d velocity = {}) {
  return solid(make_soft_box(middle - 0.5 * Vec3d{size, size, size}, {size, size, size}, cells, cells, cells), material,
               velocity);
}
World3 with_ground() {
  World3 world;
  rigid::BodyDef<Dim3> ground;
  ground.type = rigid::BodyType::fixed;
  world.add_shape(world.create_body(ground).value(), geometry::Plane{}).value();
  return world;
}
TEST(SoftGroup, CubesDroppedOnEachOtherRestApart) {
  World3 world = with_ground();
  const SoftMaterial foam{.density = 200, .youngs_modulus = 5e4, .poisson_ratio = 0.3, .damping = 0.01};
  SoftBody below = cube({0, 0.3, 0}, 0.4, 4, foam), above = cube({0.05, 1.0, 0.03}, 0.4, 5, foam);
  SoftBody* const both[] = {&below, &above};
  SoftGroup group;
  double closest = 1;
  for (int i = 0; i < 600; ++i) {
    group.step({}, both, world, dt).value();
    world.step(float(dt)).value();
    for (const SoftContact& contact : group.contacts()) closest = min(closest, contact.distance);
  }
  // The skin of 5 mm is kept between the faces, less what the contacts give way.
  double least = 1, most = 0;
  for (const SoftContact& contact : group.contacts()) {
    least = min(least, contact.distance);
    most = max(most, contact.distance);
  }
  RecordProperty("closest_mm", std::to_string(1e3 * closest));
  RecordProperty("least_mm", std::to_string(1e3 * least));
  EXPECT_GT(closest, 0);
  EXPECT_GT(least, 0.004);
  EXPECT_LT(most, 0.0052);
  EXPECT_LT(above.kinetic_energy() + below.kinetic_energy(), 5e-5);
  // The contacts bear the weight.
  Vec3d force{};
  for (const SoftContact& contact : group.contacts()) force += (contact.thing == 1 ? 1.0 : -1.0) * contact.force;
  EXPECT_NEAR(force.y, above.mass() * g, 0.01 * above.mass() * g);
  EXPECT_LT(abs(force.x), 0.01 * above.mass() * g);
}

TEST(SoftGroup, HeadOnKeepsMomentumAndGainsNoEnergy) {
  World3 world = weightless();
  const SoftMaterial rubber{.density = 300, .youngs_modulus = 5e4, .poisson_ratio = 0.4, .damping = 0.002};
  for (const double speed : {1.0, 6.0, 20.0}) {
    const SoftMesh mesh_a = make_soft_ball({-0.5, 0.02, 0}, 0.3, 6),
                   mesh_b = make_soft_box({0.1, -0.3, -0.25}, {0.5, 0.5, 0.5}, 4, 4, 4);
    SoftBody a = solid(mesh_a, rubber, {speed, 0, 0}), b = solid(mesh_b, rubber, {-0.5 * speed, 0, 0});
    SoftBody* const both[] = {&a, &b};
    SoftGroup group;
    const Vec3d before = a.momentum() + b.momentum();
    const double amount = length(a.momentum()) + length(b.momentum());
    const double energy = a.kinetic_energy() + b.kinetic_energy();
    double worst = 0, deepest = 0;
    for (int i = 0; i < 60; ++i) {
      group.step({}, both, world, dt).value();
      worst = max(worst, a.kinetic_energy() + b.kinetic_energy());
      deepest = max(deepest, max(depth(a, mesh_a, b), depth(b, mesh_b, a)));
    }
    const Vec3d after = a.momentum() + b.momentum();
    RecordProperty("lost", std::to_string(1e9 * length(after - before) / amount));
    RecordProperty("deepest_mm", std::to_string(1e3 * deepest));
    EXPECT_LT(length(after - before), 1e-6 * amount);
    EXPECT_LE(worst, energy * (1 + 1e-6));
    EXPECT_LT(a.momentum().x / a.mass(), 0.5 * speed) << "they met";
    EXPECT_LT(deepest, 0.02);
  }
}

TEST(SoftGroup, ThreadsAndLanesGiveTheSameBitsAndACopyIsASnapshot) {
  const auto pool = core::make_thread_pool(3);
  const SoftMaterial foam{.density = 200, .youngs_modulus = 3e4};
  const ClothSheet sheet = make_cloth_sheet({-0.5, 1.3, -0.5}, {1, 0, 0}, {0, 0, 1}, 13, 13);
  const auto run = [&](int lanes, core::TaskScheduler* scheduler, bool twice) {
    World3 world = with_ground();
    std::vector<SoftBody> bodies;
    for (int k = 0; k < 3; ++k)
      bodies.push_back(solid(make_soft_box({0.1 * k, 0.05 + 0.4 * k, 0.05 * k}, {0.3, 0.3, 0.3}, 3, 3, 3), foam, {},
                             lanes, scheduler));
    Cloth cloth =
        Cloth::make({.points = sheet.points, .triangles = sheet.triangles, .scheduler = scheduler, .lanes = lanes})
            .value();
    SoftGroup group;
    const auto go = [&](int steps) {
      SoftBody* list[] = {&bodies[0], &bodies[1], &bodies[2]};
      Cloth* cloths[] = {&cloth};
      for (int i = 0; i < steps; ++i) {
        group.step(cloths, list, world, dt).value();
        world.step(float(dt)).value();
      }
    };
    const auto hash = [&] {
      std::uint64_t sum = cloth.state_hash();
      for (const SoftBody& body : bodies) sum = sum * 31 + body.state_hash();
      return sum;
    };
    go(40);
    const std::vector<SoftBody> kept = bodies;
    const Cloth kept_cloth = cloth;
    go(30);
    const std::uint64_t end = hash();
    if (twice) {
      bodies = kept;
      cloth = kept_cloth;
      group = {};
      go(30);
      EXPECT_EQ(hash(), end);
    }
    return end;
  };
  const std::uint64_t one = run(4, nullptr, true);
  EXPECT_EQ(run(8, nullptr, false), one);
  EXPECT_EQ(run(16, pool.get(), false), one);
}

TEST(SoftGroup, AnyOrderGivesTheSame) {
  const SoftMaterial foam{.density = 200, .youngs_modulus = 3e4, .damping = 0.01};
  double height[2] = {};
  for (const int order : {0, 1}) {
    World3 world = with_ground();
    SoftBody a = cube({0, 0.25, 0}, 0.4, 3, foam), b = cube({0.08, 0.8, 0.05}, 0.4, 3, foam);
    SoftBody* list[] = {order == 0 ? &a : &b, order == 0 ? &b : &a};
    SoftGroup group;
    for (int i = 0; i < 240; ++i) {
      group.step({}, list, world, dt).value();
      world.step(float(dt)).value();
    }
    height[order] = b.center().y;
  }
  EXPECT_NEAR(height[0], height[1], 2e-4);
}

TEST(SoftGroup, FrictionHoldsASlopeAndLetsASteeperOneSlide) {
  // A block on the tilted top of one that is held: it stays while tan(angle) < friction.
  for (const double slope : {0.3, 0.8}) {
    rigid::WorldDef<Dim3> def;
    const double turn = 1 / sqrt(1 + slope * slope);
    def.gravity = Vec3f(g * Vec3d{slope * turn, -turn, 0});
    World3 world(def);
    const SoftMaterial rubber{.density = 500, .youngs_modulus = 2e5, .damping = 0.01, .friction = 0.5};
    SoftBody table = solid(make_soft_box({-1, -0.2, -0.3}, {4, 0.2, 0.6}, 20, 2, 4), rubber),
             block = solid(make_soft_box({-0.3, 0.006, -0.1}, {0.3, 0.1, 0.2}, 4, 2, 3), rubber);
    for (int i = 0; i < table.vertex_count(); ++i)
      if (table.positions()[std::size_t(i)].y < -0.19) table.pin(i).value();
    SoftBody* const both[] = {&table, &block};
    SoftGroup group;
    const double start = block.center().x;
    for (int i = 0; i < 60; ++i) group.step({}, both, world, dt).value();
    const double slid = block.center().x - start, t = 60 * dt;
    RecordProperty("slid", std::to_string(slid));
    // a = g (sin − μ cos)
    const double free = 0.5 * g * turn * (slope - 0.5) * t * t;
    if (slope < 0.5) {
      EXPECT_LT(abs(slid), 0.01);
    } else {
      EXPECT_NEAR(slid, free, 0.1 * free);
    }
  }
}

TEST(SoftGroup, ClothCarriesASoftBallAndNeitherPassesTheOther) {
  World3 world;
  const ClothSheet sheet = make_cloth_sheet({-0.6, 0, -0.6}, {1.2, 0, 0}, {0, 0, 1.2}, 25, 25);
  Cloth cloth = Cloth::make({.fabric = {.warp_stiffness = 3000, .weft_stiffness = 3000, .thickness = 0.006},
                             .points = sheet.points,
                             .triangles = sheet.triangles})
                    .value();
  for (const int corner : {0, 24, 600, 624}) cloth.pin(corner).value();
  const SoftMesh mesh = make_soft_ball({0, 0.4, 0}, 0.2, 6);
  SoftBody ball = solid(mesh, {.density = 100, .youngs_modulus = 4e4, .damping = 0.005});
  SoftBody* const bodies[] = {&ball};
  Cloth* const cloths[] = {&cloth};
  SoftGroup group;
  for (int i = 0; i < 480; ++i) {
    group.step(cloths, bodies, world, dt).value();
    world.step(float(dt)).value();
  }
  Vec3d force{};
  for (const SoftContact& contact : group.contacts()) force += (contact.thing == 1 ? 1.0 : -1.0) * contact.force;
  Vec3d held{};
  for (const int corner : {0, 24, 600, 624}) held += cloth.pin_force(corner);
  EXPECT_GT(ball.center().y, -0.5);
  EXPECT_NEAR(force.y, ball.mass() * g, 0.05 * ball.mass() * g);
  EXPECT_NEAR(-held.y, (ball.mass() + cloth.mass()) * g, 0.05 * (ball.mass() + cloth.mass()) * g);
}

TEST(SoftGroup, FiltersAndDistanceLeaveEachItsOwnStep) {
  World3 world = weightless();
  const SoftMaterial foam{.density = 200};
  const auto fall = [&](std::uint32_t mask, bool together) {
    const SoftMesh mesh = make_soft_box({0, 0, 0}, {0.3, 0.3, 0.3}, 3, 3, 3),
                   beside = make_soft_box({0.4, 0, 0}, {0.3, 0.3, 0.3}, 3, 3, 3);
    SoftBody a = SoftBody::make({.material = foam,
                                 .points = mesh.points,
                                 .tetrahedra = mesh.tetrahedra,
                                 .velocity = {1, 0, 0},
                                 .filter = {.category = 2, .mask = mask}})
                     .value();
    SoftBody b = solid(beside, foam);
    SoftBody* const both[] = {&a, &b};
    SoftGroup group;
    for (int i = 0; i < 60; ++i) {
      if (together) {
        group.step({}, both, world, dt).value();
      } else {
        a.step(world, dt).value();
        b.step(world, dt).value();
      }
    }
    return a.state_hash() + b.state_hash();
  };
  EXPECT_EQ(fall(4, true), fall(4, false));
  EXPECT_NE(fall(~0u, true), fall(4, false));
}

TEST(SoftGroup, BadInputIsRefusedAndMovesNothing) {
  World3 world = with_ground();
  SoftBody a = cube({0, 1, 0}, 0.3, 2, {}), b = cube({0.5, 1, 0}, 0.3, 2, {});
  SoftGroup group;
  const auto message = [&](std::span<SoftBody* const> list, double step) {
    const std::uint64_t before = b.state_hash();
    const core::Status status = group.step({}, list, world, step);
    EXPECT_EQ(b.state_hash(), before);
    return status.ok() ? std::string("none") : status.error().message;
  };
  SoftBody* const twice[] = {&b, &a, &b};
  EXPECT_EQ(message(twice, dt), "SoftGroup: bodies[2] is the same as bodies[0]");
  SoftBody* const none[] = {&b, nullptr};
  EXPECT_EQ(message(none, dt), "SoftGroup: bodies[1] is null or was moved away");
  SoftBody* const both[] = {&b, &a};
  EXPECT_NE(message(both, nan("")).find("dt"), std::string::npos);
  a.set_velocity(3, {3e38, 0, 0}).value();
  a.set_velocity(4, {3e38, 0, 0}).value();
  a.step(world, dt).value();
  EXPECT_EQ(message(both, dt), "SoftGroup: bodies[1] has a place or a velocity that is not finite");
  const SoftBody gone = std::move(a);
  EXPECT_EQ(message(both, dt), "SoftGroup: bodies[1] is null or was moved away");
  const SoftGroup empty = std::move(group);
  SoftBody* const one[] = {&b};
  EXPECT_TRUE(group.step({}, one, world, dt).ok()) << "a group that was moved away begins anew";
}

}  // namespace soft_group_test
}  // namespace carom::particles
