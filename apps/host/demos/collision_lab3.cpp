// A ball and a cube thrown at a floor: friction turns speed into spin (chapter 5.4).
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class CollisionLab3 final : public Repeatable<CollisionLab3, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "collision-lab-3d";
    d.title = "Collision lab, 3D";
    d.summary =
        "A ball and a cube hit the floor at an angle: watch speed become spin, and a row of balls pass a blow on.";
    d.group = "Collisions";
    d.chapter = "5";
    d.text =
        "Friction in an impact is an impulse too. It stops the sliding of the contact point if it can, and is never "
        "more than μ times the normal impulse.\n\n"
        "  J_n = (1 + e) m v_n      J_t = min(μ J_n, 2/7 m v_t)  for a solid ball\n\n"
        "  v_t' = v_t − J_t/m      ω' = J_t r / I\n\n"
        "A ball thrown with (10, −5) m/s at e = 0.8 and μ = 0.3 keeps sliding: it leaves with 7.3 m/s along the floor "
        "and a spin "
        "of 6.75 m/s over its radius. More friction than 0.317 and it rolls off instead. The cube lands on an edge "
        "and shows the same law with a longer arm. They start over every three and a half seconds.";
    d.dt = 1.0 / 240;
    d.duration = 3;
    d.camera = {{4.6, 3.4, 10.5}, {4.2, 0.7, 0}};
    d.ground = 0;
    d.parameters = {
        {"restitution", "Restitution e", "", "", "0: stays down, 1: as high as it fell", 0, 1, 0, 0.8, false},
        {"friction", "Friction μ", "", "", "of ball and cube on the floor", 0, 1.5, 0, 0.3, false},
        {"speed", "Speed along the floor", "m/s", "m/s", "of the ball; the cube has half of it", 0, 20, 0, 10, false},
        {"fall", "Speed toward the floor", "m/s", "m/s", "at the moment of the impact", 1, 15, 0, 5, false},
        {"spin", "Back spin before", "rad/s", "rad/s", "positive: against rolling", -100, 100, 0, 0, false},
        {"gravity", "Gravity", "m/s^2", "m/s²", "0: one impact, then straight on", 0, 20, 0, 9.80665, false},
    };
    d.plots = {{"Ball",
                {"time since the throw", "s"},
                {"speed", "m/s"},
                {{"along the floor"}, {"spin × radius"}, {"of the contact point"}}},
               {"Energy of the ball",
                {"time since the throw", "s"},
                {"energy", "J"},
                {{"translation"}, {"rotation"}, {"height"}, {"all"}}},
               {"Momentum of the ball",
                {"time since the throw", "s"},
                {"momentum", "kg·m/s"},
                {{"along the floor"}, {"upward"}}}};
    d.inputs = {{"again", "Throw again", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {0, -stage.valuef("gravity"), 0};
    world.restitution_threshold = 0.2f;
    stage.start(world);
    rigid::Material material;
    material.friction = stage.valuef("friction");
    material.restitution = stage.valuef("restitution");
    stage.floor(0, material);
    rigid::ShapeDef<Dim3> shape;
    shape.material = material;
    rigid::BodyDef<Dim3> body;
    body.bullet = true;
    body.name = "ball";
    ball_ = stage.add(body, geometry::Sphere{radius_}, shape, orange);
    body.name = "cube";
    cube_ = stage.add(body, geometry::Box{{0.19f, 0.19f, 0.19f}}, shape, blue);
    // Newton's row: equal balls, nearly touching; what hits one end leaves at the other.
    rigid::ShapeDef<Dim3> steel_shape;
    steel_shape.density = 7850;
    steel_shape.material = {0.0f, 1.0f};
    for (int i = 0; i < 5; ++i) {
      body.name = "row";
      body.position = {-0.5 + 0.43 * i, 0.2 + 1e-4, -2.2};
      row_.push_back(stage.add(body, geometry::Sphere{0.2f}, steel_shape, i == 0 ? red : steel));
    }
    launch(stage);
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("again") > 0 || stage.world().time() - launched_ > 3.5) launch(stage);
    before_ = stage.at(ball_);
  }

  void after_step(Stage3& stage) override {
    const auto ball = stage.at(ball_);
    const double t = stage.world().time() - launched_;
    const Vec3d v(ball.linear_velocity), w(ball.angular_velocity);
    const double i = 0.4 * ball.mass * radius_ * radius_;
    const double g = stage.value("gravity");
    if (stage.world().step_count() % 2 == 0) {
      stage.sample(0, 0, t, v.x);
      stage.sample(0, 1, t, -w.z * radius_);
      stage.sample(0, 2, t, v.x + w.z * radius_);
      const double translation = 0.5 * ball.mass * length_squared(v), rotation = 0.5 * i * length_squared(w);
      const double height = ball.mass * g * (ball.pose.position.y - radius_);
      stage.sample(1, 0, t, translation);
      stage.sample(1, 1, t, rotation);
      stage.sample(1, 2, t, height);
      stage.sample(1, 3, t, translation + rotation + height);
      stage.sample(2, 0, t, ball.mass * v.x);
      stage.sample(2, 1, t, ball.mass * v.y);
    }
    trail_.add(ball.pose.position);
    trail_.draw(stage, pen(orange, 0xa0));
    const Vec3d at = ball.center_of_mass;
    stage.line(at, at + 0.12 * v, pen(0xffffff));
    if (!bounced_ && before_.linear_velocity.y < 0 && v.y > 0) {
      bounced_ = true;
      along_ = v.x;
      spin_ = -w.z * radius_;
      stage.say(
          format("first bounce: %.3f m/s along the floor, spin × radius %.3f m/s, up at %.3f m/s", along_, spin_, v.y));
    }
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back(
        {"speed along the floor after the bounce", "m/s", "ch. 5.4: e = .8, μ = .3, v = (10, −5)", along_, 7.3, 0.05});
    out.push_back({"spin × radius after the bounce", "m/s", "ch. 5.4: 316.16 rad/s at r = 21.35 mm", spin_,
                   316.16 * 0.02135, 0.1});
    const auto last = stage.at(row_.back());
    out.push_back({"share of the speed that leaves the row", "", "Newton's cradle: equal masses, e = 1",
                   last.linear_velocity.x / 3.0, 1, 0.02});
  }

 private:
  static constexpr float radius_ = 0.2135f;  // ten golf balls wide: the same speeds, a tenth of the spin

  void launch(Stage3& stage) {
    const double lead = 0.12;  // s until they touch
    const double g = stage.value("gravity"), v = stage.value("speed"), fall = stage.value("fall") - g * lead;
    const double up = lead * fall + 0.5 * g * lead * lead;
    throw_one(stage, ball_, {-v * lead, radius_ + up, 0}, {}, {float(v), -float(fall), 0});
    const Quatf edge{0.9238795f, 0, 0, 0.3826834f};  // 45° about z: lands on an edge
    throw_one(stage, cube_, {-v * lead, 0.30 + up, 1.3}, edge, {float(0.5 * v), -float(fall), 0});
    for (std::size_t i = 0; i < row_.size(); ++i)
      throw_one(stage, row_[i], {(i == 0 ? -1.5 : -0.5 + 0.43 * double(i)), 0.2001, -2.2}, {},
                {i == 0 ? 3.0f : 0.0f, 0, 0}, false);
    launched_ = stage.world().time();
    bounced_ = false;
    trail_.clear();
  }
  void throw_one(Stage3& stage, rigid::BodyId body, Vec3d position, Quatf rotation, Vec3f velocity, bool spin = true) {
    stage.check(stage.world().set_pose(body, position, rotation));
    stage.check(stage.world().set_velocity(body, velocity, {0, 0, spin ? stage.valuef("spin") : 0.0f}));
    stage.check(stage.world().set_awake(body, true));
  }

  rigid::BodyId ball_, cube_;
  std::vector<rigid::BodyId> row_;
  rigid::BodyState<Dim3> before_;
  Trail trail_{0.05, 300};
  double along_ = 0, spin_ = 0, launched_ = 0;
  bool bounced_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_collision_lab3() { return std::make_unique<CollisionLab3>(); }

}  // namespace carom::host::demo
