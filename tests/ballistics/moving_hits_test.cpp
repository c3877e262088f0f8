// Projectiles and bodies that both move: a body is met where it was on its way, and only there.
#include <gtest/gtest.h>

#include <array>

#include "carom/ballistics/hits.h"
#include "carom/math/random.h"
#include "carom/math/rotation.h"

namespace ballistics_moving_hits_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;
using math::Vec3f;
using rigid::Dim2;
using rigid::Dim3;

constexpr double dt = 1.0 / 60;
const Conditions still{.air = environment::AirColumn::uniform(0), .gravity = 0};

/// A world without weight in which one plate moves; what hits it in one step.
struct Range {
  rigid::World3 world;
  rigid::BodyId plate;
  Range(Vec3d position, Vec3f half, Vec3f velocity, Vec3f spin = {}, rigid::BodyType type = rigid::BodyType::kinematic)
      : world([] {
          rigid::WorldDef<Dim3> definition;
          definition.gravity = {};
          return definition;
        }()) {
    rigid::BodyDef<Dim3> body;
    body.type = type;
    body.position = position;
    body.linear_velocity = velocity;
    body.angular_velocity = spin;
    plate = *world.create_body(body);
    (void)*world.add_shape(plate, geometry::Box{half});
  }
  std::vector<BatchHit> shoot(Vec3d from, Vec3d velocity) {
    ProjectileBatch batch(DragCurve(.3), still);
    batch.add({from, velocity}, BatchRound{.mass = .01, .frontal_area = 5e-5});
    EXPECT_TRUE(world.step(float(dt)).ok());
    batch.step(dt);
    BatchHits<Dim3> hits;
    EXPECT_TRUE(hits.collect(batch, world, dt).ok());
    return {hits.hits().begin(), hits.hits().end()};
  }
};

// A plate of 2 mm falls or rises across the line of fire at 60 m/s, a metre in the step: it stands on the line in the
// middle of the step only. The bullet that passes then is hit there, edge on; those that pass sooner or later are not.
TEST(MovingHits, APlateThatCrossesTheLineWithinAStep) {
  for (const double way : {1.0, -1.0})
    for (const double speed : {40.0, 400.0, 4000.0}) {
      const auto shoot = [&](double delay) {  // m that it is late by
        Range range({0, -.5 * way, 0}, {.05f, .001f, 1}, {0, float(60 * way), 0});
        return range.shoot({-speed * dt / 2 - delay, 0, 0}, {speed, 0, 0});
      };
      // They meet over the time in which the plate passes: its thickness by its speed, and the way across the plate.
      const auto hits = shoot(0);
      ASSERT_EQ(hits.size(), 1u) << speed << ' ' << way;
      EXPECT_NEAR(hits[0].point.y, 0, 1e-6);
      EXPECT_LE(math::abs(hits[0].point.x), .0501);
      EXPECT_NEAR(hits[0].time, dt / 2, .051 / speed + .002 / 60);
      if (speed < 100) EXPECT_NEAR(hits[0].normal.y, way, 1e-5) << "its face sweeps the bullet up";
      // Late or early by more than the plate is wide and the line is blocked.
      const double clear = .06 + speed * .001 / 60;
      EXPECT_TRUE(shoot(clear).empty()) << speed;
      EXPECT_TRUE(shoot(-clear).empty()) << speed;
      EXPECT_EQ(shoot(.9 * .05).size(), 1u);
      EXPECT_EQ(shoot(-.9 * .05).size(), 1u);
    }
}

// A plate that stands across the way at the end of the step alone is not hit by what passed before.
TEST(MovingHits, WhatComesTooLateIsNotHit) {
  Range late({0, 1.02, 0}, {.5f, .01f, 1}, {0, -60, 0});
  EXPECT_TRUE(late.shoot({-2, .02, 0}, {600, 0, 0}).empty()) << "it was .8 m above when the bullet passed";
  Range stands({0, .02, 0}, {.5f, .01f, 1}, {});
  EXPECT_EQ(stands.shoot({-2, .02, 0}, {600, 0, 0}).size(), 1u);
  // One that was there when the bullet passed and has left since.
  Range left({0, .1, 0}, {.01f, .2f, 1}, {0, 60, 0});
  const auto hits = left.shoot({-1, .15, 0}, {600, 0, 0});
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_NEAR(hits[0].point.x, -.01, 1e-5);
  EXPECT_NEAR(hits[0].time, .99 / 600, 1e-6);
  EXPECT_NEAR(hits[0].velocity.x, 600, 1e-3);
}

