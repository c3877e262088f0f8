// Games as files: the same numbers as the library's own, and errors that name the place.
#include "carom/scene/game_presets.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/scene/source_file.h"

namespace scene_game_presets_test {
using namespace carom;

template <class T, class Parse>
void expect_files(std::span<const sports::GamePreset<T>> presets, const std::string& kind, Parse&& parse) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(CAROM_SOURCE_DIR) + "/presets/" + kind))
    files += entry.path().extension() == ".json";
  EXPECT_EQ(files, presets.size()) << kind;
  for (const auto& preset : presets) {
    const std::string name = kind + "/" + std::string(preset.name) + ".json";
    const auto text = scene::test::read_source("presets/" + name);
    ASSERT_TRUE(text) << name;
    EXPECT_NE(text->find(preset.source), std::string::npos) << name;
    EXPECT_NE(text->find(preset.description), std::string::npos) << name;
    const auto value = parse(*text, name);
    ASSERT_TRUE(value) << value.error().message;
    if constexpr (!std::is_same_v<T, sports::Swing>) {
      const auto found = sports::game_numbers(*value), expected = sports::game_numbers(preset.value);
      for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(found[i], expected[i], 1e-12 * (1 + std::abs(expected[i])))
            << name << ' ' << sports::game_number_names<T>()[i].name;
    }
  }
}

void expect_same(const sports::Curve& found, const sports::Curve& expected) {
  ASSERT_EQ(found.points.size(), expected.points.size());
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    EXPECT_EQ(found.points[i].time, expected.points[i].time);
    EXPECT_EQ(found.points[i].value, expected.points[i].value);
  }
}

TEST(SceneGamePresets, FilesAreTheLibrarysNumbers) {
  expect_files(sports::pitch_presets(), "pitch", scene::parse_pitch);
  expect_files(sports::bat_presets(), "bat", scene::parse_bat);
  expect_files(sports::cricket_presets(), "cricket", scene::parse_cricket_delivery);
  expect_files(sports::bowling_ball_presets(), "bowling_ball", scene::parse_bowling_ball);
  expect_files(sports::lane_presets(), "lane", scene::parse_lane);
  expect_files(sports::bowling_presets(), "bowling", scene::parse_bowling_delivery);
  expect_files(sports::swing_presets(), "swing", scene::parse_swing);
  for (const auto& preset : sports::lane_presets()) {
    const std::string name = "lane/" + std::string(preset.name) + ".json";
    const auto lane = scene::parse_lane(scene::test::read_source("presets/" + name).value(), name);
    ASSERT_EQ(lane->stretches.size(), preset.value.stretches.size());
    for (std::size_t i = 0; i < lane->stretches.size(); ++i) {
      EXPECT_NEAR(lane->stretches[i].end, preset.value.stretches[i].end, 1e-12);
      EXPECT_EQ(lane->stretches[i].friction, preset.value.stretches[i].friction);
    }
  }
  for (const auto& preset : sports::swing_presets()) {
    const std::string name = "swing/" + std::string(preset.name) + ".json";
    const auto swing = scene::parse_swing(scene::test::read_source("presets/" + name).value(), name);
    const sports::Swing& expected = preset.value;
    EXPECT_NEAR(swing->plane, expected.plane, 1e-15);
    EXPECT_EQ(swing->impact, expected.impact);
    EXPECT_EQ(swing->shaft.frequency, expected.shaft.frequency);
    EXPECT_EQ(swing->shaft.damping_ratio, expected.shaft.damping_ratio);
    EXPECT_EQ(swing->shaft.head_mass, expected.shaft.head_mass);
    EXPECT_EQ(swing->shaft.shaft_mass, expected.shaft.shaft_mass);
    ASSERT_EQ(swing->links.size(), expected.links.size());
    for (std::size_t i = 0; i < expected.links.size(); ++i) {
      const sports::SwingLink &a = swing->links[i], &b = expected.links[i];
      EXPECT_NEAR(a.mass, b.mass, 1e-12);
      EXPECT_NEAR(a.length, b.length, 1e-12);
      EXPECT_NEAR(a.centre, b.centre, 1e-12);
      EXPECT_NEAR(a.inertia, b.inertia, 1e-12);
      EXPECT_NEAR(a.angle, b.angle, 1e-12);
      EXPECT_EQ(a.hold.until, b.hold.until);
      expect_same(a.torque, b.torque);
    }
  }
}

TEST(SceneGamePresets, ErrorsNameThePlace) {
  const auto message = [](const auto& result) { return result ? std::string() : result.error().message; };
  const auto has = [&](const auto& result, const char* what) {
    EXPECT_NE(message(result).find(what), std::string::npos) << message(result);
  };
  has(scene::parse_pitch("{\n\"values\": {\n\"speed\": \"94\"}}", "p.json"), "p.json:3: values.speed");
  has(scene::parse_pitch(R"({"values": {"speed": "-94 mph"}})", "p.json"), "p.json: speed of a pitch is -42");
  has(scene::parse_bat(R"({"values": {"length": "1 m"}})", "b.json"), "values.length: found a name that is not known");
  has(scene::parse_cricket_delivery(R"({"values": {"seam": "4 m"}})", "c.json"), "values.seam");
  has(scene::parse_lane(R"({"values": {}})", "l.json"), "values.stretches: expected a list");
  has(scene::parse_lane(R"({"values": {"stretches": [{"end": "5 m"}, {"end": "4 m"}]}})", "l.json"),
      "l.json: end of stretch 2");
  has(scene::parse_lane(R"({"values": {"stretches": [5]}})", "l.json"),
      "values.stretches[0]: found 5, expected an object");
  has(scene::parse_swing(R"({"values": {"links": [{"mass": "1 kg"}]}})", "s.json"), "s.json: ");
  has(scene::parse_swing(R"({"values": {"links": [{"hold": 4}, {}]}})", "s.json"), "values.links[0].hold: found 4");
  has(scene::parse_swing(R"({"values": {"links": [{"torque": [0, 1, 2]}, {}]}})", "s.json"), "pairs of time and value");
  has(scene::parse_swing(R"({"values": {"impact": "never", "links": []}})", "s.json"), "expected head_below_hub");
}

}  // namespace scene_game_presets_test
