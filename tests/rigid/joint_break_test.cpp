// Every kind of joint tells the force or the torque that statics asks of it, and breaks with one event where that is
// above what it bears, and nowhere below.
#include <functional>

#include "mechanics_world.h"

namespace carom::rigid::test {
namespace joint_break_test {

template <class D>
class JointBreak : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(JointBreak, Dimensions);

constexpr float g = 9.80665f, weight = 2 * g, torque = 2;  // of 2 kg; N, N·m
constexpr int steps = 300;

float size_of(float w) { return math::abs(w); }
float size_of(const Vec3f& w) { return math::length(w); }

template <class D>
BodyId add_weight(World<D>& world, double x = 0, double y = 0) {
  return add_mass<D>(world, x, y, 2, 0.3);
}
/// m by which a spring of so many Hz gives way under what hangs on it.
float yield_of(float hertz) { return g / (4 * pi_f * pi_f * hertz * hertz); }
template <class D, class Def>
JointId make(World<D>& world, Def def, BodyId body, float break_force, float break_torque = 0) {
  def.body_b = body;
  def.break_force = break_force;
  def.break_torque = break_torque;
  return world.create_joint(def).value();
}

/// Makes the joint in a world of its own; what it bears, 0: anything.
template <class D>
struct Rig {
  const char* name;
  std::function<JointId(World<D>&, float bears)> make;
};

/// 2 kg hang on it.
template <class D>
std::vector<Rig<D>> hangers() {
  std::vector<Rig<D>> rigs;
  const auto add = [&](const char* name, auto make) { rigs.push_back({name, make}); };
  add("distance", [](World<D>& w, float bears) { return make(w, DistanceJointDef<D>{}, add_weight(w, 0, -1), bears); });
  add("rope", [](World<D>& w, float bears) {
    DistanceJointDef<D> d;
    d.rope = true;
    d.limit = {true, 0, 1};
    return make(w, d, add_weight(w, 0, -1), bears);
  });
  add("distance with a spring", [](World<D>& w, float bears) {
    DistanceJointDef<D> d;
    d.spring = {4, 1};
    d.length = 1 - yield_of(4);
    return make(w, d, add_weight(w, 0, -1), bears);
  });
  add("ball", [](World<D>& w, float bears) { return make(w, BallJointDef<D>{}, add_weight(w), bears); });
  add("hinge", [](World<D>& w, float bears) { return make(w, HingeJointDef<D>{}, add_weight(w), bears); });
  add("slider across", [](World<D>& w, float bears) { return make(w, SliderJointDef<D>{}, add_weight(w), bears); });
  const auto down = [] {
    SliderJointDef<D> d;
    d.frame_a.q = d.frame_b.q = turned<D>(-0.5 * pi);
    return d;
  };
  add("slider on its stop", [down](World<D>& w, float bears) {
    SliderJointDef<D> d = down();
    d.limit = {true, -1, 0};
    return make(w, d, add_weight(w), bears);
  });
  add("slider held by its motor", [down](World<D>& w, float bears) {
    SliderJointDef<D> d = down();
    d.motor = {true, 0, 1e3f};
    return make(w, d, add_weight(w), bears);
  });
  add("weld", [](World<D>& w, float bears) { return make(w, WeldJointDef<D>{}, add_weight(w), bears); });
  add("weld with a spring", [](World<D>& w, float bears) {
    WeldJointDef<D> d;
    d.linear = {5, 1};
    d.frame_a.p = vec<D>(0, yield_of(5));
    return make(w, d, add_weight(w), bears);
  });
  add("motor", [](World<D>& w, float bears) {
    MotorJointDef<D> d;
    d.linear = {0, 0};
    return make(w, d, add_weight(w), bears);
  });
  add("mouse", [](World<D>& w, float bears) {
    MouseJointDef<D> d;
    d.target = pos<D>(0, double(yield_of(5)));
    return make(w, d, add_weight(w), bears);
  });
  add("generic, held", [](World<D>& w, float bears) { return make(w, GenericJointDef<D>{}, add_weight(w), bears); });
  add("generic on its stop", [](World<D>& w, float bears) {
    GenericJointDef<D> d;
    d.linear[1].free = true;
    d.linear[1].limit = {true, 0, 1};
    return make(w, d, add_weight(w), bears);
  });
  add("generic held by friction", [](World<D>& w, float bears) {
    GenericJointDef<D> d;
    d.linear[1].free = true;
    d.linear[1].friction = 1000;
    return make(w, d, add_weight(w), bears);
  });
  add("wheel", [](World<D>& w, float bears) {
    JointFrames<D> frames;
    frames.frame_a.p = vec<D>(0, yield_of(3));
    return make(w, make_wheel_joint<D>(frames, {3, 0.7f}, {true, -1, 1}), add_weight(w), bears);
  });
  add("pulley", [](World<D>& w, float bears) {
    PulleyJointDef<D> d;
    d.body_a = add_weight(w, -1, -1);
    d.ground_a = pos<D>(-1, 0);
    d.ground_b = pos<D>(1, 0);
    d.length = 2;
    return make(w, d, add_weight(w, 1, -1), bears);
  });
  add("path across", [](World<D>& w, float bears) {
    const std::vector<typename D::Vector> points{vec<D>(-1, 0), vec<D>(1, 0)};
    PathJointDef<D> d;
    d.points = points;
    d.straight = true;
    return make(w, d, add_weight(w), bears);
  });
  add("path on its end", [](World<D>& w, float bears) {
    const std::vector<typename D::Vector> points{vec<D>(0, 0), vec<D>(0, 1)};
    PathJointDef<D> d;
    d.points = points;
    d.straight = true;
    return make(w, d, add_weight(w), bears);
  });
  add("rack", [](World<D>& w, float bears) {  // on a pinion that is held
    const BodyId pinion = add_weight(w, -0.3), rack = add_weight(w);
    HingeJointDef<D> hinge;
    hinge.frame_a.p = vec<D>(-0.3f, 0);
    hinge.motor = {true, 0, 1e4f};
    make(w, hinge, pinion, 0);
    SliderJointDef<D> upright;
    upright.frame_a.q = upright.frame_b.q = turned<D>(0.5 * pi);
    make(w, upright, rack, 0);
    RackJointDef<D> d;
    d.body_a = pinion;
    d.radius = 0.3f;
    d.frame_b.q = upright.frame_b.q;
    return make(w, d, rack, bears);
  });
  return rigs;
}

/// 2 N·m turn it about z; the body is the first of its world.
template <class D>
std::vector<Rig<D>> twisters() {
  std::vector<Rig<D>> rigs;
  const auto add = [&](const char* name, auto def) {
    rigs.push_back({name, [def](World<D>& w, float bears) { return make(w, def, add_weight(w), 0, bears); }});
  };
  const auto changed = [](auto def, auto change) {
    change(def);
    return def;
  };
  constexpr int z = D::dimension == 2 ? 0 : 2;
  add("ball with a spring", changed(BallJointDef<D>{}, [](auto& d) { d.spring = {4, 1}; }));
  add("ball with friction", changed(BallJointDef<D>{}, [](auto& d) { d.friction_torque = 10; }));
  add("ball at its twist limit", changed(BallJointDef<D>{}, [](auto& d) { d.twist = {true, -1, 0}; }));
  add("hinge with a spring", changed(HingeJointDef<D>{}, [](auto& d) { d.spring = {4, 1}; }));
  add("hinge with a brake", changed(HingeJointDef<D>{}, [](auto& d) { d.motor = {true, 0, 10}; }));
  add("hinge at its stop", changed(HingeJointDef<D>{}, [](auto& d) { d.limit = {true, -1, 0}; }));
  add("slider", SliderJointDef<D>{});
  add("weld", WeldJointDef<D>{});
  add("weld with a spring", changed(WeldJointDef<D>{}, [](auto& d) { d.angular = {4, 1}; }));
  add("motor", MotorJointDef<D>{});
  add("generic, held", GenericJointDef<D>{});
  add("generic at its stop", changed(GenericJointDef<D>{}, [](auto& d) {
        d.angular[z].free = true;
        d.angular[z].limit = {true, -1, 0};
      }));
  add("generic with friction", changed(GenericJointDef<D>{}, [](auto& d) {
        d.angular[z].free = true;
        d.angular[z].friction = 10;
      }));
  add("generic with a spring", changed(GenericJointDef<D>{}, [](auto& d) {
        d.angular[z].free = true;
        d.angular[z].spring = {4, 1};
      }));
  rigs.push_back({"gear on a wheel that is held", [](World<D>& w, float bears) {
                    const BodyId wheel = add_weight(w), held = add_weight(w, 1);
                    HingeJointDef<D> hinge;
                    make(w, hinge, wheel, 0);
                    hinge.frame_a.p = vec<D>(1, 0);
                    hinge.motor = {true, 0, 1e3f};
                    make(w, hinge, held, 0);
                    GearJointDef<D> d;
                    d.body_a = held;
                    d.ratio = -2;
                    return make(w, d, wheel, 0, bears);
                  }});
  if constexpr (D::dimension == 3) {
    rigs.push_back({"screw on a nut that is held", [](World3& w, float bears) {
                      const BodyId body = add_weight(w);
                      auto sleeve = make_cylindrical_joint<Dim3>({});
                      sleeve.frame_a.q = sleeve.frame_b.q = {math::sqrt(0.5f), 0, -math::sqrt(0.5f), 0};  // x along z
                      sleeve.linear[0].friction = 1e5f;
                      make(w, sleeve, body, 0);
                      ScrewJointDef<Dim3> d;
                      d.pitch = 0.1f;
                      d.frame_a.q = d.frame_b.q = sleeve.frame_a.q;
                      return make(w, d, body, 0, bears);
                    }});
    rigs.push_back({"path that is followed", [](World3& w, float bears) {
                      const std::vector<Vec3f> points{{-1, 0, 0}, {1, 0, 0}};
                      PathJointDef<Dim3> d;
                      d.points = points;
                      d.straight = d.follow = true;
                      d.limit = {true, 1, 1};
                      return make(w, d, add_weight(w), 0, bears);
                    }});
  }
  return rigs;
}

struct Course {
  bool holds = true;
  double force = 0, torque = 0;  ///< N, N·m: at the end, or of the event
  int events = 0;
};
/// Lets it hang, or turns the world's first body, by a gravity or torque that grows to its value in two seconds.
template <class D>
Course run(const Rig<D>& rig, float bears, bool turn) {
  WorldDef<D> definition;
  definition.allow_sleep = false;
  const auto gravity = definition.gravity;
  definition.gravity = {};
  World<D> world(definition);
  const JointId joint = rig.make(world, bears);
  std::vector<BodyId> bodies;
  world.bodies(bodies);
  Course out;
  const auto note = [&](const auto& of) { out.force = math::length(of.force), out.torque = size_of(of.torque); };
  for (int i = 0; i < steps; ++i) {
    const float share = min(1.0f, float(i) / 120);
    if (turn)
      world.add_torque(bodies[0], about_z<D>(share * torque)).value();
    else
      world.set_gravity(share * gravity).value();
    world.step(frame).value();
    for (const JointBreakEvent<D>& event : world.events().joint_break) {
      EXPECT_EQ(event.joint, joint) << rig.name;
      note(event);
      ++out.events;
    }
  }
  out.holds = world.contains(joint);
  if (out.holds) note(world.joint_state(joint).value());
  return out;
}

template <class D>
void expect_statics(const Rig<D>& rig, double wanted, bool turn) {
  SCOPED_TRACE(rig.name);
  const auto of = [&](const Course& c) { return turn ? c.torque : c.force; };
  const Course free = run(rig, 0, turn), strong = run(rig, float(1.03 * wanted), turn),
               weak = run(rig, float(0.97 * wanted), turn);
  EXPECT_TRUE(free.holds);
  EXPECT_NEAR(of(free), wanted, 0.005 * wanted);
  EXPECT_TRUE(strong.holds);
  EXPECT_EQ(free.events + strong.events, 0);
  EXPECT_FALSE(weak.holds);
  EXPECT_EQ(weak.events, 1);
  EXPECT_GT(of(weak), 0.97 * wanted);
  EXPECT_LT(of(weak), 1.03 * wanted);
}

TYPED_TEST(JointBreak, ForcesAreThoseOfStatics) {
  for (const Rig<TypeParam>& rig : hangers<TypeParam>()) expect_statics(rig, double(weight), false);
}

TYPED_TEST(JointBreak, TorquesAreThoseOfStatics) {
  for (const Rig<TypeParam>& rig : twisters<TypeParam>()) expect_statics(rig, double(torque), true);
}

}  // namespace joint_break_test
}  // namespace carom::rigid::test
