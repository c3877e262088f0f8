// Explosions, guns and structures of scene files: what they do, every preset of theirs, what is wrong.
#include "carom/scene/destruction.h"

#include <dirent.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "carom/scene/scene.h"
#include "carom/scene/write_scene.h"
#include "tests/scene/scene_world.h"
#include "tests/scene/source_file.h"

namespace scene_destruction_test {
using namespace carom;
using scene::ParameterValue;
using scene::Scene;
using scene::SceneWorld;
using scene::test::read;
using scene::test::read_source;

/// A tetrahedron of edge √2 m with its corners counterclockwise seen from outside.
constexpr const char* tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
scene::Result<Scene> parse(const std::string& text) {
  const scene::Resolver resolver = [](std::string_view path) -> scene::Result<std::string> {
    if (path == "solid.obj") return std::string(tetrahedron);
    if (path == "open.obj") return std::string(tetrahedron).substr(0, std::string(tetrahedron).rfind("f 2"));
    return read_source(path);
  };
  return scene::parse_scene(text, "s.json", resolver);
}
SceneWorld start(const std::string& text, std::vector<ParameterValue> values = {}) {
  return scene::test::started(parse(text), values);
}
void run(SceneWorld& world, double seconds) {
  while (world.time() < seconds - 1e-9) ASSERT_TRUE(world.step().ok());
}
std::string message(const std::string& keys, int dimension = 3) {
  const auto s = parse("{\"dimension\": " + std::to_string(dimension) + ", " + keys + "}");
  return s.ok() ? std::string("none") : s.error().message;
}
std::vector<std::string> presets(const char* kind) {
  std::vector<std::string> names;
  DIR* folder = opendir((std::string(CAROM_SOURCE_DIR) + "/presets/" + kind).c_str());
  while (const dirent* entry = folder != nullptr ? readdir(folder) : nullptr)
    if (const std::string name = entry->d_name; name.size() > 5 && name.ends_with(".json"))
      names.push_back(name.substr(0, name.size() - 5));
  if (folder != nullptr) closedir(folder);
  std::sort(names.begin(), names.end());
  return names;
}

std::string charged(const std::string& charge, int dimension) {
  const bool plane = dimension == 2;
  return std::string("{\"dimension\": ") + (plane ? "2" : "3") + ", \"gravity\": " + (plane ? "[0, 0]" : "[0, 0, 0]") +
         R"(, "parameters": {"charge": {"value": "8 kg", "minimum": "1 kg", "maximum": "20 kg"}},
      "bodies": [{"name": "box", "position": )" +
         (plane ? R"(["6 m", "0.5 m"])" : R"(["6 m", "0.5 m", 0])") +
         R"(, "mass": "100 kg", "shape": {"type": "box", "size": )" + (plane ? "[1, 1]" : "[1, 1, 1]") +
         R"(}}], "explosions": [{"name": "c", "position": )" + (plane ? "[0, 0]" : "[0, 0, 0]") + ", " + charge + "}]}";
}

TEST(SceneExplosions, PushWhenTheyGoOff) {
  for (const int dimension : {2, 3}) {
    const auto speed = [&](const char* charge, double seconds, std::vector<ParameterValue> values = {}) {
      SceneWorld world = start(charged(charge, dimension), values);
      run(world, seconds);
      return read(world, "box.velocity.x");
    };
    const double pushed = speed(R"("mass": "=charge")", 0.2);
    EXPECT_GT(pushed, 1);
    EXPECT_EQ(speed(R"("mass": "=charge", "time": "0.3 s")", 0.2), 0);
    EXPECT_NEAR(speed(R"("mass": "=charge", "time": "0.3 s")", 0.5), pushed, 0.02 * pushed);
    EXPECT_GT(speed(R"("mass": "=charge")", 0.2, {{"charge", 16}}), pushed);
    EXPECT_EQ(start(charged(R"("mass": "=charge", "if": 0)", dimension)).destruction, nullptr);
    SceneWorld world = start(charged(R"("mass": "=charge")", dimension));
    run(world, 0.5);
    EXPECT_EQ(read(world, "explosion.c.reached"), 1);
    EXPECT_NEAR(read(world, "explosion.c.impulse.x"), 100 * read(world, "box.velocity.x"), 1e-3 * 100 * pushed);
  }
}

TEST(SceneExplosions, AreWrittenAndGoOnWhereTheyWere) {
  SceneWorld world = start(charged(R"("mass": "2.7 kg", "time": "55 ms", "burst": "free_air", "casing": "box",
                                      "mask": "0x7", "shelter": 0.25, "clearing": false, "reach": "30 m")",
                                   3));
  run(world, 2.0 / 60);
  const auto text = scene::write_scene(world);
  ASSERT_TRUE(text.ok()) << text.error().message;
  SceneWorld copy = start(*text);
  const auto &a = world.destruction->space.explosions[0].thing.explosion.charge(),
             &b = copy.destruction->space.explosions[0].thing.explosion.charge();
  EXPECT_NEAR(b.time, a.time - world.time(), 1e-15);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.burst, b.burst);
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.shelter, b.shelter);
  EXPECT_EQ(a.clearing, b.clearing);
  EXPECT_EQ(a.reach, b.reach);
  EXPECT_EQ(world.find_body(a.casing)->name, copy.find_body(b.casing)->name);
}

