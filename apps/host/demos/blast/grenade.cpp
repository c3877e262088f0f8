// A grenade: fragments at Gurney's speed with Mott's masses, in drag, and what they hit (chapter 18.6).
#include <algorithm>

#include "apps/host/demos/blast/list.h"
#include "carom/blast/explosion.h"
#include "carom/blast/fragments.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Grenade final : public Repeatable<Grenade, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "grenade";
    d.title = "Grenade";
    d.summary =
        "A steel case bursts: fragments by Gurney and Mott fly through the air in slow motion, and the blast with "
        "them.";
    d.group = "Explosions and fracture";
    d.chapter = "18.6, 18.7";
    d.text =
        "The charge drives the pieces of its case to a speed that follows from energy and momentum (Gurney), and "
        "breaks it "
        "into masses that Mott's law counts:\n\n"
        "  v = √(2E) / √(M/C + 3/5),   N(m) = (M/2μ) e^{−√(m/μ)}\n\n"
        "Fragments are thrown in pairs of equal mass to opposite sides: their momentum is zero, as before. Air slows "
        "the "
        "small ones first. Boards show where they hit; their number thins out with the square of the distance.";
    d.duration = 3;
    d.camera = {{5.5, 4.2, 8.5}, {0, 1.2, 0}};
    d.ground = 0;
    d.parameters = {
        {"case", "Mass of the case", "kg", "g", "of steel", 0.05, 2, 0.01, 0.24, false},
        {"charge", "Charge", "kg", "g", "of TNT", 0.02, 1, 0.01, 0.16, false},
        {"fragments", "Fragments", "", "", "", 50, 4000, 10, 900, false},
        {"slow", "Slow motion", "", "", "", 1, 200, 1, 60, true},
    };
    d.plots = {
        {"Fragments heavier than m", {"mass", "g"}, {"number", ""}, {{"drawn", Series::Style::points}, {"Mott's law"}}},
        {"Hits by distance",
         {"distance of the board", "m"},
         {"hits per m²", "1/m²"},
         {{"hits", Series::Style::points}, {"n/(4πr²)"}}},
        {"Fastest fragment", {"time", "ms"}, {"speed", "m/s"}, {{"fastest"}, {"mean"}}}};
    d.inputs = {{"again", "Once more", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    for (int k = 0; k < boards_; ++k) {
      // On a spiral, so that none hides another.
      const double angle = 2 * pi * k / boards_, r = 2 + 0.75 * k;
      rigid::BodyDef<Dim3> body;
      body.name = "board";
      body.position = {r * cos(angle), 1.001, r * sin(angle)};
      body.rotation = math::Quatf{float(cos(-0.5 * angle)), 0, float(sin(-0.5 * angle)), 0};
      body_[k] = stage.add(body, geometry::Box{{0.03f, 1, 0.6f}}, {.density = 500}, sand);
      distance_[k] = r - 0.03;
    }
    throw_one(stage);
  }

  core::Status step(Stage3& stage) override {
    const bool flight = stage.world().time() - start_ < 0.05;
    const double dt = stage.declaration().dt / (flight ? max(stage.value("slow"), 1.0) : 1.0);
    if (auto s = blast_.apply(stage.world(), dt); !s) return s;
    fly(stage, dt);
    return stage.world().step(float(dt));
  }
  void before_step(Stage3& stage) override {
    if (stage.presses("again") > 0) throw_one(stage);
  }

  void after_step(Stage3& stage) override {
    std::vector<Vec3f> places;
    std::vector<float> radii;
    std::vector<std::uint32_t> colors;
    double fastest = 0, mean = 0;
    for (const Flying& f : flying_) {
      places.push_back(Vec3f(f.place));
      radii.push_back(f.rests ? 0.018f : 0.026f);
      const double hot = math::clamp(length(f.velocity) / first_speed_, 0.0, 1.0);
      colors.push_back(f.rests ? pen(dark)
                               : (std::uint32_t(200 + 55 * hot) << 24 | std::uint32_t(60 + 150 * hot) << 16 | 0x30ffu));
      if (f.rests) continue;
      fastest = max(fastest, length(f.velocity));
      mean += length(f.velocity) / double(flying_.size());
    }
    stage.points(places, radii, colors);
    const double since = stage.world().time() - start_;
    if (since <= 0.03) {
      stage.sample(2, 0, 1e3 * since, fastest);
      stage.sample(2, 1, 1e3 * since, mean);
    }
    const double front = blast_.front_radius(stage.world().time());
    if (!blast_.finished(stage.world().time()) && front > 0)
      for (int k = 0; k < 64; ++k) {
        const double a = 2 * pi * k / 64, b = 2 * pi * (k + 1) / 64;
        stage.line(Vec3d{front * cos(a), 1, front * sin(a)}, Vec3d{front * cos(b), 1, front * sin(b)},
                   pen(orange, 0xa0));
      }
    int hits = 0;
    for (int k = 0; k < boards_; ++k) hits += hits_[k];
    stage.say(format("%.0f m/s at first; %.0f hits in the boards, %.0f still fly", first_speed_, double(hits),
                     double(std::count_if(flying_.begin(), flying_.end(), [](const Flying& f) { return !f.rests; }))));
    if (!told_ && since > 0.02) {
      told_ = true;
      for (int k = 0; k < boards_; ++k) {
        stage.sample(1, 0, distance_[k], hits_[k] / 2.4);
        stage.sample(1, 1, distance_[k], double(flying_.size()) / (4 * pi * square(distance_[k])));
      }
    }
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back(
        {"first speed", "m/s", "Gurney, sphere of TNT, M/C = 1.5", first_speed_, 2440 / sqrt(1.5 + 0.6), 0.1});
    out.push_back(
        {"momentum of the spray by its sum of magnitudes", "", "pairs to opposite sides", momentum_, 0, 1e-9});
    double expected = 0;
    int hits = 0;
    for (int k = 0; k < boards_; ++k) {
      // What a board of 1.2 m × 2 m takes of the sphere about the charge, in its middle height.
      const double r = distance_[k], solid = 4 * asin(0.6 * 1 / sqrt((0.36 + r * r) * (1 + r * r)));
      expected += stage.value("fragments") * solid / (4 * pi);
      hits += hits_[k];
    }
    out.push_back({"hits in all boards", "", "n Ω/4π, three standard deviations", double(hits), expected,
                   3 * sqrt(expected) + 2});
  }

 private:
  struct Flying {
    Vec3d place{}, velocity{};
    double mass = 0;
    bool rests = false;
  };
  static constexpr int boards_ = 9;

  void throw_one(Stage3& stage) {
    flying_.clear();
    std::fill(std::begin(hits_), std::end(hits_), 0);
    told_ = false;
    start_ = stage.world().time();
    const double mass = stage.value("case"), charge = stage.value("charge");
    first_speed_ = blast::gurney_speed(blast::CaseShape::sphere, mass / charge);
    const auto spray = stage.keep(blast::fragment_spray(mass, first_speed_, stage.count("fragments"), 11));
    Vec3d sum{};
    double size = 0;
    std::vector<double> masses;
    for (const blast::Fragment& f : spray) {
      flying_.push_back({{0, 1, 0}, f.velocity, f.mass, false});
      sum += f.mass * f.velocity;
      size += f.mass * length(f.velocity);
      masses.push_back(f.mass);
    }
    momentum_ = length(sum) / size;
    std::sort(masses.begin(), masses.end());
    const double mu = 0.5 * mass / double(masses.size());
    for (std::size_t i = 0; i < masses.size(); i += math::max<std::size_t>(masses.size() / 60, 1)) {
      stage.sample(0, 0, 1e3 * masses[i], double(masses.size() - i));
      stage.sample(0, 1, 1e3 * masses[i], blast::mott_count(mass, mu, masses[i]));
    }
    blast::Charge<Dim3> c;
    c.position = {0, 1, 0};
    c.mass = charge;
    c.burst = blast::Burst::free_air;
    c.time = start_;
    c.reach = 10;
    blast_ = stage.keep(blast::Explosion3::make(c));
  }

  /// Drag of tumbling chunks: C_D 1.1, the area of a cube of that mass seen from all sides. A swept step each.
  void fly(Stage3& stage, double dt) {
    std::vector<rigid::RayQuery<Dim3>> rays;
    std::vector<std::size_t> who;
    for (std::size_t i = 0; i < flying_.size(); ++i) {
      Flying& f = flying_[i];
      if (f.rests) continue;
      const double area = 1.5 * math::pow(f.mass / 7800, 2.0 / 3), k = 0.5 * 1.225 * 1.1 * area / f.mass;
      // v' = −k v² exactly over the step, then gravity.
      const double v = length(f.velocity);
      f.velocity = f.velocity / (1 + k * v * dt) - Vec3d{0, 9.80665 * dt, 0};
      rays.push_back({f.place, Vec3f(f.velocity * dt), {}});
      who.push_back(i);
    }
    std::vector<rigid::RayHit<Dim3>> hits(rays.size());
    stage.check(stage.world().cast_rays(rays, hits));
    for (std::size_t k = 0; k < hits.size(); ++k) {
      Flying& f = flying_[who[k]];
      if (hits[k].shape.is_null()) {
        f.place += Vec3d(rays[k].translation);
        continue;
      }
      f.place = hits[k].point;
      f.rests = true;
      const auto body = stage.world().body_of(hits[k].shape);
      for (int b = 0; b < boards_ && body.ok(); ++b)
        if (*body == body_[b]) {
          ++hits_[b];
          stage.check(stage.world().add_impulse_at(*body, Vec3f(f.mass * f.velocity), hits[k].point));
        }
      f.velocity = {};
    }
    if (flying_.size() > 5000) flying_.resize(5000);
  }

  blast::Explosion3 blast_;
  std::vector<Flying> flying_;
  rigid::BodyId body_[boards_];
  double distance_[boards_] = {};
  int hits_[boards_] = {};
  double first_speed_ = 1, momentum_ = 0, start_ = 0;
  bool told_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_grenade() { return std::make_unique<Grenade>(); }

}  // namespace carom::host::demo
