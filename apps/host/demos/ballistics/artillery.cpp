// The 155 mm shell M107 against its firing table (chapter 18.1).
#include "apps/host/demos/ballistics/range.h"
#include "carom/ballistics/shell.h"

namespace carom::host::demo {
namespace {

class Artillery final : public Repeatable<Artillery, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "artillery";
    d.title = "Artillery by the firing table";
    d.summary =
        "A spinning 155 mm shell drifts to the right: modified point mass, six degrees of freedom, and the printed "
        "table.";
    d.group = "Ballistics";
    d.chapter = "18.1";
    d.text =
        "A shell that spins fast keeps its nose a little to the right of its path, at the yaw of repose, and the air "
        "pushes it that way.\n\n"
        "  δ = −2 I_x p (v × v̇)/(ρ S d C_Mα v⁴)\n\n"
        "The modified point mass (STANAG 4355) lets the axis stand there; with six degrees of freedom it nutates and "
        "precesses about it. The points are of the firing table FT 155-AM-2 of the howitzer M185/M199 (after Lim, NPS "
        "thesis AD1029824): range within 1.1 %, time within 1.3 %, drift to the right and at most 20 % more. "
        "Elevations "
        "are in mils, 6 400 to the circle.";
    d.duration = 12;
    d.camera = {.position = {-900, 900, 5200}, .target = {3600, 350, 0}, .width = 9000};
    d.ground = 0;
    d.parameters = {
        {"charge", "Charge", "", "", "4: 337 m/s, 6: 474 m/s at the muzzle", 4, 6, 2, 6, false},
        {"elevation", "Elevation in mils", "", "", "of 6 400 to the circle", 40, 1250, 0.1, 258.4, false},
        {"wind", "Wind across", "m/s", "m/s", "positive: to the right", -20, 20, 0.5, 0, false},
        yes_or_no("six", "Six degrees of freedom", "the axis swings", false),
        {"pace", "Pace", "", "", "seconds of flight for one of ours", 1, 10, 0.5, 3, true},
    };
    d.plots = {{"Side view",
                {"distance", "m"},
                {"height", "m"},
                {{"shell"}, {"without air"}, {"firing table: range, and height over this top", Series::Style::points}}},
               {"Range by elevation",
                {"elevation (mils)", ""},
                {"range", "m"},
                {{"charge 4"}, {"charge 6"}, {"firing table", Series::Style::points, table(0)}}},
               {"Drift by range",
                {"range", "m"},
                {"drift", "m"},
                {{"charge 4"}, {"charge 6"}, {"firing table", Series::Style::points, table(1)}}},
               {"Yaw", {"time", "s"}, {"yaw", "deg"}, {{"of the axis"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    shell_ = ballistics::m107();
    for (const int charge : {4, 6}) {
      for (double mils = 40; mils <= 800; mils += 40) {
        const auto flight = shoot(stage, charge, mils, false, 0);
        const Vec3d end = flight.path.end().position;
        stage.sample(1, charge == 4 ? 0 : 1, mils, end.x);
        stage.sample(2, charge == 4 ? 0 : 1, end.x, end.z);
      }
    }
    flight_ =
        shoot(stage, stage.count("charge"), stage.value("elevation"), stage.value("six") > 0.5, stage.value("wind"));
    const ballistics::Trajectory& path = flight_->path;
    const double reach = path.end().position.x, top = path.apex().position.y;
    const Vec3d v = path.start().velocity;
    for (int i = 0; i <= 60; ++i) {
      const double t = 2 * v.y / g_ * i / 60;
      stage.sample(0, 1, v.x * t, v.y * t - 0.5 * g_ * t * t);
    }
    for (const Row& row : rows_)
      if (row.charge == stage.count("charge") && abs(row.mils - stage.value("elevation")) < 0.05) {
        stage.sample(0, 2, row.range, 0);
        stage.sample(0, 2, path.apex().position.x, row.height);  // the table does not say where it is highest
      }
    const float size = float(max(reach / 130, 8.0));
    shell_body_ = add_marker(stage, "shell", geometry::Capsule3{2 * size, size}, {}, orange);
    howitzer_ = add_marker(stage, "barrel", geometry::Cylinder{3 * size, 0.8f * size}, {}, dark);
    stage.check(stage.world().set_pose(howitzer_, {}, turn_of_y(normalize(v))));
    // Stakes of the table along the range, one a kilometre.
    for (int km = 1; km <= 12; ++km)
      add_marker(stage, "stake", geometry::Box{{0.25f * size, (km % 5 == 0 ? 3.0f : 1.2f) * size, 0.25f * size}},
                 {1000.0 * km, 0, 0}, km % 5 == 0 ? gold : steel);
    const double wide = max(0.62 * reach, 1.1 * top);
    stage.set_camera({{0.32 * reach, 0.5 * top + 0.22 * wide, 1.45 * wide}, {0.5 * reach, 0.4 * top, 0}});
  }

  void after_step(Stage3& stage) override {
    if (!flight_) return;
    clock_ += stage.declaration().dt * stage.value("pace");
    const ballistics::Trajectory& path = flight_->path;
    const double t = min(clock_, path.duration());
    const auto point = path.at(t);
    stage.check(stage.world().set_pose(shell_body_, point.position, turn_of_y(normalize(point.velocity))));
    draw_flight(stage, path, t, pen(orange), 120);
    for (int i = 0; i < 40; ++i) {  // its shadow on the ground, and the line it was fired along
      const Vec3d a = path.at(t * i / 40).position, b = path.at(t * (i + 1) / 40).position;
      stage.line(Vec3d{a.x, 1, a.z}, Vec3d{b.x, 1, b.z}, pen(dark, 0x90));
    }
    const Vec3d end = path.end().position;
    stage.line(Vec3d{0, 1, 0}, Vec3d{1.05 * end.x, 1, 0}, pen(steel, 0x90));
    if (t < path.duration()) {
      stage.sample(0, 0, point.position.x, point.position.y);
      while (told_ < flight_->states.size() && flight_->states[told_].time <= t) {
        const ballistics::ShellState& state = flight_->states[told_++];
        stage.sample(3, 0, state.time, degrees(state.yaw));
      }
    }
    stage.say(format("t = %.1f s, %.0f m, %.0f m high, drift %.1f m, %.0f m/s", t, point.position.x,
                     max(0.0, point.position.y), point.position.z, length(point.velocity)));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const auto flight = shoot(stage, 6, 258.4, false, 0);
    const auto end = flight.path.end();
    const char* source = "FT 155-AM-2, charge 6, 258.4 mil";
    out.push_back({"range", "m", source, end.position.x, 7000, 77});
    out.push_back({"time of flight", "s", source, end.time, 20.8, 0.27});
    out.push_back({"speed at the impact", "m/s", source, length(end.velocity), 298, 6});
    out.push_back({"height of the path", "m", source, flight.path.apex().position.y, 548, 5.5});
    out.push_back({"drift, to the right and at most a fifth more", "m", source, end.position.z, 45.5, 9.1});
  }

 private:
  static constexpr double g_ = 9.80665;
  struct Row {
    int charge;
    double mils, range, drift, height;
  };
  static constexpr Row rows_[] = {{4, 97.2, 2000, 3.2, 50},     {4, 152.0, 3000, 7.8, 119},
                                  {4, 211.6, 4000, 15.2, 224},  {6, 258.4, 7000, 45.5, 548},
                                  {6, 378.6, 9000, 88.2, 1059}, {6, 539.9, 11000, 169.4, 1924}};
  static std::vector<Vec2d> table(int which) {
    std::vector<Vec2d> points;
    for (const Row& row : rows_)
      points.push_back(which == 0 ? Vec2d{row.mils, row.range} : Vec2d{row.range, row.drift});
    return points;
  }
  ballistics::ShellFlight shoot(Stage3& stage, int charge, double mils, bool six, double wind) const {
    ballistics::Conditions air;
    air.gravity_model = ballistics::GravityModel::inverse_square;
    air.wind = environment::WindColumn(Vec3d{0, 0, wind});
    const double speed = charge == 4 ? 337 : 474;
    auto flight =
        ballistics::fly_shell(shell_, air, {{}, speed * ballistics::direction(mils * 2 * pi / 6400)},
                              six ? ballistics::ShellModel::six_degrees : ballistics::ShellModel::modified_point_mass,
                              {.time = 200, .ground = 0, .tolerance = 1e-7});
    if (flight.ok()) return std::move(flight).value();
    stage.fail(flight.error());
    return {ballistics::Trajectory({{}, {.time = 1}}), {}};
  }

  ballistics::Shell shell_{};
  std::optional<ballistics::ShellFlight> flight_;
  rigid::BodyId shell_body_, howitzer_;
  double clock_ = 0;
  std::size_t told_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_artillery() { return std::make_unique<Artillery>(); }

}  // namespace carom::host::demo