// Charges with their case as files: each goes off, and throws as many fragments as it says with Gurney's speed: the
// grenade's 210 g of steel about .25 kg of TNT of filling √(2E)/√(M/C + 3/5).
TEST(SceneExplosions, EveryPresetGoesOff) {
  for (const std::string& name : presets("explosion")) {
    SceneWorld world = start(R"({"step": "1/480 s", "explosions": [{"name": "c", "preset": "explosion/)" + name +
                             R"(", "position": [0, 0.5, 0], "time": "1 ms"}]})");
    run(world, 0.9 / 480);
    const auto& casing = *world.destruction->space.explosions[0].thing.casing;
    EXPECT_EQ(read(world, "explosion.c.fragments"), casing.definition().fragments) << name;
    double fastest = 0;
    for (std::size_t i = 0; i < casing.batch().size(); ++i)
      fastest = math::max(fastest, length(casing.batch().at(i).velocity));
    EXPECT_GT(fastest, 800) << name;
    EXPECT_LT(fastest, 2400) << name;
  }
  EXPECT_GE(presets("explosion").size(), 2u);
}

// 240 g of steel about 160 g of TNT: 2440 m/s/√(1.5 + ⅗) = 1683.8 m/s at first. A board of 2 m × 2 m takes the share of
// the solid angle that it fills, 4 asin(a b/√((a² + d²)(b² + d²)))/4π, and what it is pushed with.
TEST(SceneExplosions, ACaseFliesApart) {
  const auto scene = [](const char* type, const char* drag) {
    return std::string(R"({"step": "1/480 s", "gravity": [0, 0, 0], "bodies": [
        {"name": "board", "type": ")") +
           type +
           R"(", "position": [3, 0, 0], "density": 7850, "shape": {"type": "box", "size": [0.2, 2, 2], "filter": {"category": 2}}},
        {"name": "grenade", "position": [0, 0, 0], "velocity": [0, 0, 0], "shape": {"type": "sphere", "radius": "3 cm", "filter": {"category": 2}}}],
        "explosions": [{"name": "c", "mass": "160 g", "burst": "free_air", "casing": "grenade", "mask": "0x4", "time": "1 ms",
          "case": {"mass": "240 g", "fragments": 4000, "drag_coefficient": )" +
           drag + R"(, "seed": 5}}]})";
  };
  SceneWorld still = start(scene("fixed", "0"));
  run(still, 0.9 / 480);
  EXPECT_EQ(read(still, "explosion.c.fragments") + read(still, "explosion.c.fragment_hits"), 4000);
  const auto& batch = still.destruction->space.explosions[0].thing.casing->batch();
  for (std::size_t i = 0; i < batch.size(); i += 100)
    EXPECT_NEAR(length(batch.at(i).velocity), 2440 / math::sqrt(1.5 + 0.6), 0.1);
  run(still, 0.02);
  const double share = 4 * math::asin(1 / (1 + 2.9 * 2.9)) / (4 * math::pi), expected = 4000 * share;
  EXPECT_NEAR(read(still, "explosion.c.fragment_hits"), expected, 3 * math::sqrt(expected));
  SceneWorld pushed = start(scene("dynamic", "0"));
  run(pushed, 0.02);
  const double momentum = read(pushed, "board.mass") * read(pushed, "board.velocity.x");
  EXPECT_GT(momentum, 0.8 * 0.24 * share * 1683.8);
  EXPECT_LT(momentum, 1.1 * 0.24 * share * 1683.8);
  // Air takes speed of the small ones first.
  SceneWorld slowed = start(scene("dynamic", "1.1"));
  run(slowed, 0.02);
  EXPECT_LT(read(slowed, "board.velocity.x"), read(pushed, "board.velocity.x"));
  // Until it goes off, it is written; then it is gone after its lifetime.
  const auto text = scene::write_scene(start(scene("fixed", "0")));
  ASSERT_TRUE(text.ok()) << text.error().message;
  EXPECT_EQ(start(*text).destruction->space.explosions[0].thing.casing->definition().fragments, 4000);
  run(still, 10.1);
  EXPECT_EQ(read(still, "explosion.c.fragments"), 0);
}

TEST(SceneExplosions, DriveParticlesAlong) {
  const auto thrown = [](const char* charges) {
    SceneWorld world = start(std::string(R"({"gravity": [0, 0, 0], "particles": [{"name": "dust", "radius": "1 mm",
        "density": "500 kg/m^3", "emitters": [{"burst": 100, "position": [4, 1, 0], "speed": 0, "lifetime": "10 s"}]}])") +
                             charges + "}");
    run(world, 0.1);
    EXPECT_EQ(read(world, "particles.dust.count"), 100);
    return read(world, "particles.dust.center.x");
  };
  EXPECT_NEAR(thrown(""), 4, 1e-3);
  EXPECT_GT(thrown(R"(, "explosions": [{"mass": "2 kg", "time": "20 ms"}])"), 4.2);
}