// A thin blade of 2 m turns about z through the line of a bullet at rest: by the chord in pieces, at any spin.
TEST(MovingHits, ABladeThatTurns) {
  for (const double spin : {6.0, -6.0, 60.0, 150.0})
    for (const double radius : {.2, .6, .95}) {
      // Seen from the blade, at angle 0 when the step begins, it turns by spin·dt; the bullet waits at half of that.
      const double angle = .5 * spin * dt;
      const Vec3d place{radius * math::cos(angle), radius * math::sin(angle), 0};
      Range range({}, {1, .0005f, .1f}, {}, {0, 0, float(spin)});
      const auto hits = range.shoot(place, {0, 0, .001});
      ASSERT_EQ(hits.size(), 1u) << spin << ' ' << radius;
      EXPECT_NEAR(hits[0].time, dt / 2, .02 * dt + .001 / (radius * math::abs(spin)));
      const Vec3d across = Vec3d{-math::sin(angle), math::cos(angle), 0} * (spin > 0 ? 1.0 : -1.0);
      EXPECT_GT(math::dot(hits[0].normal, across), .98);
      // Beyond its end, and where it has not come to.
      const Vec3d outside{1.02 * math::cos(angle), 1.02 * math::sin(angle), 0};
      EXPECT_TRUE(Range({}, {1, .0005f, .1f}, {}, {0, 0, float(spin)}).shoot(outside, {0, 0, .001}).empty());
      const double beyond = 1.1 * spin * dt + (spin > 0 ? .02 : -.02);
      const Vec3d ahead{radius * math::cos(beyond), radius * math::sin(beyond), 0};
      EXPECT_TRUE(Range({}, {1, .0005f, .1f}, {}, {0, 0, float(spin)}).shoot(ahead, {0, 0, .001}).empty());
    }
}

/// A plate on its way, and where a point stands seen from it.
struct Plate {
  rigid::BodyId id;
  Vec3d position, velocity, spin;
  Vec3f half;
  math::Quatf rotation;  // when the step began
  math::Quatd attitude(double t) const { return math::from_rotation_vector(t * spin) * math::Quatd(rotation); }
  Vec3d point(Vec3d local, double t) const { return position + t * velocity + rotate(attitude(t), local); }
  /// How far outside of the plate a point is at time t of the step (m); below zero inside.
  double outside(Vec3d point, double t) const {
    const Vec3d local = inverse_rotate(attitude(t), point - position - t * velocity);
    return math::max(math::max(math::abs(local.x) - double(half.x), math::abs(local.y) - double(half.y)),
                     math::abs(local.z) - double(half.z));
  }
  /// The deepest that a shot comes into it; where that is 2 mm outside or more, about so.
  double deepest(const FlightPoint& shot) const {
    const double quickest = math::length(shot.velocity - velocity) + math::length(spin) * math::length(half) + 1;
    double least = 1e300;
    for (double t = 0; t <= dt;) {
      const double out = outside(shot.position + t * shot.velocity, t);
      least = math::min(least, out);
      t += math::max(dt / 20000, .5 * (out - .002) / quickest);
    }
    return least;
  }
};

// Many bullets against many plates that fly and tumble: each is told as by the exact motion, sampled finely. None of
// those that clearly cross is missed, none that clearly misses is told, alone or among other shapes, in the first step
// of the plates and after many.
TEST(MovingHits, AgreeWithTheMotionInSmallParts) {
  math::Random random(5);
  int met = 0, told = 0;
  for (int trial = 0; trial < 40; ++trial) {
    rigid::WorldDef<Dim3> definition;
    definition.gravity = {};
    definition.threads = trial % 2 + 1;
    rigid::World3 world(definition);
    std::vector<Plate> plates;
    for (int i = 0; i < 12; ++i) {
      Plate p;
      p.position = {random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), 8.0 * i};  // none near another
      p.velocity = 60.0 * Vec3d{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0};
      p.spin = trial % 2 == 0
                   ? Vec3d{0, 0, random.uniform(-29.0, 29.0)}
                   : random.uniform(0.0, 40.0) * direction(random.uniform(-3.0, 3.0), random.uniform(-1.0, 1.0));
      p.half = {float(random.uniform(.3, 1.0)), .004f, .5f};
      rigid::BodyDef<Dim3> body;
      body.type = rigid::BodyType::kinematic;
      body.position = p.position;
      body.linear_velocity = Vec3f(p.velocity);
      body.angular_velocity = Vec3f(p.spin);
      p.id = *world.create_body(body);
      (void)*world.add_shape(p.id, geometry::Box{p.half});
      plates.push_back(p);
    }
    for (int step = 0; step < trial / 2; ++step) ASSERT_TRUE(world.step(float(dt)).ok());
    for (Plate& p : plates) {
      const auto state = *world.state(p.id);
      p.position = state.pose.position;
      p.rotation = state.pose.rotation;
    }
    ProjectileBatch batch(DragCurve(.3), still);
    std::vector<FlightPoint> shots;
    for (std::size_t i = 0; i < 240; ++i) {
      const Plate& p = plates[i % plates.size()];
      const Vec3d v = 300 * math::square(math::square(random.uniform())) * direction(random.uniform(-3.0, 3.0), 0);
      // It comes by a place on or about the plate, at any moment of the step.
      const double then = random.uniform(0.0, dt);
      const Vec3d place = 1.3 * Vec3d{random.uniform(-1.0, 1.0) * double(p.half.x), random.uniform(-.1, .1),
                                      random.uniform(-1.0, 1.0) * double(p.half.z)};
      shots.push_back({p.point(place, then) - then * v, v});
      batch.add(shots.back(), BatchRound{.mass = 0, .frontal_area = 5e-5, .tag = i});
    }
    ASSERT_TRUE(world.step(float(dt)).ok());
    batch.step(dt);
    BatchHits<Dim3> hits;
    ASSERT_TRUE(hits.collect(batch, world, dt, {.most_hits = 1}).ok());
    std::vector<int> hit(shots.size(), 0);
    for (const BatchHit& h : hits.hits()) hit[std::size_t(h.tag)] = 1;
    for (std::size_t i = 0; i < shots.size(); ++i) {
      // Below −1 mm it is hit, above +2 mm it is not.
      const double deepest = plates[i % plates.size()].deepest(shots[i]);
      if (deepest < -.001) {
        ++met;
        EXPECT_EQ(hit[i], 1) << trial << ": " << i << " by " << deepest;
      }
      if (deepest > .002) EXPECT_EQ(hit[i], 0) << trial << ": " << i << " by " << deepest;
      told += hit[i];
    }
  }
  EXPECT_GT(met, 1000);
  EXPECT_GE(told, met);
}

