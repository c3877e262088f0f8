// Rounded boxes, cylinders, cones and hulls; a rounded cone rocks on a slope about where its tip would be.
#include "apps/host/demos/demos.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/mass_properties.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Rounded final : public Repeatable<Rounded, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "rounded";
    d.title = "Rounded shapes";
    d.summary =
        "Boxes, cylinders, cones and hulls swept by a ball tumble into a heap; a rounded cone rocks on a slope.";
    d.group = "Shapes";
    d.text =
        "A convex core swept by a ball of radius r is as quick to collide as the core alone: the distance of two cores "
        "less the two radii. Volume and inertia of the swept body are closed forms, and Steiner's formula holds for "
        "its "
        "volume, with the core's surface S and M, 2π times its mean width:\n\n"
        "  V = V₀ + S r + M r² + 4/3 π r³\n\n"
        "A cone of half angle α that rolls on a plane turns about the point where its side would come to a tip, here "
        "r/sin α beyond the core's. On a slope β it swings there like a pendulum, with I about the line on which it "
        "lies and the centre of mass l from that tip:\n\n"
        "  T = 2π √( I cot²α / (m g sin β l cos α) ),  I = I_a cos²α + (I_t + m l²) sin²α";
    d.duration = 8;
    d.camera = {{0.6, 3.2, 6.2}, {0.3, 0.4, 0}, 0.75};
    d.ground = 0;
    d.parameters = {
        {"rounding", "Rounding of the cone", "m", "cm", "r", 0.02, 0.2, 0, 0.08, false},
        {"slope", "Slope", "rad", "deg", "β", 0.05, 0.4, 0, radians(10.0), false},
        {"angle", "First angle", "rad", "deg", "of the cone against the line of fall", 0.05, 1, 0, radians(15.0),
         false},
        {"bodies", "Bodies in the heap", "", "", "", 0, 80, 1, 32, false},
    };
    d.plots = {
        {"The cone", {"time", "s"}, {"angle", "deg"}, {{"on the slope"}, {"φ₀ cos 2πt/T", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    heap(stage);
    ramp_ = from_axis_angle(Vec3f{0, 0, 1}, -stage.valuef("slope"));
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = "slope";
    body.rotation = ramp_;
    body.position = tip_ + rotate(Quatd(ramp_), Vec3d{0.9, -0.1, 0});
    rigid::ShapeDef<Dim3> rough;
    rough.material.friction = 1;
    stage.add(body, geometry::Box{{1.4f, 0.08f, 1.2f}, 0.02f}, rough, sand);

    const geometry::Cone cone{0.45f, 0.3f, stage.valuef("rounding")};
    const double half = atan2(double(cone.radius), 2 * double(cone.half_height)), c = cos(half), s = sin(half);
    const double reach = double(cone.rounding) / s + double(cone.half_height);  // from the tip to the shape's middle
    const Quatd turn = from_axis_angle(Vec3d{0, 1, 0}, stage.value("angle"));
    // Its axis from the tip, (cos α, sin α, 0), is −y of the shape.
    const Quatd lying = from_axis_angle(Vec3d{0, 0, 1}, half + 0.5 * pi), all = Quatd(ramp_) * turn * lying;
    body.type = rigid::BodyType::dynamic;
    body.name = "rounded cone";
    body.rotation = normalize(Quatf(all));
    body.position = tip_ + rotate(Quatd(ramp_) * turn, Vec3d{c, s, 0}) * reach;
    body.sleep_speed = 0;
    cone_ = stage.add(body, cone, rough, orange);
    const geometry::MassProperties3 m = geometry::mass_properties(geometry::Shape3(cone), 1);
    const double l = reach - m.center.y;
    const double inertia = m.inertia(1, 1) * c * c + (m.inertia(0, 0) + m.mass * l * l) * s * s;
    period_ = 2 * pi * sqrt(inertia * square(c / s) / (m.mass * 9.80665 * sin(stage.value("slope")) * l * c));
    const double phi = stage.value("angle");
    period_ *= 1 + phi * phi / 16;
    for (double t = 0; t <= 6; t += 0.1) stage.sample(0, 1, t, degrees(phi) * cos(2 * pi * t / period_));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const Vec3f axis = inverse_rotate(ramp_, rotate(stage.at(cone_).pose.rotation, Vec3f{0, -1, 0}));
    const double angle = atan2(-double(axis.z), double(axis.x));
    if (t <= 6) stage.sample(0, 0, t, degrees(angle));
    if (before_ * angle < 0) crossings_.push_back(t - angle / (angle - before_) * stage.declaration().dt);
    before_ = angle;
    const Vec3d up = rotate(Quatd(ramp_), Vec3d{0, 0.02, 0});
    stage.line(tip_ + up, tip_ + up + rotate(Quatd(ramp_), Vec3d{2.2, 0, 0}), pen(red, 0x90));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double swings = double(crossings_.size()) - 1;
    const double period = swings > 1 ? 2 * (crossings_.back() - crossings_.front()) / swings : 0;
    out.push_back(
        {"period of the cone on the slope", "s", "2π √(I cot²α/(m g sin β l cos α))", period, period_, 0.03 * period_});
    double lowest = 10;
    for (const auto& actor : stage.actors()) {
      const auto state = stage.at(actor.body);
      if (state.type == rigid::BodyType::dynamic) lowest = min(lowest, state.pose.position.y);
    }
    out.push_back({"centre of the lowest body at least", "m", "nothing sinks in", min(lowest, 0.11), 0.11, 0});
  }

 private:
  static constexpr Vec3d tip_{-2.6, 0.75, 0};

  void heap(Stage3& stage) {
    constexpr std::uint32_t colors[] = {blue, green, gold, violet, red, teal};
    constexpr Vec3f corners[] = {{0.2f, 0, 0},     {-0.2f, 0.05f, 0}, {0, 0.22f, 0.05f},    {0, -0.2f, 0},
                                 {0, 0.02f, 0.2f}, {0.03f, 0, -0.2f}, {0.15f, 0.14f, 0.14f}};
    const auto hull = stage.keep(geometry::make_hull(corners, {.radius = 0.05f}));
    const geometry::Shape3 shapes[] = {
        geometry::Box{{0.16f, 0.1f, 0.22f}, 0.06f}, geometry::Cylinder{0.12f, 0.16f, 0.06f},
        geometry::Cone{0.18f, 0.18f, 0.06f},        hull,
        geometry::Capsule3{0.16f, 0.12f},           geometry::Ellipsoid{{0.26f, 0.16f, 0.2f}}};
    constexpr const char* names[] = {"rounded box",  "rounded cylinder", "rounded cone",
                                     "rounded hull", "capsule",          "ellipsoid"};
    const int count = stage.count("bodies");
    for (int i = 0; i < count; ++i) {
      rigid::BodyDef<Dim3> body;
      body.name = names[i % 6];
      const int layer = i / 8;
      body.position = {1.2 + 0.75 * (i % 4) + 0.05 * (i % 3), 0.5 + 0.62 * layer, -0.5 + 0.9 * (i / 4 % 2)};
      body.rotation = from_axis_angle(normalize(Vec3f{1, float(i % 5), 2}), float(i));
      stage.add(body, shapes[i % 6], {.material = {.friction = 0.5f, .rolling_resistance = 0.02f}}, colors[i % 6]);
    }
  }

  BodyId cone_;
  Quatf ramp_;
  double period_ = 1, before_ = 0;
  std::vector<double> crossings_;
};

}  // namespace

std::unique_ptr<Demo> make_rounded() { return std::make_unique<Rounded>(); }

}  // namespace carom::host::demo
