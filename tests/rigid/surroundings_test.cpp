// What a world has around it: what it refuses, and what snapshots keep of it.
#include <cmath>
#include <limits>

#include "carom/rigid/snapshot.h"
#include "tests/rigid/surroundings.h"

namespace surroundings_test {

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
