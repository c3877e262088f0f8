// A wind tunnel: pendulums of a sphere, a cylinder and a disc in a wind that grows. In the drag crisis the sphere
// swings back although the wind grows.
#include "apps/host/demos/demos.h"
#include "apps/host/demos/environment/environment_demos.h"
#include "carom/environment/environment.h"
#include "carom/forces/drag.h"
#include "carom/forces/drag_law.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class DragCrisis final : public Repeatable<DragCrisis, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "drag_crisis";
    d.title = "Wind tunnel and drag crisis";
    d.summary = "A sphere, a cylinder and a disc hang in a wind that grows; at one speed the sphere swings back.";
    d.group = "Wind, water and fields";
    d.chapter = "3, 6";
    d.text =
        "Each body hangs on a rod. Its angle tells its drag,\n\n"
        "  tan θ = F_D/(m g),  F_D = ½ ρ V² C_d(Re) A,  Re = ρ V d/μ\n\n"
        "Up to Re ≈ 2·10⁵ the drag coefficient of sphere and cylinder hardly changes. Then the boundary layer becomes "
        "turbulent, stays longer at the wall, and the wake shrinks: C_d falls to a third, and the drag falls though "
        "the "
        "wind grows. Golf balls have dimples to get there sooner. The disc has sharp edges, where the flow leaves it "
        "at "
        "any speed: no crisis.\n\n"
        "Curves: Morrison's formula for the sphere, Sucker and Brauer with Schewe's measurements for the cylinder, "
        "1.17 "
        "for the disc. The points are what the angles say, all over log₁₀ Re.";
    d.dt = 1.0 / 120;
    d.duration = 40;
    d.camera = {{2.7, 0.3, 2.9}, {0.15, -0.75, 0}};
    d.parameters = {
        {"speed", "Speed of the wind at the end", "m/s", "m/s", "grows evenly from nothing", 5, 70, 0, 45, false},
        {"ramp", "Time until then", "s", "s", "", 10, 120, 0, 40, false},
        {"diameter", "Diameter", "m", "cm", "of all three", 0.05, 0.5, 0, 0.2, false},
        {"mass", "Mass", "kg", "kg", "of all three", 0.05, 3, 0, 0.35, false},
        {"altitude", "Altitude", "m", "m", "thinner air: less drag, and the crisis later", 0, 10000, 0, 0, false},
    };
    Series sphere{"sphere: Morrison"}, cylinder{"cylinder: Sucker–Brauer, Schewe"}, disc{"disc: Clift, Hoerner"};
    for (double x = 3; x <= 6; x += 0.05) {
      const double re = math::pow(10.0, x);
      sphere.points.push_back({x, forces::sphere_drag(re, 0)});
      cylinder.points.push_back({x, forces::cylinder_drag(re)});
      disc.points.push_back({x, forces::disc_drag(re)});
    }
    sphere.color = 0xe8833a, cylinder.color = 0x3b7dd8, disc.color = 0x3fa66b;
    Series a{"sphere", Series::Style::points}, b{"cylinder", Series::Style::points}, c{"disc", Series::Style::points};
    a.color = 0xe8833a, b.color = 0x3b7dd8, c.color = 0x3fa66b;
    d.plots = {{"Drag coefficient", {"log₁₀ Re", ""}, {"C_d", ""}, {sphere, cylinder, disc, a, b, c}},
               {"Angle of the pendulums", {"wind", "m/s"}, {"angle", "deg"}, {{"sphere"}, {"cylinder"}, {"disc"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.allow_sleep = false;
    stage.start(world);
    rigid::BodyDef<Dim3> beam;
    beam.type = rigid::BodyType::fixed;
    beam.name = "beam";
    const BodyId top = stage.add(beam, geometry::Box{{0.05f, 0.03f, 1.1f}}, {}, steel);
    const float d = stage.valuef("diameter"), r = 0.5f * d;
    const geometry::Shape3 shapes[3] = {geometry::Sphere{r}, geometry::Cylinder{r, r}, geometry::Cylinder{0.01f, r}};
    constexpr const char* names[3] = {"sphere", "cylinder", "disc"};
    constexpr std::uint32_t colors[3] = {orange, blue, green};
    for (int i = 0; i < 3; ++i) {
      rigid::BodyDef<Dim3> def;
      def.name = names[i];
      const double z = 0.75 * (i - 1);
      def.position = {0, -length_, z};
      def.locks.rotation_x = def.locks.rotation_y = def.locks.rotation_z = true;  // the disc goes on facing the wind
      rigid::ShapeDef<Dim3> form;
      // The cylinder lies across the wind, the disc faces it.
      if (i == 1) form.local.q = {0.70710678f, 0.70710678f, 0, 0};
      if (i == 2) form.local.q = {0.70710678f, 0, 0, 0.70710678f};
      form.density = float(stage.value("mass") / geometry::mass_properties(shapes[i], 1.0).mass);
      bodies_[i] = stage.add(def, shapes[i], form, colors[i]);
      rigid::DistanceJointDef<Dim3> rod;
      rod.body_a = top;
      rod.body_b = bodies_[i];
      rod.frame_a.p = {0, 0, float(z)};
      rod.length = float(length_);
      stage.keep(stage.world().create_joint(rod));
      rigid::BodyDrag<Dim3> drag;
      drag.body = bodies_[i];
      drag.law.kind = i == 0   ? forces::DragLaw::Kind::sphere
                      : i == 1 ? forces::DragLaw::Kind::cylinder
                               : forces::DragLaw::Kind::disc;
      drag.diameter = double(d);
      drag.area = area(i, double(d));
      stage.keep(stage.world().add_effector(drag));
    }
    environment::Environment::Definition around;
    around.altitude = stage.value("altitude");
    around_ =
        std::make_shared<const environment::Environment>(stage.keep(environment::Environment::make(std::move(around))));
    stage.keep(stage.world().add_effector(rigid::Surroundings<Dim3>{around_}));
    wind_ = stage.keep(stage.world().add_effector(rigid::Wind<Dim3>{}));
  }

  void before_step(Stage3& stage) override {
    const double share = min(stage.world().time() / stage.value("ramp"), 1.0);
    speed_ = stage.value("speed") * share;
    stage.check(stage.world().set_effector(wind_, rigid::Wind<Dim3>{{float(speed_), 0, 0}}));
  }

  void after_step(Stage3& stage) override {
    const double d = stage.value("diameter");
    const environment::AirState air = around_->air({});
    const double re = forces::reynolds_number(air.density, speed_, d, air.viscosity);
    ++steps_;
    for (int i = 0; i < 3; ++i) {
      const auto s = stage.at(bodies_[i]);
      const Vec3d p = s.center_of_mass;
      const double angle = math::atan2(p.x, -p.y);
      stage.line({0, 0, p.z}, p, pen(dark));
      if (steps_ % 6 == 0) stage.sample(1, i, speed_, angle * 180 / math::pi);
      // Where it hangs still the angle is the drag's.
      const double c = s.mass * 9.80665 * math::tan(angle) / (0.5 * air.density * speed_ * speed_ * area(i, d));
      if (steps_ % 60 == 0 && stage.world().time() > 5 && angle < 1.4) stage.sample(0, 3 + i, math::log10(re), c);
      if (i == 0) {
        if (re < 1.5e5) before_ = c;
        if (re < 5e5) after_ = c;
        if (re < 2.2e5) widest_ = max(widest_, angle);
        if (re > 3e5 && re < 3.4e5) swung_back_ = angle;
      }
      if (i == 2 && re < 1e5) disc_ = c;
    }
    const double reach = 0.02 * speed_;
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 3; ++k) {
        const Vec3d from{-1.6, -1.5 + 0.4 * row, 0.75 * (k - 1)};
        stage.line(from, from + Vec3d{reach, 0, 0}, pen(teal, 0xa0));
      }
    stage.say(format("wind %.1f m/s, Re %.2e", speed_, re));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back(
        {"C_d of the sphere at Re 1.5e5", "", "Morrison's curve", before_, forces::sphere_drag(1.5e5, 0), 0.04});
    out.push_back({"C_d of the sphere at Re 5e5", "", "Morrison's curve", after_, forces::sphere_drag(5e5, 0), 0.03});
    out.push_back({"C_d of the disc at Re 1e5", "", "Hoerner", disc_, 1.17, 0.06});
    out.push_back({"the sphere swings back in the crisis", "", "drag falls though the wind grows",
                   swung_back_ < 0.85 * widest_ ? 1.0 : 0.0, 1, 0});
  }

 private:
  static constexpr double length_ = 1.1;
  static double area(int i, double d) { return i == 1 ? d * d : 0.25 * math::pi * d * d; }

  std::shared_ptr<const environment::Environment> around_;
  BodyId bodies_[3];
  rigid::EffectorId wind_;
  double speed_ = 0, before_ = 0, after_ = 0, disc_ = 0, widest_ = 0, swung_back_ = 9;
  int steps_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_drag_crisis() { return std::make_unique<DragCrisis>(); }

}  // namespace carom::host::demo
