// The same motion by six methods side by side, against the exact one (chapter 7).
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"
#include "carom/ode/methods.h"

namespace carom::host::demo {
namespace {

using rigid::Dim2;
using State = ode::Motion<Vec2d>;

enum class Course { ship, spring, orbit };

struct Runner {
  const char* name;
  ode::Method method;
  std::uint32_t color;
};
constexpr Runner runners[] = {
    {"Euler", ode::Method::euler, red},
    {"semi-implicit Euler", ode::Method::semi_implicit_euler, orange},
    {"Heun", ode::Method::heun, gold},
    {"velocity Verlet", ode::Method::velocity_verlet, green},
    {"implicit midpoint", ode::Method::implicit_midpoint, violet},
    {"RK4", ode::Method::rk4, blue},
};
constexpr int runner_count = int(std::size(runners));

template <Course course>
class Race final : public Repeatable<Race<course>, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.dimension = 2;
    d.group = "Integrators";
    d.chapter = "7";
    std::vector<Series> names;
    for (const Runner& r : runners) names.push_back({r.name, Series::Style::line, {}, r.color});
    const Axis time{"time", "s"};
    if constexpr (course == Course::ship) {
      d.id = "race-ship";
      d.title = "Integrator race: ship";
      d.summary = "A ship gathers speed against the drag of the water; six methods reckon where it is.";
      d.text =
          "Thrust T, mass m, drag C v. The exact answer is known, so the plot can show each method's error.\n\n"
          "  m v̇ = T − C v      v = T/C (1 − e^(−C t/m))\n\n"
          "With steps of one second Euler is 0.384 m/s wrong after ten seconds, Heun −0.0132 and RK4 −0.000007. Halve "
          "the step: Euler's error "
          "halves, Heun's falls to a quarter, RK4's to a sixteenth. That is what the order of a method means.";
      d.duration = 10;
      d.camera.target = {38, -1.2, 0};
      d.camera.height = 30;
      d.camera.width = 92;
      d.loop = true;
      d.parameters = {{"step", "Step", "s", "s", "of every method", 0.05, 4, 0.05, 1, false},
                      {"mass", "Mass of the ship", "kg", "t", "", 1e3, 1e5, 0, 1e4, false},
                      {"thrust", "Thrust", "N", "kN", "", 1e3, 1e5, 0, 2e4, false},
                      {"drag", "Drag C", "N·s/m", "N·s/m", "", 1e2, 1e4, 0, 1e3, false}};
      d.plots = {{"Speed", time, {"speed", "m/s"}, with_exact(names)},
                 {"Error of the speed", time, {"log₁₀ |error|", ""}, names}};
    } else if constexpr (course == Course::spring) {
      d.id = "race-spring";
      d.title = "Integrator race: spring";
      d.summary = "A weight on a spring without friction must swing for ever; see which methods let it.";
      d.text =
          "  ẍ = −ω² x      E = ½ ẋ² + ½ ω² x²\n\n"
          "Each step of explicit Euler multiplies the energy by 1 + (ω h)²: after a hundred swings at h = 0.01 s it is "
          "10¹⁷ times too "
          "large. The semi-implicit method costs the same, and its energy only breathes by a few percent for ever. "
          "That is why game "
          "engines use it, and why this one does.";
      d.duration = 20;
      d.camera.target = {0, -4.2, 0};
      d.camera.height = 11;
      d.camera.width = 13.5;
      d.parameters = {{"step", "Step", "s", "s", "of every method", 0.005, 0.2, 0.005, 0.05, false},
                      {"frequency", "Frequency", "Hz", "Hz", "of the spring", 0.2, 2, 0, 1, false}};
      d.plots = {{"Energy", time, {"log₁₀ E/E₀", ""}, names},
                 {"Error of the place", time, {"log₁₀ |error|", ""}, names}};
    } else {
      d.id = "race-orbit";
      d.title = "Integrator race: orbit";
      d.summary = "A planet on an ellipse: some methods spiral out, some keep the orbit and let it turn.";
      d.text =
          "  r̈ = −r / |r|³      E = ½ v² − 1/|r|\n\n"
          "Near the sun the planet is fast, and one step turns it far: there the errors are made. Explicit Euler "
          "throws it out at "
          "once. Semi-implicit Euler, Verlet and the implicit midpoint rule keep the energy and lose only the "
          "direction of the ellipse, "
          "slowly. RK4 is far closer at first, and yet its energy drifts away in the end.";
      d.duration = 30;
      d.camera.target = {-0.5, 0, 0};
      d.camera.height = 3.4;
      d.camera.width = 4;
      d.parameters = {
          {"step", "Step", "s", "s", "of every method; one turn takes 2π s", 0.005, 0.2, 0.005, 0.05, false},
          {"eccentricity", "Eccentricity", "", "", "0: circle", 0, 0.8, 0, 0.5, false}};
      d.plots = {{"Energy", time, {"log₁₀ |E/E₀ − 1|", ""}, names}};
    }
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<Dim2> world;
    world.gravity = {};
    stage.start(world);
    for (int i = 0; i < runner_count; ++i) {
      state_[i] = start(stage);
      rigid::BodyDef<Dim2> body;
      body.type = rigid::BodyType::kinematic;
      body.name = runners[i].name;
      body.position = place(i, state_[i]);
      rigid::ShapeDef<Dim2> ghost;
      ghost.filter.mask = 0;
      if constexpr (course == Course::ship) {
        constexpr Vec2f hull[] = {{-7, -1}, {-1.5f, -1}, {0, 0}, {-1.5f, 1}, {-7, 1}};
        markers_[i] = stage.add(body, stage.keep(geometry::make_polygon(hull)), ghost, runners[i].color);
      } else {
        const float size = course == Course::spring ? 0.34f : 0.045f;
        markers_[i] = stage.add(body, geometry::Circle{size}, ghost, runners[i].color);
      }
      trails_[i] = Trail(course == Course::orbit ? 0.02 : 1e9, 500);
    }
    energy_ = energy(stage, state_[0]);
  }

