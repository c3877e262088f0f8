// Guns, ammunition, sights and walls as files: what follows from them is the reference's, errors name the place.
#include "carom/scene/weapon_presets.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/scene/source_file.h"

namespace weapon_presets_test {
using namespace carom;
using namespace carom::ballistics;
using scene::test::read_source;

constexpr double yard = 0.9144, foot = 0.3048, inch = 0.0254, degree = math::pi / 180;

Weapon gun(const std::string& name) {
  const std::string path = "presets/gun/" + name + ".json";
  auto w = scene::parse_gun(read_source(path).value(), path, read_source);
  EXPECT_TRUE(w) << w.error().message;
  return w.ok() ? *w : Weapon{};
}

TEST(WeaponPresets, EveryFileIsRead) {
  int count = 0;
  for (const char* kind : {"gun", "ammunition", "sight", "wall"})
    for (const auto& entry : std::filesystem::directory_iterator(std::string(CAROM_SOURCE_DIR) + "/presets/" + kind)) {
      const std::string path = "presets/" + std::string(kind) + "/" + entry.path().filename().string();
      const std::string text = read_source(path).value();
      const std::string_view k = kind;
      const auto told = [&](const auto& result) { EXPECT_TRUE(result.ok()) << result.error().message; };
      if (k == "gun") told(scene::parse_gun(text, path, read_source));
      if (k == "ammunition") told(scene::parse_ammunition(text, path));
      if (k == "sight") told(scene::parse_sight(text, path));
      if (k == "wall") told(scene::parse_wall(text, path));
      ++count;
    }
  EXPECT_GE(count, 20);
}

// The .308 of 8 lb: the reference's zero at 100 yd and drop at 500 yd, published free recoil 11.552 ft/s and 16.59
// ft·lbf, Miller's 2.032; the dial of its scope.
TEST(WeaponPresets, TheRifleIsTheReferencesRifle) {
  const Weapon w = gun("rifle_308");
  const Conditions air{.air = environment::AirColumn::uniform(1.225)};
  const auto aiming = zeroed(w, air);
  ASSERT_TRUE(aiming) << aiming.error().message;
  EXPECT_NEAR(aiming->elevation, .00114214, 1e-6);
  const FreeRecoil recoil = free_recoil(w);
  EXPECT_NEAR(recoil.speed / foot, 11.552, .002);
  EXPECT_NEAR(recoil.energy / 1.3558179, 16.59, .01);
  const Gun g = gun_of(w);
  ASSERT_TRUE(g.shape);
  EXPECT_NEAR(miller_stability(*g.shape, g.twist, g.muzzle_speed / foot), 2.032, 2e-3);
  const auto turns = dial(w, air, 500 * yard);
  ASSERT_TRUE(turns) << turns.error().message;
  EXPECT_NEAR(math::tan(turns->hold_up) * 500 * yard / inch, 64.287, .1);
  EXPECT_EQ(turns->up, int(math::round(turns->hold_up / (0.25 * minute_of_angle))));
  EXPECT_NEAR(turns->marks_up, turns->hold_up / 1e-3, 1e-9);
  EXPECT_FALSE(dial(w, air, -5));
  EXPECT_FALSE(dial(w, air, 1e7));
}

TEST(WeaponPresets, CarbineAndCannon) {
  const Weapon carbine = gun("carbine_556");
  EXPECT_NEAR(zeroed(carbine, {.air = environment::AirColumn::uniform(1.225)})->elevation, .00126231, 1e-6);
  const auto pattern = recoil_pattern(carbine.mount, recoil_impulse(charge_of(carbine)),
                                      {.shots = 10, .rounds_per_minute = carbine.rounds_per_minute});
  ASSERT_TRUE(pattern);
  EXPECT_GT((*pattern)[9].y, 0) << "it climbs";
  const auto spread = spread_at(gun_of(carbine), {}, *zeroed(carbine), 300, variation_of(carbine, 1e-3));
  ASSERT_TRUE(spread) << spread.error().message;
  EXPECT_GT(spread->sigma.x, .3);
  // The Napoleon at 5°: 1479 yd by its ball's table, as the reference computed.
  const Weapon napoleon = gun("napoleon_12_pounder");
  EXPECT_FALSE(gun_of(napoleon).shape) << "a smooth bore";
  const auto flight = fly(gun_of(napoleon).projectile, {}, {{}, gun_of(napoleon).muzzle_speed * direction(5 * degree)},
                          {.time = 60, .ground = 0});
  EXPECT_NEAR(flight->end().position.x / yard, 1479.4, 1.5);
}

TEST(WeaponPresets, WallsStopWhatTheyShould) {
  const auto wall = [](const char* name) {
    const std::string path = "presets/wall/" + std::string(name) + ".json";
    return scene::parse_wall(read_source(path).value(), path).value();
  };
  const Penetrator rifle = penetrator_of(gun("rifle_308"), 780), pistol = penetrator_of(gun("pistol_9mm"), 350);
  const auto behind = [](const Penetrator& p, const std::vector<Layer>& layers) {
    const auto passages = penetrate(p, layers).value();
    return passages.size() == layers.size() ? passages.back().speed_out : 0;
  };
  EXPECT_GT(behind(rifle, wall("timber")), behind(pistol, wall("timber")));
  EXPECT_GT(behind(rifle, wall("car_door")), 500);
  EXPECT_GT(behind(pistol, wall("car_door")), 0);
  EXPECT_EQ(behind(pistol, wall("steel_plate")), 0);
  EXPECT_EQ(behind(rifle, wall("sandbags")), 0);
}

TEST(WeaponPresets, ErrorsNameTheirPlace) {
  const auto message = [](const auto& result) { return result.ok() ? std::string("none") : result.error().message; };
  EXPECT_EQ(message(scene::parse_ammunition(R"({"values": {"mass": "10 g"}})", "a.json")),
            "a.json:1: values.diameter: is missing");
  EXPECT_NE(
      message(scene::parse_ammunition(
                  R"({"values": {"mass": "10 g", "diameter": "8 mm", "muzzle_speed": "800 m", "drag_function": "g7"}})",
                  "a.json"))
          .find("a.json:1: values.muzzle_speed"),
      std::string::npos);
  EXPECT_NE(
      message(
          scene::parse_ammunition(
              R"({"values": {"mass": "10 g", "diameter": "8 mm", "muzzle_speed": "800 m/s", "drag_function": "g9"}})",
              "a.json"))
          .find("found \"g9\", expected g1, g2"),
      std::string::npos);
  EXPECT_EQ(
      message(scene::parse_ammunition(
          R"({"values": {"mass": "-10 g", "diameter": "8 mm", "muzzle_speed": "800 m/s", "drag_function": "g7", "ballistic_coefficient": 0.2}})",
          "a.json")),
      "a.json: ammunition: mass is -0.01, expected 10^-6 to 10^5 kg");
  EXPECT_NE(
      message(scene::parse_sight(R"({"values": {"click": "0 rad"}})", "s.json")).find("s.json: a sight: click is 0"),
      std::string::npos);
  EXPECT_NE(message(scene::parse_gun(R"({"values": {"ammunition": "../secret"}})", "g.json", read_source))
                .find("expected the name of a preset"),
            std::string::npos);
  EXPECT_NE(
      message(scene::parse_gun(R"({"values": {"ammunition": "none_such"}})", "g.json", read_source)).find("no file"),
      std::string::npos);
  EXPECT_NE(message(scene::parse_wall(R"({"values": []})", "w.json")).find("expected 1 to 100 layers"),
            std::string::npos);
  EXPECT_NE(message(scene::parse_wall(R"({"values": [{"thickness": "-1 mm"}]})", "w.json")).find("thickness is -0.001"),
            std::string::npos);
}

}  // namespace weapon_presets_test
