// Every number and handle from outside that is not sound gets an error and leaves the world as it was.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class BadInput : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(BadInput, Dimensions);

template <class R>
bool refused(const R& r, std::string_view mention) {
  return !r.ok() && r.error().message.find(mention) != std::string::npos;
}
template <class D>
typename D::Angular spin_of(float w) {
  if constexpr (D::dimension == 2)
    return w;
  else
    return {w, 0, 0};
}

TYPED_TEST(BadInput, NumbersThatAreNotNumbers) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId box = add_box<D>(world, at<D>(0, 2));
  std::vector<ShapeId> shapes;
  world.shapes(box, shapes);
  run(world, 5);
  const std::uint64_t before = world.state_hash();
  typename D::Rotation turned{};
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), 3e38f}) {
    const auto v = along<D>(bad, 0);
    const auto p = at<D>(double(bad), 0);
    const bool nan = !math::is_finite(bad);
    EXPECT_TRUE(refused(world.set_pose(box, p, {}), "World::set_pose: position.x"));
    EXPECT_TRUE(refused(world.set_velocity(box, v, {}), "World::set_velocity: linear.x"));
    EXPECT_FALSE(world.set_velocity(box, {}, spin_of<D>(bad)).ok());
    EXPECT_TRUE(refused(world.add_force(box, v), "World::add_force: force.x"));
    EXPECT_FALSE(world.add_force_at(box, v, at<D>(0, 0)).ok());
    if (nan) {
      EXPECT_FALSE(world.add_force_at(box, along<D>(1, 0), p).ok());
    }
    EXPECT_FALSE(world.add_torque(box, spin_of<D>(bad)).ok());
    EXPECT_FALSE(world.add_impulse(box, v).ok());
    EXPECT_FALSE(world.add_impulse_at(box, v, at<D>(0, 0)).ok());
    EXPECT_FALSE(world.add_angular_impulse(box, spin_of<D>(bad)).ok());
    EXPECT_FALSE(world.set_damping(box, bad, 0).ok());
    EXPECT_FALSE(world.set_damping(box, 0, bad).ok());
    EXPECT_FALSE(world.set_gravity_scale(box, bad).ok());
    EXPECT_FALSE(world.set_time_scale(box, bad).ok());
    EXPECT_FALSE(world.set_gravity(v).ok());
    EXPECT_FALSE(world.step(bad).ok());
    Material m;
    m.friction = bad;
    EXPECT_FALSE(world.set_material(shapes[0], m).ok());
    m = {};
    m.restitution = bad;
    EXPECT_TRUE(refused(world.set_material(shapes[0], m), "material.restitution"));
    typename D::MassProperties mass;
    mass.mass = double(bad);
    mass.inertia = decltype(mass.inertia)(decltype(mass.inertia){});
    EXPECT_FALSE(world.set_mass_properties(box, mass).ok());
    BodyDef<D> body;
    body.position = p;
    EXPECT_FALSE(world.create_body(body).ok());
    body = {};
    body.linear_velocity = v;
    EXPECT_FALSE(world.create_body(body).ok());
    body = {};
    body.linear_damping = bad;
    EXPECT_FALSE(world.create_body(body).ok());
    body = {};
    body.sleep_speed = bad;
    EXPECT_FALSE(world.create_body(body).ok());
    ShapeDef<D> shape;
    shape.density = bad;
    EXPECT_FALSE(world.add_shape(box, ball_shape<D>(1), shape).ok());
    shape = {};
    shape.local.p.x = bad;
    EXPECT_FALSE(world.add_shape(box, ball_shape<D>(1), shape).ok());
    EXPECT_FALSE(world.add_shape(box, ball_shape<D>(bad)).ok());
    WorldDef<D> d;
    d.gravity = v;
    EXPECT_FALSE(World<D>::check(d).ok());
    d = {};
    d.contact_hertz = bad;
    EXPECT_FALSE(World<D>::check(d).ok());
  }
  EXPECT_FALSE(world.step(0).ok());
  EXPECT_FALSE(world.step(-1).ok());
  EXPECT_FALSE(world.step(2).ok());
  if constexpr (D::dimension == 2)
    turned = {0, 0};
  else
    turned = {0, 0, 0, 0};
  EXPECT_FALSE(world.set_pose(box, at<D>(0, 0), turned).ok());
  WorldDef<D> d;
  d.substeps = 0;
  World<D> unsound(d);
  EXPECT_TRUE(refused(unsound.step(frame), "substeps"));
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_EQ(world.counters().shapes, 2);
}

