// The aim solver: random cases against brute force. Reference cases are in tests/published/chapter_18_aim_test.cpp.
#include "carom/ballistics/aim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/ballistics/aim_cases.h"

namespace ballistics_aim_test {

// Every shot that is told passes within 1 cm; the scan, which walks through the flight times, finds none where none is
// told, and none earlier or later. (It may step over two hits within a hundredth of the time, which the solver finds.)
TEST(Aim, RandomCasesHitAndAgreeWithTheScan) {
  math::Random random = random_asked(2026);
  int hits = 0, none = 0, two = 0, stepped_over = 0;  // two: with a high arc of its own
  const int cases = cases_asked(200);
  double worst = 0;
  for (int i = 0; i < cases; ++i) {
    const Case c = draw(random);
    const auto aims = aim(c.projectile, c.conditions, c.shooter, c.target, {.longest_time = 60});
    ASSERT_TRUE(aims) << aims.error().message;
    const Aims scan = by_scan(c);
    ASSERT_TRUE(aims->low || !scan.low) << i;
    const auto low = aim(c.projectile, c.conditions, c.shooter, c.target, {.longest_time = 60, .high_arc = false});
    ASSERT_EQ(low->low.has_value(), aims->low.has_value()) << i;
    if (!aims->low) {
      ++none;
      continue;
    }
    ++hits;
    two += aims->high->time > aims->low->time * 1.001;
    if (scan.low) {
      EXPECT_LT(aims->low->time, scan.low->time * 1.001 + 1e-4) << i;
      EXPECT_GT(aims->high->time, scan.high->time * 0.999 - 1e-4) << i;
    }
    stepped_over += !scan.low || aims->low->time < scan.low->time * 0.999 - 1e-4 ||
                    aims->high->time > scan.high->time * 1.001 + 1e-4;
    for (const Shot& shot : {*aims->low, *aims->high}) {
      const double off = miss(c, shot);
      worst = math::max(worst, off);
      if (cases > 200 && off > .004)
        std::printf("case %d: %.4f m, T %.2f s, A/m %.2e m2/kg, C_D(2) %.2f, %.0f m/s\n", i, off, shot.time,
                    c.projectile.area_per_mass, c.projectile.drag(2), c.shooter.muzzle_speed);
      EXPECT_LT(off, .01) << i;
    }
    EXPECT_NEAR(low->low->time, aims->low->time, 1e-3 * aims->low->time + 1e-4) << i;
    EXPECT_NEAR(math::length(aims->low->direction), 1, 1e-9);
  }

  RecordProperty("worst_miss_micrometres", int(worst * 1e6));
  EXPECT_LE(stepped_over, cases / 1000);
  EXPECT_GT(hits, cases / 3);
  EXPECT_GT(two, cases / 3);
  EXPECT_GT(none, cases / 50);
}

// Spent shots that the wind carries back: secants mistake how the speed that is needed changes with the flight time.
TEST(Aim, ATargetIsMetThoughSecantsMistakeTheSlope) {
  Projectile shot = projectile_from_terminal_speed(40);
  shot.area_per_mass = 0.01301089406211511;
  Conditions conditions;
  conditions.air = environment::AirColumn::uniform(1.225);
  conditions.wind = environment::WindColumn(Vec3d{-9.6547861693455914, 0, -4.0696976673194554});
  const Shooter shooter{.muzzle_speed = 885.35282555257368,
                        .muzzle = {42.643012079601093, 4.283536908949781, -19.857361133239969},
                        .velocity = {16.398360503900175, -14.805192230098168, -4.00349836493967}};
  const Target target{{-174.78571472050169, 8.002837972127681, 315.08565861889423},
                      {-55.948587517450058, -14.528154164101464, -89.93871773911043}};
  const auto aims = aim(shot, conditions, shooter, target, {.longest_time = 60});
  ASSERT_TRUE(aims && aims->low && aims->high);
  EXPECT_NEAR(aims->low->time, 2.2671, 2e-3);
  EXPECT_NEAR(aims->high->time, 4.5862, 4e-3);
}

// Targets as fast as the shot, most of them beyond its reach: what is said to have no solution has none.
TEST(Aim, FastTargetsAgreeWithTheScan) {
  math::Random random(77);
  int none = 0, hits = 0;
  for (int i = 0; i < 80; ++i) {
    Case c = draw(random);
    const double V = c.shooter.muzzle_speed;
    c.target.velocity = random.uniform(0.3, 1.2) * V * random.on_sphere();
    c.target.velocity.y *= 0.3;
    const auto aims = aim(c.projectile, c.conditions, c.shooter, c.target, {.longest_time = 60});
    ASSERT_TRUE(aims);
    EXPECT_EQ(aims->low.has_value(), by_scan(c).low.has_value()) << i;
    if (!aims->low) {
      ++none;
      continue;
    }
    ++hits;
    EXPECT_LT(miss(c, *aims->low), .01) << i;
  }
  EXPECT_GT(none, 15);
  EXPECT_GT(hits, 15);
}

// A target that flees faster than the shot can follow, and one beyond its reach: no solution, and it is said.
TEST(Aim, NoSolutionIsSaid) {
  const Projectile shot = projectile_from_terminal_speed(40);
  const Shooter shooter{.muzzle_speed = 100};
  EXPECT_FALSE(aim(shot, {}, shooter, Target{{2000, 0, 0}}).value());
  EXPECT_FALSE(aim(shot, {}, shooter, Target{{100, 0, 0}, {150, 0, 0}}).value());
  EXPECT_FALSE(aim(shot, {}, shooter, [](double t) { return Vec3d{100 + 150 * t, 0, 0}; }).value());
  EXPECT_TRUE(aim(shot, {}, shooter, Target{{100, 0, 0}}).value());
}

// Light shots, of which the solver knows without a flight how far they can come: hit a fiftieth before the greatest
// range of brute force over the elevations, out of reach a fiftieth beyond it.
TEST(Aim, TheGreatestRangeOfLightShots) {
  math::Random random(31);
  for (int i = 0; i < 24; ++i) {
    const Projectile shot = i % 2 == 0 ? projectile_from_terminal_speed(random.uniform(12.0, 60.0))
                                       : projectile_from_size(DragCurve(DragFunction::gs), random.uniform(.002, .05),
                                                              random.uniform(.02, .04));
    Conditions air;
    if (i % 3 == 0) air.wind = environment::WindColumn(Vec3d{random.uniform(-8.0, 8.0), 0, 0});
    const double speed = random.uniform(100.0, 900.0), height = random.uniform(-40.0, 40.0);
    double greatest = 0;
    for (int k = 0; k < 200; ++k) {
      const double elevation = -.3 + k * .008;
      const auto flight = fly(shot, air, {{}, speed * direction(elevation)}, {.time = 120, .ground = -60});
      const auto point = flight->falling_through(height);
      if (point) greatest = math::max(greatest, point->position.x);
    }
    ASSERT_GT(greatest, 0);
    const Shooter shooter{.muzzle_speed = speed};
    EXPECT_TRUE(*aim(shot, air, shooter, Target{{.98 * greatest, height, 0}})) << i;
    EXPECT_FALSE(*aim(shot, air, shooter, Target{{1.02 * greatest, height, 0}})) << i;
    EXPECT_FALSE(*aim(shot, air, shooter, Target{{2 * greatest, height, 0}})) << i;
    EXPECT_FALSE(*aim(shot, air, shooter, Target{{3 * greatest, height, 0}, {-1, 0, 2}, {}}, {.longest_time = 60}))
        << i;
  }
}

// Where the high arc would take longer than the longest time the low one is all there is.
TEST(Aim, AHighArcBeyondTheLongestTimeIsNone) {
  const Projectile shot = projectile_from_coefficient(DragFunction::g7, .3);
  const Shooter shooter{.muzzle_speed = 400, .muzzle = {0, 2, 0}};
  const Target target{{900, 30, 200}, {-20, 2, 30}, {}};
  const Aims all = *aim(shot, {}, shooter, target);
  ASSERT_TRUE(all.low && all.high);
  ASSERT_GT(all.high->time, 10 * all.low->time);
  for (const double share : {.2, .6, .98, 1.02}) {
    const Aims aims = *aim(shot, {}, shooter, target, {.longest_time = share * all.high->time});
    ASSERT_TRUE(aims.low && aims.high) << share;
    EXPECT_NEAR(aims.low->time, all.low->time, 1e-5);
    EXPECT_NEAR(aims.high->time, share > 1 ? all.high->time : all.low->time, 1e-3) << share;
  }
}

// The target flees nearly as fast as the spent shot: the two meet, though every shot falls far behind in the end.
TEST(Aim, SpentShotsMeetATargetThatFlees) {
  const Projectile shot = projectile_from_coefficient(DragFunction::g7, .58);
  const Shooter shooter{.muzzle_speed = 790, .muzzle = {0, 200, 0}, .velocity = {14.6, -23.5, 10.6}};
  int met = 0;
  for (int i = 0; i < 8; ++i) {
    const Target target{{-918, 42, -1914}, Vec3d{-75.8, -9.8, -55} * (1.0 + 0.2 * i)};
    const Case c{shot, {}, shooter, target};
    const auto aims = aim(shot, {}, shooter, target, {.longest_time = 60});
    ASSERT_TRUE(aims);
    EXPECT_TRUE(aims->low || !by_scan(c).low) << i;
    if (!aims->low) continue;
    ++met;
    EXPECT_LT(miss(c, *aims->low), .01) << i;
  }
  EXPECT_GT(met, 0);
}

// Lanes of every instruction set give the same bits.
TEST(Aim, WidthsAgree) {
  math::Random random(16);
  for (int i = 0; i < 60; ++i) {
    Case c = draw(random);
    if (i % 3 == 0)
      c.conditions.wind =
          environment::WindColumn({.velocity = {6, 0, 3}, .profile = environment::WindProfile::logarithmic});
    const auto place = [&](double t) { return c.target.position + t * c.target.velocity; };
    const AimOptions options{.longest_time = 60};
    Aims one;
    for (const auto set : {math::InstructionSet::baseline, math::InstructionSet::avx2, math::InstructionSet::avx512}) {
      Aims aims;
      const detail::AimSolver solver(c.projectile, c.conditions, c.shooter, place, options, set);
      if (!solver.two_arcs(c.target, aims)) solver.scan(aims);
      if (set == math::InstructionSet::baseline) one = aims;
      ASSERT_EQ(aims.low.has_value(), one.low.has_value()) << i;
      if (!aims.low) continue;
      EXPECT_EQ(aims.low->time, one.low->time) << i;
      EXPECT_EQ(aims.low->direction, one.low->direction) << i;
      EXPECT_EQ(aims.high->time, one.high->time) << i;
      EXPECT_EQ(aims.high->velocity, one.high->velocity) << i;
    }
  }
}

// A target that leaps is not taken for a slow one: it is met where it has leapt to.
TEST(Aim, ATargetThatLeaps) {
  const Projectile shot = projectile_from_coefficient(DragFunction::g7, .3);
  const auto place = [](double t) { return t < 1 ? Vec3d{300, 10, 0} : Vec3d{900, 10, 0}; };
  const auto aims = aim(shot, {}, {.muzzle_speed = 500}, place);
  ASSERT_TRUE(aims && *aims);
  EXPECT_NEAR(aims->low->place.x, 300, .01);
  EXPECT_NEAR(aims->high->place.x, 900, .01);
  const auto away = [](double t) { return t < .2 ? Vec3d{300, 10, 0} : Vec3d{900, 10, 0}; };
  const auto later = aim(shot, {}, {.muzzle_speed = 500}, away);
  ASSERT_TRUE(later && *later);
  EXPECT_NEAR(later->low->place.x, 900, .01);
}

// Cases of four hundred thousand whose only shots were once missed: spent ones that come down on targets below, and
// such as pass the barrier of sound, whose surface of reach has two places that come near.
TEST(Aim, SpentShotsAreNotMissed) {
  const struct {
    int seed, number;
  } cases[] = {{99, 1996}, {110, 288}, {112, 1835}, {82, 823}, {94, 4429}};
  for (const auto& [seed, number] : cases) {
    math::Random random{std::uint64_t(seed)};
    for (int i = 0; i < number; ++i) draw(random);
    const Case c = draw(random);
    const auto aims = aim(c.projectile, c.conditions, c.shooter, c.target, {.longest_time = 60});
    ASSERT_TRUE(aims);
    const Aims scan = by_scan(c);
    ASSERT_TRUE(scan.low && aims->low) << seed;
    EXPECT_NEAR(aims->low->time, scan.low->time, 1e-3 * scan.low->time) << seed;
    EXPECT_LT(miss(c, *aims->low), .01) << seed;
    EXPECT_LT(miss(c, *aims->high), .01) << seed;
  }
  // Where only the earliest is asked for it is not the later of two that are close together.
  math::Random random(60);
  for (int i = 0; i < 4238; ++i) draw(random);
  const Case c = draw(random);
  const auto low = aim(c.projectile, c.conditions, c.shooter, c.target, {.longest_time = 60, .high_arc = false});
  ASSERT_TRUE(low && low->low);
  EXPECT_NEAR(low->low->time, by_scan(c).low->time, 1e-3 * low->low->time);
}

// Frame by frame after a moving target: what `aim_again` says from the last frame is what `aim` says anew.
TEST(Aim, AgainFromTheLastFrame) {
  const Projectile shot = projectile_from_coefficient(DragFunction::g7, .3);
  Conditions air;
  air.wind = environment::WindColumn(Vec3d{3, 0, -4});
  const Shooter shooter{.muzzle_speed = 500, .muzzle = {0, 2, 0}, .velocity = {15, 0, 0}};
  const auto target = [](double t) { return Target{{700 - 40 * t, 120 + 3 * t, -300 + 60 * t}, {-40, 3, 60}, {}}; };
  Aims aims = *aim(shot, air, shooter, target(0));
  ASSERT_TRUE(aims);
  for (int i = 1; i < 60; ++i) {
    const double t = i / 30.0;
    const Aims anew = *aim(shot, air, shooter, target(t));
    aims.low = *aim_again(shot, air, shooter, target(t), *aims.low);
    aims.high = *aim_again(shot, air, shooter, target(t), *aims.high);
    ASSERT_TRUE(aims.low && aims.high && anew);
    EXPECT_NEAR(aims.low->time, anew.low->time, 1e-4);
    EXPECT_NEAR(aims.high->time, anew.high->time, 1e-3);
    EXPECT_LT(math::length(aims.low->direction - anew.low->direction), 1e-5);
  }
}

// A weapon's table against the solver, in reach and out of it.
TEST(Aim, TableOfAWeapon) {
  const Projectile shot = projectile_from_coefficient(DragFunction::g1, .4);
  const Conditions air{};
  const auto table = AimTable::make(shot, air, {.muzzle_speed = 300, .longest_range = 4500});
  ASSERT_TRUE(table) << table.error().message;
  math::Random random(5);
  int found = 0, none = 0;
  for (int i = 0; i < 300; ++i) {
    const double range = random.uniform(60.0, 4480.0), height = range * random.uniform(-.3, .8);
    const Aims exact = *aim(shot, air, {.muzzle_speed = 300}, Target{{range, height, 0}});
    const AimTable::Entries entries = table->at(range, height);
    if (!exact || !entries.low) {
      none += !exact;
      // Whoever says yes alone stands at the edge of what can be reached: a little higher nobody can.
      if (bool(exact) != entries.low.has_value())
        EXPECT_FALSE(*aim(shot, air, {.muzzle_speed = 300}, Target{{range, height + .01 * range, 0}}))
            << range << ' ' << height;
      continue;
    }
    ++found;
    const double low = laying(exact.low->direction).elevation, high = laying(exact.high->direction).elevation;
    if (high - low < .15) continue;  // near the edge both are ill-conditioned
    EXPECT_NEAR(entries.low->elevation, low, 3e-4) << range << ' ' << height;
    EXPECT_NEAR(entries.low->time, exact.low->time, 2e-3 * exact.low->time + 2e-3);
    if (high < 1.49) EXPECT_NEAR(entries.high->elevation, high, 2e-3) << range << ' ' << height;
  }
  EXPECT_GT(found, 150);
  EXPECT_GT(none, 20);
  const Target runner{{600, 20, 100}, {-8, 0, 12}};
  const Aims aims = table->aim({.muzzle_speed = 300}, runner);
  const Aims exact = *aim(shot, air, {.muzzle_speed = 300}, runner);
  ASSERT_TRUE(aims && exact);
  EXPECT_LT(math::length(aims.low->direction - exact.low->direction), 5e-4);
  EXPECT_NE(AimTable::make(shot, air, {.ranges = 1}).error().message.find("ranges"), std::string::npos);
}

TEST(Aim, BadInputIsNamed) {
  const auto aims = aim({}, {}, {.muzzle_speed = -5}, Target{});
  ASSERT_FALSE(aims);
  EXPECT_EQ(aims.error().message, "aim: muzzle_speed is -5, expected a finite number > 0");
  EXPECT_FALSE(aim({}, {}, {}, Target{{__builtin_nan(""), 0, 0}}));
  // A function may say anything: no solution.
  const Projectile shot = projectile_from_coefficient(DragFunction::g7, .3);
  for (const double place : {__builtin_nan(""), __builtin_inf(), 1e200})
    EXPECT_FALSE(*aim(shot, {}, {}, [&](double) { return Vec3d{place, 0, 0}; })) << place;
}

enum class Rough { profile, layers, straight_lines };

/// Over open land: in a profile of wind or, `layers`, in one as balloons measure it, a few metres to 250 m thick and
/// unlike each other; `straight_lines`: by drag tables without smoothing.
Case draw_outdoors(math::Random& random, Rough rough) {
  constexpr DragFunction functions[] = {DragFunction::g1, DragFunction::g7, DragFunction::gs, DragFunction::g5};
  Case c;
  c.projectile =
      random.chance(.3)
          ? projectile_from_terminal_speed(random.uniform(20.0, 300.0))
          : projectile_from_coefficient(functions[random.below(4)], random.uniform(.05, 1.2),
                                        rough == Rough::straight_lines ? Interpolation::linear : Interpolation::smooth);
  if (rough == Rough::layers) {
    std::vector<environment::WindColumn::Level> levels;
    const int count = 2 + int(random.below(12));
    double height = random.uniform(-20.0, 20.0);
    const double spacing = random.uniform(5.0, 150.0);
    for (int i = 0; i < count; ++i) {
      const double x = random.uniform(-15.0, 15.0), z = random.uniform(-15.0, 15.0);
      levels.push_back({height, {x, 0, z}});
      height += spacing * random.uniform(.3, 1.7);
    }
    c.conditions.wind = environment::WindColumn(std::span<const environment::WindColumn::Level>(levels));
  } else if (random.chance(.6)) {
    const double across = random.uniform(-15.0, 15.0), along = random.uniform(-15.0, 15.0);
    c.conditions.wind = environment::WindColumn(environment::Wind{
        .velocity = {across, 0, along},
        .profile = random.chance(.5) ? environment::WindProfile::power : environment::WindProfile::uniform});
  }
  const double speed = random.uniform(60.0, 900.0), up = random.uniform(0.0, 30.0);
  const double ahead = random.uniform(-20.0, 20.0), aside = random.uniform(-20.0, 20.0);
  c.shooter = {speed, {0, up, 0}, {ahead, 0, aside}};
  const double away = math::min(speed * speed / 19.6 * math::square(random.uniform(.02, .9)), 8000.0),
               around = random.uniform(-3.1, 3.1), height = random.uniform(-50.0, 200.0);
  const double x = random.uniform(-25.0, 25.0), y = random.uniform(-3.0, 3.0), z = random.uniform(-25.0, 25.0);
  c.target = {{away * math::cos(around), height, away * math::sin(around)}, {x, y, z}, {}};
  if (random.chance(.3)) c.target.velocity = {};
  return c;
}

/// Every shot told passes within 1 cm. `seed` is not one that the solver was tuned by.
void expect_hits(Rough rough, std::uint64_t seed, int cases) {
  math::Random random = random_asked(seed);
  cases = cases_asked(cases);
  int found = 0, none = 0;
  double worst = 0;
  for (int i = 0; i < cases; ++i) {
    const Case c = draw_outdoors(random, rough);
    const auto both = aim(c.projectile, c.conditions, c.shooter, c.target);
    ASSERT_TRUE(both.ok());
    ++(*both ? found : none);
    if (!*both) continue;
    for (const Shot& shot : {*both->low, *both->high}) {
      const double off = miss(c, shot);
      worst = math::max(worst, off);
      EXPECT_LT(off, .01) << i;
    }
  }
  ::testing::Test::RecordProperty("worst_miss_micrometres", int(worst * 1e6));
  EXPECT_GT(found, cases / 2);
  EXPECT_GT(none, cases / 8);
}

/// The least miss (m) that Newton's method with differences of whole flights finds from a direction of the barrel and a
/// time: nothing of the solver is in it.
double least_miss(const Case& c, double longest, double elevation, double azimuth, double time) {
  const auto off = [&](double e, double a, double t) {
    const Vec3d u = c.shooter.velocity + c.shooter.muzzle_speed * direction(e, a);
    const auto flight = fly(c.projectile, c.conditions, {c.shooter.muzzle, u}, {.time = t, .tolerance = 1e-10});
    return flight ? flight->end().position - (c.target.position + t * c.target.velocity) : Vec3d{1e300, 0, 0};
  };
  double least = 1e300;
  for (int i = 0; i < 30; ++i) {
    const Vec3d r = off(elevation, azimuth, time);
    least = math::min(least, math::length(r));
    if (least < .005) return least;
    const double h = 1e-6, ht = 1e-5 * time;
    const Vec3d je = (off(elevation + h, azimuth, time) - r) / h, ja = (off(elevation, azimuth + h, time) - r) / h,
                jt = (off(elevation, azimuth, time + ht) - r) / ht;
    const double whole = math::dot(je, math::cross(ja, jt));
    if (whole == 0 || !math::is_finite(whole)) return least;
    const double de = math::dot(r, math::cross(ja, jt)) / whole, da = math::dot(je, math::cross(r, jt)) / whole,
                 dt = math::dot(je, math::cross(ja, r)) / whole;
    const double share = math::min(1.0, math::min(.1 / (math::abs(de) + math::abs(da)), .2 * time / math::abs(dt)));
    elevation -= share * de, azimuth -= share * da, time -= share * dt;
    if (!(time > 1e-6 && time < longest)) return least;
  }
  return least;
}

/// Tries barrels all round: the nearest passes of their whole flights are what Newton's method begins with.
double least_miss(const Case& c, double longest) {
  struct Pass {
    double miss, elevation, azimuth, time;
  };
  std::vector<Pass> passes;
  constexpr int rows = 36, columns = 48;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double elevation = math::pi * ((i + .5) / rows - .5), azimuth = 2 * math::pi * j / columns;
      const Vec3d u = c.shooter.velocity + c.shooter.muzzle_speed * direction(elevation, azimuth);
      const auto flight =
          fly(c.projectile, c.conditions, {c.shooter.muzzle, u}, {.time = longest, .ground = -1000, .tolerance = 1e-4});
      Pass pass{1e300, elevation, azimuth, 0};
      for (int k = 1; flight && k <= 100; ++k) {
        const double t = flight->duration() * math::square(k / 100.0);
        const double away =
            math::length(flight->at(t).position - (c.target.position + t * c.target.velocity)) / (1 + t);
        if (away < pass.miss) pass.miss = away, pass.time = t;
      }
      if (pass.time > 0) passes.push_back(pass);
    }
  std::sort(passes.begin(), passes.end(), [](const Pass& a, const Pass& b) { return a.miss < b.miss; });
  double least = 1e300;
  for (std::size_t i = 0; i < passes.size() && i < 24 && least > .005; ++i)
    least = math::min(least, least_miss(c, longest, passes[i].elevation, passes[i].azimuth, passes[i].time));
  return least;
}

