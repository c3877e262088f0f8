// Random cases for the aim solver.
#pragma once

#include <cstdlib>

#include "carom/ballistics/aim.h"
#include "carom/ballistics/detail/aim_solver.h"
#include "carom/math/random.h"

namespace ballistics_aim_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

struct Case {
  Projectile projectile;
  Conditions conditions;
  Shooter shooter;
  Target target;
};

inline Case draw(math::Random& random) {
  Case c;
  const double kind = random.uniform();
  if (kind < .35)
    c.projectile = projectile_from_terminal_speed(random.uniform(20.0, 300.0));
  else if (kind < .7)
    c.projectile = projectile_from_coefficient(DragFunction::g7, random.uniform(.1, .6));
  else if (kind < .9)
    c.projectile =
        projectile_from_size(DragCurve(DragFunction::gs), random.uniform(1.0, 20.0), random.uniform(.05, .2));
  if (random.chance(.5)) c.conditions.air = environment::AirColumn::uniform(1.225);
  c.conditions.wind = environment::WindColumn(Vec3d{random.uniform(-12.0, 12.0), 0, random.uniform(-12.0, 12.0)});
  c.shooter.muzzle_speed = random.uniform(30.0, 900.0);
  if (random.chance(.5)) c.shooter.velocity = random.uniform(0.0, .3) * c.shooter.muzzle_speed * random.in_sphere();
  c.shooter.muzzle = {random.uniform(-50.0, 50.0), random.uniform(0.0, 300.0), random.uniform(-50.0, 50.0)};
  const double reach = math::min(c.shooter.muzzle_speed * c.shooter.muzzle_speed / 9.8, 2500.0);
  Vec3d way = random.uniform(.02, 1.0) * reach * random.on_sphere();
  way.y *= .3;
  c.target.position = c.shooter.muzzle + way;
  if (random.chance(.6)) {
    c.target.velocity = random.uniform(0.0, .4) * c.shooter.muzzle_speed * random.in_sphere();
    c.target.velocity.y *= .2;
  }
  return c;
}

/// How a target moves: it weaves about its way, circles, or patrols five seconds there and five back.
struct Motion {
  Target target;
  Vec3d one, other;
  double rate = 0, radius = 0;  // rad/s, m
  int kind = 0;
  Motion(math::Random& random, const Target& along, double fastest, double most_rate)
      : target(along), rate(random.uniform(0.05, most_rate)) {
    radius = random.uniform(0.0, fastest) / rate;
    one = random.on_sphere();
    other = random.on_sphere();
    kind = int(random.uniform(0.0, 3.0));
  }
  Vec3d operator()(double t) const {
    const Vec3d along = target.position + t * target.velocity;
    if (kind == 0) return along + radius * math::sin(rate * t) * one;
    if (kind == 1) return along + radius * (math::sin(rate * t) * one + math::cos(rate * t) * other);
    const double leg = t - 10 * math::floor(t / 10);
    return target.position + math::min(leg, 10 - leg) * target.velocity;
  }
};

/// Of the random cases: CAROM_AIM_CASES (10 000 have been run) and CAROM_AIM_SEED ask for others.
inline int cases_asked(int usual) {
  const char* asked = std::getenv("CAROM_AIM_CASES");
  return asked != nullptr ? std::atoi(asked) : usual;
}
inline math::Random random_asked(std::uint64_t usual) {
  const char* asked = std::getenv("CAROM_AIM_SEED");
  return math::Random(asked != nullptr ? std::uint64_t(std::atoi(asked)) : usual);
}

/// The earliest and the latest root, by walks through the flight times up to a minute, without guesses.
inline Aims by_scan(const Case& c, core::FunctionRef<Vec3d(double)> place) {
  Aims aims;
  const AimOptions options{.longest_time = 60};
  detail::AimSolver(c.projectile, c.conditions, c.shooter, place, options).scan(aims);
  return aims;
}
inline Aims by_scan(const Case& c) {
  return by_scan(c, [&](double t) { return c.target.position + t * c.target.velocity; });
}

/// How far the shot passes the target, by the exact integration.
inline double miss(const Case& c, const Shot& shot, core::FunctionRef<Vec3d(double)> place) {
  const Vec3d u = c.shooter.velocity + c.shooter.muzzle_speed * shot.direction;
  const auto flight = fly(c.projectile, c.conditions, {c.shooter.muzzle, u}, {.time = shot.time, .tolerance = 1e-11});
  return flight ? math::length(flight->end().position - place(shot.time)) : 1e300;
}
inline double miss(const Case& c, const Shot& shot) {
  return miss(c, shot, [&](double t) { return c.target.position + t * c.target.velocity; });
}

}  // namespace ballistics_aim_test
