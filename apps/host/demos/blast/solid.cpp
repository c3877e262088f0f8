// Concave meshes that break: a vase, a ring, a star, a bowl, drawn as the pieces that were really cut (chapter 18.8).
#include "apps/host/demos/blast/list.h"
#include "apps/host/demos/blast/shown.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/math/elementary.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Solid final : public Repeatable<Solid, Demo3> {
 public:
  explicit Solid(bool vase = false) : vase_(vase) {}
  std::unique_ptr<Demo> again() const override { return std::make_unique<Solid>(vase_); }

  Declaration declaration() const override {
    Declaration d;
    d.id = vase_ ? "vase" : "fracture-mesh";
    d.title = vase_ ? "A vase falls" : "A mesh of your own breaks";
    d.summary = vase_ ? "A hollow, concave mesh is cut into shards that hold together until it lands."
                      : "A star or a ring of your making, cut into cells, opened by a slider and then let fall. Drop "
                        "an OBJ, STL or "
                        "glTF file on the page to break a mesh of your own.";
    d.group = "Explosions and fracture";
    d.chapter = "18.8";
    d.text =
        "A closed mesh is cut by the planes of each cell in turn. A vertex is on one side of a plane or the other, "
        "never "
        "on it, so that every piece is closed again whatever the rounding; the cut is filled with triangles that have "
        "texture coordinates of their own. Masses, centres and inertia come from the pieces' surfaces:\n\n"
        "  Σ Vᵢ = V to 10⁻¹² or so,   V − E + F = 2 for each piece that is like a ball\n\n"
        "For collisions each piece has hulls that stay within its cell, a millimetre back from the cut, so that "
        "nothing "
        "overlaps at the start. Pieces fly off with v + ω × r of the whole.";
    d.dt = 1.0 / 120;
    d.duration = vase_ ? 3 : 4;
    d.camera = vase_ ? Camera{{1.3, 1.15, 2.0}, {0, 0.62, 0}} : Camera{{2.6, 2.2, 3.6}, {0, 0.8, 0}};
    d.ground = 0;
    d.parameters = {
        {"pieces", "Cells", "", "", "", 5, 150, 1, vase_ ? 70.0 : 60.0, false},
        {"seed", "Seed", "", "", "", 1, 100, 1, 3, false},
        {"height", "Height of fall", "m", "m", "", 0.01, 3, 0.01, vase_ ? 0.9 : 0.3, false},
        {"tension", "Strength", "Pa", "MPa", "of the bonds in tension", 1e4, 2e7, 0, vase_ ? 6e5 : 1e5, false},
    };
    if (vase_) {
      d.parameters.push_back({"belly", "Belly", "m", "cm", "widest radius", 0.08, 0.3, 0.01, 0.17, false});
      d.parameters.push_back({"neck", "Neck", "m", "cm", "narrowest radius", 0.03, 0.15, 0.01, 0.06, false});
      d.parameters.push_back({"wall", "Thickness", "m", "mm", "of the wall", 0.006, 0.03, 0.001, 0.014, false});
    } else {
      d.parameters.push_back(choice("form", "Form", "", {"star", "ring", "ball"}));
      d.parameters.push_back({"points", "Points", "", "", "of the star", 3, 12, 1, 5, false});
      d.parameters.push_back({"deep", "How deep", "", "", "inner radius by outer", 0.2, 0.9, 0.05, 0.45, false});
      d.parameters.push_back(
          {"open", "Open", "m", "cm", "before it falls, pieces are moved apart so far", 0, 0.6, 0.01, 0.25, true});
    }
    d.plots = {{"Bodies", {"time", "s"}, {"bodies", ""}, {{"bodies"}, {"broken bonds"}}},
               {"Height of the middle of all pieces",
                {"time", "s"},
                {"height", "m"},
                {{"pieces"}, {"y₀ − ½ g t²", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({.contact_push_speed = 1.0f});  // thin shards that met deeply part without a jump
    stage.looks_in_materials = true;
    stage.floor(0, {.friction = 0.6f});
    const geometry::Triangles mesh = vase_ ? vase(stage) : form(stage);
    const std::vector<Vec3d> vertices(mesh.positions.begin(), mesh.positions.end());
    const auto whole = stage.keep(geometry::mesh_mass_properties(vertices, mesh.indices, 1));
    volume_ = whole.volume;
    const blast::ConvexCell box = blast::container_of(vertices);
    const auto sites = blast::even_sites(box, stage.count("pieces"), 1, std::uint64_t(stage.count("seed")));
    const auto fracture =
        stage.keep(blast::fracture_mesh(vertices, mesh.indices, stage.keep(blast::voronoi_pattern(box, sites))));
    for (const blast::Piece& piece : fracture.pieces) {
      pieces_volume_ += piece.mass.mass;
      closed_ = closed_ && blast::is_watertight(piece);
    }
    auto d = blast::structure_of(fracture, blast::density_of(blast::Substance::ceramic));
    d.material = blast::bond_material(blast::Substance::ceramic);
    d.material.tensile_strength = d.material.shear_strength = stage.value("tension");
    d.pose.position = {0, stage.value("height") - double(whole.bounds.low.y), 0};
    if (vase_) d.pose.rotation = from_axis_angle(Vec3f{0.6f, 0, 0.8f}, 0.35f);
    d.pose.position.y += vase_ ? 0.06 : 0;
    d.shape.material.friction = 0.5f;
    // Collisions are between hulls; what is shown are the pieces themselves.
    for (auto& part : d.parts) part.user_id = 0x01000000u;
    solid_ = stage.keep(blast::Structure3::make(stage.world(), d));
    stage.adopt_all();
    surfaces(stage, fracture);
    draw(stage);
    stage.say(format("%.0f triangles became %.0f pieces and %.0f bonds", double(mesh.indices.size()) / 3,
                     double(fracture.pieces.size()), double(fracture.bonds.size())));
  }

  core::Status step(Stage3& stage) override {
    // Held while it is shown opened.
    if (!vase_ && stage.world().time() < hold_)
      for (const rigid::BodyId body : bodies(stage)) stage.check(stage.world().set_velocity(body, {}, {}));
    if (!vase_ && stage.world().time() < hold_) stage.check(stage.world().set_gravity({}));
    if (!vase_ && stage.world().time() >= hold_) stage.check(stage.world().set_gravity(rigid::default_gravity<Dim3>()));
    return stage.world().step(float(stage.declaration().dt));
  }

  void after_step(Stage3& stage) override {
    stage.check(solid_.after_step(stage.world(), float(stage.declaration().dt)));
    show_changes(stage, solid_);
    draw(stage);
    stage.sample(0, 0, stage.world().time(), double(solid_.cluster_count()));
    stage.sample(0, 1, stage.world().time(), double(solid_.broken()));
    // Whatever breaks, the middle of all falls freely until something lands.
    const double t = stage.world().time(), fallen = 0.5 * 9.81 * math::square(max(t - (vase_ ? 0 : hold_), 0.0));
    const double middle = middle_height(stage);
    if (t <= hold_) start_ = middle + (vase_ ? fallen : 0);
    stage.sample(1, 0, t, middle);
    if (fallen < stage.value("height")) stage.sample(1, 1, t, start_ - fallen);
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back(
        {"volume of the pieces by that of the mesh", "", "cutting loses nothing", pieces_volume_ / volume_, 1, 1e-9});
    out.push_back({"all pieces are closed", "", "one triangle on each side of every edge", closed_ ? 1.0 : 0.0, 1, 0});
    out.push_back({"it broke", "", "in several pieces", solid_.cluster_count() > 3 ? 1.0 : 0.0, 1, 0});
  }

 private:
  geometry::Triangles vase(Stage3& stage) {
    const double belly = stage.value("belly"), neck = min(stage.value("neck"), belly - 0.01),
                 wall = min(stage.value("wall"), 0.6 * neck);
    std::vector<Vec2f> profile;
    const auto radius = [&](double y) {  // foot, belly, neck, lip
      const double up = y / 0.5;
      const double bulge =
          up < 0.4 ? 0.5 - 0.5 * cos(pi * up / 0.4) : (up < 0.85 ? 0.5 + 0.5 * cos(pi * (up - 0.4) / 0.45) : 0.0);
      const double foot = up < 0.4 ? 0.55 * belly : neck,
                   lip = up > 0.85 ? 0.25 * neck * square((up - 0.85) / 0.15) : 0;
      return foot + (belly - foot) * bulge + lip;
    };
    constexpr int n = 14;
    for (int i = 0; i <= n; ++i) profile.push_back({float(radius(0.5 * i / n)), float(0.5 * i / n)});
    for (int i = n; i >= 1; --i) profile.push_back({float(radius(0.5 * i / n) - wall), float(0.5 * i / n)});
    profile.push_back({float(radius(0) - wall), float(wall)});
    return geometry::make_lathe_mesh(profile, 30);
  }
  geometry::Triangles form(Stage3& stage) {
    const int kind = stage.count("form");
    if (kind == 1) return geometry::make_torus_mesh(0.6f, 0.22f, 36, 16);
    if (kind == 2) return geometry::make_sphere_mesh(0.6f, 32, 16);
    // A star with a thickness: an outline, twice, and the sides between.
    const int points = stage.count("points"), corners = 2 * points;
    geometry::Triangles t;
    for (const float z : {-0.18f, 0.18f}) {
      t.positions.push_back({0, 0, z});
      for (int i = 0; i < corners; ++i) {
        const double r = i % 2 == 0 ? 0.75 : 0.75 * stage.value("deep"), a = pi * i / points + 0.5 * pi;
        t.positions.push_back({float(r * cos(a)), float(r * sin(a)), z});
      }
    }
    const std::uint32_t top = std::uint32_t(corners + 1);
    for (int i = 0; i < corners; ++i) {
      const std::uint32_t a = std::uint32_t(1 + i), b = std::uint32_t(1 + (i + 1) % corners);
      t.indices.insert(t.indices.end(), {0, b, a, top, top + a, top + b, a, b, top + b, a, top + b, top + a});
    }
    return t;
  }

  double middle_height(Stage3& stage) {
    double mass = 0, moment = 0;
    for (std::uint32_t p = 0; p < solid_.part_count(); ++p) {
      if (!stage.world().contains(solid_.body_of(p))) continue;
      const double part = solid_.definition().parts[p].mass.mass;
      mass += part;
      moment += part * stage.at(solid_.body_of(p)).center_of_mass.y;
    }
    return moment / mass;
  }
  std::vector<rigid::BodyId> bodies(Stage3& stage) {
    std::vector<rigid::BodyId> found;
    for (std::uint32_t p = 0; p < solid_.part_count(); ++p)
      if (stage.world().contains(solid_.body_of(p))) found.push_back(solid_.body_of(p));
    return found;
  }

  /// Three corners a triangle, so that edges stay sharp.
  void surfaces(Stage3& stage, const blast::Fracture& fracture) {
    std::vector<std::uint32_t> triangles[2];
    std::uint32_t part = 0;
    for (const blast::Piece& piece : fracture.pieces) {
      if (piece.hulls.empty()) continue;
      for (std::size_t t = 0; t < piece.sources.size(); ++t) {
        const int side = piece.sources[t] >= 0 ? 0 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
          triangles[side].push_back(std::uint32_t(corners_[side].size()));
          corners_[side].push_back({part, Vec3f(piece.vertices[piece.triangles[3 * t + k]] - piece.mass.center)});
        }
      }
      ++part;
    }
    const std::uint32_t skin = vase_ ? blue : teal;
    for (int side = 0; side < 2; ++side)
      surface_[side] = stage.add_surface(triangles[side], pen(side == 0 ? skin : sand));
  }
  void draw(Stage3& stage) {
    const double t = stage.world().time();
    const double open = vase_ || t > hold_ ? 0 : stage.value("open") * (0.5 - 0.5 * cos(2 * pi * min(t / hold_, 1.0)));
    for (int side = 0; side < 2; ++side) {
      std::vector<Vec3f> places;
      places.reserve(corners_[side].size());
      std::uint32_t last = blast::ground;
      math::Pose3 pose;
      Vec3f shift;
      for (const Corner& corner : corners_[side]) {
        if (corner.part != last) {
          last = corner.part;
          const auto& d = solid_.definition();
          pose = stage.at(solid_.body_of(last)).pose;
          const Vec3d from_origin = d.parts[last].mass.center - solid_.origin_of(last);
          shift = Vec3f(from_origin) + float(2 * open) * Vec3f(d.parts[last].mass.center);
        }
        places.push_back(Vec3f(world_point(pose, corner.place + shift)));
      }
      stage.set_surface(surface_[side], places);
    }
  }

  struct Corner {
    std::uint32_t part;
    Vec3f place;  // from the part's centre
  };
  static constexpr double hold_ = 1.6;
  bool vase_;
  blast::Structure3 solid_;
  std::vector<Corner> corners_[2];
  int surface_[2] = {0, 0};
  double volume_ = 1, pieces_volume_ = 0;
  double start_ = 0;  // m, of the middle of all pieces
  bool closed_ = true;
};

}  // namespace

std::unique_ptr<Demo> make_vase() { return std::make_unique<Solid>(true); }
std::unique_ptr<Demo> make_fracture_mesh() { return std::make_unique<Solid>(false); }

}  // namespace carom::host::demo
