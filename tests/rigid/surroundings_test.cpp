// What a world has around it: one environment object, turning frames, charges in fields, drag by the flow, added mass.
#include <cmath>
#include <limits>

#include "carom/environment/environment.h"
#include "carom/forces/added_mass.h"
#include "carom/forces/drag.h"
#include "carom/rigid/snapshot.h"
#include "tests/rigid/mechanics_world.h"

namespace surroundings_test {
using namespace carom::rigid;
using namespace carom::rigid::test;
using namespace carom;
using environment::Environment;

constexpr float frame = 1.0f / 60;

std::shared_ptr<const Environment> shared(Environment::Definition definition) {
  return std::make_shared<const Environment>(Environment::make(std::move(definition)).value());
}
template <class D>
BodyState<D> state_of(const World<D>& world, BodyId body) {
  return world.state(body).value();
}
BodyId ball(World3& world, double radius, float density, Vec3d position = {}, Vec3f velocity = {}) {
  BodyDef<Dim3> def;
  def.position = position;
  def.linear_velocity = velocity;
  const BodyId body = world.create_body(def).value();
  ShapeDef<Dim3> shape;
  shape.density = density;
  world.add_shape(body, geometry::Shape3(geometry::Sphere{float(radius)}), shape).value();
  return body;
}

// --- charges --------------------------------------------------------------------------------------------------------

template <class D>
class Charge : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Charge, Dimensions);

// A charge in B = .5 T along z: r = m v/(q B), ω = q B/m. The circle is exact; in time the turn of a step is
// 2 atan(ω dt/2).
TYPED_TEST(Charge, CirclesWithItsRadius) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> def;
  def.linear_velocity = vec<D>(4, 0);
  const BodyId body = add_mass(world, def, 2, 1);
  ElectromagneticField<D> field;
  field.body = body;
  field.charge = 3;
  field.magnetic = {0, 0, 0.5f};
  world.add_effector(field).value();
  const double omega = 3 * 0.5 / 2, radius = 4 / omega;
  double turned_by = 0;
  for (int i = 0; i < 3600; ++i) {
    world.step(frame).value();
    const auto s = state_of(world, body);
    // Seen against B it turns clockwise, about (0, −r).
    ASSERT_NEAR(std::hypot(s.pose.position.x, s.pose.position.y + radius), radius, 1e-4 * radius) << i;
    ASSERT_NEAR(math::length(s.linear_velocity), 4, 1e-4);
    turned_by += 2 * std::atan(0.5 * omega * double(frame));
  }
  const auto v = state_of(world, body).linear_velocity;
  EXPECT_NEAR(v.x, 4 * std::cos(turned_by), 4e-3);
  EXPECT_NEAR(v.y, -4 * std::sin(turned_by), 4e-3);
  EXPECT_NEAR(turned_by / (omega * 60), 1, 2e-5) << "the cyclotron frequency q B/m";
}

// E × B drift: whatever its charge and mass, a charge drifts at E/B across both fields.
TYPED_TEST(Charge, DriftsAcrossBothFields) {
  using D = TypeParam;
  for (const double charge : {2.0, -5.0}) {
    World<D> world(weightless<D>());
    const BodyId body = add_mass(world, BodyDef<D>{}, 0.25, 1);
    ElectromagneticField<D> field;
    field.charge = charge;
    field.electric = vec<D>(0, 6);
    field.magnetic = {0, 0, 2};
    world.add_effector(field).value();
    const double period = 2 * math::pi * 0.25 / (2 * std::abs(charge));
    const int steps = int(50 * period / double(frame));
    for (int i = 0; i < steps; ++i) world.step(frame).value();
    const auto p = state_of(world, body).pose.position;
    EXPECT_NEAR(p.x / (steps * double(frame)), 3, 0.03) << "E/B, along E × B";
    EXPECT_LT(std::abs(p.y), 2 * 3 * period / (2 * math::pi) + 0.01) << "no further than a cycloid";
  }
}

// --- frames that turn -----------------------------------------------------------------------------------------------

