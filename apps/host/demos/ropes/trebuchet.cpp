// A trebuchet with a fixed counterweight and a sling of rope.
#include "apps/host/demos/ropes/draw.h"
#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {
namespace {

using particles::RopeSet;
using rigid::BodyId;
using rigid::Dim3;

class Trebuchet final : public Repeatable<Trebuchet, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "trebuchet";
    d.title = "A trebuchet";
    d.summary = "A falling weight swings an arm, the arm a sling, the sling a stone: how much of the energy flies off?";
    d.group = "Ropes and cloth";
    d.chapter = "13";
    d.text =
        "The counterweight M falls by h. Had the stone m all of that energy, it would leave with v² = 2 M g h/m and, "
        "thrown at 45°, come down at\n\n"
        "  R = 2 (M/m) h\n\n"
        "Arm and weight keep a part of it. The sling, a rope, makes the way of the stone longer than the arm, and lets "
        "go where its velocity points up at the angle that is set.";
    d.duration = 9;
    d.camera = {.position = {9, 6, 22}, .target = {9, 4, 0}, .field_of_view = 0.8, .width = 33};
    d.ground = 0;
    d.parameters = {
        {"weight", "Counterweight", "kg", "kg", "", 100, 1500, 0, 500, false},
        {"stone", "Stone", "kg", "kg", "", 1, 30, 0, 8, false},
        {"sling", "Length of the sling", "m", "m", "", 1.5, 3.4, 0, 2.8, false},
        {"angle", "Angle of release", "rad", "°", "of the stone's velocity above the horizon", 0.35, 1.2, 0, 0.72,
         false},
    };
    d.plots = {
        {"Flight", {"way", "m"}, {"height", "m"}, {{"stone"}, {"parabola from the release", Series::Style::points}}},
        {"Energy", {"time", "s"}, {"energy", "kJ"}, {{"stone"}, {"given by the weight"}}},
        {"Tension of the sling", {"time", "s"}, {"force", "kN"}, {{"sling"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    rigid::BodyDef<Dim3> def;
    const double alpha = 0.72;
    def.position = {0, 3, 0};
    def.rotation = {float(math::cos(alpha / 2)), 0, 0, float(math::sin(alpha / 2))};
    def.allow_sleep = false;
    def.name = "arm";
    arm_ = stage.add(def, {}, sand);
    rigid::ShapeDef<Dim3> beam;
    beam.density = 500;
    beam.filter.mask = 0;
    beam.local.p = {-1.5f, 0, 0};
    stage.keep(stage.world().add_shape(arm_, geometry::Box{{2.5f, 0.07f, 0.07f}}, beam));
    rigid::ShapeDef<Dim3> weight = beam;
    weight.local.p = {1, 0, 0};
    weight.density = float(stage.value("weight") / (0.8 * 0.8 * 0.8));
    stage.keep(stage.world().add_shape(arm_, geometry::Box{{0.4f, 0.4f, 0.4f}}, weight));
    stage.redraw(arm_);
    rigid::HingeJointDef<Dim3> axle;
    axle.body_b = arm_;
    axle.frame_a.p = {0, 3, 0};
    stage.keep(stage.world().create_joint(axle));
    add_frame(stage);

    const Vec3d tip = world_point(stage.at(arm_).pose, math::Vec3f{-4, 0, 0});
    const double radius = 0.2, sling = stage.value("sling");
    def = {};
    def.name = "stone";
    def.allow_sleep = false;
    def.position = {tip.x + math::sqrt(sling * sling - math::square(tip.y - radius)), radius, 0};
    rigid::ShapeDef<Dim3> stone;
    stone.density = float(stage.value("stone") / (4.0 / 3 * math::pi * radius * radius * radius));
    stone.material.friction = 0.2f;
    stone.material.rolling_resistance = 0.05f;
    stone_ = stage.add(def, geometry::Sphere{float(radius)}, stone, steel);
    const Vec3d points[] = {tip, def.position};
    stage.keep(
        ropes_.add({.material = {.mass_per_length = 0.15, .radius = 0.02, .axial_stiffness = 1e6, .axial_damping = 1e3},
                    .points = points,
                    .segments = 14,
                    .collide = false}));
    stage.check(ropes_.attach(0, {.node = 0, .body = arm_, .point = {-4, 0, 0}}, stage.world()));
    stage.check(ropes_.attach(0, {.node = -1, .body = stone_}, stage.world()));
    stage.check(ropes_.set_substeps(16));
    height_ = weight_height(stage);
    lowest_ = height_;
  }

  void before_step(Stage3& stage) override { stage.check(ropes_.step(stage.world(), stage.declaration().dt)); }

  void after_step(Stage3& stage) override {
    draw_rope(stage, ropes_, 0, 0x6b5537ff);
    const auto stone = stage.at(stone_);
    const Vec3d v(stone.linear_velocity);
    const double t = stage.world().time(), mass = stage.value("stone");
    trail_.add(stone.center_of_mass);
    trail_.draw(stage, 0xd1495bff);
    const double energy = 0.5 * mass * length_squared(v) + mass * 9.80665 * (stone.center_of_mass.y - 0.2);
    if (!released_) {
      lowest_ = min(lowest_, weight_height(stage));
      stretch_ = max(stretch_, ropes_.length(0) / ropes_.rest_length(0) - 1);
    }
    if (!released_) stage.sample(2, 0, t, 1e-3 * ropes_.peak_tension(0));
    stage.sample(1, 0, t, 1e-3 * energy);
    if (range_ == 0) stage.sample(0, 0, stone.center_of_mass.x, stone.center_of_mass.y);
    stage.sample(1, 1, t, 1e-3 * stage.value("weight") * 9.80665 * (height_ - lowest_));
    // The sling opens where the stone flies forward and no steeper than was set.
    if (!released_ && v.x > 3 && stone.center_of_mass.y > 3 && v.y < v.x * math::tan(stage.value("angle"))) {
      released_ = true;
      stage.check(ropes_.detach(0, -1));
      start_ = stone.center_of_mass;
      speed_ = v;
      const double g = 9.80665, last = (speed_.y + math::sqrt(speed_.y * speed_.y + 2 * g * start_.y)) / g;
      for (int i = 0; i <= 20; ++i) {
        const double after = i * last / 20;
        stage.sample(0, 1, start_.x + speed_.x * after, start_.y + after * (speed_.y - 0.5 * g * after));
      }
      stage.say(format("away with %.1f m/s at %.0f°", length(v), math::degrees(math::atan2(v.y, v.x))));
    }
    if (released_ && range_ == 0 && stone.center_of_mass.y < 0.25) {
      range_ = stone.center_of_mass.x;
      const double bound = 2 * stage.value("weight") / mass * (height_ - lowest_);
      share_ = range_ / bound;
      stage.say(format("%.0f m, %.0f %% of what the weight's energy could do", range_, 100 * share_));
    }
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const double g = 9.80665, h = start_.y - 0.25;
    const double vacuum = start_.x + speed_.x * (speed_.y + math::sqrt(speed_.y * speed_.y + 2 * g * h)) / g;
    out.push_back({"range", "m", "parabola from the release", range_, vacuum, 0.02 * vacuum});
    out.push_back({"share of 2 (M/m) h", "", "below one; trebuchets of this kind reach a third to two thirds", share_,
                   0.5, 0.35});
    out.push_back({"stretch of the sling, most", "", "it hardly gives way", stretch_, 0, 0.02});
  }
  std::uint64_t state_hash(std::uint64_t world) const override { return world ^ ropes_.state_hash(); }

 private:
  /// Two legs on each side carry the axle; nothing touches them.
  void add_frame(Stage3& stage) {
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    def.name = "frame";
    const BodyId frame = stage.add(def, {}, 0x7a5c3a);
    const auto bar = [&](math::Vec3f middle, math::Vec3f half, double turn) {
      rigid::ShapeDef<Dim3> shape;
      shape.filter.mask = 0;
      shape.local = {middle, {float(math::cos(turn / 2)), 0, 0, float(math::sin(turn / 2))}};
      stage.keep(stage.world().add_shape(frame, geometry::Box{half}, shape));
    };
    const double lean = math::atan2(1.3, 3);
    for (const float z : {-0.65f, 0.65f}) {
      for (const float side : {-1.0f, 1.0f}) bar({0.65f * side, 1.5f, z}, {0.08f, 1.63f, 0.08f}, double(side) * lean);
      bar({0, 0.1f, z}, {1.7f, 0.1f, 0.1f}, 0);
    }
    bar({0, 3, 0}, {0.06f, 0.06f, 0.75f}, 0);
    stage.redraw(frame);
  }
  double weight_height(Stage3& stage) { return world_point(stage.at(arm_).pose, math::Vec3f{1, 0, 0}).y; }

  RopeSet ropes_;
  BodyId arm_{}, stone_{};
  Trail trail_{0.3};
  Vec3d start_{}, speed_{};
  double height_ = 0, lowest_ = 0, range_ = 0, share_ = 0, stretch_ = 0;
  bool released_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_trebuchet() { return std::make_unique<Trebuchet>(); }

}  // namespace carom::host::demo
