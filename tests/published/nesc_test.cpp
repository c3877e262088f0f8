// NASA NESC six-degree-of-freedom check cases 01, 02 and 04.
// Sources: NASA/TM-2015-218675 and its data release (nasa/simupy-flight, NESC_data, simulations 04–06), in ft, slug,
// lbf, degrees. "Flat" rows are our own closed computation from the published equations.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "carom/rigid/free_body.h"

namespace nesc_test {
using namespace carom;
using math::Mat3d;
using math::Vec3d;
using rigid::FlightCase;
using rigid::FlightRow;
using rigid::FlightWorld;

constexpr double foot = 0.3048, slug = 14.593902937206365, pound_force = 4.4482216152605;
constexpr double slug_foot_2 = slug * foot * foot;
constexpr double degree = math::pi / 180;

std::vector<FlightRow> fly(const FlightCase& flight) {
  std::vector<FlightRow> rows;
  const core::Status status = rigid::simulate(flight, [&](const FlightRow& row) { rows.push_back(row); });
  EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().message);
  return rows;
}

FlightCase dropped_sphere() {
  FlightCase flight;
  flight.place = {0, 0, 30000 * foot};
  flight.mass = slug;
  flight.inertia = 3.6 * slug_foot_2 * Mat3d::identity();
  flight.dt = 0.01;
  flight.duration = 30;
  return flight;
}

TEST(NescCase01, DraglessSphereOverTheTurningEllipsoid) {
  FlightCase flight = dropped_sphere();
  flight.world = FlightWorld::earth;
  const std::vector<FlightRow> rows = fly(flight);
  ASSERT_EQ(rows.size(), 31u);
  // 1e-7 relative of the fall: a few units of the last printed digit.
  EXPECT_NEAR(rows[10].altitude / foot, 28400.2041, 2e-4);
  EXPECT_NEAR(rows[10].velocity_ned.z / foot, 319.967327, 1e-5);
  EXPECT_NEAR(rows[30].altitude / foot, 15598.9044, 2e-4);
  EXPECT_NEAR(rows[30].velocity_ned.z / foot, 960.293065, 1e-5);
  EXPECT_NEAR(rows[30].longitude / degree, 5.745522e-5, 2e-10);
  EXPECT_NEAR(rows[30].gravity / foot, 32.1507814, 1e-6);
}

FlightCase tumbling_brick(FlightWorld world) {
  FlightCase flight;
  flight.world = world;
  flight.place = {0, 0, 30000 * foot};
  flight.mass = 0.155404754 * slug;
  flight.inertia = slug_foot_2 * Mat3d::diagonal({0.001894220, 0.006211019, 0.007194665});
  flight.body_rates = degree * Vec3d{10, 20, 30};
  flight.dt = 0.001;
  flight.duration = 30;
  return flight;
}

struct BrickRow {
  int time;
  double p, q, r, yaw, pitch, roll;
};
void expect_rows(const std::vector<FlightRow>& rows, const BrickRow (&table)[4]) {
  for (const BrickRow& expected : table) {
    const FlightRow& row = rows[std::size_t(expected.time)];
    EXPECT_NEAR(row.time, expected.time, 1e-9);
    EXPECT_NEAR(row.body_rates.x / degree, expected.p, 1e-6) << "t = " << expected.time;
    EXPECT_NEAR(row.body_rates.y / degree, expected.q, 1e-6) << "t = " << expected.time;
    EXPECT_NEAR(row.body_rates.z / degree, expected.r, 1e-6) << "t = " << expected.time;
    EXPECT_NEAR(row.angles.yaw / degree, expected.yaw, 1e-3) << "t = " << expected.time;
    EXPECT_NEAR(row.angles.pitch / degree, expected.pitch, 1e-3) << "t = " << expected.time;
    EXPECT_NEAR(row.angles.roll / degree, expected.roll, 1e-3) << "t = " << expected.time;
  }
}

TEST(NescCase02, TumblingBrickOverAFlatWorld) {
  expect_rows(fly(tumbling_brick(FlightWorld::flat)),
              {{1, 4.2588419, 23.1199429, 28.3798178, 31.777675, 18.687210, 12.593744},
               {2, -1.7508153, 23.6495578, 28.0713200, 70.227533, 30.502825, 30.468180},
               {5, -16.9394851, 9.6319394, 33.4066281, -177.787099, 2.225186, 43.858348},
               {10, -2.4189022, -23.5525695, 28.1285926, -4.318611, 3.744485, -65.977250}});
}

TEST(NescCase02, TumblingBrickOverTheTurningEarth) {
  expect_rows(fly(tumbling_brick(FlightWorld::earth)),
              {{1, 4.2588419, 23.1199429, 28.3798178, 31.77647, 18.68941, 12.58999},
               {2, -1.7508153, 23.6495578, 28.0713200, 70.22587, 30.51069, 30.46490},
               {5, -16.9394851, 9.6319394, 33.4066281, -177.78629, 2.22438, 43.87924},
               {10, -2.4189022, -23.5525695, 28.1285926, -4.32134, 3.74134, -66.01900}});
}

