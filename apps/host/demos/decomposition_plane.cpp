// Concave polygons as convex ones: gears that mesh by their teeth alone, a ring on a peg, stars that catch in each
// other.
#include "apps/host/demos/demos.h"
#include "carom/geometry/decomposition.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;
using Points = std::vector<Vec2f>;

class DecompositionPlane final : public Repeatable<DecompositionPlane, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "decomposition-2d";
    d.title = "Concave shapes in the plane";
    d.summary =
        "Gears mesh by their teeth alone, a ring hangs on a peg, stars catch in each other: convex parts of them.";
    d.group = "Shapes";
    d.dimension = 2;
    d.text =
        "A simple polygon, with holes or not, is cut into triangles, which are put together again while they stay "
        "convex. The parts are exactly the polygon, so teeth carry as they are drawn, and the gears keep the ratio of "
        "their teeth without a joint between them.\n\n"
        "  ω₂ = −ω₁ n₁/n₂\n\n"
        "Switch on “Shapes” to see the parts.";
    d.duration = 8;
    d.camera.target = {0, 3.6, 0};
    d.camera.height = 8.6;
    d.camera.width = 12.5;
    d.ground = 0;
    d.parameters = {
        {"teeth", "Teeth of the driver", "", "", "n₁; the other has 18", 6, 24, 1, 12, false},
        {"speed", "Speed of the driver", "rad/s", "rad/s", "ω₁", -4, 4, 0.1, 1.5, true},
        {"stars", "Stars", "", "", "", 1, 30, 1, 10, false},
    };
    d.plots = {{"Gears", {"time", "s"}, {"turned", "rad"}, {{"driver"}, {"driven"}, {"−n₁/n₂ of the driver"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    stage.looks_in_materials = true;
    const int teeth[] = {stage.count("teeth"), 18};
    const double radius[] = {module_ * teeth[0] / 2, module_ * teeth[1] / 2};
    const double between = radius[0] + radius[1];
    for (int k = 0; k < 2; ++k) {
      rigid::BodyDef<Dim2> body;
      body.name = k == 0 ? "driver" : "driven gear";
      body.position = {-3.6 + (k == 0 ? 0 : between), 5};
      // A tooth of the one, in a gap of the other.
      if (k == 1) body.rotation = from_angle(float(pi + pi / teeth[1]));
      gears_[k] = add(stage, body, gear(teeth[k], radius[k]), {}, k == 0 ? 0 : 2, 0.2f);
      rigid::HingeJointDef<Dim2> axle;
      axle.body_b = gears_[k];
      axle.frame_a.p = Vec2f(body.position);
      axle.motor = {true, k == 0 ? stage.valuef("speed") : 0, k == 0 ? 1e6f : 500.0f};
      (k == 0 ? motor_ : brake_) = stage.keep(stage.world().create_joint(axle));
    }
    rigid::BodyDef<Dim2> peg;
    peg.type = rigid::BodyType::fixed;
    peg.name = "peg";
    peg.position = {4.6, 5.4};
    stage.add(peg, geometry::Circle{peg_}, {.material = {.user_id = 0xff000000u | dark}});
    rigid::BodyDef<Dim2> ring;
    ring.name = "ring";
    ring.position = {4.6, 5.05};
    ring.angular_damping = ring.linear_damping = 0.5f;
    const std::vector<Points> holes{circle(hole_, 16)};
    ring_ = add(stage, ring, circle(0.95, 24), holes, 1, 0.6f);
    for (int i = 0, n = stage.count("stars"); i < n; ++i) {
      rigid::BodyDef<Dim2> body;
      body.name = i % 2 == 0 ? "star" : "hook";
      body.position = {-4.2 + 8.4 * (i + 0.5) / n, 1.2 + 0.9 * (i % 3)};
      body.rotation = from_angle(0.7f * float(i));
      add(stage, body, i % 2 == 0 ? star() : hook(), {}, i, 0.6f);
    }
  }

  void changed(Stage2& stage, std::string_view) override {
    stage.check(stage.world().set_motor(motor_, {true, stage.valuef("speed"), 1e6f}));
  }
  void after_step(Stage2& stage) override {
    const double t = stage.world().time(), dt = stage.declaration().dt;
    for (int k = 0; k < 2; ++k) {
      turned_[k] += double(stage.at(gears_[k]).angular_velocity) * dt;
      stage.sample(0, k, t, turned_[k]);
    }
    stage.sample(0, 2, t, -turned_[0] * stage.count("teeth") / 18);
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"turn of the driven gear over the driver's", "", "−n₁/n₂", turned_[1] / turned_[0],
                   -stage.count("teeth") / 18.0, 0.01});
    out.push_back(
        {"area of all parts over that of the outlines", "", "they are the same", parts_ / outlines_, 1, 1e-5});
    out.push_back({"height of the ring's centre", "m", "the hole's side on the peg", stage.at(ring_).pose.position.y,
                   5.4 + double(peg_) - hole_, 0.03});
  }

 private:
  static constexpr double module_ = 0.2, hole_ = 0.6;
  static constexpr float peg_ = 0.12f;

  static Points circle(double radius, int corners) {
    Points p;
    for (int i = 0; i < corners; ++i) p.push_back(polar(radius, 2 * pi * i / corners));
    return p;
  }
  static Vec2f polar(double r, double a) { return {float(r * cos(a)), float(r * sin(a))}; }
  /// Straight flanks; teeth a little narrower than gaps.
  static Points gear(int teeth, double radius) {
    Points p;
    const double pitch = 2 * pi / teeth, root = radius - module_, tip = radius + 0.8 * module_;
    for (int i = 0; i < teeth; ++i)
      for (const auto& [r, a] : {std::pair{root, -0.30}, {tip, -0.13}, {tip, 0.13}, {root, 0.30}})
        p.push_back(polar(r, (i + a) * pitch));
    return p;
  }
  static Points star() {
    Points p;
    for (int i = 0; i < 10; ++i) p.push_back(polar(i % 2 == 0 ? 0.5 : 0.2, pi * i / 5));
    return p;
  }
  static Points hook() {
    return {{-0.4f, -0.5f},  {0.4f, -0.5f},    {0.4f, 0.1f},   {0.25f, 0.1f},
            {0.25f, -0.35f}, {-0.25f, -0.35f}, {-0.25f, 0.5f}, {-0.4f, 0.5f}};
  }
  static double area(std::span<const Vec2f> p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += cross(Vec2d(p[i]), Vec2d(p[(i + 1) % p.size()]));
    return 0.5 * abs(sum);
  }
  BodyId add(Stage2& stage, const rigid::BodyDef<Dim2>& body, const Points& outline, const std::vector<Points>& holes,
             int shade, float friction) {
    constexpr std::uint32_t colors[] = {teal, orange, blue, gold, green, violet};
    const BodyId id = stage.add(body, {});
    const auto parts = stage.keep(geometry::decompose_convex(outline, holes));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rigid::ShapeDef<Dim2> shape;
      shape.material.friction = friction;
      shape.material.user_id = 0xff000000u | colors[(i % 2 + std::size_t(shade)) % 6];
      stage.keep(stage.world().add_shape(id, parts[i], shape));
      parts_ += area({parts[i].vertices, std::size_t(parts[i].count)});
    }
    outlines_ += area(outline);
    for (const Points& hole : holes) outlines_ -= area(hole);
    return id;
  }

  BodyId gears_[2], ring_;
  rigid::JointId motor_, brake_;
  double turned_[2] = {}, parts_ = 0, outlines_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_decomposition_plane() { return std::make_unique<DecompositionPlane>(); }

}  // namespace carom::host::demo