TEST(SceneExplosions, PushEverythingInReach) {
  const std::string things = R"({"gravity": [0, 0, 0], "step": "1/240 s",
    "cloths": [{"name": "sheet", "preset": "fabric/denim", "corner": [8, 0, 0], "along": [0, 1, 0], "across": [0, 0, 1], "columns": 5, "rows": 5, "collide": false}],
    "ropes": [{"name": "line", "preset": "rope/static_11mm", "points": [[0, 0, 8], [0, 2, 8]], "segments": 6, "collide": false}],
    "soft_bodies": [{"name": "block", "preset": "soft/gelatin", "corner": [-9, 0, 0], "size": [1, 1, 1], "cells": [3, 3, 3], "collide": false}],
    "liquids": [{"name": "water", "lower": [-1, 0, -10], "upper": [1, 2, -8], "spacing": "0.1 m",
                 "walls": [], "fill": [{"lower": [-0.5, 0, -9], "upper": [0.5, 1, -8]}]}])";
  const auto scene = parse(things + R"(, "explosions": [{"name": "c", "mass": "3 kg"}]})");
  if (!scene.ok()) GTEST_FAIL() << scene.error().message;
  SceneWorld world = start(things + R"(, "explosions": [{"name": "c", "mass": "3 kg"}]})");
  const char* names[] = {"cloth.sheet", "rope.line", "soft_body.block", "liquid.water"};
  const char axes[] = {'x', 'z', 'x', 'z'};
  double before[4];
  for (int i = 0; i < 4; ++i) before[i] = read(world, std::string(names[i]) + ".center." + axes[i]);
  run(world, 0.1);
  const double signs[] = {1, 1, -1, -1};
  for (int i = 0; i < 4; ++i)
    EXPECT_GT(signs[i] * (read(world, std::string(names[i]) + ".center." + axes[i]) - before[i]), 1e-3) << names[i];
}

// The peak under a burst in the air is that of its reflection square on, and it goes on in a written scene.
TEST(SceneExplosions, BurstInTheAir) {
  SceneWorld world = start(
      R"({"explosions": [{"name": "c", "mass": "10 kg", "position": [0, 7, 0], "burst": "air", "ground": "2 m"}]})");
  const auto& e = world.destruction->space.explosions[0].thing.explosion;
  const double expected = blast::ideal_reflected_pressure(e.wave_at(5).pressure);
  EXPECT_NEAR(e.pressure_at({0, 2, 0}, e.wave_at(5).arrival + 1e-9), expected, 1e-3 * expected);
  EXPECT_GT(e.stem_height(20), 0);
  const auto text = scene::write_scene(world);
  ASSERT_TRUE(text.ok()) << text.error().message;
  EXPECT_EQ(start(*text).destruction->space.explosions[0].thing.explosion.charge().ground, 2);
  EXPECT_NE(message(R"("explosions": [{"mass": 1, "burst": "air"}])").find("ground"), std::string::npos);
}

constexpr const char* range = R"({"step": "1/240 s",
  "bodies": [{"name": "plate", "type": "fixed", "position": ["=200 yd + 5 mm", 0, 0],
              "shape": {"type": "box", "size": ["1 cm", "2 m", "2 m"], "material": {"user_id": 4}}},
             {"name": "behind", "type": "fixed", "position": ["190 m", 0, 0], "shape": {"type": "box", "size": [1, 9, 9]}}],
  "guns": [{"name": "g", "preset": "gun/rifle_308", "dispersion": 0, "sighted": true,
            "ammunition": {"preset": "ammunition/308_168_smk", "speed_deviation": 0}}])";

TEST(SceneGuns, ASightedRifleHitsWhereTheFieldTablesSay) {
  // 168 SMK at 2650 ft/s, zero 100 yd, sights 1.5 in above the bore: 4.333 in low and 2247.55 ft/s at 200 yd.
  SceneWorld world = start(std::string(range) + "}");
  run(world, 0.3);
  EXPECT_EQ(read(world, "gun.g.shots"), 1);
  EXPECT_EQ(read(world, "gun.g.hits"), 1);
  EXPECT_EQ(read(world, "gun.g.in_flight"), 0);
  EXPECT_NEAR(read(world, "gun.g.last_hit.y"), (1.5 - 4.333) * 0.0254, 3e-3);
  EXPECT_NEAR(read(world, "gun.g.last_hit.x"), 200 * 0.9144, 1e-3);
  EXPECT_NEAR(read(world, "gun.g.hit_speed"), 2247.55 * 0.3048, 0.6);
}

