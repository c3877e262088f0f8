// A gun that leads a target which turns as it likes, with drag and wind (chapter 18.2).
#include "apps/host/demos/ballistics/range.h"
#include "carom/ballistics/aim.h"
#include "carom/ballistics/body_flight.h"

namespace carom::host::demo {
namespace {

using ballistics::Trajectory;
using rigid::Dim3;

class Turret final : public Repeatable<Turret, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "turret";
    d.title = "Leading a moving target";
    d.summary = "Both arcs that would hit a target on any path, with drag and wind, or the honest answer: no solution.";
    d.group = "Ballistics";
    d.chapter = "18.2";
    d.text =
        "For every time of flight T there is one muzzle velocity u(T) that brings the shell to where the target will "
        "be. The gun can give it where\n\n"
        "  |u(T) − v_gun| = v_muzzle\n\n"
        "The earliest such T is the low arc (blue), the latest the high one (teal). Where the speed to spare stays "
        "below zero there is no solution, and the gun holds its fire. The target here flies a figure that the solver "
        "knows only as a function of time. A lead for its velocity alone would miss, by what it turns and speeds up in "
        "the "
        "time of flight (second plot); aims in vacuum (first plot) tell what air is worth. Shells are bodies of the "
        "world that an effector "
        "lets fly by the same drag curve. The gun may ride to and fro on a rail across the range: it gives its own "
        "velocity to every shell, and the solver takes it into account. Double the range, or let the muzzle speed "
        "fall, to see the arcs meet and vanish.";
    d.duration = 24;
    d.camera = {{-60, 230, 640}, {250, 150, -40}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Muzzle speed", "m/s", "m/s", "", 40, 400, 5, 110, true},
        {"terminal", "Terminal speed of the shell", "m/s", "m/s", "small: much drag", 40, 400, 5, 110, false},
        {"wind", "Wind across", "m/s", "m/s", "", -20, 20, 0.5, 8, false},
        {"range", "Distance of the target", "m", "m", "of the middle of its path", 100, 1500, 10, 420, true},
        {"pace", "Speed of the target", "m/s", "m/s", "at most", 0, 60, 1, 30, false},
        choice("high", "Arc", "that is fired", {"low", "high"}, 0, true),
        {"rate", "Time between shots", "s", "s", "", 0.5, 5, 0.1, 1.5, true},
        {"own", "Speed of the gun", "m/s", "m/s", "at most, to and fro on 120 m of rail", 0, 40, 1, 0, false},
    };
    d.plots = {{"Elevation",
                {"time", "s"},
                {"elevation", "deg"},
                {{"low arc"}, {"high arc"}, {"low arc in vacuum"}, {"high arc in vacuum"}}},
               {"Miss of each shell",
                {"time", "s"},
                {"distance", "m"},
                {{"nearest", Series::Style::points}, {"if led as though it flew straight on", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    wind_ = {0, 0, stage.value("wind")};
    air_ = {.air = environment::AirColumn::uniform(1.225), .wind = environment::WindColumn(wind_)};
    shell_ = ballistics::projectile_from_terminal_speed(stage.value("terminal"));
    own_ = stage.value("own");
    base_ = add_marker(stage, "base", geometry::Cylinder{3, 9}, {0, 3, 0}, dark);
    barrel_ = add_marker(stage, "barrel", geometry::Cylinder{14, 1.8f}, muzzle_, steel);
    range_ = stage.value("range");
    pace_ = stage.value("pace");
    target_ = add_marker(stage, "target", geometry::Sphere{target_radius_}, place(0), red);
  }

  void before_step(Stage3& stage) override {
    const double t = stage.world().time();
    // The path is the target's own; when the slider moves it, the solver sees the new one at the next shot.
    range_ = stage.value("range");
    stage.check(stage.world().set_pose(target_, place(t + stage.declaration().dt), {}));
    if (t + 1e-9 < next_) return;
    next_ = t + stage.value("rate");
    const ballistics::Shooter gun{
        .muzzle_speed = stage.value("speed"), .muzzle = muzzle(t), .velocity = gun_velocity(t)};
    const double pace = stage.value("pace"), range = range_;
    const auto ahead = [=](double s) { return path(t + s, range, pace); };
    auto aims = ballistics::aim(shell_, air_, gun, ahead, {.longest_time = 60});
    if (!aims.ok()) return stage.fail(aims.error());
    aims_ = *aims;
    arcs_.clear();
    const auto vacuum =
        ballistics::aim(shell_, {.air = environment::AirColumn::uniform(0)}, gun, ahead, {.longest_time = 60});
    if (!vacuum.ok()) return stage.fail(vacuum.error());
    vacuum_ = *vacuum;
    if (!aims_) {
      ++refused_;
      return;
    }
    for (const auto& shot : {aims_.low, aims_.high}) {
      auto flight = ballistics::fly(shell_, air_, {gun.muzzle, gun.velocity + gun.muzzle_speed * shot->direction},
                                    {.time = shot->time, .tolerance = 1e-7});
      if (!flight.ok()) continue;
      answer_ = max(answer_, length(flight->end().position - ahead(shot->time)));
      arcs_.push_back(std::move(flight).value());
    }
    const ballistics::Shot& shot = stage.value("high") > 0.5 ? *aims_.high : *aims_.low;
    // A shot where the target would be if it kept the velocity of this moment.
    constexpr double moment = 1e-3;
    const Vec3d velocity = (0.5 / moment) * (ahead(moment) - ahead(-moment));
    const auto straight = ballistics::aim(shell_, air_, gun, {ahead(0), velocity}, {.longest_time = 60});
    if (!straight.ok()) return stage.fail(straight.error());
    double astray = -1;
    if (*straight) {
      const ballistics::Shot& led = stage.value("high") > 0.5 ? *straight->high : *straight->low;
      astray = length(ahead(led.time) - led.place);
    }
    fire(stage, gun, shot, t, astray);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    if (own_ > 0) {
      const Vec3d at = muzzle(t), end{0, 0.3, rail_};
      stage.check(stage.world().set_pose(base_, {at.x, 3, at.z}, {}));
      stage.line(-1.0 * end + Vec3d{0, 0.6, 0}, end, pen(steel));
    }
    for (std::size_t i = 0; i < arcs_.size(); ++i) {
      draw_flight(stage, arcs_[i], 1e9, pen(i == 0 ? blue : teal, 0x90), 40);
      const Vec3d p = arcs_[i].end().position;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3d way{};
        way[axis] = 9;
        stage.line(p - way, p + way, pen(i == 0 ? blue : teal));
      }
    }
    for (int i = 0; i < 60; ++i) stage.line(place(t + 0.2 * i), place(t + 0.2 * i + 0.2), pen(red, 0x50));
    const Vec3d target = place(t), before = place(t - stage.declaration().dt);
    for (std::size_t i = 0; i < shells_.size();) {
      Shell& s = shells_[i];
      const Vec3d p = stage.at(s.body).center_of_mass;
      // The nearest approach within the step, of one point against the other.
      const Vec3d from = s.last - before, way = (p - target) - from;
      const double share = clamp(-dot(from, way) / max(dot(way, way), 1e-12), 0.0, 1.0);
      s.nearest = min(s.nearest, length(from + share * way));
      s.last = p;
      const bool done = t > s.due + 0.15;
      if (done) {
        ++arrived_;
        hits_ += s.nearest < double(target_radius_);
        worst_ = max(worst_, s.nearest);
        stage.sample(1, 0, t, s.nearest);
        if (s.astray >= 0) stage.sample(1, 1, t, s.astray);
        astray_ = max(astray_, s.astray);
        bursts_.push_back({Vec3f(p), t});
      }
      if (done || p.y < 0) {
        stage.remove(s.body);
        shells_.erase(shells_.begin() + std::ptrdiff_t(i));
      } else {
        ++i;
      }
    }
    std::vector<Vec3f> sparks;
    for (const Burst& burst : bursts_)
      if (t - burst.time < 0.6) sparks.push_back(burst.place);
    if (!sparks.empty()) stage.points(sparks, 7, pen(gold, 0xc0));
    if (aims_) {
      const auto low = ballistics::laying(aims_.low->direction), high = ballistics::laying(aims_.high->direction);
      stage.sample(0, 0, t, degrees(low.elevation));
      stage.sample(0, 1, t, degrees(high.elevation));
      if (vacuum_) {
        stage.sample(0, 2, t, degrees(ballistics::laying(vacuum_.low->direction).elevation));
        stage.sample(0, 3, t, degrees(ballistics::laying(vacuum_.high->direction).elevation));
      }
      const Vec3d d = (stage.value("high") > 0.5 ? aims_.high : aims_.low)->direction;
      stage.check(stage.world().set_pose(barrel_, muzzle(t) - 8.0 * d, turn_of_y(d)));
      stage.say(format("low arc %.1f° in %.1f s, high arc %.1f° in %.1f s; ", degrees(low.elevation), aims_.low->time,
                       degrees(high.elevation), aims_.high->time) +
                format("%.0f of %.0f hit", double(hits_), double(arrived_)));
    } else {
      stage.say("no solution: the target is out of reach");
    }
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"shells that arrived", "", "one each 1.5 s", double(arrived_ >= 8), 1, 0});
    out.push_back({"hits among them", "", "every answer of the solver is a hit", double(hits_), double(arrived_), 0});
    out.push_back(
        {"farthest miss of the answers", "m", "both arcs, flown by the model: less than 1 cm", answer_, 0, 0.01});
    if (pace_ >= 20)
      out.push_back({"a lead for the velocity alone misses", "", "by more than the target's radius",
                     double(astray_ > double(target_radius_)), 1, 0});
    out.push_back({"farthest miss", "m", "a body flies like the model, to the step of 1/60 s", worst_, 0, 0.5});
  }

