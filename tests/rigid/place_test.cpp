// Neither place nor size nor number changes what happens: far from the origin, small and large, crowded.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Place : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Place, Dimensions);

template <class D>
struct Course {
  std::vector<typename D::Position> way;  ///< of every body in every step, from the world's middle
  int contacts = 0, asleep = 0, begins = 0;
  float penetration = 0;
};

/// A stack, a ball that is thrown at a second one, and a slope of bodies, all about `middle`.
template <class D>
Course<D> run_at(typename D::Position middle) {
  World<D> world(world_with<D>());
  const auto here = [&](double x, double y) { return middle + at<D>(x, y); };
  add_body<D>(world, BodyType::fixed, box_shape<D>(50, 1, 50), here(0, -1));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 6; ++i) bodies.push_back(add_box<D>(world, here(0, 0.5 + i)));
  for (int i = 0; i < 3; ++i) bodies.push_back(add_box<D>(world, here(8, 0.5 + i)));
  bodies.push_back(add_ball<D>(world, here(3, 1.5), 0.5f, {}, along<D>(12, 1)));
  bodies.push_back(add_ball<D>(world, here(-20, 1), 0.25f, {}, along<D>(0, 5)));
  Course<D> course;
  for (int i = 0; i < 240; ++i) {
    world.step(frame).value();
    course.begins += int(world.events().contact_begin.size());
    for (const BodyId body : bodies) course.way.push_back(world.state(body).value().pose.position - middle);
  }
  course.contacts = world.counters().touching_contacts;
  course.asleep = world.counters().bodies - 1 - world.counters().awake_bodies;
  course.penetration = world.worst_penetration();
  return course;
}

// Gate 22. At 10 000 km and beyond the doubles of the world are the only rounding: 1e-9 m at 10⁷ m, 1e-7 m at 10⁹ m.
// A stack stays to that; what bounces about amplifies it and is only held to the same verdicts.
TYPED_TEST(Place, TheSameStackEverywhere) {
  using D = TypeParam;
  const Course<D> origin = run_at<D>({});
  EXPECT_GE(origin.asleep, 9);  // a ball may still roll
  const struct {
    double distance, tolerance;
  } places[] = {{1e4, 1e-6}, {1e7, 1e-5}, {1e9, 1e-4}};
  for (const auto& place : places) {
    // On the grid of a power of two the same sums are made, elsewhere the last digit differs.
    for (const double sign : {1.0, -1.0}) {
      const Course<D> there = run_at<D>(at<D>(sign * place.distance, place.distance / 2, -place.distance));
      double worst = 0;
      ASSERT_EQ(there.way.size(), origin.way.size());
      for (std::size_t i = 0; i < there.way.size(); ++i)
        if (i % 11 < 6) worst = std::max(worst, math::length(there.way[i] - origin.way[i]));
      EXPECT_LT(worst, place.tolerance) << place.distance;
      EXPECT_EQ(there.asleep, origin.asleep) << place.distance;
      EXPECT_LT(std::abs(there.contacts - origin.contacts), 2) << place.distance;  // struck boxes end centimetres apart
      EXPECT_LT(std::abs(there.begins - origin.begins), 3) << place.distance;
      EXPECT_LT(there.penetration, 0.006f) << place.distance;
    }
  }
}

// The broad phase keeps no more pairs far away than near, and finds by ray what is there.
TYPED_TEST(Place, TheBroadPhaseSeesAsSharplyFarAway) {
  using D = TypeParam;
  int pairs[2] = {};
  for (int far = 0; far < 2; ++far) {
    World<D> world(world_with<D>());
    const typename D::Position middle = far != 0 ? at<D>(1e9, -1e9, 1e9) : at<D>(0, 0);
    add_body<D>(world, BodyType::fixed, box_shape<D>(50, 1, 50), middle + at<D>(0, -1));
    for (int i = 0; i < 20; ++i) add_box<D>(world, middle + at<D>(1.3 * i - 13, 0.5));
    run(world, 30);
    pairs[far] = world.counters().contacts;
    const RayHit<D> hit = world.ray_cast(middle + at<D>(0, 5), along<D>(0, -10)).value();
    ASSERT_FALSE(hit.shape.is_null());
    EXPECT_NEAR(hit.point.y - middle.y, 1, 0.01);
  }
  EXPECT_EQ(pairs[0], 20);
  EXPECT_EQ(pairs[1], 20);
}

