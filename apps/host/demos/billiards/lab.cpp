// Stun, draw and follow beside their formulas; deflection and throw over the cut angle.
#include "apps/host/demos/billiards/list.h"
#include "apps/host/demos/billiards/table_view.h"

namespace carom::host::demo {
namespace {

using sports::BallPhase;
using sports::BilliardMotion;
using sports::BilliardPhysics;
using sports::Billiards;
using sports::BilliardState;
using sports::BilliardTable;

class BilliardsLab final : public Repeatable<BilliardsLab, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "billiards-lab";
    d.title = "Stun, draw and follow";
    d.summary =
        "Three cue balls meet their object balls head-on, alike but for their spin; the formulas lie under the curves.";
    d.group = "Billiards";
    d.chapter = "19.7, 19.8";
    d.text =
        "Head-on, with e = 1, the object ball takes the speed of the cue ball, and the cue ball keeps its spin. What "
        "it "
        "does then its spin decides:\n\n"
        "  v = ± μ_s g t while it slips, to 2/7 R ω₀ at t = 2 R|ω₀|/(7 μ_s g);  then it rolls, slower by μ_r g\n\n"
        "Follow goes on, stun stays, draw comes back. The object ball slides, and rolls at last with 5/7 of its "
        "speed.\n\n"
        "A rolling cue ball leaves a cut of φ at tan θ = sin φ cos φ/(sin²φ + 2/5), which is near 30° to 34° for most "
        "cuts: the thirty-degree rule. Points: the engine. Friction throws the object ball off the line of centres; "
        "the "
        "published values are Alciatore's (TP A.14) for a stun shot at 1.341 m/s.";
    d.dt = 1.0 / 60;
    d.duration = 6;
    d.loop = true;
    d.camera = {{0, 2.5, 2.6}, {0, 0, 0.05}, 0.8};
    d.ground = -0.8;
    d.parameters = {
        {"speed", "Speed at the start", "m/s", "m/s", "", 0.5, 3, 0, 1.6, false},
        {"spin", "Draw and follow", "", "", "spin at the impact, in that of rolling", 0.2, 1.5, 0, 1, false},
        {"sliding", "Friction of the cloth μ_s", "", "", "", 0.1, 0.5, 0, 0.2, false},
    };
    d.plots = {
        {"Cue balls after the impact",
         {"time", "s"},
         {"x", "m"},
         {{"follow"},
          {"stun"},
          {"draw"},
          {"formula for follow", Series::Style::points},
          {"for stun", Series::Style::points},
          {"for draw", Series::Style::points}}},
        {"Speed of the object balls",
         {"time", "s"},
         {"speed", "m/s"},
         {{"object ball"}, {"5/7 v", Series::Style::points}}},
        {"Deflection of a rolling cue ball",
         {"cut angle", "°"},
         {"final deflection", "°"},
         {{"formula", Series::Style::line, deflection_curve()}, {"engine", Series::Style::points}}},
        {"Throw",
         {"cut angle", "°"},
         {"throw", "°"},
         {{"engine"},
          {"Alciatore, TP A.14", Series::Style::points, {{15, 2.1921}, {30, 3.5491}, {45, 2.7734}, {60, 2.3179}}}}}};
    return d;
  }

