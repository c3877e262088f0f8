// What users say about contacts: belts, one-way platforms, rules for pairs, filters, modifiers; and blasts.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Hooks : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Hooks, Dimensions);

template <class D>
ShapeId shape_of(const World<D>& world, BodyId body) {
  std::vector<ShapeId> shapes;
  world.shapes(body, shapes);
  return shapes.at(0);
}
template <class D>
void set_material_id(World<D>& world, BodyId body, std::uint32_t id) {
  const ShapeId shape = shape_of(world, body);
  Material m = world.shape_definition(shape).value().material;
  m.user_id = id;
  world.set_material(shape, m).value();
}

// Gate 24: on a belt of speed u, a = μ g until v = u at t = u/(μ g). Both ways, and across in space.
TYPED_TEST(Hooks, ABeltCarriesByFriction) {
  using D = TypeParam;
  const float mu = 0.3f, g = 9.81f;
  for (const typename D::Vector u : {along<D>(2, 0), along<D>(-1.5f, 0), along<D>(0.9f, 0, 1.2f)}) {
    if (D::dimension == 2 && u.x == 0.9f) continue;
    World<D> world(world_with<D>(g));
    const BodyId belt = add_ground(world, {mu});
    ASSERT_TRUE(world.set_surface_velocity(shape_of(world, belt), u).ok());
    // A low box, so that it does not tip.
    const BodyId box = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(0, 0.1), {mu});
    const float arrival = math::length(u) / (mu * g);
    const typename D::Vector direction = u * (1 / math::length(u));
    int step = 0;
    for (; float(step) * frame < 0.8f * arrival; ++step) world.step(frame).value();
    const float t = float(step) * frame;
    EXPECT_NEAR(dot(world.state(box).value().linear_velocity, direction), mu * g * t, 0.01f * mu * g * t);
    run(world, 60);
    const BodyState<D> s = world.state(box).value();
    EXPECT_NEAR(math::length(s.linear_velocity - u), 0, 0.01f * math::length(u));
    EXPECT_TRUE(s.awake);
    ASSERT_TRUE(world.set_surface_velocity(shape_of(world, belt), {}).ok());
    run(world, 120);
    EXPECT_LT(speed(world, box), 1e-3f);
  }
}

// The belt turns with its shape: on the ring of a turntable it runs tangentially.
TYPED_TEST(Hooks, ABeltIsTurnedWithItsShape) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  BodyDef<D> def;
  def.type = BodyType::fixed;
  def.position = at<D>(0, -1);
  def.rotation = turned<D>(0.2);
  const BodyId slope = world.create_body(def).value();
  ShapeDef<D> belt;
  belt.material.friction = 1;
  belt.surface_velocity = along<D>(1, 0);
  world.add_shape(slope, box_shape<D>(20, 1, 20), belt).value();
  const BodyId box = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(0, 0.15), {1});
  run(world, 120);
  const BodyState<D> s = world.state(box).value();
  EXPECT_NEAR(s.linear_velocity.x, math::cos(0.2f), 0.02f);  // up the slope
  EXPECT_NEAR(s.linear_velocity.y, math::sin(0.2f), 0.02f);
}

template <class D>
BodyId add_platform(World<D>& world) {
  BodyDef<D> def;
  def.type = BodyType::fixed;
  def.position = at<D>(0, 3);
  const BodyId platform = world.create_body(def).value();
  ShapeDef<D> s;
  s.one_way = along<D>(0, 2);
  world.add_shape(platform, box_shape<D>(3, 0.1f, 3), s).value();
  return platform;
}

