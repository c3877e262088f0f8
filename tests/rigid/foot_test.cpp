// Light feet and legs, held by joints, carry what is far heavier than they are.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace foot_test {

template <class D>
class Feet : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Feet, Dimensions);

enum class Hold { weld, hinge, brake };

struct Stand {
  double lowest = 0, end = 0;  ///< m below where it was made
  double speed = 0;            ///< m/s at the end
};

/// A cube on feet of .6 × .5 m of 1/ratio of its mass, one below its middle or one below each corner.
template <class D>
Stand stand(float ratio, int a_row, Hold hold) {
  WorldDef<D> definition = world_with<D>();
  definition.allow_sleep = false;
  World<D> world(definition);
  add_ground(world);
  const float foot_mass = D::dimension == 2 ? 0.3f : 0.18f;  // over that of the cube, of one density
  const BodyId cube = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.5f, 0.5f), at<D>(0, 1),
                                  {0.6f, 0, 1000 * foot_mass * ratio, 0});
  std::vector<BodyId> feet;
  const auto place = [&](int i) { return a_row == 1 ? 0.0f : float(i) - 0.5f; };
  for (int i = 0; i < a_row; ++i)
    for (int k = 0; k < (D::dimension == 2 ? 1 : a_row); ++k) {
      const BodyId foot = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.3f, 0.25f, 0.3f),
                                      at<D>(double(place(i)), 0.25, double(place(k))), {0.6f, 0, 1000, 0});
      const auto join = [&](auto joint) {
        joint.body_a = cube, joint.body_b = foot;
        joint.frame_a.p = along<D>(place(i), -0.5f);
        if constexpr (D::dimension == 3) joint.frame_a.p.z = place(k);
        joint.frame_b.p = along<D>(0, 0.25f);
        world.create_joint(joint).value();
      };
      HingeJointDef<D> brake;
      brake.motor = {true, 0, 1e9f};
      if (hold == Hold::weld) join(WeldJointDef<D>{});
      if (hold == Hold::hinge) join(HingeJointDef<D>{});
      if (hold == Hold::brake) join(brake);
      feet.push_back(foot);
    }
  Stand out;
  for (int i = 0; i < 600; ++i) {
    run(world, 1);
    out.end = 1 - world.state(cube).value().pose.position.y;
    out.lowest = std::max(out.lowest, out.end);
  }
  out.speed = double(speed(world, cube));
  return out;
}

// The feet sank by 2 to 7 cm under a hundred times their mass, and wholly under a thousand times.
TYPED_TEST(Feet, CarryWhatIsFarHeavier) {
  using D = TypeParam;
  for (const float ratio : {10.0f, 100.0f, 1000.0f})
    for (const int a_row : {1, 2})
      for (const Hold hold : {Hold::weld, Hold::hinge, Hold::brake}) {
        if (a_row == 1 && hold == Hold::hinge) continue;  // falls over
        SCOPED_TRACE(testing::Message() << ratio << " times, " << a_row << " a row, joint " << int(hold));
        const Stand s = stand<D>(ratio, a_row, hold);
        EXPECT_LT(s.end, 0.005);
        EXPECT_LT(s.lowest, 0.01);
        EXPECT_LT(s.speed, 1e-4);
      }
}

}  // namespace foot_test
}  // namespace carom::rigid::test