// Reference "ballistics and sports" 2.4: dropped from 100 m at the equator a body lands 21.95 mm to the east.
TEST(TurningFrame3, DroppedBodyDriftsEast) {
  for (const bool by_surroundings : {false, true}) {
    WorldDef<Dim3> definition;
    definition.gravity = {0, -9.80665f, 0};
    World3 world(definition);
    const Vec3d rate = environment::earth_rate(0);  // x east, y up, z south
    EXPECT_NEAR(math::distance(rate, Vec3d{0, 0, -7.292115e-5}), 0, 1e-18);
    if (by_surroundings) {
      Environment::Definition d;
      d.frame.rate = rate;
      world.add_effector(Surroundings<Dim3>{shared(d)}).value();
    } else {
      TurningFrame<Dim3> turning;
      turning.rate = Vec3f(rate);
      world.add_effector(turning).value();
    }
    BodyDef<Dim3> def;
    def.position = {0, 100, 0};
    const BodyId body = add_mass(world, def, 1, 1);
    Vec3d before{}, after{0, 100, 0};
    while (after.y > 0) {
      before = after;
      world.step(frame).value();
      after = state_of(world, body).pose.position;
    }
    const double east = before.x + (after.x - before.x) * before.y / (before.y - after.y);
    EXPECT_NEAR(east * 1000, 21.95, 0.03);
    EXPECT_NEAR(after.z, 0, 1e-6);
  }
}

// Thrown up at v it lands 4/3 Ω cos φ v³/g² to the west (first order).
TEST(TurningFrame3, ThrownUpItLandsWest) {
  WorldDef<Dim3> definition;
  definition.gravity = {0, -9.80665f, 0};
  World3 world(definition);
  TurningFrame<Dim3> turning;
  turning.rate = Vec3f(environment::earth_rate(math::pi / 4));
  world.add_effector(turning).value();
  BodyDef<Dim3> def;
  def.linear_velocity = {0, 80, 0};
  const BodyId body = add_mass(world, def, 1, 1);
  Vec3d before{}, after{0, 1, 0};
  while (after.y > 0) {
    before = after;
    world.step(frame).value();
    after = state_of(world, body).pose.position;
  }
  const double east = before.x + (after.x - before.x) * before.y / (before.y - after.y);
  const double expected = -4.0 / 3 * 7.292115e-5 * std::cos(math::pi / 4) * 80 * 80 * 80 / (9.80665 * 9.80665);
  EXPECT_NEAR(east / expected, 1, 0.005);
}

// With both forces the frame's motion is straight motion seen from it.
TYPED_TEST(Charge, FreeMotionIsStraightSeenFromOutside) {
  using D = TypeParam;
  const double rate = 0.8;
  World<D> world(weightless<D>());
  TurningFrame<D> turning;
  turning.rate = about_z<D>(float(rate));
  turning.center = pos<D>(1, 0);
  turning.centrifugal = true;
  world.add_effector(turning).value();
  // At rest outside at (3, 1): in the frame it starts with −Ω × r.
  BodyDef<D> def;
  def.position = pos<D>(3, 1);
  def.linear_velocity = vec<D>(float(rate * 1), float(-rate * 2));
  const BodyId body = add_mass(world, def, 5, 1);
  for (int i = 1; i <= 600; ++i) {
    world.step(frame).value();
    const double a = -rate * i * double(frame);
    const auto p = state_of(world, body).pose.position;
    ASSERT_NEAR(p.x, 1 + 2 * std::cos(a) - std::sin(a), 0.02) << i;
    ASSERT_NEAR(p.y, 2 * std::sin(a) + std::cos(a), 0.02) << i;
  }
}

// --- gravity of the surroundings ------------------------------------------------------------------------------------

