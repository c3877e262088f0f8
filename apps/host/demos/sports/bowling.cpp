// Ten pins: a ball that skids through oil, hooks on dry boards and rolls into rigid bodies (chapter 19).
#include "apps/host/demos/sports/list.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"
#include "carom/sports/game_presets.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Bowling final : public Repeatable<Bowling, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "bowling";
    d.title = "Bowling on oil";
    d.summary = "The ball skids over the oil, hooks where it ends, rolls, and meets ten pins that are rigid bodies.";
    d.group = "Sports";
    d.chapter = "19";
    d.text =
        "The first twelve metres of a lane are oiled. There friction is small, and the ball's side spin lasts; beyond, "
        "on dry boards, it bites and the ball hooks. Slip keeps its direction under the friction it makes, so each "
        "stretch is a parabola:\n\n"
        "  a = −μ g û,   slip ends after u/(μ g (1 + r²/k²)),   û along v − r ω × ŷ\n\n"
        "With k = 63.5 mm, 8 m/s, 300 turns a minute and the axis turned by 45° the oil ends after 1.580 s, the ball "
        "rolls from 15.52 m on, and comes to the head pin after 2.477 s under 5.34°. The line drawn on the lane is "
        "that "
        "formula; the ball is a body of the world and knows nothing of it.\n\n"
        "Six degrees into the pocket, between the head pin and its neighbour, make a strike most likely.";
    d.dt = 1.0 / 120;
    d.duration = 6;
    d.camera = {{9.6, 2.5, 1.9}, {16.6, 0.1, 0.02}, 0.62};
    d.ground = -0.7;
    d.parameters = {
        choice("player", "Player", "",
               {"as set below", "straight", "stroker", "tweener", "cranker", "two-handed", "backup", "spinner"}),
        {"speed", "Speed", "m/s", "mph", "", 4, 12, 0, 8, false},
        {"spin", "Spin", "rad/s", "rpm", "", 0, 60, 0, 300 * pi / 30, false},
        {"axis", "Axis rotation", "rad", "deg", "0: end over end, 90°: all side spin", -1.5708, 1.5708, 0,
         radians(45.0), false},
        {"angle", "Thrown toward the left", "rad", "deg", "", -0.06, 0.06, 0, -0.0105, false},
        {"start", "Laid down to the left", "m", "cm", "from the middle", -0.42, 0.42, 0, -0.40, false},
        {"oil", "Length of the oil", "m", "ft", "", 0.5, 17, 0, 12.192, false},
        {"oil_friction", "Friction on oil", "", "", "", 0.01, 0.3, 0, 0.04, false},
        {"dry_friction", "Friction on dry boards", "", "", "at most .32 by the rules", 0.05, 0.32, 0, 0.20, false},
        {"gyration", "Radius of gyration", "m", "mm", "62.5 to 71.1 by the rules", 0.0625, 0.0711, 0, 0.0635, false},
        yes_or_no("pins", "Pins", "or the lane alone", true),
    };
    d.plots = {{"From above", {"down the lane", "m"}, {"to the left", "m"}, {{"ball in the world"}, {"formula"}}},
               {"Slip", {"time", "s"}, {"slip at the lane", "m/s"}, {{"ball in the world"}, {"formula"}}},
               {"Standing pins", {"time", "s"}, {"pins", ""}, {{"standing"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {0, -9.80665f, 0};
    world.substeps = 8;
    stage.start(world);
    stage.floor(-0.7);
    const double oil = stage.value("oil");
    const float wet = stage.valuef("oil_friction"), dry = stage.valuef("dry_friction");
    // The ball has friction 1, and a pair the geometric mean: the lane gets the squares.
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    const auto slab = [&](const char* name, Vec3d low, Vec3d high, float friction, std::uint32_t color) {
      rigid::ShapeDef<Dim3> shape;
      shape.material.friction = friction;
      shape.material.user_id = 0xff000000u | color;
      body.name = name;
      body.position = 0.5 * (low + high);
      const Vec3f half(0.5 * (high - low));
      stage.add(body, geometry::Box{half}, shape, color);
    };
    const double half = lane_.width / 2, out = half + 0.235;
    slab("approach", {-4.6, -0.2, -out}, {0, 0, out}, 0.5f, 0xb98a54);
    // Oil, dry boards and pin deck are one surface of three materials: a ball feels no joint between them.
    stage.looks_in_materials = true;
    std::vector<Vec3f> corners;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint8_t> materials;
    const double ends[] = {0, oil, 17.9, 19.3};
    for (std::size_t i = 0; i < 4; ++i)
      for (const double z : {-half, half}) corners.push_back({float(ends[i]), 0, float(z)});
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t k = 2 * i;
      for (const std::uint32_t corner : {k, k + 1, k + 3, k, k + 3, k + 2}) indices.push_back(corner);
      materials.insert(materials.end(), 2, std::uint8_t(i));
    }
    rigid::ShapeDef<Dim3> boards;
    const auto surface = [](float friction, std::uint32_t color) {
      rigid::SurfaceMaterial<Dim3> m;
      m.material.friction = friction;
      m.material.user_id = 0xff000000u | color;
      return m;
    };
    boards.surfaces = {surface(wet * wet, 0xd2a865), surface(dry * dry, 0xe6c48b), surface(2.5f, 0xefd9b0)};
    body.name = "lane";
    body.position = {};
    stage.add(body,
              stage.keep(geometry::make_triangle_mesh(std::move(corners), std::move(indices), std::move(materials))),
              boards, 0xe6c48b);
    slab("underside", {0, -0.25, -half}, {19.3, -0.06, half}, 0.3f, 0x8a6a42);
    for (const double side : {-1.0, 1.0}) {
      const double a = side * half, b = side * out, c = side * (out + 0.1);
      slab("gutter", {0, -0.29, min(a, b)}, {19.3, -0.09, max(a, b)}, 0.1f, 0x4a4f57);
      slab("kickback", {17.7, -0.6, min(b, c)}, {20.3, 0.9, max(b, c)}, 0.3f, 0x3c4654);
    }
    slab("pit", {19.3, -0.7, -out}, {20.3, -0.5, out}, 0.9f, 0x23282f);
    slab("cushion", {20.2, -0.6, -out}, {20.4, 0.9, out}, 0.9f, 0x2f3a52);
    slab("mask", {17.6, 0.75, -out - 0.1}, {17.8, 1.5, out + 0.1}, 0.9f, 0x38506f);

    const sports::BowlingBall ball{.gyration = stage.value("gyration")};
    lane_.stretches = {{oil, double(wet)}, {max(lane_.length, oil + 0.1), double(dry)}};
    delivery_ = {.speed = stage.value("speed"),
                 .angle = stage.value("angle"),
                 .spin = stage.value("spin"),
                 .axis_rotation = stage.value("axis"),
                 .start = stage.value("start")};
    if (const int player = int(stage.value("player")); player > 0)
      delivery_ = sports::bowling_presets()[std::size_t(player - 1)].value;
    path_ = stage.keep(sports::bowl(ball, lane_, delivery_));
    rigid::BodyDef<Dim3> thrown;
    thrown.name = "ball";
    thrown.position = {0, ball.radius, -delivery_.start};
    const Vec3d way{cos(delivery_.angle), 0, -sin(delivery_.angle)};
    thrown.linear_velocity = Vec3f(delivery_.speed * way);
    // Its contact point moves back under it along the direction of the rim: ω = ŷ × rim / r.
    const double turned = delivery_.angle + delivery_.axis_rotation;
    const Vec3d rim{cos(turned), 0, -sin(turned)};
    thrown.angular_velocity = Vec3f(delivery_.spin * cross(Vec3d{0, 1, 0}, rim));
    thrown.bullet = true;
    thrown.allow_sleep = false;
    rigid::ShapeDef<Dim3> skin;
    skin.material.friction = 1;
    skin.material.restitution = 0.05f;
    skin.material.user_id = 0xff3b4cc0u;
    ball_ = stage.add(thrown, geometry::Sphere{float(ball.radius)}, skin, 0x3b4cc0);
    geometry::MassProperties3 mass;
    mass.mass = ball.mass;
    const double inertia = ball.mass * ball.gyration * ball.gyration;
    mass.inertia = {{inertia, 0, 0}, {0, inertia, 0}, {0, 0, inertia}};
    stage.check(stage.world().set_mass_properties(ball_, mass));
    if (stage.value("pins") > 0.5) rack(stage);
    for (int i = 0; i <= 120 && !path_.points.empty(); ++i) {
      const sports::LanePoint p = path_.at(path_.end().time * i / 120);
      stage.sample(0, 1, p.x, p.y);
      stage.sample(1, 1, p.time, hypot(p.speed_x - p.rim_x, p.speed_y - p.rim_y));
    }
    if (!path_.points.empty() && !path_.gutter)
      stage.say(format("formula: pins after %.3f s, %.3f m left of the middle, entry angle %.2f°", path_.end().time,
                       path_.end().y, degrees(path_.entry_angle())));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const auto s = stage.at(ball_);
    const Vec3d p = s.center_of_mass, v(s.linear_velocity), w(s.angular_velocity);
    there_ = there_ || p.x >= 18.08;  // then it touches the head pin
    if (!there_) {
      stage.sample(0, 0, p.x, -p.z);
      const Vec3d slip = v - 0.1085 * cross(w, Vec3d{0, 1, 0});
      stage.sample(1, 0, t, hypot(slip.x, slip.z));
      arrived_ = {p.x, -p.z, t};
      trail_.add(p + Vec3d{0, -0.09, 0});
    }
    trail_.draw(stage, pen(blue, 0xc0));
    Vec3d last{};
    for (int i = 0; i <= 60 && !path_.points.empty(); ++i) {
      const sports::LanePoint f = path_.at(path_.end().time * i / 60);
      const Vec3d at{f.x, 0.006, -f.y};
      if (i > 0 && i % 2 == 0) stage.line(last, at, pen(dark, 0xb0));
      last = at;
    }
    int standing = 0;
    for (const BodyId pin : pins_) {
      const auto q = stage.at(pin).pose;
      const Vec3f up = rotate(q.rotation, Vec3f{0, 1, 0});
      if (up.y > 0.8f && q.position.y > 0.1) ++standing;
    }
    if (!pins_.empty()) {
      stage.sample(2, 0, t, standing);
      if (t > 4.5 && !told_) {
        told_ = true;
        const int down = int(pins_.size()) - standing;
        stage.say(down == 10 ? std::string("strike!") : format("%.0f pins down, %.0f stand", down, standing));
      }
    }
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const sports::LanePath straight = stage.keep(
        sports::bowl({}, {}, {.speed = 8, .spin = 300 * pi / 30, .axis_rotation = radians(45.0), .start = -0.3}));
    if (straight.points.empty() || path_.points.empty()) return;
    const char* source = "closed form: 8 m/s, 300 rpm, axis 45 deg";
    out.push_back({"hook of the formula", "m", source, straight.end().y + 0.3, 0.657186, 1e-6});
    out.push_back({"its entry angle", "deg", source, degrees(straight.entry_angle()), 5.3441, 1e-4});
    const double left = path_.at(arrived_.z).y;
    out.push_back({"the body's way against the formula", "m", "closed form", arrived_.y, left, 0.02});
  }

 private:
  void rack(Stage3& stage) {
    // A pin by its radii over its height (USBC: 381 mm high, 121 mm at the belly, 1.53 to 1.64 kg), in three hulls.
    constexpr double profile[][2] = {{0, 25.8},   {19, 35.8},  {57, 49.7},  {86, 56.3},  {114, 60.5},
                                     {149, 58.0}, {184, 47.1}, {222, 31.4}, {254, 22.8}, {277, 23.8},
                                     {298, 27.1}, {325, 31.0}, {343, 32.3}, {366, 26.0}, {381, 8.0}};
    const auto piece = [&](int first, int last) {
      std::vector<Vec3f> points;
      for (int i = first; i <= last; ++i)
        for (int k = 0; k < 12; ++k) {
          const double a = 2 * pi * k / 12, r = profile[i][1] * 1e-3;
          points.push_back({float(r * cos(a)), float(profile[i][0] * 1e-3 - 0.148), float(r * sin(a))});
        }
      return stage.keep(geometry::make_hull(points, {.max_vertices = 200}));
    };
    const auto belly = piece(0, 6), neck = piece(6, 8), head = piece(8, 14);
    if (!belly || !neck || !head) return;
    rigid::ShapeDef<Dim3> shape;
    shape.density = 650;
    shape.material.friction = 0.03f;
    shape.material.user_id = 0xfff4f1e8u;
    shape.material.restitution = 0.6f;
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k <= row; ++k) {
        rigid::BodyDef<Dim3> body;
        body.name = "pin";
        body.position = {18.288 + 0.264 * row, 0.148, 0.3048 * (k - 0.5 * row)};
        pins_.push_back(stage.add(body, {{belly, shape}, {neck, shape}, {head, shape}}, 0xf4f1e8));
        geometry::MassProperties3 mass = stage.keep(stage.world().mass_properties3(pins_.back()));
        const double scale = 1.55 / mass.mass;
        mass.mass *= scale;
        mass.inertia = {scale * mass.inertia.cx, scale * mass.inertia.cy, scale * mass.inertia.cz};
        stage.check(stage.world().set_mass_properties(pins_.back(), mass));
      }
  }

  sports::Lane lane_{};
  sports::Delivery delivery_{};
  sports::LanePath path_{};
  BodyId ball_{};
  std::vector<BodyId> pins_;
  Trail trail_{0.1, 300};
  Vec3d arrived_{};
  bool told_ = false, there_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_bowling() { return std::make_unique<Bowling>(); }

}  // namespace carom::host::demo