TEST(SceneGuns, GoThroughWhatTheyMay) {
  SceneWorld world = start(std::string(range) + R"(, "penetration": [{"user_id": 4, "wall": [{"strength": "30 MPa",
      "inertia": "800 kg/m^3"}]}]})");
  run(world, 0.35);
  EXPECT_EQ(read(world, "gun.g.passed"), 1);
  EXPECT_EQ(read(world, "gun.g.hits"), 2);
  EXPECT_NEAR(read(world, "gun.g.last_hit.x"), 189.5, 1e-3);
  // Poncelet: v² after 1 cm.
  const double m = 168 * 64.79891e-6, area = math::pi / 4 * math::square(0.308 * 0.0254), v = 2247.55 * 0.3048;
  const double v2 = (v * v + 30e6 / 800) * math::exp(-2 * area * 800 * 0.01 / m) - 30e6 / 800;
  EXPECT_NEAR(read(world, "gun.g.hit_speed"), math::sqrt(v2), 8);  // and 6 m of air
}

TEST(SceneGuns, LeadAMovingTargetAndSayWhenItIsOutOfReach) {
  const auto scene = [](const char* where) {
    return std::string(
               R"({"step": "1/120 s", "bodies": [{"name": "t", "gravity_scale": 0, "mass": 1000, "velocity": [-8, 0, 5],
        "position": )") +
           where + R"(, "shape": {"type": "sphere", "radius": "0.3 m"}}],
        "guns": [{"name": "g", "target": "t", "rounds": 3, "rounds_per_minute": 60,
                  "ammunition": {"mass": 1, "diameter": "5 cm", "muzzle_speed": "120 m/s"}}]})";
  };
  SceneWorld near = start(scene("[200, 20, 30]"));
  run(near, 6);
  EXPECT_EQ(read(near, "gun.g.shots"), 3);
  EXPECT_EQ(read(near, "gun.g.hits"), 3);
  SceneWorld far = start(scene("[20000, 20, 30]"));
  run(far, 0.5);
  EXPECT_EQ(read(far, "gun.g.shots"), 0);
  EXPECT_TRUE(far.destruction->space.guns[0].thing.no_solution);
}

TEST(SceneGuns, RecoilIsTheImpulseOfBulletAndGas) {
  for (const char* dimension : {"2", "3"}) {
    const bool plane = dimension[0] == '2';
    SceneWorld world =
        start(std::string("{\"dimension\": ") + dimension + ", \"gravity\": " + (plane ? "[0, 0]" : "[0, 0, 0]") +
              R"(, "bodies": [{"name": "cart", "mass": 50,
        "shape": {"type": "box", "size": )" +
              (plane ? "[1, 1]" : "[1, 1, 1]") + R"(}}],
        "guns": [{"name": "g", "body": "cart", "position": )" +
              (plane ? "[1, 0]" : "[1, 0, 0]") + R"(,
                  "ammunition": {"mass": 0.5, "diameter": 0.05, "muzzle_speed": 400, "powder_mass": 0.1, "gas_speed": 1500}}]})");
    run(world, 1.0 / 60);
    EXPECT_NEAR(read(world, "cart.velocity.x"), -(0.5 * 400 + 0.1 * 1500) / 50, 1e-5);
    EXPECT_EQ(read(world, "gun.g.in_flight"), 1);
    run(world, 61);
    EXPECT_EQ(read(world, "gun.g.in_flight"), 0) << "a projectile is forgotten after its lifetime";
  }
}

// A pattern of one's own: where the shots point beside each other, so far apart do they strike.
TEST(SceneGuns, ShootByAPatternOfTheirOwn) {
  SceneWorld world = start(R"({"step": "1/240 s", "gravity": [0, 0, 0], "environment": {"air": {"vacuum": true}},
      "bodies": [{"name": "plate", "type": "fixed", "position": [100.005, 0, 0],
                  "shape": {"type": "box", "size": ["1 cm", "4 m", "4 m"]}}],
      "guns": [{"name": "g", "rounds": 4, "rounds_per_minute": 120, "pattern": [0, 0, 0.002, 0.004, "-0.1 deg", "0.2 deg"],
                "ammunition": {"mass": 0.01, "diameter": 0.008, "muzzle_speed": 1000}}]})");
  const double degree = math::pi / 180;
  const math::Vec2d expected[] = {{0, 0}, {0.2, 0.4}, {-10 * degree, 20 * degree}, {-10 * degree, 20 * degree}};
  for (int shot = 0; shot < 4; ++shot) {
    run(world, 0.5 * shot + 0.3);
    ASSERT_EQ(read(world, "gun.g.hits"), shot + 1);
    EXPECT_NEAR(read(world, "gun.g.last_hit.z"), expected[shot].x, 1e-4) << shot;
    EXPECT_NEAR(read(world, "gun.g.last_hit.y"), expected[shot].y, 1e-4) << shot;
  }
}

