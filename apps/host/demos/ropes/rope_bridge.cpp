// A bridge of two ropes with planks between them, and a ball on a rope that swings at it.
#include "apps/host/demos/ropes/draw.h"
#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {
namespace {

using particles::RopeSet;
using rigid::BodyId;
using rigid::Dim3;

class RopeBridge final : public Repeatable<RopeBridge, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "rope-bridge";
    d.title = "A rope bridge and a wrecking ball";
    d.summary =
        "Planks on two ropes sag into their chain line; a ball of half a ton on a light rope comes down on them.";
    d.group = "Ropes and cloth";
    d.chapter = "13";
    d.text =
        "A rope is a row of particles whose segments are drawn tight by one direct solution, together with all the "
        "bodies that hang on it. Light ropes carry heavy loads without giving way: the ball has a thousand times the "
        "mass of a piece of its rope.\n\n"
        "A bridge of weight W that sags by f over a span L pulls at its ends along with about\n\n"
        "  H = W L/8f\n\n"
        "and its ropes bear the more the tighter they are: at an end √(H² + W²/4), shared by both. The rope of a ball "
        "that was let go at the angle θ₀ bears\n\n"
        "  T = m g (3 cos θ − 2 cos θ₀)\n\n"
        "Both are drawn beside what is measured until the ball arrives, as is the parabola of an evenly loaded rope.";
    d.duration = 12;
    d.camera = {{0, 4.5, 15}, {0, 1.2, 0}, 0.7};
    d.ground = -1.5;
    d.parameters = {
        {"slack", "Slack of the ropes", "", "", "length over span, less one", 0.01, 0.1, 0, 0.03, false},
        {"ball", "Mass of the ball", "kg", "kg", "", 50, 2000, 0, 500, false},
        {"strength", "Strength of a rope", "N", "kN", "tension above which it breaks", 2000, 2e5, 0, 60000, false},
    };
    d.plots = {
        {"Tension",
         {"time", "s"},
         {"tension", "kN"},
         {{"bridge"}, {"ball's rope"}, {"bridge, √(H² + W²/4)/2"}, {"ball's rope, mg(3cosθ − 2cosθ₀)"}}},
        {"Line of the deck at 1 s", {"along", "m"}, {"height", "m"}, {{"rope", Series::Style::points}, {"parabola"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(-1.5);
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    for (const double side : {-1.0, 1.0}) {
      def.position = {side * 7, 0, 0};
      stage.add(def, geometry::Box{{1, 1.5f, 1.2f}}, {}, dark);
    }
    particles::RopeMaterial rope{.mass_per_length = 0.8,
                                 .radius = 0.03,
                                 .axial_stiffness = 2e6,
                                 .axial_damping = 4e3,
                                 .drag_coefficient = 1.2,
                                 .break_tension = stage.value("strength")};
    const double length = span_ * (1 + stage.value("slack"));
    const int segments = 2 * planks_ + 1;
    for (int k = 0; k < 2; ++k) {
      const double z = k == 0 ? -0.7 : 0.7;
      std::vector<Vec3d> points;
      for (int i = 0; i <= 60; ++i) points.push_back(deck(stage, i / 60.0) + Vec3d{0, 0, z});
      stage.keep(
          ropes_.add({.material = rope, .points = points, .segments = segments, .length = length, .collide = false}));
      stage.check(ropes_.attach(k, {.node = 0, .point = points[0]}, stage.world()));
      stage.check(ropes_.attach(k, {.node = -1, .point = points.back()}, stage.world()));
    }
    def.type = rigid::BodyType::dynamic;
    def.name = "plank";
    for (int i = 0; i < planks_; ++i) {
      // Two particles of each rope are lashed to it, so that it does not turn over.
      const int node = 2 * i + 1;
      const auto line = ropes_.positions(0);
      const Vec3d before = line[std::size_t(node)], after = line[std::size_t(node) + 1];
      const Vec3d at = 0.5 * (before + after);
      const double half = 0.5 * distance(before, after),
                   tilt = 0.5 * math::atan2(after.y - before.y, after.x - before.x);
      def.rotation = {float(math::cos(tilt)), 0, 0, float(math::sin(tilt))};
      def.position = {at.x, at.y, 0};
      rigid::ShapeDef<Dim3> shape;
      shape.density = 500;
      const BodyId plank = stage.add(def, geometry::Box{{0.2f, 0.04f, 0.75f}}, shape, sand);
      weight_ += 9.80665 * 500 * 0.4 * 0.08 * 1.5;
      for (int k = 0; k < 4; ++k)
        stage.check(ropes_.attach(
            k % 2, {.node = node + k / 2, .body = plank, .point = {k < 2 ? -half : half, 0, k % 2 == 0 ? -0.7 : 0.7}},
            stage.world()));
    }
    // The ball hangs from a gallows, drawn aside.
    ball_at_ = Vec3d{0, gallows_, 0} + reach_ * Vec3d{0, -0.5, -0.866};
    def.rotation = {};
    def.name = "ball";
    def.position = ball_at_;
    rigid::ShapeDef<Dim3> heavy;
    const double radius = 0.5;
    heavy.density = float(stage.value("ball") / (4.0 / 3 * math::pi * radius * radius * radius));
    ball_ = stage.add(def, geometry::Sphere{float(radius)}, heavy, red);
    const Vec3d points[] = {{0, gallows_, 0}, ball_at_};
    stage.keep(
        ropes_.add({.material = {.mass_per_length = 2, .radius = 0.025, .axial_stiffness = 5e6, .axial_damping = 2e4},
                    .points = points,
                    .segments = 24,
                    .collide = false}));
    stage.check(ropes_.attach(2, {.node = 0, .point = points[0]}, stage.world()));
    stage.check(ropes_.attach(2, {.node = -1, .body = ball_}, stage.world()));
  }

  void before_step(Stage3& stage) override { stage.check(ropes_.step(stage.world(), stage.declaration().dt)); }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int k = 0; k < 3; ++k) draw_rope(stage, ropes_, k, k == 2 ? 0x40404aff : 0x6b5537ff);
    double bridge = 0;
    for (int k = 0; k < 2; ++k)
      for (const double tension : ropes_.tensions(k)) bridge = max(bridge, tension);
    stage.sample(0, 0, t, 1e-3 * bridge);
    stage.sample(0, 1, t, 1e-3 * ropes_.peak_tension(2));
    compare(stage, t, bridge);
    broken_ += int(ropes_.breaks().size());
    for (const auto& event : ropes_.breaks()) stage.say(format("a rope broke at %.1f kN", 1e-3 * event.tension));
    stretch_ = max(stretch_, ropes_.length(2) / ropes_.rest_length(2) - 1);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"stretch of the ball's rope, most", "", "1 : 1000 without stretch, below 1 %", stretch_, 0, 0.01});
    out.push_back({"mean tension of the bridge before, over √(H² + W²/4)/2", "", "parabola of an evenly loaded rope",
                   rest_ / max(rests_, 1), 1, 0.08});
    out.push_back({"deck at 1 s, farthest from the parabola over its sag", "", "parabola of an evenly loaded rope",
                   bent_, 0, 0.05});
    out.push_back({"tension of the ball's rope as it arrives, over mg(3cosθ − 2cosθ₀)", "", "pendulum; a rope of 13 kg",
                   swing_, 1, 0.03 + 13 / stage.value("ball")});
    out.push_back({"ropes that broke", "", "they bear the ball", double(broken_), 0, 0});
  }
  std::uint64_t state_hash(std::uint64_t world) const override { return world ^ ropes_.state_hash(); }

 private:
  static constexpr double span_ = 12, gallows_ = 7.4, reach_ = 6.7;

  void compare(Stage3& stage, double t, double bridge) {
    const Vec3d ball = stage.at(ball_).pose.position;
    const double cosine = (gallows_ - ball.y) / distance(ball, Vec3d{0, gallows_, 0});
    if (arrived_ || cosine < last_cosine_ || ball.z > -1.3) {
      arrived_ = true;
      return;
    }
    last_cosine_ = cosine;
    const auto line = ropes_.positions(0);
    double lowest = line.front().y;
    for (const Vec3d& p : line) lowest = min(lowest, double(p.y));
    const double sag = line.front().y - lowest, weight = weight_ + 2 * 9.80665 * 0.8 * ropes_.length(0);
    const double along = weight * span_ / (8 * sag), expected = 0.5 * math::hypot(along, 0.5 * weight);
    const double swing = stage.value("ball") * 9.80665 * (3 * cosine - 2 * 0.5);
    stage.sample(0, 2, t, 1e-3 * expected);
    stage.sample(0, 3, t, 1e-3 * swing);
    if (t > 0.3) {  // it sways a little from the start: the mean
      rest_ += bridge / expected;
      ++rests_;
    }
    swing_ = ropes_.peak_tension(2) / swing;
    if (drawn_ || t < 0.99) return;
    drawn_ = true;
    for (const Vec3d& p : line) {
      stage.sample(1, 0, p.x, p.y);
      const double u = 2 * p.x / span_;
      bent_ = max(bent_, math::abs(p.y - (line.front().y - sag * (1 - u * u))) / sag);
    }
    for (int i = 0; i <= 48; ++i) {
      const double u = i / 24.0 - 1;
      stage.sample(1, 1, 0.5 * span_ * u, line.front().y - sag * (1 - u * u));
    }
  }
  /// The line of the deck: a parabola as long as the ropes, length/span = 1 + 8/3 (f/L)².
  Vec3d deck(Stage3& stage, double t) {
    const double sag = 12 * math::sqrt(0.375 * stage.value("slack")), u = 2 * t - 1;
    return {6 * u, 1.6 - sag * (1 - u * u), 0};
  }
  static constexpr int planks_ = 19;
  RopeSet ropes_;
  BodyId ball_{};
  Vec3d ball_at_{};
  double stretch_ = 0, weight_ = 0, rest_ = 0, swing_ = 0, bent_ = 0, last_cosine_ = 0;
  int rests_ = 0;
  bool arrived_ = false, drawn_ = false;
  int broken_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_rope_bridge() { return std::make_unique<RopeBridge>(); }

}  // namespace carom::host::demo
