// Relations that hold whatever the numbers (shared reference "ballistics", section 4): scaling of coefficients and air,
// mirrors, reversals, systems of units, moving frames, energy that never rises. Of bullets, shells, balls and blasts;
// those of billiards, bounces and swings are in tests/sports.
#include <gtest/gtest.h>

#include "carom/ballistics/flight.h"
#include "carom/ballistics/shell.h"
#include "carom/ballistics/sights.h"
#include "carom/blast/wave.h"
#include "carom/math/elementary.h"
#include "carom/sports/flight.h"
#include "carom/sports/presets.h"

namespace published_metamorphic_test {
using namespace carom;
using math::Vec3d;

ballistics::Trajectory shoot(const ballistics::Projectile& projectile, const ballistics::Conditions& conditions,
                             Vec3d velocity, double time = 4) {
  const auto flight = ballistics::fly(projectile, conditions, {{}, velocity}, {.time = time, .tolerance = 1e-12});
  EXPECT_TRUE(flight) << flight.error().message;
  return *flight;
}

constexpr ballistics::DragFunction functions[] = {ballistics::DragFunction::g1, ballistics::DragFunction::g7,
                                                  ballistics::DragFunction::gs, ballistics::DragFunction::ra4};

// Density × k is the coefficient / k, wind and weight included.
TEST(Metamorphic, DenserAirIsASmallerCoefficient) {
  for (const ballistics::DragFunction function : functions)
    for (const double k : {.25, 3.0}) {
      const environment::WindColumn wind(Vec3d{-4, 0, 7});
      const ballistics::Conditions thick{.air = environment::AirColumn::uniform(1.225 * k), .wind = wind},
          plain{.air = environment::AirColumn::uniform(1.225), .wind = wind};
      const auto a = shoot(ballistics::projectile_from_coefficient(function, .4), thick, {600, 80, 3});
      const auto b = shoot(ballistics::projectile_from_coefficient(function, .4 / k), plain, {600, 80, 3});
      EXPECT_LT(math::length(a.end().position - b.end().position), 1e-8 * a.end().position.x);
    }
}

// Without weight the way flown down to a speed is proportional to the coefficient.
TEST(Metamorphic, WayIsProportionalToTheCoefficient) {
  const ballistics::Conditions weightless{.air = environment::AirColumn::uniform(1.225), .gravity = 0};
  for (const ballistics::DragFunction function : functions) {
    const auto way = [&](double coefficient) {
      const auto flight =
          shoot(ballistics::projectile_from_coefficient(function, coefficient), weightless, {800, 0, 0}, 12);
      return flight.first([](const auto& p) { return p.velocity.x - 420; })->position.x;
    };
    EXPECT_NEAR(way(.5) / way(.2), 2.5, 1e-6);
  }
}

TEST(Metamorphic, MirroredWindMirrorsTheDrift) {
  const auto bullet = ballistics::projectile_from_coefficient(ballistics::DragFunction::g7, .2);
  const auto land = [&](double across, double bearing) {
    ballistics::Conditions c;
    c.wind = environment::WindColumn(
        environment::Wind{.velocity = {2, 0, across}, .profile = environment::WindProfile::power}, 400);
    c.rotation = bearing * Vec3d{0, 1e-4, 0};  // about the vertical: mirrored, it turns the other way
    return shoot(bullet, c, {700, 150, 0}).end().position;
  };
  const Vec3d right = land(9, 1), left = land(-9, -1);
  EXPECT_NEAR(right.x, left.x, 1e-7);
  EXPECT_NEAR(right.y, left.y, 1e-7);
  EXPECT_NEAR(right.z, -left.z, 1e-7);
  EXPECT_GT(right.z, 1);
}

// The same shot in feet and in minutes: every result in the units of what went in.
TEST(Metamorphic, AnySystemOfUnits) {
  const auto bullet = ballistics::projectile_from_coefficient(ballistics::DragFunction::g7, .25);
  const Vec3d muzzle{780, 60, 0}, wind{-3, 0, 5};
  const ballistics::Conditions si{.air = environment::AirColumn::uniform(1.225, 340.294),
                                  .wind = environment::WindColumn(wind),
                                  .gravity = 9.80665};
  const auto meters = shoot(bullet, si, muzzle);
  for (const double length : {.3048, 25.0})
    for (const double time : {1.0, 60.0, 1e-2}) {
      const double speed = length / time;
      auto other = bullet;
      other.area_per_mass /= length * length;
      const ballistics::Conditions units{
          .air = environment::AirColumn::uniform(1.225 * length * length * length, 340.294 / speed),
          .wind = environment::WindColumn(wind / speed),
          .gravity = 9.80665 * time * time / length};
      const auto flight = shoot(other, units, muzzle / speed, 4 / time);
      EXPECT_LT(math::length(length * flight.end().position - meters.end().position), 2e-6) << length << ' ' << time;
      EXPECT_LT(math::length(speed * flight.end().velocity - meters.end().velocity), 2e-6) << length << ' ' << time;
    }
}

// Uniform wind is a frame that moves.
TEST(Metamorphic, WindIsAMovingFrame) {
  const auto bullet = ballistics::projectile_from_coefficient(ballistics::DragFunction::g1, .3);
  const Vec3d wind{6, 0, -11};
  ballistics::Conditions still{.air = environment::AirColumn::uniform(1.225)}, windy = still;
  windy.wind = environment::WindColumn(wind);
  const auto a = shoot(bullet, windy, {500, 100, 0}), b = shoot(bullet, still, Vec3d{500, 100, 0} - wind);
  for (const double t : {.5, 2.0, 4.0}) EXPECT_LT(math::length(a.at(t).position - b.at(t).position - t * wind), 1e-6);
}

TEST(Metamorphic, VacuumTurnsBack) {
  const ballistics::Conditions vacuum{.air = environment::AirColumn::uniform(0)};
  const auto there = shoot({}, vacuum, {120, 300, -40}, 30);
  const auto back = ballistics::fly({}, vacuum, {there.end().position, -1.0 * there.end().velocity},
                                    {.time = 30, .tolerance = 1e-12});
  ASSERT_TRUE(back);
  EXPECT_LT(math::length(back->end().position), 1e-7);
}

// A twist the other way throws the shell as far to the other side; so do sights that reckon spin drift.
TEST(Metamorphic, SpinReversalFlipsTheDrift) {
  ballistics::Shell left = ballistics::m107();
  left.twist = -left.twist;
  const auto fire = [](const ballistics::Shell& shell) {
    return ballistics::fly_shell(shell, {}, {{}, 400 * ballistics::direction(.5)},
                                 ballistics::ShellModel::modified_point_mass, {.time = 100, .ground = 0})
        ->path.end()
        .position;
  };
  const Vec3d a = fire(ballistics::m107()), b = fire(left);
  EXPECT_GT(a.z, 10);
  EXPECT_NEAR(a.z, -b.z, 1e-7 * a.z);
  EXPECT_NEAR(a.x, b.x, 1e-7 * a.x);
}

// Without wind the air only takes.
TEST(Metamorphic, EnergyNeverRisesInStillAir) {
  for (const ballistics::DragFunction function : functions) {
    const auto flight = shoot(ballistics::projectile_from_coefficient(function, .15), {}, {700, 300, 20}, 20);
    double before = 1e300;
    for (int i = 0; i <= 400; ++i) {
      const auto p = flight.at(flight.duration() * i / 400);
      const double energy = .5 * math::dot(p.velocity, p.velocity) + 9.80665 * p.position.y;
      EXPECT_LT(energy, before + 1e-6);
      before = energy;
    }
  }
}

// Every length and time of a burst goes with the cube root of the charge.
TEST(Metamorphic, BlastsScaleWithTheCubeRoot) {
  for (const double charge : {8.0, 1000.0})
    for (double z = .3; z < 39; z *= 1.4) {
      const double k = math::cbrt(charge);
      const blast::Wave one = blast::blast_wave(1, z).value(), large = blast::blast_wave(charge, k * z).value();
      EXPECT_NEAR(large.pressure / one.pressure, 1, 1e-9);
      EXPECT_NEAR(large.reflected_pressure / one.reflected_pressure, 1, 1e-9);
      EXPECT_NEAR(large.front_speed / one.front_speed, 1, 1e-9);
      EXPECT_NEAR(large.arrival / one.arrival, k, 1e-9 * k);
      EXPECT_NEAR(large.duration / one.duration, k, 1e-9 * k);
      EXPECT_NEAR(large.impulse / one.impulse, k, 1e-9 * k);
      EXPECT_NEAR(large.reflected_impulse / one.reflected_impulse, k, 1e-9 * k);
    }
}

// Spin the other way about the vertical bends the ball as far to the other side; of every ball that spin lifts.
TEST(Metamorphic, BallsCurveTheOtherWay) {
  for (const sports::BallPreset& preset : sports::ball_presets()) {
    if (preset.ball.lift.maximum == 0 || preset.ball.side.kind != sports::SideForce::Kind::none) continue;
    const auto land = [&](double spin) {
      const auto flight =
          sports::fly(preset.ball, {}, {.position = {0, 1, 0}, .velocity = {28, 6, 0}, .spin = {0, spin, 0}});
      EXPECT_TRUE(flight) << preset.name;
      return flight->end().position;
    };
    const Vec3d left = land(80), right = land(-80), straight = land(0);
    EXPECT_NEAR(left.x, right.x, 1e-7) << preset.name;
    EXPECT_NEAR(left.z, -right.z, 1e-7) << preset.name;
    EXPECT_LT(left.z, -.01) << preset.name;
    EXPECT_NEAR(straight.z, 0, 1e-12);
  }
}

}  // namespace published_metamorphic_test
