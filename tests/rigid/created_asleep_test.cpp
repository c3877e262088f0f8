// Bodies that are made asleep: they cost nothing and hang where they are until something awake touches them.
#include <gtest/gtest.h>

#include "carom/rigid/world.h"

namespace {
using namespace carom;
using namespace carom::rigid;

template <class D>
class CreatedAsleep : public testing::Test {
 public:
  BodyId add(double x, double y, bool awake, float speed = 0) {
    BodyDef<D> body;
    body.position.x = x, body.position.y = y;
    body.linear_velocity.x = speed;
    body.awake = awake;
    const BodyId id = world.create_body(body).value();
    if constexpr (D::dimension == 2)
      world.add_shape(id, geometry::make_box2({0.5f, 0.5f})).value();
    else
      world.add_shape(id, geometry::Box{{0.5f, 0.5f, 0.5f}}).value();
    return id;
  }
  static WorldDef<D> weightless() {
    WorldDef<D> d;
    d.gravity = {};
    return d;
  }
  World<D> world{weightless()};
};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(CreatedAsleep, Dimensions);

TYPED_TEST(CreatedAsleep, StaysUntilItIsTouched) {
  std::vector<BodyId> row;
  for (int i = 0; i < 5; ++i) row.push_back(this->add(1.0 * i, 0, false));  // side by side, touching
  for (int i = 0; i < 30; ++i) this->world.step(1.0f / 60.0f).value();
  EXPECT_EQ(this->world.counters().awake_bodies, 0);
  for (int i = 0; i < 5; ++i) {
    const auto state = this->world.state(row[std::size_t(i)]).value();
    EXPECT_FALSE(state.awake);
    EXPECT_EQ(state.pose.position.x, 1.0 * i);
  }
  // A blow at one end goes through all of them: momentum m v is shared.
  const BodyId ball = this->add(-4, 0, true, 6);
  EXPECT_EQ(this->world.counters().awake_bodies, 1);
  for (int i = 0; i < 60; ++i) this->world.step(1.0f / 60.0f).value();
  double momentum = this->world.state(ball)->linear_velocity.x;
  for (const BodyId body : row) {
    const auto state = this->world.state(body).value();
    EXPECT_GT(state.linear_velocity.x, 0.1f);
    momentum += state.linear_velocity.x;
  }
  EXPECT_NEAR(momentum, 6.0, 1e-4);
}

TYPED_TEST(CreatedAsleep, IsWokenByHand) {
  const BodyId body = this->add(0, 0, false);
  this->world.step(1.0f / 60.0f).value();
  EXPECT_FALSE(this->world.state(body)->awake);
  this->world.set_awake(body, true).value();
  EXPECT_TRUE(this->world.state(body)->awake);
  EXPECT_EQ(this->world.counters().awake_bodies, 1);
}

}  // namespace
