// A massé on a carom table: the cue from above, the ball round an obstacle, and Coriolis' rule for its last direction.
#include "apps/host/demos/billiards/list.h"
#include "apps/host/demos/billiards/table_view.h"
#include "carom/sports/billiards_rack.h"

namespace carom::host::demo {
namespace {

using sports::BallPhase;
using sports::BilliardMotion;
using sports::Billiards;
using sports::BilliardTable;
using sports::Stroke;

class Masse final : public Repeatable<Masse, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "masse";
    d.title = "Massé";
    d.summary = "Struck from above and beside, the ball curves round another: a parabola, and then a straight line.";
    d.group = "Billiards";
    d.chapter = "19.7";
    d.text =
        "A steep cue gives spin about a level axis that does not fit the ball's way. While the ball slips, the cloth's "
        "friction has a constant direction, so the path is a parabola; when slip ends it rolls straight on.\n\n"
        "  v_roll = 5/7 v + 2/7 ω × R ŷ\n\n"
        "G. G. Coriolis found in 1835 where to: parallel to the line from the point where the ball stands on the cloth "
        "to "
        "the point at which the cue's line meets the cloth. The friction does not matter, only how soon. Gold: that "
        "line; "
        "white: the path, computed before the shot.\n\n"
        "Three balls, no pockets: touch both others to score.";
    d.dt = 1.0 / 60;
    d.duration = 5;
    d.camera = {{-1.5, 0.85, 0.85}, {-0.42, 0, -0.01}, 0.66};
    d.ground = -0.8;
    d.parameters = {
        {"direction", "Direction", "rad", "deg", "of the aim, counterclockwise from the table's length", -pi, pi, 0,
         0.40, true},
        {"speed", "Cue speed", "m/s", "m/s", "", 0.3, 6, 0, 2.8, true},
        {"side", "English (side)", "", "", "tip offset in ball radii", -0.6, 0.6, 0, 0.25, true},
        {"height", "Follow and draw", "", "", "tip offset in ball radii", -0.6, 0.6, 0, -0.4, true},
        {"elevation", "Elevation of the cue", "rad", "deg", "", 0, radians(85.0), 0, radians(50.0), true},
        yes_or_no("hold", "The cue holds the ball down", "or it may hop", true, true),
        {"friction", "Friction of the cloth μ_s", "", "", "", 0.1, 0.5, 0, 0.2, false},
    };
    d.plots = {{"Seen from above", {"x", "m"}, {"−z", "m"}, {{"cue ball"}, {"before the shot", Series::Style::points}}},
               {"Speeds", {"time", "s"}, {"speed", "m/s"}, {{"cue ball"}, {"slip on the cloth"}}}};
    d.inputs = {{"aim_left", "Aim left", {"ArrowLeft"}, false, 1},
                {"aim_right", "Aim right", {"ArrowRight"}, false, 1},
                {"shoot", "Strike", {"Space", "Enter"}, true, 1},
                {"rack", "Set up", {"KeyR"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    sports::BilliardPhysics physics = sports::carom_physics();
    physics.cloth.sliding_friction = stage.value("friction");
    const auto table = BilliardTable::create(sports::carom_table());
    if (!table) return stage.fail(table.error());
    auto game = Billiards::create(*table, physics);
    if (!game) return stage.fail(game.error());
    game_ = std::move(*game);
    stage.start({});
    add_table(stage, *table, {0x0f4f94, 0x145da8, 0x4a2408});
    set_up(stage);
    balls_.add(stage, *game_, BallBodies::carom());
    cue_.add(stage);
    show(stage);
  }

  void before_step(Stage3& stage) override {
    if (!game_) return;
    const double dt = stage.declaration().dt;
    if (stage.presses("rack") > 0) set_up(stage);
    const double turn = stage.input("aim_left") - stage.input("aim_right");
    if (turn != 0) stage.set_value("direction", clamp(stage.value("direction") + 0.3 * turn * dt, -pi, pi));
    const bool opening = shots_ == 0 && stage.world().time() >= 0.8;
    if ((stage.presses("shoot") > 0 || opening) && game_->next_event_time() == sports::never) strike(stage);
    clock_ += dt;
    stage.check(game_->run(clock_));
  }

  void after_step(Stage3& stage) override {
    if (!game_) return;
    show(stage);
    const sports::BilliardState s = game_->state(0);
    if (shots_ > 0 && s.phase != BallPhase::resting) {
      stage.sample(0, 0, s.position.x, -s.position.z);
      stage.sample(1, 0, clock_, length(s.velocity));
      stage.sample(1, 1, clock_, length(sports::bed_slip(s, game_->physics().ball.radius)));
    }
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    Vec3d rolls{};
    for (const BilliardMotion& m : first_)
      if (m.phase == BallPhase::rolling) {
        rolls = m.velocity;
        break;
      }
    out.push_back({"direction in which it rolls", "°", "Coriolis 1835", degrees(atan2(-rolls.z, rolls.x)),
                   degrees(coriolis_), 1e-6});
    out.push_back({"the ball that it touches first", "", "the red one, behind the other", double(met_), 2, 0});
  }

 private:
  Stroke stroke(Stage3& stage) const {
    Stroke s{stage.value("direction"), stage.value("speed"),     stage.value("side"),
             stage.value("height"),    stage.value("elevation"), stage.value("hold") > 0.5};
    const double off = hypot(s.side, s.height);
    if (off > 0.7) s.side *= 0.7 / off, s.height *= 0.7 / off;
    return s;
  }

  /// A shaft so light at its end that there is no squirt: Coriolis knew none.
  static sports::Cue cue() { return {.end_mass = 0}; }

  void set_up(Stage3& stage) {
    stage.check(game_->place(std::vector<Vec2d>{{-0.8, 0}, {-0.5, 0}, {-0.05, -0.03}}));
    clock_ = 0;
    balls_.reset();
    shots_ = 0;
    stage.say("Space strikes");
  }

  /// From the ball's foot to where the cue's line meets the cloth.
  Vec3d aim_point(const Stroke& s) const {
    const double r = game_->physics().ball.radius;
    const SinCos<double> turn = sincos(s.direction), rise = sincos(max(s.elevation, 0.02));
    const Vec3d ahead{turn.cos, 0, -turn.sin}, right{turn.sin, 0, turn.cos};
    const Vec3d along = rise.cos * ahead - Vec3d{0, rise.sin, 0}, up = rise.sin * ahead + Vec3d{0, rise.cos, 0};
    const Vec3d q =
        r * (s.side * right + s.height * up - sqrt(max(0.0, 1 - s.side * s.side - s.height * s.height)) * along) +
        Vec3d{0, r, 0};
    return q + (q.y / rise.sin) * along;
  }

  void strike(Stage3& stage) {
    game_->forget();
    const Stroke s = stroke(stage);
    Billiards alone = *game_;
    const auto hit = game_->strike(0, s, cue());
    if (!hit) {
      stage.say(hit.error().message);
      return;
    }
    ++shots_;
    met_ = 0;
    const Vec3d a = aim_point(s);
    coriolis_ = atan2(-a.z, a.x);
    // The same stroke on the whole: how it will go, for the plot and the verdict.
    if (alone.strike(0, s, cue()) && alone.run()) {
      first_.assign(alone.path(0).begin(), alone.path(0).end());
      bool touched[3] = {};
      double until = alone.time();
      for (const sports::BilliardEvent& e : alone.events())
        if (e.kind == sports::BilliardEvent::Kind::ball && (e.ball == 0 || e.other == 0)) {
          if (e.time < until) {
            until = e.time;
            met_ = e.ball == 0 ? e.other : e.ball;
          }
          touched[e.ball == 0 ? e.other : e.ball] = true;
        }
      touched_ = touched[1] + touched[2];
      for (int i = 0; i <= 60; ++i) {
        const Vec3d p = alone.state(0, until * i / 60).position;
        stage.sample(0, 1, p.x, -p.z);
      }
      stage.say(hit->miscue     ? std::string("miscue: the tip slipped off")
                : touched_ == 2 ? std::string("touches both: a point")
                                : format("touches %.0f of two", touched_));
    }
  }

  void show(Stage3& stage) {
    balls_.show(stage, *game_, game_->time(), stage.declaration().dt);
    const bool still = game_->next_event_time() == sports::never;
    const Vec3d foot = game_->state(0).position - Vec3d{0, game_->physics().ball.radius, 0};
    if (!still) {
      draw_path(stage, *game_, 0, 0, game_->time(), pen(0xffffff, 0xc0));
      cue_.put_away(stage, {0.7, -0.785, 1.3});
      return;
    }
    const Stroke s = stroke(stage);
    cue_.aim(stage, game_->state(0).position, game_->physics().ball.radius, s, 0.02);
    draw_preview(stage, *game_, 0, s, cue(), 1);
    const Vec3d a = aim_point(s), lift{0, 0.002, 0};
    stage.line(foot + lift, foot + a + lift, pen(gold));
    stage.line(foot + a + lift, foot + a + lift + 0.8 * normalize(a), pen(gold, 0x70));
  }

  std::optional<Billiards> game_;
  std::vector<BilliardMotion> first_;
  BallBodies balls_;
  CueBody cue_;
  double clock_ = 0, coriolis_ = 0;
  int shots_ = 0, touched_ = 0, met_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_masse() { return std::make_unique<Masse>(); }

}  // namespace carom::host::demo