  void before_step(Stage2& stage) override {
    const double h = stage.value("step");
    const double now = stage.world().time() + stage.declaration().dt;
    // Every method takes its steps when their time has come; the exact place is known at any time.
    while ((taken_ + 1) * h <= now + 1e-9) {
      for (int i = 0; i < runner_count; ++i) advance(stage, i, h);
      ++taken_;
      report(stage);
    }
  }

  void after_step(Stage2& stage) override {
    for (int i = 0; i < runner_count; ++i) {
      const Vec2d at = place(i, state_[i]);
      stage.check(stage.world().set_pose(markers_[i], at, {}));
      trails_[i].add(at);
      trails_[i].draw(stage, pen(runners[i].color, 0xb0));
      if constexpr (course == Course::spring) coil(stage, {-6, -1.4 * i}, at, runners[i].color);
    }
    decorate(stage);
  }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    if constexpr (course == Course::ship) {
      const double exact = 20 * (1 - exp(-1.0));
      const char* source = "ch. 7.3: ship of 4.2, dt = 1 s, t = 10 s";
      out.push_back({"error of Euler's speed", "m/s", source, state_[0].velocity.x - exact, 0.3840, 5e-5});
      out.push_back({"error of Heun's speed", "m/s", source, state_[2].velocity.x - exact, -0.01323, 5e-6});
      out.push_back({"error of RK4's speed", "m/s", source, state_[5].velocity.x - exact, -6.66e-6, 5e-9});
    } else if constexpr (course == Course::spring) {
      // (1 + (ω h)²)^n with ω h = 2π · 0.05 after 400 steps.
      const double growth = pow(1 + square(0.1 * pi), 400);
      out.push_back({"log₁₀ of Euler's energy", "", "energy grows by 1 + (ω h)² a step", log10(energy_now_[0]),
                     log10(growth), 1e-6});
      out.push_back({"energy of the implicit midpoint", "", "keeps quadratic invariants", energy_now_[4], 1, 1e-9});
    } else {
      out.push_back({"energy drift of Verlet", "", "symplectic: bounded", energy_now_[3] - 1, 0, 0.02});
    }
  }

 private:
  static std::vector<Series> with_exact(std::vector<Series> names) {
    names.push_back({"exact", Series::Style::points, {}, dark});
    return names;
  }

  State start(Stage2& stage) {
    if constexpr (course == Course::ship) {
      return {};
    } else if constexpr (course == Course::spring) {
      return {{3, 0}, {0, 0}};
    } else {
      const double e = stage.value("eccentricity");
      return {{1 - e, 0}, {0, sqrt((1 + e) / (1 - e))}};
    }
  }

  Vec2d acceleration(Stage2& stage, Vec2d x, Vec2d v) {
    if constexpr (course == Course::ship) {
      return Vec2d{stage.value("thrust") - stage.value("drag") * v.x, 0} / stage.value("mass");
    } else if constexpr (course == Course::spring) {
      return -square(2 * pi * stage.value("frequency")) * x;
    } else {
      const double r2 = max(length_squared(x), 1e-12);
      return -1.0 / (r2 * sqrt(r2)) * x;
    }
  }

  double energy(Stage2& stage, const State& s) {
    if constexpr (course == Course::orbit)
      return 0.5 * length_squared(s.velocity) - 1 / max(length(s.position), 1e-6);
    else if constexpr (course == Course::spring)
      return 0.5 * length_squared(s.velocity) +
             0.5 * square(2 * pi * stage.value("frequency")) * length_squared(s.position);
    else
      return 1;
  }

  void advance(Stage2& stage, int i, double h) {
    const auto f = [&](double, const State& y) {
      return State{y.velocity, acceleration(stage, y.position, y.velocity)};
    };
    State next = state_[i];
    if (ode::step(runners[i].method, f, taken_ * h, next, h) != ode::Outcome::done) return;
    // A method that has blown up stays where it was last seen.
    if (is_finite(next.position) && length_squared(next.position) < 1e60 && length_squared(next.velocity) < 1e60)
      state_[i] = next;
  }

  void report(Stage2& stage) {
    const double t = taken_ * stage.value("step");
    constexpr double least = 1e-17;
    for (int i = 0; i < runner_count; ++i) {
      const State& s = state_[i];
      energy_now_[i] = energy(stage, s) / energy_;
      if constexpr (course == Course::ship) {
        stage.sample(0, i, t, s.velocity.x);
        stage.sample(1, i, t, log10(max(least, abs(s.velocity.x - exact_speed(stage, t)))));
      } else if constexpr (course == Course::spring) {
        const double exact = 3 * cos(2 * pi * stage.value("frequency") * t);
        stage.sample(0, i, t, log10(max(least, energy_now_[i])));
        stage.sample(1, i, t, log10(max(least, abs(s.position.x - exact))));
      } else {
        stage.sample(0, i, t, log10(max(least, abs(energy_now_[i] - 1))));
      }
    }
    if constexpr (course == Course::ship) stage.sample(0, runner_count, t, exact_speed(stage, t));
  }
  static double exact_speed(Stage2& stage, double t) {
    return stage.value("thrust") / stage.value("drag") * (1 - exp(-stage.value("drag") * t / stage.value("mass")));
  }

  static Vec2d place(int i, const State& s) {
    if constexpr (course == Course::ship)
      return {s.position.x, 9.0 - 3.6 * i};
    else if constexpr (course == Course::spring)
      return {clamp(s.position.x, -5.5, 60.0), -1.4 * i};
    else
      return {clamp(s.position.x, -1e3, 1e3), clamp(s.position.y, -1e3, 1e3)};
  }

  static void coil(Stage2& stage, Vec2d from, Vec2d to, std::uint32_t color) {
    constexpr int turns = 14;
    Vec2d last = from;
    for (int i = 1; i <= 2 * turns; ++i) {
      const double side = i == 2 * turns ? 0.0 : (i % 2 == 0 ? 0.22 : -0.22);
      const Vec2d next = from + (to - from) * (double(i) / (2 * turns)) + Vec2d{0, side};
      stage.line(last, next, pen(color));
      last = next;
    }
  }

  void decorate(Stage2& stage) {
    if constexpr (course == Course::ship) {
      const double t = stage.world().time();
      const double c = stage.value("drag"), m = stage.value("mass"), v = stage.value("thrust") / c;
      const double x = v * t - m / c * v * (1 - exp(-c * t / m));
      stage.line(Vec2d{x, -12}, Vec2d{x, 12}, pen(0xffffff, 0xc0));
      for (int i = 0; i <= 10; ++i) stage.line(Vec2d{10.0 * i, -12.6}, Vec2d{10.0 * i, -12}, pen(steel));
    } else if constexpr (course == Course::spring) {
      stage.line(Vec2d{-6, 0.8}, Vec2d{-6, -7.8}, pen(steel));
    } else {
      // The sun, and the ellipse that the planet should keep to.
      const double e = stage.value("eccentricity");
      Vec2d last{1 - e, 0};
      for (int i = 1; i <= 96; ++i) {
        const double angle = 2 * pi * i / 96;
        const Vec2d next{cos(angle) - e, sqrt(1 - e * e) * sin(angle)};
        stage.line(last, next, pen(0xffffff, 0x80));
        last = next;
      }
      for (int i = 0; i < 8; ++i) {
        const Vec2d ray{cos(pi * i / 4), sin(pi * i / 4)};
        stage.line(0.03 * ray, 0.07 * ray, pen(gold));
      }
    }
  }

  State state_[runner_count];
  double energy_now_[runner_count] = {};
  rigid::BodyId markers_[runner_count];
  Trail trails_[runner_count];
  double energy_ = 1;
  int taken_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_race_ship() { return std::make_unique<Race<Course::ship>>(); }
std::unique_ptr<Demo> make_race_spring() { return std::make_unique<Race<Course::spring>>(); }
std::unique_ptr<Demo> make_race_orbit() { return std::make_unique<Race<Course::orbit>>(); }

}  // namespace carom::host::demo
