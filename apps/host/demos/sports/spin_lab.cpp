// Spin in seven sports: two rigid bodies fly side by side through the same air, one with spin or seam, one without
// (chapter 6.3).
#include "apps/host/demos/sports/list.h"
#include "carom/math/elementary.h"
#include "carom/sports/bounce.h"
#include "carom/sports/effector.h"
#include "carom/sports/presets.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

struct SpinScene {
  const char* name;
  const char* ball;
  double speed, elevation, azimuth, spin, tilt;
  double height, distance;  ///< m, of the start, and to the goal, net or stumps
  double view;              ///< m, how far behind the start one stands
};
constexpr SpinScene spin_scenes[] = {
    {"free kick", "soccer", 28, 0.266, -0.055, 50, 1.45, 0.11, 25, 7},
    {"floating ball", "floating_soccer", 30, 0.20, 0, 0, 0, 0.11, 25, 7},
    {"topspin drive", "tennis", 33, 0.165, 0, 280, pi, 0.9, 23.77, 6},
    {"curve ball", "baseball", 35, 0.028, 0, 280, pi - 0.5, 1.85, 16.8, 5},
    {"knuckleball", "knuckleball", 31, 0.045, 0, 3.5, pi / 2, 1.85, 16.8, 5},
    {"swing bowling", "cricket", 34, -0.012, -0.02, 0, 0, 2.0, 17.7, 5},
    {"table tennis loop", "table_tennis", 9, 0.22, 0, 600, pi, 0.25, 2.3, 1.6},
};