TYPED_TEST(Hooks, AOneWayPlatformIsJumpedThroughAndCarries) {
  using D = TypeParam;
  for (const float up : {8.0f, 12.0f, 40.0f}) {
    World<D> world(world_with<D>());
    add_platform(world);
    const BodyId jumper = add_ball<D>(world, at<D>(0.3, 0.5), 0.3f, {}, along<D>(0, up));
    double highest = 0;
    float slowest = up;
    for (int i = 0; i < 900; ++i) {
      world.step(frame).value();
      // It is in the platform by right, which is no penetration.
      EXPECT_LT(world.worst_penetration(), 0.005f) << i;
      const BodyState<D> s = world.state(jumper).value();
      highest = std::max(highest, s.pose.position.y);
      if (s.pose.position.y < 3.6 && highest == s.pose.position.y) slowest = std::min(slowest, s.linear_velocity.y);
    }
    // As high as without the platform: v²/2g above the start.
    EXPECT_NEAR(highest, 0.5 + double(up) * double(up) / (2 * 9.81), 0.01 * highest) << up;
    EXPECT_NEAR(world.state(jumper).value().pose.position.y, 3.4, 0.02) << up;
  }
}
TYPED_TEST(Hooks, AOneWayPlatformHoldsFastOnesFromAboveAndLetsSidesPass) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_platform(world);
  const BodyId fast = add_ball<D>(world, at<D>(-1, 10), 0.1f, {}, along<D>(0, -150));
  const BodyId aside = add_ball<D>(world, at<D>(-6, 3.0), 0.05f, {}, along<D>(30, 0));
  run(world, 12);
  EXPECT_GT(world.state(aside).value().pose.position.x, -2);
  run(world, 120);
  EXPECT_NEAR(world.state(fast).value().pose.position.y, 3.2, 0.05);
  EXPECT_LT(world.state(aside).value().pose.position.y, 2.5);
  // Made solid by hand, it carries from below too; opened again, what lies on it stays.
}
TYPED_TEST(Hooks, APlatformMayBeMadeSolid) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId platform = add_platform(world);
  ASSERT_TRUE(world.set_one_way(shape_of(world, platform), {}).ok());
  const BodyId jumper = add_ball<D>(world, at<D>(0, 0.5), 0.3f, {}, along<D>(0, 12));
  double highest = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame).value();
    highest = std::max(highest, world.state(jumper).value().pose.position.y);
  }
  EXPECT_LT(highest, 2.65);
}

// Two materials may meet otherwise than by the mixture: the deceleration tells μ, the apex tells e.
TYPED_TEST(Hooks, ARuleForAPairOfMaterials) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  const BodyId ground = add_ground(world, {0.9f});
  set_material_id(world, ground, 7);
  const BodyId puck = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(0, 0.1), {0.9f});
  const BodyId ball = add_ball<D>(world, at<D>(50, 1.25), 0.25f);
  set_material_id(world, puck, 3);
  set_material_id(world, ball, 4);
  const PairRule ice{0.1f, 0, 0}, rubber{0.5f, 0.8f, 0};
  ASSERT_TRUE(world.set_pair_rule(3, 7, &ice).ok());
  ASSERT_TRUE(world.set_pair_rule(7, 4, &rubber).ok());
  run(world, 2);
  ASSERT_TRUE(world.set_velocity(puck, along<D>(4, 0), {}).ok());
  double apex = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame).value();
    if (i > 30) apex = std::max(apex, world.state(ball).value().pose.position.y);
  }
  EXPECT_NEAR(world.state(puck).value().linear_velocity.x, 4 - 0.1f * 10, 0.02f);
  EXPECT_NEAR(apex - 0.25, 0.64, 0.02);
  ASSERT_TRUE(world.set_pair_rule(7, 3, nullptr).ok());  // the mixture again, for the contact that is there too
  run(world, 60);
  EXPECT_NEAR(world.state(puck).value().linear_velocity.x, 0, 0.02f);
  const PairRule bad{-1, 0, 0};
  EXPECT_FALSE(world.set_pair_rule(1, 2, &bad).ok());
}

