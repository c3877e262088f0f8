// Ropes against ropes and against themselves.
#include <gtest/gtest.h>

#include "carom/geometry/shape3.h"
#include "carom/math/elementary.h"
#include "carom/particles/rope.h"

namespace rope_crossing_test {
using namespace carom;
using math::Vec3d;
using namespace carom::particles;
using rigid::Dim3;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

const RopeMaterial cord{.mass_per_length = 0.1,
                        .radius = 0.01,
                        .axial_stiffness = 1e5,
                        .axial_damping = 100,
                        .friction = 0.3,
                        .drag_coefficient = 0,
                        .skin_coefficient = 0};

int lay(RopeSet& ropes, Vec3d a, Vec3d b, int segments, RopeTouch touch = RopeTouch::others,
        const RopeMaterial& material = cord) {
  const Vec3d points[] = {a, b};
  return ropes.add({.material = material, .points = points, .segments = segments, .touch = touch}).value();
}
World3 weightless() {
  rigid::WorldDef<Dim3> def;
  def.gravity = {};
  return World3(def);
}
/// The least distance between the lines of two ropes.
double nearest(const RopeSet& ropes, int one, int other, int skip = 0) {
  const auto p = ropes.positions(one), q = ropes.positions(other);
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < p.size(); ++i)
    for (std::size_t j = one == other ? i + std::size_t(skip) : 0; j + 1 < q.size(); ++j)
      for (int a = 0; a <= 10; ++a)
        for (int b = 0; b <= 10; ++b)
          least =
              math::min(least, distance(math::lerp(p[i], p[i + 1], a / 10.0), math::lerp(q[j], q[j + 1], b / 10.0)));
  return least;
}
Vec3d spin_about_origin(const RopeSet& ropes) {
  Vec3d sum{};
  for (int r = 0; r < ropes.size(); ++r) {
    const auto x = ropes.positions(r), v = ropes.velocities(r);
    const double m = ropes.mass(r) / double(x.size() - 1);
    for (std::size_t i = 0; i < x.size(); ++i) sum += (i == 0 || i + 1 == x.size() ? 0.5 * m : m) * cross(x[i], v[i]);
  }
  return sum;
}

TEST(RopeCrossings, ARopeThrownOverATautOneRestsOnIt) {
  RopeMaterial soft = cord;
  soft.axial_stiffness = 2e4;
  soft.axial_damping = 200;
  soft.bending_stiffness = 1e-3;
  soft.bending_damping = 0.05;
  soft.friction = 0.5;
  soft.drag_coefficient = 1.2;
  World3 world;
  RopeSet ropes;
  const int line = lay(ropes, {-1, 0, 0}, {1, 0, 0}, 20, RopeTouch::others, soft);
  ropes.attach(line, {.node = 0, .point = {-1, 0, 0}}, world).value();
  ropes.attach(line, {.node = -1, .point = {1, 0, 0}}, world).value();
  const int thrown = lay(ropes, {0.03, 0.1, -0.5}, {0.03, 0.1, 0.5}, 25, RopeTouch::others, soft);
  double deepest = 1, borne = 0;
  for (int i = 0; i < 360; ++i) {
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
    if (i % 10 == 0) deepest = math::min(deepest, nearest(ropes, line, thrown));
    if (i >= 240)
      for (const RopeCrossing& c : ropes.crossings()) borne += c.force.y / 120;
  }
  EXPECT_GT(deepest, 0.8 * 0.02);  // the sum of the radii
  EXPECT_LT(ropes.positions(thrown).front().y, -0.4);
  EXPECT_LT(ropes.positions(thrown).back().y, -0.4);
  EXPECT_GT(ropes.positions(thrown).front().y, -0.55);
  EXPECT_NEAR(borne, ropes.mass(thrown) * g, 0.05 * ropes.mass(thrown) * g);
}