// 168 SMK, zero 100 yd by 1.14214 mrad: 15.565 in low at 300 yd (reference solution), which is 4.954 minutes of arc, so
// 20 quarters of one. Small angles add; what cant turns about the muzzle is what the bore is raised by.
TEST(SceneGuns, SightsAreTurnedHeldAndCanted) {
  constexpr double yard = 0.9144, inch = 0.0254, far = 300 * yard, low = 15.565 * inch, quarter = math::pi / 43200;
  const auto strike = [&](const std::string& keys) {
    SceneWorld world = start(R"({"step": "1/240 s",
      "bodies": [{"name": "plate", "type": "fixed", "position": ["=300 yd + 5 mm", 0, 0],
                  "shape": {"type": "box", "size": ["1 cm", "2 m", "2 m"]}}],
      "guns": [{"name": "g", "preset": "gun/rifle_308", "dispersion": 0, "sighted": true, )" +
                             keys + R"(, "ammunition": {"preset": "ammunition/308_168_smk", "speed_deviation": 0}}]})");
    run(world, 0.5);
    EXPECT_EQ(read(world, "gun.g.hits"), 1);
    return math::Vec2d{read(world, "gun.g.last_hit.z"), read(world, "gun.g.last_hit.y") - 1.5 * inch};
  };
  const double lean = 10 * math::pi / 180, raised = far * 1.14214e-3;
  struct Case {
    const char* keys;
    double right, up;
  };
  const Case cases[] = {
      {R"("clicks_up": 0)", 0, -low},
      {R"("clicks_up": 20)", 0, 20 * quarter * far - low},
      {R"("dial": "300 yd")", 0, 20 * quarter * far - low},
      {R"("dial": "300 yd", "clicks_up": -4, "clicks_right": 8)", 8 * quarter * far, 16 * quarter * far - low},
      {R"("hold_up": "1.4412 mrad", "hold_right": "-1 mrad")", -1e-3 * far, 0},
      {R"("cant": "10 deg")", raised * math::sin(lean), raised * (math::cos(lean) - 1) - low}};
  for (const Case& c : cases) {
    const math::Vec2d at = strike(c.keys);
    EXPECT_NEAR(at.x, c.right, 1.5e-3) << c.keys;
    EXPECT_NEAR(at.y, c.up, 3e-3) << c.keys;
  }
}

// Walls at 10 m in vacuum and without gravity: every hole is where the hands held the bore.
std::string swaying(const std::string& keys, int seed = 3) {
  return R"({"step": "1/100 s", "gravity": [0, 0, 0], "environment": {"air": {"vacuum": true}},
    "bodies": [{"name": "wall", "type": "fixed", "position": ["10.5 m", 0, 0], "shape": {"type": "box", "size": [1, 4, 4]}}],
    "guns": [{"name": "g", "rounds": 400, "rounds_per_minute": 600, "seed": )" +
         std::to_string(seed) + R"(, "ammunition": {"mass": "4 g", "diameter": "6 mm", "muzzle_speed": "900 m/s"}, )" +
         keys + "}]}";
}
struct Scatter {
  double right = 0, up = 0;  // rad, root mean square
  double worst = 0;          // rad, of a hole beside where the bore pointed
};
Scatter scatter_of(const std::string& text) {
  SceneWorld world = start(text);
  Scatter s;
  int shots = 0, holes = 0;
  math::Vec2d pointed{};
  while (holes < 400) {
    const math::Vec2d now{read(world, "gun.g.swing_right"), read(world, "gun.g.swing_up")};
    if (!world.step().ok()) break;
    if (read(world, "gun.g.shots") > shots) pointed = now, ++shots;
    const math::Vec2d hole{read(world, "gun.g.last_hit.z") / 10, read(world, "gun.g.last_hit.y") / 10};
    if (read(world, "gun.g.hits") == holes) continue;
    ++holes;
    s.worst = math::max(s.worst, math::distance(hole, pointed));
    s.right += math::square(pointed.x), s.up += math::square(pointed.y);
  }
  EXPECT_EQ(holes, 400);
  return {math::sqrt(s.right / 400), math::sqrt(s.up / 400), s.worst};
}

TEST(SceneGuns, SwayInTheHands) {
  // Alone, each part has the root mean square that it is told: sums of sines over 40 s.
  const std::string still = R"("breath": 0, "heartbeat": 0, "tremor": 0, "drift": 0)";
  const auto part = [&](const char* name) {
    std::string keys = still;
    const std::string zero = "\"" + std::string(name) + "\": 0";
    keys.replace(keys.find(zero), zero.size(), "\"" + std::string(name) + "\": \"2 mrad\"");
    return scatter_of(swaying("\"sway\": {" + keys + "}"));
  };
  const Scatter breath = part("breath"), drift = part("drift");
  EXPECT_NEAR(breath.up, 2e-3, 0.05e-3);
  EXPECT_NEAR(breath.right, 0.5e-3, 0.02e-3);
  EXPECT_NEAR(drift.up, 2e-3, 0.4e-3);
  EXPECT_LT(math::max(breath.worst, drift.worst), 1e-6);
  EXPECT_EQ(scatter_of(swaying("\"sway\": {" + still + "}")).up, 0);
  // Whoever stands, is tired or has never shot, scatters more.
  const auto of = [](const char* keys, int seed = 3) {
    return scatter_of(swaying("\"sway\": {" + std::string(keys) + "}", seed)).up;
  };
  const double standing = of(R"("stance": "offhand")");
  EXPECT_GT(standing, 1e-3);
  EXPECT_LT(standing, 3e-3);
  EXPECT_LT(of(R"("stance": "supported")"), 0.3e-3);
  EXPECT_LT(of(R"("stance": "kneeling")"), standing);
  EXPECT_LT(of(R"("skill": 1)"), of(R"("skill": 0)"));
  EXPECT_GT(of(R"("fatigue": 1)"), standing);
  EXPECT_LT(of(R"("breath_held": 1)"), standing);
  EXPECT_EQ(of(R"("stance": "offhand")"), standing) << "the same every time";
  EXPECT_NE(of(R"("stance": "offhand")", 4), standing);
}

TEST(SceneGuns, EveryPresetShootsAndEveryWallHolds) {
  const auto guns = presets("gun"), rounds = presets("ammunition"), walls = presets("wall");
  EXPECT_GE(guns.size(), 5u);
  EXPECT_GE(walls.size(), 6u);
  std::string list, layers;
  for (const std::string& g : guns) list += R"({"preset": "gun/)" + g + R"(", "climb": true, "rounds": 2},)";
  for (const std::string& a : rounds) list += R"({"ammunition": ")" + a + R"("},)";
  for (std::size_t i = 0; i < walls.size(); ++i)
    layers +=
        (i > 0 ? ", " : "") + std::string("{\"user_id\": ") + std::to_string(i) + ", \"wall\": \"" + walls[i] + "\"}";
  list.pop_back();
  SceneWorld world = start("{\"guns\": [" + list + "], \"penetration\": [" + layers + "]}");
  ASSERT_NE(world.destruction, nullptr);
  ASSERT_EQ(world.destruction->space.guns.size(), guns.size() + rounds.size());
  run(world, 0.1);
  for (const auto& gun : world.destruction->space.guns) EXPECT_GE(gun.thing.shots, 1) << gun.name;
}

std::string structure(const std::string& keys, int dimension = 3) {
  return "{\"dimension\": " + std::to_string(dimension) +
         ", \"gravity\": " + (dimension == 2 ? "[0, 0]" : "[0, 0, 0]") + ", \"structures\": [{\"name\": \"s\", " +
         keys + "}]}";
}

TEST(SceneStructures, EverySolidWeighsWhatItShould) {
  struct Case {
    const char* keys;
    double mass;
    int dimension = 3;
    double tolerance = 1e-4;
  };
  const Case cases[] = {
      {R"("shape": {"type": "box", "size": [1, 2, 0.5]}, "density": 1000)", 1000},
      {R"("shape": {"type": "box", "size": [1, 2, 0.5]}, "substance": "glass", "pattern": "even", "pieces": 20)", 2500},
      {R"("shape": {"type": "box", "size": [1, 2, 0.5]}, "density": 1000, "pattern": "slabs", "pieces": 5, "jitter": 0.4)",
       1000},
      {R"("shape": {"type": "box", "size": [1, 2, 0.5]}, "density": 1000, "pattern": "bricks", "brick": [0.3, 0.3, 0.5])",
       1000},
      {R"("shape": {"type": "box", "size": [1, 1, 0.01]}, "density": 1000, "pattern": "radial", "skin": 1e-4)", 10},
      {R"("shape": {"type": "hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}, "density": 600, "pattern": "clustered")",
       100},
      {R"("shape": {"type": "mesh", "file": "solid.obj"}, "density": 600, "pieces": 12)", 100},
      // A sphere of 24 facets round weighs less than the round one.
      {R"("shape": {"type": "sphere", "radius": 0.5}, "density": 1000, "pieces": 12)", 523.6, 3, 0.03},
      {R"("shape": {"type": "box", "size": [2, 1]}, "density": 1000)", 2000, 2},
      {R"("outline": [[0,0],[2,0],[2,2],[1,1],[0,2]], "density": 1000, "pattern": "radial", "impact": [1, 0.5], "first_radius": 0.2)",
       3000, 2},
      {R"("shape": {"type": "box", "size": [2, 1]}, "density": 1000, "pattern": "slabs", "pieces": 5, "axis": [1, 0.2], "jitter": 0.4)",
       2000, 2},
      {R"("outline": [[0,0],[2,0],[2,2],[1,1],[0,2]], "density": 1000, "pattern": "bricks", "brick": [0.4, "20 cm"])",
       3000, 2},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.keys);
    SceneWorld world = start(structure(c.keys, c.dimension));
    ASSERT_NE(world.destruction, nullptr);
    EXPECT_NEAR(read(world, "s.mass"), c.mass, c.tolerance * c.mass);
    EXPECT_GT(read(world, "structure.s.parts"), 3);
    EXPECT_EQ(read(world, "structure.s.pieces"), 1);
  }
}

