// A golf swing to edit: two or three links, torques, the moment the wrists open, a shaft that bends
// (chapters 19.1, 19.2).
#include "carom/sports/golf_swing.h"
#include "apps/host/demos/sports/list.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::Dim2;

class GolfSwing final : public Repeatable<GolfSwing, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "golf-swing";
    d.title = "Golf swing editor";
    d.summary = "Arms and club as a double pendulum: torque, wrist cock and release decide how fast the head arrives.";
    d.group = "Sports";
    d.chapter = "19.1, 19.2";
    d.dimension = 2;
    d.text =
        "The arms turn about the shoulders under the torque Q_s, the club hangs from the hands. While the wrists are "
        "held cocked both turn as one; then the club's own inertia swings it out, slows the arms, and takes their "
        "energy.\n\n"
        "  (J + M R²) φ̈ + R S cos(φ−ψ) ψ̈ + R S sin(φ−ψ) ψ̇² + (S_A + M R) g sin φ = Q_s − Q_w\n\n"
        "  I ψ̈ + R S cos(φ−ψ) φ̈ − R S sin(φ−ψ) φ̇² + S g sin ψ = Q_w\n\n"
        "The textbook's swing starts 135° back with the wrists cocked by 90° against a stop that cannot pull: it lets "
        "go by itself, and the head passes straight down after .286 s with 43.2 m/s. Hold the wrists longer (a late "
        "hit) and see what it brings; push with them early, and see what it costs. A shaft that bends first lags, then "
        "springs forward and adds loft.\n\n"
        "With three links the arm hangs from a shoulder that turns about the spine: the trunk is driven by Q_s, the "
        "arm by Q_a against it, and a stop holds the arm across the chest until it, too, would part by itself. Energy "
        "comes from the torques alone, whatever the links do to each other: Q_s Δθ₁ + Q_a (Δθ₂ − Δθ₁).\n\n"
        "What you see runs four times slower than it is.";
    d.dt = 1.0 / 60;
    d.duration = 2;
    d.loop = true;
    d.camera.target = {0, -0.2, 0};
    d.camera.height = 4.4;
    d.camera.width = 5;
    d.parameters = {
        {"shoulders", "Torque of the shoulders Q_s", "N*m", "N*m", "", 30, 250, 1, 100, false},
        {"wrists", "Torque of the wrists Q_w", "N*m", "N*m", "once they are free", -30, 30, 0.5, 0, false},
        {"hold", "Hold the wrists for", "s", "s", "0: a stop lets go by itself", 0, 0.35, 0.005, 0, false},
        {"back", "Arms back", "rad", "deg", "", 1.2, 3.2, 0, radians(135.0), false},
        {"cock", "Wrist cock", "rad", "deg", "", 0.3, 2.2, 0, radians(90.0), false},
        {"head", "Club head", "kg", "g", "", 0.1, 0.4, 0.005, 0.2, false},
        {"length", "Club length", "m", "m", "", 0.8, 1.3, 0.01, 1.1, false},
        {"arm", "Arm length", "m", "m", "", 0.5, 0.8, 0.01, 0.66, false},
        {"plane", "Plane over the horizon", "rad", "deg", "90° is the textbook's upright plane", 0.7, 1.5708, 0,
         1.5707963267948966, false},
        {"hub", "Shoulders move", "m/s^2", "m/s^2", "acceleration toward the target", -20, 20, 0.5, 0, false},
        {"shaft", "Shaft", "Hz", "Hz", "clamped at the grip; 0: stiff; tour drivers 4 to 4.7", 0, 8, 0.1, 0, false},
        {"links", "Links", "", "", "2: arms and club, 3: shoulders, arm and club", 2, 3, 1, 2, false},
        {"arms", "Torque of the arm Q_a", "N*m", "N*m", "of three links: against the shoulders", 0, 120, 1, 40, false},
    };
    const Axis time{"time", "s"};
    d.plots = {{"Speed of the head",
                time,
                {"speed", "m/s"},
                {{"head"}, {"hands"}, {"textbook at the ball", Series::Style::points, {{0.2862, 43.23}}}}},
               {"Angles", time, {"from straight down", "deg"}, {{"arms"}, {"club"}, {"shoulders, of three links"}}},
               {"Where the energy is", time, {"kinetic energy", "J"}, {{"arms"}, {"club"}}},
               {"Shaft", time, {"bend at the head", "mm"}, {{"bend"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<Dim2> world;
    world.gravity = {};
    stage.start(world);
    swing_ = sports::textbook_swing();
    const bool three = stage.count("links") == 3;
    if (three) swing_.links.insert(swing_.links.begin(), sports::three_link_swing().links[0]);
    club_ = three ? 2 : 1;
    const double head = stage.value("head"), length = stage.value("length"), shaft = 0.14, arm = stage.value("arm");
    sports::SwingLink &arms = swing_.links[club_ - 1], &club = swing_.links[club_];
    arms.length = arm;
    arms.centre = arm / 2;
    arms.inertia = arms.mass * arm * arm / 12;
    arms.angle = -stage.value("back");
    arms.torque = sports::Curve::constant(stage.value(three ? "arms" : "shoulders"));
    if (three) {
      // As far ahead of the arm as in the preset; held across the chest.
      sports::SwingLink& trunk = swing_.links[0];
      trunk.angle = arms.angle + radians(65.0);
      trunk.torque = sports::Curve::constant(stage.value("shoulders"));
      arms.hold = {.until = sports::Hold::Until::opens};
    }
    club.mass = head + shaft;
    club.length = length;
    club.centre = (head + shaft / 2) * length / club.mass;
    club.inertia = (head + shaft / 3) * length * length - club.mass * club.centre * club.centre;
    club.angle = arms.angle - stage.value("cock");
    if (stage.value("hold") > 0) club.hold = {.until = sports::Hold::Until::time, .time = stage.value("hold")};
    swing_.plane = stage.value("plane");
    swing_.hub = sports::Curve::constant(stage.value("hub"));
    swing_.shaft = {.frequency = stage.value("shaft"), .head_mass = head, .shaft_mass = shaft};
    // The torque of the wrists acts from when they are free; that moment is known after a first swing.
    result_ = stage.keep(sports::swing(swing_));
    const double wrists = stage.value("wrists");
    if (wrists != 0 && !result_.nodes.empty()) {
      const double free = max(1e-6, result_.release[club_]);
      club.hold = {.until = sports::Hold::Until::time, .time = free};
      club.torque = {{{free, 0}, {free + 1e-3, wrists}}};
      result_ = stage.keep(sports::swing(swing_));
    }
    if (result_.nodes.empty()) return;
    plots(stage);
    if (!result_.impact) return stage.say("the head does not come down to the ball within two seconds");
    const std::string freed = three ? format("arm free after %.4f s, ", result_.release[1]) : std::string{};
    stage.say(format("head %.2f m/s after %.4f s; ", result_.speed, result_.time) + freed +
              format("wrists open after %.4f s; attack %.1f°; the shaft adds %.1f° of loft", result_.release[club_],
                     degrees(result_.attack), degrees(result_.added_loft)));
  }

  void after_step(Stage2& stage) override {
    if (result_.nodes.empty()) return;
    constexpr double slowness = 4;
    const double end = result_.time, now = min(end, stage.world().time() / slowness);
    for (int i = 0; i <= 12; ++i) {
      const double t = end * i / 12;
      if (t <= now) figure(stage, t, true);
    }
    figure(stage, now, false);
    Vec2d head = at(0, club_), hands = at(0, club_ - 1);
    for (int i = 1; i <= 90; ++i) {
      const double t = end * i / 90;
      if (t > now) break;
      const Vec2d a = at(t, club_), b = at(t, club_ - 1);
      stage.line(head, a, pen(orange));
      stage.line(hands, b, pen(blue, 0xa0));
      head = a;
      hands = b;
    }
    // The ball lies where the head meets it.
    const Vec2d ball = at(end, club_);
    stage.line(Vec2d{-1.4, ball.y - 0.05}, Vec2d{1.6, ball.y - 0.05}, pen(green));
    circle(stage, ball + Vec2d{0.07, -0.01}, 0.035, pen(red));
    circle(stage, {0, 0}, 0.07, pen(steel));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    if (club_ == 2) {
      // No torque of the wrists, a stiff shaft and a hub at rest: the energy is the work of two torques.
      const sports::SwingState from = sports::swing_start(swing_), to = result_.at(result_.time);
      const double trunk = to.angle[0] - from.angle[0], arm = to.angle[1] - from.angle[1];
      const double work = stage.value("shoulders") * trunk + stage.value("arms") * (arm - trunk);
      out.push_back({"energy gained", "J", "the work of the torques",
                     sports::swing_energy(swing_, to) - sports::swing_energy(swing_, from), work, 1e-6});
      return;
    }
    const char* source = "textbook's double pendulum, its step .1 ms";
    out.push_back({"head speed at the ball", "m/s", source, result_.speed, 43.23, 0.01});
    out.push_back({"time", "s", source, result_.time, 0.2862, 1e-4});
  }

 private:
  Vec2d at(double t, std::size_t joint) const { return sports::swing_point(swing_, result_.at(t), joint); }

  /// A shadow is drawn paler: a page draws lines without transparency.
  void figure(Stage2& stage, double t, bool shadow) const {
    const sports::SwingState s = result_.at(t);
    const Vec2d hands = at(t, club_ - 1), head = at(t, club_), shoulder = club_ == 2 ? at(t, 0) : Vec2d{};
    const auto thick = [&](Vec2d a, Vec2d b, std::uint32_t color) {
      const Vec2d along = b - a, across = Vec2d{-along.y, along.x} * (0.008 / max(1e-9, length(along)));
      for (int i = -1; i <= 1; ++i) stage.line(a + double(i) * across, b + double(i) * across, pen(color));
    };
    if (shadow)
      stage.line(shoulder, hands, pen(0xa9c4e8));
    else
      thick(shoulder, hands, blue);
    if (!shadow && club_ == 2) thick({}, shoulder, teal);
    // The bent shaft: its first mode.
    const double angle = s.angle[club_], span = swing_.links[club_].length;
    const Vec2d along{sin(angle), -cos(angle)}, across{cos(angle), sin(angle)};
    Vec2d last = hands;
    for (int i = 1; i <= 10; ++i) {
      const double x = i / 10.0;
      const Vec2d p = hands + (x * span) * along + (s.bend * 0.5 * x * x * (3 - x)) * across;
      if (shadow)
        stage.line(last, p, pen(0xb4bcc6));
      else
        thick(last, p, 0x2b3138);
      last = p;
    }
    if (!shadow) thick(head - 0.06 * across, head + 0.03 * across, orange);
  }

  static void circle(Stage2& stage, Vec2d center, double radius, std::uint32_t color) {
    for (int i = 0; i < 16; ++i) {
      const double a = 2 * pi * i / 16, b = 2 * pi * (i + 1) / 16;
      stage.line(center + radius * Vec2d{cos(a), sin(a)}, center + radius * Vec2d{cos(b), sin(b)}, color);
    }
  }

  void plots(Stage2& stage) {
    for (int i = 0; i <= 120; ++i) {
      const double t = result_.time * i / 120;
      const sports::SwingState s = result_.at(t);
      sports::Swing still = swing_;
      still.gravity = 0;
      // All but the club, as a swing of its own; of one link alone in closed form.
      sports::Swing body = still;
      body.links.pop_back();
      body.shaft = {};
      const sports::SwingLink& arms = swing_.links[club_ - 1];
      Vec2d hands{};
      for (std::size_t i = 0; i < club_; ++i)
        hands += s.rate[i] * swing_.links[i].length * Vec2d{cos(s.angle[i]), sin(s.angle[i])};
      stage.sample(0, 0, t, length(sports::head_velocity(swing_, t, s)));
      stage.sample(0, 1, t, length(hands));
      stage.sample(1, 0, t, degrees(s.angle[club_ - 1]));
      stage.sample(1, 1, t, degrees(s.angle[club_]));
      if (club_ == 2) stage.sample(1, 2, t, degrees(s.angle[0]));
      const double own = club_ == 2 ? sports::swing_energy(body, s)
                                    : 0.5 * (arms.inertia + arms.mass * square(arms.centre)) * square(s.rate[0]);
      stage.sample(2, 0, t, own);
      stage.sample(2, 1, t, sports::swing_energy(still, s) - own);
      stage.sample(3, 0, t, 1e3 * s.bend);
    }
  }

  std::size_t club_ = 1;  // the last link
  sports::Swing swing_{};
  sports::SwingResult result_{};
};

}  // namespace

std::unique_ptr<Demo> make_golf_swing() { return std::make_unique<GolfSwing>(); }

}  // namespace carom::host::demo
