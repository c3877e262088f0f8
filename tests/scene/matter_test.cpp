// Ropes, cloth, soft bodies, liquids, grains and particles of scene files: every preset, what they give, what is wrong.
#include "carom/scene/matter.h"

#include <dirent.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "carom/scene/scene.h"
#include "tests/scene/scene_world.h"
#include "tests/scene/source_file.h"

namespace scene_matter_test {
using namespace carom;
using scene::Scene;
using scene::SceneWorld;
using scene::test::read;
using scene::test::read_source;

std::string presets_folder() { return std::string(CAROM_SOURCE_DIR) + "/presets/"; }
scene::Result<Scene> parse(const std::string& text) { return scene::parse_scene(text, "matter.json", read_source); }
SceneWorld start(const std::string& text) { return scene::test::started(parse(text)); }

struct Kind {
  const char *folder, *list, *rest;
};
constexpr Kind kinds[] = {
    {"rope", "ropes", R"("points": [[0, 0, 0], [2, 0, 0]], "attachments": [{"node": 0}])"},
    {"fabric", "cloths",
     R"("corner": [0, 0, 0], "along": [1, 0, 0], "across": [0, 0, 1], "columns": 8, "rows": 8, "pins": [{"vertex": 0}])"},
    {"soft", "soft_bodies", R"("center": [0, 0, 0], "radius": 0.2, "cells": 4)"},
    {"liquid", "liquids",
     R"("lower": [0, 0, 0], "upper": [1, 1, 1], "spacing": 0.1, "fill": [{"lower": [0, 0, 0], "upper": [0.5, 0.5, 0.5]}])"},
    {"grains", "grains",
     R"("lower": [0, 0, 0], "upper": [1, 1, 1], "radius": 0.05, "fill": [{"lower": [0, 0, 0], "upper": [0.5, 0.5, 0.5]}])"},
    {"particles", "particles", R"("emitters": [{"rate": 100, "spread": 0.5}])"},
};

TEST(SceneMatter, EveryPresetMakesAThingThatMoves) {
  int found = 0;
  for (const Kind& kind : kinds) {
    DIR* folder = opendir((presets_folder() + kind.folder).c_str());
    ASSERT_NE(folder, nullptr) << kind.folder;
    std::vector<std::string> names;
    while (const dirent* entry = readdir(folder))
      if (const std::string name = entry->d_name; name.size() > 5 && name.ends_with(".json"))
        names.push_back(name.substr(0, name.size() - 5));
    closedir(folder);
    std::sort(names.begin(), names.end());
    for (const std::string& name : names) {
      SCOPED_TRACE(std::string(kind.folder) + "/" + name);
      SceneWorld world = start("{\"" + std::string(kind.list) + "\": [{\"name\": \"it\", \"preset\": \"" + kind.folder +
                               "/" + name + "\", " + kind.rest + "}]}");
      ASSERT_NE(world.matter, nullptr);
      const std::uint64_t before = world.state_hash();
      for (int i = 0; i < 5; ++i) ASSERT_TRUE(world.step().ok());
      EXPECT_NE(world.state_hash(), before);
      ++found;
    }
  }
  EXPECT_GE(found, 25);
}

TEST(SceneMatter, ASteelCableIsAsHeavyAndAsLongAsItsPresetSays) {
  SceneWorld world = start(R"({"gravity": [0, 0, 0], "ropes": [{"name": "c", "preset": "rope/steel_6x19_12mm",
      "points": [[0, 0, 0], [10, 0, 0]]}]})");
  EXPECT_NEAR(read(world, "rope.c.mass"), 4.98, 1e-9);
  EXPECT_NEAR(read(world, "rope.c.length"), 10, 1e-9);
  EXPECT_EQ(read(world, "rope.c.count"), 21);
}

TEST(SceneMatter, ARopeHoldsABodyWhereItsAnchorIs) {
  // The anchor is a place of the world; the body hangs straight below it in the end.
  SceneWorld world = start(R"({"bodies": [{"name": "load", "position": [0, -2, 0], "rotation": {"yaw": "90 deg"},
      "angular_damping": 2, "linear_damping": 1, "shape": {"type": "box", "size": [1, 1, 1], "mass": 50}}],
      "ropes": [{"name": "r", "points": [[0.5, 1, 0], [0.5, -1.5, 0]], "collide": false,
                 "attachments": [{"node": 0}, {"anchor": [0.5, -1.5, 0], "body": "load"}]}]})");
  for (int i = 0; i < 600; ++i) ASSERT_TRUE(world.step().ok());
  EXPECT_NEAR(read(world, "rope.r.tension"), 50.25 * 9.80665, 2);
  EXPECT_NEAR(read(world, "load.position.x"), .5, 5e-3);
}

