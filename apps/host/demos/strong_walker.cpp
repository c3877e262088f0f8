// A character that is a body, pushed and pushing: stairs, a ferry, and a crate as heavy as it is.
#include "apps/host/demos/walking.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;
using rigid::DynamicCharacter3;

class StrongWalker final : public Repeatable<StrongWalker, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "strong_walker";
    d.title = "A character with a mass";
    d.summary = "It climbs the stairs by the force of its legs, is thrown back by a sliding crate, and pushes it away.";
    d.group = "Characters";
    d.text =
        "This character is a dynamic body with locked rotation: everything that pushes bodies pushes it. Its legs give "
        "it a force along the ground it stands on, no more than they can,\n\n"
        "  F = m (v_wanted − v)/dt − m g_along,  |F| ≤ F_legs\n\n"
        "and the ground gets the opposite force. A crate of mass M that slides into it at v shares its momentum at "
        "once: M v = (M + m) u. Then the legs bring it to rest and push it back.";
    d.duration = 14;
    d.camera = {{-7, 4, 11}, {-4, 1, 0}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Walking speed", "m/s", "m/s", "", 0.5, 5, 0.1, 2, true},
        {"jump", "Speed of a jump", "m/s", "m/s", "upward, at its start", 1, 8, 0.1, 4.5, true},
        {"legs", "Force of the legs", "N", "N", "", 300, 4000, 50, 1600, false},
        {"mass", "Mass", "kg", "kg", "", 30, 150, 1, 80, false},
        {"crate", "Mass of the crate", "kg", "kg", "it comes at 3 m/s on ice", 20, 400, 1, 100, false},
    };
    d.plots = {{"Speed along the course", {"time", "s"}, {"speed", "m/s"}, {{"walker"}, {"crate"}}},
               {"Height of the feet", {"time", "s"}, {"height", "m"}, {{"walker"}}}};
    d.inputs = walking_inputs();
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    for (int i = 1; i <= 4; ++i) {
      rigid::BodyDef<Dim3> stair;
      stair.type = rigid::BodyType::fixed;
      stair.name = "stair";
      stair.position = {-8.0 + 0.3 * i, 0.1 * i, 0};
      stage.add(stair, geometry::Box{{2.3f - 0.3f * float(i), 0.1f * float(i), 1.2f}}, {}, i % 2 ? steel : sand);
    }
    rigid::ShapeDef<Dim3> ice;
    ice.material.friction = 0;
    ice.density = stage.valuef("crate") / (0.8f * 0.8f * 0.8f);
    rigid::BodyDef<Dim3> crate;
    crate.name = "crate";
    crate.position = {14, 0.4, 0};
    crate.linear_velocity = {-3, 0, 0};
    crate_ = stage.add(crate, geometry::Box{{0.4f, 0.4f, 0.4f}}, ice, gold);
    rigid::BodyDef<Dim3> ferry;
    ferry.type = rigid::BodyType::kinematic;
    ferry.name = "ferry";
    ferry.position = {0, 0.1, 3.5};
    ferry_ = stage.add(ferry, geometry::Box{{1.2f, 0.1f, 0.8f}}, {}, blue);
    rigid::DynamicCharacterDef<Dim3> walker, rider;
    walker.mass = stage.valuef("mass");
    walker.leg_force = stage.valuef("legs");
    core::Result<DynamicCharacter3> one = DynamicCharacter3::create(stage.world(), walker, {-12, 0, 0});
    core::Result<DynamicCharacter3> two = DynamicCharacter3::create(stage.world(), rider, {0, 0.2, 3.5});
    if (!one.ok()) return stage.fail(one.error());
    if (!two.ok()) return stage.fail(two.error());
    walker_.emplace(std::move(one).value());
    rider_.emplace(std::move(two).value());
    show_walkers(stage, walker_->body(), rider_->body());
  }

  void before_step(Stage3& stage) override {
    const float dt = float(stage.declaration().dt);
    stage.check(walker_->move(stage.world(), wanted_walk(stage, driven_), dt));
    stage.check(rider_->move(stage.world(), {}, dt));
    const double phase = 0.6 * (stage.world().time() + stage.declaration().dt);
    stage.check(stage.world().set_target_pose(ferry_, {3 * sin(phase), 0.1, 5 - 1.5 * cos(phase)}, {}, dt));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const Vec3d feet = walker_->feet(stage.world());
    const double speed = walker_->velocity(stage.world()).x;
    stage.sample(0, 0, t, speed);
    stage.sample(0, 1, t, stage.at(crate_).linear_velocity.x);
    stage.sample(1, 0, t, feet.y);
    highest_ = max(highest_, feet.y);
    slowest_ = min(slowest_, speed);
    trail_.add(feet + Vec3d{0, 0.02, 0});
    trail_.draw(stage, pen(orange, 0xa0));
    say_ground(stage, walker_->ground().state);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"height of the landing", "m", "four stairs of 20 cm", highest_, 0.8, 0.03});
    out.push_back({"thrown back by the crate", "", "its momentum is the greater", slowest_ < -0.1 ? 1.0 : 0.0, 1, 0});
    out.push_back({"the crate pushed away again", "", "the legs go on",
                   stage.at(crate_).linear_velocity.x > 1 ? 1.0 : 0.0, 1, 0});
    const Vec3d apart = rider_->feet(stage.world()) - stage.at(ferry_).pose.position;
    out.push_back({"the rider on its ferry", "m", "where it stood", length(apart - Vec3d{0, 0.1, 0}), 0, 0.6});
  }

 private:
  std::optional<DynamicCharacter3> walker_, rider_;
  BodyId ferry_, crate_;
  Trail trail_{0.1, 300};
  double highest_ = 0, slowest_ = 0;
  bool driven_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_strong_walker() { return std::make_unique<StrongWalker>(); }

}  // namespace carom::host::demo
