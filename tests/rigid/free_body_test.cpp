// The double-precision reference body: invariants, the intermediate axis, a top, attitudes, and what it refuses.
#include "carom/rigid/free_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace free_body_test {
using namespace carom;
using math::Mat3d;
using math::Quatd;
using math::Vec3d;
using rigid::FlightCase;
using rigid::FreeBody;
using rigid::FreeBodyLoad;
using rigid::FreeBodyState;

constexpr double degree = math::pi / 180;
const auto no_load = [](double, const FreeBodyState&) { return FreeBodyLoad{}; };

TEST(FreeBody, KeepsEnergyAndAngularMomentumWithAFullTensor) {
  const FreeBody body = rigid::make_free_body(3, {{2, 0.3, -0.1}, {0.3, 3, 0.2}, {-0.1, 0.2, 4}}).value();
  FreeBodyState state{{1, 2, 3}, {4, 5, 6}, math::normalize(Quatd{1, 2, -1, 0.5}), {1, -2, 1.5}};
  const double energy = rigid::twice_rotational_energy(body, state);
  const Vec3d momentum = rigid::angular_momentum(body, state);
  for (int i = 0; i < 10000; ++i)
    ASSERT_EQ(rigid::step(ode::Method::rk4, body, no_load, 0, state, 0.001), ode::Outcome::done);
  EXPECT_NEAR(rigid::twice_rotational_energy(body, state) / energy, 1, 1e-12);
  EXPECT_LT(math::distance(rigid::angular_momentum(body, state), momentum), 1e-11 * math::length(momentum));
  EXPECT_LT(math::distance(state.position, Vec3d{41, 52, 63}), 1e-10) << "straight on";
  EXPECT_NEAR(math::length(state.attitude), 1, 1e-15);
}

// Growth rate of a small disturbance about the middle axis: σ = Ω √((I₂ − I₁)(I₃ − I₂)/(I₁I₃)) = .5582 Ω for the brick
// of NESC case 02 (shared reference "mechanics" 12.2).
TEST(FreeBody, IntermediateAxisGrowthRate) {
  const Vec3d moments{0.001894220, 0.006211019, 0.007194665};
  const FreeBody body = rigid::make_free_body(1, Mat3d::diagonal(moments)).value();
  const double spin = 3, sigma = 0.5582 * spin;
  FreeBodyState state{{}, {}, {}, {1e-8, spin, 0}};
  const auto size = [&] {
    // The growing combination of p and r.
    const double a = std::sqrt(moments.x * (moments.y - moments.x)), c = std::sqrt(moments.z * (moments.z - moments.y));
    return std::hypot(a * state.angular_velocity.x, c * state.angular_velocity.z);
  };
  const auto fly = [&](double seconds) {
    for (int i = 0; i < int(seconds * 1000 + 0.5); ++i)
      ASSERT_EQ(rigid::step(ode::Method::rk4, body, no_load, 0, state, 0.001), ode::Outcome::done);
  };
  fly(2);
  const double before = size();
  fly(3);
  EXPECT_NEAR(std::log(size() / before) / 3, sigma, 1e-3 * sigma);
}

// A fast top: precession m g l/(I ω) (12.2), here about the centre of mass with the moment of the weight.
TEST(FreeBody, FastTopPrecesses) {
  const double axial = 0.02, across = 0.03, spin = 400, moment = 0.5;
  const FreeBody body = rigid::make_free_body(1, Mat3d::diagonal({axial, across, across})).value();
  FreeBodyState state{{}, {}, {}, {spin, 0, 0}};
  // A constant torque at right angles to the axle and the vertical z.
  const auto load = [&](double, const FreeBodyState& y) {
    const Vec3d axle = math::rotate(y.attitude, Vec3d{1, 0, 0});
    return FreeBodyLoad{{}, math::inverse_rotate(y.attitude, math::cross(Vec3d{0, 0, moment}, axle))};
  };
  // Started with the steady precession itself, so that it does not nod.
  const double rate = moment / (axial * spin);
  state.angular_velocity = {spin, 0, rate};
  for (int i = 0; i < 20000; ++i)
    ASSERT_EQ(rigid::step(ode::Method::rk4, body, load, 0, state, 1e-4), ode::Outcome::done);
  const Vec3d axle = math::rotate(state.attitude, Vec3d{1, 0, 0});
  EXPECT_NEAR(std::atan2(axle.y, axle.x), rate * 2, 1e-3 * rate * 2);
  EXPECT_NEAR(axle.z, 0, 1e-3);
}

