// The pool table under a pointer: the golden ball on the line of aim is pulled, and the cue follows; its other games.
#include "tests/host/client.h"

namespace carom::host::test {
namespace {

TEST(Billiards, TheAimIsPulled) {
  Page page;
  page.open("pool-table", {{"direction", 0}});
  page.run_for(0.1);
  // 0.4 m before the cue ball, which lies on the head spot.
  page.send({{"type", "grab"},
             {"pointer", 1},
             {"origin", Json::array({-0.635 + 0.4, 2, 0})},
             {"direction", Json::array({0, -1, 0})}});
  ASSERT_GE(page.last("grabbed")["body"].get<int>(), 0);
  for (int i = 0; i < 36; ++i) {
    page.send({{"type", "drag"}, {"pointer", 1}, {"target", Json::array({-0.635 + 0.4, 0.03, -0.3})}});
    page.run_for(1.0 / 60);
  }
  EXPECT_EQ(page.count("error"), 0);
  // Counterclockwise seen from above: toward −z.
  const double direction = page.last("values")["values"]["direction"].get<double>();
  EXPECT_NEAR(direction, std::atan2(0.3, 0.4), 0.08);
}

// Carom has an opening of its own (demos_test.cpp: it scores), and the stroke of the break is back when pool is.
TEST(Billiards, TheStrokeGoesWithTheGame) {
  Page page;
  page.open("pool-table", {{"table", 5}});
  EXPECT_NEAR(page.last("values")["values"]["side"].get<double>(), 0.4, 1e-12);
  EXPECT_EQ(page.last("values")["values"]["speed"].get<double>(), 5);
  EXPECT_EQ(page.count("error"), 0);
  page.open("pool-table",
            {{"table", 2}, {"direction", 7.35 * math::pi / 180}, {"speed", 5}, {"side", 0.4}, {"height", 0}});
  EXPECT_EQ(page.last("values")["values"]["speed"].get<double>(), 6.5);
}

}  // namespace
}  // namespace carom::host::test
