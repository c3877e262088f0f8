// Pitch and hit: a curve ball, a bat that meets it a little low, and a fence (chapters 6.3 and 19).
#include "apps/host/demos/sports/list.h"
#include "carom/math/elementary.h"
#include "carom/sports/game_presets.h"
#include "carom/sports/presets.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

constexpr double ball_foot = 0.3048, ball_mph = 0.44704, plate_distance = 16.764;

/// From the pitcher's frame (x toward the plate) to the field's (x to centre field, home plate at the origin).
Vec3d turned(Vec3d v) { return {-v.x, v.y, -v.z}; }
sports::BallState in_field(const sports::BallState& s) {
  return {turned(s.position) + Vec3d{plate_distance, 0, 0}, turned(s.velocity), turned(s.spin), s.turned};
}

class HomeRun final : public Repeatable<HomeRun, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "home-run";
    d.title = "Home run";
    d.summary = "A pitch with spin, a bat a little below its middle, and a ball that clears the fence or does not.";
    d.group = "Sports";
    d.chapter = "6.3, 19";
    d.text =
        "A pitch breaks because its spin drags air round with it: backspin holds it up, topspin lets it drop, and a "
        "ball hardly spinning flutters by its seams. The bat meets it below the middle, so that the ball leaves with "
        "backspin, and lift carries it farther than vacuum mechanics would allow its drag.\n\n"
        "  v_ball = q v_pitch + (1 + q) v_bat,   q = (e − r)/(1 + r),   r = m/M\n\n"
        "  C_D = .3008 + .0292 (rpm/1000),   C_L = 1.12 S/(.583 + 2.333 S)\n\n"
        "The plots hold this flight beside Nathan's trajectory calculator, whose spins follow from the launch angle: "
        "at 100 mph and 28° it says 402.6 ft. Take the game to a mile's altitude and add twenty feet.";
    d.duration = 8;
    d.camera = {{-20, 10, 6}, {45, 12, -2}, 0.8};
    d.ground = -0.05;
    d.parameters = {
        choice("kind", "Kind of pitch", "",
               {"as set below", "four-seam", "sinker", "cutter", "slider", "sweeper", "curveball", "changeup",
                "splitter"}),
        {"pitch", "Pitch", "m/s", "mph", "at release", 25, 47, 0, 92 * ball_mph, false},
        {"pitch_spin", "Its spin", "rad/s", "rpm", "", 0, 320, 0, 2200 * pi / 30, false},
        {"tilt", "Tilt of its axis", "rad", "deg", "0 backspin (fastball), 180 topspin (curve), 90 sideways", -3.1416,
         3.1416, 0, 0.3, false},
        {"bat", "Bat", "m/s", "mph", "at the point of impact", 15, 42, 0, 74 * ball_mph, false},
        {"attack", "Bat upward", "rad", "deg", "its angle of attack", -0.2, 0.5, 0, radians(11.0), false},
        {"offset", "Bat below the ball", "m", "mm", "its axis under the ball's centre", -0.04, 0.055, 0, 0.015, false},
        {"spray", "Swung toward", "rad", "deg", "positive: right field", -0.8, 0.8, 0, 0, false},
        {"wind", "Wind to centre field", "m/s", "mph", "", -12, 12, 0, 0, false},
        {"altitude", "Altitude of the park", "m", "ft", "", 0, 2500, 0, 0, false},
        {"fence", "Height of the fence", "m", "ft", "", 1, 11.3, 0, 3, false},
    };
    d.plots = {
        {"Side view", {"distance from home", "m"}, {"height", "m"}, {{"hit"}, {"pitch"}, {"the same without spin"}}},
        {"From above", {"to centre field", "m"}, {"to the left", "m"}, {{"hit"}, {"fence"}}},
        {"Carry over launch angle, 100 mph",
         {"launch angle", "deg"},
         {"carry", "m"},
         {{"this model"}, {"trajectory calculator", Series::Style::points}}},
        {"The pitch from the side", {"to the plate", "m"}, {"height", "m"}, {{"thrown"}, {"without spin"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    stage.start(world);
    field(stage);
    const sports::Ball ball = *sports::ball_preset("baseball");
    if (stage.value("altitude") > 0) conditions_.air = environment::AirColumn({}, stage.value("altitude"));
    conditions_.wind = environment::WindColumn(Vec3d{stage.value("wind"), 0, 0});
    sports::Conditions thrown = conditions_;
    thrown.wind = environment::WindColumn(turned(Vec3d{stage.value("wind"), 0, 0}));
    sports::Pitch pitch{.speed = stage.value("pitch"), .spin = stage.value("pitch_spin"), .tilt = stage.value("tilt")};
    if (const int kind = int(stage.value("kind")); kind > 0)
      pitch = sports::pitch_presets()[std::size_t(kind - 1)].value;
    // The pitcher aims at the middle of the zone.
    pitch = stage.keep(sports::aimed(ball, thrown, pitch, 0.75, 0, plate_distance));
    pitch_ = stage.keep(sports::pitch(ball, thrown, pitch, plate_distance));
    if (pitch_.path.nodes().empty()) return;
    const sports::Bat bat;
    const sports::BatSwing swing{.speed = stage.value("bat"),
                                 .attack = stage.value("attack"),
                                 .spray = stage.value("spray"),
                                 .offset = stage.value("offset")};
    sports::BallState hit = stage.keep(sports::hit(ball, bat, swing, pitch_.path.end()));
    hit = in_field(hit);
    launch_ = sports::launch_of(hit);
    hit_ = stage.keep(sports::play(ball, conditions_, hit, *sports::surface_preset("outfield")));
    if (hit_.contacts().empty()) return;
    landing_ = sports::landing(hit_.first_flight());
    sports::Ball plain = ball;
    plain.lift = {};
    if (const auto dull = sports::fly(plain, conditions_, hit, ball.radius))
      for (int i = 0; i <= 60; ++i) {
        const auto p = dull->at(dull->duration() * i / 60).position;
        stage.sample(0, 2, hypot(p.x, p.z), p.y);
      }
    // Does it clear the fence?
    const auto wall = hit_.first_flight().first(
        [&](const sports::BallFlight::Point& p) { return hypot(p.position.x, p.position.z) - fence(p.position); });
    over_ = wall && abs(atan2(wall->position.z, wall->position.x)) < pi / 4 && wall->position.y > stage.value("fence");
    if (wall) at_fence_ = wall->position.y;
    for (int angle = 10; angle <= 46; angle += 2) {
      const sports::CalculatorInput in{.launch_angle = double(angle), .right_handed = true, .height = 3};
      const auto told = sports::trajectory_calculator(in, sports::CalculatorMode::converged);
      if (told) stage.sample(2, 1, angle, told->distance * ball_foot);
      const auto own = sports::fly(ball, {.air = environment::AirColumn::uniform(1.194)},
                                   sports::launch_state({.speed = 100 * ball_mph,
                                                         .elevation = radians(double(angle)),
                                                         .spin = max(0.0, -763 + 120.0 * angle) * pi / 30},
                                                        {0, 0.914, 0}));
      if (own) stage.sample(2, 0, angle, sports::landing(*own).carry);
    }
    for (int i = 0; i <= 40; ++i) {
      const auto p = pitch_.path.at(pitch_.time * i / 40);
      stage.sample(3, 0, p.position.x, p.position.y);
      stage.sample(
          1, 1, fence({cos(pi / 4 * (i / 20.0 - 1)), 0, sin(pi / 4 * (i / 20.0 - 1))}) * cos(pi / 4 * (i / 20.0 - 1)),
          fence({cos(pi / 4 * (i / 20.0 - 1)), 0, sin(pi / 4 * (i / 20.0 - 1))}) * sin(pi / 4 * (1 - i / 20.0)));
    }
    pitch.spin = pitch.gyro = 0;
    if (const auto straight = sports::pitch(ball, thrown, pitch, plate_distance))
      for (int i = 0; i <= 40; ++i) {
        const auto p = straight->path.at(straight->time * i / 40);
        stage.sample(3, 1, p.position.x, p.position.y);
      }
    stage.say(format("pitch: %.0f mph at the plate after %.3f s, breaks %.0f cm up and %.0f cm aside",
                     pitch_.speed / ball_mph, pitch_.time, 100 * pitch_.rise, 100 * pitch_.run));
  }

  void after_step(Stage3& stage) override {
    if (hit_.contacts().empty()) return;
    const double now = stage.world().time() - wait, swing = pitch_.time * slowness;
    const bool flies = now >= swing;
    const double t = max(0.0, now - swing);
    Vec3d at;
    if (!flies) {
      at = in_field(pitch_.path.at(max(0.0, now) / slowness)).position;
      stage.sample(0, 1, at.x, at.y);
      pitch_trail_.add(at);
    } else {
      at = hit_.at(t).position;
      // The fence stops what it is high enough for.
      if (!over_ && hypot(at.x, at.z) > fence(at))
        at = stopped_;
      else
        stopped_ = at;
      if (t < (over_ ? landing_.time : hit_.duration())) {
        stage.sample(0, 0, hypot(at.x, at.z), at.y);
        stage.sample(1, 0, at.x, -at.z);
      }
      trail_.add(at);
      if (!told_) {
        told_ = true;
        stage.say(format("hit: %.0f mph at %.1f°, %.0f rpm of backspin", launch_.speed / ball_mph,
                         degrees(launch_.elevation), launch_.spin * 30 / pi));
      }
      if (!landed_ && t >= landing_.time) {
        landed_ = true;
        const double carry = hypot(landing_.carry, landing_.side) / ball_foot;
        const bool foul = abs(atan2(landing_.side, landing_.carry)) > pi / 4;
        stage.say(foul    ? format("foul ball, %.0f ft", carry)
                  : over_ ? format("home run: %.0f ft, %.0f ft high at the fence, apex %.0f ft", carry,
                                   at_fence_ / ball_foot, landing_.apex / ball_foot)
                          : format("in play: %.0f ft in the air", carry));
      }
    }
    pitch_trail_.draw(stage, pen(gold, 0xd0));
    trail_.draw(stage, pen(red, 0xe0));
    const float size = float(max(0.0369, 0.004 * math::distance(at, Vec3d{-20, 10, 6})));
    const Vec3f where(at);
    stage.points({&where, 1}, size, pen(0xffffff));
    bat(stage, now, swing);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const auto told = stage.keep(sports::trajectory_calculator({}, sports::CalculatorMode::converged));
    out.push_back(
        {"calculator: 100 mph, 28 deg", "ft", "A. M. Nathan, trajectory calculator", told.distance, 402.647661, 0.01});
    out.push_back({"clears the fence", "", "a ball hit that hard and high", over_ ? 1.0 : 0.0, 1, 0});
    out.push_back({"carry", "ft", "calculator's class at this exit speed and angle",
                   hypot(landing_.carry, landing_.side) / ball_foot, 410, 40});
  }

 private:
  static constexpr double slowness = 3, wait = 0.4;

  /// Distance of the fence in a direction: 330 ft at the lines, 400 ft in the middle.
  static double fence(Vec3d p) {
    const double a = abs(atan2(p.z, p.x)) / (pi / 4);
    return (400 - 70 * min(1.5, a * a)) * ball_foot;
  }

  void bat(Stage3& stage, double now, double meets) const {
    // Turns level through the ball's place at the moment of impact.
    const double angle = clamp((now - meets) / slowness * 42, -2.2, 2.0);
    const Vec3d hands{-0.1, 0.8, -0.75}, along{sin(angle), 0.05, cos(angle)};
    for (int i = 0; i < 5; ++i) {
      const double a = 2 * pi * i / 5;
      const Vec3d off{0, 0.02 * sin(a), 0};
      stage.line(hands + off, hands + 0.84 * along + 1.6 * off, pen(0xb9803f));
    }
  }

  void field(Stage3& stage) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    rigid::ShapeDef<Dim3> look;
    look.filter.mask = 0;
    const auto add = [&](const char* name, Vec3d at, const geometry::Shape3& shape, std::uint32_t color,
                         double turn = 0) {
      body.name = name;
      body.position = at;
      body.rotation = Quatf(float(cos(turn / 2)), 0, float(sin(turn / 2)), 0);
      stage.add(body, shape, look, color);
    };
    add("outfield", {60, -0.08, 0}, geometry::Box{{92, 0.05f, 105}}, 0x5f8f47);
    add("infield", {19.4, -0.05, 0}, geometry::Box{{15.5f, 0.04f, 15.5f}}, 0xb98b5e, pi / 4);
    add("grass", {19.4, -0.04, 0}, geometry::Box{{12.2f, 0.045f, 12.2f}}, 0x6da350, pi / 4);
    add("circle", {0, -0.03, 0}, geometry::Cylinder{0.04f, 4}, 0xb98b5e);
    add("mound", {plate_distance + 1.68, -0.02, 0}, geometry::Cylinder{0.1f, 2.7f}, 0xb98b5e);
    add("plate", {0, 0.02, 0}, geometry::Box{{0.22f, 0.01f, 0.22f}}, 0xffffff, pi / 4);
    const double base = 27.43 / 1.41421356;
    for (const Vec3d at : {Vec3d{base, 0.03, base}, Vec3d{2 * base, 0.03, 0}, Vec3d{base, 0.03, -base}})
      add("base", at, geometry::Box{{0.23f, 0.04f, 0.23f}}, 0xffffff, pi / 4);
    const float high = stage.valuef("fence") / 2;
    for (int i = -9; i <= 9; ++i) {
      const double a = i / 9.0 * pi / 4, r = fence({cos(a), 0, sin(a)});
      add("fence", {r * cos(a), high, r * sin(a)}, geometry::Box{{0.3f, high, float(r * 0.0455)}}, 0x2f5d50, -a);
    }
    for (const double side : {-1.0, 1.0}) {
      const double r = 330 * ball_foot / 1.41421356;
      add("foul line", {r / 2, 0.0, side * r / 2}, geometry::Box{{float(r * 0.7071), 0.01f, 0.06f}}, 0xffffff,
          -side * pi / 4);
      add("foul pole", {r, 7, side * r}, geometry::Cylinder{7, 0.15f}, gold);
    }
    for (int i = -12; i <= 12; ++i) {
      const double a = i / 12.0 * pi / 4, r = fence({cos(a), 0, sin(a)}) + 9;
      add("stand", {r * cos(a), 3.0, r * sin(a)}, geometry::Box{{6, 3, 4.2f}}, i % 2 ? 0x8793a1 : 0x97a2af, -a);
    }
  }

  sports::Conditions conditions_{};
  sports::PitchResult pitch_{};
  sports::Shot hit_{};
  sports::Landing landing_{};
  sports::Launch launch_{};
  Trail trail_{0.6, 400}, pitch_trail_{0.2, 200};
  Vec3d stopped_{};
  double at_fence_ = 0;
  bool over_ = false, told_ = false, landed_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_home_run() { return std::make_unique<HomeRun>(); }

}  // namespace carom::host::demo
