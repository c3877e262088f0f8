// Guns, ammunition, sights and walls as files: what follows from them is the reference's, errors name the place.
#include "carom/scene/weapon_presets.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "carom/scene/destruction.h"
#include "carom/scene/scene.h"
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
      if (k == "ammunition") told(scene::parse_ammunition(text, path, read_source));
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

// Shells: a table in the library, files, and both the same numbers. The howitzer flies its shell by the same drag: with
// charge 6 to the reference's point mass at 258.4 mil.
TEST(WeaponPresets, ShellsAreTheLibrarysNumbers) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(CAROM_SOURCE_DIR) + "/presets/shell"))
    files += entry.path().extension() == ".json";
  EXPECT_EQ(files, shell_presets().size());
  for (const ShellPreset& preset : shell_presets()) {
    const std::string path = "presets/shell/" + std::string(preset.name) + ".json";
    const std::string text = read_source(path).value();
    EXPECT_NE(text.find(preset.source), std::string::npos);
    const auto shell = scene::parse_shell(text, path);
    ASSERT_TRUE(shell) << shell.error().message;
    EXPECT_EQ(shell->mass, preset.shell.mass);
    EXPECT_EQ(shell->diameter, preset.shell.diameter);
    EXPECT_EQ(shell->axial_inertia, preset.shell.axial_inertia);
    EXPECT_EQ(shell->transverse_inertia, preset.shell.transverse_inertia);
    EXPECT_EQ(shell->twist, preset.shell.twist);
    EXPECT_NEAR(shell->length, preset.shell.length, 1e-12);
    EXPECT_NEAR(shell->centre, preset.shell.centre, 1e-12);
    ASSERT_EQ(shell->aerodynamics.size(), preset.shell.aerodynamics.size());
    for (std::size_t i = 0; i < shell->aerodynamics.size(); ++i) {
      const ShellCoefficients &a = shell->aerodynamics[i], &b = preset.shell.aerodynamics[i];
      EXPECT_EQ(a.mach, b.mach);
      EXPECT_EQ(a.axial, b.axial);
      EXPECT_EQ(a.axial_yaw, b.axial_yaw);
      EXPECT_EQ(a.normal, b.normal);
      EXPECT_EQ(a.magnus_force, b.magnus_force);
      EXPECT_EQ(a.roll_damping, b.roll_damping);
      EXPECT_EQ(a.overturning, b.overturning);
      EXPECT_EQ(a.pitch_damping, b.pitch_damping);
      EXPECT_EQ(a.magnus_moment, b.magnus_moment);
    }
  }
  const Weapon howitzer = gun("howitzer_155mm");
  EXPECT_EQ(howitzer.ammunition.muzzle_speed, 474);
  const auto flight = fly(gun_of(howitzer).projectile, {}, {{}, 474 * direction(258.4 * 2 * math::pi / 6400)},
                          {.time = 60, .ground = 0});
  ASSERT_TRUE(flight);
  EXPECT_NEAR(flight->end().position.x, 7036.0, .004 * 7036) << "smooth between the rows, and uniform gravity";
  const auto error = [](std::string_view text) {
    const auto shell = scene::parse_shell(text, "s.json");
    return shell ? std::string() : shell.error().message;
  };
  EXPECT_NE(error(R"({"values": {"mass": "4 kg"}})").find("values.diameter: is missing"), std::string::npos);
  EXPECT_NE(error(R"({"values": {"weight": "4 kg"}})").find("values.weight: found a name"), std::string::npos);
  const std::string whole =
      R"("mass": "4 kg", "diameter": "9 cm", "axial_inertia": "1 kg*m^2", "transverse_inertia": "1 kg*m^2", "twist": 20)";
  EXPECT_NE(error("{\"values\": {" + whole + "}}").find("values.aerodynamics: expected a list"), std::string::npos);
  EXPECT_NE(error("{\"values\": {" + whole + R"(, "aerodynamics": [{"mach": 0}]}})").find("row 1: overturning"),
            std::string::npos);
  EXPECT_NE(error("{\"values\": {" + whole + R"(, "aerodynamics": [{"mach": 0, "drag": 1}]}})")
                .find("values.aerodynamics[0].drag"),
            std::string::npos);
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

