// The joints of the plane at work: a piston, gears and a rack, a tackle, a bead, a board, and a cart on springs below.
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;
using rigid::JointId;

class JointsOfThePlane final : public Repeatable<JointsOfThePlane, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "joints-2d";
    d.dimension = 2;
    d.title = "Joints of the plane";
    d.summary = "A motor drives a piston, gears and a rack; a tackle lifts; a cart on springs drives beneath.";
    d.group = "Joints";
    d.chapter = "13";
    d.text =
        "A motor turns the crank, now this way, now that; a rod of two hinges pushes the piston on its slider. A gear "
        "joint takes the crank's "
        "turns to a wheel of twice the teeth, and a rack joint those to a bar. The tackle is a pulley joint of ratio "
        "k: its rope runs k times between the right load and the beam, so that load moves k times as slowly and is "
        "held k times as strongly. The bead is on a path joint, the board is welded of springy pieces, and the "
        "cart's wheels are wheel joints: a spring along the strut, a motor about the axle.\n\n"
        "  x = r cos θ + √(l² − r² sin² θ)      a = g (m₁ − m₂/k)/(m₁ + m₂/k²)";
    d.duration = 8;
    d.dt = 1.0 / 60;
    d.camera = {{0.4, 2.6, 16}, {0.4, 2.6, 0}};
    d.camera.height = 8;
    d.camera.width = 18;
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed of the crank", "rad/s", "rad/s", "of its motor", -10, 10, 0.1, 3, true},
        {"tackle", "Ratio of the tackle", "", "", "parts of the rope that carry the right load", 1, 4, 1, 2, false},
        {"drive", "Speed of the cart", "m/s", "m/s", "that its wheels' motors want", 0, 4, 0.1, 2, true},
        {"suspension", "Frequency of the springs", "Hz", "Hz", "of the cart's suspension", 1, 8, 0.1, 3, false},
    };
    d.plots = {{"Piston", {"time", "s"}, {"place", "m"}, {{"piston"}, {"by the formula"}}},
               {"Tackle", {"time", "s"}, {"fallen", "m"}, {{"left"}, {"right"}}},
               {"Cart", {"time", "s"}, {"height", "cm"}, {{"above its rest"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<Dim2> world;
    world.allow_sleep = false;
    stage.start(world);
    stage.floor(0);
    piston(stage);
    tackle(stage);
    wire(stage);
    board(stage);
    cart(stage);
    changed(stage, "speed");
  }

  void changed(Stage2& stage, std::string_view) override {
    rigid::JointAxis turn;
    turn.free = true;
    turn.motor = {true, -stage.valuef("drive") / wheel_, 15};
    for (const JointId wheel : wheels_) stage.check(stage.world().set_axis(wheel, 2, turn));
  }

  void before_step(Stage2& stage) override {
    way_ = int(stage.world().time() / 2 + 1e-6) % 2 == 0 ? 1 : -1;
    stage.check(stage.world().set_motor(crank_hinge_, {true, float(way_) * stage.valuef("speed"), 500}));
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    const Rot2f turn = stage.at(crank_).pose.rotation;
    const double c = double(turn.c), s = double(turn.s);
    const double wanted = axle_.x + throw_ * c + sqrt(rod_ * rod_ - square(throw_ * s));
    const double place = stage.at(piston_).pose.position.x;
    stage.sample(0, 0, t, place - axle_.x);
    stage.sample(0, 1, t, wanted - axle_.x);
    if (t > 0.2) off_ = max(off_, abs(place - wanted));
    const double left = left_start_ - stage.at(left_).pose.position.y,
                 right = right_start_ - stage.at(right_).pose.position.y;
    stage.sample(1, 0, t, left);
    stage.sample(1, 1, t, right);
    if (t < 0.501) fallen_ = left, fall_time_ = t;
    const rigid::BodyState<Dim2> cart = stage.at(cart_);
    if (t > 0.99 && t < 1.01) rest_ = cart.pose.position.y;
    if (t > 1) stage.sample(2, 0, t, 100 * (cart.pose.position.y - rest_));
    farthest_ = max(farthest_, cart.pose.position.x);
    for (int i = 0; i < 64; ++i) stage.line(on_wire(i), on_wire(i + 1), pen(steel));
    const Vec2d over_left{stage.at(left_).pose.position.x, beam_}, over_right{stage.at(right_).pose.position.x, beam_};
    stage.line(stage.at(left_).pose.position, over_left, pen(sand));
    stage.line(over_left, over_right, pen(sand));
    const int parts = int(stage.value("tackle"));
    for (int i = 0; i < parts; ++i) {
      const Vec2d aside{0.05 * (i - 0.5 * (parts - 1)), 0};
      stage.line(stage.at(right_).pose.position + aside, over_right + aside, pen(sand));
    }
    const Vec2d d = stage.at(bead_).pose.position - ring_;
    bead_off_ = max(bead_off_, abs(length(d) - ring_radius_));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double speed = stage.value("speed"), k = stage.value("tackle");
    out.push_back({"piston off its formula", "m", "r cos θ + √(l² − r² sin² θ)", off_, 0, 0.003});
    const double wheel = double(stage.at(gear_).angular_velocity);
    out.push_back({"speed of the large wheel", "rad/s", "−ω/2", wheel, -0.5 * way_ * speed, 0.02});
    out.push_back({"speed of the rack", "m/s", "radius · ω", double(stage.at(rack_).linear_velocity.x),
                   gear_radius_ * wheel, 0.01});
    out.push_back(
        {"fall of the left load in half a second", "m", "½ a t²", fallen_,
         0.5 * 9.80665 * (left_mass_ - right_mass_ / k) / (left_mass_ + right_mass_ / (k * k)) * square(fall_time_),
         0.01});
    out.push_back({"bead off its wire", "m", "none", bead_off_, 0, 0.002});
    out.push_back({"place of the cart", "m", "2 m/s but for the start and the bumps", farthest_, 7.6, 1});
  }

 private:
  static BodyId part(Stage2& stage, const char* name, Vec2d at, const geometry::Shape2& shape, std::uint32_t color,
                     float density = 100) {
    rigid::BodyDef<Dim2> definition;
    definition.name = name;
    definition.position = at;
    rigid::ShapeDef<Dim2> surface;
    surface.density = density;
    surface.filter.group = -1;
    return stage.add(definition, shape, surface, color);
  }
  /// Frames of a joint at a point of the world; body a may be none.
  static void place(Stage2& stage, rigid::JointFrames<Dim2>& frames, BodyId a, BodyId b, Vec2d at) {
    frames.body_a = a;
    frames.body_b = b;
    frames.frame_a.p = a.is_null() ? Vec2f(at) : local_point(stage.at(a).pose, at);
    frames.frame_b.p = local_point(stage.at(b).pose, at);
  }
  static JointId hinge(Stage2& stage, BodyId a, BodyId b, Vec2d at) {
    rigid::HingeJointDef<Dim2> joint;
    place(stage, joint, a, b, at);
    return stage.keep(stage.world().create_joint(joint));
  }
  static void slide(Stage2& stage, BodyId body, float turn, float range = 0) {
    rigid::SliderJointDef<Dim2> rail;
    place(stage, rail, {}, body, stage.at(body).pose.position);
    rail.frame_a.q = rail.frame_b.q = {cos(turn), sin(turn)};
    rail.limit = {range > 0, -range, range};
    stage.keep(stage.world().create_joint(rail));
  }

  void piston(Stage2& stage) {
    crank_ = part(stage, "crank", axle_, geometry::Circle{float(0.5 * gear_radius_)}, blue);
    crank_hinge_ = hinge(stage, {}, crank_, axle_);
    const Vec2d pin = axle_ + Vec2d{throw_, 0}, end = pin + Vec2d{rod_, 0};
    const BodyId rod = part(stage, "rod", 0.5 * (pin + end), geometry::make_box2({float(0.5 * rod_), 0.05f}), steel);
    piston_ = part(stage, "piston", end, geometry::make_box2({0.22f, 0.2f}), orange);
    hinge(stage, crank_, rod, pin);
    hinge(stage, rod, piston_, end);
    slide(stage, piston_, 0);
    const double small = 0.5 * gear_radius_;
    const Vec2d middle = axle_ + Vec2d{0, -(small + gear_radius_)};
    gear_ = part(stage, "large wheel", middle, geometry::Circle{float(gear_radius_)}, violet);
    hinge(stage, {}, gear_, middle);
    rigid::GearJointDef<Dim2> gear;
    gear.body_a = crank_;
    gear.body_b = gear_;
    gear.ratio = -0.5f;
    stage.keep(stage.world().create_joint(gear));
    rack_ = part(stage, "rack", middle + Vec2d{1.05, -gear_radius_ - 0.08}, geometry::make_box2({1.4f, 0.08f}), gold);
    slide(stage, rack_, 0);
    rigid::RackJointDef<Dim2> rack;
    rack.body_a = gear_;
    rack.body_b = rack_;
    rack.radius = float(gear_radius_);
    stage.keep(stage.world().create_joint(rack));
  }

  void tackle(Stage2& stage) {
    left_ =
        part(stage, "left load", {-0.4, left_start_}, geometry::make_box2({0.2f, 0.2f}), red, float(left_mass_ / 0.16));
    right_ = part(stage, "right load", {0.6, right_start_}, geometry::make_box2({0.25f, 0.25f}), green,
                  float(right_mass_ / 0.25));
    const float ratio = stage.valuef("tackle");
    rigid::PulleyJointDef<Dim2> rope;
    rope.body_a = left_;
    rope.body_b = right_;
    rope.ground_a = {-0.4, beam_};
    rope.ground_b = {0.6, beam_};
    rope.ratio = ratio;
    rope.length = float(beam_ - left_start_) + ratio * float(beam_ - right_start_);
    stage.keep(stage.world().create_joint(rope));
    for (const BodyId load : {left_, right_}) slide(stage, load, float(0.5 * pi), 1.2f);
  }

  void wire(Stage2& stage) {
    std::vector<Vec2f> points;
    for (int i = 0; i < 32; ++i) points.push_back(Vec2f(on_wire(2 * i)));
    bead_ = part(stage, "bead", on_wire(0), geometry::Circle{0.14f}, red);
    rigid::PathJointDef<Dim2> path;
    path.body_b = bead_;
    path.points = points;
    path.closed = true;
    stage.keep(stage.world().create_joint(path));
  }

  void board(Stage2& stage) {
    const Vec2d root{4.6, 3.2};
    BodyId before{};
    for (int i = 0; i < 6; ++i) {
      const Vec2d from = root + Vec2d{0.4 * i, 0};
      const BodyId piece = part(stage, "board", from + Vec2d{0.2, 0}, geometry::make_box2({0.2f, 0.04f}), sand, 300);
      rigid::WeldJointDef<Dim2> weld;
      place(stage, weld, before, piece, from);
      if (i > 0) weld.angular = {24, 0.02f};
      stage.keep(stage.world().create_joint(weld));
      before = piece;
    }
    const BodyId hung = part(stage, "hung", root + Vec2d{2.3, -0.9}, geometry::Circle{0.18f}, blue, 50);
    rigid::DistanceJointDef<Dim2> rope;
    rope.body_a = before;
    rope.body_b = hung;
    rope.frame_a.p = {0.1f, 0};
    rope.length = 0.9f;
    rope.rope = true;
    stage.keep(stage.world().create_joint(rope));
  }

  void cart(Stage2& stage) {
    rigid::BodyDef<Dim2> bump;
    bump.type = rigid::BodyType::fixed;
    bump.name = "bump";
    for (const double x : {-3.0, 0.0, 3.0}) {
      bump.position = {x, -0.45};
      stage.add(bump, geometry::Circle{0.6f}, {}, dark);
    }
    cart_ = part(stage, "cart", {-6.5, 0.62}, geometry::make_box2({0.6f, 0.14f}), orange, 60);
    for (int i = 0; i < 2; ++i) {
      const Vec2d axle{-6.9 + 0.8 * i, wheel_};
      rigid::BodyDef<Dim2> body;
      body.name = "wheel";
      body.position = axle;
      rigid::ShapeDef<Dim2> tyre;
      tyre.density = 60;
      tyre.material.friction = 1;
      tyre.filter.group = -1;
      const BodyId wheel = stage.add(body, geometry::Circle{wheel_}, tyre, dark);
      rigid::JointFrames<Dim2> frames;
      place(stage, frames, cart_, wheel, axle);
      wheels_[i] = stage.keep(stage.world().create_joint(
          rigid::make_wheel_joint<Dim2>(frames, {stage.valuef("suspension"), 0.5f}, {true, -0.12f, 0.12f})));
    }
  }

  Vec2d on_wire(int i) const {
    const double a = 2 * pi * i / 64 + 0.4;
    return ring_ + ring_radius_ * Vec2d{cos(a), sin(a)};
  }

  static constexpr double throw_ = 0.25, rod_ = 1.1, gear_radius_ = 0.7, beam_ = 5.2, left_start_ = 3.6,
                          right_start_ = 3.2, left_mass_ = 2, right_mass_ = 3, ring_radius_ = 0.9;
  static constexpr float wheel_ = 0.26f;
  static constexpr Vec2d axle_{-5.4, 4.0}, ring_{2.8, 4.1};
  BodyId crank_, piston_, gear_, rack_, left_, right_, bead_, cart_;
  JointId crank_hinge_, wheels_[2];
  int way_ = 1;
  double off_ = 0, fallen_ = 0, fall_time_ = 0, rest_ = 0, farthest_ = -9, bead_off_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_joints_plane() { return std::make_unique<JointsOfThePlane>(); }

}  // namespace carom::host::demo
