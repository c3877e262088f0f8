// Bodies that turn freely in space: the brick of NASA's check case 02, and the flip of the intermediate axis.
#include "apps/host/demos/demos.h"
#include "carom/ode/methods.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

/// Euler's equations in body axes, integrated finely beside the world: what the engine is compared with.
struct Reference {
  Vec3d moments{}, rates{};
  void advance(double dt) {
    const auto f = [this](double, Vec3d w) {
      return Vec3d{(moments.y - moments.z) * w.y * w.z / moments.x, (moments.z - moments.x) * w.z * w.x / moments.y,
                   (moments.x - moments.y) * w.x * w.y / moments.z};
    };
    for (int i = 0; i < 16; ++i) rates = ode::rk4(f, 0.0, rates, dt / 16);
  }
};

Vec3d body_rates(const rigid::BodyState<Dim3>& s) {
  return inverse_rotate(Quatd(s.pose.rotation), Vec3d(s.angular_velocity));
}

void axes(Stage3& stage, const rigid::BodyState<Dim3>& s, double reach) {
  const std::uint32_t pens[] = {pen(red), pen(green), pen(blue)};
  for (int k = 0; k < 3; ++k) {
    Vec3d unit{};
    unit[k] = reach;
    stage.line(s.center_of_mass, s.center_of_mass + rotate(Quatd(s.pose.rotation), unit), pens[k]);
  }
}