/// Does a stack of cubes of this size stand, and sleep, after ten of its own seconds?
template <class D>
void expect_stack_stands(const WorldDef<D>& definition, float size, int height, float dt, float speed_scale) {
  World<D> world(definition);
  add_body<D>(world, BodyType::fixed, box_shape<D>(50 * size, size, 50 * size), at<D>(0, -double(size)));
  std::vector<BodyId> stack;
  for (int i = 0; i < height; ++i) {
    BodyDef<D> d;
    d.position = at<D>(0, double(size) * (0.5 + i));
    d.sleep_speed *= speed_scale;
    stack.push_back(world.create_body(d).value());
    world.add_shape(stack.back(), box_shape<D>(0.5f * size, 0.5f * size, 0.5f * size)).value();
  }
  for (int i = 0; i < 600; ++i) world.step(dt).value();
  for (int i = 0; i < height; ++i) {
    const BodyState<D> s = world.state(stack[std::size_t(i)]).value();
    EXPECT_NEAR(s.pose.position.y / double(size), 0.5 + i, 0.02 * (i + 1)) << size << " m, cube " << i;
    EXPECT_NEAR(s.pose.position.x / double(size), 0, 0.02) << size << " m, cube " << i;
    EXPECT_FALSE(s.awake) << size << " m, cube " << i;
  }
}

// Gate 22: cubes from 1 cm to 100 m. What is s times as large lives √s times as slowly: with step, contact frequency
// and sleep speed in that proportion it is the same stack to rounding.
TYPED_TEST(Place, TheSameStackInEverySize) {
  using D = TypeParam;
  for (const float size : {0.01f, 0.1f, 1.0f, 10.0f, 100.0f}) {
    const float slower = math::sqrt(size);
    WorldDef<D> d = world_with<D>();
    d.contact_hertz /= slower;
    d.contact_push_speed *= slower;
    d.sleep_time *= slower;
    expect_stack_stands<D>(d, size, 5, frame * slower, slower);
  }
}
// At 60 Hz and the default settings throughout. Soft contacts sag by a fixed length under a load, about .1 mm a cube
// and level, so that small cubes pile less high.
TYPED_TEST(Place, StacksOfEverySizeAtSixtyHertz) {
  using D = TypeParam;
  for (const float size : {1.0f, 10.0f, 100.0f}) expect_stack_stands<D>(world_with<D>(), size, 5, frame, 1);
  for (const float size : {0.1f, 0.05f}) expect_stack_stands<D>(world_with<D>(), size, 2, frame, 1);
  expect_stack_stands<D>(world_with<D>(), 0.01f, 1, frame, 1);
}

// No pair is ever dropped, however many touch one body: a thousand balls on one plate of their weight.
TEST(Crowd, AThousandSpheresOnOnePlate) {
  for (const BodyType type : {BodyType::dynamic, BodyType::kinematic}) {
    World3 world(world_with<Dim3>());
    add_ground(world);
    const BodyId plate = add_body<Dim3>(world, type, geometry::Box{{10, 0.25f, 10}}, {0, 0.25, 0}, {0.6f, 0, 1000, 0});
    std::vector<BodyId> balls;
    for (int x = 0; x < 32; ++x)
      for (int z = 0; z < 32; ++z) {
        if (balls.size() == 1000) break;
        balls.push_back(
            add_ball<Dim3>(world, {0.6 * x - 9.3, 0.5 + 0.25, 0.6 * z - 9.3}, 0.25f, {0.6f, 0, 1000, 0.05f}));
      }
    run(world, 60);
    int touching = 0;
    std::vector<ContactView<Dim3>> contacts;
    world.contacts(contacts);
    std::vector<ShapeId> shapes;
    world.shapes(plate, shapes);
    for (const ContactView<Dim3>& c : contacts) {
      touching += c.shape_a == shapes[0] || c.shape_b == shapes[0] ? 1 : 0;
      for (int k = 0; k < c.count; ++k) EXPECT_GT(c.points[k].separation, -0.01f);
    }
    EXPECT_GE(touching, 1000);
    for (const BodyId ball : balls) {
      const BodyState<Dim3> s = world.state(ball).value();
      EXPECT_NEAR(s.pose.position.y, 0.75, 0.02);
      EXPECT_LT(math::length(s.linear_velocity), 0.05f);
    }
  }
}

}  // namespace
}  // namespace carom::rigid::test
