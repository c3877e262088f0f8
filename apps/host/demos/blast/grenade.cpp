// A grenade: fragments at Gurney's speed with Mott's masses, in drag, and what they hit (chapter 18.6).
#include <algorithm>

#include "apps/host/demos/blast/list.h"
#include "carom/ballistics/hits.h"
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
    if (auto s = stage.world().step(float(dt)); !s) return s;
    batch_.step(dt);
    return struck_.collect(batch_, stage.world(), dt);
  }
  void before_step(Stage3& stage) override {
    if (stage.presses("again") > 0) throw_one(stage);
  }

  void after_step(Stage3& stage) override {
    for (const ballistics::BatchHit& hit : struck_.hits()) {
      rest_.push_back(Vec3f(hit.point));
      for (int b = 0; b < boards_; ++b) hits_[b] += hit.body == body_[b];
    }
    std::vector<Vec3f> places = rest_;
    std::vector<float> radii(rest_.size(), 0.018f);
    std::vector<std::uint32_t> colors(rest_.size(), pen(dark));
    double fastest = 0, mean = 0;
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      const forces::FlightPoint f = batch_.at(i);
      const double speed = length(f.velocity), hot = math::clamp(speed / first_speed_, 0.0, 1.0);
      places.push_back(Vec3f(f.position));
      radii.push_back(0.026f);
      colors.push_back(std::uint32_t(200 + 55 * hot) << 24 | std::uint32_t(60 + 150 * hot) << 16 | 0x30ffu);
      fastest = max(fastest, speed);
      mean += speed / double(thrown_);
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
                     double(batch_.size())));
    if (!told_ && since > 0.02) {
      told_ = true;
      for (int k = 0; k < boards_; ++k) {
        stage.sample(1, 0, distance_[k], hits_[k] / 2.4);
        stage.sample(1, 1, distance_[k], double(thrown_) / (4 * pi * square(distance_[k])));
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
  static constexpr int boards_ = 9;

  void throw_one(Stage3& stage) {
    batch_.clear();
    rest_.clear();
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
      batch_.add({{0, 1, 0}, f.velocity}, ballistics::chunk_round(f.mass, 7800));
      sum += f.mass * f.velocity;
      size += f.mass * length(f.velocity);
      masses.push_back(f.mass);
    }
    momentum_ = length(sum) / size;
    thrown_ = spray.size();
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

  blast::Explosion3 blast_;
  ballistics::ProjectileBatch batch_{ballistics::DragCurve(1.1), {}};  // of tumbling chunks
  ballistics::BatchHits<Dim3> struck_;
  std::vector<Vec3f> rest_;  // where they hit
  std::size_t thrown_ = 1;
  rigid::BodyId body_[boards_];
  double distance_[boards_] = {};
  int hits_[boards_] = {};
  double first_speed_ = 1, momentum_ = 0, start_ = 0;
  bool told_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_grenade() { return std::make_unique<Grenade>(); }

}  // namespace carom::host::demo
