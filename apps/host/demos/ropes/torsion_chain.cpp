// Rods on a wire that twists: a wave runs along them (section 13.6).
#include "apps/host/demos/ropes/draw.h"
#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {
namespace {

using particles::RopeSet;
using rigid::BodyId;
using rigid::Dim3;

class TorsionChain final : public Repeatable<TorsionChain, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "torsion-chain";
    d.title = "A chain of torsion springs";
    d.summary = "Rods joined by a wire that resists twisting: turn the first, and a wave runs to the last.";
    d.group = "Ropes and cloth";
    d.chapter = "13.6";
    d.text =
        "A piece of wire of length l resists a twist Θ with the moment k Θ, k = GJ/l. A rod of inertia I on it swings "
        "with T = 2π √(I/k): 1.147 s for the rod of 1/3 kg·m² on 10 N·m of section 13.6. Of many in a row each is "
        "drawn "
        "by both its neighbours, and a wave runs along them, long ones with\n\n"
        "  c = √(k/I)\n\n"
        "rods a second. N rods, held at one end and free at the other, swing in N modes (Lagrange's loaded "
        "string):\n\n"
        "  ω_m = 2 √(k/I) sin β_m/2,   Θ_i ∝ sin i β_m,   β_m = (2m − 1) π/(2N + 1)\n\n"
        "The points are their sum, moved by the first rod's pulse, without damping.";
    d.duration = 9;
    d.camera = {{0, 2.2, 7.5}, {0, 0, 0}, 0.75};
    d.parameters = {
        {"stiffness", "Stiffness of a piece", "N·m", "N·m", "moment a radian", 2, 60, 0, 10, false},
    };
    d.plots = {{"Angles",
                {"time", "s"},
                {"angle", "°"},
                {{"first"},
                 {"middle"},
                 {"last"},
                 {"middle, by the modes", Series::Style::points},
                 {"last, by the modes", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    stage.start(world);
    const double gap = 0.3;
    for (int i = 0; i < rods_; ++i) {
      rigid::BodyDef<Dim3> def;
      def.position = {gap * (i - 0.5 * (rods_ - 1)), 0, 0};
      def.allow_sleep = false;
      if (i == 0) def.type = rigid::BodyType::kinematic;
      rigid::ShapeDef<Dim3> shape;
      shape.filter.mask = 0;
      shape.density = float(inertia_ * 3 / (0.8 * 0.8) / (0.1 * 0.1 * 1.6));  // of a rod about its middle: m l²/12
      const BodyId rod = stage.add(def, geometry::Box{{0.05f, 0.8f, 0.05f}}, shape,
                                   i == 0           ? red
                                   : i + 1 == rods_ ? gold
                                                    : blue);
      bodies_.push_back(rod);
      if (i == 0) continue;
      stage.check(
          stage.world().set_mass_properties(rod, {5, {}, math::Mat3d::diagonal({inertia_, inertia_, inertia_})}));
      rigid::HingeJointDef<Dim3> hinge;
      hinge.body_b = rod;
      hinge.frame_a.p = math::Vec3f(def.position);
      hinge.frame_a.q = hinge.frame_b.q = {0.70710678f, 0, 0.70710678f, 0};  // z of the frames along the wire
      stage.keep(stage.world().create_joint(hinge));
      const Vec3d before = def.position - Vec3d{gap, 0, 0}, points[] = {before, def.position};
      const int wire = stage.keep(ropes_.add({.material = {.mass_per_length = 0.1,
                                                           .radius = 0.02,
                                                           .axial_stiffness = 1e4,
                                                           .torsional_stiffness = stage.value("stiffness") * gap},
                                              .points = points,
                                              .segments = 3,
                                              .collide = false}));
      stage.check(
          ropes_.attach(wire, {.node = 0, .body = bodies_[std::size_t(i - 1)], .clamped = true}, stage.world()));
      stage.check(ropes_.attach(wire, {.node = -1, .body = rod, .clamped = true}, stage.world()));
    }
    angle_.assign(std::size_t(rods_), 0.0);
  }

  void before_step(Stage3& stage) override {
    // The first rod is turned by 60° and back, as a smooth pulse.
    const double dt = stage.declaration().dt, t = stage.world().time() + dt;
    const double angle = t < pulse_ ? (math::pi / 6) * (1 - math::cos(2 * math::pi * t / pulse_)) : 0;
    stage.check(stage.world().set_target_pose(bodies_[0], stage.at(bodies_[0]).pose.position,
                                              {float(math::cos(angle / 2)), float(math::sin(angle / 2)), 0, 0},
                                              float(dt)));
    stage.check(ropes_.step(stage.world(), dt));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int i = 0; i < ropes_.size(); ++i) draw_rope(stage, ropes_, i, 0x8d99a6ff);
    for (int i = 0; i < rods_; ++i) {
      const auto q = stage.at(bodies_[std::size_t(i)]).pose.rotation;
      angle_[std::size_t(i)] = 2 * math::atan2(double(q.x), double(q.w));
    }
    const int shown[] = {0, rods_ / 2, rods_ - 1};
    for (int k = 0; k < 3; ++k) stage.sample(0, k, t, math::degrees(angle_[std::size_t(shown[k])]));
    const int half = rods_ / 2;
    ++steps_;
    for (const int k : {1, 2}) {
      const double by_modes = modes(shown[k], t, stage.value("stiffness"));
      if (steps_ % 12 == 0) stage.sample(0, 2 + k, t, math::degrees(by_modes));
      off_ = max(off_, math::abs(angle_[std::size_t(shown[k])] - by_modes));
      most_ = max(most_, math::abs(by_modes));
    }
    const double middle = angle_[std::size_t(half)];
    if (t < half / math::sqrt(stage.value("stiffness") / inertia_) + pulse_ && middle > peak_) {
      peak_ = middle;
      arrival_ = t - 0.5 * pulse_;
    }
  }
  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const int half = rods_ / 2;
    const double expected = half / math::sqrt(stage.value("stiffness") / inertia_);
    // A pulse of this length is slowed a little by the gaps between the rods.
    out.push_back({"time of the pulse to the middle", "s", "√(I/k) a rod", arrival_, expected, 0.06 * expected});
    out.push_back({"middle and last rod, farthest from the sum of the modes", "of the greatest angle",
                   "Lagrange's loaded string", off_ / max(most_, 1e-9), 0, 0.05});
  }
  std::uint64_t state_hash(std::uint64_t world) const override { return world ^ ropes_.state_hash(); }

 private:
  /// The angle of a rod at the time t (rad): each mode is a swing without damping, which the first rod's pulse
  /// A (1 − cos p t) drives as long as it lasts and leaves to itself.
  double modes(int rod, double t, double stiffness) const {
    const int n = rods_ - 1;
    const double p = 2 * math::pi / pulse_, amplitude = math::pi / 6, rate = stiffness / inertia_;
    double angle = 0;
    for (int m = 1; m <= n; ++m) {
      const double beta = (2 * m - 1) * math::pi / (2 * n + 1), w = 2 * math::sqrt(rate) * math::sin(beta / 2);
      const double drive = rate * amplitude * math::sin(beta) * 4 / (2 * n + 1);
      const double s = min(t, pulse_), gap = w * w - p * p;
      double q = drive * ((1 - math::cos(w * s)) / (w * w) - (math::cos(p * s) - math::cos(w * s)) / gap);
      const double v = drive * (math::sin(w * s) / w - (w * math::sin(w * s) - p * math::sin(p * s)) / gap);
      if (t > pulse_) q = q * math::cos(w * (t - pulse_)) + v / w * math::sin(w * (t - pulse_));
      angle += q * math::sin(rod * beta);
    }
    return angle;
  }
  static constexpr int rods_ = 21;
  static constexpr double inertia_ = 1.0 / 3, pulse_ = 2;
  RopeSet ropes_;
  std::vector<BodyId> bodies_;
  std::vector<double> angle_;
  double peak_ = 0, arrival_ = 0, off_ = 0, most_ = 0;
  int steps_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_torsion_chain() { return std::make_unique<TorsionChain>(); }

}  // namespace carom::host::demo
