// Two bodies of the plane meet: what restitution, friction, masses and aim make of it (chapter 5).
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

class CollisionLab2 final : public Repeatable<CollisionLab2, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "collision-lab-2d";
    d.title = "Collision lab, 2D";
    d.summary = "Two pucks meet on ice: slide restitution, friction, masses and aim, and read momentum and energy.";
    d.group = "Collisions";
    d.chapter = "5";
    d.dimension = 2;
    d.text =
        "An impact is an impulse along the line between the bodies. Restitution e says how much of the closing speed "
        "comes back; friction adds an impulse along the surfaces, no greater than μ times the first.\n\n"
        "  J = (1 + e) (v₁ − v₂)·n / (1/m₁ + 1/m₂ + …)\n\n"
        "Whatever e and μ are, momentum and angular momentum stay what they were; only energy can be lost. With the "
        "values one finds here (2 kg at 3 m/s meets 1 kg at −1 m/s, e = ½) the impulse is 4 N·s and the pucks leave at "
        "1 and 3 m/s. "
        "The pucks start over when they have flown apart.";
    d.dt = 1.0 / 120;
    d.duration = 3;
    d.camera.target = {1.5, 0, 0};
    d.camera.height = 8;
    d.camera.width = 13;
    d.parameters = {
        {"restitution", "Restitution e", "", "", "0: they stay together, 1: no energy is lost", 0, 1, 0, 0.5, false},
        {"friction", "Friction μ", "", "", "turns some of a glancing blow into spin", 0, 1.5, 0, 0.3, false},
        {"mass_a", "Mass of the left", "kg", "kg", "", 0.2, 20, 0, 2, false},
        {"mass_b", "Mass of the right", "kg", "kg", "", 0.2, 20, 0, 1, false},
        {"speed_a", "Speed of the left", "m/s", "m/s", "to the right", 0, 12, 0, 3, false},
        {"speed_b", "Speed of the right", "m/s", "m/s", "to the right", -12, 0, 0, -1, false},
        {"offset", "Off centre by", "m", "m", "how far the right one stands above the line of the left", -1.4, 1.4, 0,
         0, false},
        {"spin", "Spin of the left", "rad/s", "rad/s", "", -20, 20, 0, 0, false},
        choice("shape", "Shape", "", {"discs", "boxes", "hexagons"}),
    };
    d.plots = {{"Momentum along x", {"time", "s"}, {"momentum", "kg·m/s"}, {{"left"}, {"right"}, {"both"}}},
               {"Energy", {"time", "s"}, {"energy", "J"}, {{"translation"}, {"rotation"}, {"all"}}},
               {"Angular momentum", {"time", "s"}, {"about the centre of mass", "kg·m²/s"}, {{"both"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<rigid::Dim2> world;
    world.gravity = {};
    world.restitution_threshold = 0.01f;
    stage.start(world);
    const int shape = stage.count("shape");
    a_ = puck(stage, shape, stage.value("mass_a"), blue, "left");
    b_ = puck(stage, shape, stage.value("mass_b"), orange, "right");
    launch(stage);
  }

  void before_step(Stage2& stage) override {
    const auto a = stage.at(a_), b = stage.at(b_);
    const bool apart = stage.world().time() - launched_ > 2.5 && distance(a.pose.position, b.pose.position) > 9;
    if (apart) launch(stage);
  }

  void after_step(Stage2& stage) override {
    const auto a = stage.at(a_), b = stage.at(b_);
    const double t = stage.world().time() - launched_;
    const Vec2d pa = double(a.mass) * Vec2d(a.linear_velocity), pb = double(b.mass) * Vec2d(b.linear_velocity);
    stage.sample(0, 0, t, pa.x);
    stage.sample(0, 1, t, pb.x);
    stage.sample(0, 2, t, pa.x + pb.x);
    const double ia = inertia(stage, a_), ib = inertia(stage, b_);
    const double rotation = 0.5 * (ia * square(double(a.angular_velocity)) + ib * square(double(b.angular_velocity)));
    const double all = stage.world().totals().kinetic_energy;
    stage.sample(1, 0, t, all - rotation);
    stage.sample(1, 1, t, rotation);
    stage.sample(1, 2, t, all);
    const Vec2d center =
        (double(a.mass) * a.center_of_mass + double(b.mass) * b.center_of_mass) / double(a.mass + b.mass);
    stage.sample(2, 0, t,
                 ia * a.angular_velocity + ib * b.angular_velocity + cross(a.center_of_mass - center, pa) +
                     cross(b.center_of_mass - center, pb));
    arrow(stage, a, pen(blue));
    arrow(stage, b, pen(orange));
    for (const auto& begin : stage.world().events().contact_begin) {
      (void)begin;
      met_ = true;
    }
    if (met_ && !stage.world().events().contact_end.empty() && after_a_ == 0 && after_b_ == 0) {
      after_a_ = a.linear_velocity.x;
      after_b_ = b.linear_velocity.x;
      stage.say(format("after the impact: left %.3f m/s, right %.3f m/s, impulse %.3f N·s", after_a_, after_b_,
                       b.mass * (after_b_ - stage.value("speed_b"))));
    }
  }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    out.push_back({"speed of the left after the impact", "m/s", "ch. 5.2: m = 2 and 1 kg, v = 3 and −1 m/s, e = ½",
                   after_a_, 1, 2e-3});
    out.push_back({"speed of the right after the impact", "m/s", "ch. 5.2", after_b_, 3, 2e-3});
  }

 private:
  rigid::BodyId puck(Stage2& stage, int shape, double mass, std::uint32_t color, const char* name) {
    rigid::BodyDef<rigid::Dim2> body;
    body.name = name;
    body.sleep_speed = 0;
    body.bullet = true;
    rigid::ShapeDef<rigid::Dim2> definition;
    definition.material.restitution = stage.valuef("restitution");
    definition.material.friction = stage.valuef("friction");
    geometry::Shape2 form = geometry::Circle{0.7f};
    double area = pi * 0.7 * 0.7;
    if (shape == 1) {
      form = geometry::make_box2({0.65f, 0.65f});
      area = 1.69;
    } else if (shape == 2) {
      Vec2f corner[6];
      for (int i = 0; i < 6; ++i) corner[i] = {0.75f * cos(float(i) * pi_f / 3), 0.75f * sin(float(i) * pi_f / 3)};
      form = stage.keep(geometry::make_polygon(corner));
      area = 1.5 * sqrt(3.0) * 0.75 * 0.75;
    }
    definition.density = float(mass / area);
    return stage.add(body, form, definition, color);
  }

  void launch(Stage2& stage) {
    const float va = stage.valuef("speed_a"), vb = stage.valuef("speed_b");
    // They meet at the middle of the picture one second from now.
    const double offset = stage.value("offset");
    put(stage, a_, {-0.75 - double(va), -0.5 * offset}, va, stage.valuef("spin"));
    put(stage, b_, {0.75 - double(vb), 0.5 * offset}, vb, 0);
    launched_ = stage.world().time();
  }
  void put(Stage2& stage, rigid::BodyId body, Vec2d position, float speed, float spin) {
    stage.check(stage.world().set_pose(body, position, {}));
    stage.check(stage.world().set_velocity(body, {speed, 0}, spin));
  }
  static double inertia(Stage2& stage, rigid::BodyId body) {
    return stage.keep(stage.world().mass_properties2(body)).inertia;
  }
  static void arrow(Stage2& stage, const rigid::BodyState<rigid::Dim2>& s, std::uint32_t color) {
    const Vec2d tip = s.center_of_mass + 0.4 * Vec2d(s.linear_velocity);
    stage.line(s.center_of_mass, tip, color);
    const Vec2d back = -0.15 * normalize(Vec2d(s.linear_velocity));
    stage.line(tip, tip + back + 0.5 * perpendicular(back), color);
    stage.line(tip, tip + back - 0.5 * perpendicular(back), color);
  }

  rigid::BodyId a_, b_;
  double launched_ = 0, after_a_ = 0, after_b_ = 0;
  bool met_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_collision_lab2() { return std::make_unique<CollisionLab2>(); }

}  // namespace carom::host::demo