TYPED_TEST(Hooks, AFilterOfTheCallerDecides) {
  using D = TypeParam;
  for (const double height : {1.0, 400.0}) {  // slow; and fast enough for continuous collision
    World<D> world(world_with<D>());
    add_ground(world);
    const BodyId ghost = add_ball<D>(world, at<D>(0, height), 0.3f);
    const BodyId solid = add_ball<D>(world, at<D>(3, height), 0.3f);
    int asked = 0;
    const ShapeId ghostly = shape_of(world, ghost);
    world.set_contact_filter([&](ShapeId a, ShapeId b) {
      ++asked;
      return !(a == ghostly || b == ghostly);
    });
    run(world, height > 10 ? 620 : 120);
    EXPECT_LT(world.state(ghost).value().pose.position.y, -1);
    EXPECT_NEAR(world.state(solid).value().pose.position.y, 0.3, 0.02);
    EXPECT_GT(asked, 1);
  }
}

TYPED_TEST(Hooks, AModifierChangesContactsOfThisStep) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  add_ground(world, {0.5f});
  const BodyId slider = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(0, 0.1), {0.5f});
  const BodyId sinker = add_ball<D>(world, at<D>(30, 0.5), 0.3f);
  const BodyId other = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(60, 0.1), {0.5f});
  const ShapeId slippery = shape_of(world, slider), ghostly = shape_of(world, sinker);
  ASSERT_TRUE(world.set_modify_contacts(slippery, true).ok());
  ASSERT_TRUE(world.set_modify_contacts(ghostly, true).ok());
  bool sound = true;
  int asked = 0;
  world.set_contact_modifier([&](ContactModification<D>& c) {
    ++asked;
    sound = sound && std::abs(math::length(c.normal) - 1) < 1e-3f && c.count >= 1 && c.enabled;
    if (c.shape_a == ghostly || c.shape_b == ghostly) {
      c.enabled = false;
    } else {
      sound = sound && (c.shape_a == slippery || c.shape_b == slippery) && std::abs(c.friction - 0.5f) < 1e-6f;
      c.friction = 0;
    }
  });
  run(world, 5);
  for (const BodyId body : {slider, other}) ASSERT_TRUE(world.set_velocity(body, along<D>(3, 0), {}).ok());
  run(world, 60);
  EXPECT_TRUE(sound);
  EXPECT_GT(asked, 60);
  EXPECT_NEAR(world.state(slider).value().linear_velocity.x, 3, 1e-3f);
  EXPECT_LT(world.state(other).value().linear_velocity.x, 0.01f);
  EXPECT_LT(world.state(sinker).value().pose.position.y, -1);
  // Nonsense from the modifier is no worse than none.
  world.set_contact_modifier([](ContactModification<D>& c) {
    c.friction = std::numeric_limits<float>::quiet_NaN();
    c.restitution = 1e9f;
  });
  run(world, 90);
  EXPECT_LT(world.state(slider).value().linear_velocity.x, 0.01f);
  EXPECT_TRUE(world.events().quarantined.empty());
}

// J/m² on the area that faces it: Δv = i A / m; the rest of the room feels nothing.
TYPED_TEST(Hooks, AnExplosionPushesByArea) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const float r = 0.25f;
  const BodyId near = add_ball<D>(world, at<D>(3, 0), r), half = add_ball<D>(world, at<D>(-5, 0), r),
               far = add_ball<D>(world, at<D>(0, 9), r), inside = add_ball<D>(world, at<D>(0.1, 0), r);
  ExplosionDef<D> e;
  e.radius = 4;
  e.falloff = 1.5f;
  e.impulse_per_area = 200;
  EXPECT_EQ(world.explode(e).value(), 3);
  const float area = D::dimension == 2 ? 2 * r : pi_f * r * r, mass = world.state(near).value().mass;
  EXPECT_NEAR(world.state(near).value().linear_velocity.x, 200 * area / mass, 0.01f * 200 * area / mass);
  EXPECT_NEAR(world.state(half).value().linear_velocity.x, -200 * area / mass * (5.5f - 4.75f) / 1.5f,
              0.02f * 200 * area / mass);
  EXPECT_EQ(speed(world, far), 0);
  EXPECT_GT(world.state(inside).value().linear_velocity.x, 0);
  ExplosionDef<D> gust;
  gust.center = at<D>(3, -1);
  gust.speed = 5;
  gust.radius = 2;
  const float before = world.state(near).value().linear_velocity.y;
  EXPECT_EQ(world.explode(gust).value(), 1);
  EXPECT_NEAR(world.state(near).value().linear_velocity.y - before, 5, 1e-3f);
  e.radius = -1;
  EXPECT_FALSE(world.explode(e).ok());
}