// Spherical and oblate fields hold a satellite: the oblate one turns its node as theory says (first order in J₂).
TEST(Surroundings3, OblateEarthTurnsTheOrbit) {
  WorldDef<Dim3> definition = weightless<Dim3>();
  definition.maximum_linear_speed = 2e4f;
  World3 world(definition);
  Environment::Definition d;
  d.gravity.kind = environment::GravityField::Kind::oblate;
  d.gravity.axis = {0, 1, 0};
  d.vacuum = true;
  world.add_effector(Surroundings<Dim3>{shared(d)}).value();
  const double a = 7178137, inclination = 0.9, speed = std::sqrt(environment::earth_gm / a);
  BodyDef<Dim3> def;
  def.position = {a, 0, 0};
  // The node lies along x; the pole along y, so that the equator's other axis is −z.
  def.linear_velocity = Vec3f(Vec3d{0, speed * std::sin(inclination), -speed * std::cos(inclination)});
  const BodyId body = add_mass(world, def, 1000, 1);
  const auto node = [&] {
    const auto s = state_of(world, body);
    const Vec3d h = math::cross(s.pose.position, Vec3d(s.linear_velocity));
    return std::atan2(-h.x, -h.z);  // of the ascending node from x toward −z … by the momentum's own azimuth
  };
  const double before = node();
  const double period = 2 * math::pi * std::sqrt(a * a * a / environment::earth_gm);
  const int steps = int(4 * period);
  for (int i = 0; i < steps; ++i) world.step(1.0f).value();
  const double expected = environment::nodal_regression({}, a, 0, inclination) * steps;
  EXPECT_NEAR(std::abs(node() - before) / std::abs(expected), 1, 0.05);
  EXPECT_NEAR(math::length(state_of(world, body).pose.position) / a, 1, 0.003);
}

// --- wind and air ---------------------------------------------------------------------------------------------------

TEST(Surroundings3, DragFeelsTheWindOfThePlace) {
  World3 world(weightless<Dim3>());
  Environment::Definition d;
  d.wind.layers = {{0, {4, 0, 0}}, {10, {8, 0, 0}}};
  world.add_effector(Surroundings<Dim3>{shared(d)}).value();
  LinearDrag<Dim3> drag;
  drag.coefficient = 5;
  world.add_effector(drag).value();
  world.add_effector(Wind<Dim3>{{0, 0, 1}}).value();
  BodyDef<Dim3> low, high;
  low.position = {0, 5, 0};
  high.position = {0, 50, 0};
  const BodyId a = add_mass(world, low, 1, 1), b = add_mass(world, high, 1, 1);
  for (int i = 0; i < 600; ++i) world.step(frame).value();
  EXPECT_NEAR(state_of(world, a).linear_velocity.x, 6, 1e-3);
  EXPECT_NEAR(state_of(world, b).linear_velocity.x, 8, 1e-3);
  EXPECT_NEAR(state_of(world, b).linear_velocity.z, 1, 1e-3) << "beside the wind that is everywhere alike";
}

// Terminal speed where drag by the Reynolds number balances weight, on either side of the drag crisis.
TEST(BodyDrag3, FallsAtTheSpeedOfItsReynoldsNumber) {
  for (const double density : {30.0, 5000.0}) {
    WorldDef<Dim3> definition;
    definition.gravity = {0, -9.80665f, 0};
    World3 world(definition);
    const double radius = 0.06, area = math::pi * radius * radius;
    const BodyId body = ball(world, radius, float(density));
    BodyDrag<Dim3> drag;
    drag.diameter = 2 * radius;
    drag.area = area;
    world.add_effector(drag).value();
    for (int i = 0; i < 3000; ++i) world.step(frame).value();
    const double v = -double(state_of(world, body).linear_velocity.y), m = double(state_of(world, body).mass);
    const double re = forces::reynolds_number(1.225, v, 2 * radius, 1.7894e-5);
    const double mach = v / 340.294;
    const double weight = m * 9.80665, force = 0.5 * 1.225 * area * forces::sphere_drag(re, mach) * v * v;
    EXPECT_NEAR(force / weight, 1, 2e-3) << "Re " << re;
    if (density > 1000)
      EXPECT_GT(re, 4e5) << "beyond the crisis";
    else
      EXPECT_LT(re, 2.5e5);
  }
}

