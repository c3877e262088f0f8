// Balls, surfaces and clubs as files: the same numbers as the library's own, and errors that name the place.
#include "carom/scene/sports_presets.h"

#include <gtest/gtest.h>

#include "carom/sports/presets.h"
#include "tests/scene/source_file.h"

namespace sports_presets_test {
using namespace carom;

std::string file(const std::string& path) { return scene::test::read_source("presets/" + path).value(); }

template <class Numbers>
void expect_same(const Numbers& found, const Numbers& expected, std::string_view name) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-12 * (1 + std::abs(expected[i]))) << name << " " << i;
}

TEST(SportsPresets, FilesAreTheLibrarysNumbers) {
  for (const sports::BallPreset& preset : sports::ball_presets()) {
    const std::string name = "flight/" + std::string(preset.name) + ".json";
    const auto ball = scene::parse_ball(file(name), name);
    ASSERT_TRUE(ball) << ball.error().message;
    expect_same(sports::ball_numbers(*ball), sports::ball_numbers(preset.ball), preset.name);
    EXPECT_EQ(ball->side.kind, preset.ball.side.kind);
    EXPECT_EQ(ball->lift.shape, preset.ball.lift.shape) << preset.name;
  }
  for (const sports::SurfacePreset& preset : sports::surface_presets()) {
    const std::string name = "surface/" + std::string(preset.name) + ".json";
    const auto surface = scene::parse_surface(file(name), name);
    ASSERT_TRUE(surface) << surface.error().message;
    expect_same(sports::surface_numbers(*surface), sports::surface_numbers(preset.surface), preset.name);
  }
  for (const sports::ClubPreset& preset : sports::club_presets()) {
    const std::string name = "club/" + std::string(preset.name) + ".json";
    const auto head = scene::parse_club(file(name), name);
    ASSERT_TRUE(head) << head.error().message;
    expect_same(sports::club_numbers(*head), sports::club_numbers(preset.head), preset.name);
  }
}

TEST(SportsPresets, ErrorsNameThePlace) {
  const auto error = [](std::string_view text) {
    const auto ball = scene::parse_ball(text, "my.json");
    return ball ? std::string() : ball.error().message;
  };
  EXPECT_EQ(error(R"({"values": {"mass": "45 g", "radius": "21 mm"}})"), "");
  EXPECT_NE(error("{\n\"values\": {\n\"mass\": \"45 m\"}}").find("my.json:3: values.mass"), std::string::npos);
  EXPECT_NE(error(R"({"values": {"mass": 45}})").find("expected a quantity in kg"), std::string::npos);
  EXPECT_NE(error(R"({"values": {"weight": 45}})").find("values.weight: found a name that is not known"),
            std::string::npos);
  EXPECT_NE(error(R"({"values": {"mass": "-1 kg"}})").find("my.json: mass of a ball is -1"), std::string::npos);
  EXPECT_NE(error(R"({"values": {"side_kind": "odd"}})").find("expected none, held_seam"), std::string::npos);
  EXPECT_NE(error(R"({"balls": {}})").find("found a key"), std::string::npos);
  EXPECT_NE(error("[]").find("expected an object"), std::string::npos);
  EXPECT_NE(error("").find("my.json"), std::string::npos);
}

}  // namespace sports_presets_test