TEST(RopeCrossings, HalfATurnRoundARopeHoldsWhatItHoldsRoundABollard) {
  // Euler and Eytelwein: T₁/T₂ = e^{μφ}, 2.566 for μ = 0.3 and half a turn.
  for (const double ratio : {2.3, 2.85}) {
    World3 world;
    RopeSet ropes;
    RopeMaterial bar = cord, thin = cord;
    bar.mass_per_length = 2;
    bar.radius = 0.02;
    bar.axial_stiffness = 1e6;
    bar.axial_damping = 1e3;
    thin.mass_per_length = 0.05;
    thin.axial_stiffness = 2e5;
    thin.axial_damping = 300;
    const int line = lay(ropes, {-0.5, 0, 0}, {0.5, 0, 0}, 21, RopeTouch::others, bar);
    ropes.attach(line, {.node = 0, .point = {-0.5, 0, 0}}, world).value();
    ropes.attach(line, {.node = -1, .point = {0.5, 0, 0}}, world).value();
    const double r = 0.03;
    std::vector<Vec3d> points{{0, -0.4, -r}};
    for (int i = 0; i <= 16; ++i)
      points.push_back({0, r * math::sin(math::pi * i / 16), -r * math::cos(math::pi * i / 16)});
    points.push_back({0, -0.4, r});
    const int over = ropes.add({.material = thin, .points = points, .segments = 80}).value();
    ropes.add_mass(over, 0, ratio).value();
    ropes.add_mass(over, -1, 1).value();
    double at[2] = {0, 0};
    for (int i = 0; i < 75; ++i) {
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
      if (i == 14) at[0] = ropes.positions(over).front().y - ropes.positions(over).back().y;
    }
    at[1] = ropes.positions(over).front().y - ropes.positions(over).back().y;
    if (ratio < 2.566)
      EXPECT_NEAR(at[1], at[0], 0.003) << ratio;
    else
      EXPECT_LT(at[1], at[0] - 0.1) << ratio;
  }
}

TEST(RopeCrossings, NoneOfThemPassesThroughTheOtherAtThirtyMetresASecond) {
  for (const double speed : {2.0, 8.0, 30.0}) {
    World3 world = weightless();
    RopeSet ropes;
    const int line = lay(ropes, {-1, 0, 0}, {1, 0, 0}, 20);
    ropes.attach(line, {.node = 0, .point = {-1, 0, 0}}, world).value();
    ropes.attach(line, {.node = -1, .point = {1, 0, 0}}, world).value();
    const int thrown = lay(ropes, {0.013, 0.3, -0.5}, {0.013, 0.3, 0.5}, 20);
    for (int i = 0; i <= 20; ++i) ropes.set_velocity(thrown, i, {0, -speed, 0}).value();
    double least = 1;
    for (int i = 0; i < 60; ++i) {
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
      least = math::min(least, nearest(ropes, line, thrown));
      // The middles are still on their own sides while they touch.
      if (!ropes.crossings().empty()) {
        EXPECT_GT(ropes.positions(thrown)[10].y, ropes.positions(line)[10].y) << speed << " m/s, step " << i;
      }
    }
    EXPECT_GT(least, 0.7 * 0.02) << speed << " m/s";
  }
}

TEST(RopeCrossings, TwoFlyingRopesKeepTheirMomentumAndGainNoEnergy) {
  World3 world = weightless();
  RopeSet ropes;
  ropes.set_air({.density = 0});
  RopeMaterial slick = cord;
  slick.friction = 0;  // friction acts at the lines, two centimetres apart
  const int one = lay(ropes, {-0.4, 0, 0}, {0.6, 0, 0}, 15, RopeTouch::others, slick);
  const int other = lay(ropes, {0, 0.2, -0.6}, {0.1, 0.25, 0.4}, 15, RopeTouch::others, slick);
  for (int i = 0; i <= 15; ++i) ropes.set_velocity(other, i, {0.5, -5, 0}).value();
  const Vec3d before = ropes.momentum(), spin = spin_about_origin(ropes);
  const double energy = ropes.kinetic_energy();
  bool met = false;
  for (int i = 0; i < 60; ++i) {
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
    met |= !ropes.crossings().empty();
    EXPECT_LT(ropes.kinetic_energy(), energy * 1.0001);
  }
  EXPECT_TRUE(met);
  EXPECT_LT(length(ropes.momentum() - before), 1e-7 * length(before));
  EXPECT_GT(length(ropes.velocities(one)[8]), 0.5);
  // Pushes go through the lines of both; what very taut segments take as the direction of their end costs the rest.
  EXPECT_LT(length(spin_about_origin(ropes) - spin), 0.03 * length(spin));
}

