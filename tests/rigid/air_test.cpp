// Wind and air: drag by the flow, lift of spin, attitude.
#include <cmath>

#include "carom/forces/drag.h"
#include "tests/rigid/surroundings.h"

namespace surroundings_test {

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

}  // namespace surroundings_test
