// A charge among boxes and a wall: the front runs out, gauges write its pressure, the wall shelters, the ground
// reflects (chapter 18.6).
#include "apps/host/demos/blast/list.h"
#include "carom/blast/explosion.h"
#include "carom/blast/reflection.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Field final : public Repeatable<Field, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "blast-field";
    d.title = "Blast wave";
    d.summary = "A charge in slow motion: the front, what its pressure does to boxes, and the shelter of a wall.";
    d.group = "Explosions and fracture";
    d.chapter = "18.6";
    d.text =
        "The wave of a charge depends on the scaled distance alone; its peak, duration and impulse are those that "
        "Kingery and Bulmash measured, as Swisdak fitted them:\n\n"
        "  Z = R / W^{1/3},   p(t) = P_s (1 − t/t_d) e^{−b t/t_d}\n\n"
        "A face that looks at the charge reflects the wave, up to eight times and more of its pressure, until its "
        "edges relieve it; a face that looks away feels the side-on pressure. A burst in the air is reflected by the "
        "ground: below it as two waves, and beyond some 40° as one, the Mach stem, which stands on the ground, is "
        "stronger than the charge's own wave, and grows as it runs out (violet: its top, the triple point). Rays say "
        "what the charge sees. Time runs slowly until the wave has passed: the ring is the front, and bodies take the "
        "colour of what the pressure does: glass breaks (1 kPa), roofs (14), eardrums (34), walls (70), lungs (240 "
        "kPa).";
    d.duration = 3.5;
    d.camera = {{3, 10.5, 19}, {1, 0.6, 0}};
    d.ground = 0;
    d.parameters = {
        {"charge", "Charge W", "kg", "kg", "of TNT", 0.1, 100, 0.1, 5, false},
        {"slow", "Slow motion", "", "", "while the wave passes", 1, 200, 1, 60, true},
        {"height", "Height of the wall", "m", "m", "", 0.2, 4, 0.1, 2, false},
        {"shelter", "Shelter", "", "", "share of the pressure that comes round an obstacle", 0, 1, 0.05, 0.4, false},
        choice("air", "Where it bursts", "the wave is weaker in free air",
               {"on the ground", "in free air", "in the air over the ground"}),
        {"burst", "Height of the burst", "m", "m", "over the ground", 0.5, 8, 0.1, 2.5, false},
    };
    d.plots = {
        {"Gauges", {"time since the detonation", "ms"}, {"pressure", "kPa"}, {{"in the open"}, {"behind the wall"}}},
        {"Peak pressure",
         {"scaled distance Z", "m/kg^⅓"},
         {"side-on pressure", "kPa"},
         {{"bodies", Series::Style::points}, {"Swisdak's table", Series::Style::points}, {"in the open"}}}};
    for (const auto& [z, kilopascal] : {std::pair{2.0, 283.7}, std::pair{2.5, 171.3}, std::pair{3.0, 115.7},
                                        std::pair{4.0, 64.89}, std::pair{5.0, 43.23}})
      d.plots[1].series[1].points.push_back({z, kilopascal});
    d.inputs = {{"again", "Once more", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0, {.friction = 0.7f});
    const double half = 0.5 * stage.value("height");
    rigid::BodyDef<Dim3> wall;
    wall.type = rigid::BodyType::fixed;
    wall.name = "wall";
    wall.position = {wall_, half, 0};
    stage.add(wall, geometry::Box{{float(thick_), float(half), 2.2f}}, {}, dark);
    for (int ring = 0; ring < 3; ++ring)
      for (int k = 0; k < 12; ++k) {
        const double radius = 3.2 + 2.6 * ring, angle = 2 * pi * (k + 0.5 * ring) / 12;
        const Vec3d place{radius * cos(angle), 0.301, radius * sin(angle)};
        if (abs(place.x - wall_) < 0.6 && abs(place.z) < 2.7) continue;
        rigid::BodyDef<Dim3> body;
        body.name = "box";
        body.position = place;
        boxes_.push_back(stage.add(body, geometry::Box{{0.3f, 0.3f, 0.3f}}, {.density = 150}, steel));
      }
    charge(stage);
    const double scale = scale_of(stage);
    for (double r = 1.6 * scale; r < 12; r *= 1.06) stage.sample(1, 2, r / scale, 1e-3 * blast_.wave_at(r).pressure);
  }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt / (passing(stage) ? max(stage.value("slow"), 1.0) : 3.0);
    if (auto s = blast_.apply(stage.world(), dt); !s) return s;
    last_dt_ = dt;
    return stage.world().step(float(dt));
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("again") > 0) charge(stage);
  }

  void after_step(Stage3& stage) override {
    constexpr std::uint32_t colors[] = {steel, gold, orange, red, violet, dark};
    const double now = stage.world().time(), since = now - blast_.charge().time;
    for (const auto& event : blast_.events()) {
      if (stage.at(event.body).type == rigid::BodyType::fixed) continue;
      stage.set_color(event.body, colors[int(event.damage)]);
      stage.sample(1, 0, event.distance / scale_of(stage), 1e-3 * event.pressure);
    }
    const double front = blast_.front_radius(now), up = over_ground(stage) ? blast_.charge().position.y : 0;
    if (passing(stage) && since > 0) {
      const double along = sqrt(max(0.0, front * front - up * up)), top = min(blast_.stem_height(along), front + up);
      for (int k = 0; k < 96; ++k) {
        const double a = 2 * pi * k / 96, b = 2 * pi * (k + 1) / 96;
        for (const double y : {0.05, 0.6})
          stage.line(Vec3d{along * cos(a), y, along * sin(a)}, Vec3d{along * cos(b), y, along * sin(b)},
                     pen(orange, y > 0.1 ? 0x60 : 0xff));
        const Vec3d from{front * cos(a), up + front * sin(a), 0}, to{front * cos(b), up + front * sin(b), 0};
        if (min(from.y, to.y) > -1e-9) stage.line(from, to, pen(gold, 0x90));  // upright, above the ground
        if (over_ground(stage) && k % 4 == 0 && top > 0)
          stage.line(Vec3d{along * cos(a), 0, along * sin(a)}, Vec3d{along * cos(a), top, along * sin(a)}, pen(violet));
      }
      for (int i = 0; i < 2; ++i) {
        // The mean over the step: a front falls within it.
        const double share = seen(stage, i);
        double p = 0;
        for (int k = 0; k < 16; ++k) p += share / 16 * free_pressure(i, now - last_dt_ * (k + 0.5) / 16);
        stage.sample(0, i, 1e3 * since, 1e-3 * p);
        sum_[i] += p * last_dt_;
        peak_[i] = max(peak_[i], p);
      }
    }
    if (over_ground(stage)) {
      constexpr int parts = 48;
      for (int k = 0; k < parts; ++k) {
        const double a = blast_.reach() * k / parts, b = blast_.reach() * (k + 1) / parts;
        for (const double side : {-1.0, 1.0})
          stage.line(Vec3d{side * a, blast_.stem_height(a), 0}, Vec3d{side * b, blast_.stem_height(b), 0},
                     pen(violet, 0x70));
      }
    }
    for (const Vec3d& g : gauges_) stage.line(Vec3d{g.x, 0, g.z}, Vec3d{g.x, g.y + 0.25, g.z}, pen(blue));
    if (passing(stage))
      stage.say(format("%.1f ms, front at %.1f m; gauges peak at %.0f and %.0f kPa", 1e3 * max(since, 0.0), front,
                       1e-3 * peak_[0], 1e-3 * peak_[1]));
    else
      stage.say(format("the wave has passed; gauges peaked at %.0f and %.0f kPa", 1e-3 * peak_[0], 1e-3 * peak_[1]));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    double impulse = 0;
    for (int k = 0; k < waves_[0].count; ++k) impulse += waves_[0].wave[k].impulse;
    const char* source = over_ground(stage) ? "i_s of what comes there" : "Swisdak's fit of i_s";
    out.push_back({"impulse at the open gauge", "Pa s", source, sum_[0], impulse, 0.03 * impulse});
    if (over_ground(stage)) {
      const double along = hypot(gauges_[0].x, gauges_[0].z), stem = stem_by_steps(along);
      out.push_back({"height of the Mach stem at the open gauge", "m", "the triple point's angle, in 4 000 steps",
                     blast_.stem_height(along), stem, max(0.02 * stem, 0.01)});
      // Under the triple point there is one wave, over it the charge's own and the ground's.
      out.push_back({"waves at the open gauge", "", "one within the stem, else two", double(waves_[0].count),
                     stem > gauges_[0].y ? 1.0 : 2.0, 0});
    }
    // A burst that is high enough sees the gauge over the wall.
    const Vec3d from = blast_.charge().position, to = gauges_[1];
    const double near = (wall_ - thick_) / to.x, far = (wall_ + thick_) / to.x;
    const bool hidden = from.y + (to.y - from.y) * (to.y < from.y ? far : near) < stage.value("height");
    out.push_back({"peak behind the wall by that in the open", "",
                   hidden ? "the share that comes round" : "seen over the wall", peak_[1] / peak_[0],
                   hidden ? stage.value("shelter") : 1, 0.01});
    Vec3d drift{};
    for (const BodyId box : boxes_) {
      const Vec3d p = stage.at(box).pose.position;
      if (p.x < 3) drift += Vec3d{0, 0, p.z};
    }
    out.push_back({"sum of the ways across, left side", "m", "mirror symmetry", drift.z, 0, 0.3});
  }

 private:
  void charge(Stage3& stage) {
    blast::Charge<Dim3> charge;
    charge.mass = stage.value("charge");
    const int air = stage.count("air");
    charge.position = {0, air == 2 ? stage.value("burst") : 0.02, 0};
    charge.burst = air == 2 ? blast::Burst::air : air == 1 ? blast::Burst::free_air : blast::Burst::ground;
    charge.time = stage.world().time() + 2e-3;
    charge.reach = 13;
    charge.shelter = stage.value("shelter");
    blast_ = stage.keep(blast::Explosion3::make(charge));
    for (int i = 0; i < 2; ++i) {
      peak_[i] = sum_[i] = 0;
      waves_[i] = blast_.waves_at(gauges_[i]);
    }
  }
  static bool over_ground(Stage3& stage) { return stage.count("air") == 2; }
  /// Where the triple point passes at a distance along the ground: from where the reflection is no more regular on.
  double stem_by_steps(double along) const {
    constexpr int steps = 4000;
    const double height = blast_.charge().position.y, dx = along / steps;
    double stem = 0;
    for (int k = 0; k < steps; ++k) {
      const double x = (k + 0.5) * dx;
      const auto r = blast::reflect(blast_.wave_at(hypot(height, x)).pressure, atan2(x, height));
      if (r.ok() && r->mach) stem += dx * tan(r->stem_angle);
    }
    return stem;
  }
  static double scale_of(Stage3& stage) { return cbrt(stage.value("charge") / (stage.value("air") > 0.5 ? 1.8 : 1)); }
  double free_pressure(int i, double time) const {
    double p = 0;
    for (int k = 0; k < waves_[i].count; ++k) {
      const blast::Wave& w = waves_[i].wave[k];
      p += blast::friedlander(w.pressure, w.duration, w.decay, time - blast_.charge().time - w.arrival);
    }
    return p;
  }
  /// 1, or the share that comes round the wall.
  double seen(Stage3& stage, int i) const {
    const double moment = blast_.charge().time + waves_[i].wave[0].arrival + 1e-4;
    return blast_.pressure_at(gauges_[i], moment, &stage.world()) / blast_.pressure_at(gauges_[i], moment);
  }
  bool passing(Stage3& stage) const { return !blast_.finished(stage.world().time()); }

  blast::Explosion3 blast_;
  blast::WavesAt<Dim3> waves_[2];
  std::vector<BodyId> boxes_;
  static constexpr double wall_ = 4, thick_ = 0.15;  // m, its middle and half of it
  static constexpr Vec3d gauges_[2] = {{-6.4, 1, 0.9}, {6.4, 1, 0.9}};
  double sum_[2] = {0, 0}, peak_[2] = {0, 0}, last_dt_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_blast_field() { return std::make_unique<Field>(); }

}  // namespace carom::host::demo
