// Laws of ball flight and bounce: scaling, mirrors, reversal, units, energy; the same flight alone and as a body of a
// world; bad input. Published numbers are in tests/published/chapter_19_*_test.cpp.
#include "carom/sports/flight.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/rigid/world.h"
#include "carom/sports/bounce.h"
#include "carom/sports/effector.h"
#include "carom/sports/presets.h"

namespace sports_flight_test {
using namespace carom;
using namespace carom::sports;

const Launch drive{.speed = 60, .elevation = .25, .azimuth = .1, .spin = 280, .tilt = .3, .gyro = 20};

TEST(SportsFlight, PresetsAreSound) {
  EXPECT_GE(ball_presets().size(), 13u);
  for (const BallPreset& preset : ball_presets()) {
    ASSERT_TRUE(check(preset.ball)) << preset.name;
    EXPECT_GT(preset.source.size(), 20u);
    EXPECT_GT(preset.drag_band, 0);
    EXPECT_EQ(preset.lift_band > 0, preset.ball.lift.maximum != 0 || preset.ball.side.kind != SideForce::Kind::none)
        << preset.name;
    const auto flight = fly(preset.ball, {}, launch_state({.speed = 30, .elevation = .3, .spin = 100}, {0, 1, 0}));
    ASSERT_TRUE(flight) << flight.error().message;
    EXPECT_GT(landing(*flight).carry, 5) << preset.name;
    // Numbers out and in again give the same ball.
    std::vector<Number> numbers;
    const std::vector<double> values = ball_numbers(preset.ball);
    for (std::size_t i = 0; i < values.size(); ++i) numbers.push_back({ball_number_names()[i].name, values[i]});
    const char* const sides[] = {"none", "held_seam", "turning_seam", "wandering_wake"};
    const auto again = ball_from_numbers(numbers, sides[int(preset.ball.side.kind)], to_string(preset.ball.lift.shape));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(ball_numbers(*again), values);
    EXPECT_EQ(again->side.kind, preset.ball.side.kind);
    EXPECT_EQ(again->lift.shape, preset.ball.lift.shape);
  }
  for (const SurfacePreset& preset : surface_presets()) EXPECT_TRUE(check(preset.surface)) << preset.name;
  EXPECT_EQ(ball_preset("egg").error().message.substr(0, 41), "the ball \"egg\" is not known, expected one");
  EXPECT_FALSE(surface_preset("lava"));
}

TEST(SportsFlight, LaunchAndStateAreInverse) {
  const Launch found = launch_of(launch_state(drive));
  EXPECT_NEAR(found.speed, drive.speed, 1e-12);
  EXPECT_NEAR(found.elevation, drive.elevation, 1e-12);
  EXPECT_NEAR(found.azimuth, drive.azimuth, 1e-12);
  EXPECT_NEAR(found.spin, drive.spin, 1e-9);
  EXPECT_NEAR(found.tilt, drive.tilt, 1e-12);
  EXPECT_NEAR(found.gyro, drive.gyro, 1e-9);
}

// Mirrored spin and direction mirror the flight, bit for bit in what matters: to 1e-9 m.
TEST(SportsFlight, Mirror) {
  for (const char* name : {"golf", "baseball", "soccer", "cricket"}) {
    Ball ball = *ball_preset(name);
    Ball image = ball;
    ball.side.seam_normal = {-math::sin(.2), 0, math::cos(.2)};
    image.side.seam_normal = {-math::sin(-.2), 0, math::cos(-.2)};
    Launch right = drive, left = drive;
    left.azimuth = -right.azimuth;
    left.tilt = -right.tilt;
    left.gyro = -right.gyro;
    Conditions wind, calm;
    wind.wind = environment::WindColumn(Vec3d{1, 0, 4});
    calm.wind = environment::WindColumn(Vec3d{1, 0, -4});
    const auto a = fly(ball, wind, launch_state(right)), b = fly(image, calm, launch_state(left));
    ASSERT_TRUE(a && b);
    const Vec3d p = a->end().position, q = b->end().position;
    EXPECT_NEAR(p.x, q.x, 1e-7) << name;
    EXPECT_NEAR(p.z, -q.z, 1e-7) << name;
  }
}

// Galilei: in uniform wind w the ball flies as in still air seen from a frame that moves with w.
TEST(SportsFlight, WindIsAMovingFrame) {
  const Ball ball = *ball_preset("golf");
  const Vec3d w{-6, 0, 3};
  Conditions windy;
  windy.wind = environment::WindColumn(w);
  BallState start = launch_state(drive);
  const auto blown = fly(ball, windy, start);
  start.velocity -= w;
  const auto still = fly(ball, {}, start);
  ASSERT_TRUE(blown && still);
  for (const double t : {.5, 2.0, 4.0})
    EXPECT_LT(math::length(blown->at(t).position - still->at(t).position - t * w), 1e-6);
}

// The model knows no unit: lengths × k, times × √k (so that g stays), density/k, viscosity × √k keep Re, S and F/mg.
TEST(SportsFlight, Scaling) {
  const Ball ball = *ball_preset("golf");
  const double k = 3.7;
  Ball large = ball;
  large.radius *= k;
  Conditions thin;
  thin.air = environment::AirColumn::uniform(1.225 / (k * k * k));
  thin.viscosity = 1.7894e-5 * math::sqrt(k) / (k * k);
  BallState start = launch_state(drive), big = start;
  big.velocity = math::sqrt(k) * start.velocity;
  big.spin = start.spin / math::sqrt(k);
  const auto a = fly(ball, {}, start), b = fly(large, thin, big);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(landing(*b).carry, k * landing(*a).carry, 1e-6 * k * 100);
  EXPECT_NEAR(landing(*b).time, math::sqrt(k) * landing(*a).time, 1e-6);
  EXPECT_NEAR(landing(*b).spin, landing(*a).spin / math::sqrt(k), 1e-6);
}

TEST(SportsFlight, VacuumIsAParabolaAndTurnsBack) {
  const Conditions vacuum{.air = environment::AirColumn::uniform(0)};
  const auto flight = fly(*ball_preset("soccer"), vacuum, launch_state({.speed = 50, .elevation = math::pi / 4}));
  ASSERT_TRUE(flight);
  EXPECT_NEAR(landing(*flight).carry, 2500 / 9.80665, 1e-7);
  BallState back = flight->end();
  back.velocity = -1.0 * back.velocity;
  back.position.y = 1e-9;
  const auto returned = fly(*ball_preset("soccer"), vacuum, back);
  ASSERT_TRUE(returned);
  EXPECT_LT(math::length(returned->end().position), 1e-6);
}

// Without wind the air only takes: energy never rises, and neither does spin.
TEST(SportsFlight, AirTakesEnergy) {
  for (const BallPreset& preset : ball_presets()) {
    const auto flight = fly(preset.ball, {}, launch_state({.speed = 40, .elevation = .5, .spin = 150, .tilt = .4}));
    ASSERT_TRUE(flight);
    double energy = 1e300, spin = 1e300;
    for (int i = 0; i <= 50; ++i) {
      const auto p = flight->at(flight->duration() * i / 50);
      const double e = .5 * math::dot(p.velocity, p.velocity) + 9.80665 * p.position.y, w = math::length(p.spin);
      EXPECT_LT(e, energy * (1 + 1e-7)) << preset.name;
      EXPECT_LE(w, spin * (1 + 1e-12)) << preset.name;
      energy = e;
      spin = w;
    }
  }
}

TEST(SportsFlight, SpinFallsExponentiallyWithTheWay) {
  // ω̇ = −k V ω: ω falls by e with every 1/k metres flown through the air; k = ρ A C_m/(2 β m).
  const Ball golf = *ball_preset("golf");
  const auto flight = fly(golf, {}, launch_state({.speed = 70, .elevation = .2, .spin = 280}));
  ASSERT_TRUE(flight);
  double way = 0;
  Vec3d last = flight->start().position;
  for (int i = 1; i <= 4000; ++i) {
    const Vec3d p = flight->at(flight->duration() * i / 4000).position;
    way += math::length(p - last);
    last = p;
  }
  const double k = 1.225 * area(golf) * golf.spin_damping / (2 * golf.inertia_factor * golf.mass);
  EXPECT_NEAR(landing(*flight).spin, 280 * math::exp(-k * way), 1e-3);
  EXPECT_NEAR(k * golf.radius, 2e-5, 2e-6) << "Smits & Ogg 2004: spin rate decays as 2e-5 V w/r";
}

// Cricket: the ball swings to where the seam points, and the other way when it is too fast.
TEST(SportsFlight, SeamsPushAside) {
  Ball ball = *ball_preset("cricket");
  ball.side.seam_normal = {-math::sin(.35), 0, math::cos(.35)};  // the seam points 20° to the right
  const Vec3d slow = air_load(ball, {}, {.velocity = {30, 0, 0}}).force,
              fast = air_load(ball, {}, {.velocity = {44, 0, 0}}).force;
  EXPECT_GT(slow.z, .33 * ball.mass * 9.81);
  EXPECT_LT(fast.z, 0);
  EXPECT_NEAR(slow.y, 0, 1e-12);
  Ball knuckle = *ball_preset("knuckleball");
  const BallMotion turning{.velocity = {30, 0, 0}, .spin = {0, 5, 0}, .turned = math::pi / 8};
  EXPECT_GT(math::abs(air_load(knuckle, {}, turning).force.z), .1 * knuckle.mass * 9.81);
  BallMotion quarter = turning;
  quarter.turned += math::pi / 4;  // half of one of four cycles: the other side
  EXPECT_NEAR(air_load(knuckle, {}, quarter).force.z, -air_load(knuckle, {}, turning).force.z, 1e-12);
  Ball flutter = *ball_preset("floating_soccer");
  Ball other = flutter;
  other.side.seed = 7;
  const BallMotion later{.velocity = {28, 0, 0}, .time = .3};
  EXPECT_NE(air_load(flutter, {}, later).force.z, air_load(other, {}, later).force.z);
  EXPECT_EQ(air_load(flutter, {}, later).force.z, air_load(flutter, {}, later).force.z);
}

// A body of a world with the effector flies as the ball alone; the difference falls with the square of the step.
TEST(SportsFlight, BodyOfAWorldFliesTheSame) {
  const Ball ball = *ball_preset("baseball");
  Conditions conditions;
  conditions.wind = environment::WindColumn(Vec3d{2, 0, -3});
  const BallState start = launch_state({.speed = 44, .elevation = .5, .spin = 200, .tilt = .5}, {0, 1, 0});
  const auto alone = fly(ball, conditions, start);
  ASSERT_TRUE(alone);
  double error[2] = {};
  for (int k = 0; k < 2; ++k) {
    rigid::World3 world({.gravity = {0, -9.80665f, 0}});
    rigid::BodyDef<rigid::Dim3> def;
    def.position = start.position;
    def.linear_velocity = math::Vec3f(start.velocity);
    def.angular_velocity = math::Vec3f(start.spin);
    const rigid::BodyId body = world.create_body(def).value();
    rigid::ShapeDef<rigid::Dim3> shape;
    shape.density = float(ball.mass / (4.0 / 3 * math::pi * ball.radius * ball.radius * ball.radius));
    ASSERT_TRUE(world.add_shape(body, geometry::Sphere{float(ball.radius)}, shape));
    const int steps = k == 0 ? 90 : 180;
    ASSERT_TRUE(world.add_effector(flight_effector(ball, conditions, body, 3.0 / steps)));
    for (int i = 0; i < steps; ++i) ASSERT_TRUE(world.step(3.0f / float(steps)));
    error[k] = math::length(world.state(body)->center_of_mass - alone->at(3).position);
    EXPECT_NEAR(world.state(body)->angular_velocity.z, alone->at(3).spin.z, .3);
  }
  EXPECT_LT(error[1], 2e-3) << "60 Hz, after 3 s and 100 m";
  EXPECT_LT(error[1], .4 * error[0]) << "second order, down to what floats hold";
}

TEST(SportsFlight, BadInputIsNamed) {
  const double nan = __builtin_nan("");
  Ball ball = *ball_preset("golf");
  ball.mass = nan;
  EXPECT_EQ(fly(ball, {}, launch_state(drive)).error().message.substr(0, 14), "mass of a ball");
  ball = *ball_preset("golf");
  ball.side.seam_normal = {0, 0, 2};
  EXPECT_FALSE(check(ball));
  ball = *ball_preset("golf");
  ball.grid.speeds = {10, 20};
  EXPECT_FALSE(check(ball));
  ball.grid.spins = {0};
  ball.grid.drag = {.3, .2};
  ball.grid.lift = {.1, nan};
  EXPECT_FALSE(check(ball));
  ball.grid.lift = {.1, .2};
  EXPECT_TRUE(check(ball));
  ball.grid.speeds = {20, 10};
  EXPECT_FALSE(check(ball));
  const Ball golf = *ball_preset("golf");
  EXPECT_FALSE(fly(golf, {}, {.position = {0, nan, 0}}));
  EXPECT_FALSE(fly(golf, {}, {.velocity = {0, 1, __builtin_inf()}}));
  EXPECT_FALSE(fly(golf, {}, {.velocity = {5, -1, 0}})) << "starts on the ground and goes down";
  EXPECT_FALSE(fly(golf, {}, launch_state(drive), 0, {.time = -1}));
  EXPECT_FALSE(fly(golf, {}, launch_state(drive), 0, {.tolerance = 0}));
  EXPECT_FALSE(fly(golf, {.gravity = nan}, launch_state(drive)));
  const Number twice[] = {{"mass", 1}, {"mass", 2}}, unknown[] = {{"weight", 1}}, bad[] = {{"drag", -1}};
  EXPECT_EQ(ball_from_numbers(twice).error().message, "mass of a ball is given twice");
  EXPECT_EQ(ball_from_numbers(unknown).error().message, "a ball has no number \"weight\"");
  EXPECT_FALSE(ball_from_numbers(bad));
  EXPECT_FALSE(ball_from_numbers({}, "spiral"));
  EXPECT_FALSE(ball_from_numbers({}, "none", "square"));
  Surface grass = *surface_preset("green");
  grass.restitution = 1.2;
  EXPECT_FALSE(play(golf, {}, launch_state(drive), grass));
  EXPECT_FALSE(play(golf, {}, launch_state(drive), *surface_preset("green"), {.time = 0}));
}

}  // namespace sports_flight_test
