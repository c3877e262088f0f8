// The break of fifteen balls, seen from above and slowed down: where the energy goes.
#include "apps/host/demos/billiards/list.h"
#include "apps/host/demos/billiards/table_view.h"
#include "carom/sports/billiards_rack.h"

namespace carom::host::demo {
namespace {

using sports::Billiards;
using sports::BilliardTable;

class BreakShot final : public Repeatable<BreakShot, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "break-shot";
    d.title = "The break";
    d.summary = "Fifteen balls that touch are struck at once; speed, gaps in the rack and aim decide who goes where.";
    d.group = "Billiards";
    d.chapter = "19.6, 19.8";
    d.text =
        "In a frozen rack all contacts are compressed at the same time, and how much each ball gets follows from how "
        "its "
        "contacts are compressed: F ∝ δ^(3/2) (Hertz). The engine integrates that one impact; everything before and "
        "after "
        "is computed from event to event.\n\n"
        "  δ = v T/2.94,  T ≈ 250 µs · (v / 1 m/s)^(−1/5)\n\n"
        "A break at 9 m/s presses the balls half a millimetre into each other, so gaps of a tenth of that hardly "
        "matter; "
        "with gaps of a millimetre the balls strike one after the other, and the break is weaker.\n\n"
        "Energy is lost in impacts (balls e = 0.95, cushions e = 0.85) and to the cloth while balls slide and roll. It "
        "never rises. The whole shot is computed in a tenth of a millisecond, before the first picture; what runs here "
        "is its replay.";
    d.dt = 1.0 / 60;
    d.duration = 10;
    d.camera = {{0, 3.5, 0.75}, {0, 0, 0.05}, 0.75};
    d.ground = -0.8;
    d.parameters = {
        {"speed", "Speed of the cue ball", "m/s", "m/s", "", 1, 14, 0, 9, false},
        {"gap", "Gaps in the rack", "m", "mm", "between neighbours", 0, 0.003, 0, 0, false},
        {"offset", "Cue ball beside the middle", "m", "mm", "", -0.5, 0.5, 0, 0.2, false},
        {"side", "Aim beside the apex", "m", "mm", "", -0.02, 0.02, 0, 0, false},
        {"pace", "Pace", "", "", "1: as it was", 0.02, 2, 0, 0.6, true},
        {"seed", "Another rack", "", "", "", 1, 99, 1, 1, false},
    };
    d.plots = {{"Energy", {"time", "s"}, {"energy", "J"}, {{"all balls"}, {"cue ball"}}},
               {"How many balls move", {"time", "s"}, {"balls", ""}, {{"moving"}, {"down"}}}};
    d.inputs = {{"again", "Break again", {"Space", "Enter", "KeyR"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    const sports::RectangularTable shape = sports::nine_foot_pool();
    const sports::BilliardPhysics physics = sports::pool_physics();
    const auto table = BilliardTable::create(shape);
    if (!table) return stage.fail(table.error());
    auto game = Billiards::create(*table, physics);
    if (!game) return stage.fail(game.error());
    game_ = std::move(*game);
    layout_ = sports::eight_ball_rack(shape, physics.ball.radius,
                                      {stage.value("gap"), 1, std::uint64_t(stage.count("seed"))});
    layout_[0].y = stage.value("offset");
    stage.start({});
    add_table(stage, *table, {0x0f4f94, 0x145da8, 0x1c1e22});
    compute(stage);
    balls_.add(stage, *game_, BallBodies::pool());
  }

  void before_step(Stage3& stage) override {
    if (!game_) return;
    if (stage.presses("again") > 0) clock_ = 0, balls_.reset();
    clock_ = min(clock_ + stage.value("pace") * stage.declaration().dt, game_->time());
  }

  void after_step(Stage3& stage) override {
    if (!game_) return;
    balls_.show(stage, *game_, clock_, stage.value("pace") * stage.declaration().dt);
    double all = 0, cue = 0;
    int moving = 0, down = 0;
    for (int i = 0; i < game_->balls(); ++i) {
      const sports::BilliardState s = game_->state(i, clock_);
      if (!in_play(s.phase)) {
        ++down;
        continue;
      }
      const double e = sports::energy(s, game_->physics());
      all += e;
      if (i == 0) cue = e;
      moving += s.phase != sports::BallPhase::resting;
      if (clock_ > impact_) draw_path(stage, *game_, i, max(impact_, clock_ - 0.5), clock_, pen(0xffffff, 0x70));
    }
    stage.sample(0, 0, clock_, all);
    stage.sample(0, 1, clock_, cue);
    stage.sample(1, 0, clock_, moving);
    stage.sample(1, 1, clock_, down);
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    // The record, walked through finely.
    double before = 1e9, rise = 0;
    for (double t = 0; t < game_->time(); t += 1e-3) {
      double all = 0;
      for (int i = 0; i < game_->balls(); ++i)
        if (const sports::BilliardState s = game_->state(i, t); in_play(s.phase))
          all += sports::energy(s, game_->physics());
      if (t > 0) rise = max(rise, all - before);
      before = all;
    }
    out.push_back({"greatest rise of energy", "J", "energy never rises", rise, 0, 1e-6});
    int moved = 0;
    for (int i = 1; i < game_->balls(); ++i) moved += game_->path(i).size() > 1;
    out.push_back({"balls that move", "", "the whole rack", double(moved), 15, 0});
    out.push_back({"momentum along the table after the impact", "kg m/s", "as before, friction of the cloth apart",
                   momentum_ / came_, 1, 2e-3});
  }

 private:
  void compute(Stage3& stage) {
    stage.check(game_->place(layout_));
    const double speed = stage.value("speed"), m = game_->physics().ball.mass;
    const Vec2d aim = layout_[1] + Vec2d{0, stage.value("side")} - layout_[0];
    // So that the ball has that speed: v = 2V/(1 + m/M).
    const auto hit = game_->strike(0, {.direction = sports::aim_direction(aim), .speed = speed * (1 + m / 0.567) / 2});
    if (!hit) return stage.fail(hit.error());
    stage.check(game_->run());
    int down = 0;
    for (const sports::BilliardEvent& e : game_->events()) {
      down += e.kind == sports::BilliardEvent::Kind::pocket;
      if (impact_ == 0 && e.kind == sports::BilliardEvent::Kind::ball) impact_ = e.time;
    }
    came_ = momentum_ = 0;
    for (int i = 0; i < game_->balls(); ++i) {
      came_ += game_->state(i, impact_ - 1e-9).velocity.x;
      momentum_ += game_->state(i, impact_ + 1e-9).velocity.x;
    }
    clock_ = 0;
    stage.say(format("%.0f events, %.0f balls down, all at rest after %.1f s", double(game_->event_count()), down,
                     game_->rest_time()));
  }

  std::optional<Billiards> game_;
  std::vector<Vec2d> layout_;
  BallBodies balls_;
  double clock_ = 0, impact_ = 0, momentum_ = 0, came_ = 1;
};

}  // namespace

std::unique_ptr<Demo> make_break_shot() { return std::make_unique<BreakShot>(); }

}  // namespace carom::host::demo