// In thinner air it falls faster: the surroundings' density at its height counts.
TEST(BodyDrag3, TakesTheAirOfItsHeight) {
  WorldDef<Dim3> definition;
  definition.gravity = {0, -9.80665f, 0};
  World3 world(definition);
  Environment::Definition d;
  world.add_effector(Surroundings<Dim3>{shared(d)}).value();
  BodyDrag<Dim3> drag;
  drag.law.kind = forces::DragLaw::Kind::constant;
  drag.law.coefficient = 1;
  drag.area = 0.7;
  world.add_effector(drag).value();
  BodyDef<Dim3> def;
  def.position = {0, 11000, 0};
  const BodyId body = add_mass(world, def, 80, 1);
  for (int i = 0; i < 1500; ++i) world.step(frame).value();
  const auto s = state_of(world, body);
  const double rho = environment::standard_atmosphere(s.pose.position.y).density;
  const double v = std::sqrt(2 * 80 * 9.80665 / (rho * 0.7));
  EXPECT_NEAR(-s.linear_velocity.y / v, 1, 0.02) << "and slows down as the air thickens";
}

// Baseball r 36.6 mm, 30 rev/s, 40 m/s: C_L = 1/(2.32 + .4/S) = .2156, .889 N (reference "mechanics" 6.3).
TEST(MagnusLift3, LiftsASpinningBall) {
  World3 world(weightless<Dim3>());
  BodyDef<Dim3> def;
  def.linear_velocity = {40, 0, 0};
  def.angular_velocity = {0, 0, float(60 * math::pi)};
  const BodyId body = add_mass(world, def, 0.145, 1e-4);
  MagnusLift<Dim3> lift;
  lift.radius = 0.0366;
  world.add_effector(lift).value();
  world.step(frame).value();
  EXPECT_NEAR(state_of(world, body).linear_velocity.y * 0.145 / double(frame), 0.889, 2e-3);
}

// --- attitude --------------------------------------------------------------------------------------------------------

// A wing of 1 m² that may not turn, let go: it glides where lift and drag carry its weight, tan γ = C_D/C_L at the
// angle of attack that its fixed attitude makes with the way, in the plane as in space.
template <class D>
class Attitude : public testing::Test {};
TYPED_TEST_SUITE(Attitude, Dimensions);

TYPED_TEST(Attitude, AWingGlidesAtItsRatioOfDragToLift) {
  using D = TypeParam;
  WorldDef<D> definition = weightless<D>();
  definition.gravity = vec<D>(0, -9.80665f);
  World<D> world(definition);
  BodyDef<D> def;
  def.linear_velocity = vec<D>(14, -1);
  const BodyId body = add_mass(world, def, 8, 1e12);  // as good as never turned
  LiftingSurface<D> wing;
  wing.body = body;
  wing.law.aspect_ratio = 10;
  world.add_effector(wing).value();
  for (int i = 0; i < 12000; ++i) world.step(frame).value();
  const auto v = state_of(world, body).linear_velocity;
  const double angle = std::atan2(-double(v.y), double(v.x));  // the wing lies level: attack is the angle of descent
  const forces::LiftAndDrag c = forces::lift_and_drag(wing.law, angle);
  EXPECT_NEAR(std::tan(angle), c.drag / c.lift, 1e-3);
  const double speed = std::hypot(double(v.x), double(v.y));
  const double force = 0.5 * 1.225 * speed * speed * std::hypot(c.lift, c.drag);
  EXPECT_NEAR(force / (8 * 9.80665), 1, 2e-3);
  EXPECT_LT(angle, 0.15) << "it is a glider";
}

// Across the flow a mast has the drag of its Reynolds number; along it hardly any.
TYPED_TEST(Attitude, ACylinderFallsBySides) {
  using D = TypeParam;
  double speed[2];
  for (const bool upright : {false, true}) {
    WorldDef<D> definition = weightless<D>();
    definition.gravity = vec<D>(0, -9.80665f);
    World<D> world(definition);
    const BodyId body = add_mass(world, BodyDef<D>{}, 0.2, 1e9);
    CylinderDrag<D> drag;
    drag.body = body;
    drag.diameter = 0.02;
    drag.length = 1.5;
    drag.axis = upright ? vec<D>(0, 1) : vec<D>(1, 0);
    world.add_effector(drag).value();
    for (int i = 0; i < 6000; ++i) world.step(frame).value();
    const double v = -double(state_of(world, body).linear_velocity.y);
    const math::Vec3d axis = upright ? math::Vec3d{0, 1, 0} : math::Vec3d{1, 0, 0};
    EXPECT_NEAR(forces::cylinder_force(1.225, 1.7894e-5, 0.02, 1.5, axis, {0, -v, 0}).y / (0.2 * 9.80665), 1, 2e-3);
    speed[upright] = v;
  }
  EXPECT_GT(speed[1], 5 * speed[0]);
}

