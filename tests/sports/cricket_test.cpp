// Cricket deliveries: swing, drift, dip and turn. No table of flights with a source is known: what holds are the laws,
// and the class of what is told (R. D. Mehta, Ann. Rev. Fluid Mech. 17 (1985) 151).
#include "carom/sports/cricket.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/sports/game_presets.h"
#include "carom/sports/presets.h"

namespace cricket_test {
using namespace carom;
using namespace carom::sports;

constexpr double degree = math::pi / 180;

CricketPath thrown(const CricketDelivery& d, double length = 6, double line = 0) {
  const Ball ball = *ball_preset("cricket");
  const Surface pitch = *surface_preset("pitch");
  const auto laid = aimed(ball, {}, pitch, d, length, line);
  EXPECT_TRUE(laid) << laid.error().message;
  const auto path = deliver(ball, {}, pitch, *laid);
  EXPECT_TRUE(path) << path.error().message;
  return *path;
}

TEST(Cricket, IsAimedToAMillimetre) {
  for (const auto& preset : cricket_presets())
    for (const double length : {2.0, 6.0, 10.0}) {
      const CricketPath path = thrown(preset.value, length, -.1);
      EXPECT_FALSE(path.full) << preset.name;
      EXPECT_NEAR(path.length, length, 1e-3) << preset.name;
      EXPECT_NEAR(path.line, -.1, 1e-3) << preset.name;
      EXPECT_LT(path.speed, preset.value.speed) << preset.name;
      // The path is one: at the pitch, at the end.
      EXPECT_LT(math::length(path.at(path.air.duration()).position - path.air.end().position), 1e-9);
      EXPECT_NEAR(path.at(path.time).position.x, cricket_pitch, 1e-5);
    }
}

// A force C across a way at a steady speed bends it by ½ (F/m) T²; the seam turns out of the flow as it goes, so that a
// little less is left. Mirrored seams swing to the other side.
TEST(Cricket, SwingIsHalfTheForceTimesTheTimeSquared) {
  const Ball ball = *ball_preset("cricket");
  const CricketDelivery d = *cricket_preset("outswinger");
  const CricketPath out = thrown(d), in = thrown(*cricket_preset("inswinger"));
  const double force = .5 * 1.225 * area(ball) * d.speed * d.speed * ball.side.coefficient;
  const double bend = .5 * force / ball.mass * math::square(out.air.duration());
  EXPECT_LT(out.swing, -.5 * bend);
  EXPECT_GT(out.swing, -bend);
  EXPECT_LT(out.swing, -.3) << "some decimetres are told";
  EXPECT_GT(out.swing, -1.2);
  CricketDelivery mirror = d;
  mirror.seam = -d.seam;
  mirror.side = -d.side;
  EXPECT_NEAR(thrown(mirror).swing, -out.swing, 2e-3);
  EXPECT_GT(in.swing, .3);
  // Beyond some 36 m/s the flow turns round, and the seam of an outswinger brings it in.
  EXPECT_GT(thrown(*cricket_preset("reverse_swinger")).swing, .1);
  // An upright seam goes straight.
  CricketDelivery upright = d;
  upright.seam = 0;
  upright.side = 0;
  EXPECT_NEAR(thrown(upright).swing, 0, .02);
}

TEST(Cricket, SpinTurnsOffThePitch) {
  const CricketPath off = thrown(*cricket_preset("off_break"), 4), leg = thrown(*cricket_preset("leg_break"), 4),
                    googly = thrown(*cricket_preset("googly"), 4), straight = thrown(*cricket_preset("top_spinner"), 4);
  EXPECT_GT(off.turn / degree, 2);
  EXPECT_LT(off.turn / degree, 10);
  EXPECT_LT(leg.turn / degree, -2);
  EXPECT_GT(googly.turn / degree, 2);
  EXPECT_NEAR(straight.turn / degree, 0, .2);
  // Topspin dips: what leaves the hand alike pitches shorter, and comes off steeper than backspin.
  CricketDelivery back = *cricket_preset("top_spinner");
  back.tilt = 0;
  const auto top = deliver(*ball_preset("cricket"), {}, *surface_preset("pitch"), *cricket_preset("top_spinner")),
             floats = deliver(*ball_preset("cricket"), {}, *surface_preset("pitch"), back);
  ASSERT_TRUE(top && floats);
  EXPECT_GT(top->length, floats->length + .3);
}

TEST(Cricket, LengthsDoWhatTheirNamesSay) {
  const CricketPath yorker = thrown(*cricket_preset("yorker"), 1.0), bouncer = thrown(*cricket_preset("bouncer"), 9);
  EXPECT_TRUE(yorker.hits);
  EXPECT_LT(yorker.height, .4);
  // At the popping crease, 4 ft before the stumps, it is at a batter's shoulder; a good length hits the stumps or
  // passes a little over them, and loses a tenth to a third of its speed on the pitch.
  const double shoulder = bouncer.off[0].at_x(cricket_pitch - 1.2192)->position.y;
  EXPECT_GT(shoulder, 1.3);
  EXPECT_LT(shoulder, 1.6);
  const CricketPath good = thrown(*cricket_preset("outswinger"), 6);
  EXPECT_GT(good.height, 0.6);
  EXPECT_LT(good.height, 1.1);
  const double pace = length(good.off[0].start().velocity) / length(good.air.end().velocity);
  EXPECT_GT(pace, 0.7);
  EXPECT_LT(pace, 0.9);
  EXPECT_FALSE(bouncer.hits);
  EXPECT_GT(thrown(*cricket_preset("slower_ball")).time, 1.2 * thrown(*cricket_preset("yorker")).time);
  const auto full =
      deliver(*ball_preset("cricket"), {}, *surface_preset("pitch"), {.speed = 38, .elevation = 0, .side = 0});
  ASSERT_TRUE(full);
  EXPECT_TRUE(full->full);
  EXPECT_TRUE(full->off.empty());
}

// The drop test of grounds: from 16 ft a fast pitch gives back 25 to 30 in.
TEST(Cricket, AFastPitchGivesBackWhatTheDropTestSays) {
  const double fall = 16 * .3048, speed = math::sqrt(2 * 9.80665 * fall);
  const Bounce up = bounce(*ball_preset("cricket"), *surface_preset("pitch"), {0, 1, 0}, {.velocity = {0, -speed, 0}});
  const double height = math::square(up.after.velocity.y) / (2 * 9.80665);
  EXPECT_GT(height, 25 * .0254);
  EXPECT_LT(height, 30 * .0254);
}

TEST(Cricket, BadInputIsNamed) {
  const Ball ball = *ball_preset("cricket");
  const Surface pitch = *surface_preset("pitch");
  const auto message = [&](const CricketDelivery& d, double distance = cricket_pitch) {
    const auto path = deliver(ball, {}, pitch, d, distance);
    return path ? std::string() : path.error().message;
  };
  EXPECT_EQ(message({}), "");
  EXPECT_NE(message({.speed = __builtin_nan("")}).find("speed of a delivery"), std::string::npos);
  EXPECT_NE(message({.height = -1}).find("height of a delivery"), std::string::npos);
  EXPECT_NE(message({}, -3).find("distance"), std::string::npos);
  EXPECT_NE(message({.speed = 2}).find("does not reach the stumps"), std::string::npos);
  EXPECT_FALSE(aimed(ball, {}, pitch, {}, -1, 0));
  EXPECT_FALSE(aimed(ball, {}, pitch, {.speed = 3}, 1, 0));
}

}  // namespace cricket_test
