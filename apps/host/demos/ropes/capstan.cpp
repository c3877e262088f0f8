// A winch draws a rope round a post: the tension grows by e^(μφ).
#include "apps/host/demos/ropes/draw.h"
#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {
namespace {

using particles::RopeSet;
using rigid::BodyId;
using rigid::Dim3;

class Capstan final : public Repeatable<Capstan, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "capstan";
    d.title = "A rope round a post";
    d.summary = "A winch hauls a load over a post that does not turn; friction multiplies the tension.";
    d.group = "Ropes and cloth";
    d.chapter = "13";
    d.text =
        "A rope that slides round a post gains tension with every bit of angle that it turns, dT = μ T dφ, so that "
        "(Euler 1769, Eytelwein 1808)\n\n"
        "  T₁ = T₂ e^(μφ)\n\n"
        "Nothing else about the post matters, not even its size. Two turns of a rope with μ = .3 hold forty times the "
        "pull: how sailors hold ships.";
    d.duration = 8;
    d.camera = {{0.4, 2.2, 5.5}, {0, 1.3, 0}, 0.75};
    d.ground = -1;
    d.parameters = {
        {"friction", "Friction", "", "", "coefficient of rope on post", 0, 0.6, 0, 0.25, false},
        {"turns", "Extra turns", "", "", "beside the half one over the post", 0, 1, 1, 0, false},
        {"load", "Load", "kg", "kg", "", 5, 200, 0, 40, false},
    };
    d.plots = {
        {"Ratio of the tensions", {"time", "s"}, {"T₁/T₂", ""}, {{"rope"}, {"e^(μφ)"}}},
        {"Tension round the post",
         {"angle from the load", "rad"},
         {"T/T₂", ""},
         {{.name = "rope", .style = Series::Style::points, .latest = true}, {.name = "e^(μφ)", .latest = true}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(-1);
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    def.position = {0, 2, 0};
    def.rotation = {0.70710678f, 0.70710678f, 0, 0};
    rigid::ShapeDef<Dim3> wood;
    wood.material.friction = stage.valuef("friction");
    stage.add(def, geometry::Cylinder{0.6f, radius_}, wood, sand);
    def.position = {-double(radius_), -0.85, 0};
    def.rotation = {};
    stage.add(def, geometry::Box{{0.3f, 0.15f, 0.3f}}, {}, dark);

    const double r = double(radius_) + 0.012, angle = math::pi * (1 + 2 * stage.count("turns"));
    std::vector<Vec3d> points{{-r, -0.5, -0.06 * angle / math::pi}};
    const int corners = 24 * (1 + 2 * stage.count("turns"));
    for (int i = 0; i <= corners; ++i) {
      const double phi = angle * i / corners;
      points.push_back({-r * math::cos(phi), 2 + r * math::sin(phi), 0.06 * (2 * phi - angle) / math::pi});
    }
    points.push_back({r, 0.5, 0.06 * angle / math::pi});
    // From the winch at the left, over the post, to the load.
    double way = 0;
    for (std::size_t i = 1; i < points.size(); ++i) way += distance(points[i - 1], points[i]);
    stage.keep(ropes_.add({.material = {.mass_per_length = 0.05,
                                        .radius = 0.012,
                                        .axial_stiffness = 5e5,
                                        .axial_damping = 50,
                                        .friction = stage.value("friction")},
                           .points = points,
                           .segments = int(way / 0.045)}));
    def.type = rigid::BodyType::dynamic;
    def.name = "load";
    def.allow_sleep = false;
    def.position = points.back() - Vec3d{0, 0.2, 0};
    rigid::ShapeDef<Dim3> iron;
    iron.density = float(stage.value("load") / (0.4 * 0.4 * 0.4));
    load_ = stage.add(def, geometry::Box{{0.2f, 0.2f, 0.2f}}, iron, red);
    stage.check(ropes_.attach(0, {.node = 0, .point = points.front()}, stage.world()));
    stage.check(ropes_.attach(0, {.node = -1, .body = load_, .point = {0, 0.2, 0}}, stage.world()));
    angle_ = angle;
    ratio_ = math::exp(stage.value("friction") * angle);
  }

  void before_step(Stage3& stage) override {
    // The winch takes half a second to come up to speed, and stops when the load is near the post.
    const double t = stage.world().time();
    const double speed = 0.15 * math::clamp((t - 0.5) / 0.5, 0.0, 1.0) * math::clamp((7.5 - t) / 0.5, 0.0, 1.0);
    stage.check(ropes_.set_winch(0, 0, speed));
    stage.check(ropes_.step(stage.world(), stage.declaration().dt));
  }

  void after_step(Stage3& stage) override {
    draw_rope(stage, ropes_, 0, 0xb08d57ff);
    const double t = stage.world().time();
    const auto tension = ropes_.tensions(0);
    const double ratio = tension.front() / math::max(tension.back(), 1.0);
    stage.sample(0, 0, t, ratio);
    stage.sample(0, 1, t, ratio_);
    if (t > 3 && t < 7) {
      sum_ += ratio;
      half_ += tell_tensions(stage);
      ++samples_;
    }
  }
  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"ratio of the tensions", "", "Euler and Eytelwein, e^(μφ)", samples_ > 0 ? sum_ / samples_ : 0,
                   ratio_, 0.05 * ratio_});
    out.push_back({"tension half way round, of T₂", "", "e^(μφ/2)", samples_ > 0 ? half_ / samples_ : 0, sqrt(ratio_),
                   0.05 * sqrt(ratio_)});
    out.push_back(
        {"height gained", "m", "what the winch took in", stage.at(load_).center_of_mass.y - 0.3, 0.975, 0.06});
  }
  std::uint64_t state_hash(std::uint64_t world) const override { return world ^ ropes_.state_hash(); }

 private:
  /// From the load on, by the angle that the rope has turned round the post. Returns the tension half way, of the
  /// load's.
  double tell_tensions(Stage3& stage) {
    constexpr int stations = 24;
    const auto place = ropes_.positions(0);
    const auto tension = ropes_.tensions(0);
    const double load = math::max(tension.back(), 1.0);
    double turned = 0, half = 0;
    int station = 0;
    for (std::size_t i = tension.size(); i-- > 0 && station <= stations;) {
      const Vec3d a = place[i + 1] - Vec3d{0, 2, 0}, b = place[i] - Vec3d{0, 2, 0};
      if (b.y > 0 || turned > 0) turned += math::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
      for (; station <= stations && turned >= angle_ * station / stations; ++station) {
        const double angle = angle_ * station / stations;
        stage.sample(1, 0, angle, tension[i] / load);
        stage.sample(1, 1, angle, math::exp(stage.value("friction") * angle));
        if (2 * station == stations) half = tension[i] / load;
      }
    }
    return half;
  }

  static constexpr float radius_ = 0.25f;
  RopeSet ropes_;
  BodyId load_{};
  double ratio_ = 1, sum_ = 0, half_ = 0, angle_ = 0;
  int samples_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_capstan() { return std::make_unique<Capstan>(); }

}  // namespace carom::host::demo
