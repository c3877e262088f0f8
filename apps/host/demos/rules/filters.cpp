// Who meets whom: balls of four kinds rain on three sieves.
#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class Filters final : public Repeatable<Filters, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "filters";
    d.dimension = 2;
    d.title = "Sieves: categories, masks and groups";
    d.summary = "Three trays each hold one kind of ball and let the others fall through; ghosts fall through all.";
    d.group = "Rules of bodies";
    d.text =
        "Every shape is in categories (bits) and has a mask of the categories that it meets. Two shapes collide where "
        "each one's category is in the other's mask. The trays hold the colour they have, and balls meet their "
        "own kind.\n\n"
        "  meet = (category_a & mask_b) ≠ 0 and (category_b & mask_a) ≠ 0\n\n"
        "A group goes before: two shapes of the same negative group never meet, of the same positive one always. The "
        "grey ghosts name the ground and their own kind; being of one negative group they pass through each other "
        "too, and end all in two places. Take the group away and they pile up.";
    d.duration = 7;
    d.camera.target = {0, 4.6, 0};
    d.camera.height = 11;
    d.camera.width = 14;
    d.ground = 0;
    d.parameters = {{"balls", "Balls of a kind", "", "", "", 3, 40, 1, 14, false},
                    yes_or_no("upper", "Upper tray holds green too", "its mask names two categories", false, true),
                    yes_or_no("group", "Ghosts are one group", "or they meet one another", true)};
    d.plots = {{"Held",
                {"time", "s"},
                {"balls", ""},
                {{"upper tray", Series::Style::line, {}, red},
                 {"middle tray", Series::Style::line, {}, green},
                 {"lower tray", Series::Style::line, {}, blue}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    constexpr std::uint32_t colors[] = {red, green, blue, steel};
    for (int k = 0; k < 3; ++k) {
      rigid::BodyDef<Dim2> body;
      body.type = rigid::BodyType::fixed;
      body.name = "tray";
      body.position = {0, level(k)};
      std::initializer_list<Stage2::Part> parts = {{geometry::make_box2({3.6f, 0.1f}), surface(tray_, held(stage, k))},
                                                   {side(-3.6f), surface(tray_, held(stage, k))},
                                                   {side(3.6f), surface(tray_, held(stage, k))}};
      trays_[k] = stage.add(body, parts, colors[k]);
    }
    // Walls that everyone meets, so that nothing rolls away.
    for (const double x : {-4.6, 4.6}) {
      rigid::BodyDef<Dim2> wall;
      wall.type = rigid::BodyType::fixed;
      wall.name = "wall";
      wall.position = {x, 1};
      stage.add(wall, geometry::make_box2({0.15f, 1}), {}, dark);
    }
    const int count = stage.count("balls");
    for (int i = 0; i < 4 * count; ++i) {
      const int kind = i % 4;
      rigid::BodyDef<Dim2> body;
      body.name = kind == 3 ? "ghost" : "ball";
      const int row = i / 4;
      body.position = {-2.7 + 0.6 * (i * 7 % 10) + 0.05 * (i % 3), 8.4 + 0.42 * row};
      const std::uint64_t own = std::uint64_t{1} << (kind + 1);
      rigid::ShapeDef<Dim2> shape = surface(own, tray_ | own);
      shape.material.rolling_resistance = 0.05f;
      if (kind == 3) {
        shape.filter.group = stage.count("group") == 1 ? -3 : 0;
        body.position = {1.5 * (i % 8 < 4 ? -1 : 1), 8.4 + 0.5 * row};
      }
      balls_[kind].push_back(stage.add(body, geometry::Circle{radius_}, shape, colors[kind]));
    }
  }

  void changed(Stage2& stage, std::string_view) override {
    for (int k = 0; k < 3; ++k) {
      std::vector<rigid::ShapeId> shapes;
      stage.world().shapes(trays_[k], shapes);
      for (const rigid::ShapeId s : shapes) stage.check(stage.world().set_filter(s, {tray_, held(stage, k), 0}));
    }
  }

  void after_step(Stage2& stage) override {
    for (int k = 0; k < 3; ++k) stage.sample(0, k, stage.world().time(), on_tray(stage, k, k));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double all = double(balls_[0].size());
    out.push_back({"red balls on the upper tray", "", "its mask", on_tray(stage, 0, 0), all, 0});
    out.push_back({"green balls on the middle tray", "", "its mask", on_tray(stage, 1, 1), all, 0});
    out.push_back({"blue balls on the lower tray", "", "its mask", on_tray(stage, 2, 2), all, 0});
    double ghosts = 0, highest = 0;
    for (const BodyId ball : balls_[3]) {
      const double y = stage.at(ball).pose.position.y;
      ghosts += y < 1 ? 1 : 0;
      highest = max(highest, y);
    }
    out.push_back({"ghosts on the ground", "", "no tray names them", ghosts, double(balls_[3].size()), 0});
    out.push_back(
        {"highest ghost", "m", "a group that does not meet itself: none on another", highest, double(radius_), 0.01});
  }

 private:
  static constexpr std::uint64_t tray_ = 1;
  static constexpr float radius_ = 0.17f;
  static double level(int tray) { return 6.2 - 2.1 * tray; }
  std::uint64_t held(Stage2& stage, int tray) const {
    const std::uint64_t own = std::uint64_t{1} << (tray + 1);
    return tray == 0 && stage.count("upper") == 1 ? own | std::uint64_t{1} << 2 : own;
  }
  static rigid::ShapeDef<Dim2> surface(std::uint64_t category, std::uint64_t mask) {
    rigid::ShapeDef<Dim2> d;
    d.filter = {category, mask, 0};
    return d;
  }
  static geometry::Shape2 side(float x) {
    const Vec2f corners[] = {{x - 0.08f, 0}, {x + 0.08f, 0}, {x + 0.08f, 0.7f}, {x - 0.08f, 0.7f}};
    return geometry::make_polygon(corners).value();
  }
  double on_tray(Stage2& stage, int tray, int kind) {
    double count = 0;
    for (const BodyId ball : balls_[kind]) {
      const Vec2d p = stage.at(ball).pose.position;
      count += p.y > level(tray) && p.y < level(tray) + 1.6 ? 1 : 0;
    }
    return count;
  }

  BodyId trays_[3];
  std::vector<BodyId> balls_[4];
};

}  // namespace

std::unique_ptr<Demo> make_filters() { return std::make_unique<Filters>(); }

}  // namespace carom::host::demo
