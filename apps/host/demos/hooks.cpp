// What a program says about single contacts: a filter, a modifier, and rules for pairs of materials.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class Hooks final : public Repeatable<Hooks, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "hooks";
    d.title = "Contact hooks and material pairs";
    d.summary = "A wall that only red balls pass, a floor whose friction falls with speed, rubber and steel on ice.";
    d.group = "Events";
    d.dimension = 2;
    d.text =
        "A contact filter is asked once when two shapes come near: here the wall lets red balls through. A contact "
        "modifier is asked in every step: on the middle floor friction is μ₁ above 2 m/s and μ₀ below (as of a brake "
        "that grips when it is slow). A rule for a pair of materials stands in place of the mixture: on the lower "
        "floor, "
        "of ice, rubber has 0.4 and steel 0.02.\n\n"
        "  slowing: a = μ g";
    d.dt = 1.0 / 120;
    d.duration = 4;
    d.camera.target = {0, 3.4, 0};
    d.camera.height = 10;
    d.camera.width = 17;
    d.parameters = {
        {"slow", "Friction μ₀ below 2 m/s", "", "", "", 0, 1, 0, 0.5, true},
        {"fast", "Friction μ₁ above 2 m/s", "", "", "", 0, 1, 0, 0.15, true},
    };
    d.plots = {{"Crates", {"time", "s"}, {"speed", "m/s"}, {{"middle floor"}, {"rubber"}, {"steel"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    const auto shelf = [&](double y, bool modify, std::uint32_t material, std::uint32_t color) {
      rigid::BodyDef<Dim2> body;
      body.type = rigid::BodyType::fixed;
      body.name = "floor";
      body.position = {0, y - 0.1};
      rigid::ShapeDef<Dim2> shape;
      shape.modify_contacts = modify;
      shape.material.user_id = material;
      stage.add(body, geometry::make_box2({8, 0.1f}), shape, color);
    };
    shelf(0, false, ice_, 0xa9d8ea);
    shelf(2.6, true, 0, steel);
    shelf(5.2, false, 0, sand);
    // The wall on the upper floor.
    rigid::BodyDef<Dim2> body;
    body.type = rigid::BodyType::fixed;
    body.name = "wall";
    body.position = {0, 6.2};
    stage.add(body, geometry::make_box2({0.1f, 1}), {.user_data = wall_}, dark);
    for (int i = 0; i < 6; ++i) {
      rigid::BodyDef<Dim2> ball;
      ball.name = "ball";
      ball.position = {-7.3 + 0.9 * i, 5.5};
      ball.linear_velocity = {4, 0};
      ball.angular_velocity = -4 / 0.3f;
      balls_.push_back(
          stage.add(ball, geometry::Circle{0.3f}, {.user_data = i % 2 == 1 ? red_ : 0}, i % 2 == 1 ? red : blue));
    }
    stage.world().set_contact_filter([this](rigid::ShapeId a, rigid::ShapeId b) {
      const auto is = [this](rigid::ShapeId s, std::uint64_t what) { return data_of(s) == what; };
      return !((is(a, wall_) && is(b, red_)) || (is(b, wall_) && is(a, red_)));
    });
    for (const auto& actor : stage.actors()) {
      std::vector<rigid::ShapeId> shapes;
      stage.world().shapes(actor.body, shapes);
      for (const rigid::ShapeId s : shapes)
        known_.push_back({s, stage.keep(stage.world().shape_definition(s)).user_data});
    }
    changed(stage, {});
    stage.world().set_contact_modifier([this](rigid::ContactModification<Dim2>& c) {
      c.friction = length(c.relative_velocity) > 2 ? float(fast_) : float(slow_);
    });
    const rigid::PairRule on_ice[] = {{.friction = 0.4f}, {.friction = 0.02f}};
    stage.check(stage.world().set_pair_rule(ice_, rubber_, &on_ice[0]));
    stage.check(stage.world().set_pair_rule(ice_, steel_, &on_ice[1]));
    crates_[0] = crate(stage, {-7, 2.95}, 5, 0, gold);
    crates_[1] = crate(stage, {-7, 0.35}, 4, rubber_, violet);
    crates_[2] = crate(stage, {-5.5, 0.35}, 4, steel_, teal);
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    for (int k = 0; k < 3; ++k) {
      const double v = double(stage.at(crates_[k]).linear_velocity.x);
      stage.sample(0, k, t, v);
      if (t <= 0.25 + 1e-9) early_[k] = v;
      if (t <= 0.5 + 1e-9) late_[k] = v;
      if (k == 0 && v > 1.7) before_ = v, at_ = t;
      if (k == 0 && v > 0.5) after_ = v, until_ = t;
    }
  }
  void changed(Stage2& stage, std::string_view) override { slow_ = stage.value("slow"), fast_ = stage.value("fast"); }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double g = 9.80665;
    out.push_back({"slowing above 2 m/s", "m/s²", "μ₁ g", (early_[0] - late_[0]) / 0.25, 0.15 * g, 0.03});
    out.push_back({"slowing below 2 m/s", "m/s²", "μ₀ g", (before_ - after_) / (until_ - at_), 0.5 * g, 0.1});
    out.push_back({"slowing of rubber on ice", "m/s²", "the pair's μ g", (early_[1] - late_[1]) / 0.25, 0.4 * g, 0.08});
    out.push_back({"slowing of steel on ice", "m/s²", "the pair's μ g", (early_[2] - late_[2]) / 0.25, 0.02 * g, 0.01});
    int passed = 0, held = 0;
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      const bool right = stage.at(balls_[i]).pose.position.x > 0;
      passed += i % 2 == 1 && right ? 1 : 0;
      held += i % 2 == 0 && !right ? 1 : 0;
    }
    out.push_back({"blue balls held by the wall", "", "all three", double(held), 3, 0});
    out.push_back({"red balls that passed it", "", "the foremost at least", min(double(passed), 1.0), 1, 0});
  }

 private:
  static constexpr std::uint64_t wall_ = 1, red_ = 2;
  static constexpr std::uint32_t ice_ = 10, rubber_ = 11, steel_ = 12;

  std::uint64_t data_of(rigid::ShapeId s) const {
    for (const auto& [shape, data] : known_)
      if (shape == s) return data;
    return 0;
  }
  BodyId crate(Stage2& stage, Vec2d at, float speed, std::uint32_t material, std::uint32_t color) {
    rigid::BodyDef<Dim2> body;
    body.name = "crate";
    body.position = at;
    body.linear_velocity = {speed, 0};
    rigid::ShapeDef<Dim2> shape;
    shape.material.user_id = material;
    return stage.add(body, geometry::make_box2({0.5f, 0.35f}), shape, color);
  }

  std::vector<std::pair<rigid::ShapeId, std::uint64_t>> known_;  // the filter must not ask the world
  std::vector<BodyId> balls_;
  BodyId crates_[3];
  double slow_ = 0, fast_ = 0, early_[3] = {}, late_[3] = {}, before_ = 0, at_ = 0, after_ = 0, until_ = 1;
};

}  // namespace

std::unique_ptr<Demo> make_hooks() { return std::make_unique<Hooks>(); }

}  // namespace carom::host::demo
