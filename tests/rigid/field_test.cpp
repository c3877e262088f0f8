// Charges in fields, frames that turn, gravity that is not the same everywhere.
#include <cmath>

#include "tests/rigid/surroundings.h"

namespace surroundings_test {

// --- charges --------------------------------------------------------------------------------------------------------

template <class D>
class Charge : public testing::Test {};
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

/// m, where the body comes down to the ground; `height`: m, above it, to begin with.
double lands_east(World3& world, BodyId body, double height) {
  Vec3d before{}, after{0, height, 0};
  while (after.y > 0) {
    before = after;
    world.step(frame).value();
    after = state_of(world, body).pose.position;
  }
  return before.x + (after.x - before.x) * before.y / (before.y - after.y);
}

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
    EXPECT_NEAR(lands_east(world, body, 100) * 1000, 21.95, 0.03);
    EXPECT_NEAR(state_of(world, body).pose.position.z, 0, 1e-6);
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
  const double east = lands_east(world, body, 1);
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

}  // namespace surroundings_test
