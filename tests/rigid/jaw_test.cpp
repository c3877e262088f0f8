// Bodies that walls which no force moves press together beyond what can give way are not thrown out.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace jaw_test {

template <class D>
struct Jaws : testing::Test {
  World<D> world{world_with<D>()};
  float heavy = 1000;  ///< kg/m³, of one in seven
  std::vector<BodyId> pieces;
  double fastest = 0;  ///< m/s

  BodyId add_wall(double x, double y, const typename D::Shape& shape) {
    return add_body<D>(world, BodyType::kinematic, shape, at<D>(x, y));
  }
  void add_piece(double x, double y, double z = 0) {
    const Surface surface{.density = pieces.size() % 7 == 3 ? heavy : 1000};
    pieces.push_back(add_box<D>(world, at<D>(x, y, z), 0.2f, surface));
  }
  void drive(BodyId wall, double x, double y) { world.set_target_pose(wall, at<D>(x, y), {}, frame).value(); }
  void step() {
    world.step(frame).value();
    for (const BodyId body : pieces) fastest = std::max(fastest, double(speed(world, body)));
  }

  void close_walls() {
    add_ground(world);
    const BodyId left = add_wall(-1.5, 1, box_shape<D>(0.1f, 1, 1)), right = add_wall(1.5, 1, box_shape<D>(0.1f, 1, 1));
    for (int i = 0; i < 20; ++i) add_piece(0.45 * (i % 5 - 2), 0.2 + 0.42 * (i / 5));
    for (int i = 0; i < 900; ++i) {
      const double x = i > 400 ? std::min(1.5, 0.3 + 0.005 * (i - 400)) : std::max(0.3, 1.5 - 0.005 * i);
      drive(left, -x, 1);
      drive(right, x, 1);
      step();
    }
  }
  void lower_press() {
    add_ground(world);
    const BodyId press = add_wall(0, 4, box_shape<D>(2, 0.2f, 2));
    const bool flat = D::dimension == 2;
    for (int i = 0; i < (flat ? 12 : 30); ++i)
      add_piece(0.45 * (i % 3 - 1), 0.2 + 0.42 * (flat ? i / 3 : i / 9), 0.45 * (i / 3 % 3 - 1));
    for (int i = 0; i < 900; ++i) {
      drive(press, 0, i > 600 ? 0.5 + (i - 600) / 120.0 : std::max(0.5, 4 - i / 120.0));
      step();
    }
  }
  void expect_held(double most) {
    EXPECT_LT(fastest, most);
    for (const BodyId body : pieces) EXPECT_GT(world.state(body)->pose.position.y, 0);
  }
};

using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Jaws, Dimensions);

// While the squeeze counted for a load they left at 12 and 25 km/s.
TYPED_TEST(Jaws, WallsThatCloseThrowNothing) {
  this->close_walls();
  this->expect_held(20);
}
TYPED_TEST(Jaws, APressThrowsNothing) {
  this->lower_press();
  this->expect_held(20);
}
// Heavy ones account for a load, by which the squeeze may press light ones the harder.
TYPED_TEST(Jaws, WallsThatCloseOnHeavyOnesThrowNothing) {
  this->heavy = 1e6f;
  this->close_walls();
  this->expect_held(20);
}
TYPED_TEST(Jaws, APressOnHeavyOnesThrowsNothing) {
  this->heavy = 1e6f;
  this->lower_press();
  this->expect_held(30);
}

// The steps since a body last asked to count for more are kept modulo 2¹⁶.
TYPED_TEST(Jaws, ALoadIsGrantedAfterHoursToo) {
  using D = TypeParam;
  add_ground(this->world);
  run(this->world, 40000);
  add_box<D>(this->world, at<D>(0, 0.5), 0.5f, {.density = 1000});
  const BodyId heavy = add_box<D>(this->world, at<D>(0, 1.52), 0.5f, {.density = 1e6f});
  run(this->world, 600);
  EXPECT_NEAR(this->world.state(heavy)->pose.position.y, 1.5, 0.01);
}

}  // namespace jaw_test
}  // namespace carom::rigid::test
