// Water: added mass, and what floats in waves and currents.
#include <cmath>

#include "carom/forces/added_mass.h"
#include "carom/geometry/hull.h"
#include "tests/rigid/surroundings.h"

namespace surroundings_test {

// A sphere let go under water speeds up by (m − m_w) g/(m + m_w/2): added mass (reference "mechanics", Lamb art. 92).
TEST(AddedMass3, SlowsWhatStartsUnderWater) {
  const double radius = 0.2, volume = 4.0 / 3 * math::pi * radius * radius * radius;
  for (const double density : {300.0, 2700.0}) {
    WorldDef<Dim3> definition;
    definition.gravity = {0, -9.80665f, 0};
    World3 world(definition);
    const BodyId body = ball(world, radius, float(density), {0, -50, 0});
    Buoyancy<Dim3> water;
    water.density = 1000;
    water.added_mass = {0.5f, 0.5f, 0.5f};
    world.add_effector(water).value();
    for (int i = 0; i < 30; ++i) world.step(frame).value();
    const double a = -forces::sinking_acceleration(density * volume, 1000 * volume, 0.5, 9.80665);
    EXPECT_NEAR(state_of(world, body).linear_velocity.y / (30 * double(frame)) / a, 1, 1e-4) << density;
  }
}

// A slender body that moves a little askew is turned broadside (Munk's moment, (A₂ − A₁) u v), and free of friction
// it keeps the energy of body and water.
TEST(AddedMass3, MunkTurnsSlenderBodiesBroadside) {
  World3 world(weightless<Dim3>());
  BodyDef<Dim3> def;
  def.position = {0, -100, 0};
  def.linear_velocity = {3, 0, 0.3f};
  const BodyId body = world.create_body(def).value();
  ShapeDef<Dim3> shape;
  shape.density = 1000;
  world.add_shape(body, geometry::Shape3(geometry::Ellipsoid{{1, 0.25f, 0.25f}}), shape).value();
  const forces::AddedShares shares = forces::ellipsoid_added_mass({1, 0.25, 0.25});
  Buoyancy<Dim3> water;
  water.density = 1000;
  water.added_mass = Vec3f(shares.linear);
  // (m/5)(b² + c²) per displaced kg.
  water.added_inertia = Vec3f(Vec3d{0, shares.angular.y * 1.0625 / 5, shares.angular.z * 1.0625 / 5});
  world.add_effector(water).value();
  const auto energy = [&] {
    const auto s = state_of(world, body);
    const Vec3d u = math::inverse_rotate(Quatd(s.pose.rotation), Vec3d(s.linear_velocity)),
                w = math::inverse_rotate(Quatd(s.pose.rotation), Vec3d(s.angular_velocity));
    const double m = s.mass;
    const Vec3d inertia = m / 5 * Vec3d{0.125, 1.0625, 1.0625} + m * Vec3d(water.added_inertia);
    double e = 0;
    for (int i = 0; i < 3; ++i) e += 0.5 * m * (1 + shares.linear[i]) * u[i] * u[i] + 0.5 * inertia[i] * w[i] * w[i];
    return e;
  };
  const double start = energy();
  double most = 0;
  for (int i = 0; i < 1200; ++i) {
    world.step(1.0f / 240).value();
    const Vec3d axis = math::rotate(Quatd(state_of(world, body).pose.rotation), Vec3d{1, 0, 0});
    const Vec3d way = math::normalize(Vec3d(state_of(world, body).linear_velocity));
    most = std::max(most, std::acos(std::min(1.0, std::abs(math::dot(axis, way)))));
  }
  EXPECT_GT(most, 1.4) << "it came to lie across its way";
  EXPECT_NEAR(energy() / start, 1, 0.03);
}

// A box short against the wave rides on its slope: heave and pitch are those of the surface.
TEST(Surroundings3, BoxRidesALongWave) {
  const auto around = sea_of(2, 8);  // 100 m long
  World3 world({.allow_sleep = false});
  world.add_effector(Surroundings<Dim3>{around}).value();
  Buoyancy<Dim3> water;
  water.linear_drag = 1;
  water.angular_drag = 1;
  world.add_effector(water).value();
  BodyDef<Dim3> def;
  const BodyId body = world.create_body(def).value();
  ShapeDef<Dim3> shape;
  shape.density = 512.5f;
  world.add_shape(body, geometry::Shape3(geometry::Box{{2, 0.5f, 2}}), shape).value();
  double worst_height = 0, worst_slope = 0, highest = 0;
  for (int i = 0; i < 60 * 64; ++i) {
    world.step(frame).value();
    if (i < 60 * 24) continue;
    const auto s = state_of(world, body);
    const environment::SeaPoint surface = around->water()->sample(s.pose.position, (i + 1) * double(frame));
    const Vec3d up = math::rotate(Quatd(s.pose.rotation), Vec3d{0, 1, 0});
    worst_height = std::max(worst_height, std::abs(s.pose.position.y - surface.height));
    worst_slope = std::max(worst_slope, std::abs(std::asin(up.x) - std::asin(surface.normal.x)));
    highest = std::max(highest, s.pose.position.y);
  }
  EXPECT_LT(worst_height, 0.06) << "of an amplitude of 1 m";
  EXPECT_LT(worst_slope, 0.012) << "of a slope of .063 rad";
  EXPECT_NEAR(highest, 1, 0.06);
}

// Heave of a box in waves over their length: it follows long ones and hardly feels those shorter than itself.
TEST(Surroundings3, HeaveResponseFallsWithWaveLength) {
  const auto response = [](double length) {
    const double period = std::sqrt(2 * math::pi * length / 9.80665);
    World3 world({.allow_sleep = false});
    const auto around = sea_of(0.2, period);
    world.add_effector(Surroundings<Dim3>{around}).value();
    Buoyancy<Dim3> water;
    water.linear_drag = 1;
    water.angular_drag = 1;
    world.add_effector(water).value();
    BodyDef<Dim3> def;
    def.position = {0, 0, 0};
    const BodyId body = world.create_body(def).value();
    ShapeDef<Dim3> shape;
    shape.density = 512.5f;
    world.add_shape(body, geometry::Shape3(geometry::Box{{5, 1, 5}}), shape).value();
    double low = 1e9, high = -1e9;
    const int settle = int(40 / double(frame)), steps = settle + int(4 * period / double(frame));
    for (int i = 0; i < steps; ++i) {
      world.step(frame).value();
      const double y = state_of(world, body).pose.position.y;
      if (i >= settle) low = std::min(low, y), high = std::max(high, y);
    }
    return (high - low) / 0.2;
  };
  EXPECT_NEAR(response(300), 1, 0.05);
  EXPECT_NEAR(response(100), 1, 0.12);
  EXPECT_LT(response(10), 0.12) << "a wave as long as the box lifts one half of it and lowers the other";
  EXPECT_LT(response(4), 0.1);
}

// A hull's corners have a depth each: one as long as the wave, bow and stern on crests, floats as deep as the integral
// over its bottom says, and it agrees with a box, which is cut into pieces, of the same form.
TEST(Surroundings3, HullsFeelTheSurfaceAlongThem) {
  const auto around = sea_of(1, std::sqrt(2 * math::pi * 40 / 9.80665));
  const auto heave = [&](bool as_hull) {
    World3 world({.allow_sleep = false});
    world.add_effector(Surroundings<Dim3>{around}).value();
    Buoyancy<Dim3> water;
    water.linear_drag = 1.5;
    water.angular_drag = 1.5;
    world.add_effector(water).value();
    const BodyId body = world.create_body({}).value();
    ShapeDef<Dim3> shape;
    shape.density = 512.5f;
    std::vector<Vec3f> corners;
    for (int i = 0; i <= 10; ++i)
      for (const float y : {-0.75f, 0.75f})
        for (const float z : {-3.0f, 3.0f}) corners.push_back({-8 + 1.6f * float(i), y * (i % 10 ? 1 : 0.98f), z});
    if (as_hull)
      world.add_shape(body, geometry::Shape3(geometry::make_hull(corners).value()), shape).value();
    else
      world.add_shape(body, geometry::Shape3(geometry::Box{{8, 0.75f, 3}}), shape).value();
    double low = 1e9, high = -1e9, lean = 0;
    for (int i = 0; i < 60 * 60; ++i) {
      world.step(frame).value();
      if (i < 60 * 35) continue;
      const auto s = state_of(world, body);
      low = std::min(low, s.pose.position.y), high = std::max(high, s.pose.position.y);
      lean = std::max(lean, std::abs(math::rotate(Quatd(s.pose.rotation), Vec3d{1, 0, 0}).y));
    }
    return std::pair{high - low, lean};
  };
  const auto box = heave(false), hull = heave(true);
  EXPECT_GT(box.first, 0.3);
  EXPECT_NEAR(hull.first / box.first, 1, 0.1);
  EXPECT_NEAR(hull.second / box.second, 1, 0.1);
}

// What floats goes with the current, and round with the waves' water.
TEST(Surroundings3, FloatsGoWithTheCurrent) {
  Environment::Definition d;
  d.water = environment::Sea::make({.current = {0.7, 0, -0.3}}).value();
  World3 world({.allow_sleep = false});
  world.add_effector(Surroundings<Dim3>{shared(d)}).value();
  Buoyancy<Dim3> water;
  water.linear_drag = 2;
  water.angular_drag = 2;
  world.add_effector(water).value();
  const BodyId body = ball(world, 0.3, 500);
  for (int i = 0; i < 1200; ++i) world.step(frame).value();
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 0.7, 1e-3);
  EXPECT_NEAR(state_of(world, body).linear_velocity.z, -0.3, 1e-3);
}

}  // namespace surroundings_test