TYPED_TEST(Hooks, DensityFollows) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId box = add_box<D>(world, at<D>(0, 0));
  const float mass = world.state(box).value().mass;
  ASSERT_TRUE(world.set_density(shape_of(world, box), 250).ok());
  EXPECT_NEAR(world.state(box).value().mass, mass / 4, 1e-3f * mass);
  EXPECT_FALSE(world.set_density(shape_of(world, box), -1).ok());
}

TYPED_TEST(Hooks, DefinitionsReadBack) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId body = world.create_body({}).value();
  ShapeDef<D> d;
  d.surface_velocity = along<D>(1, 2);
  d.one_way = along<D>(0, 3);
  d.modify_contacts = true;
  const ShapeId special = world.add_shape(body, ball_shape<D>(1), d).value();
  const ShapeId plain = world.add_shape(body, ball_shape<D>(1)).value();
  const ShapeDef<D> back = world.shape_definition(special).value();
  EXPECT_EQ(back.surface_velocity, d.surface_velocity);
  EXPECT_EQ(back.one_way, along<D>(0, 1));
  EXPECT_TRUE(back.modify_contacts);
  EXPECT_FALSE(world.shape_definition(plain).value().modify_contacts);
  ASSERT_TRUE(world.destroy_shape(special).ok());
  const ShapeId reborn = world.add_shape(body, ball_shape<D>(1)).value();
  EXPECT_FALSE(world.shape_definition(reborn).value().modify_contacts);
  EXPECT_EQ(world.shape_definition(reborn).value().one_way, typename D::Vector{});
  d.one_way.x = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(world.add_shape(body, ball_shape<D>(1), d).ok());
}

// All of it is state: a snapshot keeps belts, platforms and rules.
TYPED_TEST(Hooks, SnapshotsKeepThem) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId belt = add_ground(world);
  add_platform(world);
  set_material_id(world, belt, 1);
  const PairRule rule{0.9f, 0.5f, 0};
  ASSERT_TRUE(world.set_pair_rule(0, 1, &rule).ok());
  ASSERT_TRUE(world.set_surface_velocity(shape_of(world, belt), along<D>(1, 0)).ok());
  for (int i = 0; i < 8; ++i) add_ball<D>(world, at<D>(i - 4, 0.5), 0.3f, {}, along<D>(0, 9));
  run(world, 15);  // some on their way through the platform
  const Snapshot<D> before = world.snapshot();
  const auto decoded = Snapshot<D>::decode(before.encode());
  ASSERT_TRUE(decoded.ok());
  std::vector<std::uint64_t> once, again;
  for (int i = 0; i < 90; ++i) world.step(frame).value(), once.push_back(world.state_hash());
  ASSERT_TRUE(world.set_pair_rule(0, 1, nullptr).ok());
  ASSERT_TRUE(world.set_surface_velocity(shape_of(world, belt), along<D>(-9, 0)).ok());
  run(world, 5);
  ASSERT_TRUE(world.restore(*decoded).ok());
  for (int i = 0; i < 90; ++i) world.step(frame).value(), again.push_back(world.state_hash());
  EXPECT_EQ(again, once);
}

}  // namespace
}  // namespace carom::rigid::test