TEST(SceneMatter, ClothFeelsTheWindOfTheEnvironment) {
  const auto swept = [](const char* wind) {
    SceneWorld world = start(std::string(R"({"gravity": [0, 0, 0], "environment": {"wind": {"velocity": )") + wind +
                             R"(}}, "cloths": [{"name": "c", "corner": [0, 0, 0], "along": [0, 0, 1],
                                "across": [0, 1, 0], "columns": 9, "rows": 9, "mass_per_area": "100 g/m^2"}]})");
    for (int i = 0; i < 6; ++i) EXPECT_TRUE(world.step().ok());
    return read(world, "cloth.c.center.x");
  };
  EXPECT_EQ(swept("[0, 0, 0]"), 0);
  // ½ ρ C v² A over m is 59 m/s² at 4 … 10 m/s: in 0.1 s about a quarter of a metre at most.
  const double found = swept("[9, 0, 0]");
  EXPECT_GT(found, .15);
  EXPECT_LT(found, .5 * 1.225 * 1.2 * 81 / .1 * .5 * .1 * .1);
}

TEST(SceneMatter, PinsByEdgeBoxPlaceAndNumber) {
  SceneWorld world = start(R"({"cloths": [{"name": "c", "corner": [0, 0, 0], "along": [1, 0, 0], "across": [0, 0, 1],
      "columns": 11, "rows": 6, "pins": [{"edge": "first_row"}, {"vertex": 65}, {"near": [0, 0, 1.1]},
      {"lower": [0.45, -1, 0.35], "upper": [0.55, 1, 0.45]}]}]})");
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(world.step().ok());
  const auto p = world.matter->cloths[0].thing.positions();
  for (int v = 0; v < 11; ++v) EXPECT_NEAR(p[v].y, 0, 1e-6) << v;
  EXPECT_NEAR(p[65].y, 0, 1e-6);
  EXPECT_NEAR(p[55].y, 0, 1e-6);
  EXPECT_NEAR(p[27].y, 0, 1e-6);
  EXPECT_LT(p[60].y, -.01);
}

TEST(SceneMatter, DropsSplashIntoAnotherSystem) {
  SceneWorld world =
      start(R"({"bodies": [{"name": "g", "type": "fixed", "shape": {"type": "plane", "normal": [0, 1, 0]}}],
      "particles": [{"name": "rain", "answer": "kill", "emitters": [{"position": [0, 1, 0], "burst": 10, "spread": 0.3,
          "direction": [0, -1, 0], "speed": 5, "lifetime": 9}],
        "sub_emissions": [{"on": "hit", "into": "splash", "count": 3, "emitter": {"speed": 1, "spread": 1, "lifetime": 9}}]},
      {"name": "splash"}]})");
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(world.step().ok());
  EXPECT_EQ(read(world, "particles.rain.count"), 0);
  EXPECT_EQ(read(world, "particles.splash.count"), 30);
}

