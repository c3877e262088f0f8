// Meshes on bodies that move: a bowl that pours, a torus on a peg.
#include "apps/host/demos/demos.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class MovingMeshes final : public Repeatable<MovingMeshes, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "moving-meshes";
    d.title = "Meshes that move";
    d.summary = "A bowl of one mesh pours its balls over rings of one mesh each, which hang on pegs and lie about.";
    d.group = "Shapes";
    d.text =
        "A mesh on a kinematic body is a machine part: things lie in it and ride with it. On a dynamic body it has the "
        "mass, centre and inertia of what it encloses, and meets all convex shapes and planes, through its holes too. "
        "Meshes do not meet each other; for that they are cut into convex parts.\n\n"
        "  m = 2π² R r² ρ      I = m (R² + 3/4 r²) about the axis of a torus";
    d.duration = 8;
    d.camera.position = {0, 5, 13};
    d.camera.target = {0, 2.4, 0};
    d.parameters = {
        {"balls", "Balls", "", "", "in the bowl", 10, 80, 1, 40, false},
        {"pour", "Turning of the bowl", "rad/s", "rad/s", "while it pours, from 2 s to 6 s", 0.1, 1, 0, 0.6, false},
    };
    d.plots = {{"The ring on the peg", {"time", "s"}, {"height", "m"}, {{"centre"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    std::vector<Vec2f> profile;
    for (int i = 0; i <= 18; ++i) {
      const int k = i <= 9 ? i : 18 - i;
      const double a = 1.35 * double(k) / 9, r = i <= 9 ? 1.15 : 1.0;
      profile.push_back({float(r * sin(a)), float(-r * cos(a))});
    }
    const geometry::Triangles bowl = geometry::make_lathe_mesh(profile, 40);
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::kinematic;
    body.name = "bowl";
    body.position = {-2.6, 4.2, 0};
    rigid::ShapeDef<Dim3> wall;
    wall.filter = {.category = 4, .mask = ~std::uint64_t{2}};
    bowl_ = stage.add(body, mesh(stage, bowl), wall, steel);
    constexpr std::uint32_t colors[] = {orange, blue, gold, violet, red, green};
    const int balls = stage.count("balls");
    for (int i = 0; i < balls; ++i) {
      rigid::BodyDef<Dim3> ball;
      ball.name = "ball";
      const int row = i / 8, side = i / 4 % 2;
      ball.position = {-2.6 + 0.22 * (i % 4 - 1.5), 4 + 0.24 * row, 0.2 * (side - 0.5)};
      stage.add(ball, geometry::Sphere{0.1f}, {.density = 2000}, colors[i % 6]);
    }
    rigid::BodyDef<Dim3> peg;
    peg.type = rigid::BodyType::fixed;
    peg.name = "peg";
    peg.position = {0.6, 2.9, 0};
    stage.add(peg, geometry::Box{{0.1f, 0.1f, 0.8f}}, {}, dark);
    // Rings do not meet each other: meshes of the same category would be refused.
    rigid::ShapeDef<Dim3> ring;
    ring.density = 600;
    ring.filter = {.category = 2, .mask = ~std::uint64_t{2 | 4}};
    const geometry::Shape3 torus = mesh(stage, geometry::make_torus_mesh(0.8f, 0.18f, 40, 18));
    rigid::BodyDef<Dim3> hung;
    hung.name = "ring";
    hung.position = {0.65, 2.6, 0};
    hung.angular_damping = 0.3f;
    ring_ = stage.add(hung, torus, ring, teal);
    for (int i = 0; i < 2; ++i) {
      rigid::BodyDef<Dim3> lying;
      lying.name = "ring";
      lying.position = {2.6 + 2.2 * i, 0.8, 0.3};
      lying.rotation = from_axis_angle(Vec3f{1, 0, 0}, float(pi) / 2 - 0.4f);
      lying_ = stage.add(lying, torus, ring, i == 0 ? green : violet);
    }
  }

  void before_step(Stage3& stage) override {
    const double t = stage.world().time();
    const float rate = t > 2 && t < 6 ? -stage.valuef("pour") : 0.0f;
    stage.check(stage.world().set_velocity(bowl_, {}, {0, 0, rate}));
  }
  void after_step(Stage3& stage) override { stage.sample(0, 0, stage.world().time(), stage.at(ring_).pose.position.y); }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    // On the two upper edges of the peg, 0.2 m apart, a circle of 0.62 m.
    const double hangs = 3.0 - sqrt(0.62 * 0.62 - 0.01);
    out.push_back({"height of the hanging ring", "m", "its inner circle on the edges of the peg",
                   stage.at(ring_).pose.position.y, hangs, 0.02});
    out.push_back(
        {"height of the lying ring", "m", "its tube on the floor", stage.at(lying_).pose.position.y, 0.18, 0.01});
  }

 private:
  static geometry::Shape3 mesh(Stage3& stage, const geometry::Triangles& t) {
    return stage.keep(geometry::make_triangle_mesh(t.positions, t.indices));
  }
  BodyId bowl_, ring_, lying_;
};

}  // namespace

std::unique_ptr<Demo> make_moving_meshes() { return std::make_unique<MovingMeshes>(); }

}  // namespace carom::host::demo