  void build(Stage3& stage) override {
    BilliardPhysics physics;
    physics.balls = {.restitution = 1, .friction_floor = 0, .friction_range = 0};
    physics.cloth.sliding_friction = stage.value("sliding");
    const auto table = BilliardTable::create(sports::carom_table());
    if (!table) return stage.fail(table.error());
    auto game = Billiards::create(*table, physics);
    if (!game) return stage.fail(game.error());
    game_ = std::move(*game);
    stage.start({});
    add_table(stage, *table, {0x0f4f86, 0x14609e, 0x3f1d0a});
    const double r = physics.ball.radius, v = stage.value("speed");
    std::vector<Vec2d> places;
    for (int lane = 0; lane < 3; ++lane)
      places.push_back({from_, 0.36 * (lane - 1)}), places.push_back({from_ + way_ + 2 * r, 0.36 * (lane - 1)});
    stage.check(game_->place(places));
    const double a = physics.cloth.sliding_friction * physics.gravity;
    for (int lane = 0; lane < 3; ++lane) {
      const double wanted = (1 - lane) * stage.value("spin");  // at the impact, in v/R
      // Backward from the impact: a follow shot rolls all the way; the others slip forward until then.
      double speed = v, spin = v;
      if (lane > 0) {
        const double t = (v - sqrt(max(0.0, v * v - 2 * a * way_))) / a;
        const double left = v - a * t;
        spin = wanted * left - 2.5 * a * t;
      } else {
        spin = wanted * v;
      }
      stage.check(game_->set_state(
          2 * lane,
          {{from_, r, places[2 * std::size_t(lane)].y}, {speed, 0, 0}, {0, 0, -spin / r}, BallPhase::sliding}));
    }
    stage.check(game_->run());
    balls_.add(stage, *game_,
               {{0xf6f1e3, BallBodies::Kind::solid},
                {0xd0342c, BallBodies::Kind::solid},
                {0xf6f1e3, BallBodies::Kind::solid},
                {0xf2c21b, BallBodies::Kind::solid},
                {0xf6f1e3, BallBodies::Kind::solid},
                {0x1f4fa8, BallBodies::Kind::solid}});
    formulas();
    angles(stage);
  }

  void after_step(Stage3& stage) override {
    if (!game_) return;
    const double t = min(stage.world().time(), game_->time());
    balls_.show(stage, *game_, t, stage.declaration().dt);
    for (int lane = 0; lane < 3; ++lane) {
      const BilliardState cue = game_->state(2 * lane, t);
      if (t < limit_) stage.sample(0, lane, t, cue.position.x);
      draw_path(stage, *game_, 2 * lane, 0, t, pen(0xffffff, 0xa0));
      draw_path(stage, *game_, 2 * lane + 1, 0, t, pen(gold, 0xa0));
    }
    if (t < limit_) stage.sample(1, 0, t, game_->state(3, t).velocity.x);
    if (stage.world().time() >= 0.2 && !told_) {
      told_ = true;
      for (const Sample& point : points_) stage.sample(point.plot, point.series, point.x, point.y);
    }
    stage.say(t < impact_[0] ? "back: follow, middle: stun, front: draw" : "");
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double r = game_->physics().ball.radius;
    const char* names[3] = {"follow", "stun", "draw"};
    for (int lane = 0; lane < 3; ++lane) {
      double rolled = 0;
      for (const BilliardMotion& m : game_->path(2 * lane))
        if (m.start > impact_[lane] + 1e-9 && m.phase == BallPhase::rolling) {
          rolled = m.velocity.x;
          break;
        }
      out.push_back({std::string("final speed, ") + names[lane], "m/s", "2/7 R ω at the impact", rolled,
                     2 * r * spin_[lane] / 7, 1e-7});
    }
    out.push_back({"cut of the greatest deflection: deflection", "°", "33.749° (exact)", greatest_, 33.749, 0.01});
    (void)stage;
  }

 private:
  static constexpr double from_ = -0.75, way_ = 0.25;

  static std::vector<Vec2d> deflection_curve() {
    std::vector<Vec2d> points;
    for (int i = 1; i < 90; ++i) {
      const double cut = radians(double(i)), s = sin(cut), c = cos(cut);
      points.push_back({double(i), degrees(atan2(s * c, s * s + 0.4))});
    }
    return points;
  }

