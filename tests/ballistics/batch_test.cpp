// Batches against single flights, and their bits over widths.
#include "carom/ballistics/batch.h"

#include <gtest/gtest.h>

#include <cstring>

#include "carom/math/random.h"

namespace ballistics_batch_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

Conditions windy() {
  return {.wind = environment::WindColumn(environment::Wind{
              .velocity = {4, 0, -7}, .profile = environment::WindProfile::logarithmic, .reference_height = 10}),
          .rotation = earth_rotation_rate(.8, .3)};
}

FlightPoint draw(math::Random& random) {
  const Vec3d place{random.uniform(-100.0, 100.0), random.uniform(50.0, 200.0), random.uniform(-100.0, 100.0)};
  return {place, random.uniform(100.0, 900.0) * direction(random.uniform(.1, 1.0), random.uniform(0.0, 6.28))};
}

// 60 Hz against the adaptive integration: 2 cm after 2 s, 1e-4 of the way.
TEST(Batch, AgreesWithSingleFlights) {
  const DragCurve curve(DragFunction::g7);
  const Conditions conditions = windy();
  ProjectileBatch batch(curve, conditions, {0, 100, 0});
  math::Random random(3);
  std::vector<FlightPoint> starts;
  const double area = projectile_from_coefficient(DragFunction::g7, .3).area_per_mass;
  for (int i = 0; i < 100; ++i) {
    starts.push_back(draw(random));
    batch.add(starts.back(), area);
  }
  for (int i = 0; i < 120; ++i) batch.step(1.0 / 60);
  double worst = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const auto flight = fly({curve, area}, conditions, starts[i], {.time = 2, .tolerance = 1e-10});
    const double way = math::distance(starts[i].position, flight->end().position);
    worst = math::max(worst, math::distance(batch.at(i).position, flight->end().position) / way);
    EXPECT_LT(math::distance(batch.at(i).velocity, flight->end().velocity), 2e-3 * math::length(starts[i].velocity));
  }
  EXPECT_LT(worst, 1e-4);
}

// A rifle's flat shot feels the wind of the lowest metres, where a profile changes most, over ground at any height.
TEST(Batch, FlatShotsFeelTheFootOfAProfile) {
  for (const auto profile : {environment::WindProfile::power, environment::WindProfile::logarithmic})
    for (const double ground : {0.0, -37.0, 412.0}) {
      const Conditions air{
          .wind = environment::WindColumn(environment::Wind{.velocity = {0, 0, 8}, .profile = profile}).raised(ground)};
      const Projectile bullet = projectile_from_coefficient(DragFunction::g7, .218);
      const FlightPoint start{{0, ground + 1.5, 0}, 808.0 * direction(.004)};
      ProjectileBatch batch(bullet.drag, air, {0, ground, 0});
      batch.add(start, bullet.area_per_mass);
      for (int i = 0; i < 40; ++i) batch.step(1.0 / 60);
      const auto flight = fly(bullet, air, start, {.time = 40.0 / 60});
      const double drift = flight->end().position.z;
      EXPECT_GT(drift, .1);
      EXPECT_NEAR(batch.at(0).position.z, drift, .005 * drift) << ground;
    }
}

TEST(Batch, SameBitsForAnyWidthAndAnyCut) {
  const auto fly_all = [](int lanes, bool cut) {
    ProjectileBatch batch(DragCurve(DragFunction::g1), windy(), {}, lanes);
    math::Random random(11);
    for (int i = 0; i < 77; ++i) batch.add(draw(random), 1e-3 * (1 + i % 5));
    for (int i = 0; i < 200; ++i) {
      if (i == 50) batch.remove(10);
      if (cut) {
        batch.step(1.0 / 60, 0, 32);
        batch.step(1.0 / 60, 32, batch.size());
      } else {
        batch.step(1.0 / 60);
      }
    }
    std::vector<float> all;
    for (int k = 0; k < 6; ++k) all.insert(all.end(), batch.array(k).begin(), batch.array(k).end());
    return all;
  };
  const std::vector<float> four = fly_all(4, false);
  for (const int lanes : {8, 16})
    EXPECT_EQ(std::memcmp(four.data(), fly_all(lanes, false).data(), four.size() * sizeof(float)), 0) << lanes;
  EXPECT_EQ(std::memcmp(four.data(), fly_all(0, true).data(), four.size() * sizeof(float)), 0);
}

// Dust that drag stops within a ten-thousandth of a step slows down without a leap, and sinks at its terminal speed,
// √(2 g/(ρ C_D A/m)); a bullet beside it flies as alone.
TEST(Batch, DustSlowsDown) {
  for (const int lanes : {4, 8, 16}) {
    ProjectileBatch batch(DragCurve(1.1), {.air = environment::AirColumn::uniform(1.225)}, {}, lanes);
    const BatchRound dust = chunk_round(1e-13, 7850);
    batch.add({{}, {2000, 0, 0}}, dust);
    batch.add({{}, {800, 0, 0}}, chunk_round(.01));
    double before = 2000;
    for (int i = 0; i < 400; ++i) {
      batch.step(1.0 / 60);
      const double speed = batch.at(0).velocity.x;
      ASSERT_TRUE(speed <= before && speed >= -1e-3) << i;
      before = speed;
    }
    EXPECT_NEAR(batch.at(0).velocity.y, -math::sqrt(2 * 9.80665 / (1.225 * 1.1 * dust.area_per_mass)), 1e-3);
    EXPECT_LT(before, 1e-3);
    ProjectileBatch alone(DragCurve(1.1), {.air = environment::AirColumn::uniform(1.225)}, {}, lanes);
    alone.add({{}, {800, 0, 0}}, chunk_round(.01));
    for (int i = 0; i < 400; ++i) alone.step(1.0 / 60);
    EXPECT_EQ(alone.at(0).position, batch.at(1).position);
  }
}

// Vacuum: a parabola, to the rounding of floats. Faster than the table's end: its last value.
TEST(Batch, VacuumAndTheEndsOfTheTables) {
  ProjectileBatch vacuum(DragCurve(.3), {.air = environment::AirColumn::uniform(0)});
  vacuum.add({{}, {300, 400, 0}}, 1e-3);
  for (int i = 0; i < 600; ++i) vacuum.step(1.0 / 60);
  EXPECT_NEAR(vacuum.at(0).position.x, 3000, .01);
  EXPECT_NEAR(vacuum.at(0).position.y, 4000 - .5 * 9.80665 * 100, .04);
  ProjectileBatch fast(DragCurve(DragFunction::g7), {}, {0, 60000, 0});
  fast.add({{0, 60000, 0}, {5000, 0, 0}}, 1e-3);
  fast.add({{0, -9000, 0}, {5000, 0, 0}}, 1e-3);
  fast.step(.01);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(math::is_finite(fast.at(i).velocity.x));
    EXPECT_LT(fast.at(i).velocity.x, 5000);
  }
  EXPECT_NEAR(math::length(fast.previous_position(1) - Vec3d{0, -9000, 0}), 0, .01);
}

}  // namespace ballistics_batch_test