// Many rays at once among many bodies, some of which move, turn, whirl or stand: the same answers, to the bit, as the
// nearest of what every pair of a ray and a body says by itself, whatever the threads, and whatever length of rays the
// ways were found for.
TEST(MovingHits, ManyAmongManyAsEveryPairByItself) {
  math::Random random(11);
  for (const Vec3d origin : {Vec3d{}, Vec3d{2e6, -40, 9e5}}) {
    rigid::WorldDef<Dim3> definition;
    definition.gravity = {};
    definition.threads = 2;
    rigid::World3 world(definition);
    constexpr int bodies = 60;
    std::vector<rigid::BodyId> ids;
    for (int i = 0; i < bodies; ++i) {
      rigid::BodyDef<Dim3> body;
      body.type = i % 4 == 0   ? rigid::BodyType::fixed
                  : i % 4 == 1 ? rigid::BodyType::dynamic
                               : rigid::BodyType::kinematic;
      body.position = origin + Vec3d{random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 2.5 * i - 75};
      const double speed = i % 5 == 0 ? 0 : 60;  // some stand, some only turn
      body.linear_velocity = Vec3f(speed * Vec3d{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0});
      if (i % 3 != 0) body.angular_velocity = Vec3f{1, 2, 3} * float(random.uniform(-20.0, 20.0));
      ids.push_back(*world.create_body(body));
      rigid::ShapeDef<Dim3> shape;
      shape.filter.category = std::uint64_t(1) << i;
      shape.filter.mask = ~std::uint64_t(0);
      (void)*world.add_shape(ids.back(), geometry::Box{{2, .1f, .4f}}, shape);
    }
    for (int step = 0; step < 5; ++step) ASSERT_TRUE(world.step(float(dt)).ok());
    std::vector<rigid::RayQuery<Dim3>> rays;
    std::vector<float> begins;
    for (int i = 0; i < 600; ++i) {
      const double length = i % 9 == 0 ? 200 : 15;
      const Vec3d way = length * direction(random.uniform(-1.5, 1.5), random.uniform(-3.0, 3.0));
      const Vec3d through = world.state(ids[std::size_t(i) % ids.size()])->pose.position +
                            Vec3d{random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0)};
      rays.push_back({through - random.uniform() * way, Vec3f(way)});
      begins.push_back(i % 3 == 0 ? float(random.uniform(0.0, 1.0)) : 0.0f);
    }
    int met = 0;
    for (const double length : {0.0, 15.0}) {
      rigid::StepWays<Dim3> ways;
      world.find_ways(ways, length);
      ASSERT_GT(ways.ways.size(), 30u);
      std::vector<rigid::RayHit<Dim3>> hits(rays.size());
      ASSERT_TRUE(world.cast_rays(rays, begins, hits, ways).ok());
      for (std::size_t i = 0; i < rays.size(); ++i) {
        rigid::RayHit<Dim3> best;
        for (int k = 0; k < bodies; ++k) {
          rigid::RayQuery<Dim3> ray = rays[i];
          ray.filter.mask = std::uint64_t(1) << k;
          rigid::RayHit<Dim3> hit;
          ASSERT_TRUE(world.cast_rays({&ray, 1}, {&begins[i], 1}, {&hit, 1}, ways).ok());
          if (hit.shape != rigid::ShapeId{} && (best.shape == rigid::ShapeId{} || hit.fraction < best.fraction))
            best = hit;
        }
        EXPECT_EQ(hits[i].shape, best.shape) << i;
        EXPECT_EQ(hits[i].fraction, best.fraction) << i;
        EXPECT_EQ(hits[i].point, best.point) << i;
        EXPECT_EQ(hits[i].normal, best.normal) << i;
        met += int(best.shape != rigid::ShapeId{});
      }
    }
    EXPECT_GT(met, 100);
  }
}

