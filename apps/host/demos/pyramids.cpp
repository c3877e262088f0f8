// Twenty pyramids of 55 cubes: a stack stands still, and shows at once when a solver does not.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

class Pyramids final : public Repeatable<Pyramids, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "pyramids";
    d.title = "Twenty pyramids";
    d.summary = "1 100 cubes stacked in twenty pyramids stand without creeping. Throw balls at them.";
    d.group = "Rigid bodies";
    d.chapter = "14";
    d.text =
        "Each pyramid stands on friction and on the balance of its contact forces alone. A solver that is not quite "
        "right lets them creep apart or rattle; here the plot shows the farthest that any cube has moved from where "
        "it was put.\n\n"
        "Islands that have come to rest fall asleep and cost nothing until something touches them: throw a ball "
        "(Space) and watch who wakes.";
    d.duration = 5;
    d.camera = {{26, 15, 22}, {0, 2.5, -2}};
    d.ground = 0;
    d.parameters = {
        {"pyramids", "Pyramids", "", "", "", 1, 20, 1, 20, false},
        {"base", "Cubes in the lowest row", "", "", "", 2, 12, 1, 10, false},
        {"friction", "Friction", "", "", "Coulomb's μ", 0.1, 1.2, 0, 0.6, false},
        {"ball_mass", "Mass of a thrown ball", "kg", "kg", "a cube has 1000 kg", 100, 20000, 100, 4000, true},
        {"ball_speed", "Speed of a thrown ball", "m/s", "m/s", "", 5, 100, 1, 35, true},
    };
    d.plots = {{"Drift", {"time", "s"}, {"farthest displacement", "mm"}, {{"any cube"}}},
               {"Awake bodies", {"time", "s"}, {"bodies", ""}, {{"awake"}}}};
    d.inputs = {{"throw", "Throw a ball", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    rigid::Material material;
    material.friction = stage.valuef("friction");
    stage.floor(0, material);
    const int pyramids = stage.count("pyramids"), base = stage.count("base");
    constexpr std::uint32_t shades[] = {blue, orange, green, gold, teal, violet};
    rigid::ShapeDef<rigid::Dim3> shape;
    shape.material = material;
    for (int k = 0; k < pyramids; ++k) {
      for (int i = 0; i < base; ++i) {
        for (int j = 0; j < base - i; ++j) {
          rigid::BodyDef<rigid::Dim3> body;
          body.name = "cube";
          body.position = {-0.5 * (base - 1) + 0.5 * i + j, 0.5 + i, 3.0 * (k - 0.5 * (pyramids - 1))};
          cubes_.push_back(stage.add(body, geometry::Box{}, shape, shades[k % 6]));
          start_.push_back(body.position);
        }
      }
    }
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("throw") == 0) return;
    if (balls_.size() >= 12) {
      stage.remove(balls_.front());
      balls_.erase(balls_.begin());
    }
    const float radius = 0.9f;
    rigid::BodyDef<rigid::Dim3> ball;
    ball.name = "ball";
    ball.position = {0.6 * (int(balls_.size() + thrown_) % 5 - 2), 3.5, 3.0 * stage.count("pyramids") / 2 + 8};
    ball.linear_velocity = {0, 2, -stage.valuef("ball_speed")};
    ball.bullet = true;
    rigid::ShapeDef<rigid::Dim3> shape;
    shape.density = stage.valuef("ball_mass") / (4.18879f * radius * radius * radius);
    balls_.push_back(stage.add(ball, geometry::Sphere{radius}, shape, red));
    ++thrown_;
  }

  void after_step(Stage3& stage) override {
    // Every fourth step is often enough to draw, and cheap.
    if (stage.world().step_count() % 4 != 0) return;
    drift_ = 0;
    for (std::size_t i = 0; i < cubes_.size(); ++i)
      drift_ = max(drift_, distance(stage.at(cubes_[i]).pose.position, start_[i]));
    const double t = stage.world().time();
    stage.sample(0, 0, t, 1e3 * drift_);
    stage.sample(1, 0, t, stage.world().counters().awake_bodies);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"farthest displacement of a cube", "m", "a stack of cubes at rest stays (ch. 14: drift < 1 cm)",
                   drift_, 0, 0.01});
    out.push_back({"bodies awake", "", "everything rests", double(stage.world().counters().awake_bodies), 0, 0});
  }

 private:
  std::vector<rigid::BodyId> cubes_, balls_;
  std::vector<Vec3d> start_;
  int thrown_ = 0;
  double drift_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_pyramids() { return std::make_unique<Pyramids>(); }

}  // namespace carom::host::demo
