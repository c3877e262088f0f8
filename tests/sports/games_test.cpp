// Golf, baseball and bowling: mirrors, conservation, gear effect, limits and bad input.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/sports/baseball.h"
#include "carom/sports/bowling.h"
#include "carom/sports/golf.h"
#include "carom/sports/presets.h"

namespace sports_games_test {
using namespace carom;
using namespace carom::sports;

constexpr double degree = math::pi / 180;

double kinetic(const Ball& b, const BallState& s) {
  return .5 * b.mass * math::dot(s.velocity, s.velocity) + .5 * inertia(b) * math::dot(s.spin, s.spin);
}

TEST(SportsGolf, ImpactConservesMomentumAndLosesEnergy) {
  const Ball ball = *ball_preset("golf");
  for (const ClubPreset& club : club_presets())
    for (const double toe : {-.02, 0.0, .015})
      for (const double path : {-.1, 0.0, .05}) {
        ClubDelivery d = club.delivery;
        d.toe = toe;
        d.high = .004;
        d.path = path;
        d.face = -.5 * path;
        const auto hit = strike(ball, club.head, d);
        ASSERT_TRUE(hit) << hit.error().message;
        const Vec3d before =
            club.head.mass * d.speed *
            Vec3d{math::cos(d.attack) * math::cos(path), math::sin(d.attack), math::cos(d.attack) * math::sin(path)};
        const Vec3d after = club.head.mass * hit->head_velocity + ball.mass * hit->ball.velocity;
        EXPECT_LT(math::length(after - before), 1e-10);
        // Turning of the head: at least its inertia about the vertical takes part.
        const double kept = .5 * club.head.mass * math::dot(hit->head_velocity, hit->head_velocity) +
                            .5 * club.head.inertia.y * math::square(hit->head_spin.y);
        EXPECT_LT(kinetic(ball, hit->ball) + kept, .5 * club.head.mass * d.speed * d.speed) << club.name;
      }
}

// D-plane: the ball starts between face and path, nearer to the face, and curves away from the path.
TEST(SportsGolf, FaceAndPath) {
  const Ball ball = *ball_preset("golf");
  const ClubPreset iron = *club_preset("7-iron");
  ClubDelivery d = iron.delivery;
  d.face = 2 * degree;
  d.path = 6 * degree;
  const auto draw = strike(ball, iron.head, d);
  ASSERT_TRUE(draw);
  EXPECT_GT(draw->launch.azimuth, d.face);
  EXPECT_LT(draw->launch.azimuth, .5 * (d.face + d.path));
  EXPECT_LT(draw->launch.tilt, -2 * degree) << "curves to the left";
  const auto flight = fly(ball, {}, draw->ball);
  ASSERT_TRUE(flight);
  const Vec3d end = flight->end().position;
  EXPECT_LT(math::atan2(end.z, end.x), draw->launch.azimuth);
  // The mirror image is a fade.
  d.face = -d.face;
  d.path = -d.path;
  const auto fade = strike(ball, iron.head, d);
  ASSERT_TRUE(fade);
  EXPECT_NEAR(fade->launch.azimuth, -draw->launch.azimuth, 1e-12);
  EXPECT_NEAR(fade->launch.tilt, -draw->launch.tilt, 1e-12);
  EXPECT_NEAR(fade->launch.spin, draw->launch.spin, 1e-9);
}

// Gear effect: struck toward the toe a driver's ball draws; struck high it spins less; with no depth it does neither.
TEST(SportsGolf, GearEffect) {
  const Ball ball = *ball_preset("golf");
  ClubPreset driver = *club_preset("driver");
  driver.head.bulge = driver.head.roll = 0;
  ClubDelivery d = driver.delivery;
  const auto middle = strike(ball, driver.head, d);
  d.toe = .015;
  const auto toe = strike(ball, driver.head, d);
  d.toe = 0;
  d.high = .008;
  const auto high = strike(ball, driver.head, d);
  ASSERT_TRUE(middle && toe && high);
  EXPECT_LT(toe->launch.tilt, -5 * degree);
  EXPECT_LT(toe->launch.speed, middle->launch.speed) << "off the centre costs speed";
  EXPECT_LT(high->launch.spin, middle->launch.spin - 40);
  driver.head.depth = 0;
  d.high = 0;
  d.toe = .015;
  EXPECT_NEAR(strike(ball, driver.head, d)->launch.tilt, 0, 1e-9);
}

TEST(SportsGolf, HeldWristsAndTorquesMatter) {
  const auto early = swing(textbook_swing());
  Swing held = textbook_swing();
  held.links[1].hold = {.until = Hold::Until::time, .time = .17};
  const auto late = swing(held);
  ASSERT_TRUE(early && late);
  EXPECT_GT(late->speed, early->speed) << "a late hit is faster";
  EXPECT_EQ(late->release[1], .17);
  // Twice the torques and twice the inertias: the same swing but for gravity.
  Swing heavy = textbook_swing();
  heavy.gravity = 0;
  Swing light = heavy;
  for (SwingLink& link : heavy.links) {
    link.mass *= 2;
    link.inertia *= 2;
    for (Curve::Point& p : link.torque.points) p.value *= 2;
  }
  EXPECT_NEAR(swing(heavy)->speed, swing(light)->speed, 1e-8);
  // A stiff shaft is the limit of a flexible one.
  Swing stiff = textbook_swing();
  stiff.shaft = {.frequency = 200, .damping_ratio = .05, .head_mass = .2, .shaft_mass = .14};
  EXPECT_NEAR(swing(stiff, 2, 1e-9)->speed, early->speed, .02);
  stiff.shaft.frequency = 4.2;
  const auto flexible = swing(stiff);
  ASSERT_TRUE(flexible);
  EXPECT_GT(math::abs(flexible->bend), .002);
  EXPECT_LT(math::abs(flexible->bend), .3);
  const auto faster = swing_for_speed(textbook_swing(), 50);
  ASSERT_TRUE(faster);
  EXPECT_NEAR(swing(*faster)->speed, 50, 1e-5);
  const auto three = swing(three_link_swing());
  ASSERT_TRUE(three) << three.error().message;
  EXPECT_TRUE(three->impact);
  EXPECT_GT(three->speed, 30);
  EXPECT_LT(three->speed, 60);
  EXPECT_LT(three->release[1], three->time);
}

// Work of the torques is the energy gained: of the shoulders through their angle, no losses.
TEST(SportsGolf, TorquesDoTheWork) {
  Swing s = textbook_swing();
  s.links[1].hold = {.until = Hold::Until::time, .time = .1};
  const auto result = swing(s);
  ASSERT_TRUE(result);
  const SwingState start = swing_start(s), end = result->nodes.back().state;
  EXPECT_NEAR(swing_energy(s, end) - swing_energy(s, start), 100 * (end.angle[0] - start.angle[0]), 1e-6);
}

TEST(SportsGolf, BadInputIsNamed) {
  const double nan = __builtin_nan("");
  const Ball ball = *ball_preset("golf");
  ClubHead head;
  head.mass = 0;
  EXPECT_EQ(strike(ball, head, {}).error().message.substr(0, 19), "mass of a club head");
  EXPECT_FALSE(strike(ball, {}, {.speed = nan}));
  EXPECT_FALSE(strike(ball, {}, {.speed = 40, .path = 1.4, .face = -1.4})) << "the face looks away";
  EXPECT_FALSE(club_preset("putter"));
  EXPECT_FALSE(tour_shot("putter"));
  EXPECT_FALSE(swing({}));
  Swing s = textbook_swing();
  s.links[0].mass = nan;
  EXPECT_EQ(swing(s).error().message.substr(0, 25), "mass of link 1 of a swing");
  s = textbook_swing();
  s.links[0].torque = {{{1, 0}, {.5, 1}}};
  EXPECT_FALSE(swing(s));
  s = textbook_swing();
  s.shaft.frequency = -1;
  EXPECT_FALSE(swing(s));
  s = textbook_swing();
  s.shaft = {.frequency = 4, .head_mass = 3};
  EXPECT_FALSE(swing(s));
  s.shaft = {.frequency = 4, .head_mass = .3, .shaft_mass = .01};
  EXPECT_FALSE(swing(s)) << "more inertia than the club has";
  s = textbook_swing();
  s.links[0].torque = {};
  s.gravity = 0;
  const auto still = swing(s, .5);
  ASSERT_TRUE(still);
  EXPECT_FALSE(still->impact);
  EXPECT_FALSE(play_golf({.swing = s}, *surface_preset("green")));
  EXPECT_FALSE(swing_for_speed(textbook_swing(), nan));
}

TEST(SportsBaseball, PitchesBreakAsTheySpin) {
  const Ball ball = *ball_preset("baseball");
  const auto fast = pitch(ball, {}, {}), curve = pitch(ball, {}, {.elevation = .03, .tilt = math::pi});
  const auto slider = pitch(ball, {}, {.tilt = math::pi / 2}), other = pitch(ball, {}, {.tilt = -math::pi / 2});
  const auto gyro = pitch(ball, {}, {.spin = 0, .gyro = 230});
  ASSERT_TRUE(fast && curve && slider && other && gyro);
  EXPECT_GT(fast->rise, .3);
  EXPECT_LT(curve->rise, -.3);
  EXPECT_GT(slider->run, .3);
  EXPECT_NEAR(other->run, -slider->run, 1e-9);
  EXPECT_NEAR(gyro->rise, 0, 1e-9) << "spin about the way does not curve it";
  EXPECT_LT(fast->speed, 42);
  EXPECT_FALSE(pitch(ball, {}, {.speed = 2, .elevation = -1}, 1e4));
}

TEST(SportsBaseball, BatAndBall) {
  const Ball ball = *ball_preset("baseball");
  const BallState in{.velocity = {38, -3, 0}, .spin = {0, 0, 200}};
  // Head on: v = q v_pitch + (1 + q) v_bat, q = (e − r)/(1 + r).
  const Bat bat;
  const double r = ball.mass / bat.effective_mass, q = (bat.restitution - r) / (1 + r);
  const auto straight = hit(ball, bat, {.speed = 31, .attack = 0, .offset = 0}, {.velocity = {38, 0, 0}});
  ASSERT_TRUE(straight);
  EXPECT_NEAR(-straight->velocity.x, q * 38 + (1 + q) * 31, 1e-9);
  // Lower bat: higher launch, more backspin (about −z where the ball flies along −x).
  const auto low = hit(ball, bat, {.offset = .02}, in), lower = hit(ball, bat, {.offset = .03}, in);
  ASSERT_TRUE(low && lower);
  EXPECT_GT(lower->velocity.y, low->velocity.y);
  EXPECT_LT(lower->spin.z, low->spin.z);
  EXPECT_LT(low->spin.z, 0);
  EXPECT_FALSE(hit(ball, {.effective_mass = 0}, {}, in));
  EXPECT_FALSE(hit(ball, {}, {.offset = 1}, in));
  EXPECT_FALSE(hit(ball, {}, {.speed = 0}, {.velocity = {-3, 0, 0}})) << "they part already";
}

TEST(SportsBowling, Laws) {
  const double turn = 45 * degree;
  const auto left = bowl({}, {}, {.spin = 30, .axis_rotation = turn, .start = -.2}),
             right = bowl({}, {}, {.spin = 30, .axis_rotation = -turn, .start = .2});
  ASSERT_TRUE(left && right);
  EXPECT_NEAR(left->end().y, -right->end().y, 1e-12);
  EXPECT_NEAR(left->entry_angle(), -right->entry_angle(), 1e-12);
  // A ball let go rolling rolls on straight.
  const auto rolls = bowl({}, {}, {.speed = 7, .spin = 7 / .1085});
  ASSERT_TRUE(rolls);
  EXPECT_NEAR(rolls->end().time, 18.288 / 7, 1e-9);
  EXPECT_EQ(rolls->end().y, 0);
  // Without spin the rolling speed is r²/(r² + k²) of the first, whatever the friction.
  for (const double friction : {.15, .3}) {
    const auto skid = bowl({}, {.stretches = {{18, friction}}, .length = 60}, {.speed = 8, .spin = 0});
    ASSERT_TRUE(skid);
    EXPECT_NEAR(skid->end().speed_x, 8 / (1 + math::square(.0635 / .1085)), 1e-12);
  }
  // Between its points the path is what the points say.
  const LanePoint middle = left->at(.5 * (left->points[0].time + left->points[1].time));
  EXPECT_GT(middle.x, 0);
  EXPECT_LT(middle.x, left->points[1].x);
  EXPECT_NEAR(left->at(left->points[1].time).y, left->points[1].y, 1e-12);
  EXPECT_FALSE(bowl({.mass = -1}, {}, {}));
  EXPECT_FALSE(bowl({}, {.stretches = {}}, {}));
  EXPECT_FALSE(bowl({}, {.stretches = {{5, .1}, {4, .1}}}, {}));
  EXPECT_FALSE(bowl({}, {}, {.speed = __builtin_nan("")}));
}

}  // namespace sports_games_test
