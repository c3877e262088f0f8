// Sights: cant, slant, point-blank range, what is out of reach. Published tables are in tests/published.
#include "carom/ballistics/sights.h"

#include "carom/ballistics/weapon.h"

#include <gtest/gtest.h>

namespace ballistics_sights_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;

constexpr double yard = 0.9144, foot = 0.3048, inch = 0.0254, degree = math::pi / 180;

// In vacuum: a canted gun throws the shot to the side by the sine of the cant times its rise, and below.
TEST(Sights, CantAndSlant) {
  const Gun gun{.muzzle_speed = 300, .sight_height = 0};
  const Conditions vacuum{.air = environment::AirColumn::uniform(0)};
  const double x = 200, cant = 10 * degree, elevation = zero_elevation(gun, vacuum, x).value();
  const auto canted = SightedFlight::fire(gun, vacuum, {.elevation = elevation, .cant = cant}, 300).value().at(x);
  const double time = x / (300 * math::cos(elevation)), rise = 300 * math::sin(elevation) * time;
  EXPECT_NEAR(canted->side, rise * math::sin(cant), 1e-6);
  EXPECT_NEAR(canted->height, rise * (math::cos(cant) - 1), 1e-6);
  // Slant: a zero found on the level shoots high uphill and downhill, by about g x²/2v² (1 − cos α).
  for (const double slant : {30 * degree, -30 * degree}) {
    const auto high = SightedFlight::fire(gun, vacuum, {.elevation = elevation, .slant = slant}, 300).value().at(x);
    EXPECT_NEAR(high->height, .5 * 9.80665 * math::square(x / 300) * (1 - math::cos(slant)), .05);
    EXPECT_GT(high->height, 0);
  }
  EXPECT_NEAR(zero_elevation(gun, vacuum, x, 30 * degree).value() / elevation, math::cos(30 * degree), .02);
}

TEST(Sights, PointBlankTouchesTheCircle) {
  const Gun gun{.projectile = projectile_from_coefficient(DragFunction::g7, .218),
                .muzzle_speed = 2650 * foot,
                .sight_height = 1.5 * inch};
  const auto best = best_point_blank(gun, {}, .1);
  ASSERT_TRUE(best) << best.error().message;
  const auto flight =
      SightedFlight::fire(gun, {}, {.elevation = zero_elevation(gun, {}, best->zero).value()}, 2 * best->range).value();
  EXPECT_NEAR(flight.trajectory().apex().position.y, .1, 1e-6);
  EXPECT_NEAR(flight.at(best->range)->height, -.1, 1e-6);
  EXPECT_GT(best->range, best->zero);
  for (const double zero : {best->zero - 10, best->zero + 10}) {
    const auto other =
        SightedFlight::fire(gun, {}, {.elevation = zero_elevation(gun, {}, zero).value()}, 2 * best->range).value();
    EXPECT_LT(other.point_blank_range(.1), best->range);
  }
}

TEST(Sights, FieldCoriolisIsTheFormOfTheTables) {
  // Section 2.4: 1000 yd in about 2.03 s at 45°: 3.72 in; the true one is 3.134 in.
  EXPECT_NEAR(field_coriolis_drift(45 * degree, 1000 * yard, 2.005) / inch, 3.72, .02);
  EXPECT_EQ(clicks(1.26 * milliradian, .1 * milliradian), 13);
}

