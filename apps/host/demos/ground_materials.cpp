// One mesh, several materials: its triangles say how what lies on them slides, rolls, bounces and rides.
#include "apps/host/demos/demos.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::host::demo {
namespace {

using math::Vec3f;
using rigid::Dim3;

constexpr int asphalt = 0, ice = 1, belt = 2, rubber = 3, sandy = 4;

class GroundMaterials final : public Repeatable<GroundMaterials, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "ground-materials";
    d.title = "Materials of triangles";
    d.summary = "One mesh with asphalt, ice, a belt, rubber and sand: every triangle has its own friction and bounce.";
    d.group = "Surfaces";
    d.chapter = "3.3";
    d.text =
        "A road of one mesh. Crates start at the same speed on asphalt, on ice and across both; each slows down as "
        "the triangles under it say. With Coulomb's friction that is\n\n"
        "  a = μ g      s = v²/(2 μ g)\n\n"
        "A belt carries, rubber throws balls up again by e² of their height, and sand brakes what rolls by its rolling "
        "resistance c: for a ball a = 5/7 c g.";
    d.duration = 6;
    d.camera.position = {0, 13, 17};
    d.camera.target = {0, 0, 0};
    d.parameters = {
        {"speed", "Speed of the crates", "m/s", "m/s", "at the start", 1, 9, 0.1, 6, false},
        {"asphalt", "Friction of asphalt", "", "", "", 0.1, 1.2, 0, 0.6, false},
        {"ice", "Friction of ice", "", "", "", 0, 0.2, 0, 0.05, false},
        {"belt", "Speed of the belt", "m/s", "m/s", "", -3, 3, 0.1, 1.2, true},
    };
    d.plots = {
        {"Crates", {"time", "s"}, {"speed", "m/s"}, {{"asphalt"}, {"ice"}, {"v − μ g t", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.looks_in_materials = true;
    rigid::ShapeDef<Dim3> road;
    // Of a pair the geometric mean counts: crates have 1, so that the square gives what the slider says.
    const auto surface = [](float friction, std::uint32_t color) {
      rigid::SurfaceMaterial<Dim3> s;
      s.material.friction = friction * friction;
      s.material.user_id = 0xff000000u | color;
      return s;
    };
    road.surfaces = {surface(stage.valuef("asphalt"), 0x565f69), surface(stage.valuef("ice"), 0xa9d8ea),
                     surface(0.7f, 0xb98b5e), surface(0.7f, 0x8a4a5c), surface(0.7f, 0xd9c27e)};
    road.surfaces[belt].surface_velocity = {0, 0, stage.valuef("belt")};
    road.surfaces[rubber].material.restitution = 0.8f;
    road.surfaces[sandy].material.rolling_resistance = 0.04f;
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = "road";
    ground_ = stage.add(body, mesh(stage), road);

    const float v = stage.valuef("speed");
    on_asphalt_ = crate(stage, {-11, 0.35, -3}, {v, 0, 0}, blue);
    on_ice_ = crate(stage, {-11, 0.35, -1}, {v, 0, 0}, teal);
    crate(stage, {-11, 0.35, 1}, {v, 0, 0}, orange);
    crate(stage, {6.4, 0.35, 3.2}, {}, gold);
    crate(stage, {8.1, 0.35, 4.1}, {}, violet);
    bouncing_ = ball(stage, {-9, 3.3, 4}, {}, green);
    ball(stage, {-7, 2.3, 3.4}, {}, red);
    rolling_ = ball(stage, {-3.8, 0.3, 4}, {3, 0, 0}, gold);
    const double g = 9.80665;
    for (double t = 0; t <= 3; t += 0.25) {
      stage.sample(0, 2, t, max(0.0, double(v) - stage.value("asphalt") * g * t));
      stage.sample(0, 2, t, double(v) - stage.value("ice") * g * t);
    }
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const double a = double(stage.at(on_asphalt_).linear_velocity.x), b = double(stage.at(on_ice_).linear_velocity.x);
    stage.sample(0, 0, t, a);
    stage.sample(0, 1, t, b);
    if (t <= 0.25 + 1e-9) asphalt_ = a, ice_ = b;
    if (t <= 0.75 + 1e-9) slowed_[0] = asphalt_ - a, slowed_[1] = ice_ - b;
    if (t > 0.9 && t < 2.2) highest_ = max(highest_, stage.at(bouncing_).pose.position.y - 0.3);
    if (t <= 0.5 + 1e-9) early_ = double(stage.at(rolling_).linear_velocity.x);
    if (t <= 1.5 + 1e-9) late_ = double(stage.at(rolling_).linear_velocity.x);
  }

  void changed(Stage3& stage, std::string_view) override {
    std::vector<rigid::ShapeId> shapes;
    stage.world().shapes(ground_, shapes);
    rigid::SurfaceMaterial<Dim3> surface = stage.keep(stage.world().shape_definition(shapes.front())).surfaces[belt];
    surface.surface_velocity = {0, 0, stage.valuef("belt")};
    stage.check(stage.world().set_surface(shapes.front(), belt, surface));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const double g = 9.80665;
    out.push_back({"slowing in half a second on asphalt", "m/s", "μ g t", slowed_[0], 0.6 * g * 0.5, 0.03});
    out.push_back({"slowing in half a second on ice", "m/s", "μ g t", slowed_[1], 0.05 * g * 0.5, 0.003});
    out.push_back({"height after a bounce on rubber", "m", "e² h", highest_, 3 * 0.64, 0.04});
    out.push_back({"slowing in a second on sand", "m/s", "5/7 c g t", early_ - late_, 5.0 / 7 * 0.04 * g, 0.02});
  }

 private:
  /// 24 m by 10 m in squares of 1 m.
  static geometry::Shape3 mesh(Stage3& stage) {
    constexpr int columns = 24, rows = 10;
    std::vector<Vec3f> vertices;
    std::vector<std::uint32_t> indices;
    std::vector<std::uint8_t> materials;
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= columns; ++i) vertices.push_back({float(i - 12), 0, float(j - 5)});
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const auto a = std::uint32_t(j * (columns + 1) + i), b = a + 1, c = a + columns + 1, e = c + 1;
        indices.insert(indices.end(), {a, c, e, a, e, b});
        int m = asphalt;
        if (j == 3 || j == 4) m = ice;
        if (j == 5 || j == 6) m = i % 4 < 2 ? asphalt : ice;
        if (j > 6) m = i < 7 ? rubber : i < 15 ? sandy : belt;
        materials.insert(materials.end(), 2, std::uint8_t(m));
      }
    return stage.keep(geometry::make_triangle_mesh(std::move(vertices), std::move(indices), std::move(materials)));
  }

  rigid::BodyId crate(Stage3& stage, Vec3d at, Vec3f velocity, std::uint32_t color) {
    rigid::BodyDef<Dim3> body;
    body.name = "crate";
    body.position = at;
    body.linear_velocity = velocity;
    rigid::ShapeDef<Dim3> shape;
    shape.material.friction = 1;
    shape.material.user_id = 0xff000000u | color;
    shape.density = 300;
    return stage.add(body, geometry::Box{{0.5f, 0.35f, 0.35f}}, shape, color);
  }
  rigid::BodyId ball(Stage3& stage, Vec3d at, Vec3f velocity, std::uint32_t color) {
    rigid::BodyDef<Dim3> body;
    body.name = "ball";
    body.position = at;
    body.linear_velocity = velocity;
    body.angular_velocity = {0, 0, -velocity.x / 0.3f};
    rigid::ShapeDef<Dim3> shape;
    shape.material.user_id = 0xff000000u | color;
    return stage.add(body, geometry::Sphere{0.3f}, shape, color);
  }

  rigid::BodyId ground_, on_asphalt_, on_ice_, bouncing_, rolling_;
  double asphalt_ = 0, ice_ = 0, slowed_[2] = {0, 0}, highest_ = 0, early_ = 0, late_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_ground_materials() { return std::make_unique<GroundMaterials>(); }

}  // namespace carom::host::demo
