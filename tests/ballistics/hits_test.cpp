// Projectiles of a batch in a world: nothing is missed, momentum is handed over, energy never grows.
#include "carom/ballistics/hits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "carom/ballistics/body_flight.h"
#include "carom/math/random.h"

namespace ballistics_hits_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;
using math::Vec3f;
using rigid::Dim2;
using rigid::Dim3;

const Conditions vacuum{.air = environment::AirColumn::uniform(0)};
const Layer tissue{.thickness = BatchHits<Dim3>::through, .medium = {1e6, 500}};

template <class D = Dim3>
rigid::World<D> weightless() {
  rigid::WorldDef<D> definition;
  definition.gravity = {};
  return rigid::World<D>(definition);
}

rigid::BodyId add_box(rigid::World3& world, Vec3d position, Vec3f half, rigid::BodyType type, float density = 1000,
                      std::uint32_t material = 0) {
  rigid::BodyDef<Dim3> body;
  body.type = type;
  body.position = position;
  const rigid::BodyId id = *world.create_body(body);
  rigid::ShapeDef<Dim3> shape;
  shape.density = density;
  shape.material.user_id = material;
  (void)*world.add_shape(id, geometry::Box{half}, shape);
  return id;
}

// A wall of a millimetre, at any speed and step, from any distance within the step.
TEST(Hits, NoTunnellingAtAnySpeed) {
  rigid::World3 world = weightless();
  add_box(world, {0, 0, 0}, {.0005f, 50, 50}, rigid::BodyType::fixed);
  ASSERT_TRUE(world.step(1.0f / 60).ok());
  math::Random random(7);
  Conditions still = vacuum;
  still.gravity = 0;
  for (const double dt : {1e-3, 1.0 / 60, .25})
    for (const double speed : {10.0, 900.0, 12000.0, 3e5}) {
      ProjectileBatch batch(DragCurve(.3), still);
      const int count = 60;
      for (int i = 0; i < count; ++i)
        batch.add({{-speed * dt * random.uniform(.01, 3.0) - .001, random.uniform(-20.0, 20.0), 0}, {speed, 0, 0}},
                  1e-3);
      BatchHits<Dim3> hits;
      int met = 0;
      for (int k = 0; k < 4; ++k) {
        batch.step(dt);
        ASSERT_TRUE(hits.collect(batch, world, dt).ok());
        for (const BatchHit& hit : hits.hits()) {
          ++met;
          EXPECT_NEAR(hit.point.x, -.0005, 1e-6 * speed * dt + 1e-5);
          EXPECT_NEAR(hit.normal.x, -1, 1e-6);
          EXPECT_EQ(hit.outcome, LayerOutcome::stopped);
        }
      }
      EXPECT_EQ(met, count) << speed << " m/s, " << dt << " s";
      EXPECT_EQ(batch.size(), 0u);
    }
}

// Asked in groups, by any number of threads and in any order: the same hits as ray by ray.
TEST(Hits, NothingIsMissed) {
  math::Random random(11);
  rigid::WorldDef<Dim3> definition;
  definition.threads = 2;
  rigid::World3 world(definition);
  for (int i = 0; i < 400; ++i)
    add_box(world, {random.uniform(-200.0, 200.0), random.uniform(0.0, 60.0), random.uniform(-200.0, 200.0)},
            {float(random.uniform(.2, 4.0)), float(random.uniform(.2, 4.0)), .5f}, rigid::BodyType::fixed);
  ASSERT_TRUE(world.step(1.0f / 60).ok());
  ProjectileBatch batch(DragCurve(DragFunction::g7), {});
  for (std::uint64_t i = 0; i < 3000; ++i)
    batch.add({{random.uniform(-200.0, 200.0), random.uniform(0.0, 90.0), random.uniform(-200.0, 200.0)},
               random.uniform(50.0, 900.0) * direction(random.uniform(-.5, .5), random.uniform(-3.0, 3.0))},
              BatchRound{.area_per_mass = 5e-3, .mass = .01, .tag = i});
  BatchHits<Dim3> hits;
  std::size_t met = 0;
  for (int step = 0; step < 30; ++step) {
    if (step % 8 == 0) batch.sort();
    batch.step(1.0 / 60);
    std::vector<std::uint64_t> expected, found;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const auto hit =
          world.ray_cast(batch.previous_position(i), Vec3f(batch.at(i).position - batch.previous_position(i)));
      if (hit->shape != rigid::ShapeId{}) expected.push_back(batch.round(i).tag);
    }
    ASSERT_TRUE(hits.collect(batch, world, 1.0 / 60).ok());
    for (const BatchHit& hit : hits.hits()) found.push_back(hit.tag);
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
    met += found.size();
  }
  EXPECT_GT(met, 100u);
  EXPECT_EQ(batch.size() + met, 3000u);
}