// Drag by a table of one's own and by several coefficients, in a preset and in a scene.
TEST(WeaponPresets, DragOfOnesOwn) {
  const std::string size = R"("mass": "10.89 g", "diameter": "7.82 mm", "muzzle_speed": "808 m/s")";
  const std::string table = size + R"(, "drag_table": [0, 0.14, 1, 0.43, 2, 0.35])",
                    bands = size + R"(, "drag_function": "g1", "ballistic_coefficients": [0, 0.405, 1.8, 0.462])";
  for (const std::string& text : {table, bands}) {
    const auto round = scene::parse_ammunition("{\"values\": {" + text + "}}", "a.json");
    ASSERT_TRUE(round) << round.error().message;
    const auto read =
        scene::parse_scene(R"({"guns": [{"name": "g", "ammunition": {)" + text + "}}]}", "s", read_source);
    ASSERT_TRUE(read.ok()) << read.error().message;
    const auto world = read->instantiate();
    ASSERT_TRUE(world.ok()) << world.error().message;
    const ballistics::Projectile& here =
        world->destruction->space.guns[0].thing.definition.weapon.ammunition.projectile;
    EXPECT_EQ(here.area_per_mass, round->projectile.area_per_mass);
    for (const double mach : {0.5, 1.0, 1.5, 2.5}) EXPECT_EQ(here.drag(mach), round->projectile.drag(mach)) << mach;
    if (text == table) EXPECT_DOUBLE_EQ(here.drag(1), 0.43);
    if (text == bands) EXPECT_GT(here.drag(1) / here.drag(2.5), 1.1 * 0.4805 / 0.5397);
  }
  const auto message = [&](const std::string& more) {
    const auto round = scene::parse_ammunition("{\"values\": {" + size + more + "}}", "a.json");
    return round.ok() ? std::string() : round.error().message;
  };
  EXPECT_EQ(message(R"(, "drag_table": [0, 0.1, 1])"),
            "a.json:1: values.drag_table: expected pairs, one after another");
  EXPECT_EQ(message(R"(, "drag_table": [0, 0.1, 0, 0.2])"),
            "a.json:1: values: drag_table: node 2 of a drag curve: Mach number is 0, expected more than the 0 before");
  EXPECT_EQ(
      message(R"(, "drag_coefficient": 0.3, "ballistic_coefficients": [0, 0.4])"),
      "a.json:1: values: expected drag_function or drag_table beside a ballistic_coefficient, not drag_coefficient");
  EXPECT_EQ(message(""), "a.json:1: values: expected one of drag_function, drag_coefficient and drag_table");
}

// A drag table and a motor of one's own lie beside the scene; the project's are named without an extension.
TEST(WeaponPresets, FilesBesideTheScene) {
  const std::string radar = "CFM, mine, 0.01089, 0.00782\n0.14 0\n0.43 1\n0.35 2\n";
  const std::string motor = "M1 18 70 0 0.01 0.02 me\n 0.1 10\n 1 8\n 1.2 0\n";
  const auto files = [&](std::string_view path) -> core::Result<std::string> {
    if (path == "ranges/data/mine.drg") return radar;
    if (path == "ranges/mine.eng") return motor;
    if (path.starts_with("ranges/")) return core::Error{"no file " + std::string(path)};
    return read_source(path);
  };
  const auto load = [&](const std::string& table, const std::string& engine) -> core::Result<scene::SceneWorld> {
    const std::string text =
        R"({"guns": [{"name": "g", "ammunition": {"mass": "10.89 g", "diameter": "7.82 mm", "muzzle_speed": 800, "drag_table": )" +
        table +
        R"(}}], "rockets": [{"name": "r", "diameter": "3 cm", "length": "50 cm", "stages": [{"dry_mass": "40 g", "motor": )" +
        engine + "}]}]}";
    // What is named beside a scene lies beside the file that names it, here an included one.
    const auto with_part = [&](std::string_view path) -> core::Result<std::string> {
      if (path == "ranges/part.json") return text;
      return files(path);
    };
    const auto read = scene::parse_scene(R"({"include": ["ranges/part.json"]})", "s.json", with_part);
    if (!read) return read.error();
    return read->instantiate();
  };
  const auto own = load(R"("data/mine.drg")", R"("mine.eng")");
  ASSERT_TRUE(own.ok()) << own.error().message;
  EXPECT_DOUBLE_EQ(own->destruction->space.guns[0].thing.definition.weapon.ammunition.projectile.drag(1), 0.43);
  const auto ours = load(R"("308_168_smk")", R"("black_powder")");
  ASSERT_TRUE(ours.ok()) << ours.error().message;
  EXPECT_EQ(ours->destruction->space.guns[0].thing.definition.weapon.ammunition.projectile.drag(1.4), 0.41);
  const auto message = [&](const std::string& table, const std::string& engine) {
    const auto world = load(table, engine);
    return world.ok() ? std::string("none") : world.error().message;
  };
  const std::string at = "ranges/part.json:1: ";
  EXPECT_EQ(message(R"("none.drg")", R"("mine.eng")"), at + "drag_table: no file ranges/none.drg");
  EXPECT_EQ(message(R"("../mine.drg")", R"("mine.eng")"),
            at +
                "drag_table: found \"../mine.drg\", expected the name of a file of presets/drag, or of one beside this "
                "scene, as \"my.txt\"");
  EXPECT_EQ(message(R"("data/mine.drg")", R"("data/mine.drg")").find(at + "motor: "), 0u) << "no thrust curve";
  EXPECT_NE(message("5", R"("mine.eng")").find("drag_table"), std::string::npos);
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
