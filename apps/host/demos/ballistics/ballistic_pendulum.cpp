// A bullet into a block on a rod: its speed from how high the block swings (chapter 18.5).
#include "apps/host/demos/ballistics/range.h"
#include "carom/ballistics/hits.h"
#include "carom/ballistics/recoil.h"

namespace carom::host::demo {
namespace {

using ballistics::BatchHits;
using rigid::Dim3;

class BallisticPendulum final : public Repeatable<BallisticPendulum, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "ballistic-pendulum";
    d.title = "Ballistic pendulum";
    d.summary = "A bullet stays in a hanging block. How high the block swings tells how fast the bullet was.";
    d.group = "Ballistics";
    d.chapter = "18.5";
    d.text =
        "The bullet gives the block its momentum, and most of its energy becomes heat:\n\n"
        "  m v = (m + M) V      V²/2g = h      v = (m + M)/m √(2 g h)\n\n"
        "10 g at 400 m/s into 2 kg make V = 1.990 m/s. A body hit by a bullet does not fly back: what it gets is what "
        "the "
        "gun's butt gave the shooter. The bullet is a projectile of a batch, swept against the bodies of the world; "
        "the "
        "block hangs on a joint.";
    d.dt = 1.0 / 120;
    d.duration = 6;
    d.camera = {{-1.2, 1.3, 4.6}, {-0.4, 1.05, 0}};
    d.ground = 0;
    d.parameters = {
        {"bullet", "Mass of the bullet", "kg", "g", "", 0.0005, 0.05, 0, 0.01, true},
        {"speed", "Speed of the bullet", "m/s", "m/s", "", 50, 1200, 5, 400, true},
        {"block", "Mass of the block", "kg", "kg", "", 0.2, 20, 0.1, 2, false},
        {"rod", "Length of the rod", "m", "m", "", 0.3, 1.8, 0.05, 1.2, false},
    };
    d.plots = {{"Height of the block",
                {"time since the shot", "s"},
                {"height", "m"},
                {{"block"}, {"V²/2g", Series::Style::points}}},
               {"Energy", {"time since the shot", "s"}, {"energy", "J"}, {{"block: kinetic"}, {"block: potential"}}}};
    d.inputs = {{"fire", "Fire", {"Space", "Enter"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    const double rod = stage.value("rod"), top = 2.2;
    rest_ = {0, top - rod, 0};
    rigid::BodyDef<Dim3> frame;
    frame.type = rigid::BodyType::fixed;
    frame.name = "frame";
    frame.position = {0, top + 0.05, 0};
    rigid::ShapeDef<Dim3> beam, post_far;
    beam.local.p = {0, 0, -0.22f};
    post_far.local.p = {0, -float(top) / 2, -0.5f};
    const float half = float(top) / 2;
    stage.add(frame, {{geometry::Box{{0.06f, 0.05f, 0.33f}}, beam}, {geometry::Box{{0.05f, half, 0.05f}}, post_far}},
              dark);
    rigid::BodyDef<Dim3> body;
    body.name = "block";
    body.position = rest_;
    rigid::ShapeDef<Dim3> wood;
    const float edge = 0.12f;
    wood.density = stage.valuef("block") / (8 * edge * edge * edge);
    block_ = stage.add(body, geometry::Box{{edge, edge, edge}}, wood, sand);
    rigid::DistanceJointDef<Dim3> joint;
    joint.body_b = block_;
    joint.frame_a.p = {0, float(top), 0};
    joint.length = float(rod);
    (void)stage.keep(stage.world().create_joint(joint));
    gun_ = add_marker(stage, "gun", geometry::Cylinder{0.35f, 0.02f}, {-2.6, rest_.y, 0}, steel);
    stage.check(stage.world().set_pose(gun_, {-2.6, rest_.y, 0}, turn_of_y({1, 0, 0})));
    bullet_ = add_marker(stage, "bullet", geometry::Sphere{0.02f}, {-2.3, rest_.y, 0}, gold);
    const ballistics::Layer wood_layer{.thickness = BatchHits<Dim3>::through, .medium = {2e8, 700}};
    stage.check(hits_.set_default(std::span(&wood_layer, 1)));
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("fire") > 0 || (shots_ == 0 && stage.world().time() >= 0.5)) {
      ++shots_;
      batch_.clear();
      const double m = stage.value("bullet");
      mass_ = m;
      speed_ = stage.value("speed");
      batch_.add({{-2.25, rest_.y, 0}, {speed_, 0, 0}}, {.area_per_mass = 0, .mass = m, .frontal_area = 5e-5});
      shot_time_ = stage.world().time();
      highest_ = 0;
      struck_ = false;
      const double v = ballistics::pendulum_speed(m, speed_, stage.value("block"));
      expected_ = v * v / (2 * g_);
      trail_.clear();
    }
  }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status s = stage.world().step(float(dt)); !s.ok()) return s;
    if (batch_.size() == 0) return {};
    batch_.step(dt);
    return hits_.collect(batch_, stage.world(), dt);
  }