 private:
  static constexpr float target_radius_ = 6;
  struct Shell {
    rigid::BodyId body;
    Vec3d last{};
    double due = 0;
    double astray = -1;  ///< m, by which one led for the target's velocity alone goes past it; −1: it could not be led
    double nearest = 1e300;
  };
  struct Burst {
    Vec3f place;
    double time;
  };

  static Vec3d path(double t, double range, double pace) {
    const double size = 130, rate = pace / (1.6 * size);
    return {range + size * sin(rate * t), 85 + 40 * sin(0.7 * rate * t + 1), -60 + size * 0.8 * sin(1.6 * rate * t)};
  }
  Vec3d place(double t) const { return path(t, range_, pace_); }

  /// The gun on its rail.
  Vec3d muzzle(double t) const { return muzzle_ + Vec3d{0, 0, rail_ * sin(own_ / rail_ * t)}; }
  Vec3d gun_velocity(double t) const { return {0, 0, own_ * cos(own_ / rail_ * t)}; }

  void fire(Stage3& stage, const ballistics::Shooter& gun, const ballistics::Shot& shot, double t, double astray) {
    if (shells_.size() > 40) return;
    rigid::BodyDef<Dim3> body;
    body.name = "shell";
    body.position = gun.muzzle;
    body.linear_velocity = Vec3f(gun.velocity + gun.muzzle_speed * shot.direction);
    rigid::ShapeDef<Dim3> shape;
    shape.filter.mask = 0;
    const rigid::BodyId id = stage.add(body, geometry::Sphere{2.2f}, shape, orange);
    auto effector = ballistics::flight_effector<Dim3>(id, {shell_, air_, stage.declaration().dt});
    if (!effector.ok()) return stage.fail(effector.error());
    (void)stage.keep(stage.world().add_effector(*effector));
    shells_.push_back({id, gun.muzzle, t + shot.time, astray});
  }

  static constexpr Vec3d muzzle_{0, 12, 0};
  static constexpr double rail_ = 60;  // m to either side
  double range_ = 420, pace_ = 30, own_ = 0;
  Vec3d wind_{};
  ballistics::Conditions air_{};
  ballistics::Projectile shell_{};
  ballistics::Aims aims_{}, vacuum_{};
  std::vector<Trajectory> arcs_;
  std::vector<Shell> shells_;
  std::vector<Burst> bursts_;
  rigid::BodyId target_, base_, barrel_;
  double next_ = 0.5, worst_ = 0, answer_ = 0, astray_ = 0;
  int hits_ = 0, arrived_ = 0, refused_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_turret() { return std::make_unique<Turret>(); }

}  // namespace carom::host::demo
