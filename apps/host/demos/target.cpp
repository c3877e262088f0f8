// A cannon, a target, and the two arcs that lead to it (chapter 2.5, 2.6).
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Target final : public Repeatable<Target, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "hit-the-target";
    d.title = "Hit the target";
    d.summary = "Aim a cannon by muzzle speed and two angles; the low and the high arc that would hit are drawn.";
    d.group = "Kinematics";
    d.chapter = "2.5, 2.6";
    d.text =
        "A shell leaves the muzzle with speed V at the angle α from the vertical and γ to the side, and then only "
        "gravity acts.\n\n"
        "  s = s₀ + L d + V d t − ½ g t² ŷ,   d = (sin α cos γ, cos α, sin α sin γ)\n\n"
        "To hit a point x away and y higher, two elevations will do (or none, when it is out of reach):\n\n"
        "  tan θ = (V² ± √(V⁴ − g (g x² + 2 y V²))) / (g x)\n\n"
        "The test for a hit sweeps the shell along its path, so that a fast shell never slips through between two "
        "steps. With the values one finds here (600 m away, 75 m up, 100 m/s) the low arc starts at 26.10°.";
    d.duration = 12;
    d.camera = {{260, 210, 930}, {300, 185, 0}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Muzzle speed V", "m/s", "m/s", "", 20, 200, 0.5, 100, true},
        {"alpha", "Angle from the vertical α", "rad", "deg", "90° is level", 0, 1.5707, 0, radians(90 - 26.1023), true},
        {"gamma", "Angle to the side γ", "rad", "deg", "", -0.8, 0.8, 0, 0, true},
        {"barrel", "Length of the barrel L", "m", "m", "", 0, 40, 0.5, 0, true},
        {"height", "Height of the base", "m", "m", "", 0, 100, 1, 0, true},
        {"target_x", "Target: how far", "m", "m", "", 100, 1500, 5, 600, false},
        {"target_y", "Target: how high", "m", "m", "its centre", 10, 300, 1, 75, false},
        {"target_z", "Target: to the side", "m", "m", "", -400, 400, 5, 0, false},
        {"size", "Size of the target", "m", "m", "edge of the cube", 4, 80, 1, 30, false},
        yes_or_no("assist", "Aim assist", "draw the arcs that hit", true, true),
    };
    d.plots = {{"Side view", {"distance", "m"}, {"height", "m"}, {{"shell"}, {"formula", Series::Style::points}}},
               {"Height", {"time since the shot", "s"}, {"height", "m"}, {{"shell"}}}};
    d.inputs = {{"fire", "Fire", {"Space", "Enter"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {0, -float(g_), 0};
    stage.start(world);
    rigid::Material soil;
    soil.friction = 0.9f;
    stage.floor(0, soil);
    const float half = stage.valuef("size") / 2;
    target_ = {stage.value("target_x"), stage.value("target_y"), stage.value("target_z")};
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = "target";
    body.position = target_;
    stage.add(body, geometry::Box{{half, half, half}}, {}, red);
    const float mast = float(target_.y) - half;
    if (mast > 0.5f) {
      body.name = "mast";
      body.position.y = mast / 2;
      stage.add(body, geometry::Box{{half * 0.25f, mast / 2, half * 0.25f}}, {}, dark);
    }
    body.type = rigid::BodyType::kinematic;
    body.name = "cannon";
    rigid::ShapeDef<Dim3> tube;
    tube.local.p = {0, 7, 0};
    // The cannon is only looked at.
    rigid::ShapeDef<Dim3> carriage;
    tube.filter.mask = carriage.filter.mask = 0;
    cannon_ = stage.add(body, {{geometry::Cylinder{9, 2.2f}, tube}, {geometry::Sphere{5}, carriage}}, steel);
    aim(stage);
  }

  void before_step(Stage3& stage) override {
    aim(stage);
    const bool first = shots_ == 0 && stage.world().time() >= 0.5;
    if (stage.presses("fire") > 0 || first) fire(stage);
  }

  void after_step(Stage3& stage) override {
    if (stage.value("assist") > 0.5) arcs(stage);
    follow(stage);
    trail_.draw(stage, pen(gold));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const double low = degrees(elevation(100, 600, 75, false).value_or(0));
    out.push_back({"low arc to (600, 75) m at 100 m/s", "deg", "ch. 2.6", low, 26.1023, 1e-4});
    const double flight = (585 - shell_radius_) / (100 * cos(radians(26.1023)));
    out.push_back(
        {"time until the shell touches the near face", "s", "ch. 2.6: x = V t cos θ", hit_time_, flight, 0.02});
    out.push_back({"hits", "", "the arc leads to the target", double(hits_), 1, 0});
  }

 private:
  static constexpr double g_ = 9.81;
  static constexpr float shell_radius_ = 2;

  static Vec3d direction(Stage3& stage) {
    const double a = stage.value("alpha"), b = stage.value("gamma");
    return {sin(a) * cos(b), cos(a), sin(a) * sin(b)};
  }

  void aim(Stage3& stage) {
    // The barrel lies along the body's y axis; turn y onto the direction of fire.
    const Vec3d d = direction(stage);
    const Quatd q = normalize(Quatd{1 + d.y, cross(Vec3d{0, 1, 0}, d)});
    stage.check(stage.world().set_pose(cannon_, {0, stage.value("height"), 0}, Quatf(q)));
  }

  void fire(Stage3& stage) {
    ++shots_;
    const Vec3d d = direction(stage);
    const Vec3d muzzle = Vec3d{0, stage.value("height"), 0} + stage.value("barrel") * d;
    const double v = stage.value("speed");
    if (shells_.size() >= 10) {
      stage.remove(shells_.front());
      shells_.erase(shells_.begin());
    }
    rigid::BodyDef<Dim3> body;
    body.name = "shell";
    body.position = muzzle;
    body.linear_velocity = Vec3f(v * d);
    body.bullet = true;
    rigid::ShapeDef<Dim3> shape;
    shape.density = 7850;
    shape.material.restitution = 0.3f;
    shape.material.rolling_resistance = 0.1f;
    // In flight it meets nothing but gravity, as in the formula; what it hits is found by the sweep in `follow`.
    shape.filter.mask = 0;
    shells_.push_back(stage.add(body, geometry::Sphere{shell_radius_}, shape, dark));
    shot_time_ = stage.world().time();
    start_ = last_ = muzzle;
    velocity_ = v * d;
    in_flight_ = true;
    trail_.clear();
    stage.say("in flight");
    const double flight = velocity_.y / g_ + sqrt(square(velocity_.y / g_) + 2 * start_.y / g_);
    for (int i = 0; i <= 40; ++i) {
      const double t = flight * i / 40;
      stage.sample(0, 1, length2(path(t)), path(t).y);
    }
  }

  Vec3d path(double t) const { return start_ + velocity_ * t - Vec3d{0, 0.5 * g_ * t * t, 0}; }
  static double length2(Vec3d p) { return hypot(p.x, p.z); }

  void follow(Stage3& stage) {
    if (shells_.empty()) return;
    const Vec3d p = stage.at(shells_.back()).pose.position;
    const double t = stage.world().time() - shot_time_;
    trail_.add(p);
    if (!in_flight_) return;
    stage.sample(0, 0, length2(p), p.y);
    stage.sample(1, 0, t, p.y);
    // The shell's surface against the target: its centre against a cube grown by the radius.
    const double half = stage.value("size") / 2;
    const double entry = sweep(last_, p, half + shell_radius_);
    if (entry <= 1) {
      ++hits_;
      // From where it touched, not from within.
      stage.check(stage.world().set_pose(shells_.back(), last_ + entry * (p - last_), {}));
      land(stage);
      hit_time_ = t - stage.declaration().dt * (1 - entry);
      stage.say(
          format("hit after %.2f s at %.0f m/s", hit_time_, length(Vec3d(stage.at(shells_.back()).linear_velocity))));
    } else if (p.y <= shell_radius_ && velocity_.y - g_ * t < 0) {
      land(stage);
      const double off = distance(Vec3d{p.x, 0, p.z}, Vec3d{target_.x, 0, target_.z});
      stage.say(format("ground after %.2f s, %.1f m away; %.0f m from the target", t, length2(p), off));
    } else if (t > 60) {
      land(stage);
      stage.say("timed out after 60 s");
    }
    last_ = p;
  }

  /// From the first hit on, the shell is a body among others.
  void land(Stage3& stage) {
    in_flight_ = false;
    std::vector<rigid::ShapeId> shapes;
    stage.world().shapes(shells_.back(), shapes);
    for (const rigid::ShapeId shape : shapes) stage.check(stage.world().set_filter(shape, {}));
  }

  /// The fraction of the way from a to b at which the segment enters the target's cube, or 2.
  double sweep(Vec3d a, Vec3d b, double half) const {
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double from = a[axis] - target_[axis], way = b[axis] - a[axis];
      if (way == 0) {
        if (abs(from) > half) return 2;
        continue;
      }
      const double one = (-half - from) / way, two = (half - from) / way;
      enter = max(enter, min(one, two));
      leave = min(leave, max(one, two));
    }
    return enter <= leave ? enter : 2;
  }

  static std::optional<double> elevation(double v, double x, double y, bool high) {
    const double root = v * v * v * v - g_ * (g_ * x * x + 2 * y * v * v);
    if (root < 0 || x <= 0) return {};
    return atan((v * v + (high ? 1 : -1) * sqrt(root)) / (g_ * x));
  }

  void arcs(Stage3& stage) {
    const Vec3d base{0, stage.value("height"), 0};
    const double x = hypot(target_.x, target_.z), y = target_.y - base.y, v = stage.value("speed");
    for (const bool high : {false, true}) {
      const std::optional<double> theta = elevation(v, x, y, high);
      if (!theta) continue;
      const Vec3d horizontal{target_.x / x, 0, target_.z / x};
      const double vx = v * cos(*theta), vy = v * sin(*theta), flight = x / vx;
      Vec3d last = base;
      for (int i = 1; i <= 48; ++i) {
        const double t = flight * i / 48;
        const Vec3d p = base + horizontal * (vx * t) + Vec3d{0, vy * t - 0.5 * g_ * t * t, 0};
        if (i % 2 == 0) stage.line(last, p, pen(high ? teal : blue, 0xb0));
        last = p;
      }
    }
  }

  rigid::BodyId cannon_;
  std::vector<rigid::BodyId> shells_;
  Trail trail_{2, 300};
  Vec3d target_{}, start_{}, velocity_{}, last_{};
  double shot_time_ = 0, hit_time_ = 0;
  int shots_ = 0, hits_ = 0;
  bool in_flight_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_target() { return std::make_unique<Target>(); }

}  // namespace carom::host::demo
