// Effectors against closed forms: terminal speed, decay, thrust, fields, orbits, floating.
#include "carom/environment/gravity.h"
#include "carom/forces/drag.h"
#include "carom/geometry/hull.h"
#include "mechanics_world.h"

namespace carom::rigid::test {
namespace effector_test {

template <class D>
class Effectors : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Effectors, Dimensions);

TYPED_TEST(Effectors, LinearDragDecaysExactly) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> def;
  def.linear_velocity = vec<D>(10, 0);
  const BodyId body = add_mass(world, def, 2, 1);
  LinearDrag<D> drag;
  drag.coefficient = 3;
  world.add_effector(drag).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 10 * math::exp(-1.5), 1e-4);
}

TYPED_TEST(Effectors, LinearDragOfAnyStrengthIsStable) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> def;
  def.linear_velocity = vec<D>(10, 0);
  def.angular_velocity = about_z<D>(5);
  const BodyId body = add_mass(world, def, 2, 1);
  LinearDrag<D> drag;
  drag.coefficient = 1e6;
  drag.angular_coefficient = 1e6;
  world.add_effector(drag).value();
  world.step(frame).value();
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 0, 1e-3);
  EXPECT_NEAR(z_of(state_of(world, body).angular_velocity), 0, 1e-3);
}

TYPED_TEST(Effectors, ShipAgainstLinearDragFollowsTheClosedForm) {
  // mechanics.md 4.2: v = T/C − (T/C)e^(−Ct/m).
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId ship = add_mass(world, 0, 0, 10000, 1e4);
  LinearDrag<D> drag;
  drag.body = ship;
  drag.coefficient = 1200;
  world.add_effector(drag).value();
  Thrust<D> screw;
  screw.body = ship;
  screw.force = vec<D>(30000, 0);
  world.add_effector(screw).value();
  for (int i = 0; i < 600; ++i) world.step(frame).value();
  const forces::Run run = forces::thrust_against_linear_drag(10000, 30000, 1200, 0, 10);
  EXPECT_NEAR(state_of(world, ship).linear_velocity.x, run.speed, 1e-4 * run.speed);
  EXPECT_NEAR(state_of(world, ship).pose.position.x, run.distance, 1e-4 * run.distance);
}

TYPED_TEST(Effectors, QuadraticFallFollowsTheClosedForm) {
  using D = TypeParam;
  World<D> world;
  const BodyId ball = add_mass(world, 0, 0, 0.5, 0.01);
  QuadraticDrag<D> air;
  air.drag_coefficient = 0.47;
  air.area = 0.05;
  world.add_effector(air).value();
  const double g = 9.80665, terminal = forces::terminal_speed(0.5, g, 1.225, 0.47, 0.05);
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  const forces::Run run = forces::quadratic_fall(terminal, g, 2);
  EXPECT_NEAR(-state_of(world, ball).linear_velocity.y, run.speed, 1e-3 * run.speed);
  EXPECT_NEAR(-state_of(world, ball).pose.position.y, run.distance, 1e-3 * run.distance);
  for (int i = 0; i < 1200; ++i) world.step(frame).value();
  EXPECT_NEAR(-state_of(world, ball).linear_velocity.y, terminal, 2e-5 * terminal) << "float velocities stop that near";
}

TYPED_TEST(Effectors, WindCarriesWhatDragHolds) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId leaf = add_mass(world, 0, 0, 0.01, 0.001);
  LinearDrag<D> drag;
  drag.coefficient = 0.1;
  world.add_effector(drag).value();
  Wind<D> wind;
  wind.velocity = vec<D>(4, 1);
  world.add_effector(wind).value();
  world.add_effector(wind).value();  // winds add up
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  EXPECT_NEAR(state_of(world, leaf).linear_velocity.x, 8, 1e-3);
  EXPECT_NEAR(state_of(world, leaf).linear_velocity.y, 2, 1e-3);
}

TYPED_TEST(Effectors, ThrustOffTheCentreTurns) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, 0, 0, 2, 0.5);
  Thrust<D> thrust;
  thrust.body = body;
  thrust.point = vec<D>(1, 0);
  thrust.force = vec<D>(0, 0.25f);
  world.add_effector(thrust).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(z_of(state_of(world, body).angular_velocity), 0.5f, 1e-4f) << "N t/I";
}

