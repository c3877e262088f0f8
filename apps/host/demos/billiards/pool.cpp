// A table to play on, of pool, snooker, pyramid or carom: aim, speed, english and elevation; what the shot would do is
// drawn before it is played.
#include <algorithm>
#include <array>

#include "apps/host/demos/billiards/list.h"

#include "apps/host/demos/billiards/table_view.h"
#include "carom/sports/billiards_rack.h"
#include "carom/sports/billiards_solver.h"

namespace carom::host::demo {
namespace {

using sports::Billiards;
using sports::BilliardState;
using sports::BilliardTable;
using sports::Stroke;

class PoolTable final : public Repeatable<PoolTable, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "pool-table";
    d.title = "Pool table";
    d.summary = "Play: aim, choose speed, english and elevation, and see beforehand where the balls will go.";
    d.group = "Billiards";
    d.chapter = "19.3–19.8";
    d.text =
        "Nothing is stepped here. Between two events every ball moves on a polynomial (a parabola while it slides, a "
        "straight line while it rolls), and the engine computes the next moment at which something happens: slip ends, "
        "a ball stops, meets another, a cushion, a jaw or a pocket. So the lines drawn before the shot are the "
        "shot.\n\n"
        "  sliding: a = −μ_s g û,  dω/dt = 5 μ_s g/(2R)      rolling: a = −μ_r g v̂\n\n"
        "A ball that leaves the cue with the slip u₀ = v₀ − R ω₀ slides for 2u₀/(7μ_s g), loses 2/7 of the slip, and "
        "rolls (Shepard, Amateur Physics for the Amateur Pool Player, 1997): the points, anew from every contact.\n\n"
        "The tip's offset gives spin, ω = (5/2) v b/R, and pushes the ball a little to the other side (squirt). Balls "
        "throw each other by friction that falls with slip; cushions are Stronge's compliant impact. White: the cue "
        "ball up to its first ball, and after; gold: the object ball; the circle is the ghost ball.\n\n"
        "Pull the golden ball to aim, or use the arrow keys; Space strikes, A lets the solver look for a shot and set "
        "the sliders, R racks anew. The solver knows pots, banks and kicks; on the carom table, which has no pockets, "
        "the aim is yours: the cue ball is to touch both others, and in three-cushion three cushions before the "
        "second. The opening there is a stroke that scores; its aim may be off by .3°.";
    d.dt = 1.0 / 60;
    d.duration = 12;
    d.camera = {{-3.0, 1.85, 0.62}, {-0.15, -0.05, 0.02}, 0.72};
    d.ground = -0.8;
    d.parameters = {
        {"direction", "Direction", "rad", "deg", "of the aim, counterclockwise from the table's length", -pi, pi, 0,
         -0.015, true},
        {"speed", "Cue speed", "m/s", "m/s", "", 0.2, 9, 0, 6.5, true},
        {"side", "English (side)", "", "", "tip offset in ball radii, right is positive", -0.6, 0.6, 0, 0, true},
        {"height", "Follow and draw", "", "", "tip offset in ball radii, up is follow", -0.6, 0.6, 0, 0.1, true},
        {"elevation", "Elevation of the cue", "rad", "deg", "", 0, radians(75.0), 0, 0, true},
        choice("preview", "Preview", "of the way of the cue ball",
               {"none", "to the first ball", "one cushion more", "two cushions more"}, 2, true),
        choice("table", "Table", "", {"pool, 7 ft", "pool, 8 ft", "pool, 9 ft", "snooker", "Russian pyramid", "carom"},
               2),
    };
    d.plots = {{"Speed of the cue ball",
                {"time", "s"},
                {"speed", "m/s"},
                {{"cue ball"}, {"slides, then rolls", Series::Style::points}}},
               {"Energy", {"time", "s"}, {"energy of the balls", "J"}, {{"all"}}}};
    d.inputs = {{"aim_left", "Aim left", {"ArrowLeft"}, false, 1},
                {"aim_right", "Aim right", {"ArrowRight"}, false, 1},
                {"aim_fine", "Aim finely", {"ShiftLeft", "ShiftRight"}, false, 1},
                {"shoot", "Strike", {"Space", "Enter"}, true, 1},
                {"solve", "Find a shot", {"KeyA"}, true, 1},
                {"rack", "Rack", {"KeyR"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    const int kind = std::clamp(stage.count("table"), 0, 5);
    const sports::RectangularTable shapes[6] = {sports::seven_foot_pool(), sports::eight_foot_pool(),
                                                sports::nine_foot_pool(),  sports::snooker_table(),
                                                sports::russian_table(),   sports::carom_table()};
    shape_ = shapes[kind];
    carom_ = kind == 5;
    choose_opening(stage);
    const sports::BilliardPhysics physics = kind == 3   ? sports::snooker_physics()
                                            : kind == 4 ? sports::russian_physics()
                                            : carom_    ? sports::carom_physics()
                                                        : sports::pool_physics();
    const auto table = BilliardTable::create(shape_);
    if (!table) return stage.fail(table.error());
    auto game = Billiards::create(*table, physics);
    if (!game) return stage.fail(game.error());
    game_ = std::move(*game);
    const double radius = physics.ball.radius;
    layout_ = kind == 3 ? sports::snooker_rack(shape_, radius)
              : carom_  ? sports::carom_opening(shape_, radius)
                        : sports::eight_ball_rack(shape_, radius, {2e-5, 1, 7});
    stage.start({});
    add_table(stage, *table,
              kind == 3   ? TableColors{0x0a5c2c, 0x0d6e36, 0x3f1d0a}
              : kind == 4 ? TableColors{0x0c4a78, 0x10598e, 0x4a2408}
              : carom_    ? TableColors{0x0f4f94, 0x145da8, 0x4a2408}
                          : TableColors{});
    rack(stage);
    balls_.add(stage, *game_,
               kind == 3   ? BallBodies::snooker()
               : kind == 4 ? BallBodies::russian()
               : carom_    ? BallBodies::carom()
                           : BallBodies::pool());
    cue_.add(stage);
    rigid::BodyDef<rigid::Dim3> handle;
    handle.name = "aim";
    handle.gravity_scale = 0;
    handle.linear_damping = 12;
    handle.allow_sleep = false;
    handle.locks = {false, true, false, true, true, true};
    rigid::ShapeDef<rigid::Dim3> shape;
    shape.material.user_id = 0xff000000u | gold;
    handle_ = stage.add(handle, geometry::Sphere{0.021f}, shape, gold);
    const double scale = shape_.length / 2.54;
    Camera camera = stage.declaration().camera;
    camera.position = scale * camera.position, camera.target = scale * camera.target;
    stage.set_camera(camera);
    show(stage);
  }

  void before_step(Stage3& stage) override {
    if (!game_) return;
    const double dt = stage.declaration().dt;
    if (stage.presses("rack") > 0) rack(stage);
    const double turn = stage.input("aim_left") - stage.input("aim_right");
    if (turn != 0) {
      double to = stage.value("direction") + turn * dt * (stage.input("aim_fine") > 0 ? 0.03 : 0.5);
      if (to > pi) to -= 2 * pi;
      if (to < -pi) to += 2 * pi;
      stage.set_value("direction", to);
    }
    const bool still = resting();
    if (stage.presses("solve") > 0 && still) find_shot(stage);
    const bool opening = shots_ == 0 && stage.world().time() >= 0.8;
    if ((stage.presses("shoot") > 0 || opening) && still && stroke_clock_ < 0) stroke_clock_ = 0;
    if (stroke_clock_ >= 0) {
      stroke_clock_ += dt;
      if (stroke_clock_ >= backswing_) strike(stage);
    }
    clock_ += dt;
    const core::Status ran = game_->run(clock_);
    stage.check(ran);
  }

  void after_step(Stage3& stage) override {
    if (!game_) return;
    drag(stage);
    show(stage);
    const double t = stage.world().time(), energy = game_->energy();
    stage.sample(1, 0, t, energy);
    stage.sample(0, 0, t, length(game_->state(0).velocity));
    follow_law(stage, t);
    if (shots_ > 0 && !struck_) rise_ = max(rise_, energy - energy_);
    struck_ = false;
    energy_ = energy;
    if (carom_ && shots_ == 1) opening_ = score();
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double m = game_->physics().ball.mass, offset = square(stage.value("side")) + square(stage.value("height"));
    out.push_back({"speed of the cue ball", "m/s", "2V/(1 + m/M + 2.5 b²)", started_,
                   2 * stage.value("speed") / (1 + m / 0.567 + 2.5 * offset), 1e-9});
    if (carom_) return carom_expectations(out);
    const double way = distance(start_[0], start_[1]) - 2 * game_->physics().ball.radius;  // to the foremost ball
    out.push_back({"time that the cue ball keeps to sliding and rolling", "s", "up to its first contact",
                   law_time_ - law_from_, way / started_, 2.0 / 60});
    out.push_back(rise());
    int moved = 0;
    for (int i = 1; i < game_->balls(); ++i) moved += distance(game_->state(i).position, start_[std::size_t(i)]) > 0.02;
    out.push_back({"balls that the break moved", "", "all fifteen", double(moved), 15, 0});
  }

 private:
  static constexpr double backswing_ = 0.55;
  static constexpr const char* aims_[4] = {"direction", "speed", "side", "height"};
  using Opening = std::array<double, 4>;

  /// Whoever changes the game with the sliders at its opening stroke gets that of the other.
  void choose_opening(Stage3& stage) const {
    const Opening broken{-0.015, 6.5, 0, 0.1}, scored{radians(7.35), 5, 0.4, 0};
    const Opening &from = carom_ ? broken : scored, &to = carom_ ? scored : broken;
    for (std::size_t i = 0; i < 4; ++i)
      if (abs(stage.value(aims_[i]) - from[i]) > 1e-6) return;
    for (std::size_t i = 0; i < 4; ++i) stage.set_value(aims_[i], to[i]);
  }

  /// What the cue ball has touched since the stroke.
  struct Score {
    int balls = 0, cushions = 0;  ///< others; cushions before the second of them
  };
  Score score() const {
    Score s;
    int first = 0;
    for (const sports::BilliardEvent& e : game_->events()) {
      s.cushions += e.kind == sports::BilliardEvent::Kind::cushion && e.ball == 0;
      if (e.kind != sports::BilliardEvent::Kind::ball || (e.ball != 0 && e.other != 0)) continue;
      const int other = e.ball + e.other;
      if (s.balls == 0) s.balls = 1, first = other;
      if (other == first) continue;
      s.balls = 2;
      break;
    }
    return s;
  }

  Expectation rise() const { return {"greatest rise of energy in a step", "J", "energy never rises", rise_, 0, 1e-6}; }
  void carom_expectations(std::vector<Expectation>& out) const {
    // Along its line to where it is two radii from the red, slowed by the sliding that the stroke began.
    const auto& physics = game_->physics();
    const Vec3d to = start_[2] - start_[0], line = left_ / max(length(left_), 1e-9);
    const double along = dot(to, line), beside = dot(to, to) - along * along, slows = physics.cloth.sliding_friction;
    const double way = along - sqrt(max(0.0, square(2 * physics.ball.radius) - beside)), a = slows * physics.gravity;
    const double time = (started_ - sqrt(max(0.0, started_ * started_ - 2 * a * way))) / a;
    out.push_back({"time that the cue ball keeps to sliding", "s", "x = v t − ½ μ_s g t², up to its first contact",
                   law_time_ - law_from_, time, 2.0 / 60});
    out.push_back(rise());
    out.push_back({"balls that the opening touches", "", "both: a point", double(opening_.balls), 2, 0});
    out.push_back({"cushions before the second", "", "three-cushion", double(opening_.cushions), 3, 0});
  }

  Stroke stroke(Stage3& stage) const {
    Stroke s{stage.value("direction"), stage.value("speed"), stage.value("side"), stage.value("height"),
             stage.value("elevation")};
    // The tip stays on the ball.
    const double off = hypot(s.side, s.height);
    if (off > 0.7) s.side *= 0.7 / off, s.height *= 0.7 / off;
    return s;
  }
  bool resting() const { return game_->next_event_time() == sports::never; }

  /// The speed by the law of sliding and rolling, from the stroke or the last contact on.
  void follow_law(Stage3& stage, double t) {
    const auto& physics = game_->physics();
    const BilliardState now = game_->state(0);
    const double g = physics.gravity, since = clock_ - law_at_, slip = length(law_slip_);
    const double slides = 2 * slip / (7 * physics.cloth.sliding_friction * g);
    Vec3d law = law_velocity_;
    if (slip > 0) law -= (physics.cloth.sliding_friction * g * min(since, slides) / slip) * law_slip_;
    const double speed = length(law), rolled = physics.cloth.rolling_friction * g * max(0.0, since - slides);
    if (speed > 0) law *= max(0.0, speed - rolled) / speed;
    if (distance(law, now.velocity) < 1e-6) {
      if (length(law) > 0 && ++law_steps_ % 6 == 1) stage.sample(0, 1, t, length(law));
      if (free_) law_time_ = t;
      return;
    }
    free_ = false;
    begin_law(now, clock_);
  }
  void begin_law(const BilliardState& state, double time) {
    law_at_ = time;
    law_velocity_ = state.velocity;
    law_slip_ = sports::bed_slip(state, game_->physics().ball.radius);
  }

  /// The golden ball on the line of aim may be pulled: the cue follows.
  void drag(Stage3& stage) {
    const Vec3d ball = game_->state(0).position;
    if (!resting() || !in_play(game_->state(0).phase)) {
      handle_place_ = {0, -0.78, -shape_.width / 2 - 0.6};
    } else {
      const Vec3d p = stage.at(handle_).pose.position;
      if (handle_place_.y > 0 && distance(p, handle_place_) > 3e-4) {
        const Vec2d way{p.x - ball.x, p.z - ball.z};
        if (length(way) > 0.05) stage.set_value("direction", sports::aim_direction(way));
        handle_away_ = clamp(length(way), 0.15, 1.6);
      }
      const Vec2d way = handle_away_ * sports::aim_vector(stage.value("direction"));
      handle_place_ = {ball.x + way.x, ball.y, ball.z + way.y};
    }
    stage.check(stage.world().set_pose(handle_, handle_place_, {}));
    stage.check(stage.world().set_velocity(handle_, {}, {}));
  }

  void rack(Stage3& stage) {
    stage.check(game_->place(layout_));
    start_.clear();
    for (int i = 0; i < game_->balls(); ++i) start_.push_back(game_->state(i).position);
    clock_ = 0;
    stroke_clock_ = -1;
    balls_.reset();
    stage.say("pull the golden ball to aim, Space strikes");
  }

  void strike(Stage3& stage) {
    stroke_clock_ = -1;
    game_->forget();
    const auto hit = game_->strike(0, stroke(stage));
    if (!hit) {
      stage.say(hit.error().message);
      return;
    }
    ++shots_;
    struck_ = true;
    struck_at_ = game_->time();
    if (shots_ == 1) {
      left_ = hit->velocity;
      started_ = length(left_);
      free_ = true;
      law_from_ = stage.world().time();
    }
    begin_law(game_->state(0), struck_at_);
    stage.say(hit->miscue ? std::string("miscue: the tip slipped off")
                          : format("%.1f m/s, squirt %.1f°", length(hit->velocity), degrees(hit->squirt)));
    reported_ = false;
  }

  void show(Stage3& stage) {
    balls_.show(stage, *game_, game_->time(), stage.declaration().dt);
    if (!resting()) {
      cue_.put_away(stage, {0.75, -0.785, shape_.width / 2 + 0.62});
      return;
    }
    if (shots_ > 0 && !reported_) report(stage);
    if (!in_play(game_->state(0).phase)) return;
    const Stroke s = stroke(stage);
    double back = 0.03;
    if (stroke_clock_ >= 0) {
      const double part = stroke_clock_ / backswing_;
      back = part < 0.7 ? 0.03 + 0.22 * square(sin(pi / 2 * part / 0.7)) : 0.25 * (1 - square((part - 0.7) / 0.3));
    }
    cue_.aim(stage, game_->state(0).position, game_->physics().ball.radius, s, max(0.0, back));
    const int preview = stage.count("preview");
    if (preview > 0) draw_preview(stage, *game_, 0, s, {}, preview - 1);
  }

  void report(Stage3& stage) {
    reported_ = true;
    if (carom_) {
      const Score s = score();
      stage.say(s.balls == 2 ? format("touches both, %.0f cushions before the second: a point", s.cushions) +
                                   (s.cushions >= 3 ? ", of three-cushion too" : "")
                             : format("touches %.0f of two", s.balls));
      return;
    }
    int down = 0;
    for (int i = 1; i < game_->balls(); ++i) down += !in_play(game_->state(i).phase);
    const bool scratch = !in_play(game_->state(0).phase);
    if (scratch) {
      // In hand: to the head spot, or beside it where that is taken.
      const double r = game_->physics().ball.radius;
      for (int i = 0; i < 40; ++i) {
        const double z = (i % 2 == 0 ? 1 : -1) * 0.5 * r * i;
        if (game_->set_state(0, {{-shape_.length / 4, r, z}}).ok()) break;
      }
    }
    stage.say(scratch ? "the cue ball fell: it is in hand on the head spot"
                      : format("%.0f of %.0f balls are down; the shot took %.1f s", down, game_->balls() - 1,
                               game_->rest_time() - struck_at_));
  }

  /// The easiest pot that the solver finds.
  void find_shot(Stage3& stage) {
    if (carom_) return stage.say("the solver looks for pots, and this table has no pockets");
    struct Candidate {
      int ball, pocket;
      double ease;
    };
    std::vector<Candidate> candidates;
    const auto seen = [&](int ball) {
      const Vec3d p = game_->state(ball).position;
      return Vec2d{p.x, p.z};
    };
    const auto& pockets = game_->table().pockets();
    for (int ball = 1; ball < game_->balls(); ++ball) {
      if (!in_play(game_->state(ball).phase)) continue;
      for (int pocket = 0; pocket < int(pockets.size()); ++pocket) {
        const Vec2d to = pockets[std::size_t(pocket)].center - seen(ball), from = seen(ball) - seen(0);
        const double cut = dot(normalize(to), normalize(from));
        if (cut < 0.35) continue;
        candidates.push_back({ball, pocket, cut / (length(to) * (0.4 + length(from)))});
      }
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
      return a.ease != b.ease ? a.ease > b.ease : a.ball * 8 + a.pocket < b.ball * 8 + b.pocket;
    });
    if (candidates.size() > 14) candidates.resize(14);
    for (const Candidate& c : candidates) {
      sports::ShotOptions options;
      options.side = stage.value("side"), options.height = stage.value("height");
      options.slowest = 0.9, options.fastest = 3.5, options.speeds = 3;
      const auto shot = sports::solve_shot(*game_, {.object = c.ball, .pocket = c.pocket}, options);
      if (!shot || !*shot) continue;
      double direction = (*shot)->stroke.direction;
      if (direction > pi) direction -= 2 * pi;
      if (direction < -pi) direction += 2 * pi;
      stage.set_value("direction", direction);
      stage.set_value("speed", (*shot)->stroke.speed);
      stage.set_value("elevation", 0);
      stage.say(format("ball %.0f: the aim may be off by %.2f°", c.ball, degrees((*shot)->window)));
      return;
    }
    stage.say("no direct pot from here");
  }

  std::optional<Billiards> game_;
  sports::RectangularTable shape_{};
  std::vector<Vec2d> layout_;
  std::vector<Vec3d> start_;
  BallBodies balls_;
  CueBody cue_;
  rigid::BodyId handle_;
  Vec3d handle_place_{};
  double handle_away_ = 0.4;
  double clock_ = 0, stroke_clock_ = -1, energy_ = 0, rise_ = 0, started_ = 0, struck_at_ = 0;
  double law_at_ = 0, law_time_ = 0, law_from_ = 0;
  Vec3d law_velocity_{}, law_slip_{}, left_{};
  Score opening_{};
  int law_steps_ = 0;
  int shots_ = 0;
  bool carom_ = false;
  bool free_ = false;  // has met nothing since the stroke
  bool struck_ = false, reported_ = true;
};

}  // namespace

std::unique_ptr<Demo> make_pool_table() { return std::make_unique<PoolTable>(); }

}  // namespace carom::host::demo