// Through, off or into free blocks: momentum is the sum of before, and energy falls by what is told.
TEST(Hits, MomentumIsKeptAndEnergyIsTold) {
  math::Random random(3);
  int outcomes[3] = {};
  for (int i = 0; i < 200; ++i) {
    rigid::World3 world = weightless();
    const rigid::BodyId block =
        add_box(world, {}, {.1f, .2f, .3f}, rigid::BodyType::dynamic, float(random.uniform(50.0, 3000.0)));
    ASSERT_TRUE(world.set_velocity(block, {float(random.uniform(-20.0, 20.0)), 3, 0}, {0, 2, 5}).ok());
    Conditions still = vacuum;
    still.gravity = 0;
    ProjectileBatch batch(DragCurve(.3), still);
    Layer layer = tissue;
    layer.medium.strength = math::exp(random.uniform(13.0, 21.0));
    layer.ricochet_angle = random.uniform(0.0, 1.8);
    BatchHits<Dim3> hits;
    ASSERT_TRUE(hits.set_material(0, std::array{layer}).ok());
    const Vec3d from{-3, random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
    const Vec3d at{0, random.uniform(-.15, .15), random.uniform(-.25, .25)};
    const double mass = random.uniform(.004, .05), speed = random.uniform(200.0, 900.0);
    const Vec3d v = speed * math::normalize(at - from);
    batch.add({from, v}, BatchRound{.area_per_mass = 1e-3, .mass = mass, .frontal_area = 5e-5});
    const rigid::Totals<Dim3> before = world.totals();
    batch.step(1.0 / 60);
    ASSERT_TRUE(hits.collect(batch, world, 1.0 / 60, {.keep_stopped = true}).ok());
    ASSERT_GE(hits.hits().size(), 1u);
    double told = 0;
    for (const BatchHit& hit : hits.hits()) {
      EXPECT_GE(hit.energy, 0);
      told += hit.energy;
      ++outcomes[int(hit.outcome)];
    }
    const rigid::Totals<Dim3> after = world.totals();
    const Vec3d w = batch.at(0).velocity;
    EXPECT_LT(math::length(before.momentum + mass * v - after.momentum - mass * w), 1e-5 * mass * speed + 1e-4);
    const double energy = before.kinetic_energy + .5 * mass * speed * speed;
    EXPECT_NEAR(after.kinetic_energy + .5 * mass * math::length_squared(w), energy - told, 2e-4 * energy);
    if (hits.hits().back().outcome == LayerOutcome::stopped) {
      const auto state = *world.state(block);
      const Vec3d point = Vec3d(state.linear_velocity) +
                          cross(Vec3d(state.angular_velocity), hits.hits().back().point - state.center_of_mass);
      const Vec3d d = math::normalize(hits.hits().back().impulse);
      EXPECT_NEAR(math::dot(point - w, d), 0, 1e-3 * speed) << "they go on together";
    }
  }
  for (int i = 0; i < 3; ++i) EXPECT_GT(outcomes[i], 20) << i;
}

// 10 g at 400 m/s into 2 kg on a rod: 1.99005 m/s, and it swings up to v²/2g.
TEST(Hits, BallisticPendulum) {
  rigid::World3 world;
  const rigid::BodyId bob = add_box(world, {0, 0, 0}, {.1f, .1f, .1f}, rigid::BodyType::dynamic, 250);
  rigid::DistanceJointDef<Dim3> rod;
  rod.body_b = bob;
  rod.frame_a.p = {0, 2, 0};
  rod.length = 2;
  ASSERT_TRUE(world.create_joint(rod).ok());
  ProjectileBatch batch(DragCurve(.3), vacuum);
  batch.add({{-5, 0, 0}, {400, 0, 0}}, BatchRound{.mass = .01});
  batch.step(1.0 / 60);
  BatchHits<Dim3> hits;
  ASSERT_TRUE(hits.collect(batch, world, 1.0 / 60).ok());
  ASSERT_EQ(hits.hits().size(), 1u);
  EXPECT_NEAR(world.state(bob)->linear_velocity.x, 1.990050, 1e-5);
  double height = 0;
  for (int i = 0; i < 90; ++i) {
    ASSERT_TRUE(world.step(1.0f / 60).ok());
    height = math::max(height, world.state(bob)->center_of_mass.y);
  }
  EXPECT_NEAR(height, 1.99005 * 1.99005 / (2 * 9.80665), 2e-3);
}

// Two boxes that touch: out of one is into the other. What remains agrees with the layers by themselves.
TEST(Hits, LayersThroughBodies) {
  rigid::World3 world = weightless();
  add_box(world, {.1, 0, 0}, {.1f, 1, 1}, rigid::BodyType::fixed, 1000, 4);
  add_box(world, {.3, 0, 0}, {.1f, 1, 1}, rigid::BodyType::fixed, 1000, 4);
  add_box(world, {.9, 0, 0}, {.05f, 1, 1}, rigid::BodyType::fixed, 1000, 5);
  ASSERT_TRUE(world.step(1.0f / 60).ok());
  const Layer sheet{.thickness = .003, .limit_speed = 150, .density = 7850};
  const Layer board{.thickness = .1, .medium = {2e7, 700}};
  BatchHits<Dim3> hits;
  ASSERT_TRUE(hits.set_material(4, std::array{tissue}).ok());
  ASSERT_TRUE(hits.set_material(5, std::array{sheet, board, sheet}).ok());
  ProjectileBatch batch(DragCurve(.3), vacuum);
  batch.add({{-1, 0, 0}, {800, 0, 0}}, BatchRound{.mass = .0095, .frontal_area = 4.56e-5});
  batch.step(1.0 / 60);
  ASSERT_TRUE(hits.collect(batch, world, 1.0 / 60).ok());
  ASSERT_EQ(hits.hits().size(), 3u);
  Layer first = tissue;
  first.thickness = .2;
  const auto passages = *penetrate({.0095, 4.56e-5, 800}, std::array{first, first, sheet, board, sheet});
  EXPECT_NEAR(hits.hits()[0].exit_velocity.x, passages[0].speed_out, .05);
  EXPECT_NEAR(hits.hits()[1].exit_velocity.x, passages[1].speed_out, .1);
  EXPECT_NEAR(hits.hits()[2].exit_velocity.x, passages.back().speed_out, .1);
  EXPECT_EQ(batch.size(), passages.back().speed_out > 0 ? 1u : 0u);
}

TEST(Hits, RicochetIsAMirrorWithLoss) {
  rigid::World3 world = weightless();
  add_box(world, {0, -1, 0}, {500, 1, 500}, rigid::BodyType::fixed);
  ASSERT_TRUE(world.step(1.0f / 60).ok());
  BatchHits<Dim3> hits;
  Layer water = tissue;
  water.ricochet_angle = water_ricochet_angle(7.85);
  EXPECT_NEAR(water.ricochet_angle * 180 / math::pi, 6.4, .05) << "steel";
  ASSERT_TRUE(hits.set_default(std::array{water}).ok());
  for (const double angle : {.05, .3}) {
    ProjectileBatch batch(DragCurve(.3), vacuum);
    batch.add({{-6 * math::cos(angle), 6 * math::sin(angle), 0}, 600.0 * direction(-angle)},
              BatchRound{.mass = .05, .frontal_area = 1e-4});
    batch.step(1.0 / 60);
    ASSERT_TRUE(hits.collect(batch, world, 1.0 / 60).ok());
    ASSERT_EQ(hits.hits().size(), 1u);
    const BatchHit& hit = hits.hits()[0];
    EXPECT_EQ(hit.outcome, angle < water.ricochet_angle ? LayerOutcome::ricochet : LayerOutcome::stopped);
    if (angle < water.ricochet_angle) {
      EXPECT_NEAR(math::length(hit.exit_velocity), .7 * math::length(hit.velocity), .01);
      EXPECT_GT(batch.at(0).position.y, 0);
      EXPECT_NEAR(hit.exit_velocity.y / hit.exit_velocity.x, -hit.velocity.y / hit.velocity.x, 1e-5);
    }
  }
}

TEST(Hits, InThePlane) {
  rigid::World2 world = weightless<Dim2>();
  rigid::BodyDef<Dim2> definition;
  const rigid::BodyId block = *world.create_body(definition);
  rigid::ShapeDef<Dim2> shape;
  shape.density = 2;
  (void)*world.add_shape(block, geometry::make_box2({.5f, .5f}), shape);
  ProjectileBatch batch(DragCurve(.3), vacuum);
  batch.add({{-5, .25, 0}, {400, 0, 0}}, BatchRound{.mass = .01, .frontal_area = 5e-5});
  batch.step(1.0 / 60);
  BatchHits<Dim2> hits;
  ASSERT_TRUE(hits.collect(batch, world, 1.0 / 60).ok());
  ASSERT_EQ(hits.hits().size(), 1u);
  const auto state = *world.state(block);
  EXPECT_NEAR(state.linear_velocity.x * 2 + .01 * hits.hits()[0].exit_velocity.x, .01 * 400, 1e-5);
  EXPECT_LT(state.angular_velocity, 0);
}

TEST(Hits, BadInputIsNamed) {
  rigid::World3 world;
  ProjectileBatch batch(DragCurve(.3), vacuum);
  BatchHits<Dim3> hits;
  EXPECT_NE(hits.set_material(1, {}).error().message.find("no layer"), std::string::npos);
  EXPECT_NE(hits.set_material(1, std::array{Layer{.thickness = -1}}).error().message.find("thickness"),
            std::string::npos);
  EXPECT_NE(hits.collect(batch, world, 0).error().message.find("dt"), std::string::npos);
  EXPECT_FALSE(flight_effector<Dim3>({}, {}).ok());
  EXPECT_FALSE(flight_effector<Dim3>(add_box(world, {}, {1, 1, 1}, rigid::BodyType::dynamic), {.dt = 0}).ok());
}

// A body with the effector against the model's own flight: the published rows of the 168 SMK, then wind and Coriolis.
TEST(BodyFlight, FliesLikeTheModel) {
  const Projectile bullet = projectile_from_coefficient(DragFunction::g7, .218);
  Conditions air;
  air.wind = environment::WindColumn(Vec3d{2, 0, 4});
  air.rotation = earth_rotation_rate(.8, 1.0);
  for (const int rate : {60, 240}) {
    rigid::World3 world;
    rigid::BodyDef<Dim3> definition;
    definition.linear_velocity = Vec3f(807.72 * direction(.02));
    const rigid::BodyId body = *world.create_body(definition);
    rigid::ShapeDef<Dim3> shape;
    (void)*world.add_shape(body, geometry::Sphere{.01f}, shape);
    const double dt = 1.0 / rate;
    ASSERT_TRUE(world.add_effector(*flight_effector<Dim3>(body, {bullet, air, dt})).ok());
    const Trajectory path = *fly(bullet, air, {{}, 807.72 * direction(.02)}, {.time = 2});
    for (int i = 0; i < 2 * rate; ++i) ASSERT_TRUE(world.step(float(dt)).ok());
    const Vec3d off = world.state(body)->center_of_mass - path.end().position;
    const double allowed = rate == 60 ? .06 : .01;  // of 1 060 m: second order in the step, and floats
    EXPECT_LT(math::length(off), allowed) << rate << " Hz: " << off.x << ' ' << off.y << ' ' << off.z;
    EXPECT_LT(math::length(Vec3d(world.state(body)->linear_velocity) - path.end().velocity), .02);
  }
}

}  // namespace ballistics_hits_test
