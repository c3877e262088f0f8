// Belts: a surface that moves along itself takes along what lies on it, by friction alone.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::Dim2;

class Conveyor final : public Repeatable<Conveyor, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "conveyor";
    d.title = "Conveyor belts";
    d.summary = "Crates ride up and down on belts whose surface moves; friction decides how soon they keep up.";
    d.group = "Surfaces";
    d.chapter = "3.3";
    d.dimension = 2;
    d.text =
        "A belt is a fixed body whose material has a surface speed u. Friction pulls at whatever slides on it until "
        "both move alike; with Coulomb friction that is a steady acceleration.\n\n"
        "  a = μ g      t = u/(μ g)      s = u²/(2 μ g)\n\n"
        "On a belt that rises by the angle β a crate keeps up only where μ > tan β. The crate in the plot starts at "
        "rest "
        "on the level belt.";
    d.dt = 1.0 / 120;
    d.duration = 6;
    d.camera.target = {0, 3.2, 0};
    d.camera.height = 13;
    d.camera.width = 24;
    d.parameters = {
        {"speed", "Speed of the belts", "m/s", "m/s", "of their surfaces", 0, 6, 0.1, 2, true},
        {"friction", "Friction μ", "", "", "between crates and belts", 0.05, 1.2, 0, 0.4, false},
        {"slope", "Slope of the rising belt", "rad", "deg", "", 0, 0.7, 0, radians(15.0), false},
    };
    d.plots = {{"Crate on the level belt",
                {"time", "s"},
                {"speed", "m/s"},
                {{"crate"}, {"u or μ g t", Series::Style::points}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(-1.5);
    const float speed = stage.valuef("speed");
    belt(stage, {-7, 0}, 4, 0, speed);
    const float slope = stage.valuef("slope");
    const double run = 4 * cos(double(slope)), rise = 4 * sin(double(slope));
    belt(stage, {-2.7 + run, -0.15 + rise}, 4, slope, speed);
    belt(stage, {3, 7}, 5, 0, -speed);
    rigid::BodyDef<Dim2> wall;
    wall.type = rigid::BodyType::fixed;
    wall.name = "chute";
    wall.position = {-4.2, 5};
    wall.rotation = {cos(-0.6f), sin(-0.6f)};
    stage.add(wall, geometry::make_box2({2.2f, 0.1f}), {}, dark);
    first_ = crate(stage, {-9, 0.65}, blue);
    const double u = stage.value("speed"), g = 9.80665;
    for (double t = 0.25; t <= 2; t += 0.25) stage.sample(0, 1, t, min(u, stage.value("friction") * g * t));
  }

  void before_step(Stage2& stage) override {
    if (stage.world().step_count() % 90 != 30) return;
    if (crates_.size() >= 26) {
      stage.remove(crates_.front());
      crates_.erase(crates_.begin());
    }
    constexpr std::uint32_t colors[] = {orange, gold, green, violet, teal};
    crates_.push_back(crate(stage, {6.5, 8.2}, colors[made_++ % 5]));
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    if (t > 2.5) return;
    const double v = stage.at(first_).linear_velocity.x;
    stage.sample(0, 0, t, v);
    if (t <= 0.25 + 1e-9) early_ = v / t;
    if (t <= 1.5 + 1e-9) late_ = v;
  }

  void changed(Stage2& stage, std::string_view) override {
    for (const Belt& belt : belts_) {
      auto definition = stage.keep(stage.world().shape_definition(belt.shape));
      definition.material.tangent_speed = -belt.sign * stage.valuef("speed");
      stage.check(stage.world().set_material(belt.shape, definition.material));
    }
  }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    out.push_back({"acceleration on the belt", "m/s²", "μ g", early_, 0.4 * 9.80665, 0.04 * 9.80665 * 0.4});
    out.push_back({"speed after 1.5 s", "m/s", "that of the belt", late_, 2, 0.01});
  }

 private:
  struct Belt {
    rigid::ShapeId shape;
    float sign;
  };

  void belt(Stage2& stage, Vec2d at, float half, float angle, float speed) {
    rigid::BodyDef<Dim2> body;
    body.type = rigid::BodyType::fixed;
    body.name = "belt";
    body.position = at;
    body.rotation = {cos(angle), sin(angle)};
    rigid::ShapeDef<Dim2> shape;
    // Of a pair the geometric mean counts: the crates have the same.
    shape.material.friction = stage.valuef("friction");
    shape.material.tangent_speed = -speed;  // positive runs counterclockwise round the body: to the left on top
    shape.local.q = {0, 1};                 // a capsule lies along y
    const rigid::BodyId lying = stage.add(body, geometry::Capsule2{half, 0.3f}, shape, steel);
    std::vector<rigid::ShapeId> shapes;
    stage.world().shapes(lying, shapes);
    belts_.push_back({shapes.front(), speed < 0 ? -1.0f : 1.0f});
  }

  rigid::BodyId crate(Stage2& stage, Vec2d at, std::uint32_t color) {
    rigid::BodyDef<Dim2> body;
    body.name = "crate";
    body.position = at;
    rigid::ShapeDef<Dim2> shape;
    shape.material.friction = stage.valuef("friction");
    shape.density = 200;
    return stage.add(body, geometry::make_box2({0.35f, 0.35f}), shape, color);
  }

  std::vector<Belt> belts_;
  std::vector<rigid::BodyId> crates_;
  rigid::BodyId first_;
  double early_ = 0, late_ = 0;
  int made_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_conveyor() { return std::make_unique<Conveyor>(); }

}  // namespace carom::host::demo
