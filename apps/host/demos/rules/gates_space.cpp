// Who is let through, in space: by the side it comes from, by its category, by a function of the caller, and by what a
// contact modifier says of a patch.
#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class GatesSpace final : public Repeatable<GatesSpace, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "gates-3d";
    d.title = "Gates: one-way, categories, hooks";
    d.summary = "Balls roll at four gates from both sides, and leap through a floor; each gate has its own rule.";
    d.group = "Rules of bodies";
    d.text =
        "Blue balls roll to the right, red ones to the left, at four gates.\n\n"
        "1. A one-way gate holds what comes against its direction: red ones stop.\n"
        "2. A gate of a category that blue ones have in their mask, and red ones not: blue ones stop.\n"
        "3. A contact filter is asked once for each pair that comes near: it holds big balls.\n"
        "4. A contact modifier is asked in every step: it lets through what is faster than the gate's limit.\n\n"
        "In front, balls leap up through a floor that holds from above. Behind, crates slide onto a floor on which the "
        "modifier sets the friction by their speed.\n\n"
        "  rise: h = v²/2g      slowing: a = μ(v) g";
    d.dt = 1.0 / 120;
    d.duration = 4;
    d.camera.position = {3, 9.5, 13.5};
    d.camera.target = {0, 0.6, 0.4};
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed of the balls", "m/s", "m/s", "", 1, 8, 0.1, 3, false},
        {"limit", "Limit of the fourth gate", "m/s", "m/s", "", 0, 8, 0.1, 3.5, true},
        {"slow", "Friction μ₀ below 2 m/s", "", "", "of the floor behind", 0, 1, 0.01, 0.5, true},
        {"fast", "Friction μ₁ above 2 m/s", "", "", "likewise", 0, 1, 0.01, 0.15, true},
    };
    d.plots = {{"Crate behind", {"time", "s"}, {"speed", "m/s"}, {{"crate"}}},
               {"Ball in front", {"time", "s"}, {"height", "m"}, {{"ball"}, {"v²/2g"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    rigid::ShapeDef<Dim3> gates[4];
    gates[0].one_way = {1, 0, 0};
    gates[1].filter.category = sieve_;
    gates[2].user_data = filtered_;
    gates[3].modify_contacts = true;
    gates[3].user_data = limited_;
    constexpr std::uint32_t gate_colors[] = {teal, gold, violet, green};
    for (int lane = 0; lane < 4; ++lane) {
      rigid::BodyDef<Dim3> body;
      body.type = rigid::BodyType::fixed;
      body.name = "gate";
      body.position = {0, 0.6, z_of(lane)};
      gates_[lane] = stage.add(body, geometry::Box{{0.06f, 0.6f, 0.6f}}, gates[lane], gate_colors[lane]);
      for (int side = 0; side < 2; ++side)
        for (int k = 0; k < 2; ++k) {
          // In the third lane one of each side is big, in the fourth one is fast.
          const float radius = lane == 2 && k == 1 ? 0.4f : 0.22f;
          const float speed = stage.valuef("speed") * (lane == 3 && k == 0 ? 1.5f : 1) * (side == 0 ? 1.0f : -1.0f);
          rigid::BodyDef<Dim3> ball;
          ball.name = "ball";
          // Two of a lane side by side, so that those of both sides pass each other.
          ball.position = {(side == 0 ? -1 : 1) * (2.2 + 0.9 * k), double(radius),
                           z_of(lane) + (side == 0 ? 0.28 : -0.28)};
          if (radius > 0.3f) ball.position.z = z_of(lane) + (side == 0 ? 0.42 : -0.42);
          ball.linear_velocity = {speed, 0, 0};
          ball.angular_velocity = {0, 0, -speed / radius};
          rigid::ShapeDef<Dim3> shape;
          shape.filter.category = ball_category_;
          // Balls do not meet each other, only gates and the floor; red ones not the sieve.
          shape.filter.mask = ~(ball_category_ | (side == 1 ? sieve_ : 0));
          shape.user_data = radius > 0.3f ? big_ : 0;
          shape.material.rolling_resistance = 0.02f;
          balls_[lane][side][k] = stage.add(ball, geometry::Sphere{radius}, shape, side == 0 ? blue : red);
        }
    }
    rigid::BodyDef<Dim3> deck;
    deck.type = rigid::BodyType::fixed;
    deck.name = "deck";
    deck.position = {0, 1.2, 4.6};
    stage.add(deck, geometry::Box{{3, 0.06f, 0.8f}}, {.one_way = {0, 1, 0}}, teal);
    for (int i = 0; i < 3; ++i) {
      rigid::BodyDef<Dim3> ball;
      ball.name = "leaper";
      ball.position = {-2.0 + 2 * i, 0.3, 4.6};
      ball.linear_velocity = {0, float(leap_), 0};
      leapers_[i] = stage.add(ball, geometry::Sphere{0.3f}, {}, orange);
    }
    rigid::BodyDef<Dim3> strip;
    strip.type = rigid::BodyType::fixed;
    strip.name = "floor of two frictions";
    strip.position = {0, 0.02, -4.6};
    rigid::ShapeDef<Dim3> rough;
    rough.modify_contacts = true;
    rough.user_data = strip_;
    stage.add(strip, geometry::Box{{6, 0.05f, 0.8f}}, rough, sand);
    rigid::BodyDef<Dim3> crate;
    crate.name = "crate";
    crate.position = {-5.4, 0.37, -4.6};
    crate.linear_velocity = {5, 0, 0};
    crate_ = stage.add(crate, geometry::Box{{0.5f, 0.3f, 0.4f}}, {}, gold);
    changed(stage, {});
    for (const auto& actor : stage.actors()) {
      std::vector<rigid::ShapeId> shapes;
      stage.world().shapes(actor.body, shapes);
      for (const rigid::ShapeId s : shapes)
        known_.push_back({s, stage.keep(stage.world().shape_definition(s)).user_data});
    }
    stage.world().set_contact_filter([this](rigid::ShapeId a, rigid::ShapeId b) {
      const std::uint64_t of_a = data_of(a), of_b = data_of(b);
      if (of_a != filtered_ && of_b != filtered_) return true;
      return of_a == big_ || of_b == big_;
    });
    stage.world().set_contact_modifier([this](rigid::ContactModification<Dim3>& c) {
      const std::uint64_t of_a = data_of(c.shape_a), of_b = data_of(c.shape_b);
      const double across = double(length(c.relative_velocity));
      if (of_a == strip_ || of_b == strip_) c.friction = float(across > 2 ? fast_ : slow_);
      // What is once in the gate goes on through it.
      const double toward = abs(double(dot(c.relative_velocity, c.normal)));  // without what rolls along the gate
      if (of_a == limited_ || of_b == limited_) c.enabled = toward < limit_ && c.points[0].separation > -0.03f;
    });
  }

  void changed(Stage3& stage, std::string_view) override {
    limit_ = stage.value("limit"), slow_ = stage.value("slow"), fast_ = stage.value("fast");
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time(), v = double(stage.at(crate_).linear_velocity.x);
    stage.sample(0, 0, t, v);
    if (t <= 0.25 + 1e-9) early_ = v;
    if (t <= 0.75 + 1e-9) late_ = v;
    if (v > 1.7) before_ = v, at_ = t;
    if (v > 0.5) after_ = v, until_ = t;
    const double y = stage.at(leapers_[0]).pose.position.y;
    stage.sample(1, 0, t, y);
    stage.sample(1, 1, t, 0.3 + leap_ * leap_ / (2 * 9.80665));
    highest_ = max(highest_, y);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const auto passed = [&](int lane, int side, int k) {
      const double x = stage.at(balls_[lane][side][k]).pose.position.x;
      return side == 0 ? x > 0.3 : x < -0.3;
    };
    const auto both = [&](int lane, int side) { return double(passed(lane, side, 0)) + double(passed(lane, side, 1)); };
    out.push_back({"blue balls through the one-way gate", "", "they come along its direction", both(0, 0), 2, 0});
    out.push_back({"red balls through the one-way gate", "", "they come against it", both(0, 1), 0, 0});
    out.push_back({"blue balls through the sieve", "", "its category is in their mask", both(1, 0), 0, 0});
    out.push_back({"red balls through the sieve", "", "it is not in theirs", both(1, 1), 2, 0});
    double small = 0, big = 0, quick = 0, lame = 0;
    for (int side = 0; side < 2; ++side) {
      small += passed(2, side, 0), big += passed(2, side, 1);
      quick += passed(3, side, 0), lame += passed(3, side, 1);
    }
    out.push_back({"small balls past the filter", "", "it holds big ones", small, 2, 0});
    out.push_back({"big balls past the filter", "", "it holds them", big, 0, 0});
    out.push_back({"fast balls past the modifier", "", "faster than the limit", quick, 2, 0});
    out.push_back({"slow balls past the modifier", "", "slower than the limit", lame, 0, 0});
    const double g = 9.80665;
    out.push_back({"rise of the leapers", "m", "v²/2g", highest_ - 0.3, leap_ * leap_ / (2 * g), 0.05});
    out.push_back({"height at the end", "m", "on the deck", stage.at(leapers_[0]).pose.position.y, 1.56, 0.01});
    out.push_back({"slowing above 2 m/s", "m/s²", "μ₁ g", (early_ - late_) / 0.5, 0.15 * g, 0.03});
    out.push_back({"slowing below 2 m/s", "m/s²", "μ₀ g", (before_ - after_) / (until_ - at_), 0.5 * g, 0.1});
  }

 private:
  static constexpr std::uint64_t sieve_ = 2, ball_category_ = 4;                     // categories
  static constexpr std::uint64_t filtered_ = 1, big_ = 2, limited_ = 3, strip_ = 4;  // user data of shapes
  static constexpr double leap_ = 6.5;
  static double z_of(int lane) { return -2.7 + 1.8 * lane; }
  std::uint64_t data_of(rigid::ShapeId s) const {
    for (const auto& [shape, data] : known_)
      if (shape == s) return data;
    return 0;
  }

  std::vector<std::pair<rigid::ShapeId, std::uint64_t>> known_;  // hooks must not ask the world
  BodyId gates_[4], balls_[4][2][2], leapers_[3], crate_;
  double limit_ = 0, slow_ = 0, fast_ = 0, early_ = 0, late_ = 0, before_ = 0, at_ = 0, after_ = 0, until_ = 1,
         highest_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_gates_space() { return std::make_unique<GatesSpace>(); }

}  // namespace carom::host::demo