TYPED_TEST(Effectors, DragHoldsItsPointBack) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> def;
  def.linear_velocity = vec<D>(10, 0);
  const BodyId arrow = add_mass(world, def, 1, 0.2);
  QuadraticDrag<D> fletching;
  fletching.body = arrow;
  fletching.point = vec<D>(-1, 0.1f);
  fletching.area = 0.1;
  world.add_effector(fletching).value();
  world.step(frame).value();
  // F along −x at y = +.1: torque +.1·|F|
  const double force = 0.5 * 1.225 * 0.47 * 0.1 * 100;
  EXPECT_NEAR(z_of(state_of(world, arrow).angular_velocity), 0.1 * force / 0.2 / 60, 0.02 * force / 120);
}

TYPED_TEST(Effectors, OrbitReturnsAfterItsPeriod) {
  // mechanics.md 3.2: a = 6778.137 km, T = 5553.62 s, in full size; float velocities, double positions.
  using D = TypeParam;
  WorldDef<D> definition = weightless<D>();
  definition.maximum_linear_speed = 1e5f;
  definition.substeps = 1;
  World<D> world(definition);
  const double a = 6778137, speed = math::sqrt(environment::earth_gm / a);
  BodyDef<D> def;
  def.position = pos<D>(a, 0);
  def.linear_velocity = vec<D>(0, float(speed));
  const BodyId satellite = add_mass(world, def, 420000, 1e6);
  SphericalGravity<D> earth;
  world.add_effector(earth).value();
  double time = 0, worst = 0;
  Crossings up;
  while (time < 5600) {
    world.step(0.25f).value();
    time += 0.25;
    const auto p = state_of(world, satellite).pose.position;
    up.add(time, p.y);
    worst = math::max(worst, math::abs(math::length(p) - a));
  }
  ASSERT_EQ(up.times.size(), 1u);
  this->RecordProperty("period", std::to_string(up.times[0]));
  this->RecordProperty("radius_error", std::to_string(worst));
  EXPECT_NEAR(up.times[0], 5553.62, 5553.62 * 1e-4);
  EXPECT_LT(worst, 2e-4 * a);
}

TYPED_TEST(Effectors, RadialFieldAndVortex) {
  using D = TypeParam;
  {
    World<D> world(weightless<D>());
    const BodyId body = add_mass(world, 2, 0, 3, 1);
    RadialField<D> field;
    field.strength = -8;
    field.range = 10;
    world.add_effector(field).value();
    const BodyId far = add_mass(world, 20, 0, 3, 1);
    world.step(frame).value();
    EXPECT_NEAR(state_of(world, body).linear_velocity.x, -2.0 / 60, 1e-5) << "8·(2/1)⁻²";
    EXPECT_EQ(state_of(world, far).linear_velocity.x, 0);
  }
  {
    World<D> world(weightless<D>());
    VortexField<D> vortex;
    vortex.circulation = 4 * pi;
    vortex.core_radius = 0.5;
    vortex.rate = 50;
    if constexpr (D::dimension == 3) vortex.axis = {0, 0, 1};
    world.add_effector(vortex).value();
    const BodyId body = add_mass(world, 2, 0, 3, 1);
    for (int i = 0; i < 10; ++i) world.step(frame).value();
    EXPECT_NEAR(math::length(state_of(world, body).linear_velocity), 1.0f, 0.02f) << "Γ/2πr";
    EXPECT_GT(state_of(world, body).linear_velocity.y, 0.9f) << "counterclockwise";
  }
}

TYPED_TEST(Effectors, CustomModelActs) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, 0, 0, 4, 1);
  CustomEffector<D> custom;
  custom.body = body;
  custom.model = [](const EffectorInput<D>& input) {
    Wrench<D> out;
    out.force = vec<D>(input.state.mass * 2, 0);
    out.torque = about_z<D>(3);
    return out;
  };
  world.add_effector(custom).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 2, 1e-4);
  EXPECT_NEAR(z_of(state_of(world, body).angular_velocity), 3, 1e-4);
}

