// Fields paint with what moves in them: a round planet, an oblate one, a magnetic field with and without an electric
// one, a vortex.
#include "apps/host/demos/demos.h"
#include "apps/host/demos/environment/environment_demos.h"
#include "carom/environment/environment.h"
#include "carom/forces/fields.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class OrbitPainter final : public Repeatable<OrbitPainter, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "orbit_painter";
    d.title = "Orbit painter";
    d.summary =
        "Round and oblate planets, magnetic and electric fields and a vortex, each painted by what moves in it.";
    d.group = "Wind, water and fields";
    d.chapter = "3";
    d.text =
        "Left, a round planet: a = −GM r/r³ gives the same ellipse for ever, with the period of Kepler\n\n"
        "  T = 2π √(a³/GM)\n\n"
        "Beside it a flattened one. Its second zonal harmonic J₂ turns the plane of the orbit at\n\n"
        "  dΩ/dt = −(3/2) J₂ (R/p)² n cos i\n\n"
        "(here J₂ is thirty times the Earth's; satellites use it to follow the Sun). Then charges in fields, "
        "F = q (E + v × B): in a magnetic field alone they go round with r = m v/(q B) at any speed in the same time "
        "2π m/(q B); with an electric field across it they drift at E/B, whatever their charge. Right, a vortex "
        "carries "
        "what it meets round and lets it out.";
    d.dt = 1.0 / 120;
    d.duration = 24;
    d.camera = {.position = {3, 17, 22}, .target = {3, 0, 0.3}, .width = 36};
    d.parameters = {
        {"eccentricity", "Eccentricity", "", "", "of both orbits", 0, 0.7, 0, 0.3, false},
        {"inclination", "Inclination", "rad", "deg", "of both orbits", 0, 1.57, 0, 0.7, false},
        {"j2", "J₂ of the oblate planet", "", "", "the Earth's is .00108", 0, 0.1, 0, 0.0325, false},
        {"magnetic", "Magnetic field B", "T", "T", "", 0.2, 5, 0, 2, false},
        {"electric", "Electric field E", "V/m", "V/m", "", 0, 3, 0, 0.8, false},
        {"circulation", "Circulation of the vortex", "m²/s", "m²/s", "", 1, 60, 0, 22, false},
    };
    d.plots = {{"Node of the orbits", {"time", "s"}, {"angle", "deg"}, {{"round"}, {"oblate"}, {"theory"}}},
               {"Speed of the charges", {"time", "s"}, {"speed", "m/s"}, {{"B alone"}, {"E across B"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    world.allow_sleep = false;
    stage.start(world);
    const double e = stage.value("eccentricity"), i = stage.value("inclination");
    rigid::BodyDef<Dim3> planet;
    planet.type = rigid::BodyType::fixed;
    for (int k = 0; k < 2; ++k) {
      planet.name = k == 0 ? "round planet" : "oblate planet";
      planet.position = center_[k];
      const float squash = k == 0 ? 1.0f : 0.86f;
      stage.add(planet, geometry::Ellipsoid{{0.98f, 0.98f * squash, 0.98f}}, {}, k == 0 ? blue : teal);
      // From the pericentre, on the node's line; the pole is up.
      rigid::BodyDef<Dim3> moon;
      moon.name = k == 0 ? "round" : "oblate";
      moon.position = center_[k] + Vec3d{axis_ * (1 - e), 0, 0};
      const double speed = math::sqrt(gm_ / axis_ * (1 + e) / (1 - e));
      moon.linear_velocity = Vec3f(Vec3d{0, speed * math::sin(i), -speed * math::cos(i)});
      moon_[k] = stage.add(moon, geometry::Sphere{0.12f}, {}, k == 0 ? orange : gold);
    }
    rigid::SphericalGravity<Dim3> round;
    round.body = moon_[0];
    round.center = center_[0];
    round.gm = gm_;
    round.minimum_radius = 0.1;
    stage.keep(stage.world().add_effector(round));
    environment::GravityField field;
    field.kind = environment::GravityField::Kind::oblate;
    field.center = center_[1];
    field.gm = gm_;
    field.equatorial_radius = 1;
    field.minimum_radius = 0.5;
    field.j2 = stage.value("j2");
    zonal_ = {gm_, 1, field.j2};
    rigid::CustomEffector<Dim3> oblate;
    oblate.body = moon_[1];
    oblate.model = [field](const rigid::EffectorInput<Dim3>& in) {
      // At mid-step, as the engine's own fields are taken.
      const Vec3d middle = in.state.center_of_mass + Vec3d(in.state.linear_velocity) * (0.5 / 120);
      rigid::Wrench<Dim3> w;
      w.force = Vec3f(environment::gravity_at(field, middle) * in.state.mass);
      return w;
    };
    stage.keep(stage.world().add_effector(oblate));

    for (int k = 0; k < 4; ++k) {
      rigid::BodyDef<Dim3> charge;
      charge.name = k < 2 ? "charge" : "drifting charge";
      charge.position = {k < 2 ? 8.0 : 3.5, 0.6 * (k % 2), k < 2 ? -4.5 : 3.0 + 1.5 * (k % 2)};
      charge.linear_velocity = {k < 2 ? 1.5f + 1.5f * float(k) : 0.0f, 0, 0};
      rigid::ShapeDef<Dim3> form;
      const BodyId body = stage.add(charge, geometry::Sphere{0.1f}, form, k % 2 ? violet : red);
      charge_[k] = body;
      rigid::ElectromagneticField<Dim3> lorentz;
      lorentz.body = body;
      lorentz.charge = (k % 2 == 0 ? 1.0 : -1.0) * stage.at(body).mass;  // q/m = ±1 C/kg
      lorentz.magnetic = {0, stage.valuef("magnetic"), 0};
      if (k >= 2) lorentz.electric = {0, 0, -stage.valuef("electric")};
      stage.keep(stage.world().add_effector(lorentz));
    }
    for (int k = 0; k < 3; ++k) {
      rigid::BodyDef<Dim3> leaf;
      leaf.name = "leaf";
      leaf.position = vortex_ + Vec3d{0.8 + 0.8 * k, 0, 0};
      rigid::ShapeDef<Dim3> form;
      leaf_[k] = stage.add(leaf, geometry::Sphere{0.1f}, form, green);
      rigid::VortexField<Dim3> whirl;
      whirl.body = leaf_[k];
      whirl.center = vortex_;
      whirl.circulation = stage.value("circulation");
      whirl.core_radius = 0.6;
      whirl.rate = 6;
      stage.keep(stage.world().add_effector(whirl));
    }
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int k = 0; k < 2; ++k) {
      const auto s = stage.at(moon_[k]);
      const Vec3d h = cross(s.center_of_mass - center_[k], Vec3d(s.linear_velocity));
      trail_[k].add(s.center_of_mass);
      trail_[k].draw(stage, pen(k == 0 ? orange : gold, 0xb0));
      // The line of the node lies across the momentum's shadow on the equator.
      double node = math::atan2(h.x, h.z);
      while (node - node_[k] > math::pi) node -= 2 * math::pi;
      while (node - node_[k] < -math::pi) node += 2 * math::pi;
      node_[k] = node;
      if (t < stage.declaration().dt * 1.5) start_[k] = node;
      stage.sample(0, k, t, (node - start_[k]) * 180 / math::pi);
    }
    const double e = stage.value("eccentricity"), i = stage.value("inclination");
    stage.sample(0, 2, t, environment::nodal_regression(zonal_, axis_, e, i) * t * 180 / math::pi);
    for (int k = 0; k < 4; ++k) {
      const auto s = stage.at(charge_[k]);
      trail_[2 + k].add(s.center_of_mass);
      trail_[2 + k].draw(stage, pen(k % 2 ? violet : red, 0xb0));
      if (k == 0) stage.sample(1, 0, t, length(s.linear_velocity));
      if (k == 2) stage.sample(1, 1, t, length(s.linear_velocity));
    }
    for (int k = 0; k < 3; ++k) {
      trail_[6 + k].add(stage.at(leaf_[k]).center_of_mass);
      trail_[6 + k].draw(stage, pen(green, 0xb0));
    }
    // Kepler: when the round moon comes back through its pericentre's half plane.
    const Vec3d r = stage.at(moon_[0]).center_of_mass - center_[0];
    const double side = dot(r, Vec3d{0, 1, 0});
    if (before_ < 0 && side >= 0 && t > 0.5) {
      period_ = (t - stage.declaration().dt * side / (side - before_)) / ++turns_;
    }
    before_ = side;
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double t = stage.world().time(), kepler = 2 * math::pi * math::sqrt(axis_ * axis_ * axis_ / gm_);
    out.push_back({"period of the round orbit", "s", "Kepler: 2π √(a³/GM)", period_, kepler, 0.005 * kepler});
    const double rate = environment::nodal_regression(zonal_, axis_, 0.3, 0.7);
    out.push_back({"turn of the oblate orbit's node", "deg", "Vallado eq. 9-37, first order in J₂",
                   (node_[1] - start_[1]) * 180 / math::pi, rate * t * 180 / math::pi,
                   0.12 * math::abs(rate * t) * 180 / math::pi});
    out.push_back({"speed in the magnetic field", "m/s", "it does no work",
                   length(stage.at(charge_[0]).linear_velocity), 1.5, 1e-3});
    const double drift = (stage.at(charge_[2]).center_of_mass.x - 3.5) / t;
    out.push_back({"drift of a charge", "m/s", "E/B", drift, 0.8 / 2, 0.04});
    const double other = (stage.at(charge_[3]).center_of_mass.x - 3.5) / t;
    out.push_back({"drift of the opposite charge", "m/s", "E/B too", other, 0.8 / 2, 0.04});
  }

 private:
  static constexpr double gm_ = 40, axis_ = 2.6;
  static constexpr Vec3d center_[2] = {{-10, 0, 0}, {-2, 0, 0}}, vortex_{15, 0, -2};

  BodyId moon_[2], charge_[4], leaf_[3];
  environment::ZonalGravity zonal_;
  std::vector<Trail> trail_ = std::vector<Trail>(9, Trail(0.08, 500));
  double node_[2] = {}, start_[2] = {}, before_ = 0, period_ = 0;
  int turns_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_orbit_painter() { return std::make_unique<OrbitPainter>(); }

}  // namespace carom::host::demo