// What a bullet gives to a body that flies and turns: momentum and angular momentum about any point are kept.
TEST(MovingHits, MomentumIsKept) {
  Range range({0, -.45, 0}, {.05f, .3f, .2f}, {3, 50, -7}, {2, -4, 9}, rigid::BodyType::dynamic);
  const Layer soft{.thickness = BatchHits<Dim3>::through, .medium = {1e6, 500}};
  ProjectileBatch batch(DragCurve(.3), still);
  const Vec3d v{500, 5, 0};
  batch.add({{-4, .1, .03}, v}, BatchRound{.mass = .02, .frontal_area = 5e-5});
  ASSERT_TRUE(range.world.step(float(dt)).ok());
  batch.step(dt);
  const auto before = range.world.totals();
  BatchHits<Dim3> hits;
  ASSERT_TRUE(hits.set_default(std::array{soft}).ok());
  ASSERT_TRUE(hits.collect(batch, range.world, dt, {.keep_stopped = true}).ok());
  ASSERT_EQ(hits.hits().size(), 1u);
  const BatchHit& hit = hits.hits()[0];
  const auto after = range.world.totals();
  EXPECT_LT(math::length(after.momentum - before.momentum - hit.impulse), 1e-4);
  // About the centre of mass where it was when they met.
  const Vec3d center = Vec3d{0, -.45, 0} + hit.time * Vec3d{3, 50, -7};
  const Vec3d now = range.world.state(range.plate)->center_of_mass;
  const Vec3d spin =
      (after.angular_momentum - cross(now, after.momentum)) - (before.angular_momentum - cross(now, before.momentum));
  EXPECT_LT(math::length(spin - cross(hit.point - center, hit.impulse)), 2e-3 * math::length(hit.impulse));
  EXPECT_GE(hit.energy, 0);
}

// What is set to a place has not gone there; what the snapshot brings back has gone no way.
TEST(MovingHits, WhatIsSetIsMetWhereItStands) {
  Range range({0, 5, 0}, {.05f, 1, 1}, {});
  ASSERT_TRUE(range.world.step(float(dt)).ok());
  ProjectileBatch batch(DragCurve(.3), still);
  batch.add({{-1, 0, 0}, {600, 0, 0}}, BatchRound{.mass = .01});
  batch.add({{-1, -5, 0}, {600, 0, 0}}, BatchRound{.mass = .01});
  batch.step(dt);
  ASSERT_TRUE(range.world.set_pose(range.plate, {0, -5, 0}, {}).ok());
  BatchHits<Dim3> hits;
  ASSERT_TRUE(hits.collect(batch, range.world, dt).ok());
  ASSERT_EQ(hits.hits().size(), 1u);
  EXPECT_NEAR(hits.hits()[0].point.y, -5, 1e-9);
}

TEST(MovingHits, InThePlane) {
  rigid::WorldDef<Dim2> definition;
  definition.gravity = {};
  rigid::World2 world(definition);
  rigid::BodyDef<Dim2> body;
  body.type = rigid::BodyType::kinematic;
  body.position = {0, -.5};
  body.linear_velocity = {0, 60};
  const rigid::BodyId plate = *world.create_body(body);
  (void)*world.add_shape(plate, geometry::make_box2({.05f, .001f}));
  for (const double late : {0.0, .2}) {
    ASSERT_TRUE(world.set_pose(plate, {0, -.5}, {}).ok());
    ProjectileBatch batch(DragCurve(.3), still);
    batch.add({{-300 * dt / 2 - late, 0, 0}, {300, 0, 0}}, BatchRound{.mass = .01});
    ASSERT_TRUE(world.step(float(dt)).ok());
    batch.step(dt);
    BatchHits<Dim2> hits;
    ASSERT_TRUE(hits.collect(batch, world, dt).ok());
    EXPECT_EQ(hits.hits().size(), late == 0 ? 1u : 0u);
  }
}

}  // namespace ballistics_moving_hits_test
