// Rockets as files: they fly, and errors name the place.
#include "carom/scene/rocket_presets.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/scene/source_file.h"

namespace rocket_presets_test {
using namespace carom;
using namespace carom::ballistics;
using scene::test::read_source;

// Every rocket of presets/ is stable by a calibre at the least, goes up, and comes down by its parachute.
TEST(RocketPresets, EveryFileFlies) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(CAROM_SOURCE_DIR) + "/presets/rocket")) {
    const std::string path = "presets/rocket/" + entry.path().filename().string();
    const auto rocket = scene::parse_rocket(read_source(path).value(), path, read_source);
    ASSERT_TRUE(rocket) << rocket.error().message;
    const Conditions air{.air = environment::AirColumn::uniform(1.225)};
    const auto flight =
        fly_rocket(*rocket, air, {.rail_length = 1.2}, RocketModel::six_degrees, {.time = 600, .ground = 0});
    ASSERT_TRUE(flight) << path << ": " << flight.error().message;
    const RocketMoment* apex = flight->first(RocketEvent::apex);
    ASSERT_TRUE(apex != nullptr && flight->first(RocketEvent::parachute) != nullptr) << path;
    EXPECT_GT(apex->position.y, 50) << path;
    double mass = 0, moment = 0;
    for (const Stage& stage : rocket->stages) {
      mass += stage.dry_mass + stage.motor.mass;
      moment += stage.dry_mass * stage.dry_centre + stage.motor.mass * stage.motor_centre;
    }
    EXPECT_GT(barrowman(*rocket).centre_of_pressure, moment / mass + rocket->diameter) << path << ": a calibre";
    const double sinks = math::sqrt(2 * flight->masses.back() * 9.80665 / (1.225 * rocket->parachute.drag_area));
    EXPECT_NEAR(-flight->path.end().velocity.y, sinks, .02 * sinks) << path;
    ++count;
  }
  EXPECT_GE(count, 2);
}

// The impulses are those that the NAR certified for a C6 (8.82 N s), the masses those of the file: the mean exhaust
// speed and the change of mass are in the flight.
TEST(RocketPresets, HoldsWhatTheFileSays) {
  const std::string path = "presets/rocket/two_stage_c6.json";
  const auto rocket = scene::parse_rocket(read_source(path).value(), path, read_source);
  ASSERT_TRUE(rocket) << rocket.error().message;
  ASSERT_EQ(rocket->stages.size(), 2u);
  for (const Stage& stage : rocket->stages) EXPECT_NEAR(stage.motor.curve.total_impulse(), 8.82, .002 * 8.82);
  EXPECT_DOUBLE_EQ(rocket->stages[0].dry_mass, .025);
  EXPECT_DOUBLE_EQ(rocket->stages[1].ignition_delay, .1);
  EXPECT_EQ(rocket->fins.count, 4);
  EXPECT_DOUBLE_EQ(rocket->fins.position, .7);
  EXPECT_DOUBLE_EQ(rocket->coasting_drag(0), .55);
  const auto flight =
      fly_rocket(*rocket, {}, {.rail_length = 1.2}, RocketModel::point_mass, {.time = 600, .ground = 0});
  ASSERT_TRUE(flight) << flight.error().message;
  const RocketMoment* separation = flight->first(RocketEvent::separation);
  ASSERT_NE(separation, nullptr);
  EXPECT_GT(flight->first(RocketEvent::apex)->position.y, 2 * separation->position.y);
}

// C_D by Mach number, with and without a motor that burns.
TEST(RocketPresets, DragTables) {
  const std::string path = "presets/rocket/two_stage_c6.json";
  std::string text = read_source(path).value();
  const std::string number = "\"drag_coefficient\": 0.55";
  const std::size_t at = text.find(number);
  ASSERT_NE(at, std::string::npos);
  const auto with = [&](const std::string& drag) {
    std::string other = text;
    other.replace(at, number.size(), drag);
    return scene::parse_rocket(other, "r.json", read_source);
  };
  const auto rocket =
      with(R"("drag_table": [0, 0.5, 0.9, 0.55, 1.1, 0.9, 3, 0.4], "coasting_drag_table": [0, 0.6, 2, 0.7])");
  ASSERT_TRUE(rocket) << rocket.error().message;
  EXPECT_EQ(rocket->drag(0), .5);
  EXPECT_NEAR(rocket->drag(1.1), .9, 1e-12);
  EXPECT_NEAR(rocket->drag(9), .4, 1e-12);
  EXPECT_NEAR(rocket->coasting_drag(2), .7, 1e-12);
  const auto same = with(R"("drag_table": [0, 0.5, 3, 0.4])");
  ASSERT_TRUE(same);
  EXPECT_EQ(same->coasting_drag(0), .5) << "the same without a motor unless given";
  // A constant table flies as the number does.
  const auto flat = with(R"("drag_table": [0, 0.55, 5, 0.55])"),
             plain = scene::parse_rocket(text, "r.json", read_source);
  ASSERT_TRUE(flat && plain);
  const auto apex = [](const Rocket& r) {
    return fly_rocket(r, {}, {.rail_length = 1.2}, RocketModel::point_mass, {.time = 600, .ground = 0})
        ->first(RocketEvent::apex)
        ->position.y;
  };
  EXPECT_NEAR(apex(*flat), apex(*plain), 1e-6);
  EXPECT_NE(with(R"("drag_table": [0, 0.5, 0, 0.4])").error().message.find("values.drag_table"), std::string::npos);
  EXPECT_NE(with(R"("drag_table": [0, 0.5, 1])").error().message.find("pairs"), std::string::npos);
  EXPECT_NE(with(R"("drag_table": [0, 0.5], "drag_coefficient": 1)").error().message.find("one of them"),
            std::string::npos);
}

TEST(RocketPresets, ErrorsNameThePlace) {
  const auto error = [](const std::string& values) {
    const auto rocket = scene::parse_rocket("{\"values\": {" + values + "}}", "r.json", read_source);
    return rocket.ok() ? std::string("none") : rocket.error().message;
  };
  const std::string size = R"("diameter": "25 mm", "length": "1 m", )";
  const auto says = [](const std::string& message, const std::string& part) {
    EXPECT_TRUE(message.starts_with("r.json:1: ")) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(error(R"("length": "1 m", "stages": [])"), "values.diameter");
  says(error(size + R"("stages": [])"), "1 to 10 stages");
  says(error(size + R"("wings": 2, "stages": [])"), "values.wings");
  says(error(size + R"("fin_count": 2.5, "stages": [])"), "a whole number");
  says(error(R"("diameter": "-1 m", "length": "1 m", "stages": [])"), "values.diameter");
  says(error(R"("diameter": "3 kg", "length": "1 m", "stages": [])"), "values.diameter");
  says(error(size + R"("stages": [{"dry_mass": "1 kg"}])"), "values.stages[0].motor: is missing");
  says(error(size + R"("stages": [{"motor": "black_powder"}])"), "values.stages[0].dry_mass");
  says(error(size + R"("stages": [{"dry_mass": "1 kg", "motor": "../x"}])"), "the name of a preset");
  says(error(size + R"("stages": [{"dry_mass": "1 kg", "motor": "nothing"}])"), "no file presets/motor/nothing.eng");
  says(error(size + R"("stages": [{"dry_mass": "1 kg", "motor": "black_powder", "designation": "Z9"}])"), "A8, B6, C6");
}

}  // namespace rocket_presets_test
