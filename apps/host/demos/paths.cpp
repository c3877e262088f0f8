// Beads on wires: Huygens' cycloid on which every swing takes as long, and a car on a closed track.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Paths final : public Repeatable<Paths, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "paths";
    d.title = "Beads on wires";
    d.summary = "Three beads on cycloids swing in step from any height; a car follows a track with a loop.";
    d.group = "Rigid bodies";
    d.chapter = "13";
    d.text =
        "A path joint keeps a point of a body on a curve. On a cycloid with its cusps up every swing takes as long, "
        "however wide it is (Huygens 1673): the beads start from three heights and meet at the bottom.\n\n"
        "  T = 4π √(r/g)\n\n"
        "The car turns with its track. Through a loop of radius R it needs v² = 5 g R below if it is to press on the "
        "rails all the way; the joint would hold it from above too. The force it takes is read from the joint.";
    d.duration = 12;
    d.dt = 1.0 / 60;
    d.camera = {{0, 3.5, 17}, {0, 1.8, 0}, 0.75};
    d.ground = -1.2;
    d.parameters = {
        {"radius", "Radius of the cycloid", "m", "m", "of the circle that rolls it", 0.3, 0.8, 0, 0.6, false},
        {"drive", "Speed of the lift", "m/s", "m/s", "that the car's motor holds at least", 0, 3, 0.1, 0, true},
    };
    d.plots = {{"Beads", {"time", "s"}, {"along the wire", "m"}, {{"high"}, {"middle"}, {"low"}}},
               {"Car", {"time", "s"}, {"force of the track", "g of its weight"}, {{"car"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    const double r = stage.value("radius");
    wire(r);
    const double starts[] = {2.4, 1.6, 0.8};
    const std::uint32_t colors[] = {blue, orange, green};
    for (int i = 0; i < 3; ++i) {
      const double a = starts[i];
      beads_[i] = bead(stage, {-4.5 + r * (a + sin(a)), 2 - r * cos(a), 1.2 * (i - 1)}, colors[i], i);
    }
    track();
    rigid::BodyDef<Dim3> body;
    body.name = "car";
    body.position = Vec3d(track_[0]);
    body.linear_velocity = {1, 0, 0};
    body.sleep_speed = 0;
    car_ = stage.add(body, geometry::Box{{0.3f, 0.12f, 0.18f}}, {}, red);
    rigid::PathJointDef<Dim3> rails;
    rails.body_b = car_;
    rails.points = track_;
    rails.closed = rails.follow = true;
    rails_ = stage.keep(stage.world().create_joint(rails));
    energy_ = total(stage);
  }

  void changed(Stage3& stage, std::string_view) override {
    const float speed = stage.valuef("drive");
    stage.check(stage.world().set_motor(rails_, {speed > 0, speed, 400}));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int i = 0; i < 3; ++i) {
      const double s = double(stage.keep(stage.world().joint_state(beads_[i])).coordinate) - middle_;
      stage.sample(0, i, t, s);
      if (before_[i] < 0 && s >= 0) {
        last_[i] = t - stage.declaration().dt * s / (s - before_[i]);
        if (rises_[i]++ == 0) first_[i] = last_[i];
      }
      before_[i] = s;
    }
    const Vec3f force = stage.keep(stage.world().joint_state(rails_)).force;
    const double weight = double(stage.at(car_).mass) * 9.80665;
    stage.sample(1, 0, t, double(length(force)) / weight);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double period = 4 * pi * sqrt(stage.value("radius") / 9.80665);
    const char* names[] = {"swing of the high bead", "swing of the middle bead", "swing of the low bead"};
    for (int i = 0; i < 3; ++i)
      out.push_back({names[i], "s", "4π √(r/g), Huygens", (last_[i] - first_[i]) / max(rises_[i] - 1, 1), period,
                     0.005 * period});
    // Where pieces of the track meet its curvature jumps, and with it the spin of what follows: a small blow each time.
    out.push_back({"energy of beads and car", "J", "hardly any is lost", total(stage), energy_, 0.05 * abs(energy_)});
  }

 private:
  double total(Stage3& stage) const {
    const auto t = stage.world().totals();
    return t.kinetic_energy + t.potential_energy;
  }
  void wire(double r) {
    constexpr int n = 41;
    const double end = 2.8, step = 2 * end / (n - 1);
    wire_.clear(), slopes_.clear();
    for (int i = 0; i < n; ++i) {
      const double a = -end + i * step;
      wire_.push_back(Vec3f(float(r * (a + sin(a))), float(-r * cos(a)), 0));
      slopes_.push_back(Vec3f(float(r * (1 + cos(a)) * step), float(r * sin(a) * step), 0));
    }
    middle_ = 4 * r * sin(0.5 * end);
  }
  rigid::JointId bead(Stage3& stage, Vec3d at, std::uint32_t color, int i) {
    rigid::BodyDef<Dim3> body;
    body.name = "bead";
    body.position = at;
    body.sleep_speed = 0;
    rigid::ShapeDef<Dim3> shape;
    shape.filter.group = -1;
    rigid::PathJointDef<Dim3> path;
    path.body_b = stage.add(body, geometry::Sphere{0.14f}, shape, color);
    path.frame_a.p = {-4.5f, 2, 1.2f * float(i - 1)};
    path.points = wire_;
    path.tangents = slopes_;
    return stage.keep(stage.world().create_joint(path));
  }
  /// Down a hill, through a loop that leans aside, over a hump and back.
  void track() {
    track_ = {{0.4f, 4.6f, 0},     {1.2f, 4.3f, 0},     {2.0f, 2.6f, 0},     {2.8f, 0.6f, 0},     {3.8f, -0.4f, 0},
              {4.8f, -0.2f, 0},    {5.5f, 0.8f, 0.1f},  {5.0f, 1.9f, 0.2f},  {4.1f, 1.9f, 0.4f},  {3.6f, 0.8f, 0.5f},
              {4.3f, -0.2f, 0.6f}, {5.6f, -0.5f, 0.7f}, {7.0f, -0.1f, 0.3f}, {7.6f, 0.6f, -0.8f}, {6.8f, 1.4f, -1.9f},
              {5.0f, 2.4f, -2.3f}, {3.0f, 3.4f, -2.2f}, {1.0f, 4.1f, -1.7f}, {0.0f, 4.5f, -0.8f}};
  }

  std::vector<Vec3f> wire_, slopes_, track_;
  rigid::JointId beads_[3], rails_;
  BodyId car_;
  double middle_ = 0, energy_ = 0, before_[3] = {1, 1, 1}, first_[3] = {}, last_[3] = {};
  int rises_[3] = {};
};

}  // namespace

std::unique_ptr<Demo> make_paths() { return std::make_unique<Paths>(); }

}  // namespace carom::host::demo