// No momentum between them and the energy that was asked for, whatever the seed: chapters 2.7 and 18.7.
TEST(SceneMatter, BurstsKeepTheirBudget) {
  for (const int dimension : {2, 3})
    for (const char* how :
         {R"("energy": "90 J")", R"("energy": "90 J", "equal_speeds": false)", R"("speed": "6 m/s")"}) {
      const std::string zero = dimension == 2 ? "[0, 0]" : "[0, 0, 0]", drift = dimension == 2 ? "[3, 1]" : "[3, 1, 2]";
      SceneWorld world = start("{\"dimension\": " + std::to_string(dimension) + R"(, "gravity": )" + zero +
                               R"(, "particles": [{"name": "fire", "mass": "5 g", "drag": "none",
          "bursts": [{"time": "50 ms", "count": 1001, "velocity": )" +
                               drift + R"(, "seed": 9, )" + how + "}]}]}");
      for (int i = 0; i < 2; ++i) ASSERT_TRUE(world.step().ok());
      EXPECT_EQ(read(world, "particles.fire.count"), 0);
      for (int i = 0; i < 11; ++i) ASSERT_TRUE(world.step().ok());
      const auto& matter = *world.matter;
      const particles::ParticleSystem& system =
          dimension == 2 ? matter.plane.particles[0].thing.system : matter.space.particles[0].thing.system;
      ASSERT_EQ(system.size(), 1001);
      math::Vec3d sum{};
      double energy = 0;
      const math::Vec3d centre{3, 1, dimension == 2 ? 0.0 : 2.0};
      for (int i = 0; i < system.size(); ++i) {
        const math::Vec3d v{double(system.array(3)[i]), double(system.array(4)[i]), double(system.array(5)[i])};
        sum += v - centre;
        energy += 0.5 * 0.005 * math::length_squared(v - centre);
      }
      EXPECT_LT(math::length(sum) / 1001, 1e-6);
      EXPECT_NEAR(energy, 90.09, 0.1);  // of 6 m/s each; of 90 J within rounding and that
    }
  const auto wrong = parse(R"({"particles": [{"bursts": [{"energy": "1 J", "speed": 3}]}]})");
  ASSERT_FALSE(wrong.ok() && wrong->instantiate().ok());
}

TEST(SceneMatter, ThePlaneHasLiquidsGrainsAndParticles) {
  SceneWorld world = start(R"({"dimension": 2,
      "liquids": [{"name": "w", "lower": [0, 0], "upper": [2, 1], "spacing": 0.05, "walls": ["lower_x", "lower_y", "upper_x"],
                   "fill": [{"lower": [0, 0], "upper": [1, 0.5]}], "taps": [{"center": [1.5, 0.8], "velocity": [0, -1], "radius": 0.1}],
                   "drains": [{"lower": [1.9, 0], "upper": [2, 0.1]}]}],
      "grains": [{"name": "s", "lower": [3, 0], "upper": [4, 1], "diameter": "5 cm", "fill": [{"lower": [3, 0], "upper": [3.5, 0.5]}]}],
      "particles": [{"name": "p", "attractors": [{"center": [0, 3], "strength": -5}],
                     "emitters": [{"form": "segment", "radius": 0.5, "position": [0, 2], "rotation": "30 deg", "rate": 200}]}]})");
  const double area = read(world, "liquid.w.volume");
  EXPECT_NEAR(area, .5, .01);
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(world.step().ok());
  EXPECT_GT(read(world, "liquid.w.volume"), area + .05) << "a tap of .2 m at 1 m/s for 1 s, and a drain";
  EXPECT_NEAR(read(world, "grains.s.count"), 100, 1);
  EXPECT_NEAR(read(world, "particles.p.count"), 200, 1);
}

TEST(SceneMatter, TheSameFileGivesTheSameBits) {
  const char* text = R"({"liquids": [{"lower": [0, 0, 0], "upper": [1, 1, 1], "spacing": 0.1,
      "fill": [{"lower": [0, 0, 0], "upper": [0.5, 0.7, 1]}]}], "particles": [{"turbulence_speed": 1,
      "emitters": [{"rate": 500, "spread": 3}]}]})";
  SceneWorld a = start(text), b = start(text);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(a.step().ok() && b.step().ok());
  EXPECT_EQ(a.state_hash(), b.state_hash());
}

// An emitter's mesh from a file is the one that is written out.
TEST(SceneMatter, EmittersReadMeshFiles) {
  const auto emits = [](const std::string& mesh) {
    const scene::Resolver files = [](std::string_view path) -> scene::Result<std::string> {
      if (path != "tetra.obj") return core::Error{"no such file"};
      return std::string("v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    };
    return scene::parse_scene(
        R"({"particles": [{"name": "p", "emitters": [{"form": "mesh", "burst": 500, "along_normal": true, "speed": 1, )" +
            mesh + "}]}]}",
        "t", files);
  };
  SceneWorld file = scene::test::started(emits(R"("file": "tetra.obj")")),
             inline_mesh = scene::test::started(
                 emits(R"("vertices": [[0,0,0],[2,0,0],[0,2,0],[0,0,2]], "indices": [0,2,1, 0,1,3, 0,3,2, 1,2,3])"));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(file.step().ok() && inline_mesh.step().ok());
  EXPECT_EQ(read(file, "particles.p.count"), 500);
  EXPECT_EQ(file.state_hash(), inline_mesh.state_hash());
  EXPECT_FALSE(emits(R"("file": "none.obj")").ok());
  EXPECT_FALSE(emits(R"("file": "tetra.obj", "vertices": [])").ok());
}

TEST(SceneMatter, GroupsRepeatRopesWithNames) {
  SceneWorld world = start(R"({"bodies": [{"repeat": {"i": 3},
      "ropes": [{"name": "r{i}", "points": [["=i", 0, 0], ["=i", -1, 0]], "attachments": [{"node": 0}]}]}]})");
  EXPECT_EQ(world.matter->ropes.size(), 3u);
  EXPECT_NEAR(read(world, "rope.r2.center.x"), 2, 1e-12);
}