TEST(NescCase02, EnergyAndAngularMomentumDoNotDrift) {
  const std::vector<FlightRow> rows = fly(tumbling_brick(FlightWorld::flat));
  EXPECT_NEAR(rows[0].twice_rotational_energy / slug_foot_2, 0.0027869533, 1e-10);
  EXPECT_NEAR(rows[0].angular_momentum / slug_foot_2, 0.00435900632, 1e-11);
  for (const FlightRow& row : rows) {
    EXPECT_NEAR(row.twice_rotational_energy / rows[0].twice_rotational_energy, 1, 1e-13) << row.time;
    EXPECT_NEAR(row.angular_momentum / rows[0].angular_momentum, 1, 1e-13) << row.time;
  }
}

FlightCase sphere_with_drag(FlightWorld world) {
  FlightCase flight = dropped_sphere();
  flight.world = world;
  flight.gravity = 0;
  flight.gm = 1.407644176e16 * foot * foot * foot;
  flight.radius = 20902255.199 * foot;
  flight.drag_coefficient = 0.1;
  flight.reference_area = 0.1963495 * foot * foot;
  return flight;
}

TEST(NescCase04, SphereWithDragOverARoundStillEarth) {
  FlightCase flight = sphere_with_drag(FlightWorld::round);
  flight.body_rates = degree * Vec3d{10, 20, 30};  // the published sphere turns; its force is given in body axes
  const std::vector<FlightRow> rows = fly(flight);
  // Simulation 05 of the data release. The table of vehicles.md shows the force along body z as "drag".
  const struct {
    int time;
    double altitude, down, mach;
    Vec3d force;
    double yaw, pitch, roll;
  } table[] = {{5,
                29598.890479,
                160.255298,
                0.160806865,
                {-0.112318304, -0.187085240, -0.0657347320},
                167.673107,
                -29.5277709,
                70.6404388},
               {10,
                28401.285052,
                318.198818,
                0.317661315,
                {0.116659854, -0.0736191676, -0.928369003},
                11.6615522,
                7.14012541,
                4.53403674},
               {20,
                23701.992393,
                616.341461,
                0.603340745,
                {0.948866070, -0.741485442, -3.98363113},
                24.1026126,
                13.1794397,
                10.5439765},
               {30,
                16231.306909,
                867.104777,
                0.823961735,
                {3.23329638, -3.10942606, -9.61245271},
                37.4532208,
                17.7466328,
                17.9253022}};
  for (const auto& expected : table) {
    const FlightRow& row = rows[std::size_t(expected.time)];
    EXPECT_NEAR(row.altitude / foot, expected.altitude, 1e-6 * expected.altitude) << expected.time;
    EXPECT_NEAR(row.velocity_ned.z / foot, expected.down, 1e-6 * expected.down) << expected.time;
    EXPECT_NEAR(row.mach, expected.mach, 2e-6 * expected.mach) << expected.time;
    const double drag = math::length(expected.force);
    EXPECT_NEAR(row.drag / pound_force, drag, 3e-6 * drag) << expected.time;
    EXPECT_LT(math::distance(row.drag_body / pound_force, expected.force), 3e-6 * drag) << expected.time;
    EXPECT_NEAR(row.angles.yaw / degree, expected.yaw, 1e-6) << expected.time;
    EXPECT_NEAR(row.angles.pitch / degree, expected.pitch, 1e-6) << expected.time;
    EXPECT_NEAR(row.angles.roll / degree, expected.roll, 1e-6) << expected.time;
  }
}

TEST(NescCase04, SphereWithDragOverAFlatWorldWithTheSameGravity) {
  const std::vector<FlightRow> rows = fly(sphere_with_drag(FlightWorld::flat));
  const struct {
    int time;
    double altitude, down;
  } table[] = {{5, 29598.89050, 160.255288},
               {10, 28401.28515, 318.198801},
               {20, 23701.99263, 616.341459},
               {30, 16231.30674, 867.104882}};
  for (const auto& expected : table) {
    const FlightRow& row = rows[std::size_t(expected.time)];
    EXPECT_NEAR(row.altitude / foot, expected.altitude, 1e-6 * expected.altitude) << expected.time;
    EXPECT_NEAR(row.velocity_ned.z / foot, expected.down, 1e-6 * expected.down) << expected.time;
  }
}

TEST(NescCases, AgreeBetweenIntegrators) {
  // The same flight by an adaptive-order formula: what is compared above is the model, not the method.
  FlightCase flight = sphere_with_drag(FlightWorld::round);
  const double reference = fly(flight).back().altitude;
  flight.method = ode::Method::dormand_prince;
  EXPECT_NEAR(fly(flight).back().altitude, reference, 1e-7);
  flight.method = ode::Method::heun;
  EXPECT_NEAR(fly(flight).back().altitude, reference, 1e-3);
}

}  // namespace nesc_test
