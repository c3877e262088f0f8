// Games as data: every preset can be played, and does what players know of it.
#include "carom/sports/game_presets.h"

#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/sports/golf.h"
#include "carom/sports/presets.h"

namespace game_presets_test {
using namespace carom;
using namespace carom::sports;

constexpr double inch = 0.0254, degree = math::pi / 180, mph = 0.44704;

// Breaks (in, up and to the pitcher's right) of the class that Major League Baseball's tracking tells of right-handed
// pitchers; from memory, ± 4 in.
TEST(GamePresets, PitchesBreakAsTheirKindDoes) {
  const struct {
    const char* name;
    double up, right;
  } told[] = {{"four_seam", 16, 7}, {"sinker", 8, 15},      {"cutter", 8, -3},   {"slider", 1, -5},
              {"sweeper", 1, -14},  {"curveball", -10, -9}, {"changeup", 6, 14}, {"splitter", 4, 8}};
  const Ball ball = *ball_preset("baseball");
  for (const auto& row : told) {
    const auto laid = aimed(ball, {}, *pitch_preset(row.name), .75, 0);
    ASSERT_TRUE(laid) << laid.error().message;
    const auto path = pitch(ball, {}, *laid);
    ASSERT_TRUE(path);
    EXPECT_NEAR(path->height, .75, 1e-3);
    EXPECT_NEAR(path->side, 0, 1e-3);
    EXPECT_NEAR(path->rise / inch, row.up, 4) << row.name;
    EXPECT_NEAR(path->run / inch, row.right, 4) << row.name;
    EXPECT_NEAR(path->speed / laid->speed, .915, .02) << "a tenth of the speed is lost: " << row.name;
  }
  const auto gyro = pitch(ball, {}, *pitch_preset("gyroball"));
  EXPECT_LT(math::hypot(gyro->rise, gyro->run) / inch, 2);
  EXPECT_TRUE(pitch(*ball_preset("knuckleball"), {}, *pitch_preset("knuckleball")));
  EXPECT_FALSE(aimed(ball, {}, {.speed = 3}, .75, 0));
  EXPECT_FALSE(pitch(ball, {}, {.speed = __builtin_nan("")}));
}

// v = q v_pitch + (1 + q) v_bat with q near .2 of a wooden bat; a free composite hits harder, a fungo throws less.
TEST(GamePresets, BatsHitAsTheirKindDoes) {
  const Ball ball = *ball_preset("baseball");
  const auto speed = [&](const char* name) {
    const auto out =
        hit(ball, *bat_preset(name), {.speed = 70 * mph, .attack = 0, .offset = 0}, {.velocity = {85 * mph, 0, 0}});
    EXPECT_TRUE(out) << name;
    return -out->velocity.x / mph;
  };
  const Bat wood = *bat_preset("wood");
  const double r = ball.mass / wood.effective_mass, q = (wood.restitution - r) / (1 + r);
  EXPECT_NEAR(q, .24, .05) << "about .2";
  EXPECT_NEAR(speed("wood"), q * 85 + (1 + q) * 70, 1e-9);
  EXPECT_NEAR(speed("aluminium"), speed("wood"), 2) << "as the rules want it";
  EXPECT_GT(speed("composite_free"), speed("wood") + 5);
  EXPECT_LT(speed("fungo"), speed("wood"));
}

// Entry angles grow with what the hand gives; 4 to 6° into the pocket make strikes. Plastic goes straighter.
TEST(GamePresets, BowlersHookAsTheirKindDoes) {
  const auto path = [](const char* who, const char* ball = "reactive", const char* lane = "oil_40ft") {
    const auto p = bowl(*bowling_ball_preset(ball), *lane_preset(lane), *bowling_preset(who));
    EXPECT_TRUE(p) << who << ": " << p.error().message;
    EXPECT_FALSE(p->gutter) << who << ' ' << ball << ' ' << lane;
    return *p;
  };
  double before = -1;
  for (const char* who : {"straight", "stroker", "tweener", "cranker"}) {
    const double angle = path(who).entry_angle() / degree;
    EXPECT_GT(angle, before) << who;
    EXPECT_LT(angle, 8) << who;
    before = angle;
  }
  EXPECT_LT(path("backup").entry_angle(), 0);
  EXPECT_LT(path("cranker", "plastic").entry_angle(), .8 * path("cranker").entry_angle());
  EXPECT_LT(path("stroker", "reactive", "oil_45ft").end().y, path("stroker", "reactive", "oil_32ft").end().y)
      << "long oil hooks less";
  for (const auto& ball : bowling_ball_presets())
    for (const auto& lane : lane_presets())
      for (const auto& who : bowling_presets()) {
        const auto p = bowl(ball.value, lane.value, who.value);
        EXPECT_TRUE(p) << ball.name << ' ' << lane.name << ' ' << who.name << ": " << p.error().message;
      }
  // USBC.
  for (const char* name : {"reactive", "urethane", "plastic"})
    EXPECT_TRUE(usbc_allows(*bowling_ball_preset(name), *lane_preset("oil_40ft"))) << name;
  // The cover multiplies the lane's friction: the same as a lane of so much less.
  Lane half = *lane_preset("oil_40ft");
  for (auto& s : half.stretches) s.friction *= .55;
  BowlingBall bare = *bowling_ball_preset("plastic");
  bare.cover = 1;
  EXPECT_EQ(bowl(bare, half, *bowling_preset("cranker"))->end().y, path("cranker", "plastic").end().y);
}

TEST(GamePresets, SwingsMeetTheBall) {
  for (const auto& preset : swing_presets()) {
    const auto result = swing(preset.value);
    ASSERT_TRUE(result) << preset.name;
    EXPECT_TRUE(result->impact) << preset.name;
    EXPECT_GT(result->speed, 30) << preset.name;
    EXPECT_LT(result->speed, 60) << preset.name;
  }
}

TEST(GamePresets, UnknownNamesSayWhatThereIs) {
  EXPECT_NE(pitch_preset("spitball").error().message.find("four_seam"), std::string::npos);
  EXPECT_NE(bat_preset("x").error().message.find("wood"), std::string::npos);
  EXPECT_NE(cricket_preset("x").error().message.find("googly"), std::string::npos);
  EXPECT_NE(bowling_ball_preset("x").error().message.find("plastic"), std::string::npos);
  EXPECT_NE(lane_preset("x").error().message.find("oil_40ft"), std::string::npos);
  EXPECT_NE(bowling_preset("x").error().message.find("cranker"), std::string::npos);
  EXPECT_NE(swing_preset("x").error().message.find("textbook"), std::string::npos);
}

}  // namespace game_presets_test
