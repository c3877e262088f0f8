// Concave meshes cut into convex parts: bodies that catch in each other.
#include "carom/geometry/decomposition.h"
#include "apps/host/demos/demos.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Decomposition final : public Repeatable<Decomposition, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "decomposition";
    d.title = "Convex decomposition";
    d.summary = "Rings and bowls of one mesh each become a few convex parts, and fall over a peg and into each other.";
    d.group = "Shapes";
    d.text =
        "A closed mesh is filled with cells and cut along planes, the part with the most air in its hull first, until "
        "each "
        "part is nearly convex. The parts meet everything, so that rings hang in rings.\n\n"
        "  concavity of a part = (volume of its hull − its volume) / volume of the mesh";
    d.duration = 6;
    d.camera.position = {0, 5, 11};
    d.camera.target = {0, 1.6, 0};
    d.parameters = {
        {"parts", "Most parts", "", "", "of one body", 2, 32, 1, 16, false},
        {"rings", "Rings", "", "", "", 1, 10, 1, 6, false},
    };
    d.plots = {{"The ring on the peg", {"time", "s"}, {"height", "m"}, {{"centre"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    stage.looks_in_materials = true;
    geometry::DecompositionOptions options;
    options.max_parts = stage.count("parts");
    const geometry::Triangles ring = geometry::make_torus_mesh(0.7f, 0.2f, 32, 14);
    const auto parts = stage.keep(geometry::decompose_convex(ring.positions, ring.indices, options));
    const std::vector<Vec3d> corners(ring.positions.begin(), ring.positions.end());
    mesh_volume_ = stage.keep(geometry::mesh_mass_properties(corners, ring.indices, 1)).volume;
    for (const auto& part : parts) parts_volume_ += geometry::mass_properties(part, 1).mass;
    rigid::BodyDef<Dim3> peg;
    peg.type = rigid::BodyType::fixed;
    peg.name = "peg";
    peg.position = {-2, 2.6, 0};
    stage.add(peg, geometry::Box{{0.08f, 0.08f, 1}}, {.material = {.user_id = 0xff000000u | dark}});
    const int rings = stage.count("rings");
    for (int i = 0; i < rings; ++i) {
      rigid::BodyDef<Dim3> body;
      body.name = "ring";
      body.position = i == 0 ? Vec3d{-2, 2.2, 0} : Vec3d{1.2 + 0.3 * (i % 2), 0.5 + 0.55 * i, 0.2 * (i % 3)};
      if (i > 0) body.rotation = from_axis_angle(Vec3f{1, 0, 0}, float(pi) / 2 + 0.25f * float(i));
      body.angular_damping = 0.3f;
      const BodyId id = add(stage, body, parts, i);
      if (i == 0) hung_ = id;
    }
    // A bowl, a surface of revolution with a thick wall.
    std::vector<Vec2f> profile;
    for (int i = 0; i <= 12; ++i) {
      const double a = 1.4 * (i <= 6 ? i : 12 - i) / 6, r = i <= 6 ? 0.8 : 0.6;
      profile.push_back({float(r * sin(a)), float(-r * cos(a))});
    }
    const geometry::Triangles bowl = geometry::make_lathe_mesh(profile, 24);
    options.resolution = 40;
    const auto bowl_parts = stage.keep(geometry::decompose_convex(bowl.positions, bowl.indices, options));
    rigid::BodyDef<Dim3> body;
    body.name = "bowl";
    body.position = {-1.9, 0.85, 2.6};  // out of the rings' way
    add(stage, body, bowl_parts, 3);
    rigid::BodyDef<Dim3> ball;
    ball.name = "ball";
    ball.position = {-1.9, 1.4, 2.6};
    ball_ = stage.add(ball, geometry::Sphere{0.15f}, {.material = {.user_id = 0xff000000u | red}});
  }

  void after_step(Stage3& stage) override { stage.sample(0, 0, stage.world().time(), stage.at(hung_).pose.position.y); }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"volume of the parts over that of the ring", "", "nearly convex parts", parts_volume_ / mesh_volume_,
                   1, 0.25});
    // The inner circle of 0.5 m on the peg's edges, parts being as coarse as their cells.
    out.push_back({"height of the hanging ring", "m", "its inner side on the peg", stage.at(hung_).pose.position.y,
                   2.68 - 0.49, 0.08});
    out.push_back(
        {"height of the ball", "m", "in the bowl, above its bottom", stage.at(ball_).pose.position.y, 0.4, 0.2});
  }

 private:
  /// Every part in a shade of its own.
  BodyId add(Stage3& stage, const rigid::BodyDef<Dim3>& body,
             const std::vector<std::shared_ptr<const geometry::Hull>>& parts, int shade) {
    constexpr std::uint32_t colors[] = {teal, orange, blue, gold, green, violet};
    const BodyId id = stage.add(body, {});
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rigid::ShapeDef<Dim3> shape;
      shape.density = 600;
      shape.material.user_id = 0xff000000u | colors[(i + std::size_t(shade)) % 6];
      stage.keep(stage.world().add_shape(id, parts[i], shape));
    }
    return id;
  }

  BodyId hung_, ball_;
  double mesh_volume_ = 1, parts_volume_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_decomposition() { return std::make_unique<Decomposition>(); }

}  // namespace carom::host::demo
