// A brick wall and a ball on a chain: what a rigid-body engine is for.
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

class WreckingBall final : public Repeatable<WreckingBall, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "wrecking-ball";
    d.title = "Wall and wrecking ball";
    d.summary = "A ball on a chain swings into a brick wall. Grab the ball, the chain or any brick.";
    d.group = "Rigid bodies";
    d.chapter = "13, 14";
    d.text =
        "The ball is let go at an angle, swings down on a chain of ball joints and strikes the wall with the speed "
        "that its fall gives it. Nothing is scripted: bricks are held by friction and weight alone.\n\n"
        "  v = √(2 g L (1 − cos θ))\n\n"
        "The chain carries a load many times its own mass; a rope constraint from the beam to the ball keeps it from "
        "stretching. The plot shows how potential energy turns into motion and how the wall eats it up.";
    d.duration = 8;
    d.camera = {{11.5, 5.2, 13.5}, {-0.4, 3.4, 0.8}};
    d.ground = 0;
    d.parameters = {
        {"rows", "Rows of bricks", "", "", "height of the wall in bricks of 0.3 m", 2, 16, 1, 10, false},
        {"columns", "Bricks in a row", "", "", "length of the wall in bricks of 0.6 m", 3, 20, 1, 10, false},
        {"ball_mass", "Mass of the ball", "kg", "kg", "of a steel ball; its radius follows", 50, 5000, 10, 1200, false},
        {"angle", "Angle of release", "rad", "deg", "of the chain from the vertical", radians(20.0), 1.65, 0, 1.25,
         false},
        {"brick_mass", "Mass of a brick", "kg", "kg", "", 2, 100, 1, 20, false},
        {"friction", "Friction of bricks", "", "", "Coulomb's μ between bricks and on the ground", 0.1, 1.2, 0, 0.6,
         false},
    };
    d.plots = {{"Energy", {"time", "s"}, {"energy", "kJ"}, {{"kinetic"}, {"potential"}, {"total"}}},
               {"Speed of the ball", {"time", "s"}, {"speed", "m/s"}, {{"ball"}, {"at the bottom, in vacuum"}}}};
    d.inputs = {{"again", "Pull the ball back", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    rigid::Material ground;
    ground.friction = 0.8f;
    stage.floor(0, ground);
    wall(stage);
    crane(stage);
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("again") == 0) return;
    // The whole chain goes back to where it began, straight and at rest.
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      stage.check(stage.world().set_pose(chain_[i], start_[i].position, start_[i].rotation));
      stage.check(stage.world().set_velocity(chain_[i], {}, {}));
      stage.check(stage.world().set_awake(chain_[i], true));
    }
  }

  void after_step(Stage3& stage) override {
    const rigid::Totals<rigid::Dim3> totals = stage.world().totals();
    const double t = stage.world().time();
    stage.sample(0, 0, t, totals.kinetic_energy / 1e3);
    stage.sample(0, 1, t, totals.potential_energy / 1e3);
    stage.sample(0, 2, t, (totals.kinetic_energy + totals.potential_energy) / 1e3);
    const double speed = length(stage.at(chain_.back()).linear_velocity);
    fastest_ = max(fastest_, speed);
    stage.sample(1, 0, t, speed);
    stage.sample(1, 1, t, bottom_speed_);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"fastest speed of the ball", "m/s", "energy of a pendulum of a ball and a uniform chain", fastest_,
                   bottom_speed_, 0.03 * bottom_speed_});
    out.push_back(
        {"chain and rope, pulled apart", "m", "joints hold within 5 cm", stage.world().worst_joint_error(), 0, 0.05});
  }

 private:
  static constexpr double length_ = 6.0, pivot_height_ = 7.4;
  static constexpr int links_ = 10;

  void wall(Stage3& stage) {
    const int rows = stage.count("rows"), columns = stage.count("columns");
    const Vec3f half{0.3f, 0.15f, 0.15f};
    rigid::ShapeDef<rigid::Dim3> shape;
    shape.density = stage.valuef("brick_mass") / (8 * half.x * half.y * half.z);
    shape.material.friction = stage.valuef("friction");
    constexpr std::uint32_t clay[] = {0xb5533c, 0xc0614a, 0xa84a36, 0xbb6a4e};
    for (int row = 0; row < rows; ++row) {
      for (int i = 0; i < columns; ++i) {
        rigid::BodyDef<rigid::Dim3> body;
        body.name = "brick";
        const double shift = row % 2 == 0 ? 0.0 : 0.3;
        body.position = {0.6 * (i - 0.5 * (columns - 1)) + shift - 0.15, 0.15 + 0.3 * row, -0.75};
        stage.add(body, geometry::Box{half}, shape, clay[(row * 7 + i * 3) % 4]);
      }
    }
  }

  void crane(Stage3& stage) {
    rigid::BodyDef<rigid::Dim3> beam;
    beam.type = rigid::BodyType::fixed;
    beam.name = "crane";
    beam.position = {0, pivot_height_ + 0.15, 0};
    const rigid::BodyId anchor = stage.add(beam,
                                           {{geometry::Box{{3.6f, 0.15f, 0.15f}}, {}},
                                            {geometry::Box{{0.15f, 3.7f, 0.15f}}, {{{3.6f, -3.7f, 0}}}},
                                            {geometry::Box{{0.15f, 3.7f, 0.15f}}, {{{-3.6f, -3.7f, 0}}}}},
                                           gold);
    const double angle = stage.value("angle");
    const double s = sin(angle), c = cos(angle);
    // Links lie along y of their bodies; turned about x so that the chain runs toward +z.
    const Quatf tilt{float(cos(0.5 * angle)), -float(sin(0.5 * angle)), 0, 0};
    const Vec3d along{0, -c, s};
    const Vec3d pivot{0, pivot_height_, 0};
    const float link_half = float(0.5 * length_ / links_);
    rigid::BodyId previous = anchor;
    Vec3f previous_point{0, -0.15f, 0};
    for (int i = 0; i < links_; ++i) {
      rigid::BodyDef<rigid::Dim3> body;
      body.name = "link";
      body.position = pivot + along * (link_half * (2 * i + 1));
      body.rotation = tilt;
      body.angular_damping = 0.2f;
      rigid::ShapeDef<rigid::Dim3> shape;
      shape.density = 7850;
      shape.filter.group = -1;
      const rigid::BodyId link = stage.add(body, geometry::Capsule3{link_half - 0.06f, 0.04f}, shape, dark);
      remember(body, link);
      join(stage, previous, previous_point, link, {0, link_half, 0});
      previous = link;
      previous_point = {0, -link_half, 0};
    }
    const double mass = stage.value("ball_mass");
    const float radius = float(cbrt(3 * mass / (4 * pi * 7850)));
    rigid::BodyDef<rigid::Dim3> ball;
    ball.name = "ball";
    ball.position = pivot + along * length_;
    ball.rotation = tilt;
    ball.bullet = true;
    rigid::ShapeDef<rigid::Dim3> shape;
    shape.density = float(mass / (4.0 / 3 * pi * double(radius) * radius * radius));
    shape.filter.group = -1;
    const rigid::BodyId body = stage.add(ball, geometry::Sphere{radius}, shape, steel);
    remember(ball, body);
    join(stage, previous, previous_point, body, {});
    rigid::DistanceJointDef<rigid::Dim3> rope;
    rope.body_a = anchor;
    rope.body_b = body;
    rope.frame_a.p = {0, -0.15f, 0};
    rope.length = float(length_);
    rope.rope = true;
    rope.limit = {true, 0, float(length_)};
    stage.keep(stage.world().create_joint(rope));
    // Energy of the straight pendulum: ball at L, chain of linear density λ along it.
    const double chain = links_ * 7850 * pi * 0.04 * 0.04 * (2 * (link_half - 0.06) + 4.0 / 3 * 0.04);
    const double fall = 9.80665 * length_ * (1 - c);
    bottom_speed_ =
        sqrt(2 * fall * (mass + chain / 2) / (mass + chain / 3 + 0.4 * mass * radius * radius / (length_ * length_)));
  }

  void join(Stage3& stage, rigid::BodyId a, Vec3f point_a, rigid::BodyId b, Vec3f point_b) {
    rigid::BallJointDef<rigid::Dim3> joint;
    joint.body_a = a;
    joint.body_b = b;
    joint.frame_a.p = point_a;
    joint.frame_b.p = point_b;
    stage.keep(stage.world().create_joint(joint));
  }

  void remember(const rigid::BodyDef<rigid::Dim3>& definition, rigid::BodyId body) {
    chain_.push_back(body);
    start_.push_back({definition.position, definition.rotation});
  }

  std::vector<rigid::BodyId> chain_;  ///< the links, then the ball
  std::vector<Pose3> start_;
  double bottom_speed_ = 0, fastest_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_wrecking_ball() { return std::make_unique<WreckingBall>(); }

}  // namespace carom::host::demo