class SpinLab final : public Repeatable<SpinLab, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "ball-spin";
    d.title = "What spin does to a ball";
    d.summary = "Free kick, floating ball, topspin, curve ball, knuckleball, swing bowling: with spin and without.";
    d.group = "Sports";
    d.chapter = "6.3";
    d.text =
        "Both balls of a pair are rigid bodies with the same effector, launched alike; only one has spin, or a seam "
        "that is held askew. Air is thrown to one side and the ball to the other.\n\n"
        "  F = ½ ρ A V² C_L(S, Re) (ω × v)/|ω × v|,   S = r ω/V\n\n"
        "What differs between sports are numbers: a soccer ball near 25 m/s passes through the drag crisis, so that a "
        "free kick flies fast and then drops; a tennis ball's felt keeps its drag at .51 whatever it does; a cricket "
        "ball keeps its seam at an angle and is pushed to that side until, above some 36 m/s, it swings the other way. "
        "A knuckleball turns less than once and is pushed to and fro.\n\n"
        "The thin dashes are the same flights integrated alone by the adaptive method: the bodies in the world must "
        "lie on them.";
    d.dt = 1.0 / 120;
    d.duration = 2.2;
    d.loop = true;
    d.camera = {{-7, 2.6, 1.6}, {14, 1.2, 0}, 0.6};
    d.ground = 0;
    d.parameters = {
        choice("scene", "Sport", "",
               {"free kick", "floating ball", "topspin", "curve ball", "knuckleball", "swing bowling", "table tennis"}),
        {"speed", "Speed", "", "%", "of what a good player reaches", 0.4, 1.5, 0.01, 1, false},
        {"spin", "Spin", "", "%", "of a good player's; negative turns it round", -2, 2, 0.01, 1, false},
        {"tilt", "Turn the axis by", "rad", "deg", "", -3.1416, 3.1416, 0, 0, false},
        {"seam", "Seam angle", "rad", "deg", "cricket: askew to the flight", -0.6, 0.6, 0, 0.35, false},
        {"seed", "Flutter", "", "", "another wake for the floating ball", 1, 20, 1, 3, false},
        {"density", "Density of the air", "kg/m^3", "kg/m^3", "1.225 at sea level, .95 in Mexico City", 0, 1.5, 0,
         1.225, false},
        {"wind", "Wind to the right", "m/s", "m/s", "", -10, 10, 0, 0, false},
    };
    d.plots = {{"Side view", {"distance", "m"}, {"height", "m"}, {{"with spin"}, {"without"}}},
               {"From above", {"distance", "m"}, {"to the left", "m"}, {{"with spin"}, {"without"}}},
               {"Speed", {"time", "s"}, {"speed", "m/s"}, {{"with spin"}, {"without"}}},
               {"World against flight alone", {"time", "s"}, {"distance apart", "mm"}, {{"with spin"}, {"without"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {0, -9.80665f, 0};
    stage.start(world);
    scene_ = spin_scenes[std::size_t(clamp(stage.count("scene"), 0, 6))];
    stage.set_camera({{-scene_.view, 0.9 + 0.25 * scene_.view, 0.22 * scene_.view},
                      {0.55 * scene_.distance, 0.25 + 0.04 * scene_.distance, 0},
                      0.6});
    scenery(stage);
    sports::Conditions conditions;
    conditions.air = environment::AirColumn::uniform(stage.value("density"));
    conditions.wind = environment::WindColumn(Vec3d{0, 0, stage.value("wind")});
    for (std::size_t i = 0; i < 2; ++i) {
      sports::Ball ball = *sports::ball_preset(scene_.ball);
      sports::Launch launch{.speed = scene_.speed * stage.value("speed"),
                            .elevation = scene_.elevation,
                            .azimuth = scene_.azimuth,
                            .spin = scene_.spin * stage.value("spin"),
                            .tilt = scene_.tilt + stage.value("tilt")};
      const double seam = stage.value("seam") * stage.value("spin");
      ball.side.seam_normal = {-sin(seam), 0, cos(seam)};
      ball.side.seed = std::uint64_t(stage.count("seed"));
      if (i == 1) {
        launch.spin = 0;
        ball.side.kind = sports::SideForce::Kind::none;
      }
      const sports::BallState start = sports::launch_state(launch, {0, scene_.height, 0});
      flight_[i] = stage.keep(sports::fly(ball, conditions, start, ball.radius));
      rigid::BodyDef<Dim3> body;
      body.name = i == 0 ? scene_.name : "without spin";
      body.position = start.position;
      body.linear_velocity = Vec3f(start.velocity);
      body.angular_velocity = Vec3f(start.spin);
      body.bullet = true;
      rigid::ShapeDef<Dim3> shape;
      shape.density = float(ball.mass / (4.0 / 3 * pi * ball.radius * ball.radius * ball.radius));
      shape.material.restitution = 0.7f;
      shape.material.friction = 0.5f;
      shape.filter.group = -1;  // the two pass through each other
      balls_[i] = stage.add(body, geometry::Sphere{float(ball.radius)}, shape, i == 0 ? orange : steel);
      geometry::MassProperties3 mass;
      mass.mass = ball.mass;
      const double inertia = sports::inertia(ball);
      mass.inertia = {{inertia, 0, 0}, {0, inertia, 0}, {0, 0, inertia}};
      stage.check(stage.world().set_mass_properties(balls_[i], mass));
      stage.keep(
          stage.world().add_effector(sports::flight_effector(ball, conditions, balls_[i], stage.declaration().dt)));
      radius_ = ball.radius;
    }
    if (flight_[0].nodes().empty() || flight_[1].nodes().empty()) return;
    const double reach = min(scene_.distance, 0.97 * min(flight_[0].end().position.x, flight_[1].end().position.x));
    const auto with = flight_[0].at_x(reach), without = flight_[1].at_x(reach);
    if (with && without)
      stage.say(std::string(scene_.name) +
                format(": after %.1f m the spin has moved it %.2f m up and %.2f m to the right; %.0f km/h there", reach,
                       with->position.y - without->position.y, with->position.z - without->position.z,
                       3.6 * length(with->velocity)));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int i = 0; i < 2; ++i) {
      const auto s = stage.at(balls_[i]);
      const Vec3d p = s.center_of_mass;
      trails_[i].add(p);
      trails_[i].draw(stage, pen(i == 0 ? orange : steel, 0xe0));
      const sports::BallFlight& flight = flight_[i];
      if (flight.nodes().empty()) continue;
      Vec3d last = flight.start().position;
      for (int k = 1; k <= 60; ++k) {
        const Vec3d q = flight.at(flight.duration() * k / 60).position;
        if (k % 2 == 0) stage.line(last, q, pen(0x2b3138, 0xa0));
        last = q;
      }
      // Where it comes through the goal, over the plate, past the stumps.
      if (const auto there = flight.at_x(scene_.distance)) {
        const double size = 0.8 * radius_ + 0.02;
        for (const Vec3d arm : {Vec3d{0, size, size}, Vec3d{0, size, -size}})
          stage.line(there->position - arm, there->position + arm, pen(i == 0 ? red : dark));
      }
      if (t > flight.duration()) continue;
      stage.sample(0, i, p.x, p.y);
      stage.sample(1, i, p.x, -p.z);
      stage.sample(2, i, t, length(s.linear_velocity));
      const double apart = length(p - flight.at(t).position);
      stage.sample(3, i, t, 1e3 * apart);
      if (t < 0.98 * flight.duration()) apart_ = max(apart_, apart);
    }
    // Where the spin axis points.
    const auto s = stage.at(balls_[0]);
    const float w = length(s.angular_velocity);
    if (w > 1)
      stage.line(s.center_of_mass - (2.2 * radius_ / w) * Vec3d(s.angular_velocity),
                 s.center_of_mass + (2.2 * radius_ / w) * Vec3d(s.angular_velocity), pen(red));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back(
        {"world and flight alone, farthest apart", "mm", "the same force in two integrators", 1e3 * apart_, 0, 2});
    const auto with = flight_[0].at_x(scene_.distance), without = flight_[1].at_x(scene_.distance);
    const double bent = with && without ? with->position.z - without->position.z : 0;
    out.push_back({"a free kick of 28 m/s bends over 25 m", "m", "C_L up to .3: class of 2 to 5 m", bent, 3.5, 1.5});
  }

 private:
  void scenery(Stage3& stage) {
    rigid::Material turf;
    turf.friction = 0.6f;
    stage.floor(0, turf);
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    rigid::ShapeDef<Dim3> look;
    look.filter.mask = 0;
    const auto add = [&](const char* name, Vec3d at, Vec3f half, std::uint32_t color) {
      body.name = name;
      body.position = at;
      stage.add(body, geometry::Box{half}, look, color);
    };
    const std::string_view ball = scene_.ball;
    const float far = float(scene_.distance);
    const bool soccer = ball.ends_with("soccer");
    const std::uint32_t ground = soccer                   ? 0x6b9f49
                                 : ball == "tennis"       ? 0x3f6fa8
                                 : ball == "cricket"      ? 0xc9b184
                                 : ball == "table_tennis" ? 0x1f5a8c
                                                          : 0xb98b5e;
    if (ball != "table_tennis")
      add("ground", {far / 2, -0.02, 0},
          {far * 0.75f + 3, 0.022f,
           soccer             ? 14.f
           : ball == "tennis" ? 5.5f
                              : 2.5f},
          ground);
    if (soccer) {
      for (const double z : {-3.66, 3.66}) add("post", {far, 1.22, z}, {0.06f, 1.22f, 0.06f}, 0xffffff);
      add("bar", {far, 2.5, 0}, {0.06f, 0.06f, 3.72f}, 0xffffff);
      for (int i = 0; i < 5; ++i) add("wall", {9.15, 0.9, -1.9 + 0.55 * i}, {0.12f, 0.9f, 0.24f}, i % 2 ? blue : teal);
    } else if (ball == "tennis") {
      add("net", {far / 2, 0.46, 0}, {0.02f, 0.46f, 5.5f}, 0xe8e8e8);
      add("baseline", {far, 0.004, 0}, {0.05f, 0.004f, 4.1f}, 0xffffff);
    } else if (ball == "table_tennis") {
      add("table", {1.37, -0.01, 0}, {1.37f, 0.012f, 0.76f}, ground);
      add("net", {1.37, 0.076, 0}, {0.004f, 0.076f, 0.9f}, 0xe8e8e8);
    } else if (ball == "cricket") {
      for (const double z : {-0.09, 0.0, 0.09}) add("stump", {far, 0.36, z}, {0.02f, 0.36f, 0.02f}, 0xd9b77a);
    } else {
      add("plate", {far, 0.005, 0}, {0.21f, 0.006f, 0.21f}, 0xffffff);
      for (const double z : {-0.216, 0.216}) add("zone", {far, 0.8, z}, {0.008f, 0.3f, 0.008f}, 0xffffff);
      for (const double y : {0.5, 1.1}) add("zone", {far, y, 0}, {0.008f, 0.008f, 0.216f}, 0xffffff);
    }
  }

  SpinScene scene_ = spin_scenes[0];
  sports::BallFlight flight_[2];
  BodyId balls_[2];
  Trail trails_[2] = {Trail(0.05, 400), Trail(0.05, 400)};
  double radius_ = 0.1, apart_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_spin_lab() { return std::make_unique<SpinLab>(); }

}  // namespace carom::host::demo