TEST(SceneStructures, BreakOnTheGroundInSpaceAndInThePlane) {
  for (const int dimension : {2, 3}) {
    const bool plane = dimension == 2;
    SceneWorld world = start("{\"dimension\": " + std::to_string(dimension) +
                             R"(, "bodies": [{"name": "floor", "type": "fixed",
        "position": )" + (plane ? "[0, -0.5]" : "[0, -0.5, 0]") +
                             R"(, "shape": {"type": "box", "size": )" + (plane ? "[20, 1]" : "[20, 1, 20]") +
                             R"(}}], "structures": [{"name": "s", "substance": "glass", "tensile_strength": "1 MPa",
        "shear_strength": "1 MPa", "pieces": 30, "position": )" +
                             (plane ? "[0, 4]" : "[0, 4, 0]") + R"(, "shape": {"type": "box", "size": )" +
                             (plane ? "[1, 1]" : "[1, 1, 1]") + "}}]}");
    const double before = read(world, "mass");
    run(world, 0.5);
    EXPECT_EQ(read(world, "structure.s.broken"), 0);
    run(world, 2);
    EXPECT_GT(read(world, "structure.s.pieces"), 4);
    EXPECT_NEAR(read(world, "mass"), before, 1e-5 * before);
  }
}

TEST(SceneStructures, ABlastAndAShotBreakThem) {
  const std::string wall = R"("bodies": [{"name": "ground", "type": "fixed", "shape": {"type": "plane"}}],
      "structures": [{"name": "w", "position": ["3 m", "0.8 m", 0], "shape": {"type": "box", "size": ["0.1 m", "1.6 m", "2 m"]},
                      "pattern": "bricks", "brick": ["0.1 m", "0.2 m", "0.4 m"], "substance": "brick_and_mortar", "anchored_below": "-0.75 m"}])";
  SceneWorld alone = start("{" + wall + "}");
  run(alone, 0.5);
  EXPECT_EQ(read(alone, "structure.w.broken"), 0);
  SceneWorld blast = start("{" + wall + R"(, "explosions": [{"mass": "3 kg"}]})");
  run(blast, 0.5);
  EXPECT_GT(read(blast, "structure.w.broken"), 5);
  SceneWorld shot = start("{" + wall + R"(, "guns": [{"ammunition": {"mass": 6, "diameter": 0.12, "muzzle_speed": 400},
                                                       "position": [0, 1.07, 0.03]}]})");
  run(shot, 0.5);
  EXPECT_GT(read(shot, "structure.w.broken"), 0);
}

