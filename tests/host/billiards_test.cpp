// The pool table under a pointer: the golden ball on the line of aim is pulled, and the cue follows.
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

}  // namespace
}  // namespace carom::host::test