// A plate that the wind meets behind its pivot turns into it and stays; its motion dies down (the three-quarter chord).
TEST(Attitude3, AWeathervaneTurnsIntoTheWind) {
  World3 world(weightless<Dim3>());
  BodyDef<Dim3> def;
  def.type = BodyType::fixed;
  const BodyId post = world.create_body(def).value();
  def.type = BodyType::dynamic;
  def.rotation = {float(std::cos(0.4)), 0, float(std::sin(0.4)), 0};
  const BodyId vane = add_mass(world, def, 1, 0.05);
  HingeJointDef<Dim3> hinge;
  hinge.body_a = post;
  hinge.body_b = vane;
  hinge.frame_a.q = hinge.frame_b.q = {float(std::sqrt(0.5)), float(-std::sqrt(0.5)), 0, 0};  // z upright
  world.create_joint(hinge).value();
  world.add_effector(Wind<Dim3>{{-8, 0, 0}}).value();  // it comes from +x
  LiftingSurface<Dim3> fin;
  fin.body = vane;
  fin.law = forces::flat_plate(1);
  fin.point = {-0.6f, 0, 0};
  fin.up = {0, 0, 1};
  fin.area = 0.09;
  fin.chord = 0.3;
  world.add_effector(fin).value();
  double early = 0, late = 0;
  for (int i = 0; i < 900; ++i) {
    world.step(frame).value();
    const auto q = state_of(world, vane).pose.rotation;
    const double yaw = std::abs(2 * std::atan2(double(q.y), double(q.w)));
    (i < 200 ? early : late) = std::max(i == 700 ? 0.0 : (i < 200 ? early : late), yaw);
  }
  EXPECT_GT(early, 0.5);
  EXPECT_LT(late, 0.02);
}

// However light and large, a plate in the wind is only carried along.
TYPED_TEST(Attitude, ALeafIsStable) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId leaf = add_mass(world, BodyDef<D>{}, 1e-3, 1e-4);
  world.add_effector(Wind<D>{vec<D>(5, 12)}).value();
  LiftingSurface<D> plate;
  plate.body = leaf;
  plate.law = forces::flat_plate(1);
  plate.area = 0.5;
  plate.chord = 0.7;
  world.add_effector(plate).value();
  for (int i = 0; i < 2000; ++i) {
    world.step(frame).value();
    const auto v = state_of(world, leaf).linear_velocity;
    ASSERT_LT(std::hypot(double(v.x), double(v.y)), 40);
  }
}

TYPED_TEST(Attitude, BadInputIsNamed) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, BodyDef<D>{}, 1, 1);
  const auto message = [&](const EffectorDef<D>& e) {
    const auto made = world.add_effector(e);
    return made.ok() ? std::string() : made.error().message;
  };
  LiftingSurface<D> wing;
  EXPECT_NE(message(wing).find("body"), std::string::npos) << "it is fixed to one";
  wing.body = body;
  EXPECT_EQ(message(wing), "");
  wing.forward = {};
  EXPECT_NE(message(wing).find("forward is zero"), std::string::npos);
  wing = {};
  wing.body = body;
  wing.law.aspect_ratio = -1;
  EXPECT_NE(message(wing).find("aspect_ratio"), std::string::npos);
  CylinderDrag<D> pole;
  pole.body = body;
  pole.diameter = 0;
  EXPECT_NE(message(pole).find("diameter"), std::string::npos);
}

// --- water ----------------------------------------------------------------------------------------------------------

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