// Every method of the integrator room drives it; the symplectic needs of two of them are refused with a reason.
TEST(FreeBody, TakesEveryMethod) {
  const FreeBody body = rigid::make_free_body(1, Mat3d::diagonal({1, 2, 2.5})).value();
  for (const auto name : ode::method_names) {
    const ode::Method method = *ode::method_from_name(name);
    FreeBodyState state{{}, {1, 0, 0}, {}, {0.3, 0.2, 0.1}};
    const ode::Outcome outcome = rigid::step(method, body, no_load, 0, state, 0.01);
    EXPECT_EQ(outcome, ode::needs_velocities(method) ? ode::Outcome::not_partitioned : ode::Outcome::done) << name;
    if (outcome == ode::Outcome::done) {
      EXPECT_NEAR(state.position.x, 0.01, 1e-15);
    }
  }
}

TEST(FreeBody, AnglesRoundTripAndSurviveTheGimbal) {
  for (int yaw = -170; yaw <= 180; yaw += 35)
    for (int pitch = -85; pitch <= 85; pitch += 17)
      for (int roll = -175; roll <= 180; roll += 41) {
        const rigid::FlightAngles angles{yaw * degree, pitch * degree, roll * degree};
        const rigid::FlightAngles back = rigid::to_flight_angles(rigid::to_attitude(angles));
        EXPECT_NEAR(std::remainder(back.yaw - angles.yaw, 2 * math::pi), 0, 1e-12);
        EXPECT_NEAR(back.pitch, angles.pitch, 1e-12);
        EXPECT_NEAR(std::remainder(back.roll - angles.roll, 2 * math::pi), 0, 1e-12);
      }
  for (const double pitch : {90 * degree, -90 * degree}) {
    const Quatd attitude = rigid::to_attitude({0.7, pitch, 0.4});
    const Quatd back = rigid::to_attitude(rigid::to_flight_angles(attitude));
    EXPECT_NEAR(std::abs(math::dot(attitude, back)), 1, 1e-12) << "the same attitude";
  }
  // 30/40/50° (z-y-x): q of the shared reference 11.3.
  const Quatd q = rigid::to_attitude({50 * degree, 40 * degree, 30 * degree});
  EXPECT_NEAR(q.w, 0.860042, 5e-7);
  EXPECT_NEAR(q.x, 0.080805, 5e-7);
  EXPECT_NEAR(q.y, 0.402198, 5e-7);
  EXPECT_NEAR(q.z, 0.303372, 5e-7);
}

TEST(FreeBody, RefusesImpossibleMassProperties) {
  EXPECT_NE(rigid::make_free_body(0, Mat3d::identity()).error().message.find("mass is 0"), std::string::npos);
  EXPECT_FALSE(rigid::make_free_body(NAN, Mat3d::identity()).ok());
  EXPECT_FALSE(rigid::make_free_body(1, Mat3d::diagonal({1, 1, -1})).ok());
  EXPECT_FALSE(rigid::make_free_body(1, Mat3d::diagonal({1, 1, 2.1})).ok()) << "triangle inequality";
  EXPECT_TRUE(rigid::make_free_body(1, Mat3d::diagonal({1, 1, 2})).ok()) << "a disc is allowed";
  EXPECT_FALSE(rigid::make_free_body(1, {{1, 0.5, 0}, {0, 1, 0}, {0, 0, 1}}).ok()) << "not symmetric";
  EXPECT_FALSE(rigid::make_free_body(1, Mat3d::diagonal({1, NAN, 1})).ok());
}

