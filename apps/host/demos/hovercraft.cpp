// A craft on an air cushion, seen from above: it slides where it was going, not where it points (chapters 9 and 10).
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::Dim2;

class Hovercraft final : public Repeatable<Hovercraft, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "hovercraft";
    d.title = "Hovercraft: drive and ram";
    d.summary = "Drive a hovercraft with the arrow keys, drift through bends, ram the others and the crates.";
    d.group = "Rigid bodies";
    d.chapter = "9, 10";
    d.dimension = 2;
    d.text =
        "Seen from above there is no gravity. A fan at the stern pushes along the axis, two thrusters at the bow turn "
        "the craft, and the air holds it back in proportion to its speed. Nothing holds it sideways: heading and track "
        "differ in every bend.\n\n"
        "  m v̇ = T − C v      v = T/C (1 − e^(−C t/m))\n\n"
        "  I ω̇ = ±F l − C_ω ω\n\n"
        "Until a key is pressed the craft drives by itself: five seconds straight ahead, which the plot compares with "
        "the formula, then round the yard.";
    d.dt = 1.0 / 60;
    d.duration = 20;
    d.camera.height = 46;
    d.camera.width = 80;
    d.parameters = {
        {"mass", "Mass", "kg", "kg", "of each craft", 200, 4000, 10, 1000, false},
        {"thrust", "Thrust of the fan", "N", "kN", "full throttle", 500, 20000, 100, 6000, true},
        {"bow_thrust", "Bow thruster", "N", "kN", "either side", 50, 4000, 10, 900, true},
        {"drag", "Linear drag C", "N·s/m", "N·s/m", "force per speed", 50, 2000, 10, 500, false},
        {"angular_drag", "Angular drag", "N·m·s", "N·m·s", "torque per angular speed", 100, 20000, 100, 3000, false},
        {"restitution", "Restitution", "", "", "of hulls, crates and walls", 0, 1, 0, 0.4, false},
    };
    d.plots = {
        {"Speed", {"time", "s"}, {"speed", "m/s"}, {{"craft"}, {"formula, straight ahead", Series::Style::points}}},
        {"Heading and track", {"time", "s"}, {"drift angle", "deg"}, {{"track − heading"}}},
        {"Energy of the yard", {"time", "s"}, {"kinetic energy", "kJ"}, {{"all bodies"}}}};
    d.inputs = {{"throttle", "Throttle", {"ArrowUp", "KeyW"}, false, 1},
                {"reverse", "Reverse", {"ArrowDown", "KeyS"}, false, 1},
                {"port", "Turn left", {"ArrowLeft", "KeyA"}, false, 1},
                {"starboard", "Turn right", {"ArrowRight", "KeyD"}, false, 1}};
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<Dim2> world;
    world.gravity = {};
    stage.start(world);
    material_.restitution = stage.valuef("restitution");
    material_.friction = 0.3f;
    player_ = craft(stage, {-34, -16.5}, 0, orange, "craft");
    others_.push_back(craft(stage, {20, 12}, 2.6f, blue, "other craft"));
    others_.push_back(craft(stage, {26, -6}, -2.2f, teal, "other craft"));
    others_.push_back(craft(stage, {-20, 12}, -0.6f, violet, "other craft"));
    yard(stage);
    const double t_over_c = stage.value("thrust") / stage.value("drag");
    for (double t = 0.25; t <= straight_; t += 0.25)
      stage.sample(0, 1, t, t_over_c * (1 - exp(-stage.value("drag") * t / stage.value("mass"))));
  }

  void before_step(Stage2& stage) override {
    const double forward = stage.input("throttle") - 0.5 * stage.input("reverse");
    double turn = stage.input("port") - stage.input("starboard");
    double throttle = forward;
    if (forward != 0 || turn != 0) driven_ = true;
    if (!driven_) pilot(stage, player_, 0.4, straight_, throttle, turn);
    push(stage, player_, throttle, turn, true);
    for (std::size_t i = 0; i < others_.size(); ++i) {
      pilot(stage, others_[i], 0.9 * (double(i) + 1), 0, throttle, turn);
      push(stage, others_[i], 0.45 * throttle, turn, false);
    }
  }

  void after_step(Stage2& stage) override {
    const auto craft = stage.at(player_);
    const double t = stage.world().time();
    const double speed = length(Vec2d(craft.linear_velocity));
    if (t <= straight_ + 1e-9 && !driven_) speed_straight_ = speed, time_straight_ = t;
    stage.sample(0, 0, t, speed);
    const Vec2d axis{craft.pose.rotation.c, craft.pose.rotation.s};
    if (speed > 0.5)
      stage.sample(1, 0, t,
                   degrees(atan2(cross(axis, Vec2d(craft.linear_velocity)), dot(axis, Vec2d(craft.linear_velocity)))));
    stage.sample(2, 0, t, stage.world().totals().kinetic_energy / 1e3);
    trail_.add(craft.pose.position);
    trail_.draw(stage, pen(orange, 0x70));
    stage.line(craft.center_of_mass, craft.center_of_mass + 0.4 * Vec2d(craft.linear_velocity), pen(0xffffff, 0xc0));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double c = stage.value("drag"), m = stage.value("mass");
    const double exact = stage.value("thrust") / c * (1 - exp(-c * time_straight_ / m));
    out.push_back(
        {"speed after the straight", "m/s", "ch. 4.2: v = T/C (1 − e^(−Ct/m))", speed_straight_, exact, 0.01 * exact});
  }

 private:
  static constexpr double straight_ = 5;

  rigid::BodyId craft(Stage2& stage, Vec2d position, float heading, std::uint32_t color, const char* name) {
    rigid::BodyDef<Dim2> body;
    body.name = name;
    body.position = position;
    body.rotation = {cos(heading), sin(heading)};
    body.sleep_speed = 0;
    constexpr Vec2f hull[] = {{-2, -0.95f}, {1.1f, -0.95f}, {2.1f, -0.35f}, {2.1f, 0.35f}, {1.1f, 0.95f}, {-2, 0.95f}};
    rigid::ShapeDef<Dim2> shape;
    shape.material = material_;
    shape.density = stage.valuef("mass") / 7.19f;  // area of that hull, m²
    const rigid::BodyId id = stage.add(body, stage.keep(geometry::make_polygon(hull, 0)), shape, color);
    rigid::LinearDrag<Dim2> drag;
    drag.body = id;
    drag.coefficient = stage.value("drag");
    drag.angular_coefficient = stage.value("angular_drag");
    stage.keep(stage.world().add_effector(drag));
    return id;
  }

  void yard(Stage2& stage) {
    rigid::ShapeDef<Dim2> solid;
    solid.material = material_;
    rigid::BodyDef<Dim2> walls;
    walls.type = rigid::BodyType::fixed;
    walls.name = "wall";
    const auto wall = [&](Vec2f at, Vec2f half) {
      rigid::ShapeDef<Dim2> shape = solid;
      shape.local.p = at;
      return Stage2::Part{geometry::make_box2(half), shape};
    };
    stage.add(walls,
              {wall({0, 21.5f}, {39, 0.5f}), wall({0, -21.5f}, {39, 0.5f}), wall({38.5f, 0}, {0.5f, 21}),
               wall({-38.5f, 0}, {0.5f, 21}), wall({0, 7}, {0.6f, 5}), wall({0, -9}, {0.6f, 4})},
              dark);
    const auto crate = [&](Vec2d at, float half, std::uint32_t color) {
      rigid::BodyDef<Dim2> body;
      body.name = "crate";
      body.position = at;
      body.linear_damping = 0.5f;
      body.angular_damping = 0.8f;
      rigid::ShapeDef<Dim2> shape = solid;
      shape.density = 40;
      stage.add(body, geometry::make_box2({half, half}, 0.05f), shape, color);
    };
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 4; ++j) crate({10.0 + 1.7 * i, -17.0 + 1.7 * j}, 0.75f, sand);
    for (int i = 0; i < 6; ++i) crate({-12.0 + 1.3 * i, 16.0 - 0.2 * i}, 0.55f, gold);
    for (int k = 0; k < 6; ++k) {
      rigid::BodyDef<Dim2> body;
      body.name = "buoy";
      body.position = {-8.0 + 5.5 * k, k % 2 == 0 ? -1.5 : 1.5};
      body.linear_damping = 0.6f;
      rigid::ShapeDef<Dim2> shape = solid;
      shape.density = 30;
      stage.add(body, geometry::Circle{0.6f}, shape, red);
    }
  }

  /// Steers toward a point that runs round the yard.
  static void pilot(Stage2& stage, rigid::BodyId id, double phase, double straight, double& throttle, double& turn) {
    const auto craft = stage.at(id);
    const double t = stage.world().time();
    throttle = 1;
    turn = 0;
    if (t < straight) return;
    const double angle = 0.32 * t + 1.7 * phase;
    const Vec2d goal{25 * cos(angle), 13 * sin(angle)};
    const Vec2d axis{craft.pose.rotation.c, craft.pose.rotation.s};
    const Vec2d way = goal - craft.pose.position;
    const double error = atan2(cross(axis, way), dot(axis, way));
    turn = clamp(2.0 * error - 1.2 * double(craft.angular_velocity), -1.0, 1.0);
    throttle = abs(error) < 0.9 ? 0.8 : 0.25;
  }

  static void push(Stage2& stage, rigid::BodyId id, double throttle, double turn, bool show) {
    const auto craft = stage.at(id);
    const Rot2f q = craft.pose.rotation;
    const float fan = float(throttle) * stage.valuef("thrust"), bow = float(turn) * stage.valuef("bow_thrust");
    if (fan != 0) stage.check(stage.world().add_force(id, rotate(q, Vec2f{fan, 0})));
    const Vec2d bow_point = world_point(craft.pose, {1.8f, 0});
    if (bow != 0) stage.check(stage.world().add_force_at(id, rotate(q, Vec2f{0, bow}), bow_point));
    if (!show) return;
    const Vec2d stern = world_point(craft.pose, {-2.0f, 0});
    if (throttle != 0) stage.line(stern, stern + Vec2d(rotate(q, Vec2f{-2.0f * float(throttle), 0})), pen(gold));
    if (turn != 0) {
      const Vec2d side = world_point(craft.pose, {1.8f, turn > 0 ? -0.7f : 0.7f});
      stage.line(side, side + Vec2d(rotate(q, Vec2f{0, -1.2f * float(turn)})), pen(gold));
    }
  }

  rigid::Material material_;
  rigid::BodyId player_;
  std::vector<rigid::BodyId> others_;
  Trail trail_{0.4, 240};
  bool driven_ = false;
  double speed_straight_ = 0, time_straight_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_hovercraft() { return std::make_unique<Hovercraft>(); }

}  // namespace carom::host::demo
