// One throw by six laws: vacuum, linear and quadratic drag, a measured drag curve, spin and wind (chapters 4.4, 6).
#include "apps/host/demos/ballistics/range.h"
#include "carom/forces/projectile.h"
#include "carom/sports/presets.h"

namespace carom::host::demo {
namespace {

/// Balls to throw instead of one whose terminal speed alone is told.
constexpr const char* sport_balls[] = {"golf",       "baseball", "soccer",  "tennis", "table_tennis",
                                       "basketball", "cricket",  "bowling", "arrow",  "shuttlecock"};

class TrajectoryLab final : public Repeatable<TrajectoryLab, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "trajectory-lab";
    d.title = "Trajectory lab";
    d.summary =
        "The same ball thrown by six laws at once: no air, linear drag, quadratic drag, drag by Mach number, spin, "
        "wind.";
    d.group = "Ballistics";
    d.chapter = "6.1 to 6.3, 4.4";
    d.text =
        "All six leave alike. What differs is the law of the air.\n\n"
        "  vacuum  a = g      linear  a = g − (g/v_t) v      quadratic  a = g − (g/v_t²) |v| v\n\n"
        "v_t is the terminal speed, at which drag carries the weight. The drag coefficient of the fourth ball is that "
        "of a standard projectile (G1 flat base, G2 long cone, G5 short boat tail, G6 pointed flat base, G7 long boat "
        "tail, G8 secant ogive, GI Ingalls' table, GS sphere, RA4 rimfire bullet), scaled to the others at Mach 0.3. "
        "That of G1 grows threefold at the speed of sound: throw faster than 250 m/s to see it part from the third. "
        "Spin deflects the fifth by the Magnus force,\n\n"
        "  F = ½ ρ A C_L v² (ω × v)/|ω × v|,   C_L = 1/(2.32 + 0.4/S),   S = r ω/v\n\n"
        "and the sixth flies in wind. For v = v_t and 45° the ranges are v_t²/g times 1, .490986 (linear) and .589012 "
        "(quadratic).\n\n"
        "With a ball of a sport the terminal speed is its own, and the last two fly by what was measured of it: C_D "
        "through the crisis and with spin, C_L by spin, in still air with the spin that is set, and without spin in "
        "wind.";
    d.duration = 9;
    d.loop = true;
    d.camera = {.position = {175, 70, 330}, .target = {175, 42, 0}, .width = 410};
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed v", "m/s", "m/s", "", 10, 500, 1, 60, false},
        {"elevation", "Elevation", "rad", "deg", "above the horizon", 0.02, 1.55, 0, radians(45.0), false},
        {"terminal", "Terminal speed v_t", "m/s", "m/s", "in still air; a baseball has 40, a shell 300", 5, 400, 1, 60,
         false},
        {"spin", "Backspin", "rad/s", "rpm", "of a ball with 37 mm radius", -400, 400, 0, 190, false},
        {"wind", "Wind along", "m/s", "m/s", "positive: from behind", -30, 30, 0.5, -8, false},
        {"cross", "Wind across", "m/s", "m/s", "positive: toward the viewer", -30, 30, 0.5, 6, false},
        choice("ball", "Ball", "",
               {"by its terminal speed", "golf", "baseball", "soccer", "tennis", "table tennis", "basketball",
                "cricket", "bowling", "arrow", "shuttlecock"}),
        choice("curve", "Drag curve", "", {"G1", "G2", "G5", "G6", "G7", "G8", "GI", "GS", "RA4"}),
    };
    Plot side{"Side view", {"distance", "m"}, {"height", "m"}, {}}, speed{"Speed", {"time", "s"}, {"speed", "m/s"}, {}};
    for (int k = 0; k < laws; ++k) {  // in the colors of the trails
      side.series.push_back({names[k], Series::Style::line, {}, colors[k]});
      speed.series.push_back({names[k], Series::Style::line, {}, colors[k]});
    }
    side.series.push_back({"closed forms", Series::Style::points, {}, steel});
    d.plots = {side, speed};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    speed_ = stage.value("speed");
    terminal_ = stage.value("terminal");
    spin_ = stage.value("spin");
    wind_ = {stage.value("wind"), 0, stage.value("cross")};
    direction_ = ballistics::direction(stage.value("elevation"));
    const int chosen = clamp(stage.count("ball"), 0, int(std::size(sport_balls)));
    of_sport_ = chosen > 0;
    if (of_sport_) {
      ball_ = sports::ball_preset(sport_balls[chosen - 1]).value();
      terminal_ = sports::terminal_speed(ball_, {}, g_);
    }
    // As much drag as the others where C_D is that of slow balls.
    standard_ = ballistics::projectile_from_terminal_speed(terminal_, 1.225, g_);
    const int function = clamp(stage.count("curve"), 0, int(ballistics::drag_function_names.size()) - 1);
    const ballistics::DragCurve curve{ballistics::DragFunction(function)};
    standard_.area_per_mass *= standard_.drag(0.3) / curve(0.3);
    standard_.drag = curve;
    curve_name_ = ballistics::drag_function_names[std::size_t(function)];
    for (char& c : curve_name_) c = char(c >= 'a' ? c - 'a' + 'A' : c);
    for (int plot = 0; plot < 2; ++plot) stage.name_series(plot, 3, curve_name_);
    double farthest = 1, highest = 1;
    for (int k = 0; k < laws; ++k) {
      fly(k);
      for (const Node& node : paths_[k]) {
        farthest = max(farthest, node.x.x);
        highest = max(highest, node.x.y);
      }
      const float radius = float(max(0.006 * speed_ * speed_ / g_, 0.5));
      balls_[k] =
          add_marker(stage, k == 3 ? curve_name_ : names[k], geometry::Sphere{min(radius, 6.0f)}, {}, colors[k]);
    }
    const double wide = max(0.55 * farthest, 0.9 * highest);
    stage.set_camera({{0.5 * farthest, 0.55 * highest, 1.75 * wide}, {0.5 * farthest, 0.42 * highest, 0}});
    closed_forms(stage);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int k = 0; k < laws; ++k) {
      const std::vector<Node>& path = paths_[k];
      const std::size_t now = min(std::size_t(t / dt_), path.size() - 1);
      stage.check(stage.world().set_pose(balls_[k], path[now].x, {}));
      const std::size_t stride = max<std::size_t>(path.size() / 160, 1);
      for (std::size_t i = stride; i <= now; i += stride) stage.line(path[i - stride].x, path[i].x, pen(colors[k]));
      if (now + 1 < path.size()) {
        stage.sample(0, k, path[now].x.x, path[now].x.y);
        stage.sample(1, k, t, length(path[now].v));
      }
    }
    stage.say(format("ranges: vacuum %.0f, linear %.0f, quadratic %.0f, ", range(0), range(1), range(2)) + curve_name_ +
              format(" %.0f, spin %.0f, wind %.0f m", range(3), range(4), range(5)));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const double unit = terminal_ * terminal_ / g_;
    out.push_back({"range in vacuum", "v²/g", "ch. 6.1: R = v² sin 2θ/g", range(0) / unit, 1, 1e-5});
    out.push_back(
        {"range with linear drag", "v²/g", "closed form with Lambert's W", range(1) / unit, .490986359, 1e-5});
    out.push_back({"range with quadratic drag", "v²/g", "integrated to 18 digits", range(2) / unit, .589011800, 1e-5});
    out.push_back(
        {"time with quadratic drag", "v/g", "integrated to 18 digits", flown_[2] * g_ / terminal_, 1.204724756, 1e-5});
    const auto flight = ballistics::fly(standard_, still(), {{}, speed_ * direction_}, {.ground = 0});
    const double far = flight.ok() ? flight->end().position.x : 0;
    out.push_back({"range by the drag curve " + curve_name_, "m", "ballistics::fly, in steps of its own", range(3), far,
                   1e-6 * far});
  }

 private:
  static constexpr int laws = 6;
  static constexpr const char* names[laws] = {"vacuum", "linear", "quadratic", "G1", "spin", "wind"};
  static constexpr std::uint32_t colors[laws] = {blue, teal, orange, violet, gold, red};
  static constexpr double g_ = 9.80665, dt_ = 1.0 / 240, radius_ = 0.0366, slow_drag_ = 0.35;
  struct Node {
    Vec3d x, v;
  };

  static ballistics::Conditions still() { return {.air = environment::AirColumn::uniform(1.225)}; }
  Vec3d acceleration(int law, Vec3d x, Vec3d v) const {
    Vec3d a{0, -g_, 0};
    const double k = g_ / (terminal_ * terminal_);
    const Vec3d w = law == 5 ? v - wind_ : v;
    if (law >= 4 && of_sport_)
      return a + sports::air_load(ball_, {}, {.velocity = w, .spin = {0, 0, law == 4 ? spin_ : 0}}).force / ball_.mass;
    if (law == 1) a -= (g_ / terminal_) * v;
    if (law == 2 || law >= 4) a -= (k * length(w)) * w;
    if (law == 3) a = ballistics::acceleration(standard_, still(), {x, v});
    if (law == 4 && spin_ != 0) {
      // Backspin turns about +z; the force is along ω × v.
      const double s = radius_ * abs(spin_) / length(v), lift = 1 / (2.32 + 0.4 / s);
      const Vec3d across = cross(Vec3d{0, 0, spin_ > 0 ? 1.0 : -1.0}, v) / length(v);
      a += (k * lift / slow_drag_ * dot(v, v)) * across;
    }
    return a;
  }

  void fly(int law) {
    std::vector<Node>& path = paths_[law];
    path.clear();
    Node n{{}, speed_ * direction_};
    path.push_back(n);
    for (int i = 0; i < 240 * 110; ++i) {
      const Vec3d k1 = acceleration(law, n.x, n.v), v2 = n.v + (dt_ / 2) * k1;
      const Vec3d k2 = acceleration(law, n.x, v2), v3 = n.v + (dt_ / 2) * k2;
      const Vec3d k3 = acceleration(law, n.x, v3), v4 = n.v + dt_ * k3;
      const Vec3d k4 = acceleration(law, n.x, v4);
      const Node before = n;
      n.x += (dt_ / 6) * (before.v + 2.0 * (v2 + v3) + v4);
      n.v += (dt_ / 6) * (k1 + 2.0 * (k2 + k3) + k4);
      if (n.x.y < 0) {  // where it met the ground: the parabola through this step
        const double vy = before.v.y, ay = (n.v.y - vy) / dt_;
        const double s = (-vy - sqrt(max(vy * vy - 2 * ay * before.x.y, 0.0))) / ay;
        n.x = before.x + s * before.v + (0.5 * s * s / dt_) * (n.v - before.v);
        n.v = before.v + (s / dt_) * (n.v - before.v);
        flown_[law] = i * dt_ + s;
        path.push_back(n);
        return;
      }
      path.push_back(n);
    }
    flown_[law] = 110;
  }
  double range(int law) const { return paths_[law].empty() ? 0 : paths_[law].back().x.x; }

  void closed_forms(Stage3& stage) const {
    const forces::FlightPoint start{{}, speed_ * direction_};
    const forces::LinearDragFlight linear{.mass = 1, .coefficient = g_ / terminal_, .gravity = {0, -g_, 0}};
    for (int i = 0; i <= 24; ++i) {
      const Vec3d a = forces::parabola(start, {0, -g_, 0}, flown_[0] * i / 24).position;
      const Vec3d b = forces::linear_drag_flight(linear, start, flown_[1] * i / 24).position;
      stage.sample(0, 6, a.x, a.y);
      stage.sample(0, 6, b.x, b.y);
    }
  }

  rigid::BodyId balls_[laws];
  std::vector<Node> paths_[laws];
  double flown_[laws] = {};
  double speed_ = 60, terminal_ = 60, spin_ = 0;
  Vec3d wind_{}, direction_{};
  ballistics::Projectile standard_{};
  std::string curve_name_;
  sports::Ball ball_{};
  bool of_sport_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_trajectory_lab() { return std::make_unique<TrajectoryLab>(); }

}  // namespace carom::host::demo