TEST(Flight, RefusesBadFieldsByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [](const FlightCase& flight) {
    int rows = 0;
    const core::Status status = rigid::simulate(flight, [&](const rigid::FlightRow&) { ++rows; });
    EXPECT_EQ(rows, 0);
    return status.ok() ? std::string("accepted") : status.error().message;
  };
  const auto names = [&](const FlightCase& flight, const char* field) {
    EXPECT_NE(message(flight).find(field), std::string::npos) << message(flight);
  };
  names({.velocity_ned = {0, nan, 0}}, "velocity_ned");
  names({.body_rates = {0, nan, 0}}, "body_rates");
  names({.gravity = nan}, "gravity");
  names({.gravity = -1}, "gravity");
  names({.radius = 0}, "radius");
  names({.place = {2, 0, 0}}, "place.latitude");
  names({.angles = {0, 0, HUGE_VAL}}, "angles.roll");
  names({.mass = -2}, "mass");
  names({.drag_coefficient = -0.1}, "drag_coefficient");
  names({.dt = 0}, "dt");
  names({.dt = 1e-9, .duration = 1e5}, "duration");
  names({.output_interval = nan}, "output_interval");
}

TEST(Flight, EndsWithAReasonWhereTheIntegratorFails) {
  FlightCase flight{.method = ode::Method::velocity_verlet};
  const core::Status status = rigid::simulate(flight, [](const rigid::FlightRow&) {});
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("velocity_verlet"), std::string::npos);
  EXPECT_NE(status.error().message.find("positions and velocities"), std::string::npos);
  // Quadratic drag with an absurd step diverges, and is reported, not returned as numbers.
  FlightCase wild{.velocity_ned = {1e5, 0, 0},
                  .drag_coefficient = 100,
                  .reference_area = 100,
                  .method = ode::Method::euler,
                  .dt = 1};
  EXPECT_FALSE(rigid::simulate(wild, [](const rigid::FlightRow&) {}).ok());
}

// Uniform gravity: ½ g t² to rounding, rows at the start, every interval and the end.
TEST(Flight, FlatFallAndItsRows) {
  FlightCase flight{
      .place = {0, 0, 1000}, .velocity_ned = {30, 0, 0}, .dt = 0.1, .duration = 3.25, .output_interval = 1};
  std::vector<rigid::FlightRow> rows;
  ASSERT_TRUE(rigid::simulate(flight, [&](const rigid::FlightRow& row) { rows.push_back(row); }).ok());
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].time, 0);
  EXPECT_NEAR(rows[4].time, 3.3, 1e-12) << "whole steps";
  for (const rigid::FlightRow& row : rows) {
    EXPECT_NEAR(row.altitude, 1000 - 0.5 * 9.80665 * row.time * row.time, 1e-11);
    EXPECT_NEAR(row.velocity_ned.x, 30, 1e-13);
  }
}

// A circular orbit over the round world comes back after Kepler's period.
TEST(Flight, RoundWorldOrbit) {
  const double radius = 6371000, altitude = 400000, r = radius + altitude;
  FlightCase flight{.world = rigid::FlightWorld::round,
                    .radius = radius,
                    .place = {0, 0, altitude},
                    .velocity_ned = {0, std::sqrt(environment::earth_gm / r), 0},
                    .dt = 1};
  flight.duration = flight.output_interval = 5400;
  rigid::FlightRow last;
  ASSERT_TRUE(rigid::simulate(flight, [&](const rigid::FlightRow& row) { last = row; }).ok());
  const double turned = 5400 * std::sqrt(environment::earth_gm / r) / r;
  EXPECT_NEAR(last.altitude, altitude, 1e-3);
  EXPECT_NEAR(std::remainder(last.longitude - turned, 2 * math::pi), 0, 1e-9);
  EXPECT_NEAR(last.latitude, 0, 1e-12);
}

}  // namespace free_body_test
