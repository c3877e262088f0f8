// The effector "projectile" of a scene file: flies like the model, and says what is wrong with it.
#include <gtest/gtest.h>

#include <tuple>

#include "carom/ballistics/flight.h"
#include "carom/scene/scene.h"
#include "tests/scene/source_file.h"

namespace scene_projectile_test {
using namespace carom;
using math::Vec3d;

scene::Result<scene::Scene> parse(const std::string& effector, const char* preset = nullptr) {
  const std::string text = R"({"step": "1/240 s", "bodies": [{"name": "shot", "velocity": ["200 m/s", "100 m/s", 0],
      "shape": {"type": "sphere", "radius": "5 cm"}}], "effectors": [{"type": "projectile", "body": "shot", )" +
                           effector + "}]}";
  const scene::Resolver resolver = [&](std::string_view) -> scene::Result<std::string> {
    if (preset == nullptr) return core::Error{"no such preset"};
    return std::string(preset);
  };
  return scene::parse_scene(text, "shot.json", resolver);
}

TEST(SceneProjectile, FliesLikeTheModel) {
  const auto scene = parse(R"("drag_function": "gs", "mass": "4 kg", "diameter": "10 cm", "velocity": [0, 0, "8 m/s"],
                              "latitude": "45 deg", "bearing": "30 deg")");
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  auto world = scene->instantiate();
  ASSERT_TRUE(world.ok()) << world.error().message;
  const double degree = math::pi / 180;
  const ballistics::Conditions air{.wind = environment::WindColumn(Vec3d{0, 0, 8}),
                                   .rotation = ballistics::earth_rotation_rate(45 * degree, 30 * degree)};
  const auto path =
      ballistics::fly(ballistics::projectile_from_size(ballistics::DragCurve(ballistics::DragFunction::gs), 4, .1), air,
                      {{}, {200, 100, 0}}, {.time = 5});
  for (int i = 0; i < 1200; ++i) ASSERT_TRUE(world->step().ok());
  const Vec3d off = world->world3->state(world->bodies[0].id)->center_of_mass - path->end().position;
  EXPECT_LT(math::length(off), .01);
}

TEST(SceneProjectile, PresetsGiveTheDrag) {
  const auto scene = parse(R"("preset": "projectile/any")", R"({"description": "a bullet", "source": "nobody",
      "values": {"drag_function": "g7", "ballistic_coefficient": 0.2}})");
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  auto world = scene->instantiate();
  for (int i = 0; i < 240; ++i) ASSERT_TRUE(world->step().ok());
  EXPECT_LT(world->world3->state(world->bodies[0].id)->center_of_mass.x, 195);
}

// A measured curve, as a preset and as a text file, is one projectile.
TEST(SceneProjectile, FliesByAMeasuredTable) {
  const auto read = [](const std::string& name) { return scene::test::read_source("presets/" + name).value(); };
  for (const auto& [name, mass, diameter] :
       {std::tuple{"308_168_smk", .01089, .00782}, std::tuple{"120mm_mortar", 13.585, .11956}}) {
    const std::string file = std::string(name) + (mass < 1 ? "_measured" : "");
    const std::string preset = read("projectile/" + file + ".json");
    const auto scene = parse(R"("preset": "projectile/any", "density": 1.225)", preset.c_str());
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    auto world = scene->instantiate();
    ASSERT_TRUE(world.ok()) << world.error().message;
    const auto curve = ballistics::read_drag_table(read("drag/" + std::string(name) + ".txt"), name);
    ASSERT_TRUE(curve) << curve.error().message;
    const auto path =
        ballistics::fly(ballistics::projectile_from_size(*curve, mass, diameter),
                        {.air = environment::AirColumn::uniform(1.225)}, {{}, {200, 100, 0}}, {.time = 4});
    for (int i = 0; i < 960; ++i) ASSERT_TRUE(world->step().ok());
    const math::Vec3d off = world->world3->state(world->bodies[0].id)->center_of_mass - path->end().position;
    EXPECT_LT(math::length(off), .02) << name;
  }
}

TEST(SceneProjectile, SaysWhatIsWrong) {
  const auto complains = [](const std::string& effector, const char* of) {
    const auto scene = parse(effector);
    EXPECT_FALSE(scene.ok()) << effector;
    if (!scene.ok()) EXPECT_NE(scene.error().message.find(of), std::string::npos) << scene.error().message;
  };
  complains(R"("ballistic_coefficient": 0.3)", "drag_function");
  complains(R"("drag_function": "g9", "ballistic_coefficient": 0.3)", "g7");
  complains(R"("drag_function": "g7", "ballistic_coefficient": -1)", "ballistic_coefficient");
  complains(R"("drag_function": "g7")", "\"diameter\" and a \"mass\"");
  complains(R"("diameter": "5 kg", "mass": "1 kg")", "diameter");
  complains(R"("diameter": "5 cm", "mass": "1 kg", "form_factor": 0)", "form_factor");
  complains(R"("diameter": "5 cm", "mass": "1 kg", "table": [0, 0.2, 1])", "pairs of Mach number and C_d");
  complains(R"("diameter": "5 cm", "mass": "1 kg", "table": [])", "pairs of Mach number and C_d");
  complains(R"("diameter": "5 cm", "mass": "1 kg", "table": [0, 0.2, 1, 0.5, 0.9, 0.4])",
            "node 3 of a drag curve: Mach number is 0.9, expected more than the 1 before");
  complains(R"("diameter": "5 cm", "mass": "1 kg", "table": [0, -0.2])", "table");
  complains(R"("diameter": "5 cm", "mass": "1 kg", "drag_function": "g1", "table": [0, 0.2])", "one of \"table\"");
}

}  // namespace scene_projectile_test