TYPED_TEST(Effectors, EffectorsOfADestroyedBodyGo) {
  using D = TypeParam;
  World<D> world;
  const BodyId a = add_mass(world, 0, 0, 1, 1), b = add_mass(world, 3, 0, 1, 1);
  Thrust<D> thrust;
  thrust.body = a;
  const EffectorId pushed = world.add_effector(thrust).value();
  SpringDamper<D> spring;
  spring.body_a = a;
  spring.body_b = b;
  const EffectorId tied = world.add_effector(spring).value();
  const EffectorId wind = world.add_effector(Wind<D>{}).value();
  world.step(frame).value();
  world.destroy_body(a).value();
  EXPECT_FALSE(world.effector_definition(pushed).ok());
  EXPECT_FALSE(world.effector_definition(tied).ok());
  std::vector<EffectorId> left;
  world.effectors(left);
  EXPECT_EQ(left, std::vector<EffectorId>{wind});
  world.step(frame).value();
}

TYPED_TEST(Effectors, SettingAnEffectorTakesEffect) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, 0, 0, 1, 1);
  Thrust<D> thrust;
  thrust.body = body;
  thrust.force = vec<D>(1, 0);
  const EffectorId id = world.add_effector(thrust).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  thrust.force = vec<D>(-1, 0);
  world.set_effector(id, thrust).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 0, 1e-5);
  EXPECT_EQ(std::get<Thrust<D>>(world.effector_definition(id).value()).force.x, -1);
}

// --- Buoyancy -------------------------------------------------------------------------------------------------------

Buoyancy<Dim3> still_water() {
  Buoyancy<Dim3> water;
  water.density = 1000;
  water.linear_drag = 3;
  water.angular_drag = 3;
  return water;
}
template <class Shape>
BodyId floating(World3& world, const Shape& shape, float density, Vec3d position = {}, Quatf rotation = {}) {
  BodyDef<Dim3> def;
  def.position = position;
  def.rotation = rotation;
  const BodyId body = world.create_body(def).value();
  ShapeDef<Dim3> shape_def;
  shape_def.density = density;
  world.add_shape(body, geometry::Shape3(shape), shape_def).value();
  return body;
}
void settle(World3& world, int steps = 1200) {
  for (int i = 0; i < steps; ++i) world.step(frame).value();
}

TEST(Buoyancy3, PrismOfRelativeDensityPointSixFloatsAtSixtyPercentDraft) {
  // mechanics.md 3.6. Flat enough to be stable.
  World3 world({.allow_sleep = false});
  world.add_effector(still_water()).value();
  const BodyId prism = floating(world, geometry::Box{{1, 0.25f, 1}}, 600, {0, 0.4, 0});
  settle(world);
  EXPECT_NEAR(state_of(world, prism).pose.position.y, 0.25 - 0.6 * 0.5, 1e-3);
}

TEST(Buoyancy3, HalfDensityShapesFloatHalfImmersed) {
  const auto depth = [](const auto& shape) {
    World3 world({.allow_sleep = false});
    world.add_effector(still_water()).value();
    const BodyId body = floating(world, shape, 500, {0, 0.1, 0});
    settle(world);
    return state_of(world, body).pose.position.y;
  };
  EXPECT_NEAR(depth(geometry::Sphere{0.5f}), 0, 1e-3);
  EXPECT_NEAR(depth(geometry::Cylinder{0.1f, 0.5f}), 0, 1e-3);
  const std::vector<Vec3f> corners = {{-1, -.2f, -1}, {1, -.2f, -1}, {-1, -.2f, 1}, {1, -.2f, 1},
                                      {-1, .2f, -1},  {1, .2f, -1},  {-1, .2f, 1},  {1, .2f, 1}};
  EXPECT_NEAR(depth(geometry::make_hull(corners).value()), 0, 1e-3);
}

TEST(Buoyancy3, LyingCapsuleFloatsOnItsSide) {
  World3 world({.allow_sleep = false});
  world.add_effector(still_water()).value();
  const BodyId log = floating(world, geometry::Capsule3{1, 0.2f}, 500, {0, 0, 0}, {0.98f, 0, 0, 0.199f});
  settle(world, 2400);
  const Vec3f axis = rotate(state_of(world, log).pose.rotation, Vec3f{0, 1, 0});
  EXPECT_NEAR(axis.y, 0, 0.02f) << "upright is unstable for a log";
}

