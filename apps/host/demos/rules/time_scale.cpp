// Clocks of their own: pendulums side by side, and balls that fly through a place where time goes slowly.
#include "apps/host/demos/rules/list.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class TimeScale final : public Repeatable<TimeScale, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "time-scale";
    d.dimension = 2;
    d.title = "Clocks of their own";
    d.summary = "Four pendulums, each in a time of its own, and balls that fly through a field of slow motion.";
    d.group = "Rules of bodies";
    d.text =
        "A body has a time scale s: it lives s seconds in a second of the world. Gravity, forces, damping and springs "
        "act in its own time, so its path stays what it is, and only the time on the way changes. Seen from the world "
        "its speed is s v and its acceleration s² g:\n\n"
        "  y = v₀ (s t) − ½ g (s t)²      T = (2π/s) √(l/g) (1 + φ²/16)\n\n"
        "When a clock is set anew, the velocity changes with it: in the field every ball goes on along the same "
        "parabola (the thin curve), and leaves it as it came in. Blows exchange momentum in the world's time, so that "
        "bodies with different clocks meet without trouble.";
    d.duration = 12;
    d.camera.target = {0, 4.4, 0};
    d.camera.height = 10.6;
    d.camera.width = 19;
    d.ground = 0;
    d.parameters = {
        {"field", "Time in the field", "", "", "seconds that a ball lives in it in a second of the world", 0.05, 3, 0,
         0.2, true},
        {"angle", "Angle of the pendulums", "rad", "deg", "at the start", 0.05, 1.2, 0, radians(20.0), false},
    };
    d.plots = {{"Pendulums",
                {"time", "s"},
                {"angle", "deg"},
                {{"s = 1", Series::Style::line, {}, blue},
                 {"½", Series::Style::line, {}, green},
                 {"¼", Series::Style::line, {}, gold},
                 {"⅛", Series::Style::line, {}, red}}},
               {"Speed of the first ball", {"time", "s"}, {"speed", "m/s"}, {{"seen from the world"}, {"its own"}}}};
    d.inputs = {{"throw", "Throw a ball", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    for (int i = 0; i < count_; ++i) {
      rigid::BodyDef<Dim2> body;
      body.name = "hook";
      body.type = rigid::BodyType::fixed;
      body.position = hook(i);
      rigid::ShapeDef<Dim2> shape;
      shape.filter.mask = 0;
      const BodyId fixed = stage.add(body, geometry::Circle{0.07f}, shape, dark);
      body.name = "pendulum";
      body.type = rigid::BodyType::dynamic;
      const double angle = stage.value("angle");
      body.position = hook(i) + length_ * Vec2d{sin(angle), -cos(angle)};
      body.time_scale = pace(i);
      body.sleep_speed = 0;
      constexpr std::uint32_t colors[] = {blue, green, gold, red};
      bobs_[i] = stage.add(body, geometry::Circle{0.28f}, shape, colors[i]);
      rigid::DistanceJointDef<Dim2> rod;
      rod.body_a = fixed, rod.body_b = bobs_[i];
      rod.length = float(length_);
      stage.keep(stage.world().create_joint(rod));
      crossings_[i] = 0;
    }
    rigid::BodyDef<Dim2> gun;
    gun.name = "gun";
    gun.type = rigid::BodyType::fixed;
    gun.position = start_ - 0.55 * normalize(speed_);
    gun.rotation = from_angle(float(atan2(speed_.y, speed_.x)));
    rigid::ShapeDef<Dim2> ghost;
    ghost.filter.mask = 0;
    stage.add(gun, geometry::make_box2({0.6f, 0.26f}), ghost, dark);
  }

  void before_step(Stage2& stage) override {
    const std::uint64_t step = stage.world().step_count();
    if (stage.presses("throw") > 0 || step % 90 == 0) shoot(stage);
    for (std::size_t i = balls_.size(); i-- > 0;) {
      const rigid::BodyState<Dim2> ball = stage.at(balls_[i].body);
      const bool in_field = field_low_.x < ball.pose.position.x && ball.pose.position.x < field_high_.x;
      stage.check(stage.world().set_time_scale(balls_[i].body, in_field ? stage.valuef("field") : 1));
      if (ball.pose.position.x < landing() + 4 && ball.awake) continue;
      stage.remove(balls_[i].body);
      balls_.erase(balls_.begin() + std::ptrdiff_t(i));
    }
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    for (int i = 0; i < count_; ++i) {
      const Vec2d d = stage.at(bobs_[i]).pose.position - hook(i);
      const double angle = atan2(d.x, -d.y);
      stage.sample(0, i, t, degrees(angle));
      if (before_[i] * angle < 0) {  // a quarter, three quarters, … of a swing
        const double at = t - angle / (angle - before_[i]) * stage.declaration().dt;
        if (crossings_[i] == 0) first_[i] = at;
        last_[i] = at;
        ++crossings_[i];
      }
      before_[i] = angle;
      stage.line(hook(i), stage.at(bobs_[i]).pose.position, pen(dark));
    }
    for (const Ball& b : balls_) {
      const rigid::BodyState<Dim2> ball = stage.at(b.body);
      if (!b.bounced && ball.pose.position.x < landing() - 0.1)
        off_ = max(off_, abs(ball.pose.position.y - height_at(ball.pose.position.x)));
    }
    if (!balls_.empty() && balls_.front().number == 0) {
      const auto ball = stage.at(balls_.front().body);
      const double v = double(length(ball.linear_velocity));
      stage.sample(1, 0, t, v);
      stage.sample(1, 1, t, v / double(stage.keep(stage.world().body_definition(balls_.front().body)).time_scale));
    }
    draw(stage);
  }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    constexpr const char* names[] = {"swing of the pendulum with s = 1", "with s = ½", "with s = ¼", "with s = ⅛"};
    const double phi = radians(20.0);
    for (int i = 0; i < 3; ++i) {
      const double swing = 2 * (last_[i] - first_[i]) / max(crossings_[i] - 1, 1);
      const double exact = 2 * pi / double(pace(i)) * sqrt(length_ / 9.80665) * (1 + phi * phi / 16);
      out.push_back({names[i], "s", "(2π/s) √(l/g) (1 + φ²/16)", swing, exact, 0.01 * exact});
    }
    out.push_back({"farthest a ball was off its parabola", "m", "y = x tan α − g x²/(2 v² cos² α)", off_, 0, 0.02});
  }

 private:
  struct Ball {
    BodyId body;
    int number = 0;
    bool bounced = false;
  };
  static constexpr int count_ = 4;
  static constexpr double length_ = 2.1;
  static constexpr Vec2d start_{-8.2, 0.75}, speed_{7.2, 8.6};
  static constexpr Vec2d field_low_{-4, 0}, field_high_{0.5, 5.4};

  static Vec2d hook(int i) { return {-6.3 + 4.2 * i, 8.9}; }
  static float pace(int i) { return 1 / float(1 << i); }
  /// Of a ball's centre on its way.
  static double height_at(double x) {
    const double t = (x - start_.x) / speed_.x;
    return start_.y + speed_.y * t - 0.5 * 9.80665 * t * t;
  }
  static double landing() {  // where its underside reaches the floor
    const double v = speed_.y, h = start_.y - radius_;
    return start_.x + speed_.x * (v + sqrt(v * v + 2 * 9.80665 * h)) / 9.80665;
  }
  static constexpr double radius_ = 0.2;

  void shoot(Stage2& stage) {
    rigid::BodyDef<Dim2> body;
    body.name = "ball";
    body.position = start_;
    body.linear_velocity = Vec2f(speed_);
    rigid::ShapeDef<Dim2> shape;
    shape.material.restitution = 0.5f;
    shape.material.rolling_resistance = 0.02f;
    shape.filter.group = -1;
    balls_.push_back({stage.add(body, geometry::Circle{float(radius_)}, shape, orange), thrown_++, false});
  }

  void draw(Stage2& stage) const {
    const std::uint32_t edge = pen(violet, 0xc0), hatch = pen(violet, 0x38);
    const Vec2d a = field_low_, b = field_high_;
    stage.line(a, {a.x, b.y}, edge);
    stage.line({a.x, b.y}, b, edge);
    stage.line(b, {b.x, a.y}, edge);
    for (double y = a.y; y < b.y; y += 0.3) stage.line({a.x, y}, {b.x, y}, hatch);
    Vec2d last = start_;
    for (double x = start_.x; x <= landing(); x += 0.15) {
      const Vec2d next{x, height_at(x)};
      stage.line(last, next, pen(steel, 0x90));
      last = next;
    }
  }

  BodyId bobs_[count_];
  std::vector<Ball> balls_;
  double before_[count_] = {}, first_[count_] = {}, last_[count_] = {}, off_ = 0;
  int crossings_[count_] = {}, thrown_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_time_scale() { return std::make_unique<TimeScale>(); }

}  // namespace carom::host::demo
