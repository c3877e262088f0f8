// A model rocket with two motors from a thrust file, fins, wind and a parachute (chapter 6.4).
#include <algorithm>

#include "apps/host/demos/ballistics/range.h"
#include "carom/ballistics/rocket.h"

namespace carom::host::demo {
namespace {

using ballistics::RocketEvent;

/// What the National Association of Rocketry certified (N s, N, s), of the Estes motors in the file.
struct Certificate {
  const char* name = "";
  double impulse = 0, peak = 0, burn = 0;
};
constexpr Certificate certified[] = {
    {"A8", 2.32, 9.73, 0.73}, {"B6", 4.33, 12.14, 0.86}, {"C6", 8.82, 14.09, 1.86}, {"D12", 16.84, 29.73, 1.65}};

class RocketLaunch final : public Repeatable<RocketLaunch, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "rocket-launch";
    d.title = "Rocket launch";
    d.summary =
        "Thrust from a motor file, mass that burns away, two stages, fins that turn it into the wind, a parachute.";
    d.group = "Ballistics";
    d.chapter = "6.4";
    d.text =
        "What a rocket gains without air and gravity depends on masses and the exhaust speed alone, stage by stage:\n\n"
        "  m dv/dt = F + u dm/dt,   Δv = v_e ln(m₀/m₁)\n\n"
        "Its motors are those of presets/motor/black_powder.eng, in the RASP format, in which hobby rocketry keeps "
        "thrust curves: Estes motors of the classes A to D, each of at most twice the impulse of the class before. "
        "Fins pull the nose toward the air that meets it, with the normal force and centre of pressure of Barrowman's "
        "equations, so that it flies into the wind. At the top the parachute opens; then it sinks at "
        "√(2 m g/(ρ C_D A)). The rocket is drawn thirty times its size.";
    d.duration = 30;
    d.camera = {{0, 110, 330}, {0, 110, 0}};
    d.ground = 0;
    d.parameters = {
        {"stages", "Stages", "", "", "1 or 2", 1, 2, 1, 2, false},
        choice("motor", "Motor", "of each stage", {"A8", "B6", "C6", "D12"}, 2),
        {"fuel", "Propellant", "", "%", "of what the motors hold", 0.2, 1, 0, 1, false},
        {"payload", "Payload", "kg", "g", "", 0, 0.15, 0, 0.02, false},
        {"wind", "Wind", "m/s", "m/s", "from the left", -10, 10, 0.5, 3, false},
        {"tilt", "Tilt of the rail", "rad", "deg", "to the left", -0.5, 0.5, 0, 0, false},
        {"fins", "Span of the fins", "m", "mm", "", 0.02, 0.12, 0, 0.06, false},
        {"parachute", "Diameter of the parachute", "m", "cm", "0: none", 0, 1.2, 0, 0.4, false},
    };
    d.plots = {{"Speed",
                {"time", "s"},
                {"speed", "m/s"},
                {{"rocket"},
                 {"sinks at √(2 m g/ρ C_D A)", Series::Style::points},
                 {"without air: v_e ln(m₀/m) − g t", Series::Style::points}}},
               {"Height", {"time", "s"}, {"height", "m"}, {{"rocket"}, {"lower stage"}}},
               {"Thrust", {"time", "s"}, {"thrust", "N"}, {{"motors"}, {"as certified", Series::Style::points}}},
               {"Mass", {"time", "s"}, {"mass", "g"}, {{"rocket"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    auto motors = ballistics::read_rasp(black_powder_motors(), "presets/motor/black_powder.eng");
    if (!motors.ok()) return stage.fail(motors.error());
    certificate_ = certified[std::size_t(stage.count("motor"))];
    const auto chosen = std::find_if(motors->begin(), motors->end(),
                                     [&](const ballistics::Motor& m) { return m.name == certificate_.name; });
    if (chosen == motors->end())
      return stage.fail(core::Error{std::string("presets/motor/black_powder.eng: no motor ") + certificate_.name});
    whole_ = *chosen;
    ballistics::Motor motor = whole_;
    burn_less(stage, motor, stage.value("fuel"));
    rocket_ = {};
    const int stages = stage.count("stages");
    if (stages == 2)
      rocket_.stages.push_back(
          {.motor = motor, .dry_mass = 0.025, .dry_centre = 0.72, .motor_centre = 0.74, .separation_delay = 0.1});
    rocket_.stages.push_back({.motor = motor,
                              .dry_mass = 0.05 + stage.value("payload"),
                              .dry_centre = 0.34,
                              .motor_centre = stages == 2 ? 0.6 : 0.74,
                              .ignition_delay = stages == 2 ? 0.1 : 0.0});
    rocket_.diameter = 0.025;
    rocket_.length = 0.78;
    rocket_.nose_length = 0.1;
    const double span = stage.value("fins");
    rocket_.fins = {.count = 4, .root_chord = 0.08, .tip_chord = 0.05, .span = span, .sweep = 0.03, .position = 0.7};
    rocket_.drag = rocket_.coasting_drag = ballistics::DragCurve(0.55);
    const double canopy = stage.value("parachute");
    rocket_.parachute = {.drag_area = 1.5 * pi / 4 * canopy * canopy, .deploy_delay = 0.5};
    air_ = {.air = environment::AirColumn::uniform(1.225),
            .wind = environment::WindColumn(Vec3d{stage.value("wind"), 0, 0})};
    const double tilt = stage.value("tilt");
    auto flight =
        ballistics::fly_rocket(rocket_, air_, {.direction = {-sin(tilt), cos(tilt), 0}, .rail_length = 1.2},
                               ballistics::RocketModel::six_degrees, {.time = 300, .ground = 0, .tolerance = 1e-7});
    if (!flight.ok()) return stage.fail(flight.error());
    flight_ = std::move(flight).value();
    body_ = add_marker(stage, "rocket", geometry::Capsule3{0.3f * float(scale_), 0.3f + 0.025f * float(scale_)}, {},
                       orange);
    canopy_ = add_marker(
        stage, "parachute",
        geometry::Ellipsoid{{float(scale_ * canopy / 2), float(scale_ * canopy / 5), float(scale_ * canopy / 2)}},
        {0, -50, 0}, red);
    booster_ = add_marker(stage, "lower stage",
                          geometry::Cylinder{0.07f * float(scale_), 0.3f + 0.025f * float(scale_)}, {0, -50, 0}, blue);
    add_marker(stage, "pad", geometry::Cylinder{0.4f, 5}, {0, 0.4, 0}, dark);
    if (const auto* separation = flight_->first(RocketEvent::separation)) {
      const ballistics::Projectile tumbling{ballistics::DragCurve(1.0), 0.08 * 0.03 / 0.035};
      auto fall =
          ballistics::fly(tumbling, air_, {separation->position, separation->velocity}, {.time = 100, .ground = 0});
      if (!fall.ok()) return stage.fail(fall.error());
      fall_ = std::move(fall).value();
      dropped_ = separation->time;
    }
    if (stage.value("fuel") >= 1)
      for (const ballistics::ThrustPoint& point : rocket_.stages.front().motor.curve.points())
        stage.sample(2, 1, rocket_.stages.front().ignition_delay + point.time, point.thrust);
    const RocketMoment* apex = flight_->first(RocketEvent::apex);
    const double top = (apex != nullptr ? apex->position.y : 50) + 2.2 * scale_;  // with the canopy
    // Where it drifts in half a minute is seen.
    const double middle = 0.5 * flight_->path.at(30).position.x, wide = max(0.62 * top, 0.6 * abs(middle) + 20);
    stage.set_camera({{middle, 0.5 * top, 2.5 * wide}, {middle, 0.47 * top, 0}});
  }

  void after_step(Stage3& stage) override {
    if (!flight_) return;
    const double t = stage.world().time(), end = flight_->path.duration();
    const auto point = flight_->path.at(t);
    const RocketMoment* parachute = flight_->first(RocketEvent::parachute);
    const bool open = parachute != nullptr && t >= parachute->time;
    const Vec3d through = point.velocity - air_.wind.at(0);
    const Vec3d nose = open || length(through) < 1 ? Vec3d{0, 1, 0} : normalize(through);
    const Vec3d middle = point.position + Vec3d{0, 0.35 * scale_, 0};
    stage.check(stage.world().set_pose(body_, middle, turn_of_y(nose)));
    if (open && t < end) {
      const Vec3d canopy = middle + Vec3d{0, 1.2 * scale_, 0};
      stage.check(stage.world().set_pose(canopy_, canopy, {}));
      for (const double side : {-1.0, 1.0})
        stage.line(middle + Vec3d{0, 0.3 * scale_, 0}, canopy + Vec3d{side * 0.25 * scale_, 0, 0}, pen(dark));
    } else {
      stage.check(stage.world().set_pose(canopy_, {0, -50, 0}, {}));
    }
    draw_flight(stage, flight_->path, t, pen(orange, 0xc0), 150);
    if (fall_ && t >= dropped_) {
      const auto fallen = fall_->at(t - dropped_);
      stage.check(
          stage.world().set_pose(booster_, fallen.position + Vec3d{0, 0.5, 0}, turn_of_y({sin(4 * t), cos(4 * t), 0})));
      draw_flight(stage, *fall_, t - dropped_, pen(blue, 0xa0), 60);
      if (t - dropped_ < fall_->duration()) stage.sample(1, 1, t, fallen.position.y);
    } else if (fall_ || rocket_.stages.size() == 2) {
      stage.check(stage.world().set_pose(booster_, middle - 0.4 * scale_ * nose, turn_of_y(nose)));
    }
    const char* name = "on the pad";
    for (const RocketMoment& moment : flight_->events)
      if (moment.time <= t) name = ballistics::to_string(moment.event);
    const double mass = mass_at(t);
    ++steps_;
    if (t <= end) {
      stage.sample(1, 0, t, point.position.y);
      stage.sample(0, 0, t, length(point.velocity));
      stage.sample(2, 0, t, thrust(t));
      stage.sample(3, 0, t, 1000 * mass);
      const ballistics::Motor& first = rocket_.stages.front().motor;
      const double lit = t - rocket_.stages.front().ignition_delay;
      if (lit <= first.curve.burn_time()) {  // up to the first burn-out, by Tsiolkovsky
        const double ideal = first.exhaust_speed() * math::log(flight_->masses.front() / mass) - 9.80665 * lit;
        if (ideal > 0 && steps_ % 6 == 0) stage.sample(0, 2, t, ideal);
      }
      if (open && steps_ % 60 == 0) stage.sample(0, 1, t, hypot(sink_speed(), air_.wind.at(0).x));
    }
    stage.say(std::string(name) + format(": %.1f s, %.0f m high, %.1f m/s, %.0f g", min(t, end),
                                         max(0.0, point.position.y), length(point.velocity), 1000 * mass));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    if (!flight_) return stage.fail(core::Error{"no flight"});
    const auto& points = whole_.curve.points();
    const auto peak = std::max_element(points.begin(), points.end(),
                                       [](const auto& a, const auto& b) { return a.thrust < b.thrust; });
    const std::string source = std::string("NAR's certificate of the Estes ") + certificate_.name;
    out.push_back({"total impulse of the motor file", "N s", source, whole_.curve.total_impulse(), certificate_.impulse,
                   0.002 * certificate_.impulse});
    out.push_back({"peak thrust of the motor file", "N", source, peak->thrust, certificate_.peak, 0.005});
    out.push_back({"burn time of the motor file", "s", source, whole_.curve.burn_time(), certificate_.burn, 0.005});
    out.push_back({"sinking speed", "m/s", "√(2 m g/(ρ C_D A))", -flight_->path.end().velocity.y, sink_speed(), 0.02});
    const RocketMoment *separation = flight_->first(RocketEvent::separation), *apex = flight_->first(RocketEvent::apex);
    const double first = separation != nullptr ? separation->position.y : 0;
    if (rocket_.stages.size() == 2)
      out.push_back({"the upper stage goes on", "", "higher at the top than at the separation",
                     separation != nullptr && apex != nullptr && apex->position.y > 2 * first ? 1.0 : 0.0, 1, 0});
    out.push_back({"into the wind", "", "the top lies to the left of the pad",
                   apex != nullptr && apex->position.x < 0 ? 1.0 : 0.0, 1, 0});
  }

 private:
  using RocketMoment = ballistics::RocketMoment;
  static constexpr double scale_ = 30;
  /// The grain is shorter: it burns as hard, but not as long.
  static void burn_less(Stage3& stage, ballistics::Motor& motor, double share) {
    std::vector<ballistics::ThrustPoint> points = motor.curve.points();
    for (ballistics::ThrustPoint& point : points) point.time *= share;
    motor.curve = stage.keep(ballistics::ThrustCurve::from_points(points));
    motor.mass -= (1 - share) * motor.propellant_mass;
    motor.propellant_mass *= share;
  }
  double mass_at(double t) const {
    const auto nodes = flight_->path.nodes();
    std::size_t i = 0;
    while (i + 1 < nodes.size() && nodes[i + 1].time <= t) ++i;
    return flight_->masses[i];
  }
  double thrust(double t) const {
    double sum = 0;
    for (const RocketMoment& moment : flight_->events)
      if (moment.event == RocketEvent::ignition && moment.time <= t)
        sum += rocket_.stages[std::size_t(min(moment.stage, int(rocket_.stages.size()) - 1))].motor.curve.thrust(
            t - moment.time);
    return sum;
  }
  double sink_speed() const {
    return rocket_.parachute.drag_area > 0
               ? sqrt(2 * flight_->masses.back() * 9.80665 / (1.225 * rocket_.parachute.drag_area))
               : 0;
  }

  Certificate certificate_{};
  ballistics::Motor whole_{};  // as it is in the file
  ballistics::Rocket rocket_{};
  ballistics::Conditions air_{};
  std::optional<ballistics::RocketFlight> flight_;
  std::optional<ballistics::Trajectory> fall_;
  double dropped_ = 0;
  int steps_ = 0;
  rigid::BodyId body_, canopy_, booster_;
};

}  // namespace

std::unique_ptr<Demo> make_rocket_launch() { return std::make_unique<RocketLaunch>(); }

}  // namespace carom::host::demo