  void after_step(Stage3& stage) override {
    const rigid::BodyState<Dim3> block = stage.at(block_);
    const double t = stage.world().time() - shot_time_, height = block.center_of_mass.y - rest_.y;
    for (const ballistics::BatchHit& hit : hits_.hits()) {
      if (struck_) break;
      struck_ = true;
      after_hit_ = length(Vec3d(block.linear_velocity));
      inside_ = Vec3f(hit.point - rest_) + Vec3f{0.03f, 0, 0};
      if (first_hit_ == 0) first_hit_ = after_hit_;
    }
    if (batch_.size() > 0) stage.check(stage.world().set_pose(bullet_, batch_.at(0).position, {}));
    if (struck_)
      stage.check(stage.world().set_pose(bullet_, block.pose.position + Vec3d(rotate(block.pose.rotation, inside_)),
                                         block.pose.rotation));
    if (shots_ == 0 || !struck_) return;
    highest_ = max(highest_, height);
    if (shots_ == 1) first_height_ = highest_;
    trail_.add(block.center_of_mass);
    trail_.draw(stage, pen(gold, 0xa0));
    stage.sample(0, 0, t, height);
    stage.sample(0, 1, t, expected_);
    stage.sample(1, 0, t, 0.5 * double(block.mass) * double(length_squared(block.linear_velocity)));
    stage.sample(1, 1, t, double(block.mass) * g_ * height);
    const double told = (mass_ + double(block.mass)) / mass_ * sqrt(2 * g_ * max(highest_, 0.0));
    stage.say(format("V = %.3f m/s, risen %.1f cm: the bullet had %.0f m/s (true: %.0f)", after_hit_, 100 * highest_,
                     told, speed_));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"speed of the block after the hit", "m/s", "ch. 18.5: m v/(m + M), 10 g at 400 m/s into 2 kg",
                   first_hit_, 1.99005, 2e-3});
    out.push_back({"height of the swing", "m", "V²/2g", first_height_, 1.99005 * 1.99005 / (2 * g_), 2e-3});
    out.push_back({"hits", "", "the bullet was swept along its way", struck_ ? 1.0 : 0.0, 1, 0});
  }

 private:
  static constexpr double g_ = 9.80665;
  ballistics::ProjectileBatch batch_{ballistics::DragCurve(0.3), {}};
  BatchHits<Dim3> hits_;
  rigid::BodyId block_, gun_, bullet_;
  Vec3d rest_{};
  Vec3f inside_{};
  Trail trail_{0.02, 200};
  double shot_time_ = 0, mass_ = 0.01, speed_ = 400, highest_ = 0, first_height_ = 0, expected_ = 0, after_hit_ = 0,
         first_hit_ = 0;
  int shots_ = 0;
  bool struck_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_ballistic_pendulum() { return std::make_unique<BallisticPendulum>(); }

}  // namespace carom::host::demo