// In vacuum a target of height h at range R is passed over Δ = h/(2 tan γ) to either side, γ the angle of fall; the
// shot carries v²/g at 45°. In air lower and less: quadratic drag with v = v_t carries a little more than the .5890 of
// 45° in units of v_t²/g (reference "ballistics", 2.7).
TEST(Sights, DangerSpaceAndGreatestRange) {
  const Gun gun{.muzzle_speed = 300, .sight_height = 0};
  const Conditions vacuum{.air = environment::AirColumn::uniform(0), .gravity = 9.80665};
  const auto elevation = zero_elevation(gun, vacuum, 2000);
  ASSERT_TRUE(elevation);
  const auto flight = SightedFlight::fire(gun, vacuum, {.elevation = *elevation}, 3000);
  ASSERT_TRUE(flight);
  const auto stretch = flight->danger_space(2000, 1.8);
  ASSERT_TRUE(stretch);
  const double fall = math::tan(*elevation);  // as steep down as up
  EXPECT_NEAR(2000 - stretch->from, .9 / fall, .02 * .9 / fall);
  EXPECT_NEAR(stretch->to - 2000, .9 / fall, .02 * .9 / fall);
  EXPECT_NEAR(flight->at(stretch->to)->height, -.9, 1e-6);
  EXPECT_FALSE(flight->danger_space(1e6, 1.8));
  // A flat shot stays within the height all the way from the muzzle.
  const auto near = SightedFlight::fire(gun, vacuum, {.elevation = *zero_elevation(gun, vacuum, 50)}, 100);
  EXPECT_NEAR(near->danger_space(50, 1.8)->from, 0, 1e-12);
  const auto far = greatest_range(gun, vacuum);
  ASSERT_TRUE(far);
  EXPECT_NEAR(far->range, 300 * 300 / 9.80665, 1e-3);
  EXPECT_NEAR(far->elevation, math::pi / 4, 1e-4);
  const Gun slow{.projectile = projectile_from_terminal_speed(50), .muzzle_speed = 50};
  const auto carried = greatest_range(slow, {.air = environment::AirColumn::uniform(1.225)});
  ASSERT_TRUE(carried);
  EXPECT_GT(carried->range / (50 * 50 / 9.80665), .589011800);
  EXPECT_LT(carried->range / (50 * 50 / 9.80665), .60);
  EXPECT_LT(carried->elevation, math::radians(45.0));
  EXPECT_GT(carried->elevation, math::radians(39.0));
}

TEST(Sights, OutOfReachIsSaid) {
  const Gun gun{.projectile = projectile_from_coefficient(DragFunction::g1, .1), .muzzle_speed = 100};
  const auto zero = zero_elevation(gun, {}, 3000);
  ASSERT_FALSE(zero);
  EXPECT_EQ(zero.error().message,
            "no elevation brings the shot to the line of sight at 3000 m: it is out of reach for 100 m/s");
  EXPECT_FALSE(zero_elevation({.muzzle_speed = 0}, {}, 100));
}

// Turns of the bore against their own axes, in any direction.
TEST(Sights, ABoreIsRaisedTurnedAndCantedAboutItsLine) {
  const math::Vec3d lines[] = {{1, 0, 0}, {-0.6, 0, 0.8}, math::normalize(math::Vec3d{0.3, 0.5, -0.2}), {0, 1, 0}};
  for (const math::Vec3d line : lines) {
    const double e = 0.02, w = 0.013, c = 0.4;
    const math::Vec3d up = ballistics::swung(line, math::pi / 2, 0), right = ballistics::swung(line, 0, math::pi / 2);
    EXPECT_NEAR(math::dot(up, line), 0, 1e-15);
    EXPECT_NEAR(math::dot(right, line), 0, 1e-15);
    EXPECT_NEAR(right.y, 0, 1e-15);
    EXPECT_GE(up.y, -1e-15);
    EXPECT_NEAR(math::dot(math::cross(line, up), right), 1, 1e-14);
    const math::Vec3d bore = ballistics::bore_direction(line, {.elevation = e, .cant = c, .windage = w});
    EXPECT_NEAR(math::length(bore), 1, 1e-15);
    // Seen along the line: raised by e and moved by w along axes that lean by c.
    const double x = math::cos(e) * math::sin(w), y = math::sin(e);
    EXPECT_NEAR(math::dot(bore, up), y * math::cos(c) - x * math::sin(c), 1e-15);
    EXPECT_NEAR(math::dot(bore, right), x * math::cos(c) + y * math::sin(c), 1e-15);
  }
  EXPECT_NEAR(ballistics::swung({1, 0, 0}, 0.1, 0).y, math::sin(0.1), 1e-16);
  EXPECT_NEAR(ballistics::swung({1, 0, 0}, 0, 0.1).z, math::sin(0.1), 1e-16);
}

