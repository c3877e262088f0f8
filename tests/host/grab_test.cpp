// Taking hold of bodies: the ray that picks, the spring that pulls, the limits of both.
#include <cmath>

#include "tests/host/client.h"

namespace carom::host::test {
namespace {

Json vec(double x, double y, double z) { return Json::array({x, y, z}); }

TEST(Grab, LiftsACubeOffItsPyramid) {
  Page page;
  page.open("pyramids", {{"pyramids", 1}, {"base", 3}});
  page.run_for(1);
  // One pyramid of base 3 at z = 0: its top cube is centred at (0, 2.5, 0).
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", vec(0, 2.5, 10)}, {"direction", vec(0, 0, -1)}});
  const Json grabbed = page.last("grabbed");
  ASSERT_GE(grabbed["body"].get<int>(), 0);
  EXPECT_NEAR(grabbed["point"][2].get<double>(), 0.5, 0.02);
  const auto id = grabbed["body"].get<std::uint32_t>();
  for (int i = 0; i < 120; ++i) {
    page.send({{"type", "drag"}, {"pointer", 1}, {"target", vec(0, 2.5 + 2.5 * i / 120.0, 0.5)}});
    page.run_for(1.0 / 60);
  }
  page.run_for(1);
  EXPECT_GT(page.body(id).position.y, 4);
  EXPECT_GT(page.frames.back().lines, 0u) << "the spring is drawn";
  page.send({{"type", "release"}, {"pointer", 1}});
  page.run_for(2);
  EXPECT_LT(page.body(id).position.y, 3);
}

TEST(Grab, NothingThereAndFixedBodiesAreMinusOne) {
  Page page;
  page.open("pyramids");
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", vec(0, 50, 0)}, {"direction", vec(0, 1, 0)}});
  EXPECT_EQ(page.last("grabbed")["body"], -1);
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", vec(100, 5, 100)}, {"direction", vec(0, -1, 0)}});
  EXPECT_EQ(page.last("grabbed")["body"], -1);
  page.send({{"type", "drag"}, {"pointer", 1}, {"target", vec(0, 0, 0)}});
  EXPECT_EQ(page.count("error"), 1);
}

TEST(Grab, InThePlaneTheRayMeetsTheWorldAtZero) {
  Page page;
  page.open("collision-lab-2d");
  page.send({{"type", "pause"}});
  const math::Vec3d at = page.body(0).position;
  page.send({{"type", "grab"}, {"pointer", 3}, {"origin", vec(at.x + 1, at.y, 10)}, {"direction", vec(-0.1, 0, -1)}});
  EXPECT_EQ(page.last("grabbed")["body"], 0);
  page.send({{"type", "run"}});
  for (int i = 0; i < 180; ++i) {
    page.send({{"type", "drag"}, {"pointer", 3}, {"target", vec(-2, 3, 0)}});
    page.run_for(1.0 / 60);
  }
  EXPECT_NEAR(page.body(0).position.x, -2, 0.2);
  EXPECT_NEAR(page.body(0).position.y, 3, 0.2);
}

TEST(Grab, ManyPointersAreBounded) {
  Page page;
  page.open("pyramids");
  for (int i = 0; i < 200; ++i)
    page.send({{"type", "grab"}, {"pointer", i}, {"origin", vec(0, 9.5, 50)}, {"direction", vec(0, 0, -1)}});
  int held = 0;
  for (const Json& t : page.texts) held += t["type"] == "grabbed" && t["body"] >= 0;
  EXPECT_EQ(held, Simulation::max_pointers);
  page.run_for(0.5);
  EXPECT_EQ(page.count("error"), 0);
}

TEST(Grab, RestartLetsGo) {
  Page page;
  page.open("pyramids", {{"pyramids", 1}});
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", vec(0, 9.5, 50)}, {"direction", vec(0, 0, -1)}});
  EXPECT_GE(page.last("grabbed")["body"].get<int>(), 0);
  page.send({{"type", "restart"}});
  page.run_for(0.1);
  page.send({{"type", "drag"}, {"pointer", 1}, {"target", vec(0, 20, 0)}});
  EXPECT_EQ(page.count("error"), 1);
}

TEST(Grab, APullToTheEndOfTheWorldBreaksNothing) {
  Page page;
  page.open("wrecking-ball");
  page.run_for(0.5);
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", vec(0, 1, 10)}, {"direction", vec(0, 0, -1)}});
  page.send({{"type", "drag"}, {"pointer", 1}, {"target", vec(1e9, 1e9, -1e9)}});
  page.run_for(2);
  for (const auto& [id, body] : page.bodies) EXPECT_TRUE(math::is_finite(body.position)) << id;
}

}  // namespace
}  // namespace carom::host::test