TEST(SceneDestruction, ErrorsNameTheirPlace) {
  struct Case {
    const char *keys, *part;
    int dimension = 3;
  };
  const Case cases[] = {
      {R"("guns": [{"ammunition": "9mm_115_fmj", "cant": "3 deg"}])", "only a gun that is \"sighted\" has it"},
      {R"("guns": [{"ammunition": "9mm_115_fmj", "sway": {"skill": 2}}])",
       "guns[0].sway.skill: found 2, expected 0 to 1"},
      {R"("guns": [{"ammunition": "9mm_115_fmj", "sway": {"stance": "flying"}}])", "expected one of offhand, kneeling"},
      {R"("guns": [{"ammunition": "9mm_115_fmj", "sway": {"tremor_low": "20 Hz"}}])", "tremor_high is 12"},
      {R"("guns": [{"ammunition": "9mm_115_fmj", "sighted": true, "dial": "90 km"}])", "does not get 90000 m far"},
      {R"("explosions": 5)", "explosions: found 5, expected a list"},
      {R"("explosions": [{}])", "explosions[0]: the key \"mass\" is missing"},
      {R"("explosions": [{"mass": "-1 kg"}])", "mass is -1"},
      {R"("explosions": [{"mass": "1 kg", "shelter": 2}])", "shelter is 2"},
      {R"("explosions": [{"mass": "1 kg", "burst": "sky"}])", "expected one of ground, free_air"},
      {R"("explosions": [{"mass": "1 kg", "case": {}}])", "the key \"mass\" is missing"},
      {R"("explosions": [{"mass": "1 kg", "case": {"mass": "-1 kg"}}])", "mass is -1, expected a finite number > 0"},
      {R"("explosions": [{"mass": "1 kg", "case": {"mass": "1 kg", "fragments": 1}}])", "explosions[0].case.fragments"},
      {R"("explosions": [{"mass": "1 m"}])", "explosions[0].mass"},
      {R"("explosions": [{"mass": 1, "casing": "nobody"}])", "expected the name of a body"},
      {R"("explosions": [{"mass": 1, "name": "a"}, {"mass": 1, "name": "a"}])", "a second time"},
      {R"("guns": [{}])", "the key \"ammunition\" is missing"},
      {R"("guns": [{"ammunition": "nothing"}])", "no file presets/ammunition/nothing.json"},
      {R"("guns": [{"ammunition": "../x"}])", "expected the name of a preset"},
      {R"("guns": [{"ammunition": 5}])", "guns[0].ammunition"},
      {R"("guns": [{"ammunition": {"mass": -1}}])", "guns[0].ammunition.mass"},
      {R"("guns": [{"ammunition": {"ballistic_coefficient": 0.3}}])", "drag_function"},
      {R"("guns": [{"ammunition": {}, "rounds": 0}])", "guns[0].rounds"},
      {R"("guns": [{"ammunition": {}, "direction": [0, 0, 0]}])", "a direction that is not zero"},
      {R"("guns": [{"ammunition": {}, "start": "-1 s"}])", "a time of zero or more"},
      {R"("guns": [{"ammunition": {}, "lifetime": "2 h"}])", "1 ms to 600 s"},
      {R"("guns": [{"ammunition": {}, "target": "drone"}])", "expected the name of a body"},
      {R"("guns": [{"ammunition": {}, "pattern": [0, 0, 1]}])", "two angles a shot"},
      {R"("guns": [{"ammunition": {}, "climb": true, "pattern": [0, 0]}])", "a pattern beside climb"},
      {R"("guns": [{"ammunition": {}, "sighted": true, "zero": "90 km"}])", "guns[0]"},
      {R"("guns": [{"ammunition": {}, "calibre": 5}])", "calibre"},
      {R"("penetration": [{"wall": []}])", "a list of 1 to 100 layers"},
      {R"("penetration": [{"wall": [{"thickness": "-1 m"}]}])", "penetration[0].wall"},
      {R"("penetration": [{"wall": "nothing"}])", "no file presets/wall/nothing.json"},
      {R"("structures": [{}])", "the key \"shape\" is missing"},
      {R"("structures": [{"shape": {"type": "plane"}}])", "does not break"},
      {R"("structures": [{"shape": {"type": "mesh", "file": "open.obj"}}])", "structures[0]"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "pattern": "bricks"}])",
       "the key \"brick\" is missing"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "pattern": "bricks", "brick": [1, 0, 1]}])",
       "structures[0]"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "pattern": "bricks", "brick": [0.001, 0.001, 0.001]}])",
       "structures[0]"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "pattern": "stars"}])",
       "expected one of voronoi"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "pieces": 0}])", "structures[0].pieces"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "density": 0}])", "structures[0].density"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "tensile_strength": 0}])", "structures[0]"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "skin": "1 m"}])", "skin"},
      {R"("structures": [{"shape": {"type": "box", "size": [1, 1, 1], "position": [1, 0, 0]}}])",
       "no place of its own"},
      {R"("bodies": [{"name": "a"}], "structures": [{"name": "a", "shape": {"type": "box", "size": [1, 1, 1]}}])",
       "that no body has"},
      {R"("structures": [{"shape": {"type": "segment", "points": [[0,0],[1,0]]}}])", "does not break", 2},
      {R"("structures": [{"shape": {"type": "circle", "radius": 1}, "pattern": "even"}])",
       "voronoi, radial, slabs or bricks in the plane", 2},
      {R"("structures": [{"shape": {"type": "circle", "radius": 1}, "pattern": "bricks"}])",
       "the key \"brick\" is missing", 2},
      {R"("structures": [{"shape": {"type": "circle", "radius": 1}, "pattern": "bricks", "brick": [1, 0]}])",
       "structures[0]", 2},
      {R"("structures": [{"shape": {"type": "circle", "radius": 1}, "pattern": "bricks", "brick": [1e-3, 1e-3]}])",
       "structures[0]", 2},
      {R"("structures": [{"shape": {"type": "circle", "radius": 1}, "pattern": "slabs", "axis": [0, 0]}])",
       "a direction that is not zero", 2},
      {R"("structures": [{"shape": {"type": "circle", "radius": 1}, "pattern": "slabs", "jitter": 2}])", "0 to 1", 2},
      {R"("structures": [{"outline": [[0,0],[0,1],[1,0]]}])", "structures[0]", 2},
  };
  for (const Case& c : cases) {
    const std::string found = message(c.keys, c.dimension);
    EXPECT_NE(found.find(c.part), std::string::npos) << c.keys << "\n  gave: " << found;
    EXPECT_NE(found.find(":1: "), std::string::npos) << "no line in: " << found;
  }
}

TEST(SceneDestruction, LiveParametersLeaveWhatRunsAlone) {
  const auto scene =
      parse(R"({"parameters": {"g": {"value": "-9 m/s^2", "minimum": "-20 m/s^2", "maximum": "0 m/s^2", "live": true}},
      "gravity": [0, "=g", 0], "explosions": [{"mass": 1}], "guns": [{"ammunition": {}, "rounds": 5}],
      "structures": [{"shape": {"type": "box", "size": [1, 1, 1]}, "pieces": 8}]})");
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  auto world = scene->instantiate();
  ASSERT_TRUE(world.ok());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(world->step().ok());
  const std::vector<ParameterValue> weaker = {{"g", -3}};
  const auto applied = scene->apply(*world, weaker);
  EXPECT_TRUE(applied.ok()) << applied.error().message;
  EXPECT_EQ(double(world->world3->definition().gravity.y), -3);
  EXPECT_EQ(world->destruction->space.guns[0].thing.shots, 1);
}

}  // namespace scene_destruction_test
