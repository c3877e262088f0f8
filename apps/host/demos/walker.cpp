// A character that walks: stairs, slopes, a ferry, crates in the way, and another one who comes along.
#include "apps/host/demos/walking.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Character3;
using rigid::Dim3;

class Walker final : public Repeatable<Walker, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "walker";
    d.title = "A character on its way";
    d.summary =
        "Walk up stairs and down a slope, ride the ferry, push crates. It walks by itself until a key is pressed.";
    d.group = "Characters";
    d.text =
        "A character is an upright capsule that goes where it is told. It is no dynamic body: it looks around before "
        "each step, slides along what is in its way, climbs stairs up to a height, treats what is too steep as a wall, "
        "and is carried by what it stands on. For bodies, rays and other characters it is a kinematic body.\n\n"
        "  jump: h = v²/2g\n\n"
        "The other one jumps up through a ledge that holds only from above, rides on it, because its surface runs like "
        "a belt, and lets itself fall through it again.\n\n"
        "It pushes bodies with a limited force, so that a crate moves and a house does not.";
    d.duration = 14;
    d.camera = {{-16, 5, 12}, {-12, 1, 0}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Walking speed", "m/s", "m/s", "", 0.5, 6, 0.1, 2.5, true},
        {"jump", "Speed of a jump", "m/s", "m/s", "upward, at its start", 1, 8, 0.1, 4.5, true},
        {"stair", "Height of a stair", "m", "cm", "35 cm can be climbed", 0.05, 0.5, 0.01, 0.25, false},
        {"push", "Force of a push", "N", "N", "the most it pushes with", 0, 3000, 10, 500, false},
    };
    d.plots = {{"Height of the feet", {"time", "s"}, {"height", "m"}, {{"walker"}}},
               {"Speed", {"time", "s"}, {"speed along the course", "m/s"}, {{"walker"}}}};
    d.inputs = walking_inputs();
    d.inputs.push_back({"drop", "Drop through", {"KeyX"}, true, 1});
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    course(stage);
    rigid::CharacterDef<Dim3> walker;
    walker.push_force = stage.valuef("push");
    core::Result<Character3> one = Character3::create(stage.world(), walker, {-12, 0.01, 0});
    core::Result<Character3> two = Character3::create(stage.world(), {}, {0, 0.01, -3});
    if (!one.ok()) return stage.fail(one.error());
    if (!two.ok()) return stage.fail(two.error());
    walker_.emplace(std::move(one).value());
    other_.emplace(std::move(two).value());
    show_walkers(stage, walker_->body(), other_->body());
  }

  void before_step(Stage3& stage) override {
    const float dt = float(stage.declaration().dt);
    if (stage.presses("drop") > 0) walker_->drop_through();
    stage.check(walker_->move(stage.world(), wanted_walk(stage, driven_), dt));
    // The other one jumps onto the ledge, lets go of it after two seconds, and walks back below.
    const double t = stage.world().time(), turn = t - 6 * floor(t / 6);
    const auto begins = [&](double when) { return turn >= when && turn < when + stage.declaration().dt; };
    if (begins(2.5)) other_->drop_through();
    const float back = turn > 3.5 ? clamp(float(-2 * other_->feet().x), -1.5f, 1.5f) : 0.0f;
    stage.check(other_->move(stage.world(), {back, begins(0.5) ? 5.0f : 0.0f, 0}, dt));
    // The ferry goes round and round beside the course.
    const double phase = 0.6 * (t + stage.declaration().dt);
    stage.check(stage.world().set_target_pose(ferry_, {3 * sin(phase), 0.1, 4 + 1.5 * cos(phase)}, {}, dt));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const Vec3d feet = walker_->feet();
    stage.sample(0, 0, t, feet.y);
    stage.sample(1, 0, t, walker_->velocity().x);
    highest_ = max(highest_, feet.y);
    if (stage.world().step_count() == 330) dropped_ = other_->feet().y;
    if (stage.world().step_count() == 144) ledge_height_ = other_->feet().y, ridden_ = other_->ground().velocity.x;
    trail_.add(feet + Vec3d{0, 0.02, 0});
    trail_.draw(stage, pen(orange, 0xa0));
    say_ground(stage, walker_->ground().state);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"height of the landing", "m", "five stairs of 25 cm", highest_, 1.25, 0.03});
    out.push_back({"height of the feet after the slope", "m", "the floor", walker_->feet().y, 0.01, 0.02});
    out.push_back({"height of the other one's feet on the ledge", "m", "the ledge", ledge_height_, 0.91, 0.005});
    out.push_back({"its speed there", "m/s", "that of the belt", ridden_, 0.4, 0.001});
    out.push_back({"height of its feet below the ledge", "m", "dropped through", dropped_, 0.01, 0.005});
    out.push_back({"crate pushed along by at least", "m", "500 N against μ m g = 118 N",
                   stage.at(crate_).pose.position.x > 9.5 ? 1.0 : 0.0, 1, 0});
  }

 private:
  void solid(Stage3& stage, const char* name, Vec3d at, Vec3f half, std::uint32_t color, Quatf rotation = {}) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = name;
    body.position = at;
    body.rotation = rotation;
    stage.add(body, geometry::Box{half}, {}, color);
  }

  void course(Stage3& stage) {
    const float stair = stage.valuef("stair");
    for (int i = 1; i <= 5; ++i)
      solid(stage, "stair", {-8.0 + 0.4 * i + 2, 0.5 * double(stair) * i, 0},
            {2.2f, 0.5f * stair * float(i), 1.2f - 0.005f * float(i)}, i % 2 ? steel : sand);
    // From the landing down to the floor.
    const double top = 5 * double(stair), foot = -8.0 + 2 + 2 + 2.2, angle = radians(22.0);
    const double run = top / tan(angle), half = 0.5 * top / sin(angle);
    const Vec3d middle{foot + 0.5 * run - 0.1 * sin(angle), 0.5 * top - 0.1 * cos(angle), 0};
    solid(stage, "slope", middle, {float(half), 0.1f, 1.2f}, sand,
          {float(cos(0.5 * angle)), 0, 0, -float(sin(0.5 * angle))});
    rigid::ShapeDef<Dim3> wood;
    wood.density = 60;
    rigid::BodyDef<Dim3> crate;
    crate.name = "crate";
    for (int i = 0; i < 3; ++i) {
      crate.position = {8.0 + 3.5 * i, 0.35, 0.0};
      const BodyId id = stage.add(crate, geometry::Box{{0.35f, 0.35f, 0.35f}}, wood, i == 0 ? gold : green);
      if (i == 0) crate_ = id;
    }
    rigid::BodyDef<Dim3> ledge;
    ledge.type = rigid::BodyType::fixed;
    ledge.name = "ledge";
    ledge.position = {0.6, 0.84, -3};
    rigid::ShapeDef<Dim3> belt;
    belt.one_way = {0, 1, 0};
    belt.surface_velocity = {0.4f, 0, 0};
    stage.add(ledge, geometry::Box{{1.5f, 0.06f, 0.8f}}, belt, teal);
    rigid::BodyDef<Dim3> ferry;
    ferry.type = rigid::BodyType::kinematic;
    ferry.name = "ferry";
    ferry.position = {0, 0.1, 5.5};
    ferry_ = stage.add(ferry, geometry::Box{{1.2f, 0.1f, 0.8f}}, {}, blue);
  }

  std::optional<Character3> walker_, other_;
  BodyId ferry_, crate_;
  Trail trail_{0.1, 300};
  double highest_ = 0, ledge_height_ = 0, ridden_ = 0, dropped_ = 0;
  bool driven_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_walker() { return std::make_unique<Walker>(); }

}  // namespace carom::host::demo