TEST(SceneMatter, SaysWhatIsWrong) {
  const auto complains = [](const std::string& text, const char* of) {
    const auto scene = parse(text);
    EXPECT_FALSE(scene.ok()) << text;
    if (!scene.ok()) EXPECT_NE(scene.error().message.find(of), std::string::npos) << scene.error().message;
  };
  const auto rope = [&](const char* keys, const char* of) {
    complains(std::string(R"({"ropes": [{"points": [[0, 0, 0], [1, 0, 0]], )") + keys + "}]}", of);
  };
  complains(R"({"ropes": [{"segments": 5}]})", "\"points\" is missing");
  complains(R"({"dimension": 2, "ropes": []})", "dimension 3");
  rope(R"("mass_per_length": "5 kg")", "a mass per length");
  rope(R"("axial_stiffness": -3)", "axial_stiffness");
  rope(R"("diameter": 1, "radius": 2)", "both radius and diameter");
  rope(R"("attachments": [{"clamped": true}])", "\"node\", an \"anchor\"");
  rope(R"("attachments": [{"node": 3, "body": "hook"}])", "the name of a body");
  rope(R"("attachments": [{"node": 99}])", "whole number from -1 to 20");
  rope(R"("substeps": 900)", "1 to 256");
  rope(R"("prest": "x")", "did you mean");
  complains(R"({"ropes": [{"name": "a", "points": [[0,0,0],[1,0,0]]}, {"name": "a", "points": [[0,0,0],[1,0,0]]}]})",
            "a second time");
  complains(R"({"cloths": [{}]})", "\"corner\"");
  complains(R"({"cloths": [{"corner": [0,0,0], "along": [1,0,0], "across": [2,0,0]}]})", "cloths[0]");
  complains(R"({"cloths": [{"points": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [0, 1, 7]}]})", "cloths[0]");
  complains(
      R"({"cloths": [{"points": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [0, 1, 2], "pins": [{"edge": "first_row"}]}]})",
      "only a sheet");
  complains(R"({"soft_bodies": [{"corner": [0,0,0], "size": [1,1,1], "cells": 4}]})", "three numbers for a box");
  complains(R"({"soft_bodies": [{"center": [0,0,0], "radius": 1, "poisson_ratio": 0.5}]})", "poisson");
  complains(R"({"liquids": [{"lower": [0,0,0], "upper": [1,1,1], "spacing": 0}]})", "spacing");
  complains(R"({"liquids": [{"lower": [0,0,0], "upper": [1e4,1e4,1e4], "spacing": 0.01}]})", "more points or cells");
  complains(R"({"liquids": [{"lower": [0,0,0], "upper": [1,1,1], "walls": ["left"]}]})", "lower_x");
  complains(R"({"liquids": [{"lower": [0,0,0], "upper": [1,1,1], "maximum_particles": 5,
               "fill": [{"lower": [0,0,0], "upper": [1,1,1]}]}]})",
            "fill[0]");
  complains(R"({"grains": [{"lower": [0,0,0], "upper": [1,1,1], "fill": [{"center": [0,0,0]}]}]})",
            "\"lower\" and \"upper\"");
  complains(R"({"particles": [{"emitters": [{"speed": [5, 1]}]}]})", "emitters[0]");
  complains(R"({"particles": [{"emitters": [{"direction": [0, 0, 0]}]}]})", "not zero");
  complains(R"({"particles": [{"sub_emissions": [{"on": "hit", "into": "splsh"}]}, {"name": "splash"}]})",
            "did you mean");
  complains(R"({"particles": [{"color_over_age": [[0, "red"]]}]})", "a color such as");
  complains(R"({"particles": [{"mass": 1, "density": 1}]})", "both mass and density");
  complains(
      R"({"particles": [{"name": "p"}], "plots": [{"title": "x", "series": [{"name": "n", "quantity": "particles.p.tension"}]}]})",
      "particles.p.tension");
}

}  // namespace scene_matter_test