// Where no solution is told, barrels all round find none either; where one is told, they nearly always do.
TEST(Aim, NoSolutionIsTrue) {
  const int asked = cases_asked(1);
  int told = 0, found = 0;
  for (int kind = 0; kind < 4; ++kind) {
    math::Random random = random_asked(90210);
    int none = 0, some = 0;
    for (int i = 0; none < asked && i < 100 * asked; ++i) {
      const Case c = kind == 3 ? draw(random) : draw_outdoors(random, Rough(kind));
      const double longest = kind == 3 ? 60 : AimOptions{}.longest_time;
      const auto aims = aim(c.projectile, c.conditions, c.shooter, c.target, {.longest_time = longest});
      ASSERT_TRUE(aims.ok());
      if (*aims && some++ >= asked) continue;
      const double least = least_miss(c, longest);
      if (*aims) {
        ++told;
        found += least < .01;
      } else {
        ++none;
        EXPECT_GE(least, .01) << "kind " << kind << ", case " << i;
      }
    }
    EXPECT_EQ(none, asked);
  }
  EXPECT_GE(found, told - (told + 9) / 10);
}

// Nearly straight up by a curve whose slope at Mach 0 is not zero: slow for seconds about the top; and one through the
// barrier in its first step.
TEST(Aim, SlowTopsAndTheBarrierAreMeasured) {
  Case slow;
  slow.projectile = projectile_from_coefficient(DragFunction::g1, 1);
  slow.projectile.area_per_mass = 0.0090105280216863735;
  slow.shooter = {138.76531357108547, {0, 17.212283274124893, 0}, {-12.786540870674559, 0, -10.311386445120171}};
  slow.target = {{0.056619656096137047, 43.196849767189974, -0.89700539159925219}};
  Case fast = slow;
  fast.projectile.area_per_mass = 0.0078752094639944741;
  fast.shooter = {271.17498481001593, {0, 16.491324292489963, 0}, {-12.834025913271837, 0, -6.5294398743050976}};
  fast.target = {{564.66806129553606, 173.74140979595475, -250.71458880446639}};
  for (const Case& c : {slow, fast}) {
    const auto aims = aim(c.projectile, c.conditions, c.shooter, c.target);
    ASSERT_TRUE(aims && aims->low && aims->high);
    EXPECT_LT(miss(c, *aims->low), .01);
    EXPECT_LT(miss(c, *aims->high), .01);
  }
}

// Profiles of wind are steep near the ground and have bends by the hundred.
TEST(Aim, ShotsThroughAProfileOfWindHit) { expect_hits(Rough::profile, 777, 800); }
// Layers bend sharply, and thin ones may lie within a step.
TEST(Aim, ShotsThroughLayersOfWindHit) { expect_hits(Rough::layers, 31337, 300); }
// The slope of such drag jumps at every node.
TEST(Aim, ShotsByDragTablesOfStraightLinesHit) { expect_hits(Rough::straight_lines, 777, 300); }

}  // namespace ballistics_aim_test
