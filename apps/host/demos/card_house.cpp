// A house of cards: friction alone holds it.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class CardHouse final : public Repeatable<CardHouse, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "card-house";
    d.title = "House of cards";
    d.summary = "Cards lean on each other, storey on storey. Friction holds them, or does not.";
    d.group = "Stacks";
    d.chapter = "5.2";
    d.dimension = 2;
    d.text =
        "Two cards of weight w that lean by the angle φ from the upright press against each other with ½ w tan φ, and "
        "each stands with its weight on the ground: it holds where\n\n"
        "  μ ≥ ½ tan φ\n\n"
        "A card above adds to both in the same proportion. Press the key to throw a ball at it.";
    d.dt = 1.0 / 120;
    d.duration = 8;
    d.camera.target = {0, 3.6, 0};
    d.camera.height = 10;
    d.camera.width = 12;
    d.parameters = {
        {"storeys", "Storeys", "", "", "", 1, 5, 1, 4, false},
        {"friction", "Friction μ", "", "", "of card on card and on the table", 0.05, 1, 0, 0.7, false},
        {"lean", "Lean φ", "rad", "deg", "of the cards from the upright", radians(12.0), radians(28.0), 0,
         radians(22.0), false},
    };
    d.inputs = {{"throw", "Throw a ball", {"Space"}, true, 1}};
    d.plots = {{"The topmost card", {"time", "s"}, {"height", "m"}, {{"centre"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    const float mu = stage.valuef("friction");
    stage.floor(0, {.friction = mu});
    const double phi = stage.value("lean"), s = sin(phi), c = cos(phi);
    const double half = half_ * s + thick_ * c, rise = 2 * (half_ * c + thick_ * s);
    const int storeys = stage.count("storeys");
    constexpr std::uint32_t colors[] = {red, blue, gold, green, violet};
    double y = 0;
    for (int row = 0; row < storeys; ++row) {
      const int pairs = storeys - row;
      for (int i = 0; i < pairs; ++i) {
        const double x = 4 * half * (i - 0.5 * (pairs - 1));
        card(stage, {x - half, y + 0.5 * rise}, half_, -phi, colors[row % 5]);
        card(stage, {x + half, y + 0.5 * rise}, half_, phi, colors[row % 5]);
        if (i + 1 < pairs) card(stage, {x + 2 * half, y + rise + thick_}, 2 * half - 0.004, pi / 2, sand);
      }
      y += rise + 2 * thick_;
    }
    start_ = stage.at(cards_.back()).pose.position.y;
  }

  void before_step(Stage2& stage) override {
    if (stage.presses("throw") == 0) return;
    rigid::BodyDef<Dim2> ball;
    ball.name = "ball";
    ball.position = {-6, 2.5};
    ball.linear_velocity = {9, 1};
    stage.add(ball, geometry::Circle{0.2f}, {.density = 400}, dark);
  }
  void after_step(Stage2& stage) override {
    stage.sample(0, 0, stage.world().time(), stage.at(cards_.back()).pose.position.y);
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"height of a card at the top", "m", "where it was put", stage.at(cards_.back()).pose.position.y,
                   start_, 0.05});
    double fastest = 0;
    for (const BodyId card : cards_) fastest = max(fastest, double(length(stage.at(card).linear_velocity)));
    out.push_back({"fastest card", "m/s", "it stands", fastest, 0, 0.02});
  }

 private:
  static constexpr double half_ = 0.9, thick_ = 0.02;

  void card(Stage2& stage, Vec2d at, double half, double turn, std::uint32_t color) {
    rigid::BodyDef<Dim2> body;
    body.name = "card";
    body.position = at;
    body.rotation = {float(cos(turn)), float(sin(turn))};
    rigid::ShapeDef<Dim2> shape;
    shape.material.friction = stage.valuef("friction");
    shape.density = 700;
    cards_.push_back(stage.add(body, geometry::make_box2({float(thick_), float(half)}), shape, color));
  }
  std::vector<BodyId> cards_;
  double start_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_card_house() { return std::make_unique<CardHouse>(); }

}  // namespace carom::host::demo