  /// The curves from the state at the impact.
  void formulas() {
    const double r = game_->physics().ball.radius,
                 a = game_->physics().cloth.sliding_friction * game_->physics().gravity,
                 slow = game_->physics().cloth.rolling_friction * game_->physics().gravity;
    for (const sports::BilliardEvent& e : game_->events()) {
      const bool rubber = e.kind == sports::BilliardEvent::Kind::cushion;
      if (rubber) limit_ = min(limit_, e.time);
      if (e.kind != sports::BilliardEvent::Kind::ball) continue;
      const std::size_t lane = std::size_t(e.ball / 2);
      if (impact_[lane] > 0) {
        limit_ = min(limit_, e.time);
        continue;
      }
      impact_[lane] = e.time;
      // A hair before.
      const BilliardState s = game_->state(e.ball, e.time - 1e-9);
      spin_[lane] = -s.angular_velocity.z;
      at_[lane] = s.velocity.x;
    }
    for (std::size_t lane = 0; lane < 3; ++lane)
      for (double t = 0.1; t < 3; t += 0.1) {
        const double sign = spin_[lane] < 0 ? -1 : 1, slip = abs(r * spin_[lane]), grip = 2 * slip / (7 * a);
        const double sliding = min(t, grip), rolling = clamp(t - grip, 0.0, 2 * slip / (7 * slow));
        const double x = 0.5 * a * sliding * sliding + 2 * slip / 7 * rolling - 0.5 * slow * rolling * rolling;
        if (impact_[lane] + t < limit_)
          points_.push_back({0, 3 + int(lane), impact_[lane] + t, from_ + way_ + sign * x});
      }
    const double v = at_[1], grip = 2 * v / (7 * a);
    for (double t = 0.02; t < 2; t += 0.06)
      if (impact_[1] + t < limit_)
        points_.push_back({1, 1, impact_[1] + t, t < grip ? v - a * t : 5 * v / 7 - slow * (t - grip)});
  }

  void angles(Stage3& stage) {
    BilliardPhysics smooth;
    smooth.balls = {.restitution = 1, .friction_floor = 0, .friction_range = 0};
    const auto table = BilliardTable::create(sports::RectangularTable{.length = 60, .width = 60, .pockets = false});
    if (!table) return stage.fail(table.error());
    auto game = Billiards::create(*table, smooth);
    if (!game) return stage.fail(game.error());
    const double r = smooth.ball.radius, apart = 2 * r * (1 + 1e-9);
    for (double i = 2.125505; i < 88; i += 2) {
      const double cut = radians(i);
      stage.check(game->place(std::vector<Vec2d>{{0, 0}, {apart * cos(cut), apart * sin(cut)}}));
      stage.check(game->set_state(0, {{0, r, 0}, {1, 0, 0}, {0, 0, -1 / r}, BallPhase::sliding}));
      stage.check(game->run());
      for (const BilliardMotion& m : game->path(0))
        if (m.start > 1e-6 && m.phase == BallPhase::rolling) {
          const double angle = degrees(atan2(-m.velocity.z, m.velocity.x));
          points_.push_back({2, 1, i, angle});
          greatest_ = max(greatest_, angle);
          break;
        }
    }
    BilliardPhysics rough;
    rough.balls.restitution = 1;
    for (double i = 0; i <= 85; i += 1) {
      const double cut = radians(i);
      const Vec3d n{cos(cut), 0, -sin(cut)};
      BilliardState cue{{0, r, 0}, {1.341, 0, 0}, {}, BallPhase::sliding}, object{2 * r * n + Vec3d{0, r, 0}};
      sports::strike_balls(cue, object, n, true, rough);
      points_.push_back(
          {3, 0, i, degrees(abs(atan2(dot(object.velocity, Vec3d{n.z, 0, -n.x}), dot(object.velocity, n))))});
    }
  }

  std::optional<Billiards> game_;
  BallBodies balls_;
  std::vector<Sample> points_;  ///< of formulas and single impacts: told once, early in the run
  bool told_ = false;
  double impact_[3] = {}, spin_[3] = {}, at_[3] = {}, limit_ = 1e9, greatest_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_billiards_lab() { return std::make_unique<BilliardsLab>(); }

}  // namespace carom::host::demo