class TumblingBrick final : public Repeatable<TumblingBrick, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "tumbling-brick";
    d.title = "Tumbling brick (NASA check case 02)";
    d.summary = "A brick of 8 × 4 × 2¼ inches tumbles in free flight; dots are the rates that NASA published.";
    d.group = "Rotation";
    d.chapter = "11, 12.2";
    d.text =
        "No torque acts, and still the rates change all the time: a body whose three moments of inertia differ can "
        "only keep "
        "its spin about a principal axis.\n\n"
        "  I ω̇ = −ω × (I ω)   in body axes\n\n"
        "Angular momentum in space and the energy stay constant; the tip of ω runs round a curve on the energy "
        "ellipsoid. The "
        "values are those of the NASA NESC flight simulation check cases (NASA/TM-2015-218675, case 02): start at 10, "
        "20, 30 °/s "
        "about x, y, z.";
    d.dt = 1.0 / 120;
    d.duration = 10;
    d.camera = {{0.36, 0.24, 0.5}, {0, 0, 0}};
    d.parameters = {{"p", "Rate about x", "rad/s", "deg/s", "the long axis", -2, 2, 0, radians(10.0), false},
                    {"q", "Rate about y", "rad/s", "deg/s", "", -2, 2, 0, radians(20.0), false},
                    {"r", "Rate about z", "rad/s", "deg/s", "the short axis", -2, 2, 0, radians(30.0), false}};
    d.plots = {{"Body rates",
                {"time", "s"},
                {"rate", "deg/s"},
                {{"p", Series::Style::line, {}, blue},
                 {"q", Series::Style::line, {}, orange},
                 {"r", Series::Style::line, {}, green},
                 {"p, NASA",
                  Series::Style::points,
                  {{1, 4.2588419}, {2, -1.7508153}, {5, -16.9394851}, {10, -2.4189022}},
                  blue},
                 {"q, NASA",
                  Series::Style::points,
                  {{1, 23.1199429}, {2, 23.6495578}, {5, 9.6319394}, {10, -23.5525695}},
                  orange},
                 {"r, NASA",
                  Series::Style::points,
                  {{1, 28.3798178}, {2, 28.07132}, {5, 33.4066281}, {10, 28.1285926}},
                  green}}},
               {"Drift", {"time", "s"}, {"relative drift", "1e-6"}, {{"energy"}, {"angular momentum"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    stage.start(world);
    constexpr double slug = 14.593903, foot = 0.3048;
    rigid::BodyDef<Dim3> body;
    body.name = "brick";
    body.sleep_speed = 0;
    body.angular_velocity = {stage.valuef("p"), stage.valuef("q"), stage.valuef("r")};
    const float inch = 0.0254f;
    body_ = stage.add(body, geometry::Box{{4 * inch, 2 * inch, 1.125f * inch}}, {}, 0xb5533c);
    geometry::MassProperties3 m;
    m.mass = 0.155404754 * slug;
    m.inertia = Mat3d::diagonal(Vec3d{0.001894220, 0.006211019, 0.007194665} * (slug * foot * foot));
    stage.check(stage.world().set_mass_properties(body_, m));
    moments_ = {m.inertia.cx.x, m.inertia.cy.y, m.inertia.cz.z};
    energy_ = energy(stage);
    momentum_ = length(momentum(stage));
  }

  void after_step(Stage3& stage) override {
    const auto s = stage.at(body_);
    const double t = stage.world().time();
    rates_ = body_rates(s);
    if (stage.world().step_count() % 2 == 0) {
      for (int k = 0; k < 3; ++k) stage.sample(0, k, t, degrees(rates_[k]));
      stage.sample(1, 0, t, 1e6 * (energy(stage) / energy_ - 1));
      stage.sample(1, 1, t, 1e6 * (length(momentum(stage)) / momentum_ - 1));
    }
    axes(stage, s, 0.16);
    const Vec3d w(s.angular_velocity);
    stage.line(s.center_of_mass, s.center_of_mass + 0.3 * w, pen(gold));
    tip_.add(s.center_of_mass + rotate(Quatd(s.pose.rotation), Vec3d{0.13, 0, 0}));
    tip_.draw(stage, pen(orange, 0x90));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const char* source = "NASA/TM-2015-218675, case 02, t = 10 s";
    out.push_back({"p", "deg/s", source, degrees(rates_.x), -2.4189022, 0.02});
    out.push_back({"q", "deg/s", source, degrees(rates_.y), -23.5525695, 0.02});
    out.push_back({"r", "deg/s", source, degrees(rates_.z), 28.1285926, 0.02});
    out.push_back({"drift of the energy", "", "conserved", energy(stage) / energy_ - 1, 0, 1e-3});
    out.push_back({"drift of the angular momentum", "", "conserved", length(momentum(stage)) / momentum_ - 1, 0, 1e-5});
  }

 private:
  double energy(Stage3& stage) {
    const Vec3d w = body_rates(stage.at(body_));
    return 0.5 * dot(w, scale(moments_, w));
  }
  Vec3d momentum(Stage3& stage) { return scale(moments_, body_rates(stage.at(body_))); }

  rigid::BodyId body_;
  Vec3d moments_{}, rates_{};
  double energy_ = 1, momentum_ = 1;
  Trail tip_{0.004, 400};
};

class IntermediateAxis final : public Repeatable<IntermediateAxis, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "intermediate-axis";
    d.title = "The flip of the intermediate axis";
    d.summary = "A T-handle spun about its middle axis turns over and over, again and again, with nothing touching it.";
    d.group = "Rotation";
    d.chapter = "11, 12.2";
    d.text =
        "Spin about the axis of the largest or the smallest moment of inertia is steady. About the one between, the "
        "smallest wobble grows exponentially until the body turns over, and then back.\n\n"
        "  σ = Ω √((I₂ − I₁)(I₃ − I₂) / (I₁ I₃))\n\n"
        "Dots are Euler's equations integrated finely beside the engine: the flips must come at the same moments.";
    d.dt = 1.0 / 120;
    d.duration = 20;
    d.camera = {{1.5, 1.1, 2.6}, {0, 0, 0}};
    d.parameters = {
        {"spin", "Spin", "rad/s", "rpm", "about the middle axis", 1, 15, 0, 6, false},
        {"wobble", "Wobble at the start", "rad/s", "rad/s", "about the other two axes", 0, 0.5, 0, 0.02, false},
        choice("shape", "Shape", "", {"T-handle", "brick"})};
    d.plots = {{"Body rates",
                {"time", "s"},
                {"rate", "rad/s"},
                {{"smallest axis"},
                 {"middle axis"},
                 {"largest axis"},
                 {"middle axis, Euler's equations", Series::Style::points}}},
               {"Energy", {"time", "s"}, {"relative drift", "1e-6"}, {{"kinetic"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    stage.start(world);
    rigid::BodyDef<Dim3> body;
    body.name = "T-handle";
    body.sleep_speed = 0;
    if (stage.count("shape") == 0) {
      rigid::ShapeDef<Dim3> stem, bar;
      stem.density = bar.density = 2700;
      stem.local = {{0.35f, 0, 0}, {0.70710678f, 0, 0, -0.70710678f}};  // along x
      bar.local = {{-0.05f, 0, 0}, {}};
      body_ =
          stage.add(body, {{geometry::Cylinder{0.35f, 0.09f}, stem}, {geometry::Cylinder{0.55f, 0.1f}, bar}}, steel);
    } else {
      rigid::ShapeDef<Dim3> shape;
      body_ = stage.add(body, geometry::Box{{0.6f, 0.3f, 0.09f}}, shape, 0xb5533c);
    }
    const geometry::MassProperties3 m = stage.keep(stage.world().mass_properties3(body_));
    axes_ = geometry::principal_axes(m.inertia);
    const double wobble = stage.value("wobble");
    const Vec3d start{wobble, stage.value("spin"), wobble};
    reference_ = {axes_.moments, start};
    stage.check(stage.world().set_velocity(body_, {}, Vec3f(rotate(axes_.rotation, start))));
    energy_ = 0.5 * dot(start, scale(axes_.moments, start));
    last_sign_ = last_reference_sign_ = 1;
  }

  void after_step(Stage3& stage) override {
    const auto s = stage.at(body_);
    const double t = stage.world().time();
    reference_.advance(stage.declaration().dt);
    const Vec3d w = inverse_rotate(axes_.rotation, body_rates(s));
    count(w.y, stage.value("spin"), last_sign_, flips_);
    count(reference_.rates.y, stage.value("spin"), last_reference_sign_, reference_flips_);
    drift_ = 0.5 * dot(w, scale(axes_.moments, w)) / energy_ - 1;
    if (stage.world().step_count() % 4 == 0) {
      for (int k = 0; k < 3; ++k) stage.sample(0, k, t, w[k]);
      stage.sample(1, 0, t, 1e6 * drift_);
    }
    if (stage.world().step_count() % 24 == 0) stage.sample(0, 3, t, reference_.rates.y);
    stage.say(format("%.0f flips; Euler's equations say %.0f", flips_, reference_flips_));
    axes(stage, s, 0.9);
    const Quatd q = Quatd(s.pose.rotation);
    tip_.add(s.center_of_mass + rotate(q, Vec3d{0.75, 0, 0}));
    tip_.draw(stage, pen(orange, 0x80));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"flips in 20 s", "", "Euler's equations by RK4", double(flips_), double(reference_flips_), 0});
    out.push_back({"drift of the energy", "", "conserved", drift_, 0, 1e-3});
  }

 private:
  static void count(double rate, double spin, int& sign, int& flips) {
    // A flip is done when most of the spin is there again with the other sign.
    if (rate * sign < -0.7 * spin) {
      sign = -sign;
      ++flips;
    }
  }

  rigid::BodyId body_;
  geometry::PrincipalAxes axes_;
  Reference reference_;
  double energy_ = 1, drift_ = 0;
  int flips_ = 0, reference_flips_ = 0, last_sign_ = 1, last_reference_sign_ = 1;
  Trail tip_{0.03, 300};
};

}  // namespace

std::unique_ptr<Demo> make_tumbling_brick() { return std::make_unique<TumblingBrick>(); }
std::unique_ptr<Demo> make_intermediate_axis() { return std::make_unique<IntermediateAxis>(); }

}  // namespace carom::host::demo