std::shared_ptr<const Environment> sea_of(double height, double period, double direction = 0) {
  const environment::WaveComponent wave = environment::regular_wave(height, period, direction);
  Environment::Definition d;
  d.water = environment::Sea::make({}, {&wave, 1}).value();
  return shared(d);
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
  const environment::WaveComponent wave = environment::regular_wave(1, std::sqrt(2 * math::pi * 40 / 9.80665));
  Environment::Definition d;
  d.water = environment::Sea::make({}, {&wave, 1}).value();
  const auto around = shared(d);
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

// --- input, snapshots -----------------------------------------------------------------------------------------------

TEST(Surroundings3, RefusesBadInput) {
  World3 world;
  const auto message = [&](const EffectorDef<Dim3>& e) {
    const auto id = world.add_effector(e);
    return id.ok() ? std::string("accepted") : id.error().message;
  };
  EXPECT_NE(message(Surroundings<Dim3>{}).find("environment is null"), std::string::npos);
  BodyDrag<Dim3> drag;
  drag.law.kind = forces::DragLaw::Kind::by_mach;
  EXPECT_NE(message(drag).find("table: found 0 points"), std::string::npos);
  drag.law.table = forces::CoefficientTable({{0, 0}, {0, 0}});
  EXPECT_NE(message(drag).find("x[1] is 0"), std::string::npos);
  drag = {};
  drag.diameter = 0;
  EXPECT_NE(message(drag).find("diameter"), std::string::npos);
  MagnusLift<Dim3> lift;
  lift.radius = -1;
  EXPECT_NE(message(lift).find("radius"), std::string::npos);
  ElectromagneticField<Dim3> field;
  field.magnetic.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message(field).find("magnetic"), std::string::npos);
  TurningFrame<Dim3> turning;
  turning.rate.z = std::numeric_limits<float>::infinity();
  EXPECT_NE(message(turning).find("rate"), std::string::npos);
  Buoyancy<Dim3> water;
  water.added_mass.y = -1;
  EXPECT_NE(message(water).find("added_mass"), std::string::npos);
}

// Snapshots in memory keep the environment; as bytes they need a world that has one in the same place.
TEST(Surroundings3, Snapshots) {
  const auto build = [](World3& world, bool around) {
    if (around) world.add_effector(Surroundings<Dim3>{sea_of(1, 6)}).value();
    Buoyancy<Dim3> water;
    water.added_mass = {0.5f, 0.5f, 0.5f};
    world.add_effector(water).value();
    BodyDrag<Dim3> drag;
    drag.law.kind = forces::DragLaw::Kind::by_reynolds;
    std::vector<forces::CoefficientPoint> curve;  // as long as measured ones are
    for (int i = 0; i < 84; ++i) curve.push_back({10.0 * (i + 1), 24 / (10.0 * (i + 1)) + 0.4});
    drag.law.table = forces::CoefficientTable(std::move(curve), true);
    world.add_effector(drag).value();
    return ball(world, 0.4, 400, {0, 1, 0});
  };
  World3 a({.allow_sleep = false}), b({.allow_sleep = false});
  const BodyId body = build(a, true);
  build(b, true);
  for (int i = 0; i < 100; ++i) a.step(frame).value();
  const auto taken = a.snapshot();
  const std::vector<std::byte> bytes = taken.encode();
  for (int i = 0; i < 100; ++i) a.step(frame).value();
  const double later = state_of(a, body).pose.position.y;
  ASSERT_TRUE(a.restore(taken).ok());
  for (int i = 0; i < 100; ++i) a.step(frame).value();
  EXPECT_EQ(state_of(a, body).pose.position.y, later);
  const auto decoded = Snapshot<Dim3>::decode(bytes);
  ASSERT_TRUE(decoded.ok());
  ASSERT_TRUE(b.restore(*decoded).ok());
  for (int i = 0; i < 100; ++i) b.step(frame).value();
  std::vector<BodyId> bodies;
  b.bodies(bodies);
  EXPECT_EQ(state_of(b, bodies.at(0)).pose.position.y, later);
  World3 without;
  EXPECT_NE(without.restore(*decoded).error().message.find("surroundings"), std::string::npos);
}

}  // namespace surroundings_test