TYPED_TEST(BadInput, HandlesOfNoOne) {
  using D = TypeParam;
  World<D> world(world_with<D>()), other(world_with<D>());
  const BodyId gone = add_box<D>(world, at<D>(0, 2)), foreign = add_box<D>(other, at<D>(0, 2));
  std::vector<ShapeId> shapes;
  world.shapes(gone, shapes);
  ASSERT_TRUE(world.destroy_body(gone).ok());
  const BodyId reborn = add_box<D>(world, at<D>(0, 2));
  EXPECT_EQ(reborn.index, gone.index);
  EXPECT_FALSE(reborn == gone);
  const std::uint64_t before = world.state_hash();
  for (const BodyId body : {BodyId{}, gone, foreign}) {
    EXPECT_FALSE(world.contains(body));
    EXPECT_FALSE(world.state(body).ok());
    EXPECT_FALSE(world.body_definition(body).ok());
    EXPECT_FALSE(world.destroy_body(body).ok());
    EXPECT_FALSE(world.set_pose(body, {}, {}).ok());
    EXPECT_FALSE(world.set_velocity(body, {}, {}).ok());
    EXPECT_FALSE(world.set_target_pose(body, {}, {}, 1).ok());
    EXPECT_FALSE(world.set_type(body, BodyType::fixed).ok());
    EXPECT_FALSE(world.set_awake(body, true).ok());
    EXPECT_FALSE(world.set_enabled(body, false).ok());
    EXPECT_FALSE(world.set_locks(body, {}).ok());
    EXPECT_FALSE(world.set_damping(body, 0, 0).ok());
    EXPECT_FALSE(world.set_gravity_scale(body, 1).ok());
    EXPECT_FALSE(world.set_user_data(body, 1).ok());
    EXPECT_FALSE(world.add_force(body, {}).ok());
    EXPECT_FALSE(world.add_impulse(body, {}).ok());
    EXPECT_FALSE(world.add_shape(body, ball_shape<D>(1)).ok());
  }
  EXPECT_TRUE(refused(world.state(BodyId{}), "World::state: body is the null handle") ||
              refused(world.state(BodyId{}), "null handle"));
  EXPECT_TRUE(refused(world.state(foreign), "another world"));
  EXPECT_TRUE(refused(world.state(gone), "no longer exists"));
  for (const ShapeId shape : {ShapeId{}, shapes[0]}) {
    EXPECT_FALSE(world.contains(shape));
    EXPECT_FALSE(world.destroy_shape(shape).ok());
    EXPECT_FALSE(world.body_of(shape).ok());
    EXPECT_FALSE(world.shape_geometry(shape).ok());
    EXPECT_FALSE(world.shape_definition(shape).ok());
    EXPECT_FALSE(world.set_material(shape, {}).ok());
    EXPECT_FALSE(world.set_filter(shape, {}).ok());
  }
  EXPECT_EQ(world.state_hash(), before);
}

TYPED_TEST(BadInput, EnormousButAllowedNumbersStayFinite) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const BodyId box = add_box<D>(world, at<D>(1e12, 2));
  ASSERT_TRUE(world.set_velocity(box, along<D>(1e6f, 0), spin_of<D>(1e6f)).ok());
  ASSERT_TRUE(world.add_force(box, along<D>(1e18f, 0)).ok());
  run(world, 10);
  const BodyState<D> s = world.state(box).value();
  EXPECT_TRUE(math::is_finite(s.pose.position));
  EXPECT_LE(math::length(s.linear_velocity), 4.001e3f);
  EXPECT_TRUE(world.events().quarantined.empty());
}

// Found by the fuzzer: a joint pulled at a disabled body for ever, until its speed was no number.
TYPED_TEST(BadInput, AJointToADisabledBodyHoldsNothing) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  const BodyId held = add_box<D>(world, at<D>(0, 100)), loose = add_box<D>(world, at<D>(2, 100));
  BallJointDef<D> joint;
  joint.body_a = held;
  joint.body_b = loose;
  joint.frame_a.p = along<D>(1, 0);
  joint.frame_b.p = along<D>(-1, 0);
  world.create_joint(joint).value();
  ASSERT_TRUE(world.set_enabled(held, false).ok());
  run(world, 60);
  EXPECT_EQ(math::length(world.state(held).value().linear_velocity), 0.0f);
  EXPECT_NEAR(world.state(loose).value().pose.position.y, 95, 1e-3);
  EXPECT_NEAR(world.state(loose).value().pose.position.x, 2, 1e-6);
  ASSERT_TRUE(world.set_enabled(held, true).ok());
  run(world, 60);  // joined again
  EXPECT_LT(world.worst_joint_error(), 0.02f);
}

TYPED_TEST(BadInput, DefinitionsReadBackAsGiven) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  BodyDef<D> d;
  d.position = at<D>(1, 2);
  d.linear_damping = 0.5f;
  d.angular_damping = 0.25f;
  d.gravity_scale = 2;
  d.time_scale = 0.5f;
  d.bullet = true;
  d.user_data = 77;
  d.locks.x = true;
  d.name = "crate";
  const BodyId body = world.create_body(d).value();
  const BodyDef<D> back = world.body_definition(body).value();
  EXPECT_EQ(back.position, d.position);
  EXPECT_EQ(back.linear_damping, d.linear_damping);
  EXPECT_EQ(back.angular_damping, d.angular_damping);
  EXPECT_EQ(back.gravity_scale, d.gravity_scale);
  EXPECT_EQ(back.time_scale, d.time_scale);
  EXPECT_EQ(back.bullet, true);
  EXPECT_EQ(back.user_data, 77u);
  EXPECT_EQ(back.locks, d.locks);
  EXPECT_EQ(back.name, "crate");
}

}  // namespace
}  // namespace carom::rigid::test