TEST(Buoyancy3, ConeFloatsPointDownAtTheCubeRootOfItsDensity) {
  // Submerged volume share s = d³ for draft share d of a cone that floats on its tip; here held upright by its locks.
  World3 world({.allow_sleep = false});
  world.add_effector(still_water()).value();
  BodyDef<Dim3> def;
  def.rotation = {0, 1, 0, 0};  // tip down
  def.locks.rotation_x = def.locks.rotation_y = def.locks.rotation_z = true;
  const BodyId buoy = world.create_body(def).value();
  ShapeDef<Dim3> shape;
  shape.density = 343;  // .7³
  world.add_shape(buoy, geometry::Shape3(geometry::Cone{0.5f, 0.4f}), shape).value();
  settle(world);
  EXPECT_NEAR(state_of(world, buoy).pose.position.y, 0.5 - 0.7, 2e-3);
}

TEST(Buoyancy3, UndampedBobbingKeepsItsAmplitudeAndPeriod) {
  // A flat box of draft d bobs with ω² = g/d, d = draft (no added mass in this model).
  World3 world;
  Buoyancy<Dim3> water;
  water.density = 1000;
  world.add_effector(water).value();
  const BodyId box = floating(world, geometry::Box{{1, 0.5f, 1}}, 500, {0, 0.1, 0});
  Crossings up;
  double highest = 0;
  for (int i = 0; i < 1200; ++i) {
    world.step(frame).value();
    const double y = state_of(world, box).pose.position.y;
    up.add(double(i + 1) / 60, y);
    if (i > 1000) highest = math::max(highest, y);
  }
  const double period = 2 * pi / math::sqrt(9.80665 / 0.5);
  EXPECT_NEAR(up.period(), period, 0.002 * period);
  EXPECT_NEAR(highest, 0.1, 0.002);
}

TEST(Buoyancy3, WaveCarriesASmallFloatUpAndDown) {
  World3 world;
  Buoyancy<Dim3> water = still_water();
  water.waves[0] = {0.5, 40, 0};
  water.wave_count = 1;
  world.add_effector(water).value();
  const BodyId cork = floating(world, geometry::Sphere{0.2f}, 500);
  double low = 0, high = 0;
  for (int i = 0; i < 1800; ++i) {
    world.step(frame).value();
    const double y = state_of(world, cork).pose.position.y;
    if (i > 600) {
      low = math::min(low, y);
      high = math::max(high, y);
    }
  }
  EXPECT_NEAR(high, 0.5, 0.05);
  EXPECT_NEAR(low, -0.5, 0.05);
}

TEST(Buoyancy3, HeelIsRighted) {
  World3 world({.allow_sleep = false});
  world.add_effector(still_water()).value();
  const BodyId raft = floating(world, geometry::Box{{1, 0.15f, 1}}, 500, {0, 0, 0}, {0.9689f, 0, 0, 0.2474f});
  settle(world);
  EXPECT_GT(rotate(state_of(world, raft).pose.rotation, Vec3f{0, 1, 0}).y, 0.9999f);
}

TEST(Buoyancy2, PolygonCircleAndCapsuleFloat) {
  const auto depth = [](const geometry::Shape2& shape, float density) {
    World2 world({.allow_sleep = false});
    Buoyancy<Dim2> water;
    water.density = 1000;
    water.linear_drag = water.angular_drag = 3;
    world.add_effector(water).value();
    const BodyId body = world.create_body({.position = {0, 0.1}}).value();
    world.add_shape(body, shape, {.density = density}).value();
    for (int i = 0; i < 1200; ++i) world.step(frame).value();
    return world.state(body).value().pose.position.y;
  };
  EXPECT_NEAR(depth(geometry::make_box2({1, 0.25f}), 600), 0.25 - 0.3, 1e-3);
  EXPECT_NEAR(depth(geometry::Circle{0.5f}, 500), 0, 1e-3);
}

}  // namespace effector_test
}  // namespace carom::rigid::test
