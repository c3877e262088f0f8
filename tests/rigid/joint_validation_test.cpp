// What cannot be is refused with a sentence that names the field, and the world stays as it was.
#include <limits>
#include <string>

#include "mechanics_world.h"

namespace carom::rigid::test {
namespace joint_validation_test {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

template <class D>
class JointValidation : public testing::Test {
 protected:
  World<D> world;
  BodyId a = add_mass(world, 0, 0, 1, 1), b = add_mass(world, 1, 0, 1, 1), fixed = add_fixed(world),
         fixed2 = add_fixed(world);

  template <class Def>
  void refuse(Def def, const std::string& word) {
    const std::uint64_t before = world.state_hash();
    const int count = world.counters().joints;
    const auto result = world.create_joint(def);
    ASSERT_FALSE(result.ok()) << word;
    EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
    EXPECT_NE(result.error().message.find("World::create_joint"), std::string::npos);
    EXPECT_EQ(world.state_hash(), before);
    EXPECT_EQ(world.counters().joints, count);
  }
  template <class Def>
  Def joined() {
    Def def;
    def.body_a = a;
    def.body_b = b;
    return def;
  }
};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(JointValidation, Dimensions);

TYPED_TEST(JointValidation, Bodies) {
  using D = TypeParam;
  BallJointDef<D> def = this->template joined<BallJointDef<D>>();
  def.body_b = {};
  this->refuse(def, "body_b");
  def.body_b = def.body_a;
  this->refuse(def, "same body");
  def.body_a = this->fixed;
  def.body_b = this->fixed2;
  this->refuse(def, "dynamic");
  def.body_a = {};
  this->refuse(def, "dynamic");
  World<D> other;
  def.body_a = this->a;
  def.body_b = add_mass(other, 0, 0, 1, 1);
  this->refuse(def, "body_b");
  const BodyId gone = add_mass(this->world, 5, 5, 1, 1);
  this->world.destroy_body(gone).value();
  def.body_b = gone;
  this->refuse(def, "no longer exists");
}

TYPED_TEST(JointValidation, Numbers) {
  using D = TypeParam;
  {
    auto def = this->template joined<DistanceJointDef<D>>();
    def.length = -1;
    this->refuse(def, "length");
    def.length = nan;
    this->refuse(def, "length");
    def.length = 1;
    def.frame_a.p.y = infinite;
    this->refuse(def, "frame_a.p.y");
    def.frame_a.p.y = 0;
    def.spring.hertz = -3;
    this->refuse(def, "spring.hertz");
    def.spring.hertz = 0;
    def.limit = {true, 2, 1};
    this->refuse(def, "limit.lower");
    def.limit = {};
    def.motor.max_force = -1;
    this->refuse(def, "motor.max_force");
  }
  {
    auto def = this->template joined<HingeJointDef<D>>();
    def.limit = {true, -7, 7};
    this->refuse(def, "limit");
    def.limit = {};
    def.motor.speed = nan;
    this->refuse(def, "motor.speed");
    def.motor.speed = 0;
    def.target_angle = infinite;
    this->refuse(def, "target_angle");
  }
  {
    auto def = this->template joined<BallJointDef<D>>();
    def.friction_torque = -1;
    this->refuse(def, "friction_torque");
    def.friction_torque = 0;
    def.cone_angle = 4;
    this->refuse(def, "cone_angle");
  }
  {
    auto def = this->template joined<MotorJointDef<D>>();
    def.max_torque = nan;
    this->refuse(def, "max_torque");
  }
  {
    auto def = this->template joined<MouseJointDef<D>>();
    def.target.x = double(nan);
    this->refuse(def, "target.x");
  }
  {
    auto def = this->template joined<WeldJointDef<D>>();
    if constexpr (D::dimension == 2)
      def.frame_a.q = {2, 0};
    else
      def.frame_a.q = {0, 0, 0, 0};
    this->refuse(def, "frame_a.q");
  }
}

TYPED_TEST(JointValidation, Setters) {
  using D = TypeParam;
  const JointId weld = this->world.create_joint(this->template joined<WeldJointDef<D>>()).value();
  const auto says = [](const Status& status, const std::string& word) {
    ASSERT_FALSE(status.ok());
    EXPECT_NE(status.error().message.find(word), std::string::npos) << status.error().message;
  };
  says(this->world.set_motor(weld, {true, 1, 1}), "weld");
  says(this->world.set_limit(weld, {true, 0, 1}), "weld");
  says(this->world.set_mouse_target(weld, pos<D>(0, 0)), "weld");
  says(this->world.set_motor({}, {}), "null");
  const JointId hinge = this->world.create_joint(this->template joined<HingeJointDef<D>>()).value();
  says(this->world.set_motor(hinge, {true, nan, 1}), "motor.speed");
  says(this->world.set_limit(hinge, {true, 1, -1}), "limit.lower");
  says(this->world.set_spring(hinge, {nan, 0}), "spring.hertz");
  this->world.set_motor(hinge, {true, 2, 3}).value();
  this->world.set_limit(hinge, {true, -1, 1}).value();
  this->world.set_spring(hinge, {4, 0.5f}).value();
  const AnyJointDef<D> now = this->world.joint_definition(hinge).value();
  EXPECT_EQ(std::get<HingeJointDef<D>>(now).motor, (JointMotor{true, 2, 3}));
  EXPECT_EQ(std::get<HingeJointDef<D>>(now).limit, (JointLimit{true, -1, 1}));
  EXPECT_EQ(std::get<HingeJointDef<D>>(now).spring, (JointSpring{4, 0.5f}));
  this->world.destroy_joint(hinge).value();
  says(this->world.destroy_joint(hinge), "no longer exists");
}

TYPED_TEST(JointValidation, Effectors) {
  using D = TypeParam;
  const auto refuse = [&](const EffectorDef<D>& def, const std::string& word) {
    const auto result = this->world.add_effector(def);
    ASSERT_FALSE(result.ok()) << word;
    EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
    EXPECT_EQ(this->world.counters().effectors, 0);
  };
  LinearDrag<D> drag;
  drag.coefficient = -1;
  refuse(drag, "coefficient");
  QuadraticDrag<D> air;
  air.area = double(nan);
  refuse(air, "area");
  SphericalGravity<D> planet;
  planet.minimum_radius = 0;
  refuse(planet, "minimum_radius");
  refuse(Thrust<D>{}, "body");
  SpringDamper<D> spring;
  refuse(spring, "body_a");
  spring.body_a = spring.body_b = this->a;
  refuse(spring, "same body");
  spring.body_a = this->fixed;
  spring.body_b = {};
  refuse(spring, "dynamic");
  Buoyancy<D> water;
  water.wave_count = 5;
  refuse(water, "wave_count");
  refuse(CustomEffector<D>{}, "model");
  RadialField<D> field;
  field.reference = 0;
  refuse(field, "reference");
  VortexField<D> vortex;
  vortex.core_radius = -1;
  refuse(vortex, "core_radius");
}

}  // namespace joint_validation_test
}  // namespace carom::rigid::test