// A bore beside the line of sight meets it at the zero alone: in still air by offset · (distance/zero − 1), whatever
// the drag, because the flight stays in the upright plane of the bore.
TEST(Sights, BoreBesideTheLineOfSight) {
  for (const double offset : {0.03, -0.08}) {
    Gun gun{.projectile = projectile_from_coefficient(DragFunction::g7, .218), .muzzle_speed = 800};
    Gun centred = gun;
    gun.sight_offset = offset;
    const auto aiming = zero_aiming(gun, {}, 100);
    ASSERT_TRUE(aiming) << aiming.error().message;
    EXPECT_NEAR(aiming->windage, math::atan(offset / 100), 1e-12);
    EXPECT_NEAR(aiming->elevation, *zero_elevation(centred, {}, 100), 1e-8);
    const auto flight = SightedFlight::fire(gun, {}, *aiming, 500);
    for (const double distance : {1.0, 50.0, 100.0, 300.0, 500.0}) {
      EXPECT_NEAR(flight->at(distance)->side, offset * (distance / 100 - 1), 1e-9) << distance;
    }
    EXPECT_NEAR(flight->at(100)->height, 0, 1e-6);
    // Up a slope it is set for that zero all the same; canted, the bore keeps to its own side of the sight.
    const auto slope = zero_aiming(gun, {}, 200, 0.5);
    const auto uphill = SightedFlight::fire(gun, {}, *slope, 250);
    EXPECT_NEAR(uphill->at(200)->side, 0, 1e-8);
    EXPECT_NEAR(uphill->at(200)->height, 0, 1e-6);
    Aiming canted = *aiming;
    canted.cant = math::pi / 2;
    const Vec3d muzzle = SightedFlight::fire(gun, {}, canted, 10)->trajectory().start().position;
    EXPECT_LT(length(muzzle - Vec3d{0, offset, -gun.sight_height}), 1e-12) << "leaning to the right, its left is up";
  }
  // The wind takes what is zeroed in still air aside, and the zero leaves that alone.
  Gun gun{.projectile = projectile_from_coefficient(DragFunction::g7, .218), .muzzle_speed = 800};
  Gun centred = gun;
  gun.sight_offset = .05;
  const Conditions windy{.wind = environment::WindColumn({0, 0, 4})};
  EXPECT_NEAR(SightedFlight::fire(gun, windy, *zero_aiming(gun, windy, 100), 120)->at(100)->side,
              SightedFlight::fire(centred, windy, *zero_aiming(centred, windy, 100), 120)->at(100)->side, 1e-6);
  gun.sight_offset = __builtin_nan("");
  EXPECT_NE(zero_aiming(gun, {}, 100).error().message.find("sight_offset"), std::string::npos);
}

// Parallax: rays through an objective and an eyepiece. The reticle stands where the objective has the image of D₀; the
// ray from the eye through it, traced back through the objective, comes from e M (1 − R/D₀) beside the axis.
TEST(Sights, ParallaxIsThatOfTheRays) {
  const double objective = 0.2, eyepiece = 0.02;  // m, focal lengths of thin lenses
  for (const double free : {50.0, 100.0, 1e9})
    for (const double eye : {0.001, -0.002}) {
      // Where the objective has the image of D₀ and the reticle stands; the eyepiece makes its rays parallel.
      const double image = 1 / (1 / objective - 1 / free), magnification = objective / eyepiece;
      // Through the middle of the reticle and a point `height` of the objective; the erected pupil has it at `eye`.
      const double height = magnification * eye, inner = -height / image, outer = inner + height / objective;
      for (const double distance : {25.0, 100.0, 600.0}) {
        // Backward from the objective into the field: a thin lens turns a ray by −height/f.
        const double met = height - distance * outer;
        EXPECT_NEAR(parallax_error(eye, distance, free, magnification), met, 1e-9) << free << ' ' << distance;
        EXPECT_NEAR(parallax_turn(eye, distance, free, magnification) * distance, -met, 1e-9);
      }
      EXPECT_NEAR(parallax_error(eye, free, free, magnification), 0, 1e-12);
    }
  EXPECT_EQ(parallax_error(0.002, 500, __builtin_inf(), 8), 0.016) << "set for the stars: as far as the pupil is wide";
  EXPECT_EQ(parallax_error(0.001, 300, 100), -0.002) << "to the other side beyond";
  const Sight sight{.magnification = 10, .parallax_free = 100};
  const math::Vec2d turn = parallax_of(sight, {0.002, -0.001}, 200);
  EXPECT_NEAR(turn.x, 0.02 * (1 / 100.0 - 1 / 200.0), 1e-15);
  EXPECT_NEAR(turn.y, -0.01 * (1 / 100.0 - 1 / 200.0), 1e-15);
  EXPECT_EQ(parallax_of({.parallax_free = 0}, {1, 1}, 100), math::Vec2d());
}

}  // namespace ballistics_sights_test
