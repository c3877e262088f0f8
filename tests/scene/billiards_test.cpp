// Presets of tables, cloths and cues.
#include "carom/scene/billiards.h"

#include <gtest/gtest.h>

#include <filesystem>
#include "tests/scene/source_file.h"

namespace scene_billiards_test {
using namespace carom;

std::string preset(const std::string& name) { return scene::test::read_source("presets/" + name).value(); }

void same(const scene::BilliardSetting& read, const sports::RectangularTable& table,
          const sports::BilliardPhysics& physics, const char* name) {
  const sports::RectangularTable& t = read.table;
  const double found[] = {t.length,       t.width,         t.nose_height,     t.corner_mouth, t.corner_angle,
                          t.corner_depth, t.corner_radius, t.corner_rounding, t.side_mouth,   t.side_angle,
                          t.side_depth,   t.side_radius,   t.side_rounding};
  const double expected[] = {table.length,       table.width,        table.nose_height,   table.corner_mouth,
                             table.corner_angle, table.corner_depth, table.corner_radius, table.corner_rounding,
                             table.side_mouth,   table.side_angle,   table.side_depth,    table.side_radius,
                             table.side_rounding};
  for (std::size_t i = 0; i < std::size(found); ++i) {
    if (table.pockets || i < 3) {
      EXPECT_NEAR(found[i], expected[i], 1e-12) << name << " " << i;
    }
  }
  EXPECT_EQ(t.pockets, table.pockets) << name;
  const sports::BilliardPhysics& p = read.physics;
  EXPECT_NEAR(p.ball.mass, physics.ball.mass, 1e-12) << name;
  EXPECT_NEAR(p.ball.radius, physics.ball.radius, 1e-12) << name;
  EXPECT_NEAR(p.cloth.sliding_friction, physics.cloth.sliding_friction, 1e-12) << name;
  EXPECT_NEAR(p.cloth.spinning_friction, physics.cloth.spinning_friction, 1e-12) << name;
  EXPECT_NEAR(p.cushion.friction, physics.cushion.friction, 1e-12) << name;
  EXPECT_NEAR(p.balls.restitution, physics.balls.restitution, 1e-12) << name;
}

// The files say what the library's functions say.
TEST(BilliardPresets, TablesAreTheBuiltInOnes) {
  const struct {
    const char* name;
    sports::RectangularTable table;
    sports::BilliardPhysics physics;
  } cases[] = {{"pool_7ft", sports::seven_foot_pool(), sports::pool_physics()},
               {"pool_8ft", sports::eight_foot_pool(), sports::pool_physics()},
               {"pool_9ft", sports::nine_foot_pool(), sports::pool_physics()},
               {"snooker", sports::snooker_table(), sports::snooker_physics()},
               {"carom", sports::carom_table(), sports::carom_physics()},
               {"russian", sports::russian_table(), sports::russian_physics()}};
  for (const auto& c : cases) {
    const std::string name = std::string("table/") + c.name + ".json";
    const auto read = scene::read_billiard_table(preset(name), name);
    ASSERT_TRUE(read.ok()) << read.error().message;
    same(*read, c.table, c.physics, c.name);
  }
}

TEST(BilliardPresets, AllFilesCanBeRead) {
  int files = 0;
  for (const char* kind : {"table", "cloth", "cue"})
    for (const auto& file : std::filesystem::directory_iterator(std::string(CAROM_SOURCE_DIR) + "/presets/" + kind)) {
      const std::string name = std::string(kind) + "/" + file.path().filename().string(), text = preset(name);
      ++files;
      if (std::string_view(kind) == "table") {
        const auto read = scene::read_billiard_table(text, name);
        EXPECT_TRUE(read.ok()) << read.error().message;
      } else if (std::string_view(kind) == "cloth") {
        const auto read = scene::read_cloth(text, name);
        EXPECT_TRUE(read.ok()) << read.error().message;
      } else {
        const auto read = scene::read_cue(text, name);
        EXPECT_TRUE(read.ok()) << read.error().message;
      }
    }
  EXPECT_GE(files, 17);
  sports::Cloth worn;
  worn.spinning_friction = .02;
  EXPECT_EQ(scene::read_cloth(preset("cloth/fast.json"), "fast", worn)->spinning_friction, .02)
      << "what is not said stays";
}

TEST(BilliardPresets, ErrorsNameThePlace) {
  const auto error = [](const char* text) {
    const auto read = scene::read_billiard_table(text, "t.json");
    return read.ok() ? std::string() : read.error().message;
  };
  EXPECT_NE(error("{"), "");
  EXPECT_NE(error("[]").find("t.json:1"), std::string::npos);
  EXPECT_NE(error("{\"values\": 3}").find("values"), std::string::npos);
  const std::string wrong = error("{\n \"values\": {\n  \"length\": \"2 s\"}}");
  EXPECT_NE(wrong.find("t.json:3: length: found \"2 s\", expected a length"), std::string::npos) << wrong;
  EXPECT_NE(error("{\"values\": {\"lenght\": 2}}").find("one of the keys length"), std::string::npos);
  EXPECT_NE(error("{\"values\": {\"ball\": {\"mass\": \"-1 kg\"}}}").find("ball.mass"), std::string::npos);
  EXPECT_NE(error("{\"values\": {\"corner_radius\": \"1 mm\"}}").find("facings"), std::string::npos);
  EXPECT_NE(error("{\"values\": {\"cushion\": {\"model\": \"wood\"}}}").find("mathavan"), std::string::npos);
  EXPECT_FALSE(scene::read_cue("{\"values\": {\"mass\": 0}}", "c").ok());
  EXPECT_FALSE(scene::read_cloth("{\"values\": {\"rolling_friction\": 2}}", "c").ok());
}

}  // namespace scene_billiards_test
