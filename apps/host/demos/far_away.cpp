// The same stack at the origin and a thousand million metres away: positions are double, always.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;
using World = rigid::World<Dim3>;

class FarAway final : public Repeatable<FarAway, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "far-away";
    d.title = "Far away from the origin";
    d.summary = "A ball and a stack at 10⁹ m behave as they do at the origin; both are simulated and compared.";
    d.group = "Large worlds";
    d.text =
        "In single precision the places where a body can be lie 64 m apart at 10⁹ m from the origin. Carom keeps "
        "positions in double precision and computes a step in local frames: contacts in the frame of the first body, "
        "motion as the small way since the step began. Nothing about it is an option.\n\n"
        "The stack that one sees stands at the chosen place; a second one, not shown, stands at the origin. The plot "
        "shows how far they are apart in what they do.";
    d.duration = 6;
    d.camera = {{5, 4, 10}, {0, 2, 0}};
    d.parameters = {
        {"place", "Distance from the origin", "m", "km", "along each axis of the ground", 0, 1e9, 0, 1e9, false},
        {"boxes", "Boxes", "", "", "in the stack", 1, 12, 1, 6, false},
    };
    d.plots = {{"Difference to the one at the origin", {"time", "s"}, {"farthest box", "µm"}, {{"stack"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    const double place = stage.value("place");
    offset_ = {place, 0, place};
    near_ = World(rigid::WorldDef<Dim3>{});
    const int boxes = stage.count("boxes");
    far_bodies_ = fill(stage, stage.world(), offset_, boxes);
    near_bodies_ = fill(stage, near_, {}, boxes);
    stage.adopt_all();
    constexpr std::uint32_t colors[] = {blue, orange, green, gold, violet, teal};
    for (std::size_t i = 0; i < far_bodies_.size(); ++i)
      stage.set_color(far_bodies_[i], i + 1 == far_bodies_.size() ? red : colors[i % 6]);
    stage.set_camera({offset_ + Vec3d{5, 4, 10}, offset_ + Vec3d{0, 2, 0}, 0.75});
  }

  core::Status step(Stage3& stage) override {
    const float dt = float(stage.declaration().dt);
    if (const core::Status status = near_.step(dt); !status.ok()) return status;
    return stage.world().step(dt);
  }

  void after_step(Stage3& stage) override {
    double farthest = 0;
    for (std::size_t i = 0; i < far_bodies_.size(); ++i) {
      const Vec3d here = stage.at(far_bodies_[i]).pose.position - offset_;
      farthest = max(farthest, distance(here, stage.keep(near_.state(near_bodies_[i])).pose.position));
    }
    worst_ = max(worst_, farthest);
    stage.sample(0, 0, stage.world().time(), 1e6 * farthest);
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return world ^ near_.state_hash(); }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back(
        {"farthest apart in what they do", "m", "double positions: 1.2e-7 m apart at 1e9 m", worst_, 0, 5e-4});
  }

 private:
  static std::vector<BodyId> fill(Stage3& stage, World& world, Vec3d at, int boxes) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = "ground";
    body.position = at - Vec3d{0, 0.5, 0};
    const BodyId ground = stage.keep(world.create_body(body));
    stage.keep(world.add_shape(ground, geometry::Box{{12, 0.5f, 12}}));
    std::vector<BodyId> out;
    body.type = rigid::BodyType::dynamic;
    body.name = "box";
    for (int i = 0; i < boxes; ++i) {
      body.position = at + Vec3d{0, 0.3 + 0.6 * i, 0};
      out.push_back(stage.keep(world.create_body(body)));
      stage.keep(world.add_shape(out.back(), geometry::Box{{0.3f, 0.3f, 0.3f}}));
    }
    // A light ball that rolls against the foot of the stack.
    body.name = "ball";
    body.position = at + Vec3d{0, 0.25, 5};
    body.linear_velocity = {0, 0, -2};
    out.push_back(stage.keep(world.create_body(body)));
    rigid::ShapeDef<Dim3> light;
    light.density = 100;
    stage.keep(world.add_shape(out.back(), geometry::Sphere{0.25f}, light));
    return out;
  }

  World near_;
  std::vector<BodyId> far_bodies_, near_bodies_;
  Vec3d offset_{};
  double worst_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_far_away() { return std::make_unique<FarAway>(); }

}  // namespace carom::host::demo