TEST(RopeCrossings, BodiesOnTheRopesTakePartInThePush) {
  // Two ropes with heavy ends cross at right angles: at first the light ropes, then the masses feel it. All momentum is
  // that of ropes and bodies together.
  World3 world = weightless();
  RopeSet ropes;
  ropes.set_air({.density = 0});
  rigid::BodyId ends[4];
  double mass = 0;
  for (int r = 0; r < 2; ++r) {
    const Vec3d middle{0, r * 0.1, 0}, half = r == 0 ? Vec3d{0.5, 0, 0} : Vec3d{0, 0, 0.5};
    lay(ropes, middle - half, middle + half, 10);
    for (int k = 0; k < 2; ++k) {
      rigid::BodyDef<Dim3> def;
      def.position = k == 0 ? middle - half : middle + half;
      def.linear_velocity = r == 0 ? math::Vec3f{} : math::Vec3f{0, -2, 0};
      rigid::BodyId& body = ends[2 * r + k] = world.create_body(def).value();
      world.set_mass_properties(body, {2.0, {}, math::Mat3d::diagonal({.01, .01, .01})}).value();
      ropes.attach(r, {.node = k == 0 ? 0 : -1, .body = body}, world).value();
      mass += 2;
    }
    for (int i = 0; i <= 10; ++i) ropes.set_velocity(r, i, {0, r == 0 ? 0.0 : -2.0, 0}).value();
  }
  const auto momentum = [&] {
    Vec3d sum = ropes.momentum();
    for (const rigid::BodyId body : ends) sum += 2.0 * Vec3d(world.state(body)->linear_velocity);
    return sum;
  };
  const Vec3d before = momentum();
  double least = 1;
  for (int i = 0; i < 40; ++i) {
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
    least = math::min(least, nearest(ropes, 0, 1));
  }
  EXPECT_GT(least, 0.8 * 0.02);
  EXPECT_LT(length(momentum() - before), 2e-4 * length(before));
  EXPECT_LT(world.state(ends[0])->linear_velocity.y, -0.3f);  // drawn along
  EXPECT_GT(world.state(ends[2])->linear_velocity.y, -1.9f);
}

TEST(RopeCrossings, ARopeThatTouchesItselfPilesUpWhereOneThatDoesNotLiesFlat) {
  double heights[2];
  for (int k = 0; k < 2; ++k) {
    World3 world;
    world.add_shape(world.create_body({.type = rigid::BodyType::fixed}).value(), geometry::Plane{}).value();
    RopeSet ropes;
    const Vec3d points[] = {{0, 0.03, 0}, {0.01, 1.03, 0.005}};
    const int rope = ropes
                         .add({.material = {.mass_per_length = 0.1,
                                            .radius = 0.01,
                                            .axial_stiffness = 2e4,
                                            .axial_damping = 50,
                                            .bending_stiffness = 2e-4,
                                            .bending_damping = 0.02},
                               .points = points,
                               .segments = 40,
                               .touch = k == 0 ? RopeTouch::others : RopeTouch::itself})
                         .value();
    for (int i = 0; i < 120; ++i) {
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
    }
    double sum = 0;
    for (const Vec3d p : ropes.positions(rope)) sum += p.y;
    heights[k] = sum / 41;
    if (k == 1) {
      EXPECT_GT(nearest(ropes, rope, rope, 4), 0.7 * 0.02);
      EXPECT_FALSE(ropes.crossings().empty());
    }
  }
  EXPECT_LT(heights[0], 0.0115);  // all on the ground
  EXPECT_GT(heights[1], 1.2 * heights[0]);
}

TEST(RopeCrossings, FiltersAndWishesKeepRopesApart) {
  for (int k = 0; k < 3; ++k) {
    World3 world = weightless();
    RopeSet ropes;
    const Vec3d a[] = {{-0.5, 0, 0}, {0.5, 0, 0}}, b[] = {{0, 0.1, -0.5}, {0, 0.1, 0.5}};
    rigid::Filter filter;
    if (k == 1) filter.group = -3;
    ropes.add({.material = cord, .points = a, .segments = 8, .filter = filter}).value();
    const int thrown = ropes
                           .add({.material = cord,
                                 .points = b,
                                 .segments = 8,
                                 .touch = k == 0 ? RopeTouch::none : RopeTouch::others,
                                 .filter = filter})
                           .value();
    for (int i = 0; i <= 8; ++i) ropes.set_velocity(thrown, i, {0, -1, 0}).value();
    for (int i = 0; i < 30; ++i) ropes.step(world, dt).value();
    if (k < 2)
      EXPECT_NEAR(ropes.positions(thrown)[4].y, -0.4, 1e-9);
    else
      EXPECT_GT(ropes.positions(thrown)[4].y, -0.38);
  }
}

TEST(RopeCrossings, ACopyGoesOnWithTheSameBits) {
  World3 world;
  RopeSet ropes;
  const int line = lay(ropes, {-1, 0, 0}, {1, 0, 0}, 20);
  ropes.attach(line, {.node = 0, .point = {-1, 0, 0}}, world).value();
  ropes.attach(line, {.node = -1, .point = {1, 0, 0}}, world).value();
  lay(ropes, {0.03, 0.03, -0.5}, {0.03, 0.03, 0.5}, 24);
  for (int i = 0; i < 30; ++i) ropes.step(world, dt).value();
  ASSERT_FALSE(ropes.crossings().empty());
  RopeSet copy = ropes;
  for (int i = 0; i < 30; ++i) {
    ropes.step(world, dt).value();
    copy.step(world, dt).value();
  }
  EXPECT_EQ(ropes.state_hash(), copy.state_hash());
}

}  // namespace rope_crossing_test
