// A golf hole in one call: swing, impact, flight, bounces and roll, beside what launch monitors say (chapter 19).
#include "apps/host/demos/sports/list.h"
#include "carom/math/elementary.h"
#include "carom/sports/golf.h"
#include "carom/sports/presets.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

constexpr double golf_yard = 0.9144, golf_mph = 0.44704, golf_degree = pi / 180;
constexpr double green_x = 235, green_radius = 15;

class GolfHole final : public Repeatable<GolfHole, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "golf-hole";
    d.title = "A golf hole";
    d.summary = "Swing, impact, flight, bounces and roll with twelve clubs, beside the averages of the tour.";
    d.group = "Sports";
    d.chapter = "19.1, 19.2, 6.3";
    d.text =
        "The player's arms and club swing as two rods; the head meets the ball with its loft, face and path. What the "
        "face does along itself becomes spin, and spin becomes lift.\n\n"
        "  J = K⁻¹ ((1 + e) v_n n + (1 + e_x) v_t),   K = 1/m + 1/M + (both bodies' turning)\n\n"
        "  F = ½ ρ A V² (C_D(Re, S) backward + C_L(S, Re) across),   S = r ω/V\n\n"
        "Lift saturates with spin, and drag rises steeply where the ball gets slow and the dimples no longer help (Re "
        "near 7·10⁴): that is why a drive falls so steeply at the end. On the turf the ball ploughs in: its bounce is "
        "that of a slope that leans back by up to 15° at 67 km/h, more for a steeper fall (Penner).\n\n"
        "With its own numbers for each club the flight is within 3 % of the carry, 3 yd of the height and 3° of "
        "the landing angle that launch monitors measured on average on the PGA tour. Open the face or swing across, "
        "and see the ball curve: it starts near where the face looks and bends away from the path.";
    d.duration = 15;
    d.camera = {{-11, 2.7, 2.2}, {60, 4, 0}, 0.62};
    d.ground = -0.5;
    d.parameters = {
        choice("club", "Club", "",
               {"driver", "3-wood", "5-wood", "hybrid", "3-iron", "4-iron", "5-iron", "6-iron", "7-iron", "8-iron",
                "9-iron", "wedge"}),
        {"speed", "Head speed", "", "%", "of a tour player's", 0.5, 1.2, 0.01, 1, false},
        {"face", "Face", "rad", "deg", "to the right of the target", -0.12, 0.12, 0, 0, false},
        {"path", "Path", "rad", "deg", "of the head, to the right", -0.12, 0.12, 0, 0, false},
        {"attack", "More angle of attack", "rad", "deg", "upward, beyond the tour's average", -0.09, 0.12, 0, 0, false},
        {"toe", "Struck toward the toe", "m", "mm", "from the middle of the face", -0.025, 0.025, 0, 0, false},
        {"high", "Struck high", "m", "mm", "on the face", -0.015, 0.015, 0, 0, false},
        {"wind", "Wind from behind", "m/s", "m/s", "at 10 m; it blows less near the ground", -12, 12, 0, 0, false},
        {"cross", "Wind to the right", "m/s", "m/s", "", -12, 12, 0, 0, false},
        {"stimp", "Speed of the green", "m", "ft", "how far a Stimpmeter's ball rolls", 1.8, 4.3, 0, 3.05, false},
        {"altitude", "Altitude", "m", "m", "thin air carries farther", 0, 3000, 0, 0, false},
    };
    std::vector<Vec2d> carry, apex, angle;
    for (const sports::ClubPreset& c : sports::club_presets()) {
      carry.push_back({c.ball_speed * golf_mph, c.carry * golf_yard});
      apex.push_back({c.ball_speed * golf_mph, c.apex * golf_yard});
      angle.push_back({c.ball_speed * golf_mph, c.landing});
    }
    const Axis speed{"ball speed", "m/s"};
    d.plots = {{"Side view",
                {"distance", "m"},
                {"height", "m"},
                {{"this shot"}, {"tour average: carry, and height over this apex", Series::Style::points}}},
               {"From above", {"distance", "m"}, {"to the left", "m"}, {{"this shot"}}},
               {"Carry of twelve clubs",
                speed,
                {"carry", "m"},
                {{"this model"}, {"launch monitors", Series::Style::points, carry}}},
               {"Height of twelve clubs",
                speed,
                {"apex", "m"},
                {{"this model"}, {"launch monitors", Series::Style::points, apex}}},
               {"Landing angle",
                speed,
                {"angle", "deg"},
                {{"this model"}, {"launch monitors", Series::Style::points, angle}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    stage.start(world);
    scenery(stage);
    const std::size_t club = std::size_t(stage.count("club"));
    const sports::ClubPreset& preset = sports::club_presets()[min(club, sports::club_presets().size() - 1)];
    shot_ = stage.keep(sports::tour_shot(preset.name));
    if (!shot_.swing.links.empty() && stage.value("speed") != 1)
      shot_.swing = stage.keep(sports::swing_for_speed(shot_.swing, preset.delivery.speed * stage.value("speed")));
    if (shot_.swing.links.empty()) return;
    shot_.face = stage.value("face");
    shot_.path = stage.value("path");
    shot_.attack += stage.value("attack");
    shot_.toe = stage.value("toe");
    shot_.high = stage.value("high");
    if (stage.value("altitude") > 0) shot_.conditions.air = environment::AirColumn({}, stage.value("altitude"));
    shot_.conditions.wind =
        environment::WindColumn(environment::Wind{.velocity = {stage.value("wind"), 0, stage.value("cross")},
                                                  .profile = environment::WindProfile::power},
                                120);
    const sports::Surface fairway = *sports::surface_preset("fairway"), rough = *sports::surface_preset("rough"),
                          bunker = *sports::surface_preset("bunker");
    sports::Surface green = *sports::surface_preset("green");
    green.rolling = sports::rolling_of_stimp(stage.value("stimp"));
    const auto ground = [&](double x, double z) {
      if (hypot(x - green_x, z) < green_radius) return sports::Ground{0, {0, 1, 0}, green};
      if (hypot(x - 214, z - 17) < 6 || hypot(x - 224, z + 19) < 7) return sports::Ground{0, {0, 1, 0}, bunker};
      return sports::Ground{0, {0, 1, 0}, abs(z - bend(x)) < 17 ? fairway : rough};
    };
    result_ = stage.keep(sports::play_golf(shot_, ground));
    if (result_.shot.contacts().empty()) return;
    const sports::Landing& landing = result_.landing;
    const double speed = result_.impact.launch.speed;
    stage.sample(0, 1, preset.carry * golf_yard, 0);
    // Where along the way it is highest is not published: drawn over this shot's own apex.
    stage.sample(0, 1, result_.shot.first_flight().apex().position.x, preset.apex * golf_yard);
    for (const sports::ClubPreset& c : sports::club_presets()) {
      const auto flight = sports::fly(
          shot_.ball, {},
          sports::launch_state(
              {.speed = c.ball_speed * golf_mph, .elevation = c.launch * golf_degree, .spin = c.spin * pi / 30}));
      if (!flight) continue;
      const sports::Landing told = sports::landing(*flight);
      stage.sample(2, 0, c.ball_speed * golf_mph, told.carry);
      stage.sample(3, 0, c.ball_speed * golf_mph, told.apex);
      stage.sample(4, 0, c.ball_speed * golf_mph, told.angle / golf_degree);
    }
    stage.say(format("launch %.1f m/s at %.1f°, %.0f rpm; carry %.0f yd, apex %.0f yd, total %.0f yd", speed,
                     degrees(result_.impact.launch.elevation), result_.impact.launch.spin * 30 / pi,
                     landing.carry / golf_yard, landing.apex / golf_yard, result_.total / golf_yard));
  }

  void after_step(Stage3& stage) override {
    if (result_.swing.nodes.empty()) return;
    const double now = stage.world().time();
    // The downswing a quarter as fast as it is, then the ball as it flies.
    const double swung = min(result_.swing.time, now / slowness);
    const double t = max(0.0, now - result_.swing.time * slowness);
    draw_swing(stage, swung, t);
    const Vec3d at = result_.shot.at(t).position;
    const bool rests = t >= result_.shot.duration();
    if (t > 0) {
      trail_.add(at);
      if (!rests) {
        stage.sample(0, 0, at.x, at.y);
        stage.sample(1, 0, at.x, -at.z);
      }
    }
    trail_.draw(stage, pen(red, 0xe0));
    // Large enough to be seen from the tee, and never smaller than it is.
    const float size = float(max(0.0214, 0.0042 * math::distance(at, Vec3d{-11, 2.7, 2.2})));
    const Vec3f where(at + Vec3d{0, double(size), 0});
    stage.points({&where, 1}, size, pen(0xffffff));
    for (const sports::Shot::Contact& c : result_.shot.contacts())
      if (t >= c.time) stage.line(c.before.position, c.before.position + Vec3d{0, 3, 0}, pen(gold, 0x90));
    if (rests && !told_) {
      told_ = true;
      stage.say(format("carry %.1f m, lands at %.1f°, rolls to %.1f m, %.1f m right; %.1f m from the flag",
                       result_.landing.carry, degrees(result_.landing.angle), at.x, at.z, hypot(at.x - green_x, at.z)));
    }
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const sports::ClubPreset& c = sports::club_presets().front();
    const char* source = "TrackMan, averages of the PGA tour";
    out.push_back(
        {"carry of the driver", "m", source, result_.landing.carry, c.carry * golf_yard, .03 * 275 * golf_yard});
    out.push_back({"apex", "m", source, result_.landing.apex, c.apex * golf_yard, 3 * golf_yard});
    out.push_back({"landing angle", "deg", source, degrees(result_.landing.angle), c.landing, 3});
    out.push_back({"smash factor", "", "ball speed over head speed, 1.48 to 1.49", result_.impact.smash, 1.48, 0.01});
  }

 private:
  static constexpr double slowness = 4;
  static double bend(double x) { return 5 * sin(x / 70); }

  void draw_swing(Stage3& stage, double swung, double since) const {
    // The swing's plane leans toward the player, who stands to the left and looks across.
    const double plane = 60 * golf_degree;
    const double reach = shot_.swing.links[0].length + shot_.swing.links[1].length;
    const Vec3d up{0, sin(plane), -cos(plane)}, hub = shot_.tee + reach * up;
    const auto place = [&](Vec2d p) { return hub + Vec3d{p.x, 0, 0} + p.y * up; };
    const auto figure = [&](double t, std::uint32_t alpha) {
      const sports::SwingState s = result_.swing.at(t);
      const Vec3d hands = place(sports::swing_point(shot_.swing, s, 0)),
                  head = place(sports::swing_point(shot_.swing, s, 1));
      const auto thick = [&](Vec3d a, Vec3d b, std::uint32_t color) {
        for (int i = -1; i <= 1; ++i) {
          const Vec3d off{0.006 * i, 0.004 * i, 0.006 * i};
          stage.line(a + off, b + off, pen(color, alpha));
        }
      };
      thick(hub, hands, blue);
      thick(hands, head, 0x202428);
      stage.line(head - Vec3d{0, 0.03, 0}, head + Vec3d{0, 0.03, 0.1}, pen(orange, alpha));
    };
    if (since < 1) figure(swung, 0xff);
    Vec3d last = place(sports::swing_point(shot_.swing, result_.swing.at(0), 1));
    for (int i = 1; i <= 48; ++i) {
      const double t = result_.swing.time * i / 48;
      if (t > swung) break;
      const Vec3d p = place(sports::swing_point(shot_.swing, result_.swing.at(t), 1));
      stage.line(last, p, pen(orange, 0xa0));
      last = p;
    }
    // The player: head, spine and legs, as a hint of the scale.
    const Vec3d hips = hub + Vec3d{0, -0.5, -0.25};
    const Vec3d head = hub + Vec3d{0, 0.32, 0.03};
    stage.line(hub, hips, pen(dark));
    stage.line(hips, {-0.22, 0, hips.z + 0.05}, pen(dark));
    stage.line(hips, {0.22, 0, hips.z + 0.05}, pen(dark));
    for (int i = 0; i < 12; ++i) {
      const double a = 2 * pi * i / 12, b = 2 * pi * (i + 1) / 12;
      stage.line(head + 0.11 * Vec3d{cos(a), sin(a), 0}, head + 0.11 * Vec3d{cos(b), sin(b), 0}, pen(dark));
    }
  }

  static void scenery(Stage3& stage) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    rigid::ShapeDef<Dim3> look;
    look.filter.mask = 0;
    const auto add = [&](const char* name, Vec3d at, const geometry::Shape3& shape, std::uint32_t color) {
      body.name = name;
      body.position = at;
      stage.add(body, shape, look, color);
    };
    // Each strip of ground lies a little over the next one: no edge is seen from the tee.
    add("rough", {150, -0.31, 0}, geometry::Box{{190, 0.25f, 70}}, 0x55803f);
    add("rough", {-15.4, -0.257, 0}, geometry::Box{{24.6f, 0.25f, 70}}, 0x55803f);
    for (int i = 0; i < 24; ++i)
      add("fairway", {15.1 + 12.0 * i, -0.055 - 0.002 * i, bend(15 + 12.0 * i)}, geometry::Box{{6.1f, 0.045f, 17}},
          i % 2 ? 0x74a84f : 0x6b9f49);
    add("tee", {0, -0.02, 0}, geometry::Box{{3, 0.02f, 2}}, 0x86b95e);
    add("green", {green_x, -0.02, 0}, geometry::Cylinder{0.04f, float(green_radius)}, 0x9ccc74);
    add("bunker", {214, -0.02, 17}, geometry::Cylinder{0.035f, 6}, 0xe3d3a2);
    add("bunker", {224, -0.02, -19}, geometry::Cylinder{0.035f, 7}, 0xe3d3a2);
    add("flagstick", {green_x, 1.5, 0}, geometry::Cylinder{1.5f, 0.06f}, 0xf2f2f2);
    add("flag", {green_x, 2.6, 0.7}, geometry::Box{{0.03f, 0.4f, 0.7f}}, red);
    for (int i = 0; i < 26; ++i) {
      const double x = 40 + 11.0 * i, side = i % 2 ? 1 : -1, z = bend(x) + side * (34 + (i * 7) % 13);
      add("trunk", {x, 1.5, z}, geometry::Cylinder{1.5f, 0.3f}, 0x6b4a2f);
      add("tree", {x, 6.5, z}, geometry::Cone{4.5f, float(2.4 + 0.2 * (i % 4))}, i % 3 ? 0x3f6b3a : 0x4b7a40);
    }
    for (int yards = 50; yards <= 300; yards += 50)
      add("marker", {yards * golf_yard, 0.5, bend(yards * golf_yard) - 17}, geometry::Box{{0.15f, 0.5f, 0.15f}}, gold);
  }

  sports::GolfShot shot_{};
  sports::GolfShotResult result_{};
  Trail trail_{0.6, 400};
  bool told_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_golf_hole() { return std::make_unique<GolfHole>(); }

}  // namespace carom::host::demo
