// A pane of glass that cracks where it is hit, at the moment it is hit (chapter 18.8).
#include <algorithm>

#include "apps/host/demos/blast/list.h"
#include "apps/host/demos/blast/shown.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Pane final : public Repeatable<Pane, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "glass-pane";
    d.title = "Glass that cracks where it is hit";
    d.summary = "A ball meets a pane: cracks run out from that very point, in rays and rings, cut in a millisecond.";
    d.group = "Explosions and fracture";
    d.chapter = "18.8";
    d.text =
        "The pane is one box until something strikes it. Then sites are set in rings about the point of impact, each "
        "ring "
        "wider than the last, and the Voronoi cells of the sites become the pieces: small and many at the impact, long "
        "splinters farther out. Bonds hold them to each other and to the frame, and the blow decides which stay.\n\n"
        "  r_{k+1} = growth · r_k";
    d.duration = 4;
    d.camera = {{2.6, 1.9, 3.6}, {0, 1.05, 0}};
    d.ground = 0;
    d.parameters = {
        {"sectors", "Rays", "", "", "pieces in a ring", 5, 24, 1, 11, false},
        {"growth", "Growth of the rings", "", "", "", 1.2, 3, 0.05, 1.55, false},
        {"thickness", "Thickness", "m", "mm", "", 0.004, 0.03, 0.001, 0.01, false},
        {"speed", "Speed of the ball", "m/s", "m/s", "", 2, 40, 0.5, 12, true},
        {"tension", "Strength", "Pa", "MPa", "of the glass in tension", 5e6, 2e8, 0, 4e7, false},
    };
    d.plots = {
        {"Pieces that fell", {"time", "s"}, {"bodies", ""}, {{"bodies"}}},
        {"Speed of the ball", {"time", "s"}, {"speed", "m/s"}, {{"ball"}, {"free flight", Series::Style::points}}},
        {"Pieces about the impact",
         {"distance", "m"},
         {"pieces within", ""},
         {{"pieces", Series::Style::points}, {"1 + rays · ln(r/r₀)/ln(growth)"}}}};
    d.inputs = {{"shoot", "Throw", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.looks_in_materials = true;
    stage.floor(0);
    const float w = 1.0f, h = 0.75f, bar = 0.05f;
    rigid::BodyDef<Dim3> frame;
    frame.type = rigid::BodyType::fixed;
    frame.name = "frame";
    frame.position = middle_;
    const rigid::ShapeDef<Dim3> wood{.material = {.user_id = 0xff000000u | 0x8a6a4a}};
    const auto at = [&](math::Vec3f p) {
      rigid::ShapeDef<Dim3> s = wood;
      s.local.p = p;
      return s;
    };
    stage.add(frame, {{geometry::Box{{w + 2 * bar, bar, bar}}, at({0, h + bar + 0.002f, 0})},
                      {geometry::Box{{w + 2 * bar, bar, bar}}, at({0, -h - bar - 0.002f, 0})},
                      {geometry::Box{{bar, h, bar}}, at({w + bar + 0.002f, 0, 0})},
                      {geometry::Box{{bar, h, bar}}, at({-w - bar - 0.002f, 0, 0})},
                      {geometry::Box{{bar, 0.14f, bar}}, at({w, -h - 0.24f, 0})},
                      {geometry::Box{{bar, 0.14f, bar}}, at({-w, -h - 0.24f, 0})}});
    rigid::BodyDef<Dim3> pane = frame;
    pane.name = "pane";
    half_ = {double(w), double(h), 0.5 * stage.value("thickness")};
    pane_ = stage.add(pane, geometry::Box{math::Vec3f(half_)},
                      {.material = {.friction = 0.4f, .user_id = glass_}, .hit_events = true});
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("shoot") == 0 && !(shots_ == 0 && stage.world().time() >= 0.3)) return;
    rigid::BodyDef<Dim3> body;
    body.name = "ball";
    body.bullet = true;
    body.position = middle_ + Vec3d{0.25 - 0.45 * (shots_ % 3), 0.1 + 0.15 * (shots_ % 2), 2.2};
    body.linear_velocity = {0, 0.9f, -stage.valuef("speed")};
    ball_ = stage.add(body, geometry::Sphere{0.06f}, {.density = 2600, .material = {.user_id = 0xff000000u | red}});
    thrown_ = stage.world().time();
    ++shots_;
  }

  core::Status step(Stage3& stage) override {
    const float dt = float(stage.declaration().dt);
    if (!stage.world().contains(pane_)) return stepper_.step(stage.world(), dt, glass_pieces_);
    // Where the first blow falls is known after the step: then the step is done again with the pane in pieces.
    stage.world().snapshot(before_);
    if (auto s = stage.world().step(dt); !s) return s;
    if (!crack(stage)) return {};
    return stepper_.step(stage.world(), dt, glass_pieces_);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    if (!stage.world().contains(pane_)) show_changes(stage, glass_pieces_);
    stage.sample(0, 0, t, double(glass_pieces_.cluster_count()));
    if (shots_ == 0 || !stage.world().contains(ball_)) return;
    stage.sample(1, 0, t, double(length(stage.at(ball_).linear_velocity)));
    if (stage.world().contains(pane_)) stage.sample(1, 1, t, hypot(stage.value("speed"), 0.9 - 9.81 * (t - thrown_)));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const double mass = 2500 * 8 * half_.x * half_.y * half_.z;
    double sum = 0;
    for (const auto& part : glass_pieces_.definition().parts) sum += part.mass.mass;
    out.push_back({"mass of the pieces", "kg", "ρ V of the pane", sum, mass, 1e-6 * mass});
    out.push_back({"pieces in the outermost whole ring and within", "", "rays in every ring, and the middle", found_,
                   expected_, 0.1 * expected_});
    out.push_back({"pieces that fell", "", "some do", glass_pieces_.cluster_count() > 8 ? 1.0 : 0.0, 1, 0});
  }

 private:
  static constexpr std::uint32_t glass_ = 0x70a8d0e0u;
  static constexpr double first_radius_ = 0.03;  // m

  bool crack(Stage3& stage) {
    for (const auto& hit : stage.world().events().contact_hit) {
      const auto a = stage.keep(stage.world().body_of(hit.shape_a)), b = stage.keep(stage.world().body_of(hit.shape_b));
      if ((!(a == pane_) && !(b == pane_)) || hit.impulse < 0.5f) continue;
      const Vec3d point = hit.point;
      const blast::ConvexCell box(geometry::Bounds3d{-half_, half_});
      Vec3d impact = point - middle_;
      impact.z = 0;
      const auto sites = stage.keep(blast::radial_sites(box,
                                                        {.impact = impact,
                                                         .axis = {0, 0, 1},
                                                         .first_radius = first_radius_,
                                                         .growth = stage.value("growth"),
                                                         .sectors = stage.count("sectors")},
                                                        5));
      auto d = blast::structure_of(stage.keep(blast::fracture_convex(stage.keep(blast::voronoi_pattern(box, sites)),
                                                                     {.skin = 5e-4, .meshes = false})),
                                   2500);
      d.material = blast::bond_material(blast::Substance::glass);
      d.material.tensile_strength = d.material.shear_strength = stage.value("tension");
      d.pose.position = middle_;
      d.shape.material.friction = 0.4f;
      for (auto& part : d.parts) part.user_id = glass_;
      hold(d);
      if (auto restored = stage.world().restore(before_); !restored.ok()) stage.check(restored);
      stage.remove(pane_);
      glass_pieces_ = stage.keep(blast::Structure3::make(stage.world(), d));
      stage.adopt_all();
      count_pieces(stage, d, impact);
      stage.say(format("%.0f pieces about the impact", double(d.parts.size())));
      return true;
    }
    return false;
  }
  /// How many lie within a distance of the impact, as far as whole rings reach, and how many rings make them.
  void count_pieces(Stage3& stage, const blast::StructureDef<Dim3>& d, Vec3d impact) {
    const double edge = math::min(half_.x - math::abs(impact.x), half_.y - math::abs(impact.y));
    const double growth = stage.value("growth");
    const int rays = stage.count("sectors");
    std::vector<double> distances;
    for (const auto& part : d.parts)
      distances.push_back(math::hypot(part.mass.center.x - impact.x, part.mass.center.y - impact.y));
    std::sort(distances.begin(), distances.end());
    for (std::size_t i = 0; i < distances.size() && distances[i] < edge; ++i)
      stage.sample(2, 0, distances[i], double(i + 1));
    int rings = 0;
    for (double radius = first_radius_; radius < edge; radius *= growth, ++rings) {
      stage.sample(2, 1, radius, 1 + rays * rings);
      expected_ = 1 + rays * rings;
      found_ = double(std::lower_bound(distances.begin(), distances.end(), radius) - distances.begin());
    }
  }
  /// Pieces at the border are held by putty.
  void hold(blast::StructureDef<Dim3>& d) const {
    for (std::uint32_t i = 0; i < d.parts.size(); ++i)
      for (int side = 0; side < 4; ++side) {
        const int axis = side / 2;
        const double sign = side % 2 == 0 ? 1 : -1;
        double low = 1e30, high = -1e30;
        bool touches = false;
        for (const Vec3f& v : d.parts[i].shapes[0].hull->vertices) {
          const Vec3d p = Vec3d(v) + d.parts[i].mass.center;
          if (sign * p[axis] < half_[axis] - 0.004) continue;
          touches = true;
          low = min(low, p[1 - axis]), high = max(high, p[1 - axis]);
        }
        if (!touches || !(high > low + 1e-4)) continue;
        blast::StructureDef<Dim3>::Joint joint;
        joint.a = i, joint.b = blast::ground, joint.area = (high - low) * 2 * half_.z, joint.strength = 0.6f;
        joint.center[axis] = sign * half_[axis], joint.center[1 - axis] = 0.5 * (low + high);
        joint.normal[axis] = sign;
        d.bonds.push_back(joint);
      }
  }

  blast::Structure3 glass_pieces_;
  blast::FractureStepper3 stepper_;
  rigid::Snapshot3 before_;
  rigid::BodyId pane_, ball_;
  Vec3d half_{}, middle_{0, 1.05, 0};
  int shots_ = 0;
  double thrown_ = 0;  // s
  double found_ = 0, expected_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_pane() { return std::make_unique<Pane>(); }

}  // namespace carom::host::demo
