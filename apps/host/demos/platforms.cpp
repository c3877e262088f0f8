// Platforms to jump through from below, and an explosion under them.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class Platforms final : public Repeatable<Platforms, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "platforms";
    d.title = "One-way platforms and an explosion";
    d.summary = "Balls jump up through platforms that hold them when they come down. Set off the charge below.";
    d.group = "Surfaces";
    d.dimension = 2;
    d.text =
        "A one-way shape holds what comes against its direction and lets through what comes from elsewhere, until it "
        "is out again. No callback is needed, and it holds for fast bodies too.\n\n"
        "  rise of a jump: h = v²/2g\n\n"
        "The explosion gives every body near it a speed away from its centre, within a radius and falling off beyond.";
    d.dt = 1.0 / 120;
    d.duration = 4;
    d.camera.target = {0, 3.4, 0};
    d.camera.height = 10;
    d.camera.width = 15;
    d.parameters = {
        {"jump", "Speed of a jump", "m/s", "m/s", "of the balls, upward", 2, 14, 0.1, 8, true},
        {"blast", "Speed of the blast", "m/s", "m/s", "given to what is within 3 m of the charge", 0, 20, 0.5, 9, true},
    };
    d.plots = {
        {"Height of the first ball", {"time", "s"}, {"height", "m"}, {{"ball"}, {"v²/2g", Series::Style::points}}}};
    d.inputs = {{"jump", "Jump", {"Space", "ArrowUp"}, true, 1}, {"blast", "Blast", {"KeyB"}, true, 1}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    for (int i = 0; i < 3; ++i) {
      rigid::BodyDef<Dim2> body;
      body.type = rigid::BodyType::fixed;
      body.name = "platform";
      body.position = {i == 1 ? 1.5 : -1.0, 2.0 + 2.0 * i};
      rigid::ShapeDef<Dim2> shape;
      shape.one_way = {0, 1};
      stage.add(body, geometry::make_box2({4, thickness_}), shape, teal);
    }
    constexpr std::uint32_t colors[] = {orange, blue, gold, violet, red};
    for (int i = 0; i < 5; ++i) {
      rigid::BodyDef<Dim2> body;
      body.name = "ball";
      body.position = {-2.6 + 1.2 * i, double(radius_)};
      rigid::ShapeDef<Dim2> shape;
      shape.material.rolling_resistance = 0.05f;
      balls_.push_back(stage.add(body, geometry::Circle{radius_}, shape, colors[i]));
    }
    const double v = stage.value("jump");
    stage.sample(0, 1, 0.5 + v / 9.80665, double(radius_) + v * v / (2 * 9.80665));
  }

  void before_step(Stage2& stage) override {
    if (stage.presses("jump") > 0 || stage.world().step_count() == 60)
      for (const BodyId ball : balls_)
        stage.check(stage.world().set_velocity(ball, {0, stage.valuef("jump")}, 0)),
            stage.check(stage.world().set_awake(ball, true));
    if (stage.presses("blast") > 0) {
      rigid::ExplosionDef<Dim2> charge;
      charge.center = {0, 0};
      charge.radius = 3;
      charge.falloff = 2;
      charge.speed = stage.valuef("blast");
      stage.say(format("the blast reached %.0f bodies", double(stage.keep(stage.world().explode(charge)))));
    }
  }

  void after_step(Stage2& stage) override {
    const double y = stage.at(balls_.front()).pose.position.y;
    highest_ = max(highest_, y);
    stage.sample(0, 0, stage.world().time(), y);
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double rise = 64 / (2 * 9.80665);
    out.push_back({"highest place of the ball", "m", "v²/2g, through the platform", highest_, radius_ + rise, 0.03});
    out.push_back({"where it rests", "m", "on the first platform", stage.at(balls_.front()).pose.position.y,
                   2.0 + double(thickness_) + double(radius_), 0.01});
  }

 private:
  static constexpr float radius_ = 0.3f, thickness_ = 0.12f;
  std::vector<BodyId> balls_;
  double highest_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_platforms() { return std::make_unique<Platforms>(); }

}  // namespace carom::host::demo
